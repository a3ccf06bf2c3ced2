"""Gibbs sampling of partitions: one tracklet after another asks again which object it is of.

A tracklet that is taken out of its object, or put into one, changes the joint covariance of all objects by a matrix of
rank two; what was integrated out stays so. This is algorithm 3 of Neal, "Markov chain sampling methods for Dirichlet
process mixture models", 2000, with trajectory and map collapsed too. ``partition_posterior`` says plainly what it
samples from; ``split_merge`` has the moves that a single tracklet cannot make.
"""

import functools
import math
from typing import NamedTuple

import numpy as np

from npslam_teach.association.joint_gaussian import JointGaussian, log_normal, with_room
from npslam_teach.association.partition_posterior import (
    TrackletEvidence,
    joint_system,
    log_evidence,
    log_prior,
)
from npslam_teach.association.partitions import in_order_of_sight

MOST_AHEAD = 32  # tracklets whose products are worked out together


class _Apart(NamedTuple):
    """What would be if one tracklet stood alone: the joint Gaussian of the objects without it, and its own place."""

    slot: int  # that it would have
    change: float  # of the log posterior, by leaving
    update: tuple | None  # of the joint Gaussian, by leaving; None where the tracklet is alone already
    mean: np.ndarray  # (2S,) of the objects without it
    blocks: np.ndarray  # (S, 2, 2) the covariance of each
    own_mean: np.ndarray  # (2,) of the tracklet
    own_cov: np.ndarray  # (2, 2)
    column: np.ndarray  # (2S, 2) the covariance of all objects with it


class GibbsSampler:
    """A partition that moves: one tracklet at a time, or two objects at once.

    Every object has a slot; ``joint`` is the Gaussian over the places of all of them.
    """

    def __init__(self, evidence: TrackletEvidence, labels: np.ndarray, rng: np.random.Generator):
        self.evidence, self.rng = evidence, rng
        # Of a tuple of tracklets in the order of first sight; the same few objects are asked for again and again.
        self.log_prior = functools.lru_cache(50_000)(lambda members: log_prior(list(members), evidence))
        self._blocks = evidence.information.reshape(len(labels), 2, len(labels), 2)
        self.slot = np.asarray(labels)
        self.refresh()

    @property
    def labels(self) -> np.ndarray:
        """(N,) the object of each tracklet, from 0 without gaps, numbered by first sight."""
        return in_order_of_sight(self.slot)

    @property
    def positions(self) -> np.ndarray:
        """(N, 2) m, W: where the object of each tracklet stands."""
        return self.joint.mean.reshape(-1, 2)[self.slot]

    def sweep(self, temperature: float = 1.0, which: np.ndarray | None = None) -> None:
        """Ask every tracklet once, in random order; or those of ``which``, indices, alone."""
        order, products, ahead = self.rng.permutation(len(self.slot) if which is None else which), {}, 1
        for k, tracklet in enumerate(order):
            if tracklet not in products:
                products, ahead = self._products(order[k : k + ahead]), min(2 * ahead, MOST_AHEAD)
            apart = self.apart(tracklet, products[tracklet])
            slot, change = self.draw(*self._weights(tracklet, apart), temperature)
            if slot == self.slot[tracklet]:
                continue
            if slot == apart.slot:
                self.split_off(tracklet, apart)
            else:
                self._move(tracklet, apart, slot, change)
            products, ahead = {}, 1
        self.refresh()

    def refresh(self) -> None:
        """Work everything out anew: the rounding of many updates would grow."""
        self.slot = np.unique(self.slot, return_inverse=True)[1]
        self.members = [np.flatnonzero(self.slot == i).tolist() for i in range(self.slot.max(initial=-1) + 1)]
        precision, vector = joint_system(self.evidence, self.slot)
        cov = np.linalg.inv(precision) if len(precision) else precision
        self.joint = JointGaussian(cov @ vector, cov)
        prior = sum(self.log_prior(tuple(each)) for each in self.members)
        self.log_posterior = log_evidence(self.evidence, precision, vector, self.joint.mean, prior)

    def change_by(self, tracklet: int, slot: int) -> float:
        """How the log posterior changes when a lone tracklet joins an object; -inf for a rival."""
        if self.evidence.rivals[tracklet, self.members[slot]].any():
            return -math.inf
        density = _log_density(self.apart(tracklet), np.array([slot]))[0]
        return float(density) + self.seating(self.members[slot], tracklet, +1)

    def saved(self) -> tuple:
        """A copy of all that moves, for ``restore``."""
        return self.slot.copy(), [list(each) for each in self.members], self.joint.copy(), self.log_posterior

    def restore(self, saved: tuple) -> None:
        """Go back to what was ``saved``; once only, for it will move on."""
        self.slot, self.members, self.joint, self.log_posterior = saved

    def split_off(self, tracklet: int, apart: _Apart | None = None) -> None:
        """Take a tracklet out of its object, alone into a slot of its own."""
        apart = apart or self.apart(tracklet)
        if apart.update is None:
            return
        if apart.slot == len(self.members):
            count = max(len(self.members), 4)
            self.members += [[] for _ in range(count)]
            self.joint.change(*apart.update)
            self.joint.make_room(count)
            column = with_room(apart.column, 2 * count, 0)
        else:
            self.joint.change(*apart.update)
            column = apart.column
        self.joint.put(apart.slot, apart.own_mean, apart.own_cov, column)
        self.members[self.slot[tracklet]].remove(tracklet)
        self.members[apart.slot] = [tracklet]
        self.slot[tracklet] = apart.slot
        self.log_posterior += apart.change

    def _products(self, tracklets: np.ndarray) -> dict:
        """V = A^T Lambda_t and Sigma V, (2S, 2) each, of several tracklets (b,); None for one that is alone already.

        Sigma is large, and reading it is what takes the time: once for all of them, as long as nothing moves.
        """
        sharing = [int(t) for t in tracklets if len(self.members[self.slot[t]]) > 1]
        v = np.zeros((len(self.members), 4 * len(sharing)))
        np.add.at(v, self.slot, self._blocks[:, :, sharing].reshape(len(self.slot), -1))
        v = v.reshape(2 * len(self.members), -1)
        s_v = self.joint.times(v)
        pairs = ((v[:, 2 * k : 2 * k + 2], s_v[:, 2 * k : 2 * k + 2]) for k in range(len(sharing)))
        return dict.fromkeys(tracklets.tolist()) | dict(zip(sharing, pairs, strict=True))

    def apart(self, tracklet: int, products: tuple | None = None) -> _Apart:
        """Let a tracklet stand apart from its object by delta, which nothing else knows of.

        With ``l_t = l_i + delta`` the joint information of (l, delta) is [[J, V], [V^T, Lambda_tt]], V = A^T Lambda_t.
        ``products``: V and Sigma V, where they are known.
        """
        slot, joint = self.slot[tracklet], self.joint
        here, t = slice(2 * slot, 2 * slot + 2), slice(2 * tracklet, 2 * tracklet + 2)
        column = joint.column(slot)
        if len(self.members[slot]) == 1:
            return _Apart(slot, 0.0, None, joint.mean, joint.own, joint.mean[here], joint.own[slot], column)
        v, s_v = products or self._products(np.array([tracklet]))[tracklet]
        delta_cov = np.linalg.inv(self.evidence.information[t, t] - v.T @ s_v)
        delta = delta_cov @ (self.evidence.vector[t] - v.T @ joint.mean)
        gain, step = s_v @ delta_cov, -(s_v @ delta)
        blocks = joint.own + gain.reshape(-1, 2, 2) @ s_v.reshape(-1, 2, 2).swapaxes(1, 2)
        own_cov = blocks[slot] - gain[here] - gain[here].T + delta_cov
        column = column + gain @ s_v[here].T - gain
        change = self.seating(self.members[slot], tracklet, -1) - float(log_normal(delta, delta_cov))
        mean = joint.mean + step
        return _Apart(self._free_slot(), change, (step, gain, s_v), mean, blocks, mean[here] + delta, own_cov, column)

    def _move(self, tracklet: int, apart: _Apart, slot: int, change: float) -> None:
        """Put a tracklet into another object: condition on ``l_i - l_t = 0``."""
        if apart.update is None:
            self.join(tracklet, slot, change)
            return
        self.joint.change(*apart.update)
        there = slice(2 * slot, 2 * slot + 2)
        difference = self.joint.column(slot) - apart.column
        spread = difference[there] - apart.column[there].T + apart.own_cov
        self._condition(difference, spread, self.joint.mean[there] - apart.own_mean)
        self.members[self.slot[tracklet]].remove(tracklet)
        self.members[slot] = sorted([*self.members[slot], tracklet])
        self.slot[tracklet] = slot
        self.log_posterior += apart.change + change

    def join(self, tracklet: int, slot: int, change: float) -> None:
        """Put a tracklet that is alone into an object. Its own slot: it stays alone."""
        own = self.slot[tracklet]
        if slot == own:
            return
        self.merge(own, slot)
        self.log_posterior += change

    def weights(self, tracklet: int) -> tuple[np.ndarray, np.ndarray]:
        """Where a tracklet may go once it is alone: slots, its own first; and how the log posterior changes there."""
        return self._weights(tracklet, self.apart(tracklet))

    def _weights(self, tracklet: int, apart: _Apart) -> tuple[np.ndarray, np.ndarray]:
        open_slots = np.zeros(max(len(self.members), apart.slot + 1), dtype=bool)
        open_slots[self.slot] = True
        open_slots[self.slot[self.evidence.rivals[tracklet]]] = False
        open_slots[apart.slot] = False
        open_slots = np.flatnonzero(open_slots)
        change = _log_density(apart, open_slots)
        near = np.flatnonzero(change > change.max(initial=-math.inf) - 60.0)  # elsewhere it will never go
        for k in near.tolist():
            others = [each for each in self.members[open_slots[k]] if each != tracklet]
            change[k] += self.seating(others, tracklet, +1)
        return np.append(apart.slot, open_slots[near]), np.append(0.0, change[near])

    def draw(self, slots: np.ndarray, change: np.ndarray, temperature: float) -> tuple[int, float]:
        """One of the places, with probability in proportion to ``exp(change / temperature)``."""
        scaled = change / temperature
        weights = np.exp(scaled - scaled.max())
        k = int(np.searchsorted(np.cumsum(weights), self.rng.random() * weights.sum(), side="right"))
        k = min(k, len(slots) - 1)
        return int(slots[k]), float(change[k])

    def merger_change(self, gone: int, stays: int) -> float:
        """How the log posterior changes when two objects become one; none of their tracklets may be rivals."""
        first, second = self.members[gone], self.members[stays]
        column, b = self.joint.column(gone), slice(2 * stays, 2 * stays + 2)
        cov = self.joint.own[gone] + self.joint.own[stays] - column[b] - column[b].T
        mean = self.joint.mean.reshape(-1, 2)
        joint, *apart = (self.log_prior(tuple(each)) for each in (sorted(first + second), first, second))
        return float(log_normal(mean[stays] - mean[gone], cov)) + joint - sum(apart)

    def merge(self, gone: int, stays: int) -> None:
        """Put all of one object into another: condition on their difference being zero."""
        a, b = slice(2 * gone, 2 * gone + 2), slice(2 * stays, 2 * stays + 2)
        difference = self.joint.column(stays) - self.joint.column(gone)
        self._condition(difference, difference[b] - difference[a], self.joint.mean[b] - self.joint.mean[a])
        self.slot[self.members[gone]] = stays
        self.members[stays] = sorted(self.members[stays] + self.members[gone])
        self.members[gone] = []

    def _condition(self, difference: np.ndarray, spread: np.ndarray, off: np.ndarray) -> None:
        """Two places are one: their difference, of mean (2,) and covariance (2, 2), and (2S, 2) with all, is zero."""
        gain = difference @ np.linalg.inv(spread)
        self.joint.change(-(gain @ off), -gain, difference)

    def seating(self, members: list[int], tracklet: int, sign: int) -> float:
        """How the log prior changes when a tracklet comes to members (+1), or leaves them for itself (-1)."""
        with_it = sorted([*members, tracklet]) if sign > 0 else members
        without = members if sign > 0 else [each for each in members if each != tracklet]
        joint, *apart = (self.log_prior(tuple(each)) for each in (with_it, without, (tracklet,)))
        return sign * (joint - sum(apart))

    def _free_slot(self) -> int:
        """An empty slot; where there is none, the one after the last."""
        return next((i for i, members in enumerate(self.members) if not members), len(self.members))


def _log_density(apart: _Apart, slots: np.ndarray) -> np.ndarray:
    """Log N(l_i - l_t; 0) for objects i (m,) and a tracklet that stands apart."""
    cross = apart.column.reshape(-1, 2, 2)[slots]
    cov = apart.blocks[slots] + apart.own_cov - cross - cross.swapaxes(1, 2)
    return log_normal(apart.mean.reshape(-1, 2)[slots] - apart.own_mean, cov)
