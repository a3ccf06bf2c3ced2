"""Two ideas of lesson 03 before their formulas: a turn has a lever, and no measurement says where the map lies."""

import numpy as np
from matplotlib.figure import Figure

from npslam_teach import se2
from npslam_teach.plotting.style import CLASS_COLORS, ESTIMATE_COLOR, TRUTH_COLOR, label_axes, label_map, new_figure


def lever_figure(distances=(1.0, 2.0, 3.0), turn: float = np.deg2rad(12)) -> Figure:
    """What was straight ahead before the robot turned left, as it sees it afterwards.

    Args:
        distances: m ahead.
        turn: rad, to the left.
    """
    figure, ax = new_figure(size=(6.0, 4.4))
    for distance in distances:
        ahead, left = se2.rotate(-turn, np.array([distance, 0.0]))
        ax.plot(0, distance, "o", markersize=11, markerfacecolor="none", color=TRUTH_COLOR)
        arrow = {"arrowstyle": "-|>", "color": CLASS_COLORS[1], "linewidth": 2.2, "shrinkA": 6, "shrinkB": 6}
        ax.annotate("", (left, ahead), (0, distance), arrowprops=arrow)
        ax.plot(left, ahead, "o", markersize=11, color=CLASS_COLORS[0], markeredgecolor=ESTIMATE_COLOR)
        words = f"{abs(left):.2f} m to the right"
        ax.annotate(words, (left, ahead), (12, 0), textcoords="offset points", va="center")
    ax.plot(0, 0, "^", markersize=16, color=ESTIMATE_COLOR, markerfacecolor="white")
    ax.set(xlim=(1.0, -2.4), ylim=(-0.4, max(distances) + 0.5), aspect="equal")
    title = f"a turn of {np.rad2deg(turn):.0f} degrees to the left:\nthe further away, the further to the right"
    return label_axes(ax, "to the left (m)", "ahead (m)", title).figure


def gauge_figure(poses: np.ndarray, chair: np.ndarray, moves: dict[str, np.ndarray], size: float = 0.4) -> Figure:
    """The map, and the map moved in directions that cost nothing.

    Args:
        poses: (T, 3) m, m, rad.
        chair: (2,) m.
        moves: by name, the change (3 T + 2,) of all unknowns per unit.
        size: how many units.
    """
    figure, axes = new_figure(1, len(moves), (4.0 * len(moves), 4.2), sharex=True, sharey=True)
    for ax, (name, move) in zip(axes, moves.items(), strict=True):
        moved = poses + size * move[:-2].reshape(-1, 3), chair + size * move[-2:]
        for (path, place), color, style in ((((poses, chair)), TRUTH_COLOR, "--"), (moved, CLASS_COLORS[0], "-")):
            for pose in path:
                ax.plot(*np.array([pose[:2], place]).T, color=color, linewidth=0.8, linestyle=":")
            ax.plot(*path[:, :2].T, style, color=color, marker="o", markersize=6, linewidth=1.8)
            ax.plot(*place, "s", color=color, markersize=11)
        label_map(ax, name)
    figure.suptitle("the whole map moves, and every measurement stays as it is", fontsize=13)
    return figure
