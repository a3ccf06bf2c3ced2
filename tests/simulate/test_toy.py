"""The toy scene's numbers, as they are worked out on paper."""

import math

import numpy as np
import pytest

from npslam_teach import dead_reckoning, evaluation, np_graph, se2, toy_objects
from npslam_teach.association import association_weights

TOY = {"alpha": 0.5}


@pytest.fixture
def seen():
    log, truth = toy_objects()
    poses = dead_reckoning(log.odometry)
    return log, truth, se2.apply(poses[log.obs_time], log.obs_xy)


def test_where_everything_lands_along_the_wheels_path(seen):
    _, _, xy = seen
    expected = [[1.2, 1.1], [1.2, 0.4], [2.8, 0.6], [1.2, 1.4], [1.2, 0.7], [2.8, 0.9], [0.6, 0.5], [0.5, 2.0]]
    np.testing.assert_allclose(xy, expected, atol=1e-12)


def test_distances_and_weights_of_obj_5(seen):
    _, _, xy = seen
    distance = np.linalg.norm(xy - xy[4], axis=1)
    np.testing.assert_allclose(distance[[1, 0, 3]], [0.3, 0.4, 0.7], atol=1e-12)
    weights = association_weights(np.ones(3), distance[[1, 0, 3]])
    np.testing.assert_allclose(weights, [math.exp(-0.36), math.exp(-0.64), math.exp(-1.96)])


def test_only_the_slip_is_wrong():
    log, truth = toy_objects()
    error = log.odometry - se2.between(truth.poses[:-1], truth.poses[1:])
    error[:, 2] = se2.wrap(error[:, 2])
    expected = np.zeros((5, 3))
    expected[2, 0] = 0.3
    np.testing.assert_allclose(error, expected, atol=1e-12)
    real = truth.obs_object >= 0
    np.testing.assert_allclose(
        se2.apply(truth.poses[log.obs_time], log.obs_xy)[real],
        truth.world.object_xy[truth.obs_object[real]],
        atol=1e-12,
    )
    np.testing.assert_array_equal(log.obs_class[real], truth.world.object_class[truth.obs_object[real]])


def test_every_sighting_is_in_view():
    log, _ = toy_objects()
    assert (np.linalg.norm(log.obs_xy, axis=1) < 4.0).all()
    assert (np.abs(np.arctan2(log.obs_xy[:, 1], log.obs_xy[:, 0])) < np.deg2rad(60)).all()


def test_the_method_repairs_the_slip_with_the_sensors_own_noise():
    log, truth = toy_objects()
    stds = {"odometry_std": log.odometry_std, "observation_std": log.observation_std}
    snapshots = list(np_graph(log, **TOY, **stds))
    assert [s.num_objects for s in snapshots] == [8, 5, 5]
    labels = snapshots[-1].labels
    assert labels[0] == labels[3] and labels[1] == labels[4] and labels[2] == labels[5]
    assert len(set(labels[[0, 1, 2, 6, 7]])) == 5
    assert evaluation.evaluate(snapshots[-1], truth, log).mean_pose_error < 0.02


def test_at_the_papers_alpha_nothing_in_the_toy_merges():
    log, _ = toy_objects()
    *_, last = np_graph(log, alpha=0.9)
    assert last.num_objects == 8
