"""The noise of a log: one for all, or a covariance for each, and what the methods make of it."""

from dataclasses import replace

import numpy as np
import pytest

from npslam_teach import simulate
from npslam_teach.evaluation.clustering import compare_partitions
from npslam_teach.methods import METHODS
from npslam_teach.methods.noise import (
    block_diagonal,
    observation_covariances,
    range_bearing_covariances,
    step_covariances,
    with_noise,
)
from npslam_teach.pose_graph import chi2, fit


def with_covariances(log):
    """The same noise, said for every step and observation."""
    return replace(log, odometry_cov=step_covariances(log), observation_cov=observation_covariances(log))


@pytest.mark.parametrize("method", [pytest.param("posterior", marks=pytest.mark.slow), "ekf"])
def test_the_same_noise_said_of_each_gives_the_same_answer(method):
    log, _ = simulate.fifteen_objects(3, noise=2.0)
    settings = {"starts": 1} if method == "posterior" else {}  # a second search asks no more of the noise
    *_, one = METHODS[method](log, **settings)
    *_, each = METHODS[method](with_covariances(log), **settings)
    np.testing.assert_array_equal(one.labels, each.labels)
    np.testing.assert_allclose(one.graph.poses, each.graph.poses, atol=1e-9)
    assert each.chi2 == pytest.approx(one.chi2, rel=1e-9)


def test_given_standard_deviations_are_for_all():
    log, truth = simulate.toy_objects()
    plain = with_noise(with_covariances(log), (0.1, 0.1, 0.1), (0.2, 0.2))
    assert plain.odometry_cov is None and plain.observation_cov is None
    assert plain.observation_std.tolist() == [0.2, 0.2]
    labels = np.unique(truth.obs_object, return_inverse=True)[1]
    given = fit(with_covariances(log), labels, odometry_std=(0.1, 0.1, 0.1), observation_std=(0.2, 0.2))
    assert chi2(given) == pytest.approx(chi2(fit(plain, labels)), rel=1e-12)


@pytest.mark.parametrize("method", [pytest.param("posterior", marks=pytest.mark.slow), "ekf"])
def test_bad_observations_that_say_so_do_no_harm(method):
    """A third of the observations is six times as noisy; the log says which."""
    rng, right = np.random.default_rng(0), []
    for seed in range(2):
        log, truth = simulate.fifteen_objects(seed, noise=1.0)
        bad = rng.random(log.num_observations) < 1 / 3
        spoilt = log.obs_xy + bad[:, None] * rng.normal(size=log.obs_xy.shape) * np.sqrt(35) * log.observation_std
        cov = observation_covariances(log) * np.where(bad, 36.0, 1.0)[:, None, None]
        *_, last = METHODS[method](replace(log, obs_xy=spoilt, observation_cov=cov))
        used = last.labels >= 0
        right.append((last.num_objects, compare_partitions(truth.obs_object[used], last.labels[used])[0]))
    assert all(ari > 0.97 for _, ari in right), right


def test_errors_along_and_across_the_ray():
    rng = np.random.default_rng(0)
    distance, bearing = rng.uniform(1, 5, 6), rng.uniform(-2, 2, 6)
    polar = np.stack([distance, bearing], axis=1)[:, None] + rng.normal(size=(6, 200_000, 2)) * [0.05, 0.01]
    xy = polar[..., :1] * np.stack([np.cos(polar[..., 1]), np.sin(polar[..., 1])], axis=-1)
    seen = np.column_stack([distance * np.cos(bearing), distance * np.sin(bearing)])
    found = range_bearing_covariances(seen, 0.05, 0.01)
    for points, cov in zip(xy, found, strict=True):
        np.testing.assert_allclose(np.cov(points.T), cov, atol=2e-5)
    with pytest.raises(ValueError, match="range_std: expected positive numbers, got 0.0"):
        range_bearing_covariances(seen, 0, 0.01)
    with pytest.raises(ValueError, match="distances of obs_xy: expected positive numbers"):
        range_bearing_covariances([[0.0, 0.0]], 1, 0.01)


def test_independent_errors_side_by_side():
    blocks = np.arange(8.0).reshape(2, 2, 2)
    whole = [[0, 1, 0, 0], [2, 3, 0, 0], [0, 0, 4, 5], [0, 0, 6, 7]]
    np.testing.assert_array_equal(block_diagonal(blocks), whole)


@pytest.mark.parametrize("name", ["odometry_cov", "observation_cov"])
def test_a_covariance_must_be_one(name):
    log, _ = simulate.toy_objects()
    cov = getattr(with_covariances(log), name).copy()
    cov[1, 0, 1] = 1e-3
    with pytest.raises(ValueError, match=f"{name}: expected symmetric positive definite matrices, got .* at 1"):
        replace(log, **{name: cov})
