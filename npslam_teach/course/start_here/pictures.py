"""What the robot is given, and how a sighting is carried into the room: the axes "ahead" and "left" turn with it."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from npslam_teach import se2
from npslam_teach.course.small_pictures import bars_figure, dots_figure
from npslam_teach.plotting.style import (
    CLASS_COLORS,
    ESTIMATE_COLOR,
    TEXT_SIZE,
    class_handles,
    class_style,
    label_axes,
    label_map,
    legend_beside,
    new_figure,
)
from npslam_teach.types import RobotLog

WIDE = {"textcoords": "offset points", "fontsize": TEXT_SIZE["label"], "ha": "center", "va": "center"}


def plot_carried(ax: Axes, pose: np.ndarray, sighting: np.ndarray) -> Axes:
    """A robot, what it sees, and the way there along its own two axes.

    Args:
        ax: a map.
        pose: (3,) m, m, rad, W.
        sighting: (2,) m, ahead and to the left of the robot.
    """
    corners = se2.apply(np.asarray(pose, float), np.array([[0.0, 0.0], [sighting[0], 0.0], sighting]))
    names = (f"{sighting[0]:g} m ahead", f"{sighting[1]:g} m to the left")
    sides = ((34, -14), (66, 8))  # points: clear of the arrows
    for k, (name, side) in enumerate(zip(names, sides, strict=True)):
        arrow = {"arrowstyle": "-|>", "color": CLASS_COLORS[k], "linewidth": 2.4, "shrinkA": 0, "shrinkB": 0}
        ax.annotate("", corners[k + 1], corners[k], arrowprops=arrow)
        ax.annotate(name, corners[k : k + 2].mean(axis=0), side, color=CLASS_COLORS[k], **WIDE)
    ax.plot(*corners[[0, 2]].T, color="0.5", linestyle=":", linewidth=1.6)
    # A disc: the heading of an equilateral arrowhead cannot be read at this angle, and the first arrow shows it.
    ax.plot(*corners[0], marker="o", markersize=15, color=ESTIMATE_COLOR, markerfacecolor="white", zorder=3)
    ax.plot(*corners[2], marker="o", markersize=11, color=ESTIMATE_COLOR)
    ax.annotate("the sighting", corners[2], (0, 18), **WIDE)
    ax.annotate(f"robot at ({pose[0]:g}, {pose[1]:g})", corners[0], (0, -20), **WIDE)
    low, high = np.minimum(corners.min(axis=0) - 0.6, 0), np.maximum(corners.max(axis=0) + 0.6, (5, 4))
    ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
    return label_map(ax, "ahead and left are the robot's axes: they turn with it")


def first_sightings_figure(log: RobotLog, class_names, count: int) -> Figure:
    """The first sightings as the robot has them: what, how far ahead, and how far to the left.

    Args:
        log: what the robot measured.
        class_names: a name for every class index.
        count: how many sightings.
    """
    figure, ax = new_figure(size=(8.0, 4.4))
    seen = np.unique(log.obs_class[:count])
    for c in seen:
        color, marker = class_style(c)
        own = log.obs_xy[:count][log.obs_class[:count] == c]
        ax.plot(own[:, 1], own[:, 0], marker, linestyle="none", color=color, markersize=6, alpha=0.8)
    ax.plot(0, 0, marker="^", markersize=15, color=ESTIMATE_COLOR, markerfacecolor="white")
    ax.annotate("the robot, looking up", (0, 0), (14, 0), textcoords="offset points", va="center")
    ax.invert_xaxis()  # left is to the left
    ax.set_aspect("equal", adjustable="datalim")
    legend_beside(ax, class_handles(seen, class_names))
    title = f"the first {count} sightings: a class and a place, no name"
    return label_axes(ax, "to the left (m)", "ahead (m)", title).figure


def rooms_figure(counts: list[int]) -> Figure:
    """The number of objects found in each of many rooms, a dot for each."""
    labels, line = ("a dot for each room", "objects found (number)"), (15, "true number: 15")
    return dots_figure({f"{len(counts)} rooms": counts}, labels, "never too few, sometimes too many", line)


def cliff_figure(found: dict[str, int]) -> Figure:
    """The number of objects found, by alpha."""
    return bars_figure(found, ("alpha (no unit)", "objects found (number)"), "at 1.0 nothing joins any more")
