"""A log and the object of each of its observations make a pose graph: its factors, its start, and the best fit."""

from dataclasses import replace

import numpy as np

from npslam_teach import se2
from npslam_teach.pose_graph.multi_start import optimize
from npslam_teach.pose_graph.object_headings import with_headings
from npslam_teach.types import NO_HEADINGS, BetweenFactors, ObservationFactors, PoseGraph, RobotLog
from npslam_teach.validation import checked_array

SMALLEST_STD = 1e-7  # m or rad; the information of a smaller one, 1 / std^2, is beyond `validation.LARGEST`
LARGEST_STD = 1e5  # m or rad; beside other factors one of a larger is lost in rounding


def fit(log: RobotLog, labels, poses=None, odometry_std=None, observation_std=None) -> PoseGraph:
    """The best fit to the log when it is known which observation is of which object: the back end alone.

    Where the log has headings, the objects have them too.

    Args:
        log: what was measured.
        labels: (M,) index of the object of each observation, from 0 without gaps; -1 leaves the observation out.
        poses: (T, 3) W, from which the solver sets out; None: dead reckoning.
        odometry_std: (3,) m, m, rad, what the solver assumes per step; None: what the log says, of each if it does.
        observation_std: (2,) m, and per observation; None: what the log says.
    """
    labels = np.asarray(labels, dtype=int)
    poses = se2.dead_reckoning(log.odometry) if poses is None else poses
    obs_xy_world = se2.apply(poses[log.obs_time], log.obs_xy)
    factors = odometry_factors(log, odometry_std), observation_factors(log, labels, observation_std)
    graph = PoseGraph(poses, mean_landmarks(labels, obs_xy_world), *factors)
    return optimize(with_headings(log, graph, labels, graph.landmarks))


def with_associations(
    log: RobotLog, graph: PoseGraph, labels, landmarks, observation_std=None, heading_std=None
) -> PoseGraph:
    """The same trajectory, and every observation tied to the object it is now thought to be of.

    Args:
        log: what was measured.
        graph: whose poses and odometry factors are kept.
        labels: (M,) index of the object of each observation; -1 leaves the observation out.
        landmarks: (K, 2) m, W: where the objects are to start; with a log that has headings also (K, 3).
        observation_std: (2,) m; None: what the log says.
        heading_std: rad; None: what the log says.
    """
    if log.obs_theta is None:
        return replace(graph, landmarks=landmarks, observations=observation_factors(log, labels, observation_std))
    none = np.zeros((0, 2)), ObservationFactors([], [], np.zeros((0, 2)), np.zeros((0, 2, 2)))
    bare = replace(graph, landmarks=none[0], observations=none[1], headings=NO_HEADINGS)
    placed = with_headings(log, bare, np.asarray(labels), landmarks, heading_std)
    return replace(placed, observations=observation_factors(log, labels, observation_std))


def odometry_factors(log: RobotLog, odometry_std=None) -> BetweenFactors:
    """The chain of odometry: one factor from every pose to the next; the noise is the log's unless it is given."""
    steps = np.arange(len(log.odometry))
    if odometry_std is None and log.odometry_cov is not None:
        information = np.linalg.inv(log.odometry_cov)
    else:
        std = log.odometry_std if odometry_std is None else odometry_std
        information = np.broadcast_to(_information("odometry_std", std, 3), (len(steps), 3, 3))
    return BetweenFactors(steps, steps + 1, log.odometry, information)


def observation_factors(log: RobotLog, labels: np.ndarray, observation_std=None) -> ObservationFactors:
    """One factor for every observation that belongs to an object; the noise is the log's unless it is given."""
    used = np.flatnonzero(labels >= 0)
    if observation_std is None and log.observation_cov is not None:
        information = np.linalg.inv(log.observation_cov[used])
    else:
        std = log.observation_std if observation_std is None else observation_std
        information = np.broadcast_to(_information("observation_std", std, 2), (len(used), 2, 2))
    return ObservationFactors(log.obs_time[used], labels[used], log.obs_xy[used], information)


def mean_landmarks(labels: np.ndarray, obs_xy_world: np.ndarray) -> np.ndarray:
    """The mean of each object's observations, (K, 2) m, W.

    Args:
        labels: (M,) index of the object, from 0 without gaps; -1 belongs to none.
        obs_xy_world: (M, 2) m, W.
    """
    used = labels >= 0
    counts = np.bincount(labels[used])
    sums = [np.bincount(labels[used], weights=obs_xy_world[used, axis]) for axis in (0, 1)]
    return np.column_stack(sums) / counts[:, None]


def _information(name: str, std, size: int) -> np.ndarray:
    """The information matrix (size, size) of independent errors."""
    std = checked_array(name, std, (size,))
    if not (std > 0).all():
        raise ValueError(f"{name}: expected positive numbers, got {std.tolist()}")
    if not (std >= SMALLEST_STD).all():
        raise ValueError(f"{name}: expected at least {SMALLEST_STD:g}, got {std.tolist()}")
    if not (std <= LARGEST_STD).all():
        raise ValueError(f"{name}: expected at most {LARGEST_STD:g}, got {std.tolist()}")
    return np.diag(1 / std**2)
