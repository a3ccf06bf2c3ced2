"""Tracklets: what is tied together is of one object, and nothing is tied over a long gap."""

from dataclasses import replace

import numpy as np
import pytest

from npslam_teach import se2, simulate
from npslam_teach.association import in_order_of_sight
from npslam_teach.methods.oriented import Headings
from npslam_teach.methods.tracklets import LONGEST_GAP, Surroundings, tied_both_ways, tracklets
from npslam_teach.types import RobotLog


@pytest.mark.parametrize("noise", [1.0, 3.0])
@pytest.mark.parametrize("tie", [tracklets, tied_both_ways])
def test_they_are_pure_and_long(tie, noise):
    for seed in range(3):
        log, truth = simulate.fifteen_objects(seed, noise)
        labels = tie(log)
        for k in range(labels.max() + 1):
            assert len(np.unique(truth.obs_object[labels == k])) == 1
            times = np.sort(log.obs_time[labels == k])
            assert np.diff(times).max(initial=0) <= LONGEST_GAP
        assert labels.max() + 1 < log.num_observations / 8
        assert np.count_nonzero(labels < 0) < 0.06 * log.num_observations


def test_two_of_a_frame_are_two_tracklets():
    log, _ = simulate.fifteen_objects(0)
    labels = tracklets(log)
    for time in np.unique(log.obs_time):
        tied = labels[(log.obs_time == time) & (labels >= 0)]
        assert len(np.unique(tied)) == len(tied)


def test_the_order_of_lines_does_not_matter():
    log, _ = simulate.fifteen_objects(1)
    order = np.random.default_rng(0).permutation(log.num_observations)
    other = replace(log, obs_time=log.obs_time[order], obs_xy=log.obs_xy[order], obs_class=log.obs_class[order])
    labels, permuted = tracklets(log)[order], tracklets(other)
    assert len(np.unique(labels)) == len(np.unique(permuted))
    assert len(np.unique(np.column_stack([labels, permuted]), axis=0)) == len(np.unique(labels))


@pytest.mark.parametrize("seed", range(5))
def test_the_error_of_a_step_shifts_and_turns_what_is_in_view(seed):
    """The covariance after a step against the derivatives of the step, by central differences."""
    rng = np.random.default_rng(seed)
    xy, step, std = rng.normal(0, 3, (3, 2)), rng.normal(0, 1, 3), rng.uniform(0.1, 1, 3)
    root = rng.normal(size=(6, 6))
    nothing = np.zeros(3, dtype=int)
    moved = Surroundings(nothing, nothing, nothing, xy, root @ root.T, Headings.silent(len(xy))).after_step(
        step, np.diag(np.square(std))
    )

    def after(places_and_step):
        return se2.apply_inverse(places_and_step[6:], places_and_step[:6].reshape(3, 2)).ravel()

    at, h = np.concatenate([xy.ravel(), step]), 1e-6
    jacobian = np.column_stack([(after(at + h * e) - after(at - h * e)) / (2 * h) for e in np.eye(9)])
    # The noise of a step is that of its own frame, which a turn by step leaves where it is.
    spread = jacobian[:, :6] @ root @ root.T @ jacobian[:, :6].T + (jacobian[:, 6:] * std**2) @ jacobian[:, 6:].T
    np.testing.assert_allclose(moved.xy.ravel(), after(at), atol=1e-12)
    np.testing.assert_allclose(moved.cov, spread, atol=1e-6)


def test_what_was_not_seen_for_long_begins_anew():
    times = np.array([0, 1, 2, 2 + LONGEST_GAP + 1])
    log = RobotLog(np.zeros((20, 3)), times, np.tile([2.0, 0.0], (4, 1)), np.zeros(4, int), 1, (0.01,) * 3, (0.1,) * 2)
    assert tracklets(log).tolist() == [0, 0, 0, 1]


def test_numbers_are_in_the_order_of_sight():
    keys = np.array([[7], [3], [7], [1]])
    assert in_order_of_sight(keys, np.array([True, True, True, False])).tolist() == [0, 1, 0, -1]
