"""The method with a part of the truth given: what is given stays, and what is not given is the method's own."""

import numpy as np
import pytest

from npslam_teach import simulate
from npslam_teach.association import same_partition
from npslam_teach.evaluation import evaluate, true_association_fit
from npslam_teach.experiments.oracles import from_the_truth, poses_at_truth
from npslam_teach.methods import settings_for


@pytest.fixture(scope="module")
def room():
    return simulate.fifteen_objects(1)


def test_poses_stay_at_the_truth_and_the_objects_do_not(room):
    log, truth = room
    last = poses_at_truth(log, truth)
    np.testing.assert_array_equal(last.graph.poses, truth.poses)
    assert last.num_objects == 15 and evaluate(last, truth, log).ari == pytest.approx(1.0)
    # With the poses held, an object stands at the mean of its observations carried into the world.
    rotated = [np.array([[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]]) for a in truth.poses[log.obs_time, 2]]
    xy = truth.poses[log.obs_time, :2] + np.einsum("nij,nj->ni", rotated, log.obs_xy)
    means = [xy[last.labels == k].mean(axis=0) for k in range(15)]
    np.testing.assert_allclose(last.graph.landmarks, means, atol=1e-6)


def test_a_kernel_too_narrow_for_the_noise_fails_even_with_true_poses(room):
    log, truth = room
    assert poses_at_truth(log, truth, kernel_std=0.02).num_objects > 30


def test_from_the_truth_no_round_is_no_change_and_the_rounds_change_nothing_here(room):
    log, truth = room
    still, last = (from_the_truth(log, truth, iterations=k) for k in (0, 5))
    np.testing.assert_array_equal(still.graph.poses, true_association_fit(log, truth).poses)
    assert same_partition(still.labels, truth.obs_object) and same_partition(last.labels, truth.obs_object)
    assert last.iteration == 1, "no label changed, so it rests after one round"


def test_it_may_leave_the_truth(room):
    log, truth = room
    last = from_the_truth(log, truth, kernel_std=0.02)
    assert last.num_objects > 30 and not same_partition(last.labels, truth.obs_object)


@pytest.mark.parametrize("oracle", [poses_at_truth, from_the_truth])
def test_the_settings_are_those_of_the_method(room, oracle):
    log, truth = room
    sensor = settings_for(log)
    last = oracle(log, truth, **sensor)
    information = last.graph.observations.information[0]
    np.testing.assert_allclose(information, np.diag(1 / np.square(sensor["observation_std"])))
    between = last.graph.between.information[0]
    np.testing.assert_allclose(between, np.diag(1 / np.square(sensor["odometry_std"])))
    with pytest.raises(ValueError, match="alpha"):
        oracle(log, truth, alpha=-1.0)
