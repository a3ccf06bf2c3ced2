"""What every method needs: the common start, the factors of a log, and the keeping of a snapshot."""

from dataclasses import replace

import numpy as np

from npslam_teach import se2
from npslam_teach.associate import PAPER_ALPHA, Association, objective
from npslam_teach.data import BetweenFactors, ObservationFactors, PoseGraph, RobotLog, Snapshot
from npslam_teach.dirichlet import count_votes
from npslam_teach.pose_graph import chi2
from npslam_teach.validation import checked_array

PAPER_ODOMETRY_STD = (0.1, 0.1, 0.1)  # m, m, rad: what the authors' solver assumes per step
PAPER_OBSERVATION_STD = (0.5, 0.5)  # m: and per observation; the sensor itself is better than both
SMALLEST_STD = 1e-7  # m or rad; the information of a smaller one, 1 / std^2, is beyond `validation.LARGEST`


def start(log: RobotLog, odometry_std, observation_std, alpha: float = PAPER_ALPHA, area: float = 1.0) -> Snapshot:
    """Snapshot 0: dead reckoning from the origin, and every observation an object where it was seen."""
    poses = se2.dead_reckoning(log.odometry)
    graph = PoseGraph(
        poses=poses,
        landmarks=se2.transform_to(poses[log.obs_time], log.obs_xy),
        between=odometry_factors(log, odometry_std),
        observations=observation_factors(log, np.arange(log.num_observations), observation_std),
    )
    return snapshot(log, 0, np.arange(log.num_observations), graph, alpha, area)


def snapshot(
    log: RobotLog, iteration: int, labels: np.ndarray, graph: PoseGraph, alpha: float, area: float = 1.0
) -> Snapshot:
    """Count the votes, measure chi2 and the objective, and keep it all together."""
    votes = count_votes(labels, log.obs_class, len(graph.landmarks), log.num_classes)
    value = chi2(graph)
    return Snapshot(iteration, labels, votes, graph, value, objective(value, votes, alpha, area))


def odometry_factors(log: RobotLog, odometry_std) -> BetweenFactors:
    """The chain of odometry: one factor from every pose to the next."""
    steps = np.arange(len(log.odometry))
    information = np.broadcast_to(_information("odometry_std", odometry_std, 3), (len(steps), 3, 3))
    return BetweenFactors(steps, steps + 1, log.odometry, information)


def observation_factors(log: RobotLog, labels: np.ndarray, observation_std) -> ObservationFactors:
    """One factor for every observation that belongs to an object."""
    used = np.flatnonzero(labels >= 0)
    information = np.broadcast_to(_information("observation_std", observation_std, 2), (len(used), 2, 2))
    return ObservationFactors(log.obs_time[used], labels[used], log.obs_xy[used], information)


def _information(name: str, std, size: int) -> np.ndarray:
    """The information matrix (size, size) of independent errors."""
    std = checked_array(name, std, (size,))
    if not (std > 0).all():
        raise ValueError(f"{name}: expected positive numbers, got {std.tolist()}")
    if not (std >= SMALLEST_STD).all():
        raise ValueError(f"{name}: expected at least {SMALLEST_STD:g}, got {std.tolist()}")
    return np.diag(1 / std**2)


def reassociated(log: RobotLog, graph: PoseGraph, association: Association, observation_std) -> PoseGraph:
    """The same trajectory, and every observation tied to the object it is now thought to be of."""
    factors = observation_factors(log, association.labels, observation_std)
    return replace(graph, landmarks=association.landmarks, observations=factors)


def mean_landmarks(labels: np.ndarray, obs_xy_world: np.ndarray) -> np.ndarray:
    """The mean of each object's observations, (K, 2) m, W."""
    used = labels >= 0
    counts = np.bincount(labels[used])
    sums = [np.bincount(labels[used], weights=obs_xy_world[used, axis]) for axis in (0, 1)]
    return np.column_stack(sums) / counts[:, None]
