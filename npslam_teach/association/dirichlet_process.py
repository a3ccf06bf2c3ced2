"""The Dirichlet process as the Chinese restaurant: how probable the next observation starts a new object.

That is asked before its position is looked at. Counting from one, ``m_i`` observations belong to object i.
"""

import math

import numpy as np


def require_alpha(alpha: float) -> float:
    """Return ``alpha`` if it is a concentration: a positive, finite number; otherwise raise ``ValueError``."""
    if not (math.isfinite(alpha) and alpha > 0):
        raise ValueError(f"alpha: expected a positive number, got {alpha}")
    return float(alpha)


def require_area(area: float) -> None:
    """Raise ``ValueError`` for an area over which objects cannot be uniform: it is positive and finite, in m^2."""
    if not 0 < area < math.inf:
        raise ValueError(f"area: expected a positive number of square metres, got {area}")


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
