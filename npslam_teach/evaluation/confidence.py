"""How sure is a share of successes over so many runs? The score interval of Wilson.

A share of 30 runs scatters: 27 of 30 may well be 80 %, or 97 %. The interval holds every true probability under which
the observed count would be no surprise (E. B. Wilson, "Probable inference, the law of succession, and statistical
inference", Journal of the American Statistical Association 22, 1927). Unlike ``share +- 2 std`` it stays within [0, 1]
and has a width at 0 and at n successes as well (R. G. Newcombe, Statistics in Medicine 17, 1998).
"""

from statistics import NormalDist

import numpy as np


def wilson_interval(successes, trials, confidence: float = 0.95) -> tuple[np.ndarray, np.ndarray]:
    """The low and the high end of the probability of success.

    Args:
        successes: (...) counts, each from 0 to its number of trials.
        trials: (...) how many runs, at least one; one number for all, or one each.
        confidence: in (0, 1): in the long run a share of the intervals of about this size holds the true probability.

    Raises:
        ValueError: a count that is none, or more successes than trials.

    Returns:
        (...) the low ends and (...) the high ends.
    """
    successes, trials = np.broadcast_arrays(np.asarray(successes, float), np.asarray(trials, float))
    if not 0 < confidence < 1:
        raise ValueError(f"confidence: expected a share between 0 and 1, got {confidence}")
    if not (np.isfinite(trials).all() and (trials >= 1).all()):
        raise ValueError(f"trials: expected at least one, got {trials.tolist()}")
    if not ((successes >= 0) & (successes <= trials)).all():
        raise ValueError(f"successes: expected from 0 to the number of trials, got {successes.tolist()}")
    z = NormalDist().inv_cdf((1 + confidence) / 2)
    share, rest = successes / trials, z**2 / trials
    middle = (share + rest / 2) / (1 + rest)
    half = z * np.sqrt(share * (1 - share) / trials + rest / (4 * trials)) / (1 + rest)
    # Exactly 0 and 1 at the ends, where rounding would leave a little.
    low = np.where(successes == 0, 0.0, middle - half)
    high = np.where(successes == trials, 1.0, middle + half)
    return low, high
