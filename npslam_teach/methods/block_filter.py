"""The filter of ``ekf``, written on the blocks that it touches: O(n^2) per frame instead of O(n^3).

A step moves the pose alone, so only three rows and columns of the covariance change; an observation depends on the pose
and on one object, so that H P is a sum of a few rows. ``ekf`` says the same with whole matrices; a test compares them.
"""

from dataclasses import dataclass

import numpy as np

from npslam_teach import se2
from npslam_teach.methods.ekf import POSE, landmarks_of, motion_jacobians
from npslam_teach.methods.gating import squared_mahalanobis
from npslam_teach.methods.noise import block_diagonal
from npslam_teach.pose_graph import observation_jacobians


@dataclass(frozen=True, eq=False)
class Belief:
    """One Gaussian over the present pose and K objects."""

    mean: np.ndarray  # (3 + 2K,) W
    cov: np.ndarray  # (3 + 2K, 3 + 2K)

    @classmethod
    def at_origin(cls) -> "Belief":
        """Certain to stand at the origin, and of no object."""
        return cls(np.zeros(3), np.zeros((3, 3)))

    def predicted(self, step: np.ndarray, step_cov: np.ndarray) -> "Belief":
        """After one odometry step (3,), its covariance (3, 3)."""
        by_pose, by_step = motion_jacobians(self.mean[POSE], step)
        mean, cov = self.mean.copy(), self.cov.copy()
        mean[POSE] = se2.compose(self.mean[POSE], step)
        cov[POSE] = by_pose @ cov[POSE]
        cov[:, POSE] = cov[:, POSE] @ by_pose.T
        cov[POSE, POSE] += by_step @ step_cov @ by_step.T
        return Belief(mean, cov)

    def squared_distances(self, xy: np.ndarray, noise: np.ndarray) -> np.ndarray:
        """Squared Mahalanobis distance of observations (m, 2), noise (m, 2, 2), to all objects, (m, K)."""
        count = len(landmarks_of(self.mean))
        pose = np.broadcast_to(self.mean[POSE], (count, 3))
        by_pose, by_object = observation_jacobians(pose, landmarks_of(self.mean))
        cross = self.cov[POSE, 3:].reshape(3, count, 2).swapaxes(0, 1)
        own = self.cov[3:, 3:].reshape(count, 2, count, 2)[np.arange(count), :, np.arange(count)]
        mixed = by_pose @ cross @ by_object.swapaxes(1, 2)
        cov = by_pose @ self.cov[POSE, POSE] @ by_pose.swapaxes(1, 2) + by_object @ own @ by_object.swapaxes(1, 2)
        cov = cov + mixed + mixed.swapaxes(1, 2)
        expected = se2.apply_inverse(self.mean[POSE], landmarks_of(self.mean))
        return squared_mahalanobis(xy[:, None, :] - expected, cov + noise[:, None])

    def updated(self, objects: np.ndarray, xy: np.ndarray, noise: np.ndarray) -> tuple["Belief", float]:
        """After observations (m, 2), noise (m, 2, 2), of objects (m,), all at once; and NIS, ``y^T S^-1 y``."""
        pose = np.broadcast_to(self.mean[POSE], (len(objects), 3))
        by_pose, by_object = observation_jacobians(pose, landmarks_of(self.mean)[objects])
        of_objects = self.cov[3:].reshape(-1, 2, len(self.mean))[objects]
        h_cov = (by_pose @ self.cov[POSE] + by_object @ of_objects).reshape(-1, len(self.mean))  # H P
        s = (h_cov[:, POSE] @ by_pose.reshape(-1, 3).T).reshape(-1, len(objects), 2)
        seen = h_cov[:, 3:].reshape(len(h_cov), -1, 2)[:, objects]
        s = (s + np.einsum("rmk,mjk->rmj", seen, by_object)).reshape(len(h_cov), -1)
        s += block_diagonal(noise)
        innovation = (xy - se2.apply_inverse(self.mean[POSE], landmarks_of(self.mean)[objects])).ravel()
        gain = np.linalg.solve(s, h_cov).T
        mean, cov = self.mean + gain @ innovation, self.cov - gain @ h_cov
        mean[2] = se2.wrap(mean[2])
        return Belief(mean, (cov + cov.T) / 2), float(innovation @ np.linalg.solve(s, innovation))

    def with_new_object(self, xy: np.ndarray, noise: np.ndarray) -> "Belief":
        """An object more, which stands where it is seen (2,), noise (2, 2), and shares the error of the pose."""
        by_pose, by_observation = (j[:2] for j in motion_jacobians(self.mean[POSE], np.append(xy, 0.0)))
        cross, count = by_pose @ self.cov[POSE], len(self.mean)
        cov = np.empty((count + 2, count + 2))
        cov[:count, :count], cov[count:, :count], cov[:count, count:] = self.cov, cross, cross.T
        turned = by_observation[:, :2] @ noise @ by_observation[:, :2].T
        cov[count:, count:] = cross[:, POSE] @ by_pose.T + turned
        return Belief(np.append(self.mean, se2.apply(self.mean[POSE], xy)), cov)
