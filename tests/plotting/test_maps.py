"""Single maps: what is drawn where, and how it is told from the truth."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.markers import MarkerStyle
from pictures import METHODS, is_grey, kabsch, lines_like, offsets, same_points, scatters

from npslam_teach import plotting
from npslam_teach.evaluation import evaluate
from npslam_teach.types import GroundTruth, ObservationFactors, RobotLog, Snapshot, World


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
