"""Drift: robots on a map, the toy scene along the odometry path, clouds of runs and their predicted ellipses."""

import numpy as np
from matplotlib.axes import Axes

from npslam_teach import se2
from npslam_teach.plotting.maps import plot_objects, plot_observation_rays, plot_robots, plot_trajectory
from npslam_teach.plotting.style import (
    CLASS_COLORS,
    ESTIMATE_COLOR,
    TEXT_SIZE,
    TRUTH_COLOR,
    label_axes,
    label_map,
    legend_beside,
    path_handles,
)
from npslam_teach.plotting.uncertainty import ellipse_points
from npslam_teach.types import GroundTruth, RobotLog

CLOUD_COLOR, ELLIPSE_COLOR = CLASS_COLORS[5], CLASS_COLORS[1]


def plot_two_orders(ax: Axes, steps: np.ndarray, names: tuple) -> Axes:
    """Two steps chained in either order from the origin: the same steps, two different ends.

    Args:
        ax: a map.
        steps: (2, 3) m, m, rad, each in the frame of the pose before it.
        names: of the two orders, for the legend.
    """
    for k, order in enumerate((steps, steps[::-1])):
        path = se2.dead_reckoning(np.asarray(order))
        dashes, color = ("-", ":")[k], CLASS_COLORS[k]
        ax.plot(path[:, 0], path[:, 1], dashes, color=color, linewidth=2.5, label=names[k])
        x, y, heading = path[-1]
        ax.plot([x], [y], marker=(3, 0, np.rad2deg(heading) - 90), markersize=16, color=color)
    plot_robots(ax, np.zeros((1, 3)))
    ax.margins(0.15)
    legend_beside(ax)
    return label_map(ax, "the same two steps in another order: another place")


def plot_frame_by_frame(ax: Axes, log: RobotLog, poses: np.ndarray, truth: GroundTruth, title: str) -> Axes:
    """Every observation an object of its own, ``Obj_1`` and so on, along a given path (deck figure 5).

    Args:
        ax: a map.
        log: few observations: each gets its name.
        poses: (T, 3) m, m, rad, W: the path along which the observations are carried into W.
        truth: the true path dashed, the true objects as grey rings.
        title: of the map.
    """
    world = truth.world
    plot_trajectory(ax, truth.poses, truth=True)
    plot_objects(ax, world.object_xy, world.object_class, world.class_names, truth=True)
    plot_trajectory(ax, poses)
    plot_robots(ax, poses)
    plot_observation_rays(ax, poses, log)
    seen_at = se2.apply(poses[log.obs_time], log.obs_xy)
    plot_objects(ax, seen_at, log.obs_class, world.class_names)
    for k, xy in enumerate(seen_at):
        place = {"xytext": (11, 0), "textcoords": "offset points", "va": "center", "fontsize": TEXT_SIZE["tick"]}
        # On white, so that the rays behind it are not mistaken for strokes of letters.
        ax.annotate(f"Obj_{k + 1}", xy, zorder=4, bbox={"facecolor": "white", "linewidth": 0, "pad": 0.6}, **place)
    ax.margins(0.06, 0.1)
    return label_map(ax, title)


def plot_one_wrong_turn(ax: Axes, steps: np.ndarray, wrong: int, error: float) -> Axes:
    """A path whose heading is wrong in one step, over the true one: everything after that step is turned.

    Args:
        ax: a map.
        steps: (N, 3) m, m, rad, the true steps.
        wrong: index of the step whose turn is reported wrongly.
        error: rad, by how much.
    """
    reported = np.array(steps, float)
    reported[wrong, 2] += error
    true_path, path = se2.dead_reckoning(np.asarray(steps, float)), se2.dead_reckoning(reported)
    plot_trajectory(ax, true_path, truth=True)
    plot_trajectory(ax, path)
    text = {"textcoords": "offset points", "fontsize": TEXT_SIZE["label"]}
    note = f"here one turn is reported\n{np.rad2deg(error):.0f} degrees too large"
    ax.plot(*path[wrong + 1, :2], marker="o", markersize=11, color=CLASS_COLORS[1], zorder=4)
    ax.annotate(note, path[wrong + 1, :2], xytext=(-8, 24), ha="right", color=CLASS_COLORS[1], **text)
    ax.plot(*path[-1, :2], marker="X", markersize=11, color=ESTIMATE_COLOR, zorder=4)
    ax.plot(*true_path[-1, :2], marker="X", markersize=11, color=TRUTH_COLOR, zorder=4)
    off = np.linalg.norm(path[-1, :2] - true_path[-1, :2])
    ax.annotate(f"the end is {off:.1f} m off", path[-1, :2], xytext=(0, -22), ha="center", **text)
    ax.margins(0.12)
    legend_beside(ax, path_handles(("true path", "estimated path")))
    return label_map(ax, "one wrong heading turns all that comes after it")


def plot_path_ellipses(ax: Axes, path: np.ndarray, covs: np.ndarray) -> Axes:
    """A path, and at every pose the ellipse that holds its true place with a probability of 95 %.

    Args:
        ax: a map.
        path: (T, 3) m, m, rad, W.
        covs: (T, 2, 2) m^2.
    """
    plot_trajectory(ax, path)
    plot_robots(ax, path)
    for k, (pose, cov) in enumerate(zip(path, covs, strict=True)):
        if np.any(cov > 0):
            label = "95 % ellipse" if k == len(path) - 1 else None
            ax.plot(*ellipse_points(pose[:2], cov).T, color=ELLIPSE_COLOR, linewidth=2.0, zorder=2.5, label=label)
    legend_beside(ax)
    return label_map(ax, "with every step the robot is less sure of its place")


def plot_cloud(ax: Axes, ends_xy: np.ndarray, mean: np.ndarray, cov: np.ndarray) -> Axes:
    """Where many runs ended, and the ellipse that should hold 95 % of them by first-order propagation.

    Args:
        ax: a map; several clouds share one legend.
        ends_xy: (N, 2) m, W.
        mean: (2,) m, where the robot without noise ends.
        cov: (2, 2) m^2.
    """
    first = not ax.lines
    dots = {"linestyle": "none", "marker": ".", "markersize": 5, "color": CLOUD_COLOR, "alpha": 0.6}
    ax.plot(*ends_xy.T, label="ends of runs" if first else None, **dots)
    line = {"color": ELLIPSE_COLOR, "linewidth": 2.2, "zorder": 3}
    ax.plot(*ellipse_points(mean, cov).T, label="95 % ellipse" if first else None, **line)
    legend_beside(ax)
    return label_map(ax, "beyond 10 m the cloud bends; the ellipse cannot")


def plot_growth(ax: Axes, predicted: np.ndarray, errors: np.ndarray) -> Axes:
    """The expected error of the position along the path, and the errors of several runs.

    Args:
        ax: any axes.
        predicted: (T,) m, the root of the expected squared distance.
        errors: (runs, T) m.
    """
    for k, error in enumerate(errors):
        label = f"{len(errors)} runs" if k == 0 else None
        ax.plot(error, color=CLOUD_COLOR, linewidth=0.9, alpha=0.7, label=label)
    squares = np.sqrt(np.mean(np.square(errors), axis=0))
    ax.plot(squares, color=ESTIMATE_COLOR, linewidth=2.2, linestyle="-.", label="root mean square of the runs")
    ax.plot(predicted, color=ELLIPSE_COLOR, linewidth=2.6, label="predicted by F P F$^T$ + G Q G$^T$")
    legend_beside(ax)
    return label_axes(
        ax, "pose t (index)", "distance from the truth (m)", "the error rises in waves: on the way back it shrinks"
    )


def plot_one_step(ax: Axes, poses: np.ndarray, covs: np.ndarray, step_std: np.ndarray) -> Axes:
    """The two parts of the ellipse after a step: the one before it, carried along, and the step's own.

    Args:
        ax: a map.
        poses: (2, 3) m, m, rad, before the step and after it.
        covs: (2, 3, 3) of these poses.
        step_std: (3,) m, m, rad, standard deviations of the step.
    """
    axes = se2.rotate(poses[0, 2], np.diag(step_std[:2]))
    own = axes.T @ axes
    (before, after), end = covs[:, :2, :2], poses[1, :2]
    parts = {
        "before the step: P": (poses[0, :2], before, {"color": TRUTH_COLOR, "linestyle": ":"}),
        "carried along: F P F$^T$": (end, after - own, {"color": CLASS_COLORS[0], "linestyle": "--"}),
        "the step's own: G Q G$^T$": (end, own, {"color": CLASS_COLORS[2], "linestyle": "-."}),
        "after it: their sum": (end, after, {"color": ELLIPSE_COLOR, "linestyle": "-"}),
    }
    ax.plot(*poses[:, :2].T, color=ESTIMATE_COLOR, linewidth=1.4, marker="o", markersize=5)
    for name, (middle, cov, style) in parts.items():
        ax.plot(*ellipse_points(middle, cov).T, linewidth=2.0, label=name, **style)
    legend_beside(ax)
    return label_map(ax, "the old ellipse carried along, and the step's own")
