"""Online: frames one at a time give what a log gives, minds are changed, units and order of lines are not in it."""

import math
from dataclasses import replace

import numpy as np
import pytest

from npslam_teach import evaluation, se2, simulate
from npslam_teach.association import same_partition
from npslam_teach.methods import Online, online
from npslam_teach.methods.online import frames
from npslam_teach.methods.repair import completed
from npslam_teach.methods.robot import MOST_LIFTED, MOST_NEAR, MOST_RECENT
from npslam_teach.pose_graph import chi2, fit
from npslam_teach.pose_graph.submap_tree import STRETCH
from npslam_teach.types import RobotLog


@pytest.fixture(scope="module")
def scene():
    return simulate.fifteen_objects(2)


@pytest.fixture(scope="module")
def snapshots(scene):
    return list(online(scene[0]))


def test_it_finds_the_fifteen_objects(scene, snapshots):
    log, truth = scene
    found = evaluation.evaluate(snapshots[-1], truth, log)
    assert (found.num_objects, len(snapshots)) == (15, 11)
    assert found.ari > 0.99 and found.mean_pose_error < 0.1


def test_the_end_is_the_batch_solution_of_its_own_labels(scene, snapshots):
    batch = fit(scene[0], snapshots[-1].labels)
    assert snapshots[-1].chi2 == pytest.approx(chi2(batch), rel=1e-6)


def test_what_was_not_seen_yet_is_of_no_object(scene, snapshots):
    log, _ = scene
    for tenth, now in enumerate(snapshots[1:-1], 1):
        assert (now.labels[log.obs_time > tenth / 10 * log.num_poses] == -1).all()
        assert (now.labels >= 0).sum() > 0.9 * (log.obs_time < tenth / 10 * log.num_poses).sum()


def test_a_robot_says_where_its_objects_are():
    """Each by its oldest tracklet, as labels call it; near where the toy scene has them."""
    log, truth = simulate.toy_objects()
    robot = Online(log.num_classes, log.odometry_std, log.observation_std)
    for _ in frames(robot, log):
        pass
    objects, places = robot.landmarks()
    np.testing.assert_array_equal(objects, np.unique(robot.labels[robot.labels >= 0]))
    off = np.linalg.norm(places[:, None] - truth.world.object_xy, axis=2).min(axis=1)
    assert off.max() < 1.0


@pytest.mark.parametrize("seed", [0, 1])
def test_units_and_the_order_of_lines_do_not_matter(seed):
    log, _ = simulate.toy_objects()
    *_, first = online(log)
    order = np.random.default_rng(seed).permutation(log.num_observations)
    fields = {name: getattr(log, name)[order] for name in ("obs_time", "obs_xy", "obs_class")}
    *_, shuffled = online(replace(log, **fields))
    assert same_partition(first.labels[order], shuffled.labels)
    metres = np.array([1000.0, 1000.0, 1.0])
    longer = {"odometry": log.odometry * metres, "obs_xy": 1000 * log.obs_xy}
    longer |= {"odometry_std": log.odometry_std * metres, "observation_std": 1000 * log.observation_std}
    *_, scaled = online(replace(log, **longer))
    assert same_partition(first.labels, scaled.labels)
    np.testing.assert_allclose(scaled.graph.poses, first.graph.poses * metres, rtol=1e-6, atol=1e-3)


def circle(num_poses, turn, objects, noise, rng):
    """A drive in circles past objects of one class: (log, true object of each observation)."""
    steps = np.tile([0.2, 0.0, turn], (num_poses - 1, 1))
    poses = se2.dead_reckoning(steps)
    times, obj = np.nonzero(np.linalg.norm(poses[:, None, :2] - objects, axis=2) < 1.5)
    xy = se2.apply_inverse(poses[times], objects[obj]) + rng.normal(scale=noise, size=(len(times), 2))
    odometry = steps + rng.normal(scale=(noise / 5, noise / 5, noise / 5), size=steps.shape)
    zeros = np.zeros(len(times), dtype=int)
    return RobotLog(odometry, times, xy, zeros, 1, (noise / 5,) * 3, (noise, noise)), obj


def test_at_most_so_many_objects_are_at_hand():
    objects = np.column_stack([np.repeat(np.arange(30), 3), np.tile([-1.2, 0.2, 1.2], 30)]).astype(float) * [0.5, 1.0]
    log, _ = circle(90, 0.0, objects, 0.02, np.random.default_rng(0))
    robot, most = Online(1, log.odometry_std, log.observation_std, window=10), 0
    for _ in frames(robot, log):
        most = max(most, int(robot.tree.is_active().sum()) - len(robot._recent))
    assert len(np.unique(robot.labels)) > MOST_NEAR
    assert most <= MOST_NEAR


def test_the_work_of_a_frame_does_not_grow_with_the_map():
    """A corridor, counted in condensed submaps and in variables of the front, so that no clock is asked."""
    objects = np.column_stack([np.repeat(np.arange(60), 2), np.tile([-1.2, 1.2], 60)]).astype(float)
    log, _ = circle(300, 0.0, objects, 0.02, np.random.default_rng(0))
    robot, work, at_hand = Online(1, log.odometry_std, log.observation_std, window=10), [], []
    for _ in frames(robot, log):
        work.append(robot.tree.redone - sum(work))
        at_hand.append(int(robot.tree.is_active().sum()))
    assert len(np.unique(robot.labels)) > 100
    assert max(at_hand) <= MOST_NEAR + MOST_RECENT
    depth = math.ceil(math.log2(300 / STRETCH))  # a joint more for twice the drive
    assert max(work) <= (2 + MOST_LIFTED) * (2 * depth + 2)
    assert np.mean(work[200:]) < 1.5 * np.mean(work[100:200])


def test_a_pass_in_the_window_changes_its_object_when_more_is_seen():
    """Driven three times around; on the way what is believed of earlier frames changes, and comes out right."""
    rng = np.random.default_rng(4)
    objects = np.array([[0.0, -0.8], [1.4, 1.5], [-1.5, 1.2], [0.3, 2.9]])
    log, obj = circle(96, 0.2, objects, 0.15, rng)
    robot = Online(1, log.odometry_std, log.observation_std)
    for _ in frames(robot, log):
        pass
    labels = robot.labels
    used = labels >= 0
    assert used.mean() > 0.95
    assert same_partition(labels[used], obj[used])


def test_completed_looks_at_what_was_left_out():
    noise = (1.0,) * 3, (0.1,) * 2
    xy = [[1, 0], [1.02, 0], [1.01, 0], [1.05, 0], [9, 9]]
    log = RobotLog(np.zeros((2, 3)), [0, 1, 2, 2, 2], xy, [0] * 5, 1, *noise)
    for before, after in (
        ([0, 0, -1, 1, 2], [0, 0, 0, -1, -1]),  # the better one takes it; what was seen once makes no object
        ([0, 0, 0, -1, -1], [0, 0, 0, -1, -1]),  # its frame has seen it already
        ([0, -1, -1, -1, -1], [-1] * 5),
    ):
        labels = np.array(before)
        np.testing.assert_array_equal(completed(log, fit(log, labels), labels), after)


@pytest.mark.parametrize(
    ("setting", "message"),
    [
        ({"alpha": 0.0}, "alpha: expected a positive number"),
        ({"area": -1.0}, "area: expected a positive number of square metres"),
        ({"window": 3}, "window: expected a whole number of poses, 10 or more"),
        ({"observation_std": (0.0, 1.0)}, "observation_std: expected positive"),
    ],
)
def test_bad_settings_are_named(setting, message, scene):
    with pytest.raises(ValueError, match=message):
        list(online(scene[0], **setting))


def test_the_first_frame_has_no_step_and_all_others_have_one():
    robot = Online(1, (0.1,) * 3, (0.1,) * 2)
    with pytest.raises(ValueError, match="step: expected None"):
        robot.add_frame([0.1, 0, 0], [], [])
    robot = Online(1, (0.1,) * 3, (0.1,) * 2)
    assert len(robot.add_frame(None, [], []).objects) == 0
    with pytest.raises(ValueError, match="step: expected None"):
        robot.add_frame(None, [], [])
