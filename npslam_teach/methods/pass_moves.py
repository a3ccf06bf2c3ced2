"""Whole passes, or parts of them, in another object: judged by what they do to the trajectory as well.

Where one object comes into view as another leaves it, a tracklet may run on from the one to the other, and the
trajectory bends to suit both, so that residuals do not show it. The linear model around what was found knows how it
would bend back (``association.gibbs``). Every pass is therefore cut where another begins or ends, and where the linear
model says that the object may have changed (``change_points``). Every stretch of neighbouring parts is moved to every
other object; what looks good is solved anew, and kept if it pays.
"""

import itertools
from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np

from npslam_teach.association import first_observations, in_order_of_sight
from npslam_teach.association.gibbs import GibbsSampler
from npslam_teach.association.joint_gaussian import log_normal
from npslam_teach.methods.annealing import Model, reports_of
from npslam_teach.methods.change_points import after_change
from npslam_teach.methods.gating import twice_in_a_frame
from npslam_teach.methods.partition_score import Found, in_pieces, partition_prior, scored
from npslam_teach.methods.persistence import passes_of, persistence, singled_out
from npslam_teach.methods.polish import MARGIN
from npslam_teach.methods.repair import without_gaps

WORTH = 30.0  # nats that the prior may make up for
IN_VAIN = 50
FIRST = 8  # moves that are tried two at once


class Move(NamedTuple):
    """Some observations in another object."""

    gain: float  # of the log posterior, by the linear model
    own: np.ndarray  # (n,) observations
    there: int  # one of the other object; -1: they become an object


def with_moved_passes(model: Model, found: Found) -> Found:
    """Move parts of passes as long as that pays.

    The most promising come first, and then two at once.

    Args:
        model: with the tracklets as they were before any cut.
        found: what is to be improved.
    """
    while True:
        before, moves = found, sorted(_moves(model, found), key=lambda move: -move.gain)
        found = _one_by_one(model, before, moves)
        if found.score <= before.score + 1e-6:
            found = _two_at_once(model, before, moves[:FIRST])
        if found.score <= before.score + 1e-6:
            return found


def _one_by_one(model: Model, found: Found, moves: list[Move]) -> Found:
    """What comes of moves that pay; after ``IN_VAIN`` that have not, one after the other, the rest is not tried."""
    in_vain = 0
    for move in moves:
        again = _moved(model, found, found, [move])
        in_vain = in_vain + 1 if again is found else 0
        found = again
        if in_vain == IN_VAIN:
            break
    return found


def _two_at_once(model: Model, found: Found, moves: list[Move]) -> Found:
    """The best that two moves come to together: the trajectory bends to suit both, and neither may pay alone."""
    best = found
    for two in itertools.combinations(moves, 2):
        if not np.isin(two[0].own, two[1].own).any():
            best = _moved(model, found, best, two)
    return best


def _moved(model: Model, found: Found, best: Found, moves: Iterable[Move]) -> Found:
    """What was found, after moves; or what is best so far, where that is better or a frame would see a thing twice."""
    labels = found.labels.copy()
    for _, own, there in moves:
        both = np.append(own, there) if there >= 0 else own
        labels[both] = found.labels[there] if there >= 0 and found.labels[there] >= 0 else labels.max() + 1
    if twice_in_a_frame(model.log, labels):
        return best
    again = scored(model, without_gaps(labels), found.graph.poses)
    return again if again.score > best.score else best


def _moves(model: Model, found: Found) -> Iterator[Move]:
    """What the linear model holds better, or nearly as good."""
    part, of_pass = parts_of_passes(model, found)
    first = first_observations(part)
    finer, reduced = in_pieces(model, found.labels, found.graph, part)
    price = persistence(model.tracklet, model.log.obs_time, model.alpha)
    prior = partition_prior(model, found.labels, price)
    of_part = in_order_of_sight(singled_out(found.labels)[first])
    sampler = GibbsSampler(finer.evidence(reduced), of_part, np.random.default_rng(0))
    for stretch, slot, change in _stretches(sampler, of_pass):
        if change > -WORTH:
            moved = of_part.copy()
            moved[stretch] = slot
            gain = change + partition_prior(model, in_order_of_sight(moved[finer.tracklet]), price) - prior
            if gain > -MARGIN:
                others = np.flatnonzero(of_part == slot)
                yield Move(gain, np.flatnonzero(np.isin(part, stretch)), first[others[0]] if len(others) else -1)


def _stretches(sampler: GibbsSampler, of_pass: np.ndarray) -> Iterator[tuple[list[int], int, float]]:
    """The first parts of a pass, its last, or any one; an object where they may go; and the log density of that."""
    for begin in range(len(of_pass)):
        before, stretch = sampler.saved(), []
        parts = np.flatnonzero(of_pass == of_pass[begin])
        for each in parts[parts >= begin].tolist():
            sampler.split_off(each)
            if stretch:
                sampler.join(each, sampler.slot[begin], sampler.change_by(each, sampler.slot[begin]))
            stretch = [*stretch, each]
            if begin not in (parts[0], each) and each != parts[-1]:
                continue
            taken = sampler.log_posterior - before[-1] - _seats(sampler, sampler.members) + _seats(sampler, before[1])
            for slot, density in _places(sampler, sampler.slot[begin]):
                if slot != before[0][begin]:
                    yield stretch, slot, taken + density
        sampler.restore(before)


def _seats(sampler: GibbsSampler, members: list[list[int]]) -> float:
    """The prior of the linear model, in which parts are drawn as if they were tracklets."""
    return sum(sampler.log_prior(tuple(each)) for each in members if each)


def _places(sampler: GibbsSampler, slot: int) -> list[tuple[int, float]]:
    """Objects that one may join, and the log density of their difference being zero; its own: it stays, 0."""
    joint, rivals = sampler.joint, sampler.evidence.rivals[sampler.members[slot]].any(axis=0)
    free = [bool(each) and not rivals[each].any() and k != slot for k, each in enumerate(sampler.members)]
    slots = np.flatnonzero(free)
    cross, mean = joint.column(slot).reshape(-1, 2, 2)[slots], joint.mean.reshape(-1, 2)
    cov = joint.own[slots] + joint.own[slot] - cross - cross.swapaxes(1, 2)
    density = log_normal(mean[slots] - mean[slot], cov)
    return [(slot, 0.0), *zip(slots.tolist(), density.tolist(), strict=True)]


def parts_of_passes(model: Model, found: Found) -> tuple[np.ndarray, np.ndarray]:
    """Passes cut where another, of what may be the same class, begins or ends, and where the object may have changed.

    Args:
        model: the log and the prior.
        found: the passes, solved.

    Returns:
        (M,) the part of each observation, in the order of first sight; (N,) the pass of each part.
    """
    number, _ = passes_of(found.labels, model.log.obs_time)
    time, first = model.log.obs_time, first_observations(number)
    last = len(number) - 1 - first_observations(number[::-1])
    allowed = np.isfinite(reports_of(model.log, number)).astype(float)
    cuts = (allowed @ allowed.T > 0) & (np.bincount(number) > 1)  # a single observation is seldom a thing
    part = np.zeros(len(number), dtype=int)
    for each in range(len(first)):
        own, others = np.flatnonzero(number == each), np.flatnonzero(cuts[each])
        part[own] = np.searchsorted(
            np.unique(np.append(time[first[others]], time[last[others]] + 1)), time[own], side="right"
        )
    part = in_order_of_sight(np.column_stack([number, part, after_change(model, found.labels, found.graph)]))
    return part, number[first_observations(part)]
