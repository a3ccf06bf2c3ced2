"""A map whose path and objects can be moved from one snapshot to another."""

from collections.abc import Callable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from npslam_teach.plotting.maps import laid_over_truth, plot_objects, plot_trajectory
from npslam_teach.plotting.style import (
    ESTIMATE_COLOR,
    ESTIMATE_LINE,
    class_handles,
    class_style,
    label_map,
    path_handles,
)
from npslam_teach.types import GroundTruth, RobotLog, Snapshot


def plot_moving_map(ax: Axes, snapshots: list[Snapshot], log: RobotLog, truth: GroundTruth) -> Callable:
    """Map for an explorer: the truth, and a path and objects that can be moved to any snapshot.

    Args:
        ax: a map.
        snapshots: those that the window has to hold.
        log: what they were made from.
        truth: drawn behind, and what each snapshot is laid over.

    Returns:
        a function (snapshot, title) that moves the artists.
    """
    world = truth.world
    plot_trajectory(ax, truth.poses, truth=True)
    plot_objects(ax, world.object_xy, world.object_class, world.class_names, truth=True)
    (path,) = ax.plot([], [], **ESTIMATE_LINE)
    looks = [class_style(c) for c in range(log.num_classes)]
    edges = {"edgecolors": ESTIMATE_COLOR, "linewidths": 0.6, "zorder": 2.5}
    objects = [ax.scatter([], [], c=color, marker=marker, **edges) for color, marker in looks]
    points = [xy[:, :2] for snapshot in snapshots for xy in laid_over_truth(snapshot, truth)]
    points = np.concatenate([*points, truth.poses[:, :2], world.object_xy])
    low, high = points.min(axis=0) - 0.4, points.max(axis=0) + 0.4
    label_map(ax, "").set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))

    def move(snapshot: Snapshot, title: str) -> None:
        poses, landmarks = laid_over_truth(snapshot, truth)
        path.set_data(*poses[:, :2].T)
        counts, classes = snapshot.votes[:, 1:].sum(axis=1), snapshot.votes[:, 1:].argmax(axis=1)
        for c, artist in enumerate(objects):
            artist.set_offsets(landmarks[classes == c])
            artist.set_sizes(12 * np.sqrt(counts[classes == c]))
        ax.set_title(title)

    return move


def moving_map_handles(truth: GroundTruth) -> list[Line2D]:
    """The legend of ``plot_moving_map``."""
    classes = np.unique(truth.world.object_class)
    paths = path_handles(("estimated path", "true path", "true object"))
    return class_handles(classes, truth.world.class_names) + paths
