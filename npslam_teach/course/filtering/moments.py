"""A moment of the filter, before it uses what it sees: what its gates are made of."""

from dataclasses import dataclass

import numpy as np

from npslam_teach.methods.ekf import expected_observations
from npslam_teach.methods.ekf_slam import FilterStep
from npslam_teach.types import RobotLog


@dataclass(frozen=True, eq=False)
class Moment:
    """One step of the filter, before its observations are used. m of them, K objects."""

    step: FilterStep
    squared_distance: np.ndarray  # (m, K) infinite where the classes differ
    expected: np.ndarray  # (K, 2) m, in the frame of the robot
    innovation_cov: np.ndarray  # (K, 2, 2) m^2
    xy_robot: np.ndarray  # (m, 2) m, what was measured

    def squared_distance_of(self, xy_robot: np.ndarray) -> np.ndarray:
        """The same if the observations were measured at ``xy_robot`` (m, 2) m."""
        away = self._mahalanobis(xy_robot) - self._mahalanobis(self.xy_robot)
        # Where nothing is moved away is zero but for rounding, which must not make a distance negative.
        moved = np.maximum(np.where(np.isfinite(self.squared_distance), self.squared_distance, 0.0) + away, 0.0)
        return np.where(np.isfinite(self.squared_distance), moved, np.inf)

    def _mahalanobis(self, xy_robot: np.ndarray) -> np.ndarray:
        innovation = xy_robot[:, None] - self.expected
        return np.einsum("mki,kij,mkj->mk", innovation, np.linalg.inv(self.innovation_cov), innovation)

    @property
    def gated(self) -> np.ndarray:
        """The objects that have a gate: those of a class that is seen, or all of them where no such class is."""
        of_class = np.isfinite(self.squared_distance).any(axis=0)
        return np.flatnonzero(of_class) if of_class.any() else np.arange(len(of_class))


def moment_of(step: FilterStep, log: RobotLog) -> Moment:
    """What gates need of a step of a filter; its own decision is ignored.

    Args:
        step: of ``ekf_slam.filter_steps``.
        log: what it runs on.
    """
    # With known associations the distances of a filter ignore classes; gates do not.
    rivals = log.obs_class[step.observations][:, None] == step.object_class
    squared = np.where(rivals, step.squared_distance, np.inf)
    known = np.arange(len(step.object_class))
    expected, cov = expected_observations(step.prior_mean, step.prior_cov, known, log.observation_std)
    return Moment(step, squared, expected, cov, log.obs_xy[step.observations])
