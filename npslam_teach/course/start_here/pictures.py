"""How a sighting is carried into the room: ahead and left are the robot's own axes, and turn with it."""

import numpy as np
from matplotlib.axes import Axes

from npslam_teach import se2
from npslam_teach.plotting.style import CLASS_COLORS, ESTIMATE_COLOR, TEXT_SIZE, label_map

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
    ax.set(xlim=(0, 5), ylim=(0, 4))
    return label_map(ax, "ahead and left are the robot's axes: they turn with it")
