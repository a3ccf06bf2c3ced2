"""What an object is, given the votes of its observations: the Dirichlet distribution over classes (deck step 2.b)."""

import numpy as np

FALSE_POSITIVE = 0  # the column of `votes` that counts against the object's existence


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


def log_density(concentration: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Logarithm of the Dirichlet density (deck figure 10): ``sum (a_i - 1) log x_i - log B(a)``.

    Args:
        concentration: (C,) positive.
        points: (..., C) probabilities, each positive; where one is zero the density may be zero or infinite.

    Returns:
        (...), per unit of the first C - 1 coordinates.
    """
    from scipy.special import gammaln

    concentration = np.asarray(concentration, dtype=float)
    log_beta = gammaln(concentration).sum() - gammaln(concentration.sum())
    return ((concentration - 1) * np.log(points)).sum(axis=-1) - log_beta


def mode(concentration: np.ndarray) -> np.ndarray | None:
    """Where the Dirichlet density is highest: ``(a - 1) / (sum a - C)``, (C,).

    None where there is no such point: with an entry below 1 the density is infinite on an edge, and with all entries 1
    it is the same everywhere.
    """
    # Rounded, because a slider's 1.0 may be the sum of ten steps of 0.1.
    above = np.round(np.asarray(concentration, dtype=float) - 1, 9)
    return above / above.sum() if (above >= 0).all() and above.any() else None
