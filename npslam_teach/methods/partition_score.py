"""Does it pay? The posterior of a partition of all observations, whatever tracklets it cuts."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from npslam_teach import se2
from npslam_teach.association import first_observations
from npslam_teach.association.gibbs import GibbsSampler
from npslam_teach.association.partition_posterior import log_posterior, log_priors
from npslam_teach.association.split_merge import displaced
from npslam_teach.methods.annealing import Model, rivals_of
from npslam_teach.methods.persistence import Persistence, num_comings, passes_of, persistence, singled_out
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


def scored(model: Model, labels: np.ndarray, poses: np.ndarray) -> Found:
    """A partition (M,) solved, from poses (T, 3) W, and its score."""
    graph = fit(model.log, labels, poses)
    return Found(labels, graph, partition_score(model, labels, graph))


def partition_score(model: Model, labels: np.ndarray, graph: PoseGraph) -> float:
    """The log posterior of a partition of the observations.

    Of the tracklets it is that of ``partition_posterior.log_posterior``. A partition that cuts them, or takes up what
    they left out, has other passes and lets things come into view more often or less: ``persistence``.

    Args:
        model: with the tracklets as they were before any cut.
        labels: (M,) the object of each observation; one that was left out, -1, counts as an object of its own.
        graph: solved for them.
    """
    number, of_pass = passes_of(labels, model.log.obs_time)
    finer, reduced = in_pieces(model, labels, graph, number)
    price = persistence(model.tracklet, model.log.obs_time, model.alpha)
    return log_posterior(finer.evidence(reduced), of_pass) + _log_within_passes(model, labels, number, price)


def partition_prior(model: Model, labels: np.ndarray, price: Persistence) -> float:
    """What ``partition_score`` of labels (M,) counts beside the places: seats, classes, headings and persistence."""
    number, of_pass = passes_of(labels, model.log.obs_time)
    evidence = model._replace(tracklet=number).prior()
    return log_priors(of_pass, evidence) + _log_within_passes(model, labels, number, price)


def _log_within_passes(model: Model, labels: np.ndarray, number: np.ndarray, price: Persistence) -> float:
    """What does not show in the posterior of passes, (M,) of each observation: their number, comings and headings."""
    again = price.log_prior(num_comings(singled_out(labels), price.look), int(number.max()) + 1)
    return again + (0.0 if model.headings is None else model.headings.agreement_within(number))


def without_displaced(model: Model, labels: np.ndarray, graph: PoseGraph) -> np.ndarray:
    """Labels (M,) in which objects that are others in a wrong place are joined to them, where the log has outliers."""
    share = outlier_share(model.log, graph, labels)
    if not 0.0 < share <= MOST_OUTLIERS:
        return labels
    number, of_pass = passes_of(labels, model.log.obs_time)
    finer, reduced = in_pieces(model, labels, graph, number)
    sampler = GibbsSampler(finer.evidence(reduced), of_pass, np.random.default_rng(0))
    spread = np.diag((OUTLIER_FACTOR * model.log.observation_std) ** 2)
    joined = finer.of_observations(displaced(sampler, share, spread))
    # Two guests of one object may have been seen together: the one of the larger object stays.
    size = np.append(np.bincount(labels[labels >= 0]), 0)[labels]
    order = np.argsort(-size, kind="stable")
    _, first = np.unique(np.column_stack([model.log.obs_time, joined])[order], axis=0, return_index=True)
    return without_gaps(np.where(np.isin(np.arange(len(joined)), order[first]), joined, -1))


def in_pieces(model: Model, labels: np.ndarray, graph: PoseGraph, piece: np.ndarray) -> tuple[Model, ReducedSystem]:
    """The model of other tracklets, and the graph reduced to them.

    Args:
        model: the log and the prior.
        labels: (M,) the object of each observation, -1 = of none.
        graph: one landmark for each object, solved.
        piece: (M,) the tracklet of each observation, of one object each.
    """
    landmarks = mean_landmarks(piece, se2.apply(graph.poses[model.log.obs_time], model.log.obs_xy))
    together = labels[first_observations(piece)]
    landmarks[together >= 0] = graph.landmarks[together[together >= 0]]
    reduced = reduced_system(replace(graph, landmarks=landmarks, observations=observation_factors(model.log, piece)))
    return model._replace(tracklet=piece, rivals=rivals_of(model.log, piece)), reduced
