"""Runs drawn from the prior: the restaurant's frequencies, a uniform square, and noise of the size that is said."""

import numpy as np
import pytest

from npslam_teach import se2
from npslam_teach.simulate.from_prior import CORNER, chairs_from_prior

STEPS = np.array([[1.0, 0, 0.5], [2.0, 0, 0.5]])
STDS = (0.2, 0.1, 0.05), (0.1, 0.3)


def draw(rng, **settings):
    return chairs_from_prior(rng, STEPS, (0, 1, 2), *STDS, **settings)


def test_without_noise_everything_is_where_it_is_seen():
    log, truth = draw(np.random.default_rng(0), noise=0.0)
    np.testing.assert_allclose(log.odometry, STEPS)
    seen = se2.apply(truth.poses[log.obs_time], log.obs_xy)
    np.testing.assert_allclose(seen, truth.world.object_xy[truth.obs_object], atol=1e-12)
    assert np.array_equal(log.odometry_std, STDS[0]) and np.array_equal(log.observation_std, STDS[1])


@pytest.mark.parametrize("noise", [1.0, 2.0])
def test_errors_are_so_many_times_what_the_log_says(noise):
    rng, steps, sights = np.random.default_rng(1), [], []
    for _ in range(1500):
        log, truth = draw(rng, noise=noise)
        steps.append(log.odometry - STEPS)
        true_xy = se2.apply_inverse(truth.poses[log.obs_time], truth.world.object_xy[truth.obs_object])
        sights.append(log.obs_xy - true_xy)
    np.testing.assert_allclose(np.concatenate(steps).std(axis=0), noise * np.array(STDS[0]), rtol=0.06)
    np.testing.assert_allclose(np.concatenate(sights).std(axis=0), noise * np.array(STDS[1]), rtol=0.06)


@pytest.mark.parametrize("alpha", [0.5, 2.0])
def test_who_is_who_is_a_chinese_restaurant(alpha):
    """Of three guests all sit together with probability 2 / (1 + alpha)(2 + alpha), all apart with alpha^2 / ..."""
    rng = np.random.default_rng(2)
    chairs = [draw(rng, alpha=alpha)[1].obs_object.max() + 1 for _ in range(4000)]
    share = np.bincount(chairs, minlength=4)[1:] / len(chairs)
    below = (1 + alpha) * (2 + alpha)
    np.testing.assert_allclose(share, [2 / below, 3 * alpha / below, alpha**2 / below], atol=0.03)


def test_chairs_are_uniform_over_the_square():
    rng = np.random.default_rng(3)
    xy = np.concatenate([draw(rng, side=3.0)[1].world.object_xy for _ in range(1500)]) - CORNER
    assert (xy >= 0).all() and (xy <= 3).all()
    np.testing.assert_allclose(xy.mean(axis=0), 1.5, atol=0.08)
    np.testing.assert_allclose(xy.std(axis=0), 3 / np.sqrt(12), rtol=0.06)


def test_the_same_seed_draws_the_same():
    first, second = (draw(np.random.default_rng(5))[0] for _ in range(2))
    np.testing.assert_array_equal(first.obs_xy, second.obs_xy)
    np.testing.assert_array_equal(first.odometry, second.odometry)


def test_wrong_steps_are_named():
    with pytest.raises(ValueError, match="steps"):
        chairs_from_prior(np.random.default_rng(0), np.zeros((2, 2)), (0,), *STDS)
