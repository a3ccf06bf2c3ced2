"""What the methods share about headings: which way objects face, beside where they stand.

The deck's second complaint is that an object is a point. Here an observation may say which way its object faces, and a
landmark becomes a pose. ``np_graph`` multiplies its kernel by one of headings (``association.headings``), ``ekf_slam``
gates position and heading together, ``posterior`` weighs how well the headings of one object agree; the pose graph has
a factor for each heading (``pose_graph.object_headings``). A table turned by half looks the same: every difference of
headings is the smallest that looks alike.
"""

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from npslam_teach import se2
from npslam_teach.association import PAPER_KERNEL_STD, SeenHeadings
from npslam_teach.association.headings import log_heading_evidence
from npslam_teach.association.partition_posterior import HeadingEvidence
from npslam_teach.methods.gating import as_two_degrees
from npslam_teach.methods.noise import observation_covariances, step_covariances
from npslam_teach.methods.settings import PAPER_OBSERVATION_NOISE
from npslam_teach.pose_graph import mean_headings, symmetries
from npslam_teach.pose_graph.object_headings import symmetry_of_objects
from npslam_teach.types import RobotLog

KERNEL_WIDTHS = float(PAPER_KERNEL_STD / PAPER_OBSERVATION_NOISE[0])  # st. deviations that the paper's kernel is wide


def without_headings(log: RobotLog) -> RobotLog:
    """The same log for a method that does not look at headings."""
    if log.obs_theta is None:
        return log
    return replace(log, obs_theta=None, observation_theta_std=None)


def turns_of_odometry(log: RobotLog) -> np.ndarray:
    """(T,) rad: how far the robot has turned since pose 0, by its odometry alone."""
    return np.append(0.0, np.cumsum(log.odometry[:, 2]))


def kernel_heading_std(log: RobotLog, heading_std: float | None) -> float | None:
    """What an alternation assumes of a heading, in rad: as much wider than the sensor as the paper's kernel is.

    Args:
        log: what was measured.
        heading_std: rad, what was asked for; None: by the log.

    Raises:
        ValueError: it is not positive.
    """
    if heading_std is not None and not 0 < heading_std < np.inf:
        raise ValueError(f"heading_std: expected a positive number of radians, got {heading_std}")
    if heading_std is None and log.obs_theta is not None:
        return KERNEL_WIDTHS * log.observation_theta_std
    return heading_std


def seen_headings(log: RobotLog, poses: np.ndarray, std: float | None) -> SeenHeadings | None:
    """The headings of all observations in the world; None where the log has none.

    Args:
        log: what was measured.
        poses: (T, 3) W.
        std: rad, the width of the kernel.
    """
    if log.obs_theta is None:
        return None
    return SeenHeadings(se2.wrap(poses[log.obs_time, 2] + log.obs_theta), symmetries(log), std)


def sights(log: RobotLog) -> tuple[np.ndarray, np.ndarray]:
    """What a filter is fed with: (M, 2) places and (M, 2, 2), or with headings (M, 3) and (M, 3, 3).

    The heading of something round is 0 with a variance of 1; ``block_filter`` takes care that it says nothing.
    """
    cov = observation_covariances(log)
    if log.obs_theta is None:
        return log.obs_xy, cov
    said = symmetries(log) > 0
    wider = np.zeros((log.num_observations, 3, 3))
    wider[:, :2, :2], wider[:, 2, 2] = cov, np.where(said, log.observation_theta_std**2, 1.0)
    return np.column_stack([log.obs_xy, np.where(said, log.obs_theta, 0.0)]), wider


class Headings(NamedTuple):
    """Headings and how sure they are, of observations or of the objects in view."""

    theta: np.ndarray  # (K,) rad, in the frame of the robot
    var: np.ndarray  # (K,) rad^2
    symmetry: np.ndarray  # (K,) 0: nothing is said

    @classmethod
    def of_log(cls, log: RobotLog) -> "Headings":
        """Those of all observations."""
        symmetry, count = symmetries(log), log.num_observations
        if log.obs_theta is None:
            return cls(np.zeros(count), np.ones(count), symmetry)
        return cls(log.obs_theta, np.full(count, log.observation_theta_std**2), symmetry)

    @classmethod
    def silent(cls, count: int) -> "Headings":
        """So many that say nothing."""
        return cls(np.zeros(count), np.ones(count), np.zeros(count, dtype=int))

    def of(self, which: np.ndarray) -> "Headings":
        """Some of them."""
        return Headings(*(column[which] for column in self))

    def joined_by(self, others: "Headings") -> "Headings":
        """These and then others."""
        return Headings(*(np.append(mine, theirs) for mine, theirs in zip(self, others, strict=True)))

    def after_turn(self, turn: float, var: float) -> "Headings":
        """As the robot sees them after it has turned, with an error of this variance."""
        return self._replace(theta=self.theta - turn, var=self.var + var)

    def with_positions(self, squared: np.ndarray, seen: "Headings") -> np.ndarray:
        """Squared distances (m, K) of positions, with those of headings seen (m,) added; as of two degrees of freedom.

        Position and heading of an object are taken for independent here.
        """
        both = (seen.symmetry[:, None] > 0) & (self.symmetry > 0)
        if not both.any():
            return squared
        off = se2.wrap_symmetric(seen.theta[:, None] - self.theta, seen.symmetry[:, None])
        return np.where(both, as_two_degrees(squared + off**2 / (seen.var[:, None] + self.var)), squared)

    def updated(self, which: np.ndarray, seen: "Headings") -> "Headings":
        """After one observation each (m,) of some objects (m,): a Kalman update of each by itself."""
        own = self.of(which)
        gain = np.where((own.symmetry > 0) & (seen.symmetry > 0), own.var / (own.var + seen.var), 0.0)
        theta, var = self.theta.copy(), self.var.copy()
        theta[which] += gain * se2.wrap_symmetric(seen.theta - own.theta, seen.symmetry)
        var[which] *= 1.0 - gain
        return self._replace(theta=theta, var=var)


@dataclass(frozen=True, eq=False)
class ChainHeadings:
    """Headings carried along the odometry alone, for which the errors of the robot's own heading are known exactly.

    The robot's heading is a random walk: each step adds its error to all that follow. What two passes say of one object
    is therefore as uncertain as the walk between them; the object's own heading is integrated out. Two things are left
    out: that positions and other objects tell of the robot's heading too, so that less is known here than could be; and
    that an error of a turn shows in positions as well, whose evidence is counted as independent of this one.
    """

    theta: np.ndarray  # (M,) rad, in the frame of pose 0
    symmetry: np.ndarray  # (M,)
    time: np.ndarray  # (M,) pose
    var: float  # rad^2, of one heading
    step_var: np.ndarray  # (T-1,) rad^2, of the turn of each step

    @classmethod
    def of_log(cls, log: RobotLog) -> "ChainHeadings | None":
        """Those of a log; None where it has none that say anything."""
        symmetry = symmetries(log)
        if not symmetry.any():
            return None
        turned = turns_of_odometry(log)[log.obs_time]
        step_var = step_covariances(log)[:, 2, 2]
        return cls(turned + log.obs_theta, symmetry, log.obs_time, log.observation_theta_std**2, step_var)

    def of_tracklets(self, tracklet: np.ndarray) -> HeadingEvidence:
        """The mean heading of each tracklet, and the covariance of their errors.

        A tracklet's mean holds the error of a step as often as it has observations after that step.

        Args:
            tracklet: (M,) of each observation, from 0 without gaps; -1 = of none.
        """
        symmetry = symmetry_of_objects(tracklet, self.symmetry)
        used = np.flatnonzero((tracklet >= 0) & (self.symmetry > 0))
        seen = np.zeros((len(symmetry), len(self.step_var) + 1))
        np.add.at(seen, (tracklet[used], self.time[used]), 1.0)
        counts = np.maximum(seen.sum(axis=1), 1.0)
        after = 1.0 - np.cumsum(seen, axis=1)[:, :-1] / counts[:, None]  # the share that is seen after each step
        cov = (after * self.step_var) @ after.T + np.diag(self.var / counts)
        return HeadingEvidence(mean_headings(tracklet, self.theta, self.symmetry), cov, symmetry)

    def agreement_within(self, tracklet: np.ndarray) -> float:
        """``log_heading_evidence`` of the observations of each tracklet for being one heading, summed over tracklets.

        The walk within a tracklet counts too: where headings are measured to a degree or two, a robot's own heading
        errs more while an object stays in view.

        Args:
            tracklet: (M,) of each observation, from 0 without gaps; -1 = of none.
        """
        used = np.flatnonzero((tracklet >= 0) & (self.symmetry > 0))
        used = used[np.argsort(tracklet[used], kind="stable")]
        each = np.split(used, np.flatnonzero(np.diff(tracklet[used])) + 1)
        # Most tracklets are the same in the next partition that is asked for.
        return sum(_agreement_of(self, indices.tobytes()) for indices in each)

    def squared_turns(self, labels: np.ndarray, correction: np.ndarray) -> np.ndarray:
        """How far every observation is turned from every object, squared, in standard deviations: (M, K).

        Args:
            labels: (M,) the object of each, from 0 without gaps; -1 = of none.
            correction: (T,) rad, what the heading of each pose is beyond the turns of the odometry.
        """
        theta, symmetry = self.theta + correction[self.time], symmetry_of_objects(labels, self.symmetry)
        both = (self.symmetry[:, None] > 0) & (symmetry > 0)
        off = theta[:, None] - mean_headings(labels, theta, self.symmetry)
        return se2.wrap_symmetric(off, np.where(both, symmetry, 0)) ** 2 / self.var


@lru_cache(20_000)
def _agreement_of(headings: ChainHeadings, indices: bytes) -> float:
    """``log_heading_evidence`` of some observations, by the bytes of their indices (n,)."""
    own = np.frombuffer(indices, dtype=int)
    if len(own) < 2:
        return 0.0
    walk = np.append(0.0, np.cumsum(headings.step_var))[headings.time[own]]
    cov = np.minimum(walk[:, None], walk) - walk.min() + headings.var * np.eye(len(own))
    return log_heading_evidence(headings.theta[own], cov, int(headings.symmetry[own[0]]))
