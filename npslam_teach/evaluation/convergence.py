"""Have the chains of a sampler forgotten where they began, and how many independent samples are they worth?

R-hat compares the spread between chains, each cut in two, with that within them; the effective sample size adds up
their autocorrelation as long as it is positive in pairs (Gelman et al., "Bayesian Data Analysis", 2013, sections 11.4
and 11.5; Geyer 1992).
"""

import numpy as np

ROUNDING = 1e-9  # relative: a number that changes by less than this does not change


def r_hat(chains: np.ndarray) -> float:
    """Near 1 when the chains agree; above 1.05 they do not. 1 where nothing ever changes, in all chains alike.

    Args:
        chains: (C, n) a number of every sample, at least two.
    """
    halves = _halves(chains)
    within, between = halves.var(axis=1, ddof=1).mean(), halves.mean(axis=1).var(ddof=1)
    if within == 0:
        return 1.0 if between == 0 else float("inf")
    length = halves.shape[1]
    return float(np.sqrt((length - 1) / length + between / within))


def effective_sample_size(chains: np.ndarray) -> float:
    """How many independent samples tell as much about the mean; all of them where nothing ever changes.

    Args:
        chains: (C, n) a number of every sample.
    """
    halves = _halves(chains)
    count, length = halves.shape
    centred = halves - halves.mean(axis=1, keepdims=True)
    within, between = halves.var(axis=1, ddof=1).mean(), halves.mean(axis=1).var(ddof=1)
    total = (length - 1) / length * within + between
    if total == 0:
        return float(chains.size)
    power = np.abs(np.fft.rfft(centred, 2 * length, axis=1)) ** 2
    autocovariance = np.fft.irfft(power, axis=1)[:, :length].mean(axis=0) / length
    correlation = 1 - (within - autocovariance * length / (length - 1)) / total
    pairs = correlation[1 : length - length % 2 - 1].reshape(-1, 2).sum(axis=1)
    positive = len(pairs) if (pairs > 0).all() else int(np.argmax(pairs <= 0))
    return float(min(chains.size, count * length / (1 + 2 * max(pairs[:positive].sum(), 0.0))))


def _halves(chains: np.ndarray) -> np.ndarray:
    chains = np.asarray(chains, dtype=float)
    if chains.ndim != 2 or chains.shape[1] < 4:
        raise ValueError(f"chains: expected an array (C, n) with n at least 4, got shape {chains.shape}")
    if np.ptp(chains) <= ROUNDING * (1.0 + np.abs(chains).max()):
        chains = np.zeros_like(chains)
    length = chains.shape[1] // 2
    return np.concatenate([chains[:, :length], chains[:, -length:]])
