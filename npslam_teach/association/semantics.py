"""Classes that a detector confuses: what an observation says of its class, and whether it may be of an object.

A report "cup" of a detector that takes a third of the cups for books does not say *cup*, it says *cup, or perhaps a
book*: a row of likelihoods ``p(report | class)``. An object's class is the product of what its observations say (Bayes'
rule, all classes alike before), and an observation suits an object as well as the two rows agree. Where every row is
certain this is the rule of all other methods: the classes must be equal.
"""

import math

import numpy as np

from npslam_teach.types import RobotLog
from npslam_teach.validation import checked_array, require_distributions

LEAST = math.log(1e-12)  # of the likelihood of a class


def reported(obs_class: np.ndarray, confusion: np.ndarray) -> np.ndarray:
    """What reports say of the true class, through the confusion matrix of their detector (Bayes' rule).

    Args:
        obs_class: (M,) the classes that were reported.
        confusion: (C, C), row c is the distribution of the report when the true class is c.

    Raises:
        ValueError: rows that are no distributions, or a report that no class ever gives.

    Returns:
        (M, C) for ``RobotLog.class_probabilities``; rows sum to one.
    """
    num_classes = len(confusion)
    confusion = checked_array("confusion", confusion, (num_classes, num_classes))
    require_distributions("confusion", confusion)
    likelihood = confusion.T[obs_class]
    total = likelihood.sum(axis=1, keepdims=True)
    if (total == 0).any():
        impossible = np.asarray(obs_class)[(total == 0).ravel()][0]
        raise ValueError(f"confusion: expected a class that is reported as {impossible}, as an observation was")
    return likelihood / total


def evenly_confused(num_classes: int, share: float) -> np.ndarray:
    """A detector (C, C) that is wrong in a share of its reports, every wrong class alike.

    Args:
        num_classes: C.
        share: from 0 to 1; 0 where there is a single class.
    """
    if not 0 <= share <= 1 or (num_classes == 1 and share > 0):
        raise ValueError(f"share: expected a probability (0 for a single class), got {share}")
    if num_classes == 1:
        return np.ones((1, 1))
    return np.where(np.eye(num_classes, dtype=bool), 1.0 - share, share / (num_classes - 1))


def log_likelihoods(obs_class: np.ndarray, num_classes: int, class_probabilities: np.ndarray | None) -> np.ndarray:
    """How much an observation speaks for each class: logarithms (M, C).

    Of probabilities, relative to their mean, which is what an observation of *nothing*, of any class alike, would say.
    Without them a report is certain: 0 for its class, -inf for all others.

    Args:
        obs_class: (M,) the classes that were reported.
        num_classes: C.
        class_probabilities: (M, C), as in ``RobotLog``, or None.
    """
    known = np.eye(num_classes)[obs_class] if class_probabilities is None else num_classes * class_probabilities
    with np.errstate(divide="ignore"):
        return np.log(known)


def reports(log: RobotLog) -> np.ndarray:
    """What every observation of a log says of its class: ``log_likelihoods`` (M, C)."""
    return log_likelihoods(log.obs_class, log.num_classes, log.class_probabilities)


def floored(seen: np.ndarray) -> np.ndarray:
    """The same (..., C), no class ruled out: one report of many must not rule a class out for good."""
    return np.maximum(seen, LEAST)


def combined(seen: np.ndarray, objects: np.ndarray, count: int, weight: np.ndarray | float = 1.0) -> np.ndarray:
    """The sum of what observations say, object by object: logarithms (K, C), not normalised.

    Args:
        seen: (m, C), see ``log_likelihoods``.
        objects: (m,) the object of each observation.
        count: K.
        weight: (m,) how much each observation counts, or the same for all.
    """
    total = np.zeros((count, seen.shape[1]))
    np.add.at(total, objects, np.reshape(weight, (-1, 1)) * seen)
    return total


def normalised(total: np.ndarray) -> np.ndarray:
    """Logarithms of probabilities (K, C) from those of weights (K, C), of which one in each row is finite."""
    total = total - total.max(axis=1, keepdims=True, initial=-np.inf)
    return total - np.log(np.exp(total).sum(axis=1, keepdims=True))


def beliefs(seen: np.ndarray, objects: np.ndarray, count: int, weight: np.ndarray | float = 1.0) -> np.ndarray:
    """What objects may be, by all that is reported of them: logarithms of probabilities (K, C).

    No class is ruled out: a certain report may be of the object with a probability of 0.001 only, or wrongly.

    Args: as of ``combined``.
    """
    return normalised(combined(floored(seen), objects, count, weight))


def class_evidence(total: np.ndarray) -> float:
    """How well the reports of one object agree: the log of their mean likelihood over its classes, all alike before.

    It is 0 for one report whose likelihoods are relative to their mean, and for reports of nothing.

    Args:
        total: (C,) the sum of what they say, see ``combined``.
    """
    largest = float(total.max())
    return largest + math.log(np.exp(total - largest).mean()) if math.isfinite(largest) else largest


def class_evidences(totals: np.ndarray) -> list[float]:
    """``class_evidence`` of many objects (K, C)."""
    largest = totals.max(axis=1)
    finite = np.isfinite(largest)
    mean = np.exp(totals - np.where(finite, largest, 0.0)[:, None]).mean(axis=1)
    pairs = zip(largest.tolist(), mean.tolist(), finite.tolist(), strict=True)
    return [each + math.log(share) if known else each for each, share, known in pairs]


def class_distances(seen: np.ndarray, belief: np.ndarray) -> np.ndarray:
    """What the classes add to the squared Mahalanobis distance: ``-2 log`` of how well they agree.

    It is infinite where the two cannot be of one class, and 0 where they are surely of the same. Of probabilities it is
    negative where they agree better than an observation of nothing would.

    Args:
        seen: (m, C), see ``log_likelihoods``.
        belief: (K, C) logarithms of the probabilities of the objects' classes.

    Returns:
        (m, K).
    """
    with np.errstate(divide="ignore"):
        return -2.0 * np.log(np.exp(seen) @ np.exp(belief).T)


def updated_belief(belief: np.ndarray, seen: np.ndarray) -> np.ndarray:
    """The classes of objects after one more observation each: logarithms (K, C), normalised.

    Args:
        belief: (K, C) logarithms of probabilities; zeros where nothing is known.
        seen: (K, C) what the observations say, see ``log_likelihoods``.

    Raises:
        ValueError: an observation contradicts what is known for sure.
    """
    total = belief + seen
    if np.isneginf(total.max(axis=1, initial=-np.inf)).any():
        raise ValueError("seen: expected observations that some class allows, got one that contradicts its object")
    return normalised(total)
