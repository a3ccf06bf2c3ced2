"""Gates: which observations of a frame may be of which objects, by Mahalanobis distance, and which are taken.

A pair must be within the gate, and no two observations of a frame share an object. An observation beyond the second
gate of every object is a new one; one in between is left out, because either answer would be a guess (Bar-Shalom, Li
and Kirubarajan, "Estimation with Applications to Tracking and Navigation", 2001).
"""

import numpy as np

from npslam_teach import se2
from npslam_teach.association import one_to_one
from npslam_teach.pose_graph import squared_radius
from npslam_teach.types import RobotLog

GATE, NEW_GATE = 0.99, 0.999999  # shares of right matches that a consistent filter lets through
UNASSIGNED, NEW = -1, -2  # what an observation can be, besides one of a known object


def squared_gates(gate: float, new_gate: float) -> tuple[float, float]:
    """The gates as squared Mahalanobis distances: quantiles of chi-squared with 2 degrees of freedom.

    Raises:
        ValueError: a gate is no probability below 1, or the second is inside the first.
    """
    if not 0 < gate < 1:
        raise ValueError(f"gate: expected a probability between 0 and 1, got {gate}")
    if not gate <= new_gate < 1:
        raise ValueError(f"new_gate: expected a probability from gate = {gate} to below 1, got {new_gate}")
    return squared_radius(gate), squared_radius(new_gate)


def assign(squared_distance: np.ndarray, gate: float, new_gate: float) -> np.ndarray:
    """Match the observations of a frame with the objects, one to one.

    Args:
        squared_distance: (m, K), infinite where a match is out of the question.
        gate: as a squared distance; nothing at or beyond it is matched.
        new_gate: as a squared distance; an observation beyond it from every object is new.

    Returns:
        (m,) the object, UNASSIGNED or NEW.
    """
    chosen = one_to_one(squared_distance, gate)  # to match nothing costs as much as a match at the gate
    far = (squared_distance > new_gate).all(axis=1)
    return np.where(chosen < squared_distance.shape[1], chosen, np.where(far, NEW, UNASSIGNED))


def frames_of(log: RobotLog) -> list[np.ndarray]:
    """The observations of every pose, in the order of the log."""
    in_time = np.argsort(log.obs_time, kind="stable")
    return np.split(in_time, np.searchsorted(log.obs_time[in_time], np.arange(1, log.num_poses)))


def frames_with_observations(log: RobotLog) -> list[np.ndarray]:
    """The same without the poses from which nothing was seen, of which a long log may have many."""
    return [observations for observations in frames_of(log) if len(observations)]


def twice_in_a_frame(log: RobotLog, labels: np.ndarray) -> int:
    """How many observations are of an object that the same frame has seen already; labels (M,), -1 of none."""
    used = labels >= 0
    pairs = np.column_stack([log.obs_time[used], labels[used]])
    return int(len(pairs) - len(np.unique(pairs, axis=0)))


def seen_together(log: RobotLog, labels: np.ndarray, count: int) -> np.ndarray:
    """Which of ``count`` objects, or tracklets, some frame has seen both of: (count, count) bool, the diagonal false.

    Args:
        log: when each observation was made.
        labels: (M,) of each observation, -1 = of none.
        count: above all labels.
    """
    from scipy.sparse import csr_array

    used = labels >= 0
    where = log.obs_time[used], labels[used]
    seen = csr_array((np.ones(len(where[0])), where), shape=(log.num_poses, count))
    together = (seen.T @ seen).toarray() > 0
    np.fill_diagonal(together, False)
    return together


def squared_mahalanobis(innovation: np.ndarray, innovation_cov: np.ndarray) -> np.ndarray:
    """The squared length of an innovation in standard deviations, ``y^T S^-1 y``.

    For right matches it follows chi-squared with as many degrees of freedom as y has numbers.

    Args:
        innovation: (..., d).
        innovation_cov: (..., d, d).
    """
    whitened = np.linalg.solve(innovation_cov, innovation[..., None])[..., 0]
    return (innovation * whitened).sum(axis=-1)


def as_two_degrees(squared: np.ndarray) -> np.ndarray:
    """The squared distance with two degrees of freedom that is as improbable as these (...) are with three.

    So one gate serves for what is measured with and without a heading. The share of chi-squared beyond q is
    ``exp(-q / 2)`` for two, and ``erfc(sqrt(q / 2)) + sqrt(2 q / pi) exp(-q / 2)`` for three.
    """
    from scipy.special import erfcx

    return squared - 2 * np.log(erfcx(np.sqrt(squared / 2)) + np.sqrt(2 * squared / np.pi))


def squared_residuals(log: RobotLog, which, poses: np.ndarray, landmarks: np.ndarray) -> np.ndarray:
    """How far observations lie from where landmarks would be seen, squared, in standard deviations; headings left out.

    Args:
        log: what was measured; the noise of each observation counts.
        which: indices (...) of the observations.
        poses: (T, 3) W.
        landmarks: (..., 2) m, W, one for each or many for all of them.
    """
    off = log.obs_xy[which] - se2.apply_inverse(poses[log.obs_time[which]], landmarks[..., :2])
    if log.observation_cov is None:
        return ((off / log.observation_std) ** 2).sum(axis=-1)
    return squared_mahalanobis(off, log.observation_cov[which])
