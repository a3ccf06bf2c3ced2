"""One pass over all observations: each is asked once which object it is of, and each answer counts for the next.

``plain_sweep`` is the rule of the paper; ``sweep`` finds the same labels in less time. They take the same arguments,
which are written out in both, so that an editor shows them.
"""

import numpy as np

from npslam_teach.association.headings import SeenHeadings, opened_at, turned
from npslam_teach.association.likelihood import (
    LEAST_THRESHOLD,
    PAPER_ALPHA,
    PAPER_KERNEL_STD,
    association_probabilities,
    decide,
    require_rule,
)
from npslam_teach.association.partitions import Association, without_empty_objects
from npslam_teach.association.radius_search import CandidateIndex, search_radius


def plain_sweep(
    labels: np.ndarray,
    landmarks: np.ndarray,
    obs_xy_world: np.ndarray,
    obs_class: np.ndarray,
    alpha: float = PAPER_ALPHA,
    threshold: float | None = None,
    kernel_std: float = PAPER_KERNEL_STD,
    order: str | np.ndarray = "last-to-first",
    headings: SeenHeadings | None = None,
) -> Association:
    """Ask every observation once which object it is of (paper algorithm 1, lines 5 to 9; deck step 2.a).

    This is the rule as published: every observation is compared with every object. ``sweep`` finds the same labels in
    less time.

    An observation first takes its vote back, so that it is judged by the others; an object left without votes has
    weight zero from then on. Positions stay as they are during the sweep.

    Args:
        labels: (M,) index of the present object of each observation.
        landmarks: (K, 2) m, W; (K, 3) with headings, rad.
        obs_xy_world: (M, 2) m, every observation carried into W.
        obs_class: (M,).
        alpha: concentration, the weight of a new object.
        threshold: see ``decide``.
        kernel_std: s, m.
        order: "last-to-first" (the authors'), "first-to-last", or the order itself (M,).
        headings: of the observations, where they count.
    """
    require_rule(alpha, threshold, kernel_std)
    num_objects, num_observations = len(landmarks), len(labels)
    labels = np.array(labels)
    # Room for every observation to open an object of its own.
    landmarks = np.concatenate([landmarks, np.zeros((num_observations, landmarks.shape[1]))])
    votes = np.zeros((len(landmarks), obs_class.max(initial=0) + 1))
    np.add.at(votes, (labels, obs_class), 1.0)
    for k in visiting_order(order, num_observations):
        votes[labels[k], obs_class[k]] -= 1.0
        distance = np.linalg.norm(landmarks[:num_objects, :2] - obs_xy_world[k], axis=1)
        off = turned(headings, k, landmarks[:num_objects])
        probabilities = association_probabilities(votes[:num_objects, obs_class[k]], distance, alpha, kernel_std, off)
        labels[k] = decide(probabilities, threshold)
        if labels[k] == num_objects:
            landmarks[num_objects] = opened_at(obs_xy_world, headings, k)
            num_objects += 1
        votes[labels[k], obs_class[k]] += 1.0
    return without_empty_objects(labels, landmarks)


def sweep(
    labels: np.ndarray,
    landmarks: np.ndarray,
    obs_xy_world: np.ndarray,
    obs_class: np.ndarray,
    alpha: float = PAPER_ALPHA,
    threshold: float | None = None,
    kernel_std: float = PAPER_KERNEL_STD,
    order: str | np.ndarray = "last-to-first",
    headings: SeenHeadings | None = None,
) -> Association:
    """Ask every observation once which object it is of: ``plain_sweep`` in a time that grows with the observations.

    An observation is compared only with objects of its class within a search radius. The outcome is ``plain_sweep``'s
    to the last bit: where rounding could decide, all objects are compared.

    Args: as in ``plain_sweep``.
    """
    require_rule(alpha, threshold, kernel_std)
    order = visiting_order(order, len(labels))
    if len(order) == 0 or (threshold is not None and threshold < LEAST_THRESHOLD):
        return plain_sweep(labels, landmarks, obs_xy_world, obs_class, alpha, threshold, kernel_std, order, headings)
    radius = search_radius(alpha, threshold, kernel_std, labels, obs_xy_world, obs_class)
    nearby = CandidateIndex(labels, landmarks, obs_xy_world, obs_class, kernel_std, radius, headings)
    labels = np.asarray(labels).tolist()
    for k, objects, kernels in nearby.candidates(order):
        votes = nearby.votes[obs_class[k]]
        votes[labels[k]] -= 1.0
        choice = _choose(votes, objects, kernels, alpha, threshold)
        if choice is None:
            landmarks = nearby.landmarks
            distance, off = np.linalg.norm(landmarks[:, :2] - obs_xy_world[k], axis=1), turned(headings, k, landmarks)
            choice = decide(association_probabilities(np.array(votes), distance, alpha, kernel_std, off), threshold)
        if choice == len(votes):
            nearby.add_object(k)
        votes[choice] += 1.0
        labels[k] = choice
    return without_empty_objects(np.array(labels), nearby.landmarks)


def _choose(votes: list, objects: list, kernels: list, alpha: float, threshold: float | None) -> int | None:
    """What ``decide`` answers if all other objects are negligible; None where rounding could decide."""
    best, weight, runner_up = len(votes), 0.0, 0.0
    for i, value in zip(objects, kernels, strict=True):
        rival = votes[i] * value
        if rival > runner_up:
            if rival > weight:
                best, weight, runner_up = i, rival, weight
            else:
                runner_up = rival
    # Without a threshold it is weight against weight; equal ones open a new object, or the object of lower index.
    value, bar, margin = weight, alpha, 1e-14 * alpha
    if threshold is not None:
        total = alpha + sum(votes[i] * value for i, value in zip(objects, kernels, strict=True))
        value, bar, margin = weight / total, threshold, 1e-11
    if value < bar - margin or (threshold is None and value == bar):
        return len(votes)
    rounding_decides = value <= bar + margin or weight * (1 - 1e-14) < runner_up < weight
    return None if rounding_decides else best


def visiting_order(order: str | np.ndarray, num_observations: int) -> np.ndarray:
    """The observations in the order in which a sweep asks them: (M,)."""
    if isinstance(order, str):
        if order not in ("last-to-first", "first-to-last"):
            raise ValueError(f"order: expected last-to-first, first-to-last or a permutation, got {order!r}")
        forward = np.arange(num_observations)
        return forward if order == "first-to-last" else forward[::-1]
    order = np.asarray(order)
    if order.dtype.kind not in "iu" or not np.array_equal(np.sort(order), np.arange(num_observations)):
        raise ValueError(f"order: expected a permutation of 0 .. {num_observations - 1}, got {order}")
    return order
