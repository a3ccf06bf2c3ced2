"""Which object is it? The association of observations with objects, poses and map held still.

An observation carried into the world lands at some distance d from every object. Every object gets the weight
``votes for the observed class * exp(-d^2 / (2 s^2))``, a new object gets alpha, and the largest wins, or the deck's
threshold decides. One ``sweep`` asks every observation once, and each answer counts for the next question.
"""

import math
from dataclasses import dataclass

import numpy as np

from npslam_teach.candidates import Neighbourhood, reach
from npslam_teach.dirichlet import require_alpha, reweight

PAPER_ALPHA = 0.9
PAPER_KERNEL_STD = math.sqrt(1 / 8)  # m; the published script writes exp(-4 d^2)
LEAST_THRESHOLD = 1e-9  # below it, objects at any distance count


def require_rule(alpha: float, threshold: float | None, kernel_std: float) -> None:
    """Raise ``ValueError`` that names the first setting of the association rule that makes no sense."""
    require_alpha(alpha)
    if threshold is not None and not 0 <= threshold <= 1:
        raise ValueError(f"threshold: expected a probability in [0, 1], got {threshold}")
    if not 1e-6 <= kernel_std <= 1e6:
        raise ValueError(f"kernel_std: expected a length from 1e-6 to 1e6 m, got {kernel_std}")


@dataclass(frozen=True, eq=False)
class Association:
    """The outcome of a sweep: objects without observations are gone, the others are numbered from 0."""

    labels: np.ndarray  # (M,) index of the object, or -1
    landmarks: np.ndarray  # (K, 2) m, W: old objects stay where they were, a new one is where it was seen


def association_weights(
    class_votes: np.ndarray, distance: np.ndarray, kernel_std: float = PAPER_KERNEL_STD
) -> np.ndarray:
    """How well one observation fits each object: ``votes * exp(-d^2 / (2 s^2))``.

    Args:
        class_votes: (K,) each object's votes for the observed class, the observation's own vote not counted.
        distance: (K,) m, from the observation, carried into W, to each object.
        kernel_std: s, m.
    """
    return class_votes * np.exp(-(distance**2) / (2 * kernel_std**2))


def association_probabilities(
    class_votes: np.ndarray,
    distance: np.ndarray,
    alpha: float = PAPER_ALPHA,
    kernel_std: float = PAPER_KERNEL_STD,
) -> np.ndarray:
    """Probabilities that one observation is of each object, or of a new one (deck figures 6 and 7; paper eq. 8).

    Args: as in ``association_weights``, and the concentration alpha.

    Returns:
        (K+1,); the last entry is "new".
    """
    return reweight(association_weights(class_votes, distance, kernel_std), alpha)


def decide(probabilities: np.ndarray, threshold: float | None = None) -> int:
    """Choose an object; the number of objects itself, K, means a new one (deck figure 8).

    Args:
        probabilities: (K+1,); the last entry is "new".
        threshold: None: the most probable wins, as the authors published it. A number: the best match is accepted
            when its probability exceeds it, as the deck tells it. Ties open a new object.
    """
    num_objects = len(probabilities) - 1
    if num_objects == 0:
        return 0
    best = int(np.argmax(probabilities[:-1]))
    bar = probabilities[-1] if threshold is None else threshold
    return best if probabilities[best] > bar else num_objects


def plain_sweep(
    labels: np.ndarray,
    landmarks: np.ndarray,
    obs_xy_world: np.ndarray,
    obs_class: np.ndarray,
    alpha: float = PAPER_ALPHA,
    threshold: float | None = None,
    kernel_std: float = PAPER_KERNEL_STD,
    order: str | np.ndarray = "last-to-first",
) -> Association:
    """Ask every observation once which object it is of (paper algorithm 1, lines 5 to 9; deck step 2.a).

    This is the rule as it is told: every observation is compared with every object. ``sweep`` finds the same labels in
    less time.

    An observation first takes its vote back, so that it is judged by the others; an object left without votes has
    weight zero from then on. Positions stay as they are during the sweep.

    Args:
        labels: (M,) index of the present object of each observation.
        landmarks: (K, 2) m, W.
        obs_xy_world: (M, 2) m, every observation carried into W.
        obs_class: (M,).
        alpha: concentration, the weight of a new object.
        threshold: see ``decide``.
        kernel_std: s, m.
        order: "last-to-first" (the authors'), "first-to-last", or the order itself (M,).
    """
    require_rule(alpha, threshold, kernel_std)
    num_objects, num_observations = len(landmarks), len(labels)
    labels = np.array(labels)
    # Room for every observation to open an object of its own.
    landmarks = np.concatenate([landmarks, np.zeros((num_observations, 2))])
    votes = np.zeros((len(landmarks), obs_class.max(initial=0) + 1))
    np.add.at(votes, (labels, obs_class), 1.0)
    for k in visiting_order(order, num_observations):
        votes[labels[k], obs_class[k]] -= 1.0
        distance = np.linalg.norm(landmarks[:num_objects] - obs_xy_world[k], axis=1)
        probabilities = association_probabilities(votes[:num_objects, obs_class[k]], distance, alpha, kernel_std)
        labels[k] = decide(probabilities, threshold)
        if labels[k] == num_objects:
            landmarks[num_objects] = obs_xy_world[k]
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
) -> Association:
    """Ask every observation once which object it is of: ``plain_sweep`` in a time that grows with the observations.

    An observation is compared only with objects of its class and in its reach. The outcome is that of ``plain_sweep``
    to the last bit: an answer that hangs on rounding is asked for again, the plain way.

    Args: as in ``plain_sweep``.
    """
    require_rule(alpha, threshold, kernel_std)
    order = visiting_order(order, len(labels))
    if len(order) == 0 or (threshold is not None and threshold < LEAST_THRESHOLD):
        return plain_sweep(labels, landmarks, obs_xy_world, obs_class, alpha, threshold, kernel_std, order)
    radius = reach(alpha, threshold, kernel_std, labels, obs_xy_world, obs_class)
    nearby = Neighbourhood(labels, landmarks, obs_xy_world, obs_class, kernel_std, radius)
    labels = np.asarray(labels).tolist()
    for k, objects, kernels in nearby.candidates(order):
        votes = nearby.votes[obs_class[k]]
        votes[labels[k]] -= 1.0
        choice = _choose(votes, objects, kernels, alpha, threshold)
        if choice is None:
            distance = np.linalg.norm(nearby.landmarks - obs_xy_world[k], axis=1)
            choice = decide(association_probabilities(np.array(votes), distance, alpha, kernel_std), threshold)
        if choice == len(votes):
            nearby.open(k)
        votes[choice] += 1.0
        labels[k] = choice
    return without_empty_objects(np.array(labels), nearby.landmarks)


def _choose(votes: list, objects: list, kernels: list, alpha: float, threshold: float | None) -> int | None:
    """What ``decide`` answers when all other objects weigh nothing; None where that hangs on rounding."""
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
    hangs_on_rounding = value <= bar + margin or weight * (1 - 1e-14) < runner_up < weight
    return None if hangs_on_rounding else best


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


def without_empty_objects(labels: np.ndarray, landmarks: np.ndarray) -> Association:
    """Drop objects that no observation belongs to, and number the others in their old order."""
    kept = np.unique(labels[labels >= 0])
    renumbered = np.full(len(landmarks), -1)
    renumbered[kept] = np.arange(len(kept))
    return Association(np.where(labels >= 0, renumbered[labels], -1), landmarks[kept])


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
