"""What the figures contain. Pictures are never compared with pictures: the artists in them are asked."""

import base64
import html.parser
import io
import itertools
import subprocess
import sys
from dataclasses import replace

import matplotlib
import numpy as np
import pytest
from matplotlib.collections import PathCollection
from matplotlib.colors import to_hex, to_rgb
from matplotlib.legend import Legend
from matplotlib.markers import MarkerStyle
from PIL import Image

from npslam_teach import plotting
from npslam_teach.evaluation import evaluate
from npslam_teach.methods import METHODS as ALL_METHODS
from npslam_teach.plotting import style
from npslam_teach.simulate import fifteen_objects
from npslam_teach.types import GroundTruth, ObservationFactors, RobotLog, Snapshot, World

# --- the scenes ------------------------------------------------------------------------------------------------------

METHODS = {name: method for name, method in ALL_METHODS.items() if method.in_paper}


@pytest.fixture(scope="module")
def scene():
    """The fifteen objects: log and truth."""
    return fifteen_objects()


@pytest.fixture(scope="module")
def runs(scene):
    """Every snapshot of each of the paper's methods."""
    return {name: list(METHODS[name](scene[0])) for name in METHODS}


@pytest.fixture(scope="module")
def last(runs):
    return {name: snapshots[-1] for name, snapshots in runs.items()}


@pytest.fixture
def ax():
    return plotting.new_figure()[1]


def lines_like(ax, dashed):
    """The lines of a path or a level, with or without dashes; markers alone are left out."""
    found = [line for line in ax.lines if line.get_linestyle() != "None" and len(line.get_xdata()) > 1]
    return [line for line in found if (line.get_linestyle() == "--") == dashed]


def scatters(ax, hollow):
    found = [artist for artist in ax.collections if isinstance(artist, PathCollection)]
    return [artist for artist in found if (len(artist.get_facecolors()) == 0) == hollow]


def offsets(collections):
    return np.concatenate([np.asarray(artist.get_offsets()) for artist in collections])


def same_points(a, b):
    return np.allclose(a[np.lexsort(np.asarray(a).T)], b[np.lexsort(np.asarray(b).T)], atol=1e-9)


def is_grey(color):
    return np.ptp(to_rgb(color)) < 1e-9 and 0.3 < to_rgb(color)[0] < 0.7


def kabsch(xy, reference_xy):
    """The best rigid motion by another road than the package takes: singular values."""
    mean, reference_mean = xy.mean(axis=0), reference_xy.mean(axis=0)
    u, _, vt = np.linalg.svd((xy - mean).T @ (reference_xy - reference_mean))
    flip = np.diag([1.0, np.sign(np.linalg.det(u @ vt))])
    rotation = (u @ flip @ vt).T
    return lambda points: (points - mean) @ rotation.T + reference_mean


# --- colours and markers ---------------------------------------------------------------------------------------------

# Machado, Oliveira and Fernandes 2009, severity 1, on linear RGB.
DEFICIENCIES = {
    "normal": np.eye(3),
    "deuteranopia": np.array(
        [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]]
    ),
    "protanopia": np.array(
        [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]]
    ),
}
XYZ_OF_RGB = np.array(
    [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750], [0.0193339, 0.1191920, 0.9503041]]
)


def lab(colors, deficiency="normal"):
    """(N, 3) CIELAB of sRGB colours as somebody with a deficiency sees them."""
    srgb = np.array([to_rgb(color) for color in colors])
    linear = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
    seen = np.clip(linear @ DEFICIENCIES[deficiency].T, 0, 1)
    t = seen @ XYZ_OF_RGB.T / XYZ_OF_RGB.sum(axis=1)
    f = np.where(t > 216 / 24389, np.cbrt(t), (24389 / 27 * t + 16) / 116)
    return np.stack([116 * f[:, 1] - 16, 500 * (f[:, 0] - f[:, 1]), 200 * (f[:, 1] - f[:, 2])], axis=1)


def least_distance(points):
    return min(np.linalg.norm(a - b) for a, b in itertools.combinations(points, 2))


def test_the_simulation_of_colour_blindness_does_what_it_should():
    assert np.allclose(lab(["white"], "deuteranopia"), lab(["white"]), atol=0.1)
    red_and_green = ["#c03020", "#507020"]
    for deficiency in ("deuteranopia", "protanopia"):
        assert least_distance(lab(red_and_green, deficiency)) < 0.55 * least_distance(lab(red_and_green))


# A distance of 2.3 can just be noticed side by side; 10 is a clear difference at a glance. Five classes, those of the
# lessons, are held to more than eight, for which colour alone is a weak sign on a grey printer: markers decide there.
@pytest.mark.parametrize(("num_classes", "in_colour", "in_grey"), [(5, 25.0, 12.0), (8, 20.0, 6.5)])
def test_class_colours_can_be_told_apart_by_everybody(num_classes, in_colour, in_grey):
    colors = [plotting.class_style(c)[0] for c in range(num_classes)]
    for deficiency in DEFICIENCIES:
        assert least_distance(lab(colors, deficiency)) > in_colour, deficiency
    assert least_distance(lab(colors)[:, :1]) > in_grey


def test_class_colours_stand_out_from_paper_and_from_the_path():
    colors = [plotting.class_style(c)[0] for c in range(8)]
    for background in ("white", style.ESTIMATE_COLOR):
        assert min(np.linalg.norm(lab([color])[0] - lab([background])[0]) for color in colors) > 20


def test_every_class_has_a_marker_of_its_own():
    markers = [plotting.class_style(c)[1] for c in range(8)]
    assert len(set(markers)) == 8
    assert all(MarkerStyle(marker).is_filled() for marker in markers)
    assert len({plotting.class_style(c) for c in range(64)}) == 64


def test_class_style_refuses_a_negative_class():
    with pytest.raises(ValueError, match="c: expected a class index"):
        plotting.class_style(-1)


def test_every_method_has_a_style_of_its_own():
    names = set(ALL_METHODS)
    styles = [plotting.method_style(name) for name in names]
    for key in ("color", "marker"):
        assert len({look[key] for look in styles}) == len(names)
    assert plotting.method_style("np-graph") == plotting.method_style("np-graph")
    with pytest.raises(ValueError, match="name: expected one of np-graph, .* got 'nonsense'"):
        plotting.method_style("nonsense")


def test_the_styles_of_methods_that_are_compared_differ_in_dashes_or_width():
    looks = [plotting.method_style(name) for name in METHODS]
    assert len({(look["linestyle"], look["linewidth"]) for look in looks}) == len(METHODS)
    for deficiency in DEFICIENCIES:
        assert least_distance(lab([look["color"] for look in looks], deficiency)) > 25


# --- maps ------------------------------------------------------------------------------------------------------------


def assert_is_map(ax):
    assert ax.get_aspect() == 1.0
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("x (m)", "y (m)")


@pytest.mark.parametrize("truth", [True, False])
def test_trajectory_is_dashed_grey_when_true_and_solid_otherwise(ax, truth):
    poses = np.array([[0, 0, 0], [1, 2, 0.3], [4, 3, 0.1]], dtype=float)
    assert plotting.plot_trajectory(ax, poses, truth=truth, label="path") is ax
    (line,) = ax.lines
    assert np.array_equal(line.get_xydata(), poses[:, :2])
    assert line.get_label() == "path"
    assert line.get_linestyle() == ("--" if truth else "-")
    assert is_grey(line.get_color()) == truth
    assert_is_map(ax)


def test_objects_have_the_colour_and_the_marker_of_their_class(ax):
    xy, object_class = np.array([[0, 0], [1, 1], [2, 0], [3, 3]], float), np.array([1, 0, 1, 2])
    assert plotting.plot_objects(ax, xy, object_class, ["a", "b", "c"], sizes=[1, 2, 3, 4]) is ax
    assert [artist.get_label() for artist in ax.collections] == ["a", "b", "c"]
    for c, artist in enumerate(ax.collections):
        color, marker = plotting.class_style(c)
        assert to_hex(artist.get_facecolors()[0]) == color
        shape = MarkerStyle(marker)
        expected = shape.get_path().transformed(shape.get_transform()).vertices
        assert np.allclose(artist.get_paths()[0].vertices, expected)
        assert np.array_equal(artist.get_offsets(), xy[object_class == c])
        assert np.array_equal(artist.get_sizes(), np.flatnonzero(object_class == c) + 1)
    assert_is_map(ax)


def test_true_objects_are_hollow_and_grey(ax):
    plotting.plot_objects(ax, [[0, 0], [1, 1]], [0, 1], ["a", "b"], truth=True)
    assert len(scatters(ax, hollow=True)) == 2
    assert all(is_grey(artist.get_edgecolors()[0]) for artist in ax.collections)


def test_no_objects_at_all_is_an_empty_map(ax):
    plotting.plot_objects(ax, np.empty((0, 2)), np.empty(0, int), [])
    assert not ax.collections
    assert_is_map(ax)


def test_arrows_of_the_truth_follow_the_path_whatever_the_heading(ax):
    path = np.column_stack([np.linspace(0, 5, 50), np.zeros(50), np.full(50, np.pi)])
    world = World([[1, 1]], [0], ["a"])
    plotting.plot_truth(ax, GroundTruth(world, path, []))
    assert ax.texts and all(arrow.xy[0] > arrow.xyann[0] for arrow in ax.texts)


def test_truth_of_a_robot_that_stands_still(ax):
    world = World([[1, 1]], [0], ["a"])
    plotting.plot_truth(ax, GroundTruth(world, np.zeros((3, 3)), []))
    assert not ax.texts


def test_view_is_the_sector_of_the_sensor(ax):
    plotting.plot_view(ax, np.array([1.0, 2.0, np.pi / 2]), 4.0, np.deg2rad(120))
    (wedge,) = ax.patches
    assert (wedge.center, wedge.r) == ((1.0, 2.0), 4.0)
    assert np.allclose([wedge.theta1, wedge.theta2], [30, 150])
    assert ax.get_ylim()[1] >= 6.0


def test_view_of_a_full_circle(ax):
    plotting.plot_view(ax, np.zeros(3), 2.0, 7.0)
    assert ax.patches[0].theta2 - ax.patches[0].theta1 == 360.0


def test_truth_figure_shows_path_start_direction_and_objects(ax, scene):
    truth = scene[1]
    assert plotting.plot_truth(ax, truth) is ax
    (path,) = lines_like(ax, dashed=True)
    assert np.array_equal(path.get_xydata(), truth.poses[:, :2])
    assert is_grey(path.get_color())
    assert same_points(offsets(scatters(ax, hollow=False)), truth.world.object_xy)
    legend = [text.get_text() for text in ax.get_legend().get_texts()]
    assert legend == [*truth.world.class_names, "true path", "start"]
    (start,) = [line for line in ax.lines if line.get_linestyle() == "None"]
    assert np.array_equal(start.get_xydata(), truth.poses[:1, :2])
    assert len(ax.texts) >= 5
    for arrow in ax.texts:
        tail, head = (np.argmin(np.linalg.norm(truth.poses[:, :2] - end, axis=1)) for end in (arrow.xyann, arrow.xy))
        assert 0 < head - tail < 20
    assert ax.get_title() == "truth: 15 objects, 5 classes"
    assert_is_map(ax)


@pytest.mark.parametrize(("index", "title"), [(0, "frame by frame: 1185 objects"), (1, "iteration 1: 43 objects")])
def test_snapshot_is_laid_over_the_truth(ax, scene, runs, index, title):
    (log, truth), snapshot = scene, runs["np-graph"][index]
    assert plotting.plot_snapshot(ax, snapshot, log, truth) is ax
    motion = kabsch(snapshot.graph.poses[:, :2], truth.poses[:, :2])
    (estimate,), (true_path,) = lines_like(ax, dashed=False), lines_like(ax, dashed=True)
    assert np.allclose(estimate.get_xydata(), motion(snapshot.graph.poses[:, :2]), atol=1e-9)
    assert np.array_equal(true_path.get_xydata(), truth.poses[:, :2])
    assert same_points(offsets(scatters(ax, hollow=False)), motion(snapshot.graph.landmarks))
    assert same_points(offsets(scatters(ax, hollow=True)), truth.world.object_xy)
    assert true_path.get_zorder() < estimate.get_zorder()
    assert max(a.get_zorder() for a in scatters(ax, True)) < min(a.get_zorder() for a in scatters(ax, False))
    assert ax.get_title() == title
    assert_is_map(ax)


def test_the_error_seen_in_the_map_is_the_error_in_the_table(ax, scene, last):
    (log, truth), snapshot = scene, last["robust-slam"]
    plotting.plot_snapshot(ax, snapshot, log, truth)
    drawn = lines_like(ax, dashed=False)[0].get_xydata()
    error = np.linalg.norm(drawn - truth.poses[:, :2], axis=1).mean()
    assert error == pytest.approx(evaluate(snapshot, truth, log).mean_pose_error)


def test_snapshot_without_truth_stays_where_it_is(ax, scene, runs):
    log, snapshot = scene[0], runs["np-graph"][2]
    plotting.plot_snapshot(ax, snapshot, log)
    (line,) = ax.lines
    assert np.array_equal(line.get_xydata(), snapshot.graph.poses[:, :2])
    assert same_points(offsets(ax.collections), snapshot.graph.landmarks)
    labels = [text.get_text() for text in ax.get_legend().get_texts()]
    assert labels == [f"class {c}" for c in range(5)] + ["estimated path"]


def test_snapshot_colours_an_object_by_most_votes_whatever_the_false_positive_vote(ax):
    log = RobotLog([[1, 0, 0]], [0, 0, 1, 1], [[1, 0]] * 4, [2, 0, 2, 1], 3, [0.1] * 3, [0.1] * 2)
    start = next(iter(METHODS["frame-by-frame"](log)))
    graph = replace(start.graph, landmarks=[[1.0, 0.0], [2.0, 0.0]], observations=empty_observations())
    snapshot = Snapshot(3, [0, 0, 0, 1], [[9, 1, 0, 2], [1, 0, 1, 0]], graph, 0.0, 0.0)
    plotting.plot_snapshot(ax, snapshot, log, class_names=["a", "b", "c"])
    by_name = {artist.get_label(): artist for artist in ax.collections}
    assert set(by_name) == {"b", "c"}
    assert np.array_equal(by_name["c"].get_offsets(), [[1.0, 0.0]])
    assert by_name["c"].get_sizes()[0] > by_name["b"].get_sizes()[0]
    assert ax.get_title() == "iteration 3: 2 objects"


def empty_observations():
    return ObservationFactors([], [], np.empty((0, 2)), np.empty((0, 2, 2)))


def test_marker_size_grows_with_the_number_of_observations(ax, scene, runs):
    log, snapshot = scene[0], runs["np-graph"][1]
    plotting.plot_snapshot(ax, snapshot, log)
    counts = np.bincount(snapshot.labels, minlength=snapshot.num_objects)
    size_at = {}
    for artist in ax.collections:
        size_at |= {tuple(xy): s for xy, s in zip(np.asarray(artist.get_offsets()), artist.get_sizes(), strict=True)}
    sizes = np.array([size_at[tuple(xy)] for xy in snapshot.graph.landmarks])
    order = np.argsort(counts)
    assert len(np.unique(counts)) > 5
    assert np.array_equal(np.diff(counts[order]) > 0, np.diff(sizes[order]) > 1e-9)


def test_a_thousand_singletons_are_small_and_translucent(ax, scene, runs):
    plotting.plot_snapshot(ax, runs["np-graph"][0], scene[0])
    for artist in ax.collections:
        assert artist.get_sizes().max() < 20  # pt^2
        assert artist.get_facecolors()[:, 3].max() < 0.7


def test_class_names_must_be_enough(ax, scene, last):
    with pytest.raises(ValueError, match="class_names: expected a name for each of 5 classes, got 2"):
        plotting.plot_snapshot(ax, last["np-graph"], scene[0], class_names=["a", "b"])


# --- several panels --------------------------------------------------------------------------------------------------


def panels(figure):
    return [ax for ax in figure.axes if ax.axison]


def titles(figure):
    return [ax.get_title() for ax in panels(figure)]


def legend_texts(figure):
    (legend,) = figure.findobj(Legend)
    return [text.get_text() for text in legend.get_texts()]


def test_iterations_side_by_side(scene, runs):
    (log, truth), snapshots = scene, runs["np-graph"]
    figure = plotting.plot_iterations(iter(snapshots), log, truth)
    counts = [snapshot.num_objects for snapshot in snapshots]
    names = ["frame by frame"] + [f"iteration {k}" for k in range(1, len(snapshots))]
    assert titles(figure) == [f"{name}\n{count} objects" for name, count in zip(names, counts, strict=True)]
    for ax, snapshot in zip(panels(figure), snapshots, strict=True):
        assert len(offsets(scatters(ax, hollow=False))) == snapshot.num_objects
        assert ax.get_aspect() == 1.0
    assert len({(ax.get_xlim(), ax.get_ylim()) for ax in panels(figure)}) == 1
    assert legend_texts(figure) == [*truth.world.class_names, "estimated path", "true path", "true object"]


def test_many_iterations_leave_out_the_middle_and_keep_the_last(scene, runs):
    log, snapshot = scene[0], runs["np-graph"][-1]
    figure = plotting.plot_iterations([replace(snapshot, iteration=k) for k in range(10)], log)
    assert [title.split("\n")[0] for title in titles(figure)] == [
        "frame by frame",
        *(f"iteration {k}" for k in (1, 2, 3, 4, 9)),
    ]


@pytest.mark.parametrize("count", [1, 2, 3, 4, 5, 6])
def test_the_outer_panels_carry_labels_and_numbers(scene, runs, count):
    log, snapshot = scene[0], runs["np-graph"][-1]
    figure = plotting.plot_iterations([snapshot] * count, log)
    figure.draw_without_rendering()
    boxes = {ax: ax.get_window_extent() for ax in panels(figure)}
    assert len(boxes) == count
    for ax, box in boxes.items():
        below = any(np.isclose(b.x0, box.x0, atol=2) and b.y1 <= box.y0 for b in boxes.values())
        left = any(np.isclose(b.y0, box.y0, atol=2) and b.x1 <= box.x0 for b in boxes.values())
        assert ax.get_xlabel() == ("" if below else "x (m)")
        assert ax.get_ylabel() == ("" if left else "y (m)")
        assert any(label.get_visible() for label in ax.get_xticklabels()) == (not below)
        assert any(label.get_visible() for label in ax.get_yticklabels()) == (not left)


def test_methods_side_by_side(scene, last):
    (log, truth), names = scene, scene[1].world.class_names
    figure = plotting.plot_methods(last, log, truth, names)
    assert titles(figure) == [f"{name}: {snapshot.num_objects} objects" for name, snapshot in last.items()]
    assert len({round(ax.get_position().x0, 3) for ax in panels(figure)}) == 2
    for ax, snapshot in zip(panels(figure), last.values(), strict=True):
        motion = kabsch(snapshot.graph.poses[:, :2], truth.poses[:, :2])
        drawn = lines_like(ax, dashed=False)[0].get_xydata()
        assert np.allclose(drawn, motion(snapshot.graph.poses[:, :2]), atol=1e-9)
        assert len(offsets(scatters(ax, hollow=False))) == snapshot.num_objects


def test_maps_fill_the_figure_whatever_their_shape():
    world = World([[0, 0], [12, 4]], [0, 0], ["a"])
    truth = GroundTruth(world, [[0, 0, 0], [12, 4, 0]], [0])
    log = RobotLog([[12, 4, 0]], [0], [[1, 1]], [0], 1, [0.1] * 3, [0.1] * 2)
    figure = plotting.plot_iterations(list(METHODS["np-graph"](log))[:1] * 4, log, truth)
    figure.draw_without_rendering()
    covered = sum(np.prod(ax.get_window_extent().size) for ax in panels(figure))
    assert covered > 0.35 * np.prod(figure.bbox.size)


@pytest.mark.parametrize("draw", [plotting.plot_iterations, plotting.animate])
def test_nothing_to_draw_is_an_error(scene, draw):
    with pytest.raises(ValueError, match="snapshots: expected at least one snapshot, got none"):
        draw([], scene[0])
    with pytest.raises(ValueError, match="last_snapshots: expected at least one"):
        plotting.plot_methods({}, scene[0])


# --- curves ----------------------------------------------------------------------------------------------------------


def test_object_counts_are_written_at_their_points(ax, runs):
    snapshots = runs["np-graph"]
    assert plotting.plot_object_counts(ax, iter(snapshots), 15) is ax
    (curve,), (level,) = lines_like(ax, dashed=False), lines_like(ax, dashed=True)
    counts = [snapshot.num_objects for snapshot in snapshots]
    assert np.array_equal(curve.get_xydata(), np.column_stack([range(len(counts)), counts]))
    assert [text.get_text() for text in ax.texts] == [str(count) for count in counts]
    assert [text.xy for text in ax.texts] == list(enumerate(counts))
    assert set(level.get_ydata()) == {15} and is_grey(level.get_color())
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["true number: 15"]
    assert ax.get_yscale() == "log"
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("iteration (number)", "objects (number, log scale)")


def test_object_counts_are_written_where_they_can_be_read(ax, runs):
    plotting.plot_object_counts(ax, runs["np-graph"], 15)
    ax.figure.draw_without_rendering()
    corners = ax.transData.transform(lines_like(ax, dashed=False)[0].get_xydata())
    along = np.linspace(0, 1, 200)[:, None]
    curve = np.concatenate([a + along * (b - a) for a, b in itertools.pairwise(corners)])
    for text, corner in zip(ax.texts, corners, strict=True):
        box, frame = text.get_window_extent(), ax.get_window_extent()
        assert not ((curve > box.min) & (curve < box.max)).all(axis=1).any()
        assert (box.min > frame.min).all() and (box.max < frame.max).all()
        assert np.linalg.norm(box.min - corner) < 20  # pixels


def test_object_counts_where_the_truth_is_unknown(ax, runs):
    plotting.plot_object_counts(ax, runs["np-graph"])
    assert not lines_like(ax, dashed=True) and ax.get_legend() is None


def test_objective_per_iteration(ax, runs):
    snapshots = runs["np-graph"]
    assert plotting.plot_objective(ax, snapshots) is ax
    assert np.array_equal(ax.lines[0].get_ydata(), [snapshot.objective for snapshot in snapshots])
    assert np.array_equal(ax.lines[0].get_xdata(), [snapshot.iteration for snapshot in snapshots])
    assert ax.get_ylabel() == "objective (nats)"
    ax.figure.draw_without_rendering()
    assert all(float(tick).is_integer() for tick in ax.get_xticks())


def test_cumulative_error_of_every_method(ax, scene, last):
    log, truth = scene
    assert plotting.plot_cumulative_error(ax, last, truth) is ax
    for line, (name, snapshot) in zip(ax.lines, last.items(), strict=True):
        drawn = kabsch(snapshot.graph.poses[:, :2], truth.poses[:, :2])(snapshot.graph.poses[:, :2])
        errors = np.linalg.norm(drawn - truth.poses[:, :2], axis=1)
        assert np.allclose(line.get_ydata(), [errors[: t + 1].sum() for t in range(len(errors))])
        assert line.get_ydata()[-1] == pytest.approx(evaluate(snapshot, truth, log).cumulative_pose_error)
        assert (line.get_label(), line.get_color()) == (name, plotting.method_style(name)["color"])
        assert line.get_marker() == plotting.method_style(name)["marker"]
    assert ax.get_yscale() == "log"
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("pose t (index)", "cumulative trajectory error (m, log scale)")


@pytest.mark.parametrize("names", [("open-loop", "frame-by-frame"), ("frame-by-frame", "open-loop")])
def test_curves_that_coincide_are_both_seen(ax, scene, last, names):
    plotting.plot_cumulative_error(ax, {name: last[name] for name in names}, scene[1])
    line = {artist.get_label(): artist for artist in ax.lines}
    thin, wide = line["open-loop"], line["frame-by-frame"]
    assert np.allclose(thin.get_ydata(), wide.get_ydata())
    assert thin.get_zorder() > wide.get_zorder()
    assert wide.get_linewidth() >= 2.5 * thin.get_linewidth()
    assert thin.get_linestyle() == "--"  # the wide one shows between the dashes, too
    first_markers = {artist.get_markevery()[0] for artist in ax.lines}
    assert len(first_markers) == 2


def test_error_against_objects(ax, scene, last):
    log, truth = scene
    assert plotting.plot_error_against_objects(ax, last, truth) is ax
    level, *points = ax.lines
    assert set(level.get_xdata()) == {15} and level.get_linestyle() == "--" and is_grey(level.get_color())
    for point, (name, snapshot) in zip(points, last.items(), strict=True):
        expected = (snapshot.num_objects, evaluate(snapshot, truth, log).mean_object_error)
        assert np.allclose(point.get_xydata(), [expected])
        assert (point.get_label(), point.get_marker()) == (name, plotting.method_style(name)["marker"])
    assert ax.get_xscale() == "log" and ax.get_ylim()[0] == 0
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("objects found (number, log scale)", "mean object error (m)")


def test_a_perfect_trajectory_draws_without_complaint(ax):
    world = World([[1, 1]], [0], ["a"])
    truth = GroundTruth(world, [[0, 0, 0], [1, 0, 0], [2, 0, 0]], [0])
    log = RobotLog([[1, 0, 0], [1, 0, 0]], [0], [[1, 1]], [0], 1, [0.1] * 3, [0.1] * 2)
    exact = {"np-graph": list(METHODS["np-graph"](log))[-1]}
    plotting.plot_cumulative_error(ax, exact, truth)
    ax.figure.draw_without_rendering()
    plotting.plot_error_against_objects(plotting.new_figure()[1], exact, truth)


def test_a_method_that_used_no_observation_has_no_point(ax, scene, last):
    unused = replace(last["np-graph"], labels=np.full_like(last["np-graph"].labels, -1))
    plotting.plot_error_against_objects(ax, {"np-graph": unused}, scene[1])
    assert len(ax.lines) == 1


# --- layout: every kind of figure ------------------------------------------------------------------------------------


def on_axes(draw, *arguments):
    figure, ax = plotting.new_figure()
    draw(ax, *arguments)
    return figure


FIGURES = {
    "truth": lambda log, truth, runs, last: on_axes(plotting.plot_truth, truth),
    "start": lambda log, truth, runs, last: on_axes(plotting.plot_snapshot, runs["np-graph"][0], log, truth),
    "end": lambda log, truth, runs, last: on_axes(plotting.plot_snapshot, last["np-graph"], log, truth),
    "iterations": lambda log, truth, runs, last: plotting.plot_iterations(runs["np-graph"], log, truth),
    "four": lambda log, truth, runs, last: plotting.plot_iterations(runs["np-graph"][:4], log, truth),
    "methods": lambda log, truth, runs, last: plotting.plot_methods(last, log, truth),
    "counts": lambda log, truth, runs, last: on_axes(plotting.plot_object_counts, runs["np-graph"], 15),
    "objective": lambda log, truth, runs, last: on_axes(plotting.plot_objective, runs["np-graph"]),
    "trajectory": lambda log, truth, runs, last: on_axes(plotting.plot_cumulative_error, last, truth),
    "objects": lambda log, truth, runs, last: on_axes(plotting.plot_error_against_objects, last, truth),
}


@pytest.fixture(params=FIGURES, scope="module")
def figure(request, scene, runs, last):
    made = FIGURES[request.param](*scene, runs, last)
    made.draw_without_rendering()
    return made


def drawn_texts(figure):
    """Every text that is really seen: not the numbers of ticks beyond the ends of an axis."""
    texts = [text for legend in figure.findobj(Legend) for text in legend.get_texts()]
    for ax in panels(figure):
        texts += [ax.title, ax.xaxis.label, ax.yaxis.label, *ax.texts]
        for axis in (ax.xaxis, ax.yaxis):
            low, high = sorted(axis.get_view_interval())
            ticks = axis.get_major_ticks(len(axis.get_majorticklocs()))
            texts += [tick.label1 for tick in ticks if low <= tick.get_loc() <= high and tick.label1.get_visible()]
    return [text for text in texts if text.get_visible() and text.get_text().strip()]


def test_no_label_is_cut_off(figure):
    for text in drawn_texts(figure):
        box = text.get_window_extent()
        assert box.x0 >= 0 and box.y0 >= 0, text
        assert box.x1 <= figure.bbox.x1 and box.y1 <= figure.bbox.y1, text


def test_no_two_texts_overlap(figure):
    for a, b in itertools.combinations(drawn_texts(figure), 2):
        assert not a.get_window_extent().overlaps(b.get_window_extent()), (a, b)


def test_no_legend_covers_data(figure):
    for legend in figure.findobj(Legend):
        covered = legend.get_window_extent()
        for ax in panels(figure):
            points = [ax.transData.transform(line.get_xydata()) for line in lines_like(ax, dashed=False)]
            points += [ax.transData.transform(a.get_offsets()) for a in scatters(ax, hollow=False)]
            points = np.concatenate([*points, np.empty((0, 2))])
            assert not ((points > covered.min) & (points < covered.max)).all(axis=1).any()


def test_every_text_can_be_read_from_the_back_of_the_room(figure):
    assert min(text.get_fontsize() for text in drawn_texts(figure)) >= 11


def test_every_axis_names_its_unit(figure):
    labels = [label for ax in panels(figure) for label in (ax.get_xlabel(), ax.get_ylabel())]
    labels = [label for label in labels if label]
    assert len(labels) >= 2
    assert all(label.endswith(")") and "(" in label for label in labels)


def test_pyplot_holds_no_figure(figure):
    import matplotlib.pyplot as plt

    assert plt.get_fignums() == []


def test_pyplot_is_not_even_loaded():
    program = (
        "import sys; from npslam_teach import plotting as p; from npslam_teach.simulate import fifteen_objects;"
        "figure, ax = p.new_figure(); p.plot_truth(ax, fifteen_objects()[1]); figure.draw_without_rendering();"
        "assert 'matplotlib.pyplot' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", program], check=True)


# --- output ----------------------------------------------------------------------------------------------------------


def test_saved_files_are_the_same_on_every_run(tmp_path, scene, runs):
    def contents(name):
        figure = on_axes(plotting.plot_snapshot, runs["np-graph"][1], *scene)
        paths = plotting.save(figure, tmp_path / name)
        assert [path.name for path in paths] == [f"{name}.png", f"{name}.svg"]
        return [path.read_bytes() for path in paths]

    first = contents("first.figure")  # a dot in the name is not a suffix
    with matplotlib.rc_context({"svg.hashsalt": "mine", "savefig.bbox": "tight", "savefig.dpi": 30}):
        second = contents("second")
    assert first == second
    assert first[0].startswith(b"\x89PNG") and b"<svg" in first[1]
    assert b"dc:date" not in first[1] and b"Matplotlib" not in first[0] + first[1]
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        f"{name}.{suffix}" for name in ("first.figure", "second") for suffix in ("png", "svg")
    ]


def test_saved_files_replace_older_ones_whole(tmp_path):
    (tmp_path / "figure.png").write_bytes(b"old" * 100_000)
    plotting.save(plotting.new_figure()[0], tmp_path / "figure")
    picture = Image.open(io.BytesIO((tmp_path / "figure.png").read_bytes()))
    assert picture.size == (7 * 125, int(5.5 * 125))
    with pytest.raises(FileNotFoundError, match="no folder"):
        plotting.save(plotting.new_figure()[0], tmp_path / "missing" / "figure")


class FirstTag(html.parser.HTMLParser):
    def handle_starttag(self, tag, attributes):
        self.tag, self.attributes = tag, dict(attributes)


def parsed(shown):
    parser = FirstTag()
    parser.feed(shown.data)
    media_type, data = parser.attributes["src"].removeprefix("data:").split(";base64,")
    return parser, media_type, base64.b64decode(data, validate=True)


def test_show_is_an_image_with_alternative_text():
    alt = 'The "true" path & <b>15</b> objects,\n  d < 1 m\'s'
    figure = plotting.new_figure(size=(7.0, 5.5))[0]
    parser, media_type, data = parsed(plotting.show(figure, alt))
    assert parser.tag == "img"
    assert parser.attributes["alt"] == " ".join(alt.split())
    assert parser.attributes["style"] == "max-width:100%"
    assert media_type == "image/png"
    picture = Image.open(io.BytesIO(data))
    assert picture.width / picture.height == pytest.approx(7.0 / 5.5, rel=0.01)
    assert int(parser.attributes["width"]) == 7 * 96 < picture.width


@pytest.mark.parametrize("alt", ["", "  \n"])
def test_show_refuses_a_picture_without_words(alt):
    for show, picture in ((plotting.show, plotting.new_figure()[0]), (plotting.show_animation, b"")):
        with pytest.raises(ValueError, match="alt: expected a sentence"):
            show(picture, alt)


def test_pictures_in_notebooks_are_small_and_true_to_their_colours(figure):
    figure.set_layout_engine("none")  # the layout moves by a hair whenever it is computed again
    data = parsed(plotting.show(figure, "a figure"))[2]
    assert 10_000 < len(data) < 120_000
    stream = io.BytesIO()
    figure.savefig(stream, dpi=125)
    exact = np.asarray(Image.open(stream).convert("RGB")).astype(int)
    shown = np.asarray(Image.open(io.BytesIO(data)).convert("RGB")).astype(int)
    assert np.abs(exact - shown).max() <= 20  # of 255


@pytest.fixture(scope="module")
def gif(scene, runs):
    return plotting.animate(iter(runs["np-graph"]), *scene)


def frames(gif):
    picture = Image.open(io.BytesIO(gif))
    for k in range(picture.n_frames):
        picture.seek(k)
        yield picture.info["duration"], np.asarray(picture.convert("RGB")).astype(int)


def test_animation_has_a_frame_per_iteration_and_rests_on_the_last(gif, runs):
    durations = [duration for duration, _ in frames(gif)]
    assert durations == [1200] * (len(runs["np-graph"]) - 1) + [2500]
    assert Image.open(io.BytesIO(gif)).info["loop"] == 0  # for ever
    assert len(gif) < 400_000


def test_animation_is_the_same_on_every_run(gif, scene, runs):
    assert plotting.animate(runs["np-graph"], *scene) == gif


def test_animation_keeps_its_axes_still_while_the_estimate_moves(gif):
    pictures = [picture for _, picture in frames(gif)]

    def long_dark_lines(picture):
        dark = (picture < 60).all(axis=2)
        return [np.flatnonzero(dark.mean(axis=k) > 0.6).tolist() for k in (0, 1)]

    assert all(len(lines) == 2 for lines in long_dark_lines(pictures[0]))  # the four sides of the map
    assert all(long_dark_lines(picture) == long_dark_lines(pictures[0]) for picture in pictures)
    # The numbers on the axes stand still too: so does everything below the map.
    bottom = long_dark_lines(pictures[0])[1][1]
    assert all(np.abs(picture[bottom + 2 :] - pictures[0][bottom + 2 :]).max() <= 20 for picture in pictures)
    assert all((a != b).any() for a, b in itertools.pairwise(pictures))


def test_animation_shows_everything_in_every_frame(monkeypatch):
    log = RobotLog([[1, 0, 0]], [0, 1, 1], [[9, 0], [8, 0.1], [0, 7]], [0, 0, 0], 1, [0.1] * 3, [0.1] * 2)
    truth = GroundTruth(World([[9, 0], [1, 7], [-5, -5]], [0, 0, 0], ["a"]), [[0, 0, 0], [1, 0, 0]], [0, 0, 1])
    monkeypatch.setattr("npslam_teach.plotting.panels.gif_bytes", lambda figures, durations: figures)
    snapshots = list(METHODS["np-graph"](log))
    moved = replace(snapshots[-1], graph=replace(snapshots[-1].graph, landmarks=[[-20.0, 0.0], [1.0, 30.0]]))
    maps = [panels(figure)[0] for figure in plotting.animate([*snapshots, moved], log, truth)]
    assert len({(ax.get_xlim(), ax.get_ylim()) for ax in maps}) == 1
    for ax in maps:
        points = np.concatenate([line.get_xydata() for line in ax.lines] + [offsets(ax.collections)])
        (left, right), (bottom, top) = ax.get_xlim(), ax.get_ylim()
        assert (points > [left, bottom]).all() and (points < [right, top]).all()


def test_animation_keeps_the_colours_of_the_classes(gif):
    for _, picture in frames(gif):
        for c in range(5):
            wanted = np.rint(255 * np.array(to_rgb(plotting.class_style(c)[0])))
            close = np.abs(picture - wanted).max(axis=2) <= 12
            assert np.count_nonzero(close) > 20, c


def test_animation_in_a_notebook(gif):
    parser, media_type, data = parsed(plotting.show_animation(gif, "1185 objects become 15"))
    assert (media_type, data, parser.attributes["alt"]) == ("image/gif", gif, "1185 objects become 15")


def test_everything_public_is_there():
    assert all(callable(getattr(plotting, name)) for name in plotting.__all__)
