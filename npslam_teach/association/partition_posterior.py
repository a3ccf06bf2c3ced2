"""Which tracklets are of one object? The posterior of a partition, the trajectory and the map integrated out.

The measurements enter as one quadratic form in the positions of the N tracklets (``pose_graph.reduced_system``). A
partition says which of these positions are one and the same. Its posterior is a Gaussian integral away:

    J = A^T Lambda A,  e = A^T eta                            A (2N, 2K): which tracklet is of which object
    log p = -(c - e^T J^-1 e) / 2 - log det(J / 2 pi) / 2 + sum_i log(prior of object i)

A tracklet is one draw of a Chinese restaurant process: its first observation is drawn, the others stay with it. An
object costs ``alpha / area`` (objects are uniform over the area), and joining it weighs as many observations as it has
by then. Where every tracklet is a single observation this is the process itself: ``alpha^K prod (n_i - 1)!``. Reports
of classes that are not certain weigh by how well those of one object agree (``semantics.class_evidence``), and so do
headings (``headings.log_heading_evidence``): object by object, beside the positions and not together with them.

``log_posterior`` and ``plain_weights`` say it as it is; ``gibbs`` says the same faster.
"""

import functools
import math
from itertools import accumulate
from typing import NamedTuple

import numpy as np

from npslam_teach.association.headings import log_heading_evidence
from npslam_teach.association.semantics import class_evidence, class_evidences


class HeadingEvidence(NamedTuple):
    """Which way the objects of N tracklets face, the position of the robot and of the objects not looked at."""

    theta: np.ndarray  # (N,) rad, all in one frame
    cov: np.ndarray  # (N, N) rad^2 of their errors
    symmetry: np.ndarray  # (N,) how many headings look alike; 0: nothing is said

    def log_agreement(self, members: list[int]) -> float:
        """``headings.log_heading_evidence`` of some tracklets for being one object."""
        told = [each for each in members if self.symmetry[each]]
        if len(told) < 2:
            return 0.0
        cov = self.cov[np.array(told)[:, None], told]
        return _agreement(self.theta[told].tobytes(), cov.tobytes(), int(self.symmetry[told].max()))


@functools.lru_cache(maxsize=10_000)
def _agreement(theta: bytes, cov: bytes, symmetry: int) -> float:
    """``log_heading_evidence`` of doubles, remembered: most objects of a partition are those of the one before."""
    theta = np.frombuffer(theta)
    return log_heading_evidence(theta, np.frombuffer(cov).reshape(len(theta), -1), symmetry)


class TrackletEvidence(NamedTuple):
    """What is known of N tracklets, in the order in which they were first seen."""

    constant: float
    vector: np.ndarray  # (2N,)
    information: np.ndarray  # (2N, 2N)
    counts: np.ndarray  # (N,) observations of each
    rivals: np.ndarray  # (N, N) bool, pairs that cannot be one object: seen in one frame, or of two classes
    alpha: float  # concentration
    area: float  # m^2
    classes: np.ndarray | None = None  # (N, C) what the reports of each say, logarithms; None: only ``rivals`` says it
    headings: HeadingEvidence | None = None  # where the log has some


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
    prior = sum(log_prior(each, evidence) for each in members)
    return log_evidence(evidence, precision, vector, np.linalg.solve(precision, vector), prior)


def log_evidence(evidence: TrackletEvidence, precision, vector, mean, prior: float) -> float:
    """``log_posterior`` of a partition whose joint system is known.

    Args:
        evidence: of N tracklets.
        precision: (2K, 2K) J.
        vector: (2K,) e.
        mean: (2K,) J^-1 e.
        prior: the sum of ``log_prior`` over all objects.
    """
    chi2 = evidence.constant - vector @ mean
    log_det = np.linalg.slogdet(precision / (2 * np.pi))[1]
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


def log_priors(labels: np.ndarray, evidence: TrackletEvidence) -> float:
    """The sum of ``log_prior`` over all objects; in one piece, where only the seats count.

    Args:
        labels: (N,) the object of each tracklet, from 0 without gaps.
        evidence: of N tracklets.
    """
    order = np.argsort(labels, kind="stable")
    begins = np.diff(labels[order], prepend=-1) != 0
    if evidence.classes is not None or evidence.headings is not None:
        return _sum_of_log_priors(order, np.flatnonzero(begins), evidence)
    seated = np.cumsum(evidence.counts[order]) - evidence.counts[order]
    before = seated - np.maximum.accumulate(np.where(begins, seated, 0))
    return float(begins.sum() * math.log(evidence.alpha / evidence.area) + np.log(before[~begins]).sum())


def _sum_of_log_priors(order: np.ndarray, starts: np.ndarray, evidence: TrackletEvidence) -> float:
    """``log_priors`` where classes or headings count: tracklets by their objects, and where each object begins."""
    members = [each.tolist() for each in np.split(order, starts[1:])]
    counts = evidence.counts.tolist()
    priors = [_of_seats_and_headings([counts[k] for k in each], each, evidence) for each in members]
    if evidence.classes is not None and len(order):
        agreement = class_evidences(np.add.reduceat(evidence.classes[order], starts, axis=0))
        priors = [prior + each for prior, each in zip(priors, agreement, strict=True)]
    return sum(priors)


def log_prior(members: list[int], evidence: TrackletEvidence) -> float:
    """The log prior of an object of these tracklets, in the order of first sight, and of what they say of its class."""
    prior = _of_seats_and_headings(evidence.counts[members].tolist(), members, evidence)
    if evidence.classes is None or not members:
        return prior
    return prior + class_evidence(evidence.classes[members].sum(axis=0))


def _of_seats_and_headings(counts: list[int], members: list[int], evidence: TrackletEvidence) -> float:
    """``log_prior`` but for classes, of tracklets with so many observations."""
    seats = math.log(evidence.alpha / evidence.area) + _log_seats(tuple(counts))
    return seats if evidence.headings is None else seats + evidence.headings.log_agreement(members)


@functools.lru_cache(maxsize=10_000)
def _log_seats(counts: tuple[int, ...]) -> float:
    """What the tracklets of an object weigh when each joins those before it."""
    return sum(math.log(before) for before in accumulate(counts[:-1]))


def plain_weights(evidence: TrackletEvidence, labels: np.ndarray, tracklet: int) -> np.ndarray:
    """The log posterior for every place that one tracklet may take, all others kept: (K+1,), the last for a new object.

    Args:
        evidence: of N tracklets.
        labels: (N,); the K objects of the others count in the order of their labels.
        tracklet: which.
    """
    objects, of_others = np.unique(np.delete(labels, tracklet), return_inverse=True)
    return np.array(
        [log_posterior(evidence, np.insert(of_others, tracklet, place)) for place in range(len(objects) + 1)]
    )
