"""Maps: the robot's path and the objects around it, true and estimated.

The truth is dashed, hollow and grey; an estimate is solid, in the colour and with the marker of its class. An estimate
lives in the frame of its own first pose, so where the truth is given it is laid over it first (``se2.align``), by the
same rule as in ``evaluate``.
"""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Wedge

from npslam_teach import se2
from npslam_teach.evaluation import align_to_truth
from npslam_teach.plotting.style import (
    ESTIMATE_COLOR,
    ESTIMATE_LINE,
    START,
    TRUTH_COLOR,
    TRUTH_LINE,
    TRUTH_OBJECT,
    class_handles,
    class_style,
    label_map,
    legend_beside,
    path_handles,
)
from npslam_teach.types import GroundTruth, RobotLog, Snapshot


def plot_trajectory(ax: Axes, poses: np.ndarray, truth: bool = False, label: str | None = None) -> Axes:
    """Draw a path: solid, or dashed grey when it is the true one.

    Args:
        ax: a map.
        poses: (T, 3) or (T, 2) m, W.
        truth: whether this is what really happened.
        label: for the legend.
    """
    ax.plot(*np.asarray(poses)[:, :2].T, label=label, **(TRUTH_LINE if truth else ESTIMATE_LINE))
    return label_map(ax)


def plot_objects(
    ax: Axes,
    xy: np.ndarray,
    object_class: np.ndarray,
    class_names,
    truth: bool = False,
    sizes=None,
    alpha=0.9,
) -> Axes:
    """Draw objects with the marker of their class: filled with its colour, or hollow and grey when they are the truth.

    Args:
        ax: a map.
        xy: (K, 2) m, W.
        object_class: (K,) class indices.
        class_names: a name for every class index.
        truth: whether these are the real objects, drawn larger so that they ring the estimates.
        sizes: (K,) pt^2, the area of each marker; or one number for all.
        alpha: (K,) opacity of each marker, 0 to 1; or one number for all.
    """
    xy, object_class = np.reshape(xy, (-1, 2)), np.asarray(object_class, dtype=int)
    sizes = np.broadcast_to((200.0 if truth else 75.0) if sizes is None else sizes, object_class.shape)
    alpha = np.broadcast_to(alpha, object_class.shape)
    for c in np.unique(object_class):
        color, marker = class_style(c)
        of_class = object_class == c
        # Thinner edges on fainter markers: a thousand of them must not become one dark spot.
        opacity = alpha[of_class]
        filled = {"c": color, "edgecolors": ESTIMATE_COLOR, "linewidths": 0.7 * opacity, "alpha": opacity}
        ax.scatter(
            *xy[of_class].T,
            s=sizes[of_class],
            marker=marker,
            label=None if truth else class_names[c],
            **({"zorder": 1.6} | TRUTH_OBJECT if truth else {"zorder": 2.5} | filled),
        )
    return label_map(ax)


def plot_view(ax: Axes, pose: np.ndarray, max_range: float, field_of_view: float) -> Axes:
    """Draw the sector that the sensor sees from one pose.

    Args:
        ax: a map.
        pose: (3,) m, m, rad, W.
        max_range: m.
        field_of_view: rad, full opening angle.
    """
    x, y, heading = pose
    half = min(np.rad2deg(field_of_view) / 2, 180.0)
    middle = np.rad2deg(heading)
    style = {"facecolor": TRUTH_COLOR, "alpha": 0.18, "linewidth": 0, "zorder": 1.2}
    ax.add_patch(Wedge((x, y), max_range, middle - half, middle + half, **style))
    ax.plot([x], [y], marker=(3, 0, middle - 90), markersize=12, color=ESTIMATE_COLOR, zorder=3)
    ax.autoscale_view()
    return label_map(ax)


def plot_truth(ax: Axes, truth: GroundTruth) -> Axes:
    """What really is there: the path with its direction, and the objects by class (deck figure 14)."""
    world = truth.world
    plot_trajectory(ax, truth.poses, truth=True)
    _mark_direction(ax, truth.poses)
    plot_objects(ax, world.object_xy, world.object_class, world.class_names)
    classes = np.unique(world.object_class)
    legend_beside(ax, class_handles(classes, world.class_names) + path_handles(("true path", "start")))
    return label_map(ax, f"truth: {len(world.object_xy)} objects, {len(classes)} classes")


def _mark_direction(ax: Axes, poses: np.ndarray, num_arrows: int = 7) -> None:
    """Put a dot at the first pose, and arrow heads along the path.

    They follow the path, not the heading: in the paper's data the robot does not look where it goes.
    """
    ax.plot(*poses[:1, :2].T, **START)
    # Not at the ends or in the middle of equal parts: a regular path crosses itself there.
    at = ((np.arange(num_arrows) + 0.3) / num_arrows * (len(poses) - 1)).astype(int)
    ahead = np.minimum(at + max(len(poses) // 100, 1), len(poses) - 1)
    for here, there in zip(poses[at, :2], poses[ahead, :2], strict=True):
        arrow = {"arrowstyle": "-|>", "color": ESTIMATE_COLOR, "mutation_scale": 16, "shrinkA": 0, "shrinkB": 0}
        if (here != there).any():
            ax.annotate("", there, here, arrowprops=arrow)


def plot_snapshot(
    ax: Axes,
    snapshot: Snapshot,
    log: RobotLog,
    truth: GroundTruth | None = None,
    class_names=None,
    legend: bool = True,
) -> Axes:
    """One iteration of a method: its path, and its objects by class (deck figures 15 and 16).

    A marker grows with the number of observations of its object; objects seen once are small and translucent.

    Args:
        ax: a map.
        snapshot: the estimate.
        log: what it was made from.
        truth: drawn behind when given, and the estimate is laid over it.
        class_names: (C,); those of the truth when None.
        legend: whether to put one beside the map.
    """
    class_names = names_of_classes(log, truth, class_names)
    poses, landmarks = laid_over_truth(snapshot, truth)
    if truth is not None:
        plot_trajectory(ax, truth.poses, truth=True)
        plot_objects(ax, truth.world.object_xy, truth.world.object_class, class_names, truth=True)
    plot_trajectory(ax, poses)
    counts = snapshot.votes[:, 1:].sum(axis=1)
    alpha = np.where(counts > 1, 0.9, 0.55)
    plot_objects(ax, landmarks, classes_of(snapshot), class_names, sizes=12 * np.sqrt(counts), alpha=alpha)
    if legend:
        legend_beside(ax, map_handles([snapshot], truth, class_names))
    return label_map(ax, f"{name_of(snapshot)}: {how_many(snapshot)}")


def classes_of(snapshot: Snapshot) -> np.ndarray:
    """The class with the most votes of each object, (K,)."""
    return snapshot.votes[:, 1:].argmax(axis=1)


def laid_over_truth(snapshot: Snapshot, truth: GroundTruth | None) -> tuple[np.ndarray, np.ndarray]:
    """Poses (T, 3) and objects (K, 2), moved rigidly to fit the true path best; as they are without a truth."""
    poses, landmarks = snapshot.graph.poses, snapshot.graph.landmark_xy
    motion = None if truth is None else align_to_truth(poses, truth)
    if motion is None:
        return poses, landmarks
    return se2.compose(motion, poses), se2.apply(motion, landmarks)


def names_of_classes(log: RobotLog, truth: GroundTruth | None, class_names) -> tuple:
    """The names given, else those of the truth or the log, else "class 0", "class 1", ..."""
    if class_names is None:
        names = log.class_names or [f"class {c}" for c in range(log.num_classes)]
        class_names = names if truth is None else truth.world.class_names
    if len(class_names) < log.num_classes:
        raise ValueError(f"class_names: expected a name for each of {log.num_classes} classes, got {len(class_names)}")
    return tuple(class_names)


def map_handles(snapshots: list, truth: GroundTruth | None, class_names) -> list:
    """The legend of these maps: every class that occurs, the paths, and the true objects if drawn."""
    seen = [classes_of(snapshot) for snapshot in snapshots] + ([truth.world.object_class] if truth else [])
    lines = ("estimated path",) + (("true path", "true object") if truth else ())
    return class_handles(np.unique(np.concatenate(seen)), class_names) + path_handles(lines)


def name_of(snapshot: Snapshot) -> str:
    """What an iteration is called in a title."""
    return "frame by frame" if snapshot.iteration == 0 else f"iteration {snapshot.iteration}"


def how_many(snapshot: Snapshot) -> str:
    """The number of objects, in words of a title."""
    return f"{snapshot.num_objects} object" + ("" if snapshot.num_objects == 1 else "s")


def plot_robots(ax: Axes, poses: np.ndarray, truth: bool = False) -> Axes:
    """Draw an arrowhead at every pose that points where the robot looks; hollow and grey when it is the truth.

    Args:
        ax: a map.
        poses: (N, 3) m, m, rad, W.
        truth: whether this is what really happened.
    """
    color = TRUTH_COLOR if truth else ESTIMATE_COLOR
    for x, y, heading in np.reshape(poses, (-1, 3)):
        marker = (3, 0, np.rad2deg(heading) - 90)
        fill = "white" if truth else color
        ax.plot([x], [y], marker=marker, markersize=13, linestyle="none", color=color, mfc=fill, zorder=3)
    return label_map(ax)


def plot_observation_rays(ax: Axes, poses: np.ndarray, log: RobotLog) -> Axes:
    """A thin line from each pose to everything that was seen from it.

    Args:
        ax: a map.
        poses: (T, 3) m, m, rad, W.
        log: the observations.
    """
    seen_from = poses[log.obs_time, :2]
    seen_at = se2.apply(poses[log.obs_time], log.obs_xy)
    for start, end in zip(seen_from, seen_at, strict=True):
        ax.plot(*np.stack([start, end]).T, color=TRUTH_COLOR, linewidth=0.7, linestyle=":", zorder=1.3)
    return label_map(ax)
