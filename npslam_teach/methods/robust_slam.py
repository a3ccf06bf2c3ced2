"""Robust SLAM: one object of each class, and only observations that agree with it (paper section V.A; deck figure 17).

The first observation of a class founds its object. A later one joins if it is like one that has joined before, by
``exp(-d^2 / (2 s^2))`` above the threshold; all others are left out. Then the pose graph is solved, once. A second
chair breaks the assumption: either it is ignored, or it is dragged onto the first.
"""

from collections.abc import Iterator

import numpy as np

from npslam_teach import se2
from npslam_teach.association import (
    PAPER_KERNEL_STD,
    association_weights,
    require_kernel,
    without_empty_objects,
)
from npslam_teach.methods.oriented import without_headings
from npslam_teach.methods.snapshots import PAPER_OBSERVATION_STD, PAPER_ODOMETRY_STD, initial_snapshot, snapshot
from npslam_teach.pose_graph import mean_landmarks, optimize, with_associations
from npslam_teach.system.progress import track
from npslam_teach.types import RobotLog, Snapshot


def robust_slam(
    log: RobotLog,
    threshold: float = 0.9,
    *,
    kernel_std: float = PAPER_KERNEL_STD,
    odometry_std=PAPER_ODOMETRY_STD,
    observation_std=PAPER_OBSERVATION_STD,
) -> Iterator[Snapshot]:
    """Associate along the dead-reckoned trajectory with one object per class, then solve.

    Args:
        log: what the robot measured.
        threshold: the likeness above which an observation is used.
        kernel_std: s, m.
        odometry_std: (3,) m, m, rad: what the solver assumes per step.
        observation_std: (2,) m: what the solver assumes per observation.

    Yields:
        the frame-by-frame start, and the result; observations that were left out have label -1.
    """
    require_kernel(threshold, kernel_std)
    log = without_headings(log)
    first = initial_snapshot(log, odometry_std, observation_std)
    yield first
    obs_xy_world = se2.apply(first.graph.poses[log.obs_time], log.obs_xy)
    joined = join_first_of_class(obs_xy_world, log.obs_class, threshold, kernel_std)
    # Classes that were never seen leave gaps in the numbering.
    labels = without_empty_objects(np.where(joined, log.obs_class, -1), np.zeros((log.num_classes, 2))).labels
    landmarks = mean_landmarks(labels, obs_xy_world)
    graph = optimize(with_associations(log, first.graph, labels, landmarks, observation_std))
    yield snapshot(log, 1, labels, graph)


def join_first_of_class(
    obs_xy_world: np.ndarray, obs_class: np.ndarray, threshold: float, kernel_std: float
) -> np.ndarray:
    """Which observations are used: the first of each class, and those like one used before; (M,) bool."""
    joined = np.zeros(len(obs_class), dtype=bool)
    joined[np.unique(obs_class, return_index=True)[1]] = True
    others = np.flatnonzero(~joined)
    for k in track(others, len(others), "robust-slam", "observations"):
        comparable = joined & (obs_class == obs_class[k])
        distance = np.linalg.norm(obs_xy_world[comparable] - obs_xy_world[k], axis=1)
        joined[k] = association_weights(1.0, distance, kernel_std).max() > threshold
    return joined
