"""Lesson 08: its pictures, its explorer, and that every check names the mistake."""

from pathlib import Path

import numpy as np
import pytest
from exercises import assert_names_the_mistake, checks_and_solutions
from matplotlib.patches import Rectangle
from readable import assert_readable

from npslam_teach import plotting
from npslam_teach.camera import centroid_from_box, points_in_box
from npslam_teach.course.office import checks as check
from npslam_teach.course.office import explorer as widget
from npslam_teach.course.office import pictures
from npslam_teach.course.office.figures import FIGURES, PAPERS
from npslam_teach.evaluation import map_quality, valid_only
from npslam_teach.methods import METHODS
from npslam_teach.simulate.office import OFFICE_CLASSES, office
from npslam_teach.simulate.office_camera import rendered_frame_and_truth

FIGURE_FOLDER = Path(__file__).parents[2] / "figures"
CHECKS, solution = checks_and_solutions("08_office")


@pytest.fixture(scope="module")
def run():
    log, truth = office(5)
    return log, truth, {name: list(METHODS[name](log))[-1] for name in PAPERS}


@pytest.fixture(scope="module")
def frame():
    return rendered_frame_and_truth(2016, 610)


# --- exercises


def ray_length(u, v, depth, camera):
    point = solution(1)(u, v, depth, camera)
    return point * depth / np.linalg.norm(point)


def nearest_point(points):
    kept = points[points[:, 2] < points[:, 2].min() + 0.3].mean(axis=0)
    return kept[2], -kept[0]


def per_object(of_own):
    return lambda xy, labels, k: np.array([of_own(xy[labels == i], xy) for i in range(k)])


def squared(own, centre):
    return ((own - centre) ** 2).sum(axis=1)


def valid(votes, epsilon):
    return votes[:, 0] / votes.sum(axis=1) <= epsilon


WRONG = [
    (1, lambda u, v, d, c: [u / c.fx * d, v / c.fy * d, d], "optical axis goes through"),
    (1, ray_length, "length of the ray"),
    (1, lambda u, v, d, c: [(u - c.cx) * c.fx * d, (v - c.cy) * c.fy * d, d], "focal length divides"),
    (1, lambda u, v, d, c: [(u - c.cx) / c.fx, (v - c.cy) / c.fy, 1.0], "go along it"),
    (1, lambda u, v, d, c: [(v - c.cy) / c.fy * d, (u - c.cx) / c.fx * d, d], "other way round"),
    (2, lambda p: [p[:, 2].mean(), -p[:, 0].mean()], "background and all"),
    (2, lambda p: solution(2)(p) * [1, -1], "one sign is missing"),
    (2, lambda p: solution(2)(p)[::-1], "order is"),
    (2, lambda p: p[np.abs(p[:, 2] - np.quantile(p[:, 2], 0.4)) < 0.3].mean(axis=0)[:2], "first two columns"),
    (2, nearest_point, "stray reading"),
    (3, lambda b, e: (valid(b, e).sum(), b[valid(b, e)].sum()), "nobody's sighting"),
    (3, lambda b, e: ((~valid(b, e)).sum(), b[~valid(b, e), 1:].sum()), "rejected"),
    (3, lambda b, e: (valid(b, e).sum(), b[:, 1:].sum()), "all sightings are counted"),
    (3, lambda b, e: solution(3)(b, np.nextafter(e, 0)), "exactly at epsilon stays"),
    (3, lambda b, e: solution(3)(b, e)[::-1], "order is"),
    (4, lambda *a: np.sqrt(solution(4)(*a)), "standard deviation"),
    (4, lambda *a: solution(4)(*a) / 2, "their sum"),
    (4, per_object(lambda own, _: squared(own, own.mean(axis=0)).sum()), "sums"),
    (4, per_object(lambda own, _: squared(own, 0.0).mean()), "from the origin"),
    (4, per_object(lambda own, xy: squared(own, xy.mean(axis=0)).mean()), "mean of all sightings"),
    (4, per_object(lambda own, _: np.sqrt(squared(own, own.mean(axis=0))).mean()), "mean distance"),
    (5, lambda T: solution(5)(T) * [1, 1, -1], "turns the wrong way"),
    (5, lambda T: [T[2, 3], -T[0, 3], np.arctan(-T[0, 2] / T[2, 2])], "arctan2"),
    (5, lambda T: solution(5)(T) * [1, -1, 1], "points to the right"),
    (5, lambda T: [T[0, 3], T[1, 3], solution(5)(T)[2]], "first two coordinates"),
    (5, lambda T: [T[2, 3], -T[0, 3], np.arctan2(-T[0, 1], T[2, 1])], "looks along its z axis"),
    (5, lambda T: [T[2, 3], -T[0, 3], np.arctan2(-T[2, 0], T[2, 2])], "last row"),
]


@pytest.mark.parametrize(("number", "answer", "message"), WRONG)
def test_the_check_names_the_mistake(number, answer, message):
    assert_names_the_mistake(CHECKS[number], answer, message)


def test_an_angle_a_whole_turn_away_is_right():
    assert check.check_floor_pose(lambda T: solution(5)(T) + [0, 0, 2 * np.pi]).passed


def test_the_camera_of_the_check_is_a_rotation_that_looks_where_it_should():
    pose = check._camera_pose(np.zeros(3), 0.7, 0.1)[:3, :3]
    np.testing.assert_allclose(pose @ pose.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(pose) == pytest.approx(1.0)
    assert pose[1, 2] == pytest.approx(np.sin(0.1)), "looks down, and y is down"
    assert np.arctan2(-pose[0, 2], pose[2, 2]) == pytest.approx(0.7)


# --- pictures


def test_the_picture_holds_every_box(frame):
    figure, ax = plotting.new_figure()
    pictures.plot_picture(ax, frame[0], OFFICE_CLASSES, 1)
    boxes = [patch for patch in ax.patches if isinstance(patch, Rectangle)]
    drawn = [
        [b.get_x() + 0.5, b.get_y() + 0.5, b.get_x() + b.get_width() + 0.5, b.get_y() + b.get_height() + 0.5]
        for b in boxes
    ]
    np.testing.assert_allclose(drawn, frame[0].boxes)
    assert boxes[1].get_linewidth() > boxes[0].get_linewidth()
    names = {text.get_text() for text in ax.get_legend().get_texts()}
    assert names == {OFFICE_CLASSES[c] for c in frame[0].obs_class}


def test_the_depth_image_hides_what_has_no_reading(frame):
    figure, ax = plotting.new_figure()
    pictures.plot_depth(ax, frame[0])
    shown = np.ma.filled(ax.images[0].get_array(), np.nan)
    np.testing.assert_array_equal(np.isnan(shown), frame[0].depth == 0)


def test_the_view_from_above_shows_the_three_centres(frame):
    figure, ax = plotting.new_figure()
    box = frame[0].boxes[1]
    pictures.plot_box_from_above(ax, frame[0], box, frame[1].obs_xy[1])
    lines = {line.get_label(): np.column_stack(line.get_data()) for line in ax.lines}
    for use in ("mean", "median", "foreground"):
        expected = centroid_from_box(frame[0].depth, box, frame[0].intrinsics, use)
        np.testing.assert_allclose(lines[f"centre: {use}"][0], expected)
    num_points = len(points_in_box(frame[0].depth, box, frame[0].intrinsics))
    assert len(lines["background"]) + len(lines["foreground"]) == num_points
    np.testing.assert_allclose(lines["true centre"][0], frame[1].obs_xy[1])
    off = [np.linalg.norm(lines[f"centre: {use}"][0] - frame[1].obs_xy[1]) for use in ("mean", "foreground")]
    assert ax.get_title() == f"from above: mean off by {off[0]:.2f} m,\nforeground off by {off[1]:.2f} m"
    assert ax.get_aspect() == 1.0


def test_the_cloud_in_space_is_ahead_left_and_up(frame):
    figure, ax = plotting.new_figure(subplot_kw={"projection": "3d"})
    box = frame[0].boxes[1]
    pictures.plot_cloud(ax, frame[0], box)
    inside = np.column_stack(ax.collections[1]._offsets3d)
    right, down, ahead = points_in_box(frame[0].depth, box, frame[0].intrinsics).T
    np.testing.assert_allclose(inside, np.column_stack([ahead, -right, -down]))
    assert (ax.get_xlabel(), ax.get_ylabel(), ax.get_zlabel()) == ("ahead (m)", "left (m)", "up (m)")


def test_the_view_in_space_has_an_object_on_every_stem(run):
    log, truth, results = run
    last = valid_only(results["np-graph"], 0.1)
    figure = pictures.office_3d_figure({"np-graph": last}, log)
    ax = figure.axes[0]
    placed = np.concatenate([np.column_stack(scatter._offsets3d) for scatter in ax.collections])
    expected = np.column_stack([last.graph.landmarks, last.votes[:, 1:].sum(axis=1)])
    order = np.lexsort(expected.T), np.lexsort(placed.T)
    np.testing.assert_allclose(placed[order[1]], expected[order[0]])
    assert len(ax.lines) == 1 + last.num_objects
    assert ax.get_zlabel() == "sightings (number)"
    span = np.ptp([ax.get_xlim(), ax.get_ylim()], axis=1)
    assert ax._box_aspect[0] / ax._box_aspect[1] == pytest.approx(span[0] / span[1]), "a metre is a metre"


def test_the_measures_have_a_point_for_every_run(run):
    log, truth, results = run
    qualities = {name: [map_quality(snapshot, log, 0.1)] * 3 for name, snapshot in results.items()}
    figure = pictures.quality_figure(qualities, num_true=43)
    valid_objects = [line.get_xdata() for line in figure.axes[0].lines if line.get_marker() != "None"]
    assert [list(each) for each in valid_objects] == [[q.num_valid for q in runs] for runs in qualities.values()]
    assert [label.get_text() for label in figure.axes[0].get_yticklabels()] == list(results)
    assert all(ax.get_title() for ax in figure.axes)


@pytest.fixture(params=FIGURES, ids=lambda entry: entry.name)
def entry(request):
    return request.param


def test_every_text_is_inside_large_enough_and_over_no_other(entry):
    assert_readable(entry.draw())


def test_every_axis_of_the_figure_files_has_a_unit(entry):
    labels = [label for ax in entry.draw().axes for label in (ax.get_xlabel(), ax.get_ylabel()) if label]
    assert labels and all("(" in label for label in labels)


def test_the_figure_files_are_in_order():
    assert [entry.name[:5] for entry in FIGURES] == ["fig18", "fig18", "fig19", "fig19"]
    assert all(len(entry.alt) > 60 for entry in FIGURES)
    for entry in FIGURES:
        assert (FIGURE_FOLDER / f"{entry.name}.png").exists()


# --- the explorer


@pytest.fixture(scope="module")
def explorer(run):
    log, truth, results = run
    return widget.explore_office(results, log, truth)


@pytest.mark.parametrize("method", PAPERS)
@pytest.mark.parametrize("epsilon", [0.02, 0.1, 0.2, 0.33, 0.5])
def test_words_and_artists_agree_with_the_library(run, explorer, method, epsilon):
    log, _, results = run
    words = explorer.move(method=method, epsilon=epsilon)
    q = map_quality(results[method], log, epsilon)
    assert f"{q.num_valid} of {results[method].num_objects} objects are valid" in words
    assert f"hold {q.num_inliers} of {log.num_observations} sightings" in words
    update = explorer._update
    assert sum(len(scatter.get_offsets()) for scatter in update.of_class) == q.num_valid
    assert len(update.rejected.get_offsets()) == results[method].num_objects - q.num_valid
    assert update.counts[1].get_data() == ([epsilon], [q.num_valid])
    assert update.inliers[1].get_data() == ([epsilon], [q.num_inliers])
    k = np.flatnonzero(np.isclose(widget.EPSILONS, epsilon))[0]
    assert update.inliers[0].get_ydata()[k] == q.num_inliers


@pytest.mark.parametrize(
    ("epsilon", "least"), [(0.5, 1), (0.49, 2), (0.34, 2), (0.2, 4), (0.1, 9), (0.05, 19), (0.02, 49)]
)
def test_the_words_say_how_many_sightings_are_needed(run, explorer, epsilon, least):
    words = explorer.move(method="np-graph", epsilon=epsilon)
    assert f"needs {least} sighting" in words
    counts = run[2]["np-graph"].votes[:, 1:].sum(axis=1)
    assert map_quality(run[2]["np-graph"], run[0], epsilon).num_valid == np.count_nonzero(counts >= least)


def test_the_explorer_makes_no_new_artists(explorer):
    before = [len(ax.get_children()) for ax in explorer.figure.axes]
    for epsilon in (0.3, 0.03):
        explorer.move(epsilon=epsilon)
    assert [len(ax.get_children()) for ax in explorer.figure.axes] == before


def test_an_error_reaches_the_student(explorer, monkeypatch):
    explorer.move(epsilon=0.4)
    monkeypatch.setattr(widget, "map_quality", lambda *a: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        explorer.move(epsilon=0.41)
    monkeypatch.undo()
    assert "epsilon 0.42" in explorer.move(epsilon=0.42)
