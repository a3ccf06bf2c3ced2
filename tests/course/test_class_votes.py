"""Lesson 05: its checks know the usual mistakes, its pictures hold the numbers, its densities are densities."""

import base64
import io
import re

import numpy as np
import pytest
from exercises import assert_names_the_mistake
from matplotlib.colors import to_hex
from PIL import Image
from readable import assert_readable
from rings import rings_of

from npslam_teach import association, np_graph, plotting, simulate
from npslam_teach.association import class_posterior, count_votes, false_positives
from npslam_teach.course.class_votes import checks, figures, pictures, triangle
from npslam_teach.course.class_votes import explorer as class_votes_explorer
from npslam_teach.evaluation import Metrics
from npslam_teach.plotting.maps import laid_over_truth

CLASSES = simulate.TOY_CLASSES

# --- exercises -------------------------------------------------------------------------------------------------------


def without_add_at(labels, obs_class, num_objects, num_classes):
    votes = np.zeros((num_objects, num_classes + 1))
    votes[:, 0] = 1
    used = labels >= 0
    votes[labels[used], obs_class[used] + 1] += 1
    return votes


def counting_minus_one(labels, obs_class, num_objects, num_classes):
    votes = np.zeros((num_objects, num_classes + 1))
    votes[:, 0] = 1
    np.add.at(votes, (labels, obs_class + 1), 1)
    return votes


def unshifted(labels, obs_class, num_objects, num_classes):
    votes = np.zeros((num_objects, num_classes + 1))
    votes[:, 0] = 1
    used = labels >= 0
    np.add.at(votes, (labels[used], obs_class[used]), 1)
    return votes


@pytest.mark.parametrize(
    ("answer", "message"),
    [
        (lambda *a: count_votes(*a)[:, 1:], "column of the false-positive vote is missing"),
        (lambda *a: count_votes(*a).T, "rows and columns are exchanged"),
        (lambda *a: count_votes(*a) * (np.arange(a[3] + 1) > 0), "holds no false-positive vote"),
        (without_add_at, "forgets repetitions"),
        (counting_minus_one, "a label of -1"),
        (unshifted, "column c + 1"),
        (lambda *a: count_votes(*a) + 1, "some count is off"),
    ],
)
def test_mistakes_in_votes_are_named(answer, message):
    assert_names_the_mistake(checks.check_count_votes, answer, message)


@pytest.mark.parametrize(
    ("answer", "message"),
    [
        (lambda v: v / v[:, 1:].sum(axis=1, keepdims=True), "without the false-positive vote"),
        (lambda v: (v - v * (np.arange(v.shape[1]) == 0)) / v[:, 1:].sum(axis=1, keepdims=True), "left out altogether"),
        (lambda v: v / v.sum(axis=0), "columns add up to 1"),
        (lambda v: v / v.sum(), "everything together"),
        (lambda v: np.exp(v) / np.exp(v).sum(axis=1, keepdims=True), "softmax"),
        (lambda v: (v - 1) / np.maximum((v - 1).sum(axis=1, keepdims=True), 1e-300), "mode of Dir(votes)"),
        (lambda v: v, "the first row adds up to"),
    ],
)
def test_mistakes_in_class_posteriors_are_named(answer, message):
    assert_names_the_mistake(checks.check_class_posterior, answer, message)


@pytest.mark.parametrize(
    ("answer", "message"),
    [
        (lambda v, e: ~false_positives(v, e), "marks what is kept"),
        (lambda v, e: class_posterior(v)[:, 0] >= e, "does not exceed it"),
        (lambda v, e: v[:, 0] > e, "the vote itself"),
        (lambda v, e: 1 / v[:, 1:].sum(axis=1) > e, "not 1 / m"),
        (lambda v, e: 1 / (1 + v[:, 1:].max(axis=1)) > e, "most common class"),
        (lambda v, e: np.zeros(len(v), dtype=bool), "the answer should be"),
        (lambda v, e: class_posterior(v)[:, 0], "True or False"),
    ],
)
def test_mistakes_in_false_positives_are_named(answer, message):
    assert_names_the_mistake(checks.check_false_positives, answer, message)


def log_beta(a):
    from scipy.special import gammaln

    return gammaln(a).sum() - gammaln(a.sum())


def naive_log_density(x, a):
    from scipy.special import gamma

    return np.log(gamma(a.sum()) / np.prod(gamma(a)) * np.prod(x ** (a - 1)))


@pytest.mark.parametrize(
    ("answer", "message"),
    [
        (lambda x, a: ((a - 1) * np.log(x)).sum(), "factor 1 / B(a) is missing"),
        (lambda x, a: ((a - 1) * np.log(x)).sum() + log_beta(a), "is subtracted"),
        (lambda x, a: (a * np.log(x)).sum() - log_beta(a), "a_i - 1, not a_i"),
        (lambda x, a: np.exp(((a - 1) * np.log(x)).sum() - log_beta(a)), "that is the density"),
        (naive_log_density, "too large a number"),
        (lambda x, a: 0.0, "the same number everywhere"),
    ],
)
def test_mistakes_in_the_density_are_named(answer, message):
    assert_names_the_mistake(checks.check_log_density, answer, message)


def product(votes, confusion):
    likelihood = np.prod(confusion**votes, axis=1)
    return likelihood / likelihood.sum()


@pytest.mark.parametrize(
    ("answer", "message"),
    [
        (lambda v, c: product(v, c.T), "rows and columns are exchanged"),
        (lambda v, c: v / v.sum(), "confusion matrix is not used"),
        (lambda v, c: c @ v / (c @ v).sum(), "independent reports multiply"),
        (lambda v, c: np.prod(c**v, axis=1), "divide by their sum"),
        (lambda v, c: product(v, c) @ c, "the next report"),
        (lambda v, c: product(v > 0, c), "the votes are exponents"),
        (product, "too small for a number"),
        (lambda v, c: np.full(len(v), 1 / len(v)), "they must add up to 1"),
    ],
)
def test_mistakes_in_the_true_class_are_named(answer, message):
    assert_names_the_mistake(checks.check_true_class, answer, message)


# --- the mathematics -------------------------------------------------------------------------------------------------


def test_the_density_is_scipys_and_adds_up_to_one():
    from scipy.stats import dirichlet

    rng = np.random.default_rng(3)
    points, faces = pictures.triangle_points(120)
    middles = points[faces].mean(axis=1)
    for _ in range(5):
        a = rng.uniform(1.0, 9.0, 3)
        log_f = association.log_density(a, middles)
        assert np.allclose(log_f, dirichlet.logpdf(middles.T, a))
        # Over the first two coordinates the triangle has an area of one half.
        assert np.isclose(np.exp(log_f).mean() / 2, 1.0, atol=2e-3)


def test_the_grid_covers_the_triangle_once():
    points, faces = pictures.triangle_points(10)
    assert len(points) == 66 and len(faces) == 100
    assert np.allclose(points.sum(axis=1), 1.0) and (points >= -1e-12).all()
    a, b, c = (pictures.on_triangle(points[faces[:, k]]) for k in range(3))
    across, up = b - a, c - a
    areas = 0.5 * np.abs(across[:, 0] * up[:, 1] - across[:, 1] * up[:, 0])
    assert np.allclose(areas, np.sqrt(3) / 4 / 100)
    assert np.allclose(pictures.on_triangle(np.eye(3)), pictures.CORNERS)


def test_the_mode_is_where_the_density_is_highest():
    rng = np.random.default_rng(4)
    for _ in range(10):
        a = rng.uniform(1.05, 8.0, 3)
        peak = association.mode(a)
        nearby = np.abs(peak + 0.02 * rng.normal(size=(300, 3)))
        nearby /= nearby.sum(axis=1, keepdims=True)
        assert (association.log_density(a, nearby) <= association.log_density(a, peak) + 1e-12).all()
    assert np.allclose(association.mode(np.array([8.0, 4.0, 1.0])), [0.7, 0.3, 0.0])


def test_there_is_no_mode_below_one_and_none_where_all_is_even():
    assert association.mode(np.ones(3)) is None
    assert association.mode(np.full(3, sum([0.1] * 10))) is None  # ten steps of a slider
    assert association.mode(np.array([7.5, 3.5, 0.5])) is None


def test_shading_keeps_the_order_and_never_breaks():
    points, _ = pictures.triangle_points()
    for a in ([1, 1, 1], [0.2, 0.2, 0.2], [400, 1, 1], [20, 20, 20], [0.2, 20, 0.2]):
        shades = pictures.shade(np.array(a, dtype=float), points)
        assert np.isfinite(shades).all() and (shades >= 0).all() and (shades <= 1).all()
        inside = points.min(axis=1) > 0.01
        order = np.argsort(association.log_density(np.array(a, dtype=float), points[inside]))
        assert (np.diff(shades[inside][order]) >= -1e-12).all()
    assert np.allclose(pictures.shade(np.ones(3), points), 0.5)


def test_samples_have_the_mean_and_the_spread_of_the_distribution(monkeypatch):
    levels = np.random.default_rng(0).uniform(0, 1, (20_000, 3))
    monkeypatch.setattr(class_votes_explorer, "_levels", lambda: levels)
    for a in (np.array([8.0, 4.0, 1.0]), np.array([0.5, 0.5, 0.5])):
        samples, mean = class_votes_explorer.samples_of(a), a / a.sum()
        assert np.allclose(samples.sum(axis=1), 1.0)
        assert np.allclose(samples.mean(axis=0), mean, atol=0.01)
        assert np.allclose(samples.var(axis=0), mean * (1 - mean) / (a.sum() + 1), atol=0.01)


def test_the_posterior_under_a_confusion_matrix_is_bayes_rule_report_by_report():
    rng = np.random.default_rng(5)
    confusion = 0.5 * np.eye(3) + 0.5 * rng.dirichlet(np.ones(3), 3)
    belief, votes = np.full(3, 1 / 3), np.zeros(3)
    for report in rng.integers(0, 3, 12):
        belief = belief * confusion[:, report]
        belief /= belief.sum()
        votes[report] += 1
    assert np.allclose(checks.true_class(votes, confusion), belief)
    # A detector that hardly ever errs: the share of the votes, for votes of one class.
    sharp = 0.999999 * np.eye(3) + 1e-6 / 3
    assert np.allclose(checks.true_class(np.array([0.0, 4.0, 0.0]), sharp), [0, 1, 0], atol=1e-5)


# --- pictures --------------------------------------------------------------------------------------------------------


@pytest.fixture
def ax():
    return plotting.new_figure()[1]


def test_votes_are_stacked_with_their_class_and_number(ax):
    votes = np.array([[1, 2, 0, 3], [1, 0, 1, 0]])
    assert pictures.plot_votes(ax, votes, ["a", "b"], CLASSES, "t") is ax
    for column, container in enumerate(ax.containers):
        some = np.flatnonzero(votes[:, column])
        assert [bar.get_height() for bar in container] == votes[some, column].tolist()
        assert [bar.get_y() for bar in container] == votes[some, :column].sum(axis=1).tolist()
        if column:
            assert {to_hex(bar.get_facecolor()) for bar in container} == {plotting.class_style(column - 1)[0]}
        else:
            assert {bar.get_hatch() for bar in container} == {"///"}
    said = sorted(text.get_text().replace("\n", " ") for text in ax.texts)
    assert said == ["chair 2", "cup 3", "nothing 1", "nothing 1", "screen 1"]
    assert "(number)" in ax.get_ylabel()


def test_doubt_adds_one_bar_and_nothing_else():
    beta = np.array([1.0, 0.0, 2.0, 0.0])
    left, right = pictures.plot_doubt(beta, CLASSES).axes
    assert [bar.get_height() for bar in left.containers[0]] == [0, 0, 2, 0]
    assert [bar.get_height() for bar in right.containers[0]] == beta.tolist()
    assert left.get_ylim() == right.get_ylim()


def test_the_triangle_shades_its_density_and_names_its_corners(ax):
    shading = pictures.plot_triangle(ax, np.array([3.0, 1.0, 1.0]), CLASSES)
    points, _ = pictures.triangle_points()
    assert np.allclose(shading.get_array(), pictures.shade(np.array([3.0, 1.0, 1.0]), points))
    for text, corner, name in zip(ax.texts, pictures.CORNERS, CLASSES, strict=True):
        assert text.get_text() == f"{name}: 1" and np.allclose(text.xy, corner)
    assert ax.get_aspect() == 1.0
    assert "density" in ax.figure.axes[1].get_ylabel()


def test_runs_show_every_room_and_the_truth(ax):
    fields = dict.fromkeys(Metrics.__dataclass_fields__, 0)
    runs = {
        name: [Metrics(**fields | {"num_objects": n + 5 * k}) for n in (15, 16, 20)]
        for k, name in enumerate(pictures.KINDS)
    }
    pictures.plot_runs(ax, runs, num_objects_true=15)
    truth, *found = ax.lines
    assert set(truth.get_ydata()) == {15} and truth.get_linestyle() == "--"
    for k, line in enumerate(found):
        assert list(line.get_ydata()) == [15 + 5 * k, 16 + 5 * k, 20 + 5 * k]
        assert np.allclose(line.get_xdata(), np.arange(3), atol=0.2)
    assert len({line.get_marker() for line in found}) == len({line.get_color() for line in found}) == 3
    assert "(number)" in ax.get_ylabel() and "seed" in ax.get_xlabel()


def test_of_two_objects_at_one_place_the_smaller_is_drawn_again_on_top(ax):
    log, truth = simulate.toy_objects()
    *_, last = np_graph(log, alpha=0.5)
    before = len(plotting.plot_snapshot(plotting.new_figure()[1], last, log, truth).lines)
    pairs = np.array([[0, 2], [1, 3]])
    pictures.plot_doubles(ax, last, log, truth, pairs)
    _, landmarks = laid_over_truth(last, truth)
    counts = last.votes[:, 1:].sum(axis=1)
    added = ax.lines[before:]
    assert len(added) == 2 and max(line.get_zorder() for line in added) > 3
    for line, (i, j) in zip(added, pairs, strict=True):
        smaller = i if counts[i] <= counts[j] else j
        assert np.allclose(line.get_xydata(), landmarks[smaller])
    assert ax.get_title() == f"{last.num_objects} objects for 4 things: 2 pairs of two classes at one place"


@pytest.mark.parametrize("entry", figures.FIGURES, ids=lambda entry: entry.name)
def test_figure_files_are_readable(entry):
    assert entry.name[:5] in ("fig09", "fig10", "fig11") and len(entry.alt) > 60
    assert_readable(entry.draw())


def test_the_figure_of_votes_is_what_its_alternative_text_says():
    left, right = figures.votes_figure().axes
    said = [text.get_text().replace("\n", " ") for text in left.texts]
    assert sorted(said) == ["chair 2", "chair 2", "cup 1", "screen 1", "screen 2"]
    assert left.get_title().endswith("5 clusters") and right.get_title().endswith("6 clusters")
    assert "six clusters" in figures.FIGURES[0].alt
    assert "Obj_2" in [tick.get_text() for tick in right.get_xticklabels()]


# --- the explorer ----------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def explorer():
    return class_votes_explorer.explore_triangle()


def at(scene, name):
    """The middle of a mark in the triangle's units, or None where there is no such mark."""
    if name not in scene.parts:
        return None
    tag, named = scene.parts[name]
    if tag == "circle":
        middle = [float(named["cx"]), float(named["cy"])]
    elif tag == "rect":
        middle = [float(named[key]) + float(named[size]) / 2 for key, size in (("x", "width"), ("y", "height"))]
    else:
        corners = np.array([each.split(",") for each in named["points"].split()], dtype=float)
        middle = (corners.min(axis=0) + corners.max(axis=0)) / 2
    a, x0, b, y0 = triangle.TRIANGLE.scale
    return (np.array(middle) - (x0, y0)) / (a, b)


@pytest.mark.parametrize("votes", [(7, 3, 0), (0, 0, 0), (20, 20, 20), (0, 1, 0), (2, 0, 20)])
@pytest.mark.parametrize("prior", [0.2, 1.0, 2.0])
def test_the_explorer_agrees_with_the_formulas(explorer, votes, prior):
    words = explorer.move(first=votes[0], second=votes[1], third=votes[2], prior=prior)
    votes = np.array(votes, dtype=float)
    a, scene = votes + prior, explorer.scene
    assert scene.parts["density"][1]["href"] == triangle.shading(a)
    assert np.allclose(at(scene, "mean"), pictures.on_triangle(a / a.sum()), atol=1e-4)
    assert "mean " + ", ".join(f"{share:.2f}" for share in a / a.sum()) in words
    if votes.any():
        assert np.allclose(at(scene, "maximum likelihood"), pictures.on_triangle(votes / votes.sum()), atol=1e-4)
        assert "maximum likelihood " + ", ".join(f"{share:.2f}" for share in votes / votes.sum()) in words
    else:
        assert at(scene, "maximum likelihood") is None and "no maximum likelihood" in words
    exists = (a >= 1).all() and (a > 1).any()
    assert (at(scene, "mode") is not None) == exists
    if exists:
        assert np.allclose(at(scene, "mode"), pictures.on_triangle((a - 1) / (a - 1).sum()), atol=1e-4)
    assert ("no mode" in words) == (not exists)
    assert ("infinite" in words) == (a < 1).any()
    dots = np.array(re.findall(r"M(\d+),(\d+)h0", scene.parts["samples"][1]["d"]), dtype=float)
    assert len(dots) == class_votes_explorer.NUM_SAMPLES
    assert np.allclose(
        dots, triangle.TRIANGLE.to_page(pictures.on_triangle(class_votes_explorer.samples_of(a))), atol=0.51
    )


@pytest.mark.parametrize("concentration", [(8.0, 4.0, 1.0), (1.0, 1.0, 1.0), (0.5, 3.0, 9.0)])
def test_the_shading_is_as_opaque_as_the_density_is_high(concentration):
    """At points of the triangle that are looked up in the picture, within one level and one pixel."""
    a = np.array(concentration)
    content = base64.b64decode(triangle.shading(a).split(",")[1])
    opacity = np.asarray(Image.open(io.BytesIO(content)).convert("RGBA"))[..., 3] / 255
    height, width = opacity.shape
    points = np.random.default_rng(0).dirichlet(np.ones(3), 500)
    x, y = pictures.on_triangle(points).T
    column, row = (x * width).astype(int), ((1 - y / pictures.CORNERS[2, 1]) * height).astype(int)
    middle = np.column_stack([(column + 0.5) / width, (1 - (row + 0.5) / height) * pictures.CORNERS[2, 1]])
    to_shares = np.linalg.inv(np.column_stack([pictures.CORNERS, np.ones(3)]).T)
    shares = np.column_stack([middle, np.ones(500)]) @ to_shares.T
    inside = shares.min(axis=1) > 0.005
    assert inside.sum() > 400
    expected = pictures.shade(a, shares[inside])
    assert np.abs(opacity[row, column][inside] - expected).max() < 0.5 / (triangle.LEVELS - 1) + 0.005


def test_votes_are_cast_and_taken_back_by_their_rings(explorer):
    explorer.move(first=7, second=0, third=20, prior=1.0)
    rings = rings_of(explorer.scene)
    assert set(rings) == {"cast 0", "take 0", "cast 1", "take 2"}, "none below 0, none above 20"
    for name, ring in rings.items():
        ((x, y, sign),) = ring.stops
        assert sign == (">" if name.startswith("cast") else "<")
        assert ring.moves == (triangle.CONTROLS[int(name[-1])],) and not ring.follows
        if sign == ">":
            assert np.allclose((x, y), triangle.TRIANGLE.to_page(pictures.CORNERS.mean(axis=0))[0], atol=0.06)
    for c, count in enumerate((7, 0, 20)):
        assert sum(name.startswith(f"vote {c} ") for name in explorer.scene.parts) == count
        assert explorer.scene.parts[f"count {c}"][2] == f"{CLASSES[c]}: {count}"
    every_vote = [part[1] for name, part in explorer.scene.parts.items() if name.startswith("vote ")]
    assert max(float(each["cx"]) for each in every_vote if "cx" in each) < triangle.SIZE[0] - 6


def test_a_vote_can_be_dropped_anywhere_in_the_triangle_and_not_where_it_lies():
    middle = triangle.TRIANGLE.to_page(pictures.CORNERS.mean(axis=0))[0]
    corners = triangle.TRIANGLE.to_page(pictures.CORNERS)
    assert np.linalg.norm(corners - middle, axis=1).max() < triangle.REACH
    assert all(np.hypot(*(middle - (triangle.TRAY, y))) > triangle.REACH for y in triangle.ROWS)
