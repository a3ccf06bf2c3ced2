"""Exchanges: two objects near each other, each in some frames taken for the other.

Every pair is asked with all frames together (``persistence.exchanged``), the map held still; what is found must pay in
the posterior of all observations, solved anew, before it is kept.
"""

import math

import numpy as np

from npslam_teach.association import first_observations, in_order_of_sight
from npslam_teach.association.gibbs import GibbsSampler
from npslam_teach.association.joint_gaussian import log_normal
from npslam_teach.association.partition_posterior import log_prior
from npslam_teach.association.semantics import class_distances, reports
from npslam_teach.methods.annealing import Model, reports_of
from npslam_teach.methods.gating import squared_residuals
from npslam_teach.methods.partition_score import (
    Found,
    alone,
    in_pieces,
    partition_prior,
    partition_score,
    passes_of,
)
from npslam_teach.methods.persistence import Persistence, between_two, persistence
from npslam_teach.methods.repair import REPAIR_GATE, classes_of, without_gaps
from npslam_teach.pose_graph import fit, squared_radius

ROUNDS = 3
WORTH, MARGIN = 30.0, 3.0


def with_exchanges(model: Model, found: Found) -> Found:
    """Exchange what pays, pair by pair, until nothing does.

    Args:
        model: with the tracklets as they were before any cut.
        found: what is to be improved.
    """
    price = persistence(model.log, model.tracklet, model.alpha)
    lonely = _alone(model, price)
    for _ in range(ROUNDS):
        before = found.score
        squared = _squared(model, found)
        for pair in _rivals(squared, found.labels, price.look, price):
            labels = _exchanged(squared, found.labels, pair, price, lonely)
            if labels is None:
                continue
            graph = fit(model.log, labels, found.graph.poses)
            score = partition_score(model, labels, graph)
            if score > found.score:
                found = Found(labels, graph, score)
                if len(graph.landmarks) < squared.shape[1]:
                    break
                squared = _squared(model, found)
        if found.score <= before + 1e-6:
            return found
    return found


def _squared(model: Model, found: Found) -> np.ndarray:
    """Squared distances (M, K) of all observations to all objects, of place and class."""
    log, every = model.log, np.arange(model.log.num_observations)[:, None]
    squared = squared_residuals(log, every, found.graph.poses, found.graph.landmarks)
    return squared + class_distances(reports(log), classes_of(log, found.labels))


def _rivals(squared: np.ndarray, labels: np.ndarray, look: np.ndarray, price: Persistence) -> list[tuple[int, int]]:
    """Pairs of objects of which at least one observation may be of either, or keeps a third out."""
    slack = -4 * price.log_coming  # an exchange may save two comings
    used, left = np.flatnonzero(labels >= 0), np.flatnonzero(labels < 0)
    least = np.where(labels >= 0, squared[np.arange(len(labels)), labels], squared.min(axis=1))
    near = squared < np.minimum(least, squared_radius(REPAIR_GATE))[:, None] + slack
    either = np.zeros((squared.shape[1],) * 2, dtype=bool)
    np.logical_or.at(either, labels[used], near[used])
    for k in left:
        nearest = np.argsort(squared[k])[:2]
        either[nearest[0], nearest[-1]] |= near[k, nearest[0]]
        others = used[look[used] == look[k]]
        others = others[near[k, labels[others]]]
        np.logical_or.at(either, labels[others], near[others])
    return np.argwhere(np.triu(either | either.T, 1)).tolist()


def _exchanged(squared, labels: np.ndarray, pair: list[int], price: Persistence, alone: float) -> np.ndarray | None:
    """Labels (M,) with two objects exchanged where that is more probable; None: nowhere."""
    near = (squared[:, pair] < 2 * (alone - price.log_coming)).any(axis=1)
    own = np.flatnonzero(np.isin(labels, pair) | ((labels < 0) & near))
    found = between_two(squared[np.ix_(own, pair)], price.look[own], price.log_coming, alone)
    found = np.where(found < 0, -1, np.array(pair)[found])
    if (found == labels[own]).all():
        return None
    labels = labels.copy()
    labels[own] = found
    return labels if np.isin(pair, labels).all() else without_gaps(labels)


def _alone(model: Model, price: Persistence) -> float:
    """How improbable it is, -log, that an observation is an object of its own, beside being at its place."""
    spread = 2 * math.pi * math.prod(model.log.observation_std)
    return math.log(model.area / model.alpha) - math.log(spread) - price.log_draw - price.log_coming


def with_moved_passes(model: Model, found: Found) -> Found:
    """Move whole passes to the objects that a linear model holds nearly as good, each solved anew."""
    while True:
        before = found.score
        for labels in _moved(model, found):
            graph = fit(model.log, labels, found.graph.poses)
            score = partition_score(model, labels, graph)
            if score > found.score + 1e-6:
                found = Found(labels, graph, score)
                break
        if found.score <= before:
            return found


def _moved(model: Model, found: Found) -> list[np.ndarray]:
    """Labels (M,) that may be better: best first, by the linear model around what is found."""
    piece, in_pass = fragments(model, found.labels)
    finer, reduced = in_pieces(model, found.labels, found.graph, piece)
    of_piece = in_order_of_sight(alone(found.labels)[first_observations(piece)])
    prior, moves = partition_prior(model, found.labels), []
    sampler = GibbsSampler(finer.evidence(reduced), of_piece, np.random.default_rng(0))
    for begin in range(len(of_piece)):
        before, members = sampler.saved(), []
        for each in np.flatnonzero(in_pass == in_pass[begin]).tolist():
            if each < begin:
                continue
            sampler.split_off(each)
            if members:
                sampler.join(each, sampler.slot[begin], sampler.change_by(each, sampler.slot[begin]))
            members.append(each)
            taken = sampler.log_posterior - before[-1] - _seats(sampler, before)
            for slot, put_in in _places(sampler, sampler.slot[begin]):
                if slot == before[0][begin] or taken + put_in < -WORTH:
                    continue
                moved = sampler.slot.copy()
                moved[members] = slot
                labels = in_order_of_sight(moved[finer.tracklet])
                gain = taken + put_in + partition_prior(model, labels) - prior
                if gain > -MARGIN:
                    moves.append((gain, labels))
        sampler.restore(before)
    return [labels for _, labels in sorted(moves, key=lambda move: -move[0])]


def _seats(sampler: GibbsSampler, before) -> float:
    """How the prior of the linear model has changed."""
    now, then = (
        sum(log_prior(each, sampler.evidence) for each in members if each) for members in (sampler.members, before[1])
    )
    return now - then


def _places(sampler: GibbsSampler, slot: int):
    """Where an object may go: slots, and the log density of the difference being zero; its own: it stays alone."""
    rivals = sampler.evidence.rivals[sampler.members[slot]].any(axis=0)
    open_slots = np.array([bool(each) and not rivals[each].any() for each in sampler.members])
    open_slots[slot] = False
    slots = np.flatnonzero(open_slots)
    joint = sampler.joint
    cross = joint.column(slot).reshape(-1, 2, 2)[slots]
    cov = joint.own[slots] + joint.own[slot] - cross - cross.swapaxes(1, 2)
    mean = joint.mean.reshape(-1, 2)
    return [(slot, 0.0), *zip(slots.tolist(), log_normal(mean[slots] - mean[slot], cov).tolist())]


def fragments(model: Model, labels: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Passes (M,) cut where another, of what may be the same class, begins or ends; and the pass of each (N,)."""
    piece, of_pass = passes_of(model, labels)
    look = np.unique(model.log.obs_time, return_inverse=True)[1]
    first = first_observations(piece)
    last = len(piece) - 1 - first_observations(piece[::-1])
    allowed = np.isfinite(reports_of(model.log, piece)).astype(float)
    alike = allowed @ allowed.T > 0
    alike[:, np.bincount(piece) == 1] = False
    part = np.zeros(len(piece), dtype=int)
    for each in range(len(of_pass)):
        own = np.flatnonzero(piece == each)
        cuts = np.unique(np.concatenate([look[first[alike[each]]], look[last[alike[each]]] + 1]))
        part[own] = np.searchsorted(cuts, look[own], side="right")
    fragment = in_order_of_sight(np.column_stack([piece, part]))
    return fragment, piece[first_observations(fragment)]
