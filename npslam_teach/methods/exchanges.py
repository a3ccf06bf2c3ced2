"""Exchanges: two objects near each other, each taken for the other in some frames; and what was left out beside them.

Every pair is asked with all frames together, the map held still (``persistence.between_two``). What is found is kept if
it pays in the posterior of all observations, solved anew.
"""

import math

import numpy as np

from npslam_teach.association.semantics import class_distances, reports
from npslam_teach.methods.annealing import Model
from npslam_teach.methods.gating import squared_residuals
from npslam_teach.methods.oriented import turns_of_odometry
from npslam_teach.methods.partition_score import Found, scored
from npslam_teach.methods.persistence import Persistence, between_two, persistence
from npslam_teach.methods.repair import REPAIR_GATE, classes_of, without_gaps
from npslam_teach.pose_graph import squared_radius

ROUNDS = 3


def with_exchanges(model: Model, found: Found) -> Found:
    """Exchange what pays, pair by pair, until nothing does.

    Args:
        model: with the tracklets as they were before any cut.
        found: what is to be improved.
    """
    price = persistence(model.tracklet, model.log.obs_time, model.alpha)
    for _ in range(ROUNDS):
        before, squared = found, _squared_distances(model, found)
        for pair in _rivals(squared, found.labels, price):
            labels = _exchanged(squared, found.labels, pair, price, _log_alone(model, price))
            again = found if labels is None else scored(model, labels, found.graph.poses)
            if again.score > found.score:
                found, squared = again, _squared_distances(model, again)
            if squared.shape[1] < len(before.graph.landmarks):
                break  # one is gone, and the numbers of the others have changed
        if found.score <= before.score + 1e-6:
            break
    return found


def _squared_distances(model: Model, found: Found) -> np.ndarray:
    """Of all observations to all objects, by place, class and heading: (M, K)."""
    log, every = model.log, np.arange(model.log.num_observations)[:, None]
    squared = squared_residuals(log, every, found.graph.poses, found.graph.landmarks)
    squared = squared + class_distances(reports(log), classes_of(log, found.labels))
    if model.headings is None:
        return squared
    return squared + model.headings.squared_turns(found.labels, found.graph.poses[:, 2] - turns_of_odometry(log))


def _rivals(squared: np.ndarray, labels: np.ndarray, price: Persistence) -> list[list[int]]:
    """Pairs of objects of which some observation may be of either; or where one keeps out what may be of the other."""
    used = np.flatnonzero(labels >= 0)
    own = np.where(labels >= 0, squared[np.arange(len(labels)), labels], squared.min(axis=1))
    # An exchange may save two comings, and an observation may be far off for that.
    near = squared < np.minimum(own, squared_radius(REPAIR_GATE))[:, None] - 4 * price.log_coming
    either = np.zeros((squared.shape[1],) * 2, dtype=bool)
    np.logical_or.at(either, labels[used], near[used])
    for k in np.flatnonzero(labels < 0):
        nearest = np.argsort(squared[k])[:2]
        either[nearest[0], nearest[-1]] |= near[k, nearest[0]]
        others = used[price.look[used] == price.look[k]]
        others = others[near[k, labels[others]]]
        np.logical_or.at(either, labels[others], near[others])
    return np.argwhere(np.triu(either | either.T, 1)).tolist()


def _exchanged(squared, labels: np.ndarray, pair: list[int], price: Persistence, log_alone: float) -> np.ndarray | None:
    """Labels (M,) with the observations of two objects, and what is of none, each where it is best; None: as now."""
    near = (squared[:, pair] < -2 * (log_alone + price.log_coming)).any(axis=1)
    own = np.flatnonzero(np.isin(labels, pair) | ((labels < 0) & near))
    found = between_two(squared[np.ix_(own, pair)], price.look[own], price.log_coming, log_alone)
    found = np.where(found < 0, -1, np.array(pair)[found])
    if (found == labels[own]).all():
        return None
    labels = labels.copy()
    labels[own] = found
    return labels if np.isin(pair, labels).all() else without_gaps(labels)


def _log_alone(model: Model, price: Persistence) -> float:
    """That an observation is an object of its own, as against one of an object exactly at its place."""
    log_density = -math.log(2 * math.pi * math.prod(model.log.observation_std))
    return math.log(model.alpha / model.area) - log_density + price.log_pass + price.log_coming
