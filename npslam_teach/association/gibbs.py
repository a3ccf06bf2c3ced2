"""Gibbs sampling of partitions: one tracklet after another asks again which object it is of.

A tracklet that is taken out of its object, or put into one, changes the joint covariance of all objects by a matrix of
rank two; what was integrated out stays so. This is algorithm 3 of Neal, "Markov chain sampling methods for Dirichlet
process mixture models", 2000, with trajectory and map collapsed too. ``partition_posterior`` says plainly what it
samples from; ``split_merge`` has the moves that a single tracklet cannot make.
"""

import math

import numpy as np

from npslam_teach.association.partition_posterior import (
    TrackletEvidence,
    joint_system,
    log_evidence,
    log_prior,
)
from npslam_teach.association.partitions import in_order_of_sight


class GibbsSampler:
    """A partition that moves: one tracklet at a time, or two objects at once.

    Every object has a slot; ``mean`` (2S,) and ``cov`` (2S, 2S) are of all objects jointly, zero in free slots.
    """

    def __init__(self, evidence: TrackletEvidence, labels: np.ndarray, rng: np.random.Generator):
        self.evidence, self.rng = evidence, rng
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
        return self.mean.reshape(-1, 2)[self.slot]

    def sweep(self, temperature: float = 1.0) -> None:
        """Ask every tracklet once, in random order."""
        for tracklet in self.rng.permutation(len(self.slot)):
            self.split_off(tracklet)
            self.join(tracklet, *self.draw(*self.weights(tracklet), temperature))
        self.refresh()

    def refresh(self) -> None:
        """Work everything out anew: the rounding of many updates would grow."""
        self.slot = np.unique(self.slot, return_inverse=True)[1]
        self.members = [np.flatnonzero(self.slot == i).tolist() for i in range(self.slot.max(initial=-1) + 1)]
        precision, vector = joint_system(self.evidence, self.slot)
        self.cov = np.linalg.inv(precision) if len(precision) else precision
        self.mean = self.cov @ vector
        self.log_posterior = log_evidence(self.evidence, precision, vector, self.mean, self.members)

    def change_by(self, tracklet: int, slot: int) -> float:
        """How the log posterior changes when a lone tracklet joins an object; -inf for a rival."""
        if self.evidence.rivals[tracklet, self.members[slot]].any():
            return -math.inf
        density = self._log_density(self.slot[tracklet], np.array([slot]))[0]
        return float(density) + self.seating(self.members[slot], tracklet, +1)

    def saved(self) -> tuple:
        """A copy of all that moves, for ``restore``."""
        return (
            self.slot.copy(),
            [list(each) for each in self.members],
            self.cov.copy(),
            self.mean.copy(),
            self.log_posterior,
        )

    def restore(self, saved: tuple) -> None:
        """Go back to what was ``saved``; once only, for it will move on."""
        self.slot, self.members, self.cov, self.mean, self.log_posterior = saved

    def split_off(self, tracklet: int) -> None:
        """Take a tracklet out of its object, alone into a slot of its own.

        With ``l_t = l_i + delta`` the joint information of (l, delta) is [[J, V], [V^T, Lambda_tt]], V = A^T Lambda_t.
        """
        slot = self.slot[tracklet]
        if len(self.members[slot]) == 1:
            return
        delta, delta_cov, gain = self._let_go(tracklet)
        free, here = self._free_slot(), slice(2 * slot, 2 * slot + 2)
        there = slice(2 * free, 2 * free + 2)
        with_delta = np.zeros((len(self.cov), 2))
        with_delta[: len(gain)] = -gain
        row = self.cov[:, here] + with_delta
        self.cov[:, there], self.cov[there] = row, row.T
        self.cov[there, there] = self.cov[here, here] + with_delta[here] + with_delta[here].T + delta_cov
        self.mean[there] = self.mean[here] + delta
        change = self.seating(self.members[slot], tracklet, -1) - float(log_normal(delta, delta_cov))
        self.members[slot].remove(tracklet)
        self.members[free] = [tracklet]
        self.slot[tracklet] = free
        self.log_posterior += change

    def _let_go(self, tracklet: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Let a tracklet stand apart from its object by delta: its mean and covariance, and how the objects follow."""
        t, v = slice(2 * tracklet, 2 * tracklet + 2), np.zeros((len(self.members), 4))
        np.add.at(v, self.slot, self._blocks[:, :, tracklet].reshape(-1, 4))
        v = v.reshape(-1, 2)
        s_v = self.cov @ v
        delta_cov = np.linalg.inv(self.evidence.information[t, t] - v.T @ s_v)
        delta = delta_cov @ (self.evidence.vector[t] - v.T @ self.mean)
        gain = s_v @ delta_cov
        self.cov += gain @ s_v.T
        self.mean -= s_v @ delta
        return delta, delta_cov, gain

    def join(self, tracklet: int, slot: int, change: float) -> None:
        """Put a tracklet that is alone into an object: condition on ``l_i - l_t = 0``. Its own slot: it stays alone."""
        own = self.slot[tracklet]
        if slot == own:
            return
        self.merge(own, slot)
        self.log_posterior += change

    def weights(self, tracklet: int) -> tuple[np.ndarray, np.ndarray]:
        """Where a tracklet that is alone may go: slots, its own first; and how the log posterior changes there."""
        own = self.slot[tracklet]
        forbidden = np.zeros(len(self.members), dtype=bool)
        forbidden[self.slot[self.evidence.rivals[tracklet]]] = True
        forbidden[own] = True
        open_slots = np.array([i for i, members in enumerate(self.members) if members and not forbidden[i]], dtype=int)
        change = self._log_density(own, open_slots)
        near = np.flatnonzero(change > change.max(initial=-math.inf) - 60.0)  # elsewhere it will never go
        for k in near.tolist():
            change[k] += self.seating(self.members[open_slots[k]], tracklet, +1)
        keep = open_slots[near]
        return np.append(own, keep), np.append(0.0, change[near])

    def draw(self, slots: np.ndarray, change: np.ndarray, temperature: float) -> tuple[int, float]:
        """One of the places, with probability in proportion to ``exp(change / temperature)``."""
        scaled = change / temperature
        weights = np.exp(scaled - scaled.max())
        k = int(np.searchsorted(np.cumsum(weights), self.rng.random() * weights.sum(), side="right"))
        k = min(k, len(slots) - 1)
        return int(slots[k]), float(change[k])

    def merge(self, gone: int, stays: int) -> None:
        """Put all of one object into another: condition on their difference being zero."""
        a, b = slice(2 * gone, 2 * gone + 2), slice(2 * stays, 2 * stays + 2)
        difference = self.cov[:, b] - self.cov[:, a]
        spread = np.linalg.inv(difference[b] - difference[a])
        gain = difference @ spread
        self.mean -= gain @ (self.mean[b] - self.mean[a])
        self.cov -= gain @ difference.T
        self.cov[a], self.cov[:, a], self.mean[a] = 0.0, 0.0, 0.0
        self.slot[self.members[gone]] = stays
        self.members[stays] = sorted(self.members[stays] + self.members[gone])
        self.members[gone] = []

    def _log_density(self, own: int, slots: np.ndarray) -> np.ndarray:
        """Log N(l_i - l_t; 0) for objects i (m,) and an object t."""
        blocks, mean = self.cov.reshape(len(self.members), 2, -1, 2), self.mean.reshape(-1, 2)
        cross = blocks[slots, :, own]
        cov = blocks[slots, :, slots] + blocks[own, :, own] - cross - cross.swapaxes(1, 2)
        return log_normal(mean[slots] - mean[own], cov)

    def seating(self, members: list[int], tracklet: int, sign: int) -> float:
        """How the log prior changes when a tracklet comes to members (+1), or leaves them for itself (-1)."""
        with_it = sorted([*members, tracklet]) if sign > 0 else members
        without = members if sign > 0 else [each for each in members if each != tracklet]
        counts, own = self.evidence.counts, [self.evidence.counts[tracklet]]
        joint = log_prior(counts[with_it].tolist(), self.evidence)
        apart = log_prior(counts[without].tolist(), self.evidence) + log_prior(own, self.evidence)
        return sign * (joint - apart)

    def _free_slot(self) -> int:
        """An empty slot; where there is none, room for twice as many."""
        for i, members in enumerate(self.members):
            if not members:
                return i
        count = max(len(self.members), 4)
        self.members += [[] for _ in range(count)]
        self.mean = np.append(self.mean, np.zeros(2 * count))
        self.cov = np.pad(self.cov, ((0, 2 * count), (0, 2 * count)))
        return len(self.members) - count


def log_normal(difference: np.ndarray, cov: np.ndarray) -> np.ndarray:
    """The log density at zero of two-dimensional normals: mean (..., 2), covariance (..., 2, 2)."""
    a, b, d = cov[..., 0, 0], cov[..., 0, 1], cov[..., 1, 1]
    # Where rounding has eaten the difference of two nearly equal covariances, it is small, and positive.
    det = np.maximum(a * d - b * b, 1e-12 * np.abs(a * d) + 1e-300)
    x, y = difference[..., 0], difference[..., 1]
    squared = (d * x * x - 2 * b * x * y + a * y * y) / det
    return -squared / 2 - np.log(det) / 2 - math.log(2 * math.pi)
