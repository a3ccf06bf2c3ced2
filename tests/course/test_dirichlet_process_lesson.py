"""Lesson 04: its checks know the usual mistakes, its pictures hold the numbers, its explorer says what is true."""

import numpy as np
import pytest
from exercises import assert_names_the_mistake, checks_and_solutions
from matplotlib.colors import to_hex
from readable import assert_readable

from npslam_teach import dead_reckoning, plotting, se2, simulate
from npslam_teach.association import association_probabilities, association_weights, decide, expected_num_objects
from npslam_teach.course.dirichlet_process import checks, figures, pictures
from npslam_teach.course.dirichlet_process import explorer as dirichlet_process_explorer

# --- exercises -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("answer", "message"),
    [
        (lambda v, d, s: np.exp(-(d**2) / (2 * s**2)), "votes are missing"),
        (lambda v, d, s: v * np.exp(-d / (2 * s**2)), "distance is not squared"),
        (lambda v, d, s: v * np.exp(-(d**2) / (2 * s)), "kernel width is not squared"),
        (lambda v, d, s: v * np.exp(-(d**2) / s**2), "the 2 under"),
        (lambda v, d, s: v * np.exp(d**2 / (2 * s**2)), "wrong sign"),
        (lambda v, d, s: (w := v * np.exp(-(d**2) / (2 * s**2))) / w.sum(), "shares, not weights"),
        (lambda v, d, s: v + np.exp(-(d**2) / (2 * s**2)), "some weight is off"),
        (lambda v, d, s: v[:2], "shape"),
    ],
)
def test_mistakes_in_weights_are_named(answer, message):
    assert_names_the_mistake(checks.check_weights, answer, message)


@pytest.mark.parametrize(
    ("answer", "message"),
    [
        (lambda w, a: w / (w.sum() + a), '"new", which has no entry'),
        (lambda w, a: list(w / w.sum()), '"new", which has no entry'),
        (lambda w, a: np.append(w, a) / w.sum(), "leaves alpha out"),
        (lambda w, a: np.append(w, a), "nothing was divided"),
        (lambda w, a: np.append(a, w) / (w.sum() + a), "stands first"),
        (lambda w, a: np.append(w / (w.sum() + a), a), "alpha is taken for a probability"),
        (lambda w, a: (v := np.append(w + a, a)) / v.sum(), 'only "new" has it'),
        (lambda w, a: np.append(w, 1.0) / (w.sum() + 1.0), "the probabilities should be"),
    ],
)
def test_mistakes_in_reweighting_are_named(answer, message):
    assert_names_the_mistake(checks.check_reweight, answer, message)


def at_least(p, threshold):
    best = int(np.argmax(p[:-1]))
    return best if p[best] >= (p[-1] if threshold is None else threshold) else len(p) - 1


@pytest.mark.parametrize(
    ("answer", "message"),
    [
        (lambda p, t: decide(p), "threshold is not used"),
        (lambda p, t: int(np.argmax(p)) if t is None or p.max() > t else len(p) - 1, "still takes part"),
        (at_least, "a tie must open a new object"),
        (lambda p, t: decide(p, t) - (decide(p, t) == len(p) - 1), "one past the last object"),
        (lambda p, t: int(np.argmax(p[:-1])), "never opened"),
        (lambda p, t: len(p) - 1, "the index should be"),
        (lambda p, t: float(decide(p, t)), "a whole number"),
    ],
)
def test_mistakes_in_decisions_are_named(answer, message):
    assert_names_the_mistake(checks.check_decide, answer, message)


@pytest.mark.parametrize(
    ("answer", "message"),
    [
        (lambda n, a: sum(a / (a + i) for i in range(1, n + 1)), "opens a table for certain"),
        (lambda n, a: a / (a + n - 1), "the last guest alone"),
        (lambda n, a: a * np.log(1 + n / a), "logarithm"),
        (lambda n, a: sum(1 / (a + i) for i in range(n)), "above the fraction"),
        (lambda n, a: sum(a / (a + i) for i in range(n + 1)), "one guest too many"),
        (lambda n, a: n, "exactly 1 table"),
    ],
)
def test_mistakes_in_tables_are_named(answer, message):
    assert_names_the_mistake(checks.check_expected_tables, answer, message)


def a_sweep(labels, places, xy, obs_class, alpha, order=reversed, own=1, classes=True, move=True, new=True):
    """The sweep written again in plain loops, with switches for typical mistakes."""
    labels, places, home = list(labels), [*places], list(labels)
    for k in order(range(len(labels))):
        weights = []
        for i, place in enumerate(places):
            members = home if not move else labels
            alike = [j for j, label in enumerate(members) if label == i and (j != k or not own)]
            votes = sum(not classes or obs_class[j] == obs_class[k] for j in alike)
            weights.append(votes * np.exp(-4 * np.sum((place - xy[k]) ** 2)))
        best = int(np.argmax(weights))
        if new and weights[best] <= alpha:
            best = len(places)
            places.append(xy[k])
        labels[k] = best
    return np.array(labels)


@pytest.mark.parametrize(
    ("mistake", "message"),
    [
        ({"own": 0}, "take its vote back"),
        ({"order": list}, "order matters"),
        ({"move": False}, "votes of the beginning"),
        ({"classes": False}, "class is left out"),
        ({"new": False}, "never opened"),
    ],
)
def test_mistakes_in_the_sweep_are_named(mistake, message):
    assert_names_the_mistake(checks.check_sweep, lambda *a: a_sweep(*a, **mistake), message)


def test_the_sweep_is_judged_by_its_groups_not_by_its_numbers():
    assert checks.check_sweep(a_sweep).passed
    assert checks.check_sweep(lambda *a: 7 + 2 * a_sweep(*a)).passed
    verdict = checks.check_sweep(lambda labels, *a: labels)
    assert not verdict.passed
    verdict = checks.check_sweep(lambda labels, *a: 0 * labels)
    assert not verdict.passed and "1 objects where there should be" in verdict.message


def test_checks_notice_students_who_change_their_arguments():
    _, solution = checks_and_solutions("04_dirichlet_process")

    def changes(labels, landmarks, xy, obs_class, alpha):
        answer = solution(5)(labels, landmarks, xy, obs_class, alpha)
        labels[:], xy[:] = 0, 0
        return answer

    assert_names_the_mistake(checks.check_sweep, changes, "changes its argument labels")


# --- pictures --------------------------------------------------------------------------------------------------------


@pytest.fixture
def ax():
    return plotting.new_figure()[1]


def heights(ax):
    return [bar.get_height() for bar in ax.containers[0]]


def test_bars_have_the_heights_the_numbers_and_the_colours(ax):
    values = np.array([0.3, 0.0, 0.25, 0.45])
    assert pictures.plot_bars(ax, values, ["a", "b", "c", "new"], [0, 1, 2, None], "probability (no unit)", "t") is ax
    assert heights(ax) == values.tolist()
    assert [text.get_text() for text in ax.texts] == ["0.30", "0", "0.25", "0.45"]
    assert [text.xy[1] for text in ax.texts] == values.tolist()
    for c, bar in enumerate(ax.containers[0][:3]):
        assert to_hex(bar.get_facecolor()) == plotting.class_style(c)[0]
    assert ax.containers[0][3].get_hatch() == "///"
    assert "(no unit)" in ax.get_ylabel()
    assert ax.get_ylim()[0] == 0 and ax.get_ylim()[1] > 0.45
    pictures.set_bars(ax, np.array([np.nan, 0.5, 0.2, 0.3]))
    assert heights(ax) == [0.0, 0.5, 0.2, 0.3]
    assert [text.get_text() for text in ax.texts] == ["itself", "0.50", "0.20", "0.30"]


def test_a_threshold_is_a_dashed_level_with_its_number(ax):
    pictures.plot_bars(ax, np.array([0.3, 0.2]), ["a", "new"], [0, None], "p (no unit)", "")
    pictures.plot_threshold(ax, 0.6)
    (level,) = ax.lines
    assert set(level.get_ydata()) == {0.6} and level.get_linestyle() == "--"
    assert "0.60" in ax.texts[-1].get_text()
    assert ax.get_ylim()[1] > 0.6


def test_panels_share_one_scale_and_know_new():
    figure = pictures.plot_bar_panels(
        {"a": [0.5, 0.5], "b": [0.2, 0.3, 0.5]}, ["x", "y"], [0, 1], thresholds=(0.1, 0.4)
    )
    left, right = figure.axes
    assert left.get_ylim() == right.get_ylim()
    assert [tick.get_text() for tick in right.get_xticklabels()] == ["x", "y", "new"]
    assert [tick.get_text() for tick in left.get_xticklabels()] == ["x", "y"]
    assert [ax.lines[0].get_ydata()[0] for ax in (left, right)] == [0.1, 0.4]


def test_the_map_shows_every_sighting_and_the_distances_of_the_one_that_asks(ax):
    log, truth = simulate.toy_objects()
    poses = dead_reckoning(log.odometry)
    xy = se2.apply(poses[log.obs_time], log.obs_xy)
    assert pictures.plot_sightings(ax, poses, xy, log.obs_class, truth.world.class_names, asks=4) is ax
    assert ax.get_aspect() == 1.0 and (ax.get_xlabel(), ax.get_ylabel()) == ("x (m)", "y (m)")
    assert np.array_equal(ax.lines[0].get_xydata(), poses[:, :2])
    names = {text.get_text(): text.xy for text in ax.texts if text.get_text().startswith("Obj_")}
    assert {f"Obj_{k + 1}" for k in range(8)} == set(names)
    assert all(np.allclose(names[f"Obj_{k + 1}"], xy[k]) for k in range(8))
    assert sorted(text.get_text() for text in ax.texts if text.get_text().endswith(" m")) == ["0.3 m", "0.4 m", "0.7 m"]
    for bow in ax.lines[1:]:
        assert np.allclose(bow.get_xydata()[0], xy[4])
        assert any(np.allclose(bow.get_xydata()[-1], xy[k]) for k in (0, 1, 3))


def test_tables_show_the_mean_and_the_formula(ax):
    rng = np.random.default_rng(0)
    tables = {a: np.cumsum(rng.integers(0, 2, (30, 12)), axis=1) for a in (0.5, 2.0)}
    expected = {a: np.arange(12.0) * a for a in tables}
    pictures.plot_tables(ax, tables, expected)
    solid, dashed = ax.lines[0::2], ax.lines[1::2]
    for line, level, a in zip(solid, dashed, tables, strict=True):
        assert np.allclose(line.get_ydata(), tables[a].mean(axis=0))
        assert np.array_equal(level.get_ydata(), expected[a])
        assert level.get_linestyle() == "--" and line.get_linestyle() != "--"
    assert "(number)" in ax.get_xlabel() and "(number)" in ax.get_ylabel()
    assert len(ax.collections) == 2


def test_the_cliff_has_a_curve_for_every_room(ax):
    counts = np.array([[15, 16, 900], [15, 15, 1000]])
    pictures.plot_cliff(ax, (0.1, 0.9, 1.0), counts, num_objects_true=15)
    assert [line.get_ydata().tolist() for line in ax.lines[:2]] == counts.tolist()
    assert ax.get_yscale() == "log"
    labels = [text.get_text() for text in ax.get_legend().get_texts()]
    assert labels == ["room 0", "room 1", "true number: 15", "alpha = 1"]


@pytest.mark.parametrize("entry", figures.FIGURES, ids=lambda entry: entry.name)
def test_figure_files_are_readable(entry):
    assert entry.name[:5] in ("fig06", "fig07", "fig08") and len(entry.alt) > 60
    assert_readable(entry.draw())


def test_the_numbers_in_the_alternative_texts_are_those_of_the_bars():
    by_name = {entry.name[:5]: entry for entry in figures.FIGURES}
    for number in ("fig06", "fig07", "fig08"):
        axes = [ax for ax in by_name[number].draw().axes if ax.containers]
        shown = {text.get_text() for ax in axes for text in ax.texts} - {"0"}
        if number == "fig08":
            assert "0.37" in by_name[number].alt
            assert [ax.get_title().split(": ")[1] for ax in axes] == ["Obj_5 is Obj_2", "Obj_5 is a new object"]
        else:
            assert all(text in by_name[number].alt for text in shown)
    bars = heights(by_name["fig07"].draw().axes[1])
    weights = np.exp([-0.64, -0.36, -1.96])
    assert np.allclose(np.array(bars)[[0, 1, 3, 7]], np.append(weights, 0.5) / (weights.sum() + 0.5))


# --- the explorer ----------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def explorer():
    return dirichlet_process_explorer.explore_association()


def toy_answer(asks, alpha, kernel_std):
    log, _ = simulate.toy_objects()
    xy = se2.apply(dead_reckoning(log.odometry)[log.obs_time], log.obs_xy)
    votes = (log.obs_class == log.obs_class[asks]) & (np.arange(8) != asks)
    distance = np.linalg.norm(xy - xy[asks], axis=1)
    return association_weights(votes, distance, kernel_std), association_probabilities(
        votes, distance, alpha, kernel_std
    )


@pytest.mark.parametrize("asks", [0, 2, 4, 6])
@pytest.mark.parametrize(
    ("alpha", "threshold", "kernel_std"), [(0.05, 0.0, 0.05), (0.5, 0.3, 0.35), (0.9, 0.95, 0.6), (1.5, 0.05, 1.0)]
)
def test_the_explorer_agrees_with_the_library(explorer, asks, alpha, threshold, kernel_std):
    words = explorer.move(asks=asks, alpha=alpha, threshold=threshold, kernel_std=kernel_std)
    weights, probabilities = toy_answer(asks, alpha, kernel_std)
    for row, (kind, values) in enumerate({"weight": np.append(weights, alpha), "probability": probabilities}.items()):
        panel = dirichlet_process_explorer.BARS[row]
        top = (dirichlet_process_explorer.HIGHEST_WEIGHT, 1.12)[row]
        shown = [bar_height(explorer.scene, f"{kind} {k}") * top / panel[3] for k in range(9)]
        assert np.allclose(np.delete(shown, asks), np.delete(values, asks), atol=1e-4)
        assert explorer.scene.parts[f"{kind} number {asks}"][2] == "itself" and shown[asks] == 0
        assert max(shown) < top
    chosen = decide(probabilities, threshold or None)
    assert words.endswith("a new object." if chosen == 8 else f"the same as Obj_{chosen + 1}.")
    assert words.startswith(f"Obj_{asks + 1} weighs") and f"new {probabilities[-1]:.2f}" in words
    for k in np.flatnonzero(weights > 0.01):
        assert f"Obj_{k + 1} {weights[k]:.2f}" in words and f"Obj_{k + 1} {probabilities[k]:.2f}" in words
    assert ("threshold" in explorer.scene.parts) == (threshold > 0)
    if threshold > 0:
        left, top, width, height = dirichlet_process_explorer.BARS[1]
        level = top + height * (1 - threshold / 1.12)
        wanted = [[left, level], [left + width, level]]
        assert np.allclose(points_of(explorer.scene, "threshold"), wanted, atol=0.006)


def bar_height(scene, name):
    return float(scene.parts[name][1]["height"])


def points_of(scene, name):
    return np.array([each.split(",") for each in scene.parts[name][1]["points"].split()], dtype=float)


def test_a_sighting_that_is_dragged_is_judged_where_it_lies(explorer):
    xy = explorer.sliders["xy"].value.copy()
    explorer.move(asks=4, alpha=0.5, threshold=0.0, kernel_std=0.35)
    try:
        moved = xy.copy()
        moved[4] = xy[6] + (0.0, 0.1)  # onto the cup, which is no chair
        words = explorer.move(xy=moved)
        distance = np.linalg.norm(moved - moved[4], axis=1)
        log, _ = simulate.toy_objects()
        votes = (log.obs_class == log.obs_class[4]) & (np.arange(8) != 4)
        weights = association_weights(votes, distance, 0.35)
        assert all(f"Obj_{k + 1} {weights[k]:.2f}" in words for k in (0, 1, 3)) and "Obj_7" not in words
        room = explorer.controls[-1]
        assert room["kind"] == "places"
        handle = explorer.scene.parts["handle 4"][1]
        a, x0, b, y0 = room["scale"]
        assert np.allclose([float(handle["cx"]), float(handle["cy"])], moved[4] * (a, b) + (x0, y0), atol=0.006)
    finally:
        explorer.move(xy=xy)


def test_what_may_be_the_same_has_the_kernel_around_it(explorer):
    explorer.move(asks=2, kernel_std=0.6)
    halos = {name for name in explorer.scene.parts if name.startswith("halo")}
    assert halos == {f"halo {k} {times}" for k in (5, 7) for times in (1, 2)}  # the other screens
    scale = explorer.controls[-1]["scale"][0]
    assert np.isclose(float(explorer.scene.parts["halo 5 1"][1]["r"]), 0.6 * scale, atol=0.006)
    explorer.move(asks=4, kernel_std=0.35)


# --- the claims of the lesson ----------------------------------------------------------------------------------------


def test_rivals_move_the_threshold_and_not_alpha():
    """The most probable wins when its weight exceeds alpha; a threshold also counts the others."""
    rng = np.random.default_rng(4)
    for _ in range(200):
        weights, alpha, threshold = rng.exponential(0.5, 4), rng.uniform(0.1, 1.5), rng.uniform(0.1, 0.9)
        p = np.append(weights, alpha) / (weights.sum() + alpha)
        best = weights.argmax()
        assert (decide(p) == best) == (weights[best] > alpha)
        assert (decide(p, threshold) == best) == (weights[best] > threshold * (weights.sum() + alpha))


def test_the_restaurant_of_the_lesson_is_the_formula():
    """Tables by seating guests one at a time, exactly: the distribution of the number of tables."""
    alpha, chance = 0.9, {0: 1.0}
    for others in range(25):
        opened = alpha / (alpha + others)
        after = {}
        for tables, p in chance.items():
            after[tables] = after.get(tables, 0.0) + p * (1 - opened)
            after[tables + 1] = after.get(tables + 1, 0.0) + p * opened
        chance = after
    assert np.isclose(sum(tables * p for tables, p in chance.items()), expected_num_objects(25, alpha))
