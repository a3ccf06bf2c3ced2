"""The alternation against all partitions, where there are few enough to be listed."""

import math

import numpy as np
import pytest
from partitions import objective_of, partitions, same_groups

from npslam_teach import np_graph
from npslam_teach.types import RobotLog


def one_view_log(xy, obs_class):
    """Everything seen from a single pose: the association alone, no trajectory to solve."""
    return RobotLog(np.zeros((0, 3)), np.zeros(len(xy), int), xy, obs_class, 3, (1, 1, 1), (1, 1))


def least_objective(xy, obs_class, alpha, kernel_std):
    """Over all partitions into objects of one class, each object where its observations put it."""
    best = (math.inf, None)
    for labels in partitions(len(xy)):
        labels = np.array(labels)
        groups = [np.flatnonzero(labels == i) for i in range(labels.max() + 1)]
        if any(len(set(obs_class[g])) > 1 for g in groups):
            continue
        means = np.array([xy[g].mean(axis=0) for g in groups])
        best = min(best, (objective_of(labels, means, xy, obs_class, alpha, kernel_std), labels.tolist()))
    return best


def alternate(xy, obs_class, alpha, kernel_std):
    log = one_view_log(xy, obs_class)
    *_, last = np_graph(
        log, alpha=alpha, iterations=30, kernel_std=kernel_std, observation_std=(kernel_std, kernel_std)
    )
    return last


@pytest.mark.parametrize("seed", range(12))
def test_well_separated_objects_are_found_as_the_best_of_all_partitions(seed):
    rng = np.random.default_rng(seed)
    n, kernel_std = 4 + seed % 4, 0.35
    centres = np.array([[0.0, 0.0], [4.0, 0.0], [0.0, 4.0]])
    member = rng.integers(0, 3, n)
    xy, obs_class = centres[member] + rng.uniform(-0.06, 0.06, (n, 2)), np.array([0, 1, 0])[member]
    value, labels = least_objective(xy, obs_class, 0.9, kernel_std)
    last = alternate(xy, obs_class, 0.9, kernel_std)
    assert last.objective == pytest.approx(value, abs=1e-8)
    np.testing.assert_array_equal(same_groups(last.labels), same_groups(labels))


def test_on_any_seven_observations_alternation_is_bounded_by_the_best_partition():
    """It is a descent and may stop short: never below the best of all 877 partitions, and often at it."""
    at_best = []
    for seed in range(25):
        rng = np.random.default_rng(seed)
        xy, obs_class = rng.uniform(0, 1.0, (7, 2)), rng.integers(0, 2, 7)
        value, _ = least_objective(xy, obs_class, 0.9, 0.35)
        last = alternate(xy, obs_class, 0.9, 0.35)
        assert last.objective >= value - 1e-8
        at_best.append(last.objective <= value + 1e-8)
    assert np.mean(at_best) > 0.2
