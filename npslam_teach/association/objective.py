"""The number that the alternation lowers."""

import math

import numpy as np


def objective(chi2: float, votes: np.ndarray, alpha: float, area: float = 1.0) -> float:
    """The number that alternation brings down: minus the log probability, up to a constant (DESIGN section 4).

    ``chi2 / 2 - K log(alpha / area) - sum_i sum_c log Gamma(votes_i[c])``: what the measurements say, and the
    Chinese-restaurant prior over objects of one class, uniform over the area.

    Args:
        chi2: of the graph.
        votes: (K, C+1); column 0, the false-positive vote, is a constant and not counted.
        alpha: concentration.
        area: m^2; the published rule silently assumes 1.
    """
    cast = votes[:, 1:][votes[:, 1:] > 0]
    return chi2 / 2 - len(votes) * math.log(alpha / area) - sum(math.lgamma(count) for count in cast)
