"""Maps of lesson 14: a hall as it is and as a method believes it is, with noses that show where things face."""

import numpy as np
from matplotlib.axes import Axes

from npslam_teach.plotting import plot_objects, plot_trajectory
from npslam_teach.plotting.maps import laid_over_truth
from npslam_teach.plotting.style import ESTIMATE_COLOR, TRUTH_COLOR, class_handles, label_map, path_handles
from npslam_teach.types import GroundTruth, Snapshot

NOSE = 0.3  # m, how long the line is that shows which way something faces


def noses(xy: np.ndarray, theta: np.ndarray, length: float = NOSE) -> np.ndarray:
    """Lines (2, 3K) that show where things face, with gaps between them, for ``Line2D.set_data``.

    Args:
        xy: (K, 2) m.
        theta: (K,) rad.
        length: m.
    """
    tips = xy + length * np.column_stack([np.cos(theta), np.sin(theta)])
    return np.stack([xy, tips, np.full_like(tips, np.nan)], axis=1).reshape(-1, 2).T


def plot_noses(ax: Axes, xy: np.ndarray, theta: np.ndarray, truth: bool = False, **style) -> Axes:
    """Which way things face: a line from the middle of each; grey and wide for the truth.

    Args:
        ax: a map.
        xy: (K, 2) m, W.
        theta: (K,) rad, W.
        truth: whether they really face so.
        style: of the lines.
    """
    look = {"color": TRUTH_COLOR, "linewidth": 4.0, "alpha": 0.6, "zorder": 1.7}
    look = look if truth else {"color": ESTIMATE_COLOR, "linewidth": 1.6, "zorder": 2.7}
    ax.plot(*noses(np.asarray(xy), np.asarray(theta)), **look | style)
    return ax


def laid_over(snapshot: Snapshot, truth: GroundTruth) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Path (T, 3), objects (K, 2) and their headings (K,), moved to fit the true path best; NaN without headings."""
    (path, xy), graph = laid_over_truth(snapshot, truth), snapshot.graph
    if graph.landmarks.shape[1] == 2:
        return path, xy, np.full(len(xy), np.nan)
    return path, xy, graph.landmarks[:, 2] + path[0, 2] - graph.poses[0, 2]


def plot_hall(ax: Axes, snapshot: Snapshot, truth: GroundTruth, title: str) -> Axes:
    """The hall as it is, hollow and grey, and as a method believes it is.

    Args:
        ax: a map.
        snapshot: the estimate.
        truth: behind it.
        title: of the map.
    """
    world, (path, xy, theta) = truth.world, laid_over(snapshot, truth)
    plot_trajectory(ax, truth.poses, truth=True)
    plot_objects(ax, world.object_xy, world.object_class, world.class_names, truth=True)
    plot_noses(ax, world.object_xy, world.object_theta, truth=True)
    plot_trajectory(ax, path)
    sizes = 12 * np.sqrt(snapshot.votes[:, 1:].sum(axis=1))
    plot_objects(ax, xy, np.zeros(len(xy), dtype=int), world.class_names, sizes=sizes)
    plot_noses(ax, xy, theta)
    return label_map(ax, title)


def hall_handles(truth: GroundTruth) -> list:
    """The legend of ``plot_hall``."""
    paths = path_handles(("estimated path", "true path", "true object"))
    return class_handles([0], truth.world.class_names) + paths
