"""The noise that a log itself shows: of known noise, of wrong claims, of errors that last, and with outliers."""

import sys
from dataclasses import replace

import numpy as np
import pytest
from beginnings import first_poses

from npslam_teach import simulate
from npslam_teach.methods import estimate_noise
from npslam_teach.methods.noise import with_noise
from npslam_teach.methods.noise_estimate import _given_labels, _one_per_pass
from npslam_teach.pose_graph import fit, linearize, mean_leverages
from npslam_teach.types import RobotLog


def known(log, truth, claim=1.0):
    """The estimate for a log whose associations are known and whose claims are off by a factor."""
    wrong = with_noise(log, claim * log.odometry_std, claim * log.observation_std)
    return _given_labels(wrong, truth.obs_object, truth.poses, 1, np.random.default_rng(0))


@pytest.mark.slow
def test_whatever_a_log_claims_its_noise_is_found():
    """Who is who is not known either. The beginning of a room at twice the noise; it takes three rounds from 2.5."""
    log, _ = simulate.fifteen_objects(2, noise=2.0)
    log = first_poses(log, 200)
    wrong = with_noise(log, 2.5 * log.odometry_std, 2.5 * log.observation_std)
    estimate = estimate_noise(wrong)
    assert estimate.converged and estimate.is_white and estimate.rounds > 2
    np.testing.assert_allclose(estimate.odometry_std, log.odometry_std, rtol=0.2)
    np.testing.assert_allclose(estimate.observation_std, log.observation_std, rtol=0.06)
    assert estimate.outlier_share < 0.005
    np.testing.assert_array_equal(estimate.applied_to(wrong).observation_std, estimate.observation_std)


def test_every_round_draws_alike(monkeypatch):
    """Rounds that choose other observations of the passes would differ, and go on, by the luck of the draw."""
    module, begins = sys.modules[_given_labels.__module__], []

    def given_labels(log, labels, poses, number, rng):
        begins.append(rng.bit_generator.state["state"]["state"])
        return _given_labels(log, labels, poses, number, rng)

    monkeypatch.setattr(module, "_given_labels", given_labels)
    log, _ = simulate.fifteen_objects(2, noise=2.0)
    log = first_poses(log, 150)
    estimate_noise(with_noise(log, 2.5 * log.odometry_std, 2.5 * log.observation_std), rounds=2)
    assert len(begins) == 2 and len(set(begins)) == 1


@pytest.mark.parametrize("claim", [0.3, 3.0])
def test_with_known_associations_the_noise_is_found(claim):
    log, truth = simulate.fifteen_objects(2, noise=2.0)
    estimate = known(log, truth, claim)
    np.testing.assert_allclose(estimate.odometry_std, log.odometry_std, rtol=0.1)
    np.testing.assert_allclose(estimate.observation_std, log.observation_std, rtol=0.05)
    assert estimate.is_white and estimate.outlier_share < 0.005


def test_outliers_are_counted_and_do_not_count():
    log, truth = simulate.fifteen_objects(2, noise=2.0)
    rng = np.random.default_rng(0)
    bad = rng.random(log.num_observations) < 0.05
    off = 8 * log.observation_std * rng.choice([-1, 1], (log.num_observations, 2))
    estimate = known(replace(log, obs_xy=log.obs_xy + bad[:, None] * off), truth)
    assert estimate.outlier_share == pytest.approx(bad.mean(), abs=0.015)
    np.testing.assert_allclose(estimate.observation_std, log.observation_std, rtol=0.1)


@pytest.mark.slow
def test_errors_that_last_for_a_pass_are_seen():
    """An error common to a pass: nobody sees it within the pass, and it counts between passes."""
    log, truth = simulate.fifteen_objects(2, noise=0.5)
    rng, std = np.random.default_rng(3), 0.3
    order = np.lexsort((log.obs_time, truth.obs_object))
    gap = (np.diff(truth.obs_object[order], prepend=-2) != 0) | (np.diff(log.obs_time[order], prepend=0) > 10)
    of_pass = np.empty(log.num_observations, dtype=int)
    of_pass[order] = np.cumsum(gap) - 1
    common = rng.normal(0, std, (of_pass.max() + 1, 2))
    estimate = known(replace(log, obs_xy=log.obs_xy + common[of_pass]), truth, claim=2.0)
    total = np.hypot(std, log.observation_std)
    assert not estimate.is_white
    np.testing.assert_allclose(estimate.observation_std, total, rtol=0.25)
    assert (estimate.within_pass_std < 0.7 * total).all()


def test_one_observation_of_every_pass():
    time = np.array([0, 1, 2, 3, 3, 20, 21, 40])
    log = RobotLog(np.zeros((40, 3)), time, np.ones((8, 2)), np.zeros(8, int), 1, (0.1,) * 3, (0.1,) * 2)
    labels = np.array([0, 0, 0, 0, 1, 0, 0, -1])
    rng, seen = np.random.default_rng(0), set()
    for _ in range(50):
        chosen = np.flatnonzero(_one_per_pass(log, labels, rng) >= 0)
        assert len(chosen) == 3 and chosen[0] in (0, 1, 2, 3) and 4 in chosen and chosen[2] in (5, 6)
        seen.update(chosen.tolist())
    assert seen == set(range(7))


def test_leverages_add_up_to_the_number_of_unknowns():
    log, truth = simulate.toy_objects()
    graph = fit(log, np.unique(truth.obs_object, return_inverse=True)[1])
    steps, observations, headings = mean_leverages(graph)
    assert not headings.any()  # the log has none
    total = steps.sum() * len(log.odometry) + observations.sum() * log.num_observations
    assert total == pytest.approx(len(linearize(graph)[1]), rel=1e-9)
    assert (steps > 0).all() and (steps <= 1).all() and (observations > 0).all() and (observations < 1).all()


@pytest.mark.parametrize("rounds", [0, 1.5])
def test_rounds_are_whole_numbers(rounds):
    with pytest.raises(ValueError, match=f"rounds: expected a positive integer, got {rounds}"):
        estimate_noise(simulate.toy_objects()[0], rounds)


def test_a_log_that_cannot_tell_is_refused():
    log, _ = simulate.toy_objects()
    standing = replace(log, odometry=np.zeros((0, 3)), obs_time=np.zeros(log.num_observations, int))
    with pytest.raises(ValueError, match="log: expected steps of odometry, got none"):
        estimate_noise(standing)
    once = replace(
        log, obs_time=log.obs_time[:2], obs_xy=np.array([[1.0, 5.0], [1.0, -5.0]]), obs_class=np.zeros(2, int)
    )
    with pytest.raises(ValueError, match="log: expected an object that is seen in more than one pass, found none"):
        estimate_noise(once)
