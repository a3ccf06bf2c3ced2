"""Two observations of one frame are two things: the matching against brute force, and the sweep against ``sweep``."""

from itertools import product

import numpy as np
import pytest

from npslam_teach import association, methods, se2, simulate
from npslam_teach.association import (
    association_weights,
    decide,
    exclusive_sweep,
    reweight,
    sweep,
    without_empty_objects,
)
from npslam_teach.association.exclusive import assign
from npslam_teach.types import RobotLog


def best_by_trying(weights, alpha, threshold):
    """The largest product of weights over bars, a new object counting one, over all one-to-one matchings."""
    m, num_objects = weights.shape
    bar = np.full(m, alpha) if threshold is None else threshold * (alpha + weights.sum(axis=1))
    best, found = -1.0, None
    for chosen in product(range(num_objects + 1), repeat=m):
        used = [j for j in chosen if j < num_objects]
        gains = [weights[k, j] / bar[k] if j < num_objects else 1.0 for k, j in enumerate(chosen)]
        if len(set(used)) == len(used) and all(g > 1 or j == num_objects for g, j in zip(gains, chosen, strict=True)):
            if np.prod(gains) > best * (1 + 1e-12):
                best, found = np.prod(gains), chosen
    return found


@pytest.mark.parametrize("threshold", [None, 0.1, 0.3])
@pytest.mark.parametrize("seed", range(20))
def test_the_matching_is_the_best_of_all(seed, threshold):
    rng = np.random.default_rng(seed)
    weights = rng.exponential(1.0, (int(rng.integers(1, 5)), int(rng.integers(1, 5)))) * (rng.random((1, 1)) < 0.9)
    np.testing.assert_array_equal(assign(weights, 0.5, threshold), best_by_trying(weights, 0.5, threshold))


@pytest.mark.parametrize("threshold", [None, 0.0, 0.2])
def test_for_one_observation_it_is_the_papers_decision(threshold):
    rng = np.random.default_rng(0)
    for _ in range(200):
        weights = rng.exponential(1.0, int(rng.integers(0, 5)))
        assert assign(weights[None], 0.7, threshold)[0] == decide(reweight(weights, 0.7), threshold)


def dense_sweep(labels, landmarks, xy, obs_class, obs_time, alpha, threshold, kernel_std):
    """The rule written out, last frame first, every observation compared with every object."""
    labels, landmarks = labels.copy(), list(landmarks)
    for time in np.unique(obs_time)[::-1]:
        frame = np.flatnonzero(obs_time == time)[::-1]
        others = np.delete(np.arange(len(labels)), frame)
        weights = np.zeros((len(frame), len(landmarks)))
        for row, k in zip(weights, frame, strict=True):
            votes = np.bincount(labels[others[obs_class[others] == obs_class[k]]], minlength=len(landmarks))
            row[:] = association_weights(votes, np.linalg.norm(np.array(landmarks) - xy[k], axis=1), kernel_std)
        for k, chosen in zip(frame, assign(weights, alpha, threshold), strict=True):
            labels[k] = chosen if chosen < weights.shape[1] else len(landmarks)
            if labels[k] == len(landmarks):
                landmarks.append(xy[k])
    return without_empty_objects(labels, np.array(landmarks))


@pytest.mark.parametrize("threshold", [None, 0.0, 1e-12, 0.05, 0.4])
@pytest.mark.parametrize("seed", range(3))
def test_the_search_radius_leaves_nothing_out(seed, threshold):
    log, _ = simulate.fifteen_objects(seed)
    used = log.obs_time < 120
    xy = se2.apply(se2.dead_reckoning(log.odometry)[log.obs_time[used]], log.obs_xy[used])
    for start in (np.arange(len(xy)), np.random.default_rng(seed).integers(0, 40, len(xy))):
        arguments = start, xy, xy, log.obs_class[used], log.obs_time[used], 0.9, threshold, 0.3
        ours, theirs = exclusive_sweep(*arguments), dense_sweep(*arguments)
        np.testing.assert_array_equal(ours.labels, theirs.labels)
        np.testing.assert_array_equal(ours.landmarks, theirs.landmarks)


def test_a_log_without_observations_has_no_objects():
    nothing = np.zeros(0, dtype=int)
    found = exclusive_sweep(nothing, np.zeros((0, 2)), np.zeros((0, 2)), nothing, nothing)
    assert found.labels.shape == (0,) and found.landmarks.shape == (0, 2)


@pytest.mark.parametrize("seed", range(5))
def test_frames_of_one_observation_are_swept_as_ever(seed):
    log, _ = simulate.fifteen_objects(seed)
    kept = np.unique(log.obs_time, return_index=True)[1]
    xy, classes = se2.apply(se2.dead_reckoning(log.odometry)[log.obs_time[kept]], log.obs_xy[kept]), log.obs_class[kept]
    start = np.arange(len(kept)), xy, xy, classes
    for order in ("last-to-first", "first-to-last", np.random.default_rng(seed).permutation(len(kept))):
        ours = exclusive_sweep(*start, log.obs_time[kept], order=order)
        np.testing.assert_array_equal(ours.labels, sweep(*start, order=order).labels)
        np.testing.assert_array_equal(ours.landmarks, sweep(*start, order=order).landmarks)


@pytest.mark.parametrize("seed", range(3))
def test_no_object_is_seen_twice_in_a_frame(seed):
    log, _ = simulate.fifteen_objects(seed)
    for snapshot in methods.np_graph(log, exclusive=True):
        pairs = np.column_stack([log.obs_time, snapshot.labels])
        assert len(np.unique(pairs, axis=0)) == len(pairs)


def test_two_chairs_side_by_side_stay_two():
    """A third of a metre apart, seen together in every frame from one place; the paper's rule joins them."""
    rng = np.random.default_rng(0)
    num_frames, chairs = 30, np.array([[2.0, 0.15], [2.0, -0.15]])
    log = RobotLog(
        odometry=np.zeros((num_frames - 1, 3)),
        obs_time=np.repeat(np.arange(num_frames), 2),
        obs_xy=np.tile(chairs, (num_frames, 1)) + rng.normal(0, 0.05, (2 * num_frames, 2)),
        obs_class=np.zeros(2 * num_frames, dtype=int),
        num_classes=1,
        odometry_std=[0.02, 0.02, 0.01],
        observation_std=[0.05, 0.05],
    )
    assert [*methods.np_graph(log)][-1].num_objects == 1
    *_, last = methods.np_graph(log, exclusive=True)
    assert last.num_objects == 2
    np.testing.assert_array_equal(last.labels.reshape(-1, 2) == last.labels[0], np.tile([True, False], (num_frames, 1)))


def test_renaming_and_rigid_motion_change_nothing():
    log, _ = simulate.fifteen_objects(1)
    xy = se2.apply(se2.dead_reckoning(log.odometry)[log.obs_time], log.obs_xy)
    start = np.arange(log.num_observations)
    found = exclusive_sweep(start, xy, xy, log.obs_class, log.obs_time)
    moved = se2.apply([3.0, -2.0, 1.0], xy)
    other = exclusive_sweep(start, moved, moved, (log.obs_class + 1) % log.num_classes, log.obs_time)
    np.testing.assert_array_equal(found.labels, other.labels)
    assert isinstance(found, association.Association)
