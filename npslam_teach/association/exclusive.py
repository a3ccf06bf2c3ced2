"""A sweep in which two observations of one frame are two things: each frame is matched with the objects one to one.

The paper's rule asks every observation by itself, so two chairs side by side that are seen together may both go to one
object. Here the weights are the same, but within a frame an object is taken at most once, and the product of all
weights is as large as can be (an assignment problem; Kuhn 1955, "The Hungarian method").
"""

import numpy as np

from npslam_teach.association.headings import SeenHeadings
from npslam_teach.association.likelihood import LEAST_THRESHOLD, PAPER_ALPHA, PAPER_KERNEL_STD, require_rule
from npslam_teach.association.partitions import Association, without_empty_objects
from npslam_teach.association.radius_search import CandidateIndex, search_radius
from npslam_teach.association.sweep import visiting_order

LEAST_BAR = 1e-300  # stands for zero, which has no logarithm; a weight that is not zero exceeds both


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
    headings: SeenHeadings | None = None,
) -> Association:
    """Ask the observations frame by frame which objects they are of; where a frame holds one, this is ``sweep``.

    All observations of a frame take their votes back together, are matched, and vote again. As in ``sweep``, only
    objects within the search radius are looked at.

    Args: as in ``plain_sweep``, and the pose (M,) of each observation. Frames are visited in the order in which
        ``order`` first comes to one of their observations.
    """
    require_rule(alpha, threshold, kernel_std)
    if len(labels) == 0:
        return without_empty_objects(labels, landmarks)
    frames = _frames(obs_time, visiting_order(order, len(labels)))
    everywhere = threshold is not None and threshold < LEAST_THRESHOLD
    radius = np.inf if everywhere else search_radius(alpha, threshold, kernel_std, labels, obs_xy_world, obs_class)
    nearby = CandidateIndex(labels, landmarks, obs_xy_world, obs_class, kernel_std, radius, headings)
    labels, candidates = np.array(labels), nearby.candidates(np.concatenate(frames))
    for frame in frames:
        for k in frame.tolist():
            nearby.votes[obs_class[k]][labels[k]] -= 1.0
        # What an observation opens is no candidate for the others of its frame: theirs are asked for first.
        found = [next(candidates) for _ in frame]
        objects = np.array(sorted({i for _, near, _ in found for i in near}), dtype=int)
        weights = np.zeros((len(frame), len(objects)))
        for row, (k, near, kernels) in zip(weights, found, strict=True):
            votes = nearby.votes[obs_class[k]]
            row[np.searchsorted(objects, near)] = [votes[i] * value for i, value in zip(near, kernels, strict=True)]
        for k, chosen in zip(frame.tolist(), assign(weights, alpha, threshold).tolist(), strict=True):
            if chosen == len(objects):
                nearby.add_object(k)
            labels[k] = objects[chosen] if chosen < len(objects) else len(nearby.votes[obs_class[k]]) - 1
            nearby.votes[obs_class[k]][labels[k]] += 1.0
    return without_empty_objects(labels, nearby.landmarks)


def assign(weights: np.ndarray, alpha: float, threshold: float | None = None) -> np.ndarray:
    """Match the observations of one frame with objects, one to one; the product of the weights is largest.

    Args:
        weights: (m, K), see ``association_weights``.
        alpha: concentration, the weight of a new object.
        threshold: see ``decide``.

    Returns:
        (m,) the object, K for a new one. For a single observation it is what ``decide`` answers.
    """
    # What a weight has to exceed: alpha, or a share of all weights.
    bar = np.full(len(weights), alpha) if threshold is None else threshold * (alpha + weights.sum(axis=1))
    with np.errstate(divide="ignore"):
        gain = np.log(weights) - np.log(np.maximum(bar, LEAST_BAR))[:, None]
    return one_to_one(-gain, 0.0)


def one_to_one(cost: np.ndarray, alternative: float) -> np.ndarray:
    """Match rows with columns so that the total cost is least, where a row without a column costs the alternative.

    Args:
        cost: (m, K), infinite where a match is out of the question. Nothing that costs the alternative is matched.
        alternative: finite.

    Returns:
        (m,) the column of each row, K for none.
    """
    from scipy.optimize import linear_sum_assignment

    num_rows, num_columns = cost.shape
    # A column of its own for every row that stays alone; what costs more than that is never worth it.
    with_alternatives = np.full((num_rows, num_columns + num_rows), alternative)
    with_alternatives[:, :num_columns] = np.minimum(cost, alternative + 1.0)
    rows, chosen = linear_sum_assignment(with_alternatives)
    return np.where(with_alternatives[rows, chosen] < alternative, chosen, num_columns)


def _frames(obs_time: np.ndarray, order: np.ndarray) -> list[np.ndarray]:
    """The observations of every frame, in the order of visits: frames by their first visit."""
    _, first, frame = np.unique(obs_time[order], return_index=True, return_inverse=True)
    by_frame = np.argsort(first[frame], kind="stable")
    ends = np.cumsum(np.unique(first[frame], return_counts=True)[1])[:-1]
    return np.split(order[by_frame], ends)
