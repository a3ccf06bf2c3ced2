"""The last nats: partitions that the linear model holds nearly as good are compared, each around its own solution.

A sampler sees all partitions through one linear model, made around one of them; another's own best trajectory may be
better than that model believes. Those within a margin are therefore solved and scored themselves.
"""

import numpy as np

from npslam_teach.association import in_order_of_sight
from npslam_teach.association.gibbs import GibbsSampler
from npslam_teach.association.partition_posterior import log_posterior
from npslam_teach.association.split_merge import split_or_merge
from npslam_teach.methods.annealing import Model, State, solved
from npslam_teach.pose_graph.reduced_system import reduced_system
from npslam_teach.types import PoseGraph

MARGIN = 3.0  # of the log posterior: how far a linear model may be off
STEPS = 20  # of the solver, for one partition
SWEEPS = 60  # of a chain that looks around


def polished(model: Model, state: State) -> State:
    """Move to the rival with the highest log posterior as long as one is better.

    Args:
        model: with N tracklets.
        state: the best of a search. Its log posterior is replaced by that around its own solution.

    Returns:
        the best partition; no rival that was looked at is better, each judged around its own solution.
    """
    best = _around_itself(model, state.graph, state.labels)
    while True:
        near = [_around_itself(model, best.graph, labels) for labels in _rivals(model, best)]
        better = max(near, key=lambda each: each.log_posterior, default=best)
        if better.log_posterior <= best.log_posterior + 1e-6:
            return best
        best = better


def _rivals(model: Model, state: State) -> list[np.ndarray]:
    """Partitions (N,) that the linear model holds as good up to the margin: neighbours, and what a chain comes across.

    Neighbours differ by the place of one tracklet or by a merger; a chain at temperature 1 also moves two at once.
    """
    sampler = GibbsSampler(model.evidence(reduced_system(state.graph)), state.labels, np.random.default_rng(0))
    least, found = sampler.log_posterior - MARGIN, {}
    for tracklet in range(len(state.labels)):
        before = sampler.saved()
        sampler.split_off(tracklet)
        for slot, change in zip(*sampler.weights(tracklet), strict=True):
            if sampler.log_posterior + change > least:
                moved = sampler.slot.copy()
                moved[tracklet] = slot
                _keep(found, moved)
        sampler.restore(before)
    for gone in range(len(sampler.members)):
        for stays in range(gone):
            merged = np.where(sampler.slot == gone, stays, sampler.slot)
            if log_posterior(sampler.evidence, in_order_of_sight(merged)) > least:
                _keep(found, merged)
    for _ in range(SWEEPS):
        sampler.sweep()
        split_or_merge(sampler)
        if sampler.log_posterior > least:
            _keep(found, sampler.slot)
    found.pop(in_order_of_sight(state.labels).tobytes(), None)
    return list(found.values())


def _keep(found: dict, labels: np.ndarray) -> None:
    labels = in_order_of_sight(labels)
    found[labels.tobytes()] = labels


def _around_itself(model: Model, graph: PoseGraph, labels: np.ndarray) -> State:
    """A partition with its own solution, and its log posterior in the model that is linear around that."""
    graph, chi2 = solved(model, graph, labels, STEPS)
    return State(0.0, labels, graph, log_posterior(model.evidence(reduced_system(graph)), labels), chi2, chi2)
