"""A sweep in which two observations of one frame are two things: each frame is matched with the objects one to one.

The paper's rule asks every observation by itself, so two chairs side by side that are seen together may both go to one
object. Here the weights are the same, but within a frame an object is taken at most once, and the product of all
weights is as large as can be (an assignment problem; Kuhn 1955, "The Hungarian method").
"""

import numpy as np

from npslam_teach.association.likelihood import PAPER_ALPHA, PAPER_KERNEL_STD, association_weights, require_rule
from npslam_teach.association.partitions import Association, without_empty_objects
from npslam_teach.association.sweep import visiting_order

IMPOSSIBLE = 1e6  # a cost that no product of weights reaches


def exclusive_sweep(
    labels: np.ndarray,
    landmarks: np.ndarray,
    obs_xy_world: np.ndarray,
    obs_class: np.ndarray,
    obs_time: np.ndarray,
    alpha: float = PAPER_ALPHA,
    threshold: float | None = None,
    kernel_std: float = PAPER_KERNEL_STD,
    order: str | np.ndarray = "last-to-first",
) -> Association:
    """Ask the observations frame by frame which objects they are of; where a frame holds one, this is ``sweep``.

    All observations of a frame take their votes back together, are matched, and vote again.

    Args: as in ``plain_sweep``, and the pose (M,) of each observation. Frames are visited in the order in which
        ``order`` first comes to one of their observations.
    """
    require_rule(alpha, threshold, kernel_std)
    labels, num_objects = np.array(labels), len(landmarks)
    landmarks = np.concatenate([landmarks, np.zeros((len(labels), 2))])
    votes = np.zeros((len(landmarks), obs_class.max(initial=0) + 1))
    np.add.at(votes, (labels, obs_class), 1.0)
    for frame in _frames(obs_time, visiting_order(order, len(labels))):
        np.subtract.at(votes, (labels[frame], obs_class[frame]), 1.0)
        known = np.flatnonzero((votes[:num_objects, np.unique(obs_class[frame])] > 0).any(axis=1))
        distance = np.linalg.norm(landmarks[known] - obs_xy_world[frame][:, None], axis=2)
        weights = association_weights(votes[known][:, obs_class[frame]].T, distance, kernel_std)
        chosen = assign(weights, alpha, threshold)
        is_new = chosen == len(known)
        labels[frame[~is_new]] = known[chosen[~is_new]]
        labels[frame[is_new]] = num_objects + np.arange(is_new.sum())
        landmarks[labels[frame[is_new]]] = obs_xy_world[frame[is_new]]
        num_objects += int(is_new.sum())
        np.add.at(votes, (labels[frame], obs_class[frame]), 1.0)
    return without_empty_objects(labels, landmarks)


def assign(weights: np.ndarray, alpha: float, threshold: float | None = None) -> np.ndarray:
    """Match the observations of one frame with objects, one to one; the product of the weights is largest.

    Args:
        weights: (m, K), see ``association_weights``.
        alpha: concentration, the weight of a new object.
        threshold: see ``decide``.

    Returns:
        (m,) the object, K for a new one. For a single observation it is what ``decide`` answers.
    """
    from scipy.optimize import linear_sum_assignment

    num_observations, num_objects = weights.shape
    # What a weight has to exceed: alpha, or a share of all weights.
    bar = np.full(num_observations, alpha) if threshold is None else threshold * (alpha + weights.sum(axis=1))
    with np.errstate(divide="ignore"):
        gain = np.log(weights) - np.log(bar)[:, None]
    cost = np.hstack([np.where(gain > 0, -gain, IMPOSSIBLE), np.zeros((num_observations, num_observations))])
    chosen = linear_sum_assignment(cost)[1]
    return np.minimum(chosen, num_objects)


def _frames(obs_time: np.ndarray, order: np.ndarray) -> list[np.ndarray]:
    """The observations of every frame, in the order of visits: frames by their first visit."""
    _, first, frame = np.unique(obs_time[order], return_index=True, return_inverse=True)
    by_frame = np.argsort(first[frame], kind="stable")
    ends = np.cumsum(np.unique(first[frame], return_counts=True)[1])[:-1]
    return np.split(order[by_frame], ends)
