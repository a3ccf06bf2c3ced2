"""Takeovers: one object comes into view as another leaves it, and a tracklet runs on from the one to the other.

The trajectory bends to suit both, so that residuals do not show it. Each tracklet is therefore judged by a map that was
made without it: there it goes to the object that suits it best, or up to some observation to one and then to another.
What is found must pay in the posterior of all observations, solved anew, before it is kept.
"""

import math

import numpy as np

from npslam_teach import se2
from npslam_teach.association import in_order_of_sight, same_partition
from npslam_teach.association.semantics import class_distances, reports
from npslam_teach.methods.annealing import Model
from npslam_teach.methods.gating import GATE, squared_residuals
from npslam_teach.methods.partition_score import Found, partition_score
from npslam_teach.methods.repair import attached, classes_of, greatest_change
from npslam_teach.pose_graph import fit, levenberg_marquardt, with_associations
from npslam_teach.types import PoseGraph, RobotLog

STEPS = 3  # of the solver without a tracklet
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
    labels, graph = _map_without(log, rest, found.graph, own)
    if len(graph.landmarks) == 0:
        return None
    squared = squared_residuals(log, own[:, None], graph.poses, graph.landmarks)
    squared = squared + class_distances(reports(log)[own], classes_of(log, labels))
    used = labels >= 0
    taken = np.zeros((log.num_poses, len(graph.landmarks)), dtype=bool)
    taken[log.obs_time[used], labels[used]] = True
    labels[own] = one_or_two(np.where(taken[log.obs_time[own]], np.inf, squared))
    labels = attached(log, labels, graph.poses, graph.landmarks)
    labels = in_order_of_sight(labels, labels >= 0)
    return None if same_partition(labels, found.labels) else labels


def _map_without(log: RobotLog, labels: np.ndarray, graph: PoseGraph, own: np.ndarray) -> tuple[np.ndarray, PoseGraph]:
    """What would be without some observations (n,): labels (M,), and the graph with a landmark for each object left."""
    rest = labels.copy()
    rest[own] = -1
    kept = np.unique(rest[rest >= 0])
    rest = np.where(rest >= 0, np.searchsorted(kept, rest), -1)
    start = with_associations(log, graph, rest, graph.landmarks[kept])
    *_, last = levenberg_marquardt(start, max_iterations=STEPS)
    return rest, last.graph


def cut_by_others(log: RobotLog, labels: np.ndarray, graph: PoseGraph, tracklet: np.ndarray) -> np.ndarray:
    """Cut every tracklet where another object may have taken over: where, by a map without it, its place changes most.

    Args:
        log: what was measured.
        labels: (M,) the object of each observation, -1 = of none.
        graph: one landmark for each object, solved.
        tracklet: (M,) of each observation, in the order of the poses; -1 = of none.

    Returns:
        (M,) index of the half, in the order of first sight.
    """
    half = np.zeros(len(tracklet), dtype=int)
    for k in range(tracklet.max(initial=-1) + 1):
        own = np.flatnonzero(tracklet == k)
        poses = _map_without(log, labels, graph, own)[1].poses
        half[own[greatest_change(se2.apply(poses[log.obs_time[own]], log.obs_xy[own])) :]] = 1
    return in_order_of_sight(np.column_stack([tracklet, half]), tracklet >= 0)


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
