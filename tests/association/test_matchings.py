"""Marginals over one-to-one matchings: dynamic programming against the sum over all of them."""

import numpy as np
import pytest

from npslam_teach.association.matchings import MOST_TOGETHER, matching_probabilities, plain_matching_probabilities


def test_two_observations_and_one_object_by_hand():
    """Matchings: none (1), the first (3), the second (2): six in all."""
    for function in (plain_matching_probabilities, matching_probabilities):
        np.testing.assert_allclose(function(np.array([[3.0], [2.0]])), [[3 / 6], [2 / 6]])


@pytest.mark.parametrize("seed", range(60))
def test_fast_and_plain_agree(seed):
    rng = np.random.default_rng(seed)
    shape = rng.integers(0, 5, 2)
    weights = np.exp(rng.normal(scale=3.0, size=shape)) * (rng.random(shape) < rng.uniform(0.2, 1.0))
    np.testing.assert_allclose(matching_probabilities(weights), plain_matching_probabilities(weights), atol=1e-12)


def test_rows_and_columns_hold_at_most_one():
    weights = np.exp(np.random.default_rng(1).normal(scale=4.0, size=(10, 7)))
    found = matching_probabilities(weights)
    assert (found.sum(axis=0) <= 1 + 1e-9).all() and (found.sum(axis=1) <= 1 + 1e-9).all()


def test_the_order_of_rows_and_columns_says_nothing():
    rng = np.random.default_rng(2)
    weights = np.exp(rng.normal(size=(6, 5)))
    rows, columns = rng.permutation(6), rng.permutation(5)
    shuffled = matching_probabilities(weights[np.ix_(rows, columns)])
    np.testing.assert_allclose(shuffled, matching_probabilities(weights)[np.ix_(rows, columns)], atol=1e-12)


def test_groups_are_independent():
    a, b = np.exp(np.random.default_rng(3).normal(size=(2, 3, 3)))
    whole = np.zeros((6, 6))
    whole[:3, :3], whole[3:, 3:] = a, b
    found = matching_probabilities(whole)
    np.testing.assert_allclose(found[:3, :3], plain_matching_probabilities(a))
    np.testing.assert_allclose(found[3:, 3:], plain_matching_probabilities(b))


def test_two_that_look_alike_are_told_apart_by_exclusion():
    """Each alone is nearer to the first object; together one of them must be of the second."""
    weights = np.array([[50.0, 20.0], [40.0, 10.0]])
    alone = weights / (1 + weights.sum(axis=1, keepdims=True))
    together = matching_probabilities(weights)
    assert (alone.argmax(axis=1) == 0).all()
    assert together[0, 1] > 0.5 and together[1, 0] > 0.5


def test_a_crowd_is_asked_one_by_one():
    weights = np.ones((MOST_TOGETHER + 1, 3))
    np.testing.assert_allclose(matching_probabilities(weights), 0.25)
