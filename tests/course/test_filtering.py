"""Lesson 09: its pictures contain what they should, its sliders tell the truth, its checks know the usual mistakes."""

import re
from dataclasses import replace
from itertools import islice

import numpy as np
import pytest
from exercises import assert_names_the_mistake, checks_and_solutions
from matplotlib.path import Path as Outline
from readable import assert_readable
from rings import assert_rings_lie_where_they_are_led
from scipy.optimize import linear_sum_assignment
from scipy.stats import chi2, norm

from npslam_teach import evaluation, plotting, se2, simulate
from npslam_teach.course.filtering import checks, figures, pictures
from npslam_teach.course.filtering import explorer as filtering_explorer
from npslam_teach.course.scene import Panel
from npslam_teach.methods.ekf import new_filter, predict, squared_distances, with_new_object
from npslam_teach.methods.ekf_slam import FilterRecord, ekf_slam, filter_steps, run_filter
from npslam_teach.methods.gating import assign, squared_mahalanobis

WITHOUT_OBJ_4 = [0, 1, 2, -1, 1, -1, 3, 4]

# --- exercises -------------------------------------------------------------------------------------------------------

CHECKS, solution = checks_and_solutions("09_filtering")


def add(mean, cov, xy, std, lever=1.0, power=2, turned=True, cross=1.0, only_pose=False, moved=True):
    turn = np.array([[np.cos(mean[2]), -np.sin(mean[2])], [np.sin(mean[2]), np.cos(mean[2])]])
    dx, dy = turn @ xy
    F = np.zeros((2, len(mean)))
    F[0, [0, 2]], F[1, [1, 2]] = [1, -lever * dy], [1, lever * dx]
    noise = np.diag(std**power)
    own = F @ cov @ F.T + (turn @ noise @ turn.T if turned else noise)
    shared = cross * F @ cov
    if only_pose:
        shared[:, 3:] = 0
    return np.append(mean, mean[:2] + (turn @ xy if moved else xy)), np.block([[cov, shared.T], [shared, own]])


def last_resort(squared, gate):
    """Assign without the gate, then discard pairs beyond it."""
    rows, columns = linear_sum_assignment(squared)
    chosen = np.full(len(squared), -1)
    for row, column in zip(rows, columns, strict=True):
        chosen[row] = column if squared[row, column] < gate else -1
    return chosen


def in_turn(squared, gate):
    left, chosen = np.array(squared), []
    for row in left:
        j = row.argmin()
        chosen.append(j if row[j] < gate else -1)
        left[:, j] = np.inf if row[j] < gate else left[:, j]
    return chosen


def clipped(squared, gate):
    """Another right answer, without extra columns for observations that are left out."""
    rows, columns = linear_sum_assignment(np.minimum(squared, gate))
    chosen = np.full(len(squared), -1)
    chosen[rows] = np.where(squared[rows, columns] < gate, columns, -1)
    return chosen


WRONG = [
    (1, lambda p, h, s: p * h / (h * h * p + s), "must be squared"),
    (1, lambda p, h, s: p * abs(h) / (h * h * p + s * s), "sign of the slope"),
    (1, lambda p, h, s: p * h / (abs(h) * p + s * s), "counts twice"),
    (1, lambda p, h, s: 1 / h, "noise of the sensor is missing"),
    (1, lambda p, h, s: s * s / (h * h * p + s * s), "share of the old belief"),
    (1, lambda p, h, s: h * h * p / (h * h * p + s * s), "divide by the slope"),
    (1, lambda p, h, s: p / (h * h * p + s * s), "missing above the line"),
    (1, lambda p, h, s: 2 * p * h / (h * h * p + s * s), "should be"),
    (1, lambda p, h, s: [p, h], "shape (), yours has (2,)"),
    (2, lambda y, S: np.sqrt(y @ np.linalg.inv(S) @ y), "the square is asked for"),
    (2, lambda y, S: y @ S @ y, "multiplied, not divided"),
    (2, lambda y, S: np.linalg.norm(y) ** 2, "covariance is not used"),
    (2, lambda y, S: sum(y**2 / np.diag(S)), "only the diagonal"),
    (2, lambda y, S: y @ (1 / S) @ y, "number by number"),
    (2, lambda y, S: y @ np.linalg.inv(S @ S) @ y, "inverted twice"),
    (2, lambda y, S: 2 * (y @ np.linalg.inv(S) @ y), "should be"),
    (3, lambda d, g: np.where(d.min(axis=1) < g, d.argmin(axis=1), -1), "share an object"),
    (3, in_turn, "take turns"),
    (3, last_resort, "asked too late"),
    (3, lambda d, g: np.zeros(len(d)), "should be"),
    (3, lambda d, g: linear_sum_assignment(d)[1], "shape"),
    (4, lambda *a: add(*a, cross=0.0), "shares no error with the pose"),
    (4, lambda *a: add(*a, only_pose=True), "with the pose only"),
    (4, lambda *a: add(*a, turned=False), "not turned into the world"),
    (4, lambda *a: add(*a, lever=0.0), "heading is left out"),
    (4, lambda *a: add(*a, lever=-1.0), "wrong sign"),
    (4, lambda *a: add(*a, power=1), "must be squared"),
    (4, lambda *a: add(*a, moved=False), "not turned into the world before"),
    (4, lambda m, P, xy, s: (add(m, P, xy, s)[0][::-1], add(m, P, xy, s)[1]), "old numbers of your mean"),
    (4, lambda m, P, xy, s: (add(m, P, xy, s)[0], P), "your covariance should have shape"),
    (4, lambda m, P, xy, s: (add(m, P, xy, s)[0], 2 * add(m, P, xy, s)[1]), "old part of your covariance"),
    (4, lambda m, P, xy, s: (add(m, P, xy, s)[0], add(m, P, xy, 2 * s)[1]), "its own two by two"),
    (4, lambda *a: add(*a, cross=0.5), "shares with the old"),
    (4, lambda *a: add(*a)[0], "return two things"),
    (5, lambda n, p: chi2.ppf([(1 - p) / 2, (1 + p) / 2], n) / n, "adds two degrees"),
    (5, lambda n, p: chi2.ppf([(1 - p) / 2, (1 + p) / 2], 2 * n), "bounds of the sum"),
    (5, lambda n, p: chi2.ppf([1 - p, p], 2 * n) / n, "half of it at either end"),
    (5, lambda n, p: chi2.ppf([(1 - p) / 2, (1 + p) / 2], 2 * n) / (2 * n), "a match has two"),
    (5, lambda n, p: 2 + 2 / n**0.5 * norm.ppf([(1 - p) / 2, (1 + p) / 2]), "Gaussian approximation"),
    (5, lambda n, p: chi2.ppf([(1 - p) / 2, (1 + p) / 2], 2), "must depend on N"),
    (5, lambda n, p: chi2.ppf([(1 + p) / 2, (1 - p) / 2], 2 * n) / n, "low, then high"),
    (5, lambda n, p: [1, 3], "should be"),
]


@pytest.mark.parametrize(("number", "mistake", "message"), WRONG)
def test_usual_mistakes_are_named(number, mistake, message):
    assert_names_the_mistake(CHECKS[number], mistake, message)


def test_other_right_ways_are_right():
    assert checks.check_match_frame(clipped).passed
    assert checks.check_match_frame(lambda d, g: np.maximum(assign(d, g, np.inf), -1)).passed
    assert checks.check_squared_mahalanobis(squared_mahalanobis).passed
    assert checks.check_kalman_gain(lambda p, h, s: np.array(1 / (h + s**2 / (p * h)))).passed
    assert checks.check_add_object(add).passed


def test_the_solution_of_exercise_4_is_the_filters():
    rng = np.random.default_rng(0)
    ekf, std = new_filter(), np.array([0.3, 0.6])
    for xy in rng.normal(size=(3, 2)):
        predict(ekf, rng.normal(size=3), np.array([0.1, 0.2, 0.3]))
        mean, cov = solution(4)(ekf.x, ekf.P, xy, std)
        ekf = with_new_object(ekf, xy, std)
        np.testing.assert_allclose(ekf.x, mean, atol=1e-12)
        np.testing.assert_allclose(ekf.P, cov, atol=1e-12)


# --- pictures --------------------------------------------------------------------------------------------------------


@pytest.fixture
def ax():
    return plotting.new_figure()[1]


def test_figure_20_shows_two_answers():
    figure = figures.two_answers_figure()
    assert_readable(figure)
    left, right = figure.axes
    log, truth = simulate.toy_objects()
    assert {text.get_text() for text in left.texts} == {"chair A", "chair B", "Obj_5: chair B"}
    for ax in figure.axes:
        assert ax.get_aspect() == 1.0
        assert ax.get_xlabel() == "x (m)"
    assert left.get_ylabel() == "y (m)"
    beliefs = [line for line in right.lines if len(line.get_xdata()) == 100]
    assert [line.get_label() for line in beliefs] == ["taken for chair B", "taken for chair A"]
    true_xy = truth.poses[figures.POSE, :2]
    inside = [Outline(line.get_xydata()).contains_point(true_xy) for line in beliefs]
    assert inside == [True, False]
    sizes = [np.ptp(line.get_xydata(), axis=0) for line in beliefs]
    middles = [line.get_xydata()[:-1].mean(axis=0) for line in beliefs]
    np.testing.assert_allclose(sizes[0], sizes[1], rtol=0.25)
    assert np.linalg.norm(middles[0] - middles[1]) > 0.5
    (entry,) = figures.FIGURES
    assert entry.name.startswith("fig20_") and len(entry.alt) > 60


def test_beliefs_are_gaussians(ax):
    pictures.plot_beliefs(ax, {"wheels": (3.0, 0.25), "wall": (3.4, 0.04)}, true_x=3.3)
    wheels, wall, true = ax.lines
    x, density = wheels.get_data()
    assert np.trapezoid(density, x) == pytest.approx(1.0, abs=0.01)
    assert x[density.argmax()] == pytest.approx(3.0, abs=0.01)
    assert wall.get_ydata().max() == pytest.approx(1 / np.sqrt(2 * np.pi * 0.04), rel=1e-3)
    assert true.get_linestyle() == "--" and set(true.get_xdata()) == {3.3}
    assert len({(line.get_color(), line.get_linestyle()) for line in ax.lines}) == 3
    assert "(m)" in ax.get_xlabel() and "(1/m)" in ax.get_ylabel()
    assert ax.get_title() == "the narrowest belief: wall, with a standard deviation of 0.20 m"


def test_names_count_within_a_class():
    assert pictures.object_names([0, 0, 1, 0], ("chair", "cup")) == ["chair A", "chair B", "cup A", "chair C"]
    names = pictures.object_names(np.zeros(60, dtype=int), ("chair",))
    assert names[25:28] == ["chair Z", "chair A1", "chair B1"] and len(set(names)) == 60
    assert pictures.object_names([], ("chair",)) == []


@pytest.mark.parametrize("radius", [0.5, 1.4, 3.0, 6.0])
def test_the_gate_on_the_map_is_the_gate_of_the_filter(radius):
    """An observation lies inside the ellipse exactly when its Mahalanobis distance is below the radius."""
    log, _ = simulate.toy_objects()
    step = list(filter_steps(log, labels=WITHOUT_OBJ_4))[4]
    state = step.prior_mean, step.prior_cov
    outline = pictures.gate_outline(*state, 1, log.observation_std, radius)
    on_edge = se2.apply_inverse(step.prior_mean[:3], outline)
    squared = squared_distances(*state, on_edge, log.observation_std)[:, 1]
    np.testing.assert_allclose(np.sqrt(squared), radius, rtol=1e-6)
    assert evaluation.share_within(radius) == pytest.approx(chi2.cdf(radius**2, 2))


def record_of(nis, dof):
    nothing = np.zeros(0)
    return FilterRecord(nothing, nothing, nothing, nothing, nothing, nothing, np.array(nis), np.array(dof))


def test_nis_is_averaged_over_windows(ax):
    nan = float("nan")
    record = record_of([1.0, nan, 3.0, nan, nan, nan, 8.0], [2, 0, 2, 0, 0, 0, 4])
    middle, average, dof = evaluation.nis_in_windows(record.nis, record.nis_dof, 3)
    np.testing.assert_allclose(middle, [1.0, 6.0])
    np.testing.assert_allclose(average, [1.0, 2.0])
    np.testing.assert_array_equal(dof, [4, 4])
    pictures.plot_nis(ax, {"mine": record, "another": record}, window=3, probability=0.9)
    np.testing.assert_allclose(ax.lines[0].get_ydata(), [1.0, 2.0])
    band = ax.collections[0].get_paths()[0].vertices
    np.testing.assert_allclose([band[:, 1].min(), band[:, 1].max()], chi2.ppf([0.05, 0.95], 4) / 4)
    labels = [text.get_text() for text in ax.get_legend().get_texts()]
    assert labels == ["mine", "another", "90% band of a consistent filter"]
    assert ax.get_yscale() == "log" and "(index)" in ax.get_xlabel()
    assert ax.get_title().endswith("band: mine, another")


def test_only_consistent_filters_are_named_in_the_title(ax):
    records = {"right": record_of([2.0] * 6, [2] * 6), "over-confident": record_of([80.0] * 6, [2] * 6)}
    assert pictures.plot_nis(ax, records, window=3).get_title().endswith("band: right")
    alone = pictures.plot_nis(plotting.new_figure()[1], {"over-confident": records["over-confident"]}, window=3)
    assert alone.get_title().endswith("band: none")


def test_the_spread_has_a_dot_for_every_room(ax):
    errors = {"ekf": [0.1, 0.2, 0.4], "ekf, paper's noise": [1.0, 3.0, 2.0], "graph after ekf": [0.1, 0.1, 0.2]}
    pictures.plot_spread(ax, errors)
    dots, bars = ax.lines[::2], ax.lines[1::2]
    for row, (values, dot, bar) in enumerate(zip(errors.values(), dots, bars, strict=True)):
        np.testing.assert_allclose(dot.get_xdata(), values)
        assert (np.abs(dot.get_ydata() - row) < 0.4).all()
        assert set(bar.get_xdata()) == {np.median(values)}
    assert [label.get_text() for label in ax.get_yticklabels()] == list(errors)
    assert dots[0].get_marker() == dots[1].get_marker() == "v"
    assert dots[2].get_marker() == "*"
    assert ax.yaxis_inverted() and "(m" in ax.get_xlabel()
    assert ax.get_title().startswith("least error in the worst room: graph after ekf\n")


# --- the explorer ----------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def explorer():
    log, truth = simulate.toy_objects()
    return filtering_explorer.explore_gate(log, 4, truth.world.class_names, labels=WITHOUT_OBJ_4)


DISTANCES = {"Obj_5": {"chair A": 1.643, "chair B": 1.232}, "Obj_6": {"screen A": 1.323}}


@pytest.mark.parametrize("second_gate", [0.5, 1.3, 6.0])
@pytest.mark.parametrize("size", [0.5, 1.2, 1.3, 1.4, 6.0])
def test_words_and_artists_agree_with_the_distances(explorer, size, second_gate):
    words = explorer.move(gate=size, second_gate=second_gate)
    wider, parts = max(size, second_gate), explorer.scene.parts
    assert words.startswith(f"Gates at {size:.1f} and {wider:.1f} standard deviations; ")
    share = float(re.search(r"; ([\d.]+) % of right", words).group(1))
    assert share == pytest.approx(100 * chi2.cdf(size**2, 2), abs=0.05)
    for name, rivals in DISTANCES.items():
        nearest = min(rivals, key=rivals.get)
        away = rivals[nearest]
        expected = nearest if away < size else "new" if away > wider else "left out"
        stated = re.search(rf"{name}: ([^;]*); ([^.;]*)\.", words)
        assert stated.group(2) == expected
        assert f"{nearest} at {away:.2f}" in stated.group(1)
        k = int(name[-1]) - 1
        assert parts[f"answer {k}"][2] == f"{name}: {expected}"
        assert (f"tie {k}" in parts) == (expected == nearest)
    for name in DISTANCES:
        assert words.count(name) == 1


def corners_of(explorer, name):
    """The points of a polyline on the map, m."""
    drawn = [each.split(",") for each in explorer.scene.parts[name][1]["points"].split()]
    a, x0, b, y0 = room_of(explorer).scale
    return (np.array(drawn, float) - (x0, y0)) / (a, b)


def room_of(explorer):
    """The map, as its control for points knows it."""
    low, high = explorer.sliders["xy"].low, explorer.sliders["xy"].high
    frame = explorer.scene.parts["map frame"][1]
    box = tuple(float(frame[key]) for key in ("x", "y", "width", "height"))
    return Panel(box, (low[0], high[0]), (low[1], high[1]))


def test_ties_lead_from_sightings_to_their_objects(explorer):
    explorer.move(gate=3.0, second_gate=5.3)
    for k, true_object in ((4, (1.2, 0.4)), (5, (2.8, 0.6))):
        begin, end = corners_of(explorer, f"tie {k}")
        np.testing.assert_allclose(end, true_object, atol=0.02)
        np.testing.assert_allclose(begin - end, (0.0, 0.3), atol=0.01)  # the slip
    explorer.move(gate=0.5, second_gate=0.5)
    assert not any(name.startswith("tie") for name in explorer.scene.parts)


def distances_on(outline, xy):
    """Of points on the page, distances in units of an ellipse that is drawn as two arcs: 1 on its border."""
    x1, y1, long, short, turn, _, _, x2, y2 = map(float, re.findall(r"-?[\d.]+", outline)[:9])
    turned = np.deg2rad(turn)
    away = np.asarray(xy) - ((x1 + x2) / 2, (y1 + y2) / 2)
    along = away @ [np.cos(turned), np.sin(turned)]
    aside = away @ [-np.sin(turned), np.cos(turned)]
    return np.hypot(along / long, aside / short)


@pytest.mark.parametrize(("pose", "size"), [(1, 3.0), (3, 1.5), (4, 0.5), (4, 6.0), (5, 3.0), (2, 3.0)])
def test_gates_follow_the_robot_and_are_where_the_distance_is_their_size(explorer, pose, size):
    """What the outline separates, seen from the robot: a sighting on it is as far as the gate says."""
    log, _ = simulate.toy_objects()
    explorer.move(pose=pose, gate=size, second_gate=6.0)
    step = next(each for each in filter_steps(log, labels=WITHOUT_OBJ_4) if each.time == pose)
    gates = [name for name in explorer.scene.parts if name.startswith("gate ")]
    assert gates
    for name in gates:
        outline = pictures.gate_outline(step.prior_mean, step.prior_cov, int(name[5:]), log.observation_std, size)
        on_page = room_of(explorer).to_page(outline)
        np.testing.assert_allclose(distances_on(explorer.scene.parts[name][1]["d"], on_page), 1.0, atol=0.01)
    assert explorer.scene.parts["map title"][2] == f"before the sightings of pose {pose} are used"
    explorer.move(pose=4)


def test_a_sighting_that_is_led_across_the_gates_is_as_far_as_it_would_be_if_it_were_measured_there(explorer):
    log, truth = simulate.toy_objects()
    before = explorer.values()["xy"]
    (handle,) = [part[1] for name, part in explorer.scene.parts.items() if name == "handle 4"]
    place = int(handle["data-index"])
    for shift in ((0.0, 0.4), (-0.6, 0.1), (1.0, 1.0)):
        xy = before.copy()
        xy[place] += shift
        words = explorer.move(xy=xy, gate=3.0, second_gate=5.3)
        pose = next(step.prior_mean[:3] for step in filter_steps(log, labels=WITHOUT_OBJ_4) if step.time == 4)
        obs_xy = log.obs_xy.copy()
        obs_xy[4] = se2.apply_inverse(pose, xy[place])
        moved = replace(log, obs_xy=obs_xy)
        step = next(each for each in filter_steps(moved, labels=WITHOUT_OBJ_4) if each.time == 4)
        near = np.sqrt(step.squared_distance[0, :2])
        for name, away in zip(("chair A", "chair B"), near, strict=True):
            assert f"{name} at {away:.2f}" in re.search(r"Obj_5: ([^;]*);", words).group(1)
    explorer.move(xy=before)


def test_the_robot_lies_where_its_ring_is_led(explorer):
    assert_rings_lie_where_they_are_led(explorer)
    assert "Nothing is seen from pose 2" in explorer.move(pose=2)
    assert "no object of its class; new" in explorer.move(pose=0)
    explorer.move(pose=4)


def test_the_explorer_works_on_a_large_scene():
    log, truth = simulate.fifteen_objects()
    explorer = filtering_explorer.explore_gate(log, 113, truth.world.class_names)
    steps = {step.time: step for step in islice(filter_steps(log), 134)}
    names = pictures.object_names(steps[133].object_class, truth.world.class_names)
    for pose in (113, 93, 133):
        words = explorer.move(pose=pose)
        for k, label in zip(steps[pose].observations, steps[pose].labels, strict=True):
            known = 0 <= label < len(steps[pose].object_class)
            told = names[label] if known else "new" if label >= 0 else "left out"
            assert re.search(rf"Obj_{k + 1}: [^;]*; {told}\.", words)


@pytest.mark.parametrize(("time", "message"), [(0, "pose 0 does not"), (2, "pose 2 does not"), (6, "from 0 to 5")])
def test_moments_without_a_question_are_refused(time, message):
    log, truth = simulate.toy_objects()
    with pytest.raises(ValueError, match=message):
        filtering_explorer.explore_gate(log, time, truth.world.class_names)


def test_errors_in_the_explorer_are_raised(explorer, monkeypatch):
    monkeypatch.setattr(filtering_explorer, "assign", lambda *a: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        explorer.move(gate=2.2)


# --- what the lesson claims ------------------------------------------------------------------------------------------


def test_a_lie_makes_the_filter_as_sure_as_the_truth():
    log, truth = simulate.toy_objects()
    true, lie = (run_filter(log, labels=labels) for labels in (figures.RIGHT, figures.WRONG))
    stds = [np.sqrt(np.diagonal(record.pose_cov[4:], axis1=1, axis2=2)) for record in (true, lie)]
    np.testing.assert_allclose(stds[0], stds[1], rtol=0.25)
    off = [np.abs(record.poses - truth.poses)[4, 1] / std[0, 1] for record, std in zip((true, lie), stds, strict=True)]
    assert off[0] < 1 and off[1] > 6
    assert lie.nis[4] < chi2.ppf(0.99, 2)


def test_the_filter_needs_the_right_noise():
    exact = {"own": 0, "paper": 0}
    paper = {"odometry_std": (0.1, 0.1, 0.1), "observation_std": (0.5, 0.5)}
    for seed in range(10, 14):
        log, _ = simulate.fifteen_objects(seed)
        for name, settings in {"own": {}, "paper": paper}.items():
            *_, last = ekf_slam(log, **settings)
            exact[name] += last.num_objects == 15
    assert exact["own"] >= 3
    assert exact["paper"] <= 2
