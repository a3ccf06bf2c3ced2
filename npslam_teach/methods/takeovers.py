"""Takeovers: one object comes into view as another leaves it, and a tracklet runs on from the one to the other.

The trajectory bends to suit both, so that residuals do not show it. Each tracklet is therefore judged by a map that was
made without it: there it goes to the object that suits it best, or up to some observation to one and then to another.
What is found must pay in the posterior of all observations, solved anew, before it is kept.
"""

import math

import numpy as np

from npslam_teach.association import in_order_of_sight
from npslam_teach.association.semantics import class_distances, reports
from npslam_teach.methods.annealing import Model
from npslam_teach.methods.gating import GATE, squared_residuals
from npslam_teach.methods.partition_score import Found, partition_score
from npslam_teach.methods.repair import attached, classes_of
from npslam_teach.pose_graph import fit, levenberg_marquardt, with_associations
from npslam_teach.types import PoseGraph, RobotLog

STEPS = 2  # of the solver without a tracklet
ROUNDS = 3


def with_takeovers(model: Model, found: Found) -> Found:
    """Ask every tracklet anew, by a map made without it, until none pays any more.

    Args:
        model: with the tracklets as they were before any cut.
        found: what is to be improved.
    """
    for _ in range(ROUNDS):
        before = found.score
        for tracklet in range(len(model.rivals)):
            labels = _asked_anew(model, found, np.flatnonzero(model.tracklet == tracklet))
            if labels is not None:
                graph = fit(model.log, labels, found.graph.poses)
                score = partition_score(model, labels, graph)
                if score > found.score:
                    found = Found(labels, graph, score)
        if found.score <= before + 1e-6:
            return found
    return found


def _asked_anew(model: Model, found: Found, own: np.ndarray) -> np.ndarray | None:
    """Labels (M,) with a tracklet's observations (n,) where a map without them says; None: where they are."""
    log, rest = model.log, np.where(model.tracklet < 0, -1, found.labels)  # these go where they fit, afterwards
    kept, labels, graph = _map_without(log, rest, found.graph, own)
    if len(kept) == 0:
        return None
    squared = squared_residuals(log, own[:, None], graph.poses, graph.landmarks)
    squared = squared + class_distances(reports(log)[own], classes_of(log, labels))
    used = labels >= 0
    taken = np.zeros((log.num_poses, len(graph.landmarks)), dtype=bool)
    taken[log.obs_time[used], labels[used]] = True
    labels[own] = one_or_two(np.where(taken[log.obs_time[own]], np.inf, squared))
    if np.array_equal(np.append(kept, -1)[labels[own]], found.labels[own]):
        return None
    labels = attached(log, labels, graph.poses, graph.landmarks)
    return in_order_of_sight(labels, labels >= 0)


def _map_without(log: RobotLog, labels: np.ndarray, graph: PoseGraph, own: np.ndarray):
    """What would be without some observations (n,): the objects left (K,), labels (M,) by these, the graph of them."""
    rest = labels.copy()
    rest[own] = -1
    kept = np.unique(rest[rest >= 0])
    rest = np.where(rest >= 0, np.searchsorted(kept, rest), -1)
    start = with_associations(log, graph, rest, graph.landmarks[kept])
    *_, last = levenberg_marquardt(start, max_iterations=STEPS)
    return kept, rest, last.graph


def one_or_two(squared: np.ndarray) -> np.ndarray:
    """One object for all observations of a tracklet, or one up to some observation and then another.

    Args:
        squared: (n, K) squared distances of the observations, in time, to the objects; infinite: impossible.

    Returns:
        (n,) indices of the objects; -1 for all where nothing is possible.
    """
    count = len(squared)
    sums = np.vstack([np.zeros(squared.shape[1]), np.cumsum(squared, axis=0)])
    after = np.vstack([np.cumsum(squared[::-1], axis=0)[::-1], np.zeros(squared.shape[1])])
    cost = sums.min(axis=1) + after.min(axis=1)  # cut before each observation; the first: not cut at all
    cost[1:count] -= 2 * (math.log(1 - GATE) - math.log(2 * max(count - 1, 1)))
    cut = int(cost[:count].argmin())
    if not np.isfinite(cost[cut]):
        return np.full(count, -1)
    return np.where(np.arange(count) < cut, sums[cut].argmin(), after[cut].argmin())
