"""Open loop: trust the odometry, and only associate (paper section V.A; deck figure 17).

An observation is compared with every earlier observation of its class, by ``exp(-d^2 / (2 s^2))``; it joins the object
of the best one if that exceeds the threshold. The trajectory is never corrected, so its drift splits the objects.
"""

from collections.abc import Iterator

import numpy as np

from npslam_teach import se2
from npslam_teach.association import PAPER_KERNEL_STD, association_weights, require_kernel
from npslam_teach.methods.oriented import without_headings
from npslam_teach.methods.snapshots import PAPER_OBSERVATION_STD, PAPER_ODOMETRY_STD, initial_snapshot, snapshot
from npslam_teach.pose_graph import mean_landmarks, with_associations
from npslam_teach.system.progress import track
from npslam_teach.types import RobotLog, Snapshot


def open_loop(
    log: RobotLog,
    threshold: float = 0.9,
    *,
    kernel_std: float = PAPER_KERNEL_STD,
    odometry_std=PAPER_ODOMETRY_STD,
    observation_std=PAPER_OBSERVATION_STD,
) -> Iterator[Snapshot]:
    """Associate along the dead-reckoned trajectory, in the order of the log.

    Args:
        log: what the robot measured.
        threshold: the likeness above which an earlier observation is accepted.
        kernel_std: s, m.
        odometry_std: (3,) m, m, rad: standard deviations that chi2 is measured with.
        observation_std: (2,) m.

    Yields:
        the frame-by-frame start, and the result.
    """
    require_kernel(threshold, kernel_std)
    log = without_headings(log)
    first = initial_snapshot(log, odometry_std, observation_std)
    yield first
    obs_xy_world = se2.apply(first.graph.poses[log.obs_time], log.obs_xy)
    labels = join_earlier_observations(obs_xy_world, log.obs_class, threshold, kernel_std)
    landmarks = mean_landmarks(labels, obs_xy_world)
    yield snapshot(log, 1, labels, with_associations(log, first.graph, labels, landmarks, observation_std))


def join_earlier_observations(
    obs_xy_world: np.ndarray, obs_class: np.ndarray, threshold: float, kernel_std: float
) -> np.ndarray:
    """The object of each observation: that of the most alike earlier one, or a new one; (M,)."""
    labels, num_objects = np.empty(len(obs_class), dtype=int), 0
    for k in track(range(len(obs_class)), len(obs_class), "open-loop", "observations"):
        distance = np.linalg.norm(obs_xy_world[:k] - obs_xy_world[k], axis=1)
        likeness = association_weights(obs_class[:k] == obs_class[k], distance, kernel_std)
        if likeness.max(initial=0.0) > threshold:
            labels[k] = labels[np.argmax(likeness)]
        else:
            labels[k] = num_objects
            num_objects += 1
    return labels
