"""Does it pay? Partitions that cut tracklets, or that take one object for another in a wrong place, are compared."""

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from npslam_teach import se2
from npslam_teach.association import first_observations, in_order_of_sight
from npslam_teach.association.gibbs import GibbsSampler
from npslam_teach.association.partition_posterior import log_posterior, log_prior
from npslam_teach.association.split_merge import displaced
from npslam_teach.methods.annealing import Model, rivals_of
from npslam_teach.methods.gating import GATE
from npslam_teach.methods.persistence import comings, passes, persistence
from npslam_teach.methods.repair import outlier_share, without_gaps
from npslam_teach.pose_graph import fit, mean_landmarks, observation_factors
from npslam_teach.pose_graph.reduced_system import ReducedSystem, reduced_system
from npslam_teach.types import PoseGraph

MOST_OUTLIERS = 0.1  # of all observations; where more lie far out, it is the noise that is described wrongly
OUTLIER_FACTOR = 5.0  # how many standard deviations of an observation an outlier is off, more or less


class Found(NamedTuple):
    """A partition of the observations, solved."""

    labels: np.ndarray  # (M,) the object of each, -1 = of none
    graph: PoseGraph  # one landmark for each object
    score: float  # ``partition_score``


def with_whole_tracklets(model: Model, labels: np.ndarray, poses: np.ndarray) -> Found:
    """Undo cuts of tracklets that do not pay.

    Args:
        model: with the tracklets as they were before any cut.
        labels: (M,) the object of each observation, -1 = of none.
        poses: (T, 3) W, from which the solver sets out.

    """
    graph = fit(model.log, labels, poses)
    score = partition_score(model, labels, graph)
    for k in range(len(model.rivals)):
        whole = _made_whole(labels, np.flatnonzero(model.tracklet == k), model.log.obs_time)
        if whole is not None:
            joined = fit(model.log, whole, graph.poses)
            joined_score = partition_score(model, whole, joined)
            if joined_score > score:
                labels, graph, score = whole, joined, joined_score
    return Found(labels, graph, score)


def partition_score(model: Model, labels: np.ndarray, graph: PoseGraph) -> float:
    """The log posterior of a partition of the observations that may cut tracklets.

    Of many possible cuts one always looks good: a share ``1 - GATE`` of all matches is wrong, and how the cut goes
    is one of many choices (``ways_to_cut``).

    Args:
        model: with the tracklets as they were before any cut.
        labels: (M,) the object of each observation; one that was left out, -1, counts as an object of its own.
        graph: solved for them.
    """
    finer, reduced, of_pass = in_passes(model, labels, graph)
    return log_posterior(finer.evidence(reduced), of_pass) + _log_persistence(model, labels, len(of_pass))


def partition_prior(model: Model, labels: np.ndarray) -> float:
    """What ``partition_score`` of labels (M,) counts beside the places: seats, classes, headings, and comings."""
    piece, of_pass = passes_of(model, labels)
    evidence = model._replace(tracklet=piece, rivals=np.zeros((len(of_pass),) * 2, dtype=bool)).prior()
    members = (np.flatnonzero(of_pass == i).tolist() for i in range(of_pass.max(initial=-1) + 1))
    return sum(log_prior(each, evidence) for each in members) + _log_persistence(model, labels, len(of_pass))


def _log_persistence(model: Model, labels: np.ndarray, count: int) -> float:
    price = persistence(model.log, model.tracklet, model.alpha)
    again = comings(alone(labels), price.look) - price.comings
    return (count - len(model.rivals)) * price.log_draw + again * price.log_coming


def passes_of(model: Model, labels: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    piece = passes(labels, model.log.obs_time)
    return piece, in_order_of_sight(alone(labels)[first_observations(piece)])


def alone(labels):
    return np.where(labels < 0, labels.max(initial=-1) + 1 + np.arange(len(labels)), labels)


def without_displaced(model: Model, labels: np.ndarray, graph: PoseGraph) -> np.ndarray:
    """Labels (M,) in which objects that are others in a wrong place are joined to them, where the log has outliers."""
    share = outlier_share(model.log, graph, labels)
    if not 0.0 < share <= MOST_OUTLIERS:
        return labels
    finer, reduced, of_piece = in_passes(model, labels, graph)
    sampler = GibbsSampler(finer.evidence(reduced), of_piece, np.random.default_rng(0))
    spread = np.diag((OUTLIER_FACTOR * model.log.observation_std) ** 2)
    joined = finer.of_observations(displaced(sampler, share, spread))
    # Two guests of one object may have been seen together: the one of the larger object stays.
    size = np.append(np.bincount(labels[labels >= 0]), 0)[labels]
    order = np.argsort(-size, kind="stable")
    _, first = np.unique(np.column_stack([model.log.obs_time, joined])[order], axis=0, return_index=True)
    return without_gaps(np.where(np.isin(np.arange(len(joined)), order[first]), joined, -1))


def in_passes(model: Model, labels: np.ndarray, graph: PoseGraph) -> tuple[Model, ReducedSystem, np.ndarray]:
    """Tracklets cut by labels (M,), the graph reduced to them, and the object of each piece (N,)."""
    piece, of_piece = passes_of(model, labels)
    return (*in_pieces(model, labels, graph, piece), of_piece)


def in_pieces(model, labels, graph, piece):
    landmarks = mean_landmarks(piece, se2.apply(graph.poses[model.log.obs_time], model.log.obs_xy))
    together = labels[first_observations(piece)]
    landmarks[together >= 0] = graph.landmarks[together[together >= 0]]
    factors = observation_factors(model.log, piece)
    reduced = reduced_system(replace(graph, landmarks=landmarks, observations=factors))
    return model._replace(tracklet=piece, rivals=rivals_of(model.log, piece)), reduced


def _made_whole(labels: np.ndarray, own: np.ndarray, obs_time: np.ndarray) -> np.ndarray | None:
    """All observations of a tracklet (n,) in the object of most of them; None where they are, or cannot be."""
    objects, counts = np.unique(labels[own], return_counts=True)
    home = objects[counts.argmax()]
    there = np.isin(obs_time[labels == home], obs_time[own[labels[own] != home]])
    if len(objects) == 1 or home < 0 or there.any():
        return None
    whole = labels.copy()
    whole[own] = home
    return without_gaps(whole)
