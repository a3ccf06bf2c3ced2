"""Soft association: every observation is of several objects at once, each with its probability (semantic SLAM by EM).

The deck's first complaint is that classes never enter the solver. Here what an observation *is* and where it *stands*
decide together how probable each association is, and the pose graph is solved with all of them, each factor as strong
as it is probable (Bowman, Atanasov, Daniilidis and Pappas, "Probabilistic data association for semantic SLAM", 2017).

1. Where does it begin? With the map of the filter, whose gates look at classes as well.
2. E-step: the probability of each pair in a frame, summed over all one-to-one matchings (``association.matchings``).
3. M-step: objects' classes by Bayes' rule, and the weighted pose graph solved. Repeat.
4. EM keeps the number of objects. Two that are one, by position and class, are joined, and EM goes on.

With ``mixture="max"`` only the best matching of each frame counts: the max-mixture of Olson and Agarwal ("Inference on
networks of mixtures for robust robot mapping", IJRR 2013; Doherty, Baxter, Schneeweiss and Leonard, ICRA 2020).
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from npslam_teach.association import one_to_one, without_empty_objects
from npslam_teach.association.matchings import matching_probabilities
from npslam_teach.association.semantics import beliefs, class_distances, reports
from npslam_teach.methods.ekf_slam import run_filter
from npslam_teach.methods.gating import (
    GATE,
    NEW_GATE,
    frames_with_observations,
    seen_together,
    squared_gates,
    squared_mahalanobis,
    squared_residuals,
)
from npslam_teach.methods.noise import observation_covariances, with_noise
from npslam_teach.methods.oriented import without_headings
from npslam_teach.methods.snapshots import initial_snapshot, snapshot
from npslam_teach.pose_graph import fit, optimize, with_associations
from npslam_teach.pose_graph.reduced_system import reduced_system
from npslam_teach.system.progress import track
from npslam_teach.types import ObservationFactors, PoseGraph, RobotLog, Snapshot

MIXTURES = ("sum", "max")
LEAST_WEIGHT = 1e-3  # a pair that is less probable adds nothing that could be seen
SETTLED = 1e-3  # EM ends when no probability has changed by more
LEAST_SEEN = 0.5  # observations that are expected of an object, below which it is none
OTHER = 30.0  # squared distance beyond which a pair is out of the question: one in 3 million right ones
_NO_FACTORS = ObservationFactors([], [], np.zeros((0, 2)), np.zeros((0, 2, 2)))


class Pairs(NamedTuple):
    """Observations and objects that may belong together, and how probably they do."""

    observation: np.ndarray  # (P,)
    object: np.ndarray  # (P,)
    weight: np.ndarray  # (P,) probability


def soft_em(
    log: RobotLog,
    iterations: int = 50,
    *,
    mixture: str = "sum",
    gate: float = GATE,
    odometry_std=None,
    observation_std=None,
) -> Iterator[Snapshot]:
    """Alternate the probabilities of all associations with a pose graph that is weighted by them.

    Args:
        log: what the robot measured; ``class_probabilities`` count where it has them.
        iterations: at most so many rounds of EM.
        mixture: "sum": all matchings of a frame, each as probable as it is; "max": the best one alone.
        gate: to be of no object is as probable as a match at this gate, which so many right matches pass.
        odometry_std: (3,) m, m, rad per step; None: what the log says.
        observation_std: (2,) m; None: what the log says.

    Yields:
        the frame-by-frame start; the filter's map, smoothed; then a snapshot after each round of EM, which ends when no
        probability changes and no two objects are one. A label is the object of the most probable matching, or -1.
    """
    if mixture not in MIXTURES:
        raise ValueError(f"mixture: expected one of {', '.join(MIXTURES)}, got {mixture!r}")
    if iterations != int(iterations) or iterations < 1:
        raise ValueError(f"iterations: expected a positive integer, got {iterations}")
    gates = gate, max(gate, NEW_GATE)
    bound, _ = squared_gates(*gates)
    log = with_noise(without_headings(log), odometry_std, observation_std)
    yield initial_snapshot(log)
    if log.num_observations == 0:
        return
    labels = run_filter(log, *gates).labels
    graph, pairs = fit(log, labels), _certain(labels)
    yield snapshot(log, 1, labels, graph)
    for iteration in track(range(2, 2 + int(iterations)), int(iterations), "soft-em", "iterations"):
        before = pairs
        graph, pairs = em_round(log, graph, pairs, bound, mixture)
        labels = best_labels(log, graph, pairs, bound)
        yield _with_labels(log, iteration, labels, graph)
        if _change(before, pairs) <= SETTLED:
            copies = same_objects(log, graph, pairs, labels, bound)
            if np.array_equal(copies, np.arange(len(copies))):
                break
            graph, pairs = joined(graph, pairs, copies)


def em_round(
    log: RobotLog, graph: PoseGraph, pairs: Pairs, bound: float, mixture: str = "sum"
) -> tuple[PoseGraph, Pairs]:
    """E-step and M-step: the probabilities of all pairs, and the graph solved that is weighted by them.

    Args:
        log: what the robot measured.
        graph: to begin with, K objects.
        pairs: whose weights say what class each object is.
        bound: squared distance of a match that is as probable as none.
        mixture: one of MIXTURES.
    """
    graph, pairs = without_unseen(graph, expected(log, graph, pairs, bound, mixture))
    return optimize(weighted(log, graph, pairs)), pairs


def expected(log: RobotLog, graph: PoseGraph, pairs: Pairs, bound: float, mixture: str = "sum") -> Pairs:
    """E-step: how probable each pair is, map and trajectory held still. Arguments as in ``em_round``."""
    distance, found = distances(log, graph, pairs), []
    for observations in frames_with_observations(log):
        own = distance[observations]
        if mixture == "sum":
            weight = matching_probabilities(np.where(own < OTHER, np.exp((bound - own) / 2), 0.0))
        else:
            weight = np.eye(own.shape[1] + 1)[one_to_one(own, bound)][:, :-1]
        row, column = np.nonzero(weight > LEAST_WEIGHT)
        found.append((observations[row], column, weight[row, column]))
    return Pairs(*(np.concatenate(parts) for parts in zip(*found, strict=True)))


def distances(log: RobotLog, graph: PoseGraph, pairs: Pairs) -> np.ndarray:
    """(M, K): squared, in standard deviations, of position and class together."""
    where = squared_residuals(log, np.arange(log.num_observations)[:, None], graph.poses, graph.landmarks)
    return where + class_distances(reports(log), class_belief(log, pairs, len(graph.landmarks)))


def class_belief(log: RobotLog, pairs: Pairs, num_objects: int) -> np.ndarray:
    """M-step of the classes: (K, C) logarithms; each observation counts as much as it is of the object.

    Args:
        log: what the robot measured.
        pairs: which observations are of which objects.
        num_objects: K.
    """
    return beliefs(reports(log)[pairs.observation], pairs.object, num_objects, pairs.weight)


def weighted(log: RobotLog, graph: PoseGraph, pairs: Pairs) -> PoseGraph:
    """M-step of the map: a factor for every pair, its information as much as it is probable."""
    information = np.linalg.inv(observation_covariances(log)[pairs.observation]) * pairs.weight[:, None, None]
    seen = pairs.observation
    factors = ObservationFactors(log.obs_time[seen], pairs.object, log.obs_xy[seen], information)
    return replace(graph, observations=factors)


def without_unseen(graph: PoseGraph, pairs: Pairs) -> tuple[PoseGraph, Pairs]:
    """Without objects of which less than half an observation is expected: others have taken over what was theirs."""
    kept = np.bincount(pairs.object, pairs.weight, minlength=len(graph.landmarks)) >= LEAST_SEEN
    own = kept[pairs.object]
    number = np.cumsum(kept) - 1
    pairs = Pairs(pairs.observation[own], number[pairs.object[own]], pairs.weight[own])
    return replace(graph, landmarks=graph.landmarks[kept], observations=_NO_FACTORS), pairs


def best_labels(log: RobotLog, graph: PoseGraph, pairs: Pairs, bound: float) -> np.ndarray:
    """(M,) the object of each observation in the most probable matching of its frame; -1 = none."""
    distance, labels = distances(log, graph, pairs), np.full(log.num_observations, -1)
    for observations in frames_with_observations(log):
        chosen = one_to_one(distance[observations], bound)
        labels[observations] = np.where(chosen < distance.shape[1], chosen, -1)
    return labels


def same_objects(log: RobotLog, graph: PoseGraph, pairs: Pairs, labels: np.ndarray, bound: float) -> np.ndarray:
    """Which objects are others once more: (K,) the number of the one that each is.

    Two are one where position, with its joint covariance, and class agree as well as a match at the gate, and no
    frame shows both. The nearest first, each once.

    Args: as in ``em_round``, and the labels (M,) of the most probable matching.
    """
    count = len(graph.landmarks)
    cov = np.linalg.inv(reduced_system(graph).information).reshape(count, 2, count, 2)
    i, j = np.triu_indices(count, 1)
    spread = cov[i, :, i] + cov[j, :, j] - cov[i, :, j] - cov[j, :, i]
    belief = class_belief(log, pairs, count)
    distance = (
        squared_mahalanobis(graph.landmarks[i] - graph.landmarks[j], spread) + class_distances(belief, belief)[i, j]
    )
    together = seen_together(log, labels, count)
    copies = np.arange(count)
    for k in np.argsort(distance, kind="stable"):
        if distance[k] >= bound:
            break
        free = copies[i[k]] == i[k] and copies[j[k]] == j[k] and np.count_nonzero(copies == j[k]) == 1
        if free and not together[i[k], j[k]]:
            copies[j[k]] = i[k]
    return copies


def joined(graph: PoseGraph, pairs: Pairs, copies: np.ndarray) -> tuple[PoseGraph, Pairs]:
    """The objects without those that are others once more, whose observations go to these."""
    kept = np.unique(copies)
    place = np.searchsorted(kept, copies[pairs.object])
    return replace(graph, landmarks=graph.landmarks[kept], observations=_NO_FACTORS), pairs._replace(object=place)


def _certain(labels: np.ndarray) -> Pairs:
    used = np.flatnonzero(labels >= 0)
    return Pairs(used, labels[used], np.ones(len(used)))


def _change(before: Pairs, after: Pairs) -> float:
    """The largest change of a probability; infinite where objects have gone."""
    count = after.object.max(initial=-1) + 1
    if before.object.max(initial=-1) + 1 != count:
        return np.inf
    size = max(before.observation.max(initial=0), after.observation.max(initial=0)) + 1
    dense = np.zeros((size, count))
    np.add.at(dense, (after.observation, after.object), after.weight)
    np.add.at(dense, (before.observation, before.object), -before.weight)
    return float(np.abs(dense).max(initial=0.0))


def _with_labels(log: RobotLog, iteration: int, labels: np.ndarray, graph: PoseGraph) -> Snapshot:
    """The map that EM has found, its observations tied to their most probable objects."""
    used = without_empty_objects(labels, graph.landmarks)
    return snapshot(log, iteration, used.labels, with_associations(log, graph, used.labels, used.landmarks))
