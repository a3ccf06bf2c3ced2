"""One decision: weights, probabilities, and which of them is taken."""

import math

import numpy as np
import pytest

from npslam_teach import association


def test_weights_and_probabilities_by_hand():
    """Three votes at distance 0, one vote at half a metre: 3 and e^-1; alpha 0.9."""
    weights = association.association_weights(np.array([3.0, 1.0]), np.array([0.0, 0.5]))
    np.testing.assert_allclose(weights, [3.0, math.exp(-1.0)])
    probabilities = association.association_probabilities(np.array([3.0, 1.0]), np.array([0.0, 0.5]), alpha=0.9)
    total = 3.0 + math.exp(-1.0) + 0.9
    np.testing.assert_allclose(probabilities, [3.0 / total, math.exp(-1.0) / total, 0.9 / total])


@pytest.mark.parametrize(
    ("probabilities", "threshold", "expected"),
    [
        ([0.5, 0.2, 0.3], None, 0),
        ([0.2, 0.3, 0.5], None, 2),
        ([0.5, 0.2, 0.3], 0.6, 2),
        ([0.5, 0.2, 0.3], 0.4, 0),
        ([0.2, 0.1, 0.7], 0.15, 0),  # the deck's rule does not ask how probable "new" is
        ([0.4, 0.2, 0.4], None, 2),  # a tie opens a new object
        ([0.5, 0.2, 0.3], 0.5, 2),
        ([1.0], None, 0),
    ],
)
def test_decide(probabilities, threshold, expected):
    assert association.decide(np.array(probabilities), threshold) == expected


def test_two_single_sightings_can_never_merge_at_alpha_one():
    """The cliff: one vote at distance zero weighs exactly 1."""
    one, zero = np.array([1.0]), np.array([0.0])
    assert association.decide(association.association_probabilities(one, zero, alpha=0.999)) == 0
    assert association.decide(association.association_probabilities(one, zero, alpha=1.0)) == 1
