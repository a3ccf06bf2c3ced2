"""Lesson 02: its pictures contain what they should, its slider tells the truth, its checks know the usual mistakes."""

import re

import numpy as np
import pytest
from exercises import assert_names_the_mistake, checks_and_solutions
from matplotlib.text import Annotation
from readable import assert_readable
from rings import assert_rings_lie_where_they_are_led

from npslam_teach import dead_reckoning, evaluation, plotting, se2, simulate, toy_objects
from npslam_teach.course.drift import explorer as drift_explorer
from npslam_teach.course.drift import figures, heading, pictures
from npslam_teach.plotting import uncertainty

# --- exercises -------------------------------------------------------------------------------------------------------

CHECKS, solution = checks_and_solutions("02_drift")


def rotation(theta):
    return np.array([[np.cos(theta), -np.sin(theta)], [np.sin(theta), np.cos(theta)]])


def pose_of(xy, theta):
    return np.array([*xy, theta])


def chained(odometry, start, step):
    path = [start]
    for each in odometry:
        path.append(step(path[-1], each))
    return np.array(path)


def covariance(pose, cov, xy, std, swing=1.0, square=2, turn_camera=True):
    turn = rotation(pose[2])
    dx, dy = turn @ xy
    by_pose = np.array([[1, 0, -swing * dy], [0, 1, swing * dx]])
    camera = np.diag(std**square)
    return by_pose @ cov @ by_pose.T + (turn @ camera @ turn.T if turn_camera else camera)


WRONG = [
    (1, lambda p, o: pose_of(p[:2] + rotation(p[2]) @ o[:2], p[2] + o[2]), "not wrapped"),
    (1, lambda p, o: se2.compose(o, p), "wrong order"),
    (1, lambda p, o: pose_of(p[:2] + o[:2], p[2] + o[2]), "nothing is turned"),
    (1, lambda p, o: pose_of(p[:2] + rotation(-p[2]) @ o[:2], p[2] + o[2]), "wrong way round"),
    (1, lambda p, o: pose_of(p[:2] + rotation(p[2]) @ o[:2], p[2]), "never turns"),
    (1, lambda p, o: pose_of(p[:2] + rotation(p[2] + o[2]) @ o[:2], p[2] + o[2]), "new heading"),
    (1, lambda p, o: se2.compose(p, o) + [0, 0, 0.1], "its angle is not"),
    (1, lambda p, o: se2.compose(p, o) + [0.1, 0, 0], "the position of your pose is off"),
    (1, lambda p, o: (p + o)[:2], "shape (3,), yours has (2,)"),
    (2, lambda a, b: pose_of(rotation(-a[2]) @ (b - a)[:2], b[2] - a[2]), "not wrapped"),
    (2, lambda a, b: b - a, "room's directions"),
    (2, lambda a, b: pose_of(rotation(a[2]) @ (b - a)[:2], b[2] - a[2]), "wrong way round"),
    (2, lambda a, b: se2.between(b, a), "swapped"),
    (2, lambda a, b: se2.compose(a, b), "that was compose"),
    (3, lambda o, s: chained(o, s, lambda p, q: se2.compose(q, p)), "wrong order"),
    (3, lambda o, s: chained(o, s, np.add), "nothing is turned"),
    (3, lambda o, s: chained(o, s, se2.compose)[1:], "start itself is missing"),
    (3, lambda o, s: chained(o, np.zeros(3), se2.compose), "origin"),
    (3, lambda o, s: chained(o, pose_of(s[:2], 0), se2.compose), "heading of the start"),
    (
        3,
        lambda o, s: chained(o, s, lambda p, q: pose_of(p[:2] + rotation(p[2]) @ q[:2], p[2] + q[2])),
        "not wrapped",
    ),
    (4, lambda p, z: p[:2] + z, "nothing is turned"),
    (4, lambda p, z: p[:2] + rotation(-p[2]) @ z, "wrong way round"),
    (4, lambda p, z: rotation(p[2]) @ z, "own position is missing"),
    (4, lambda p, z: 2 * p[:2] + z, "is off"),
    (4, se2.apply_inverse, "the way back"),
    (5, lambda *a: covariance(*a, swing=0.0), "left out"),
    (5, lambda *a: covariance(*a, swing=-1.0), "wrong sign"),
    (5, lambda *a: covariance(*a, square=1), "squared"),
    (5, lambda *a: covariance(*a, turn_camera=False), "not turned into the room"),
    (5, lambda p, c, z, std: c[:2, :2], "is off"),
]


@pytest.mark.parametrize(("number", "mistake", "message"), WRONG)
def test_usual_mistakes_are_named(number, mistake, message):
    assert_names_the_mistake(CHECKS[number], mistake, message)


def test_exercise_5_is_what_the_pose_graph_says():
    """The marginal covariance of a landmark seen once, from another road."""
    from npslam_teach import frame_by_frame, marginal_covariance

    log, _ = toy_objects()
    (start,) = frame_by_frame(log, log.odometry_std, log.observation_std)
    poses, objects = marginal_covariance(start.graph, range(log.num_poses), range(log.num_observations))
    for k, t in enumerate(log.obs_time):
        landed = solution(5)(start.graph.poses[t], poses[t], log.obs_xy[k], log.observation_std)
        np.testing.assert_allclose(landed, objects[k], atol=1e-12)


# --- pictures --------------------------------------------------------------------------------------------------------


@pytest.fixture
def figure_5():
    figure = figures.frame_by_frame_figure()
    figure.draw_without_rendering()
    return figure


def names_in(ax):
    return [text for text in ax.texts if isinstance(text, Annotation) and text.get_visible()]


def test_figure_5_shows_eight_objects_where_the_wheels_put_them(figure_5):
    log, _ = toy_objects()
    poses = dead_reckoning(log.odometry)
    left, right = figure_5.axes
    assert [text.get_text() for text in names_in(right)] == [f"Obj_{k}" for k in range(1, 9)]
    seen_at = se2.apply(poses[log.obs_time], log.obs_xy)
    np.testing.assert_allclose([text.xy for text in names_in(right)], seen_at)
    assert names_in(left) == []
    assert any(np.array_equal(line.get_xydata(), poses[:, :2]) for line in right.lines)
    assert any(line.get_linestyle() == "--" for line in right.lines)
    drawn = np.concatenate([artist.get_offsets() for artist in right.collections if len(artist.get_facecolors())])
    assert {tuple(xy) for xy in drawn.round(9)} == {tuple(xy) for xy in seen_at.round(9)}


def two_orders():
    figure, ax = plotting.new_figure(size=(7, 3.6))
    pictures.plot_two_orders(ax, np.array([[2, 0, 0], [0, 0, np.pi / 2]]), ("drive, then turn", "turn, then drive"))
    return figure


def clouds():
    figure, ax = plotting.new_figure(size=(11, 5))
    for x in (5.0, 40.0):
        pictures.plot_cloud(ax, np.random.default_rng(0).normal((x, 0), (0.2, 1.0), (50, 2)), [x, 0], np.diag([0.1, 1]))
    return figure


def growth():
    figure, ax = plotting.new_figure(size=(10, 4.5))
    pictures.plot_growth(ax, np.arange(10.0), np.arange(30.0).reshape(3, 10))
    return figure


def explored():
    figure = drift_explorer.explore_noise().figure
    return figure


@pytest.mark.parametrize("draw", [figures.frame_by_frame_figure, two_orders, clouds, growth, explored])
def test_texts_are_whole_apart_large_and_axes_have_units(draw):
    figure = draw()
    assert_readable(figure)
    for ax in figure.axes:
        labels = [label for label in (ax.get_xlabel(), ax.get_ylabel()) if label]
        assert labels and all(re.search(r"\(.+\)$", label) for label in labels)
        if draw is not growth:
            assert ax.get_aspect() == 1.0


def test_two_orders_end_at_two_places():
    (ax,) = two_orders().axes
    drawn = {line.get_label(): line.get_xydata() for line in ax.lines}
    np.testing.assert_allclose(drawn["drive, then turn"][-1], [2, 0], atol=1e-12)
    np.testing.assert_allclose(drawn["turn, then drive"][-1], [0, 2], atol=1e-12)


def test_growth_draws_the_root_mean_square():
    (ax,) = growth().axes
    drawn = {line.get_label(): line.get_ydata() for line in ax.lines}
    runs = np.arange(30.0).reshape(3, 10)
    np.testing.assert_allclose(drawn["root mean square of the runs"], np.sqrt((runs**2).mean(axis=0)))
    assert "3 runs" in drawn
    assert len(ax.lines) == 5


def test_the_ellipse_holds_what_it_promises_of_a_gaussian():
    cov = np.array([[2.0, 0.9], [0.9, 0.5]])
    xy = np.random.default_rng(1).multivariate_normal([3.0, -1.0], cov, 40_000)
    for share in (0.5, 0.95):
        assert evaluation.share_inside(xy, [3.0, -1.0], cov, share) == pytest.approx(share, abs=0.01)
        border = uncertainty.ellipse_points([3.0, -1.0], cov, share)
        squared = np.einsum("ni,ij,nj->n", border - [3.0, -1.0], np.linalg.inv(cov), border - [3.0, -1.0])
        np.testing.assert_allclose(squared, -2 * np.log(1 - share))
    assert evaluation.share_inside(np.array([[1.0, 0.0], [9.0, 0.0]]), [0, 0], np.eye(2)) == 0.5
    flat = uncertainty.ellipse_points([0, 0], np.diag([1.0, 0.0]))
    np.testing.assert_allclose(flat[:, 1], 0.0)


# --- the slider ------------------------------------------------------------------------------------------------------


def test_the_slider_tells_what_the_library_says_over_its_whole_range():
    explorer = drift_explorer.explore_noise()
    (ax,) = explorer.figure.axes
    ends = []
    for noise in np.linspace(0, 3, 5):
        words = explorer.move(noise=noise)
        log, truth = simulate.fifteen_objects(noise=noise)
        poses = dead_reckoning(log.odometry, truth.poses[0])
        off = np.hypot(*(poses - truth.poses)[:, :2].T)
        ends.append(off[-1])
        assert f"ends {off[-1]:.2f} m" in words and f"{off.mean():.2f} m off" in words
        assert f"{log.num_observations} sightings are {log.num_observations} objects" in words
        assert any(np.array_equal(line.get_xydata(), poses[:, :2]) for line in ax.lines)
        xy = se2.apply(poses[log.obs_time], log.obs_xy)
        drawn = np.concatenate([artist.get_offsets() for artist in ax.collections if len(artist.get_facecolors())])
        np.testing.assert_allclose(drawn[np.lexsort(drawn.T)], xy[np.lexsort(xy.T)])
        assert (xy >= [ax.get_xlim()[0], ax.get_ylim()[0]]).all() and (xy <= [ax.get_xlim()[1], ax.get_ylim()[1]]).all()
    assert ends == sorted(ends)


def test_only_the_size_of_the_noise_changes_under_the_slider():
    (calm, truth), (wild, _) = (simulate.fifteen_objects(noise=noise) for noise in (0.0, 3.0))
    steps = se2.between(truth.poses[:-1], truth.poses[1:])
    drawn = [(log.odometry - steps) / log.odometry_std for log in (calm, wild)]
    np.testing.assert_allclose(*drawn, atol=1e-9)
    np.testing.assert_array_equal(calm.obs_time, wild.obs_time)


# --- the heading that is dragged -------------------------------------------------------------------------------------


def test_the_path_before_a_wrong_turn_stands_and_the_path_behind_it_turns_as_a_whole():
    steps = heading.two_corners()
    true_path = dead_reckoning(steps)
    for turn in (1, 8, 13, 18):
        path, error = heading.with_wrong_turn(steps, turn, 0.3), rotation(0.3)
        np.testing.assert_allclose(path[:turn], true_path[:turn], atol=1e-12)
        hinge = true_path[turn, :2]
        np.testing.assert_allclose(path[turn:, :2], (true_path[turn:, :2] - hinge) @ error.T + hinge, atol=1e-12)


def test_the_words_and_the_picture_of_a_wrong_heading_are_those_of_a_rotation_about_it():
    explorer = heading.explore_heading()
    true_path = dead_reckoning(heading.two_corners())
    for turn, error in ((4, 15.0), (1, -30.0), (8, 30.0), (18, 7.5)):
        words = explorer.move(turn=turn, error=error)
        far = np.linalg.norm(true_path[-1, :2] - true_path[turn, :2])
        off = 2 * np.sin(np.deg2rad(abs(error)) / 2) * far
        assert f"{far:.2f} m in a straight line, and the end is {off:.2f} m off" in words
        drawn = [each.split(",") for each in explorer.scene.parts["path"][1]["points"].split()]
        path = heading.with_wrong_turn(heading.two_corners(), turn, np.deg2rad(error))
        np.testing.assert_allclose(np.array(drawn, float), heading.ROOM.to_page(path[:, :2]), atol=0.006)
        assert f"the end is {off:.2f} m off" in explorer.scene.parts["map title"][2]


def test_every_wrong_path_is_inside_its_map():
    for turn in range(1, 19):
        for error in (-heading.LARGEST, heading.LARGEST):
            xy = heading.with_wrong_turn(heading.two_corners(), turn, np.deg2rad(error))[:, :2]
            assert (xy > (heading.ROOM.x[0], heading.ROOM.y[0])).all()
            assert (xy < (heading.ROOM.x[1], heading.ROOM.y[1])).all()


def test_the_rings_of_the_wrong_heading_lie_where_they_are_led():
    assert_rings_lie_where_they_are_led(heading.explore_heading())


@pytest.mark.parametrize("heading", np.deg2rad([0, 35, 90, 200]))
def test_after_a_step_the_old_ellipse_is_carried_along_and_the_steps_own_is_added(heading):
    std, cov = np.array([0.3, 0.1, 0.05]), np.array([[0.04, 0.01, 0.01], [0.01, 0.09, 0.0], [0.01, 0.0, 0.02]])
    before = pose_of((1.0, 2.0), heading)
    after = se2.compose(before, np.array([2.0, 0.5, 0.3]))
    dx, dy = (after - before)[:2]
    F, G = np.array([[1, 0, -dy], [0, 1, dx], [0, 0, 1]]), np.eye(3)
    G[:2, :2] = rotation(heading)
    carried, own = F @ cov @ F.T, G @ np.diag(std**2) @ G.T
    _, ax = plotting.new_figure()
    pictures.plot_one_step(ax, np.array([before, after]), np.array([cov, carried + own]), std)
    _, *drawn = (np.asarray(line.get_xydata()) for line in ax.lines)
    for points, middle, expected in zip(
        drawn, (before, after, after, after), (cov, carried, own, carried + own), strict=True
    ):
        # All points of an ellipse are as far from its middle, in standard deviations of what it stands for.
        off = points - middle[:2]
        distance = np.einsum("ni,ij,nj->n", off, np.linalg.inv(expected[:2, :2]), off)
        np.testing.assert_allclose(distance, -2 * np.log(0.05), rtol=1e-6)
