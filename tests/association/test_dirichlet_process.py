"""The Chinese restaurant and the votes, against enumeration."""

import math

import numpy as np
import pytest
from partitions import partitions

from npslam_teach import association


@pytest.mark.parametrize("alpha", [0.1, 0.9, 1.0, 5.0])
@pytest.mark.parametrize("n", range(1, 8))
def test_partition_prior_sums_to_one_over_all_partitions(n, alpha):
    total = sum(math.exp(association.log_partition_prior(np.bincount(p), alpha)) for p in partitions(n))
    assert total == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize("alpha", [0.1, 0.9, 5.0])
@pytest.mark.parametrize("n", range(1, 8))
def test_expected_number_of_objects_is_the_mean_over_all_partitions(n, alpha):
    mean = sum((max(p) + 1) * math.exp(association.log_partition_prior(np.bincount(p), alpha)) for p in partitions(n))
    assert association.expected_num_objects(n, alpha) == pytest.approx(mean, rel=1e-12)


def test_expected_number_of_objects_agrees_with_a_simulated_restaurant():
    rng, alpha, n, evenings = np.random.default_rng(0), 2.0, 60, 2000
    tables = np.empty(evenings)
    for evening in range(evenings):
        counts = np.zeros(0)
        for _ in range(n):
            choice = rng.choice(len(counts) + 1, p=association.reweight(counts, alpha))
            counts = np.append(counts, 1.0) if choice == len(counts) else counts + (np.arange(len(counts)) == choice)
        tables[evening] = len(counts)
    error = tables.std() / math.sqrt(evenings)
    assert abs(tables.mean() - association.expected_num_objects(n, alpha)) < 4 * error


def test_seating_guests_one_by_one_gives_the_partition_prior():
    alpha, probability, counts = 0.7, 1.0, np.zeros(0)
    for table in [0, 0, 1, 0, 2, 1, 0]:
        chances = association.reweight(counts, alpha)
        probability *= chances[table]
        counts = np.append(counts, 1.0) if table == len(counts) else counts + (np.arange(len(counts)) == table)
    assert math.log(probability) == pytest.approx(association.log_partition_prior(counts, alpha), rel=1e-12)


def test_reweight_is_the_formula_of_the_deck():
    """m_i / (sum m + alpha) for the old objects, alpha / (sum m + alpha) for a new one."""
    np.testing.assert_allclose(association.reweight(np.array([3.0, 1.0]), 1.0), [0.6, 0.2, 0.2])


def test_votes_and_posterior_by_hand():
    labels, obs_class = np.array([0, 0, 1, 0, -1]), np.array([2, 2, 0, 1, 0])
    votes = association.count_votes(labels, obs_class, num_objects=2, num_classes=3)
    np.testing.assert_array_equal(votes, [[1, 0, 1, 2], [1, 1, 0, 0]])
    np.testing.assert_allclose(association.class_posterior(votes), [[0.25, 0, 0.25, 0.5], [0.5, 0.5, 0, 0]])


@pytest.mark.parametrize(
    ("epsilon", "rejected"),
    [(0.5, [False, False, False]), (0.49, [True, False, False]), (0.33, [True, True, False]), (0.0, [True] * 3)],
)
def test_false_positives_are_those_with_too_few_votes(epsilon, rejected):
    votes = np.array([[1.0, 1.0], [1.0, 2.0], [1.0, 60.0]])
    np.testing.assert_array_equal(association.false_positives(votes, epsilon), rejected)


@pytest.mark.parametrize("alpha", [0.0, -1.0, float("nan"), float("inf")])
def test_alpha_must_be_positive(alpha):
    with pytest.raises(ValueError, match="alpha: expected a positive number, got"):
        association.require_alpha(alpha)
