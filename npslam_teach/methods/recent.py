"""Who is who among the tracklets at hand: recent ones, which may still change their object, and old objects.

The front of ``pose_graph.SubmapTree`` is the joint Gaussian of the newest pose and all of these, everything else at its
best. Without the pose it is what ``association.gibbs`` samples from; with those of one object held together it says
where the robot is.
"""

from typing import NamedTuple

import numpy as np

from npslam_teach.association.gibbs import GibbsSampler
from npslam_teach.association.partition_posterior import TrackletEvidence
from npslam_teach.association.split_merge import merge_objects, split_or_merge
from npslam_teach.pose_graph.submaps import Submap

PROPOSALS = 4  # to split or to merge, each time that everything is asked again
CLEARLY = 1e-6  # by which the log posterior has to rise
DOUBT = 1.0  # of the log posterior: what it must cost a tracklet to leave its object, if it is to keep it for good
COLD = 0.01


class Front(NamedTuple):
    """The newest pose and N tracklets, coordinates relative to the pose's position: small numbers keep their digits."""

    ids: np.ndarray  # (N,)
    origin: np.ndarray  # (2,) m, W
    mean: np.ndarray  # (3 + 2N,) around which it is linear
    vector: np.ndarray  # (3 + 2N,) information @ minimum
    information: np.ndarray  # (3 + 2N, 3 + 2N)

    @classmethod
    def of(cls, part: Submap) -> "Front":
        """From the top of the tree."""
        origin, mean = part.at[:2].copy(), part.at.copy()
        mean[:2] = 0.0
        mean[3:] -= np.tile(origin, len(part.ids))
        return cls(part.ids, origin, mean, part.information @ mean - part.gradient, part.information)

    def together(self, labels: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """When tracklets of one object stand at one place.

        Args:
            labels: (N,) the object of each, from 0 without gaps.

        Returns:
            (3 + 2N,) values of pose and tracklets, in W; (3 + 2K,) of pose and objects relative to ``origin``, and
            their covariance.
        """
        of = np.concatenate([[0, 1, 2], (3 + 2 * labels[:, None] + np.array([0, 1])).ravel()])
        gather = np.zeros((len(of), of.max() + 1))
        gather[np.arange(len(of)), of] = 1.0
        cov = np.linalg.inv(gather.T @ self.information @ gather)
        found = cov @ (gather.T @ self.vector)
        values = found[of]
        values[:2] += self.origin
        values[3:] += np.tile(self.origin, len(self.ids))
        return values, found, (cov + cov.T) / 2

    def without_pose(self) -> tuple[np.ndarray, np.ndarray]:
        """Vector (2N,) and information (2N, 2N) of the tracklets alone, the pose integrated out."""
        tie = self.information[3:, :3]
        taken = np.linalg.solve(self.information[:3, :3], np.column_stack([tie.T, self.vector[:3]]))
        information = self.information[3:, 3:] - tie @ taken[:, :-1]
        return self.vector[3:] - tie @ taken[:, -1], (information + information.T) / 2


def sampler_of(front: Front, labels: np.ndarray, books, alpha: float, area: float, rng) -> GibbsSampler:
    """A sampler of the partitions of the tracklets at hand.

    Args:
        front: with N tracklets.
        labels: (N,) the partition to begin with.
        books: ``Sightings``.
        alpha: concentration of the Dirichlet process.
        area: m^2 over which objects are uniform.
        rng: the generator.
    """
    vector, information = front.without_pose()
    seen = books.seen[front.ids] if books.uncertain else None
    counts, rivals = books.passes[front.ids], books.rivals(front.ids)
    return GibbsSampler(TrackletEvidence(0.0, vector, information, counts, rivals, alpha, area, seen), labels, rng)


def asked_again(sampler: GibbsSampler, recent: np.ndarray) -> None:
    """Draw a partition near the present one, go downhill from there, and keep the better of the two.

    Args:
        sampler: of the present partition; changed in place.
        recent: indices of the tracklets that may change their object; older ones only as whole objects.
    """
    before = sampler.saved()
    sampler.sweep(1.0, recent)
    for _ in range(PROPOSALS):
        split_or_merge(sampler)
    sampler.sweep(COLD, recent)
    merge_objects(sampler)
    if sampler.log_posterior <= before[-1] + CLEARLY:
        sampler.restore(before)


def without_doubtful(sampler: GibbsSampler, which: np.ndarray) -> None:
    """Tracklets that are to keep their object for good stand alone, where that is nearly as probable.

    Args:
        sampler: changed in place.
        which: indices of these tracklets, the oldest of each object not among them.
    """
    for tracklet in which:
        apart = sampler.apart(tracklet)
        if apart.change > -DOUBT:
            sampler.split_off(tracklet, apart)
    sampler.refresh()


def greedily(sampler: GibbsSampler, new: np.ndarray) -> None:
    """Each of the new tracklets goes where it is most probable."""
    sampler.sweep(COLD, new)
