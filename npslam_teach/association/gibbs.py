"""Which tracklets are of one object? Gibbs sampling of partitions, the trajectory and the map integrated out.

The measurements enter as one quadratic form in the positions of the N tracklets (``pose_graph.reduced_system``). A
partition says which of these positions are one and the same. Its posterior is a Gaussian integral away:

    J = A^T Lambda A,  e = A^T eta                            A (2N, 2K): which tracklet is of which object
    log p = -(c - e^T J^-1 e) / 2 - log det(J / 2 pi) / 2 + sum_i log(prior of object i)

A tracklet is one draw of a Chinese restaurant process: its first observation is drawn, the others stay with it. An
object costs ``alpha / area`` (objects are uniform over the area), and joining it weighs as many observations as it has
by then. Where every tracklet is a single observation this is the process itself: ``alpha^K prod (n_i - 1)!``.

``log_posterior`` and ``plain_weights`` say it as it is; ``GibbsSampler`` says the same by updates of rank two (Neal,
"Markov chain sampling methods for Dirichlet process mixture models", 2000, algorithm 3, with everything collapsed).
"""

import math
from itertools import accumulate
from typing import NamedTuple

import numpy as np


class TrackletEvidence(NamedTuple):
    """What is known of N tracklets, in the order in which they were first seen."""

    constant: float
    vector: np.ndarray  # (2N,)
    information: np.ndarray  # (2N, 2N)
    counts: np.ndarray  # (N,) observations of each
    rivals: np.ndarray  # (N, N) bool, pairs that cannot be one object: seen in one frame, or of two classes
    alpha: float  # concentration
    area: float  # m^2


def log_posterior(evidence: TrackletEvidence, labels: np.ndarray) -> float:
    """The log probability of a partition, up to a constant that does not depend on it; -inf if it joins rivals.

    Args:
        evidence: of N tracklets.
        labels: (N,) the object of each, from 0 without gaps.
    """
    together = labels[:, None] == labels
    if (together & evidence.rivals).any():
        return -math.inf
    precision, vector = joint_system(evidence, labels)
    members = [np.flatnonzero(labels == i).tolist() for i in range(labels.max(initial=-1) + 1)]
    return _log_evidence(evidence, precision, vector, np.linalg.solve(precision, vector), members)


def _log_evidence(evidence: TrackletEvidence, precision, vector, mean, members: list[list[int]]) -> float:
    chi2 = evidence.constant - vector @ mean
    log_det = np.linalg.slogdet(precision / (2 * np.pi))[1]
    prior = sum(log_prior(evidence.counts[each].tolist(), evidence) for each in members)
    return float(-chi2 / 2 - log_det / 2 + prior)


def joint_system(evidence: TrackletEvidence, labels: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """J (2K, 2K) and e (2K,): the quadratic form when tracklets of one object stand at one place.

    ``A^T Lambda A`` adds up the blocks of Lambda by the objects of their rows and columns.
    """
    count = len(labels)
    if count == 0:
        return evidence.information, evidence.vector
    order = np.argsort(labels, kind="stable")
    starts = np.flatnonzero(np.diff(labels[order], prepend=-1))
    by_row = np.add.reduceat(evidence.information.reshape(count, 2, count, 2)[order], starts, axis=0)
    precision = np.add.reduceat(by_row[:, :, order], starts, axis=2).reshape(2 * len(starts), -1)
    return precision, np.add.reduceat(evidence.vector.reshape(count, 2)[order], starts, axis=0).ravel()


def log_prior(counts: list[int], evidence: TrackletEvidence) -> float:
    """The log prior of one object whose tracklets have so many observations, in the order of first sight."""
    return math.log(evidence.alpha / evidence.area) + sum(math.log(before) for before in accumulate(counts[:-1]))


def plain_weights(evidence: TrackletEvidence, labels: np.ndarray, tracklet: int) -> np.ndarray:
    """The log posterior for every place that one tracklet may take, all others kept: (K+1,), the last for a new object.

    Args:
        evidence: of N tracklets.
        labels: (N,) from 0 without gaps, also without this tracklet.
        tracklet: which.
    """
    others = np.delete(labels, tracklet).max(initial=-1) + 1
    places = [np.where(np.arange(len(labels)) == tracklet, place, labels) for place in range(others + 1)]
    return np.array([log_posterior(evidence, each) for each in places])


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
        _, first, inverse = np.unique(self.slot, return_index=True, return_inverse=True)
        return np.argsort(np.argsort(first))[inverse]

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
        self.log_posterior = _log_evidence(self.evidence, precision, vector, self.mean, self.members)

    def split_or_merge(self, temperature: float = 1.0) -> bool:
        """Propose to split an object in two, or to make one of two, where single tracklets would have to climb.

        Two tracklets are drawn. If they share an object it is split between them, the others in random order each to
        the one or the other by its weight; if not, their objects are merged, and the probability of the way back is
        that of the same split (Jain and Neal 2004, with sequential allocation: Dahl, "Sequentially-allocated
        merge-split sampler", 2005). Returns whether it was accepted.
        """
        if len(self.slot) < 2:
            return False
        anchors = self.rng.choice(len(self.slot), 2, replace=False)
        if self.evidence.rivals[tuple(anchors)]:
            return False
        before, together = self._saved(), self.slot[anchors[0]] == self.slot[anchors[1]]
        both = {*self.members[self.slot[anchors[0]]], *self.members[self.slot[anchors[1]]]}
        if not together and self.evidence.rivals[np.ix_(list(both), list(both))].any():
            return False
        others = self.rng.permutation(sorted(both - set(anchors.tolist())))
        homes = {t: self.slot[t] == self.slot[anchors[0]] for t in others}
        for tracklet in [*others, *anchors]:
            self.split_off(tracklet)
        if together:
            log_way = sum(self._seat(t, anchors, None, temperature) for t in others)
            log_ratio = (self.log_posterior - before[-1]) / temperature - log_way
        else:
            apart = self._saved()
            log_way = sum(self._seat(t, anchors, homes[t], temperature) for t in others)
            self._restore(apart)
            for tracklet in [*others, anchors[1]]:
                self.join(tracklet, self.slot[anchors[0]], self._change(tracklet, self.slot[anchors[0]]))
            log_ratio = (self.log_posterior - before[-1]) / temperature + log_way
        if math.log(self.rng.random()) < log_ratio:
            self.refresh()
            return True
        self._restore(before)
        return False

    def merge_objects(self) -> None:
        """Merge the two objects whose merger raises the log posterior most, as long as there are such."""
        self.refresh()
        while len(self.members) > 1:
            change = self._merger_changes()
            gone, stays = np.unravel_index(change.argmax(), change.shape)
            if change[gone, stays] <= 0:
                return
            self._merge(int(gone), int(stays))
            self.log_posterior += float(change[gone, stays])
            self.refresh()

    def displaced(self, share: float, spread: np.ndarray) -> np.ndarray:
        """The labels (N,) when small objects turn out to be larger ones, seen in a wrong place.

        A share of the tracklets is displaced: by an error of the pose or of the detector that lasts as long as they do,
        with a covariance far above that of single observations. An object joins the one for which this is most probable
        and more so than that it is there. It does not pull on the map.

        Args:
            share: of the tracklets that are displaced.
            spread: (2, 2) m^2, by how much.
        """
        self.refresh()
        labels, change = self.slot.copy(), self._merger_changes(spread)
        change = np.maximum(change, change.T)
        for i in sorted(range(len(self.members)), key=lambda i: self.evidence.counts[self.members[i]].sum()):
            gain = change[i] + math.log(share) * len(self.members[i])
            if len(gain) and gain.max() > 0:
                labels[self.members[i]] = labels[self.members[int(gain.argmax())][0]]
                change[:, i] = -np.inf
        return np.unique(labels, return_inverse=True)[1]

    def _merger_changes(self, spread: np.ndarray | float = 0.0) -> np.ndarray:
        """How the log posterior changes when objects i and j become one, (K, K); -inf for rivals, and for i >= j."""
        count = len(self.members)
        member_of = (self.slot[:, None] == np.arange(count)).astype(float)
        rivals = member_of.T @ self.evidence.rivals @ member_of > 0
        blocks, mean = self.cov.reshape(count, 2, count, 2).swapaxes(1, 2), self.mean.reshape(-1, 2)
        own = blocks[np.arange(count), np.arange(count)]
        cov = own[:, None] + own - blocks - blocks.swapaxes(2, 3)
        cov = cov + spread
        cov[np.arange(count), np.arange(count)] = np.eye(2)
        change = np.where(rivals | np.eye(count, dtype=bool), -np.inf, _log_normal(mean[:, None] - mean, cov))
        prior = [log_prior(self.evidence.counts[each].tolist(), self.evidence) for each in self.members]
        # A merger can gain no more than this by the prior.
        most = 10.0 * len(self.slot)
        for i, j in np.argwhere(np.triu(change > -most)):
            both = sorted(self.members[i] + self.members[j])
            joint = log_prior(self.evidence.counts[both].tolist(), self.evidence)
            change[i, j] += joint - prior[i] - prior[j]
        change[np.tril_indices(count)] = -np.inf
        return change

    def _seat(self, tracklet: int, anchors: np.ndarray, first: bool | None, temperature: float) -> float:
        """Put a lone tracklet to the first of two anchors, to the other, or by chance (None); the log probability."""
        slots = self.slot[anchors]
        change = np.array([self._change(tracklet, slot) for slot in slots])
        scaled = change / temperature
        log_share = scaled - np.logaddexp(*scaled)
        k = int(self.rng.random() >= math.exp(log_share[0])) if first is None else int(not first)
        self.join(tracklet, slots[k], change[k])
        return float(log_share[k])

    def _change(self, tracklet: int, slot: int) -> float:
        """How the log posterior changes when a lone tracklet joins an object; -inf for a rival."""
        if self.evidence.rivals[tracklet, self.members[slot]].any():
            return -math.inf
        density = self._log_density(self.slot[tracklet], np.array([slot]))[0]
        return float(density) + self._seating(self.members[slot], tracklet, +1)

    def _saved(self) -> tuple:
        return (
            self.slot.copy(),
            [list(each) for each in self.members],
            self.cov.copy(),
            self.mean.copy(),
            self.log_posterior,
        )

    def _restore(self, saved: tuple) -> None:
        self.slot, self.members, self.cov, self.mean, self.log_posterior = saved

    def split_off(self, tracklet: int) -> float:
        """Take a tracklet out of its object, alone into a slot of its own; return how the log posterior changes.

        With ``l_t = l_i + delta`` the joint information of (l, delta) is [[J, V], [V^T, Lambda_tt]], V = A^T Lambda_t.
        """
        slot, t = self.slot[tracklet], slice(2 * tracklet, 2 * tracklet + 2)
        if len(self.members[slot]) == 1:
            return 0.0
        v = np.zeros((len(self.members), 4))
        np.add.at(v, self.slot, self._blocks[:, :, tracklet].reshape(-1, 4))
        v = v.reshape(-1, 2)
        s_v = self.cov @ v
        delta_cov = np.linalg.inv(self.evidence.information[t, t] - v.T @ s_v)
        delta = delta_cov @ (self.evidence.vector[t] - v.T @ self.mean)
        gain = s_v @ delta_cov
        self.cov += gain @ s_v.T
        self.mean -= s_v @ delta
        free, here = self._free_slot(), slice(2 * slot, 2 * slot + 2)
        there = slice(2 * free, 2 * free + 2)
        with_delta = np.zeros((len(self.cov), 2))
        with_delta[: len(gain)] = -gain
        row = self.cov[:, here] + with_delta
        self.cov[:, there], self.cov[there] = row, row.T
        self.cov[there, there] = self.cov[here, here] + with_delta[here] + with_delta[here].T + delta_cov
        self.mean[there] = self.mean[here] + delta
        change = self._seating(self.members[slot], tracklet, -1) - float(_log_normal(delta, delta_cov))
        self.members[slot].remove(tracklet)
        self.members[free] = [tracklet]
        self.slot[tracklet] = free
        self.log_posterior += change
        return change

    def join(self, tracklet: int, slot: int, change: float) -> None:
        """Put a tracklet that is alone into an object: condition on ``l_i - l_t = 0``. Its own slot: it stays alone."""
        own = self.slot[tracklet]
        if slot == own:
            return
        self._merge(own, slot)
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
            change[k] += self._seating(self.members[open_slots[k]], tracklet, +1)
        keep = open_slots[near]
        return np.append(own, keep), np.append(0.0, change[near])

    def draw(self, slots: np.ndarray, change: np.ndarray, temperature: float) -> tuple[int, float]:
        """One of the places, with probability in proportion to ``exp(change / temperature)``."""
        scaled = change / temperature
        weights = np.exp(scaled - scaled.max())
        k = int(np.searchsorted(np.cumsum(weights), self.rng.random() * weights.sum(), side="right"))
        k = min(k, len(slots) - 1)
        return int(slots[k]), float(change[k])

    def _merge(self, gone: int, stays: int) -> None:
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
        return _log_normal(mean[slots] - mean[own], cov)

    def _seating(self, members: list[int], tracklet: int, sign: int) -> float:
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


def _log_normal(difference: np.ndarray, cov: np.ndarray) -> np.ndarray:
    """The log density at zero of two-dimensional normals: mean (..., 2), covariance (..., 2, 2)."""
    a, b, d = cov[..., 0, 0], cov[..., 0, 1], cov[..., 1, 1]
    det = a * d - b * b
    x, y = difference[..., 0], difference[..., 1]
    squared = (d * x * x - 2 * b * x * y + a * y * y) / det
    return -squared / 2 - np.log(det) / 2 - math.log(2 * math.pi)
