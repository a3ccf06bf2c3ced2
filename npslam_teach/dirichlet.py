"""The Dirichlet process and the Dirichlet distribution, as far as objects need them.

The process says how likely the next observation starts a new object before its position is looked at; the distribution
says what an object is, given the votes of its observations. Counting from one: ``m_i`` observations belong to object i.
"""

import math

import numpy as np

FALSE_POSITIVE = 0  # the column of `votes` that counts against the object's existence


def require_alpha(alpha: float) -> float:
    """Return ``alpha`` if it is a concentration: a positive, finite number; otherwise raise ``ValueError``."""
    if not (math.isfinite(alpha) and alpha > 0):
        raise ValueError(f"alpha: expected a positive number, got {alpha}")
    return float(alpha)


def reweight(weights: np.ndarray, alpha: float) -> np.ndarray:
    """Make room for a new object among the old ones (deck figure 7; paper eq. 8).

    With ``weights = counts`` this is the Chinese-restaurant prior of the deck's formula; with the association weights
    of DESIGN section 4 it is the posterior for one observation.

    Args:
        weights: (K,) non-negative.
        alpha: concentration, the weight of a new object.

    Returns:
        (K+1,) probabilities; the last entry is "new".
    """
    with_new = np.append(weights, alpha)
    return with_new / with_new.sum()


def expected_num_objects(num_observations: int, alpha: float) -> float:
    """How many objects the Chinese restaurant expects among n observations: ``sum_i alpha / (alpha + i)``.

    The i-th guest (from zero) opens a table with probability ``alpha / (alpha + i)``, whoever sits where.
    """
    return float((alpha / (alpha + np.arange(num_observations))).sum())


def log_partition_prior(counts: np.ndarray, alpha: float) -> float:
    """Log probability of one particular partition under the Chinese restaurant (Pitman 2006, eq. 2.19).

    ``alpha^K prod_i (m_i - 1)! / (alpha (alpha + 1) ... (alpha + n - 1))``. The order of arrival does not matter.

    Args:
        counts: (K,) positive, the number of observations of each object.
        alpha: concentration.
    """
    num_observations = int(np.sum(counts))
    seated = sum(math.lgamma(count) for count in counts)
    arrivals = math.lgamma(alpha + num_observations) - math.lgamma(alpha)
    return len(counts) * math.log(alpha) + seated - arrivals


def count_votes(labels: np.ndarray, obs_class: np.ndarray, num_objects: int, num_classes: int) -> np.ndarray:
    """Count the votes for each class of each object (deck figures 9 and 11).

    Args:
        labels: (M,) index of the object; -1 casts no vote.
        obs_class: (M,) in [0, num_classes).
        num_objects: K.
        num_classes: C.

    Returns:
        (K, C+1); column 0 is the false-positive vote, one for every object from the start; class c is column c+1.
    """
    votes = np.zeros((num_objects, num_classes + 1))
    votes[:, FALSE_POSITIVE] = 1.0
    used = labels >= 0
    np.add.at(votes, (labels[used], obs_class[used] + 1), 1.0)
    return votes


def class_posterior(votes: np.ndarray) -> np.ndarray:
    """What each object is: the value of highest likelihood under its votes, ``votes / sum`` (deck step 2.b).

    Args:
        votes: (..., C+1), column 0 = false positive.

    Returns:
        (..., C+1) probabilities.
    """
    return votes / votes.sum(axis=-1, keepdims=True)


def false_positives(votes: np.ndarray, false_positive_threshold: float) -> np.ndarray:
    """Which objects are rather nothing: ``class_posterior[0] > epsilon`` (deck step 4, figure 13).

    With one false-positive vote an object of m observations has ``class_posterior[0] = 1 / (m + 1)``: 0.5 keeps every
    object, a threshold just below 0.5 drops those seen once, below 1/3 those seen twice.

    Args:
        votes: (K, C+1).
        false_positive_threshold: epsilon.

    Returns:
        (K,) bool.
    """
    return class_posterior(votes)[:, FALSE_POSITIVE] > false_positive_threshold
