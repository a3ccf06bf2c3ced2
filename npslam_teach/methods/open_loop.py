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

PAIRS = 100_000  # of observations that are compared at once


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
    most_alike, likeness = np.zeros(len(obs_class), dtype=int), np.zeros(len(obs_class))
    blocks = list(_blocks(obs_class))
    for which, begin, end in track(blocks, len(blocks), "open-loop", "blocks"):
        xy, own = obs_xy_world[which[: end - 1]], obs_xy_world[which[begin:end]]
        x, y = (xy[:, axis] - own[:, None, axis] for axis in (0, 1))
        is_earlier = np.arange(end - 1) < np.arange(begin, end)[:, None]
        weights = association_weights(is_earlier, np.sqrt(x * x + y * y), kernel_std)
        most_alike[which[begin:end]] = which[weights.argmax(axis=1)]
        likeness[which[begin:end]] = weights.max(axis=1)
    labels, num_objects = np.empty(len(obs_class), dtype=int), 0
    for k, joins in enumerate(likeness > threshold):
        labels[k] = labels[most_alike[k]] if joins else num_objects
        num_objects += not joins
    return labels


def _blocks(obs_class: np.ndarray) -> Iterator[tuple[np.ndarray, int, int]]:
    """Observations of one class, and a few of them to compare with all of these before: (which, begin, end)."""
    for each in np.unique(obs_class):
        which = np.flatnonzero(obs_class == each)
        rows = max(PAIRS // len(which), 1)
        for begin in range(1, len(which), rows):
            yield which, begin, min(begin + rows, len(which))
