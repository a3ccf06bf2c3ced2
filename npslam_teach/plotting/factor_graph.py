"""The pose graph as a picture: poses, objects, and a line for every factor."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from npslam_teach import se2
from npslam_teach.plotting.maps import plot_objects
from npslam_teach.plotting.style import (
    ESTIMATE_COLOR,
    TEXT_SIZE,
    class_handles,
    label_map,
    legend_beside,
    new_figure,
)
from npslam_teach.types import PoseGraph

ODOMETRY_LINE = {"colors": ESTIMATE_COLOR, "linewidths": 1.8, "zorder": 2.0}


OBSERVATION_LINE = {"colors": "#8a8a8a", "linewidths": 0.9, "zorder": 1.8}


RESIDUAL_LINE = {"colors": "#c2185b", "linewidths": 3.5, "zorder": 2.2}


POSE = {"linestyle": "none", "marker": "o", "color": ESTIMATE_COLOR, "zorder": 2.3}


def odometry_segments(graph: PoseGraph) -> np.ndarray:
    """The lines (E, 2, 2) m, W, from pose to pose, of the odometry factors."""
    between = graph.between
    return np.stack([graph.poses[between.i, :2], graph.poses[between.j, :2]], axis=1)


def observation_segments(graph: PoseGraph) -> np.ndarray:
    """The lines (M, 2, 2) m, W, from pose to object, of the observation factors."""
    observations = graph.observations
    return np.stack([graph.poses[observations.pose, :2], graph.landmark_xy[observations.landmark]], axis=1)


def residual_segments(graph: PoseGraph) -> np.ndarray:
    """The residuals of the observations, (M, 2, 2) m, W: from where an observation lands to its object."""
    observations = graph.observations
    landed = se2.apply(graph.poses[observations.pose], observations.xy)
    return np.stack([landed, graph.landmark_xy[observations.landmark]], axis=1)


def plot_factor_graph(
    ax: Axes, graph: PoseGraph, object_class=None, class_names=("object",), title: str | None = None
) -> Axes:
    """Poses, objects, a line for every factor, and a thick one for every residual (deck figure 12).

    Args:
        ax: a map.
        graph: a small one; every pose is named.
        object_class: (K,) class indices; all of class 0 when None.
        class_names: a name for every class index.
        title: of the map.
    """
    object_class = np.zeros(len(graph.landmarks), dtype=int) if object_class is None else object_class
    for segments, style in ((odometry_segments(graph), ODOMETRY_LINE), (observation_segments(graph), OBSERVATION_LINE)):
        ax.add_collection(LineCollection(segments, **style))
        # A small square in the middle: in a factor graph every measurement is a node of its own.
        square = {"linestyle": "none", "marker": "s", "markersize": 4, "zorder": style["zorder"]}
        ax.plot(*segments.mean(axis=1).T, color=style["colors"], **square)
    ax.add_collection(LineCollection(residual_segments(graph), **RESIDUAL_LINE))
    plot_objects(ax, graph.landmark_xy, object_class, class_names)
    _name_poses(ax, graph.poses)
    ax.margins(0.1)
    return label_map(ax, title)


def _name_poses(ax: Axes, poses: np.ndarray) -> None:
    """White discs with the pose's number, each with a short line in the direction in which the robot looks."""
    ahead = se2.apply(poses, np.array([0.22, 0.0]))
    ax.add_collection(LineCollection(np.stack([poses[:, :2], ahead], axis=1), **ODOMETRY_LINE | {"linewidths": 3.0}))
    ax.plot(*poses[:, :2].T, **POSE | {"markersize": 17, "markerfacecolor": "white", "zorder": 2.6})
    for t, (x, y, _) in enumerate(poses):
        text = {"ha": "center", "va": "center", "fontsize": TEXT_SIZE["tick"], "zorder": 2.7}
        ax.text(x, y, str(t), **text)


def factor_handles(pull: bool = True) -> list[Line2D]:
    """Legend entries of the lines in ``plot_factor_graph``, and of the robot's poses."""
    disc = POSE | {"markerfacecolor": "white", "markersize": 11}
    lines = [("odometry", ODOMETRY_LINE), ("observation", OBSERVATION_LINE)] + [("residual", RESIDUAL_LINE)] * pull
    handles = [Line2D([], [], color=s["colors"], linewidth=s["linewidths"], label=label) for label, s in lines]
    return [Line2D([], [], label="pose", **disc), *handles]


def factor_graph_figure(graph: PoseGraph, class_name: str) -> Figure:
    """A small graph whose objects are all of one class, with its legend."""
    figure, ax = new_figure(size=(7.5, 4.6))
    plot_factor_graph(ax, graph, class_names=(class_name,))
    legend_beside(ax, factor_handles() + class_handles([0], (class_name,)))
    return figure
