"""How much a log says that it errs: one noise for all steps and observations, or a covariance for each."""

from dataclasses import replace

import numpy as np

from npslam_teach.types import RobotLog
from npslam_teach.validation import checked_array, require_positive


def with_noise(log: RobotLog, odometry_std=None, observation_std=None) -> RobotLog:
    """The same measurements with one noise for all steps, or for all observations; what is None stays as the log says.

    Args:
        log: what the robot measured.
        odometry_std: (3,) m, m, rad per step.
        observation_std: (2,) m.
    """
    if odometry_std is not None:
        log = replace(log, odometry_std=odometry_std, odometry_cov=None)
    if observation_std is not None:
        log = replace(log, observation_std=observation_std, observation_cov=None)
    return log


def step_covariances(log: RobotLog) -> np.ndarray:
    """(T-1, 3, 3) m, m, rad: of each step, its own or what holds for all."""
    if log.odometry_cov is not None:
        return log.odometry_cov
    return np.broadcast_to(np.diag(log.odometry_std**2), (len(log.odometry), 3, 3))


def observation_covariances(log: RobotLog) -> np.ndarray:
    """(M, 2, 2) m^2, in the frame of the robot: of each observation, its own or what holds for all."""
    if log.observation_cov is not None:
        return log.observation_cov
    return np.broadcast_to(np.diag(log.observation_std**2), (log.num_observations, 2, 2))


def range_bearing_covariances(obs_xy, range_std: float, bearing_std: float) -> np.ndarray:
    """The covariance of observations by a sensor that measures how far and in which direction.

    It errs by ``range_std`` along the ray and by distance times ``bearing_std`` across it.

    Args:
        obs_xy: (M, 2) m, where the robot sees the objects; not where the robot stands.
        range_std: m.
        bearing_std: rad.

    Returns:
        (M, 2, 2) m^2, for ``RobotLog.observation_cov``.

    Raises:
        ValueError: a number is not positive, or an object stands where the robot does.
    """
    obs_xy = checked_array("obs_xy", obs_xy, (None, 2))
    for name, std in (("range_std", range_std), ("bearing_std", bearing_std)):
        require_positive(name, np.asarray(std, dtype=float))
    distance = np.linalg.norm(obs_xy, axis=1)
    require_positive("distances of obs_xy", distance)
    along = obs_xy / distance[:, None]
    across = np.column_stack([-along[:, 1], along[:, 0]])
    spread = range_std**2, (distance * bearing_std)[:, None, None] ** 2
    return sum(var * axis[:, :, None] * axis[:, None, :] for var, axis in zip(spread, (along, across), strict=True))


def block_diagonal(blocks: np.ndarray) -> np.ndarray:
    """The covariance (md, md) of m independent errors, from that of each (m, d, d)."""
    count, size, _ = blocks.shape
    whole = np.zeros((count, size, count, size))
    whole[np.arange(count), :, np.arange(count)] = blocks
    return whole.reshape(count * size, count * size)
