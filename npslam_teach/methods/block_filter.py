"""The filter of ``ekf``, written on the blocks that it touches: O(n^2) per frame instead of O(n^3).

A step moves the pose alone, so only three rows and columns of the covariance change; an observation depends on the pose
and on one object, so that H P is a sum of a few rows. ``ekf`` says the same with whole matrices; a test compares them.
"""

from dataclasses import dataclass

import numpy as np

from npslam_teach import se2
from npslam_teach.methods.ekf import POSE, motion_jacobians
from npslam_teach.methods.gating import as_two_degrees, squared_mahalanobis
from npslam_teach.methods.noise import block_diagonal
from npslam_teach.pose_graph import between_jacobians, observation_jacobians


@dataclass(frozen=True, eq=False)
class Belief:
    """One Gaussian over the present pose and K objects, of s numbers each: 2, or 3 with a heading."""

    mean: np.ndarray  # (3 + s K,) W
    cov: np.ndarray  # (3 + s K, 3 + s K)
    size: int = 2  # s

    @classmethod
    def at_origin(cls, size: int = 2) -> "Belief":
        """Certain to stand at the origin, and of no object."""
        return cls(np.zeros(3), np.zeros((3, 3)), size)

    @property
    def objects(self) -> np.ndarray:
        """(K, s) W."""
        return self.mean[3:].reshape(-1, self.size)

    def predicted(self, step: np.ndarray, step_cov: np.ndarray) -> "Belief":
        """After one odometry step (3,), its covariance (3, 3)."""
        by_pose, by_step = motion_jacobians(self.mean[POSE], step)
        mean, cov = self.mean.copy(), self.cov.copy()
        mean[POSE] = se2.compose(self.mean[POSE], step)
        cov[POSE] = by_pose @ cov[POSE]
        cov[:, POSE] = cov[:, POSE] @ by_pose.T
        cov[POSE, POSE] += by_step @ step_cov @ by_step.T
        return Belief(mean, cov, self.size)

    def squared_distances(self, seen: np.ndarray, noise: np.ndarray, symmetry: np.ndarray | None = None) -> np.ndarray:
        """Squared Mahalanobis distance of observations (m, s), noise (m, s, s), to all objects, (m, K).

        Of position and heading together, as of two degrees of freedom (``gating.as_two_degrees``).
        """
        count, size = len(self.objects), self.size
        by_pose, by_object = self._jacobians(self.objects)
        cross = self.cov[POSE, 3:].reshape(3, count, size).swapaxes(0, 1)
        own = self.cov[3:, 3:].reshape(count, size, count, size)[np.arange(count), :, np.arange(count)]
        mixed = by_pose @ cross @ by_object.swapaxes(1, 2)
        cov = by_pose @ self.cov[POSE, POSE] @ by_pose.swapaxes(1, 2) + by_object @ own @ by_object.swapaxes(1, 2)
        cov = cov + mixed + mixed.swapaxes(1, 2)
        if size == 2:
            return squared_mahalanobis(self._innovation(seen[:, None, :], self.objects), cov + noise[:, None])
        told = _told(symmetry)[:, None]
        innovation = self._innovation(seen[:, None, :], self.objects, symmetry[:, None])
        squared = squared_mahalanobis(innovation, cov * told[..., :, None] * told[..., None, :] + noise[:, None])
        return np.where(symmetry[:, None] > 0, as_two_degrees(squared), squared)

    def updated(
        self, objects: np.ndarray, seen: np.ndarray, noise: np.ndarray, symmetry: np.ndarray | None = None
    ) -> tuple["Belief", float]:
        """After observations (m, s), noise (m, s, s), of objects (m,), all at once; and NIS, ``y^T S^-1 y``."""
        size, there = self.size, self.objects[objects]
        by_pose, by_object = self._jacobians(there)
        if size == 3:  # what is round says nothing of any heading
            by_pose, by_object = (_told(symmetry)[:, :, None] * by for by in (by_pose, by_object))
        of_objects = self.cov[3:].reshape(-1, size, len(self.mean))[objects]
        h_cov = (by_pose @ self.cov[POSE] + by_object @ of_objects).reshape(-1, len(self.mean))  # H P
        s = (h_cov[:, POSE] @ by_pose.reshape(-1, 3).T).reshape(-1, len(objects), size)
        across = h_cov[:, 3:].reshape(len(h_cov), -1, size)[:, objects]
        s = (s + np.einsum("rmk,mjk->rmj", across, by_object)).reshape(len(h_cov), -1)
        s += block_diagonal(noise)
        innovation = self._innovation(seen, there, symmetry).ravel()
        gain = np.linalg.solve(s, h_cov).T
        mean, cov = self.mean + gain @ innovation, self.cov - gain @ h_cov
        mean[2] = se2.wrap(mean[2])
        return Belief(mean, (cov + cov.T) / 2, size), float(innovation @ np.linalg.solve(s, innovation))

    def with_new_object(self, seen: np.ndarray, noise: np.ndarray, symmetry: int = 1) -> "Belief":
        """An object more, which stands where it is seen (s,), noise (s, s), and shares the error of the pose."""
        size, count = self.size, len(self.mean)
        by_pose, by_observation = (j[:size] for j in motion_jacobians(self.mean[POSE], np.append(seen[:2], 0.0)))
        by_pose = by_pose if size == 2 else by_pose * _told(np.array(symmetry))[:, None]
        cross = by_pose @ self.cov[POSE]
        cov = np.empty((count + size, count + size))
        cov[:count, :count], cov[count:, :count], cov[:count, count:] = self.cov, cross, cross.T
        turned = by_observation[:, :size] @ noise @ by_observation[:, :size].T
        cov[count:, count:] = cross[:, POSE] @ by_pose.T + turned
        place = se2.apply(self.mean[POSE], seen[:2])
        if size == 3:
            place = np.append(place, se2.wrap(self.mean[2] + seen[2]) if symmetry > 0 else 0.0)
        return Belief(np.append(self.mean, place), cov, size)

    def _jacobians(self, objects: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """By the pose and by each object (m, s) of how it appears: (m, s, 3) and (m, s, s)."""
        pose = np.broadcast_to(self.mean[POSE], (len(objects), 3))
        return (observation_jacobians if self.size == 2 else between_jacobians)(pose, objects)

    def _innovation(self, seen: np.ndarray, objects: np.ndarray, symmetry: np.ndarray | None = None) -> np.ndarray:
        """What is seen (..., s) less what was expected of the objects (..., s)."""
        off = seen[..., :2] - se2.apply_inverse(self.mean[POSE], objects[..., :2])
        if self.size == 2:
            return off
        turn = se2.wrap_symmetric(seen[..., 2] - (objects[..., 2] - self.mean[2]), symmetry)
        return np.concatenate([off, turn[..., None]], axis=-1)


def _told(symmetry: np.ndarray) -> np.ndarray:
    """(..., 3) 1 for what an observation says something about: not for the heading of something round."""
    told = np.ones((*np.shape(symmetry), 3))
    told[..., 2] = np.greater(symmetry, 0)
    return told
