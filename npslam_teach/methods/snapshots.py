"""What every method needs: the common start, and the keeping of a snapshot."""

import numpy as np

from npslam_teach import se2
from npslam_teach.association import count_votes, objective
from npslam_teach.pose_graph import chi2, observation_factors, odometry_factors, with_headings
from npslam_teach.types import PoseGraph, RobotLog, Snapshot

PAPER_ODOMETRY_STD = (0.1, 0.1, 0.1)  # m, m, rad: what the authors' solver assumes per step
PAPER_OBSERVATION_STD = (0.5, 0.5)  # m: and per observation; the sensor itself is better than both


def initial_snapshot(
    log: RobotLog,
    odometry_std=None,
    observation_std=None,
    alpha: float | None = None,
    area: float = 1.0,
    heading_std: float | None = None,
) -> Snapshot:
    """Snapshot 0: dead reckoning from the origin, and every observation an object where it was seen.

    Args: as in ``snapshot``; the standard deviations, (3,), (2,) and of headings, are what chi2 is measured with; None:
        the log's.
    """
    poses, labels = se2.dead_reckoning(log.odometry), np.arange(log.num_observations)
    graph = PoseGraph(
        poses=poses,
        landmarks=se2.apply(poses[log.obs_time], log.obs_xy),
        between=odometry_factors(log, odometry_std),
        observations=observation_factors(log, labels, observation_std),
    )
    return snapshot(log, 0, labels, with_headings(log, graph, labels, graph.landmarks, heading_std), alpha, area)


def snapshot(
    log: RobotLog, iteration: int, labels, graph: PoseGraph, alpha: float | None = None, area: float = 1.0
) -> Snapshot:
    """Count the votes, measure chi2 and the objective, and keep it all together.

    Args:
        log: what the robot measured.
        iteration: of the method.
        labels: (M,) index of the object of each observation; -1 = used by no object.
        graph: with that many objects.
        alpha: concentration of the Dirichlet process; None for methods that have none, and so no objective.
        area: m^2, for the objective.
    """
    labels = np.asarray(labels, dtype=int)
    votes = count_votes(labels, log.obs_class, len(graph.landmarks), log.num_classes)
    misfit = chi2(graph)
    lowered = None if alpha is None else objective(misfit, votes, alpha, area)
    return Snapshot(iteration, labels, votes, graph, misfit, lowered)
