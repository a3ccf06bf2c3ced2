"""Covariances as 95 % ellipses on a map."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Ellipse

from npslam_teach.plotting.factor_graph import POSE
from npslam_teach.plotting.maps import plot_objects
from npslam_teach.plotting.style import (
    ESTIMATE_COLOR,
    class_handles,
    class_style,
    label_map,
    legend_below,
    new_figure,
)
from npslam_teach.pose_graph import marginal_covariance, squared_radius
from npslam_teach.types import PoseGraph


def ellipse_points(mean: np.ndarray, cov: np.ndarray, share: float = 0.95) -> np.ndarray:
    """The ellipse that holds a share of a Gaussian in the plane; (100, 2) m.

    Args:
        mean: (2,) m.
        cov: (2, 2) m^2.
        share: p, the probability inside.
    """
    turn = np.linspace(0.0, 2 * np.pi, 100)
    circle = np.column_stack([np.cos(turn), np.sin(turn)])
    # The root of a covariance without rank is needed too: a sensor that errs in one direction only.
    values, vectors = np.linalg.eigh(cov)
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    return mean + np.sqrt(squared_radius(share)) * circle @ root.T


def uncertainty_figure(cases: dict, class_names) -> Figure:
    """Maps with ellipses side by side, all of one scale.

    Args:
        cases: by title, a graph at its minimum and the class (K,) of each of its objects.
        class_names: a name for every class index.
    """
    figure, axes = new_figure(1, len(cases), (6.0 * len(cases), 4.8), sharex=True, sharey=True, squeeze=False)
    for ax, (title, (graph, object_class)) in zip(axes.flat, cases.items(), strict=True):
        covs = marginal_covariance(graph, range(len(graph.poses)), range(len(graph.landmarks)))
        plot_uncertainty(ax, graph, *covs, object_class, class_names, title)
    classes = np.unique(np.concatenate([object_class for _, object_class in cases.values()]))
    rim = Line2D([], [], color=ESTIMATE_COLOR, marker="o", markersize=13, markerfacecolor="none", linestyle="none")
    rim.set_label("95 % ellipse")
    path = Line2D([], [], **POSE | {"linestyle": "-", "linewidth": 1.2, "markersize": 5}, label="pose")
    return legend_below(figure, [path, rim, *class_handles(classes, class_names)], columns=6)


def plot_uncertainty(
    ax: Axes, graph: PoseGraph, pose_cov, landmark_cov, object_class, class_names, title: str | None = None
) -> Axes:
    """The path and the objects, each in the ellipse that holds it with 95 % probability.

    Args:
        ax: a map.
        graph: at its minimum.
        pose_cov: (T, 3, 3) m, m, rad in W, from ``marginal_covariance``.
        landmark_cov: (K, 2, 2) m in W.
        object_class: (K,) class indices.
        class_names: a name for every class index.
        title: of the map.
    """
    ax.plot(*graph.poses[:, :2].T, **POSE | {"linestyle": "-", "linewidth": 1.2, "markersize": 5})
    for xy, cov in zip(graph.poses[:, :2], pose_cov, strict=True):
        ax.add_patch(ellipse(xy, cov[:2, :2], edgecolor=ESTIMATE_COLOR, facecolor="none", linewidth=1.2, zorder=1.9))
    for xy, cov, c in zip(graph.landmark_xy, landmark_cov[:, :2, :2], object_class, strict=True):
        color = class_style(c)[0]
        ax.add_patch(ellipse(xy, cov, edgecolor=color, facecolor=color + "30", linewidth=1.5, zorder=1.7))
    plot_objects(ax, graph.landmark_xy, object_class, class_names)
    ax.margins(0.05)
    return label_map(ax, title)


def ellipse(xy: np.ndarray, cov: np.ndarray, probability: float = 0.95, **style) -> Ellipse:
    """The smallest ellipse that holds a normal distribution's point with the given probability.

    Args:
        xy: (2,) m, its middle.
        cov: (2, 2) m^2.
        probability: between 0 and 1.
        **style: of the patch.
    """
    variances, axes = np.linalg.eigh(cov)
    # In two dimensions the squared distance, in standard deviations, is exponential with mean 2.
    width, height = 2 * np.sqrt(squared_radius(probability) * np.maximum(variances, 0.0))
    return Ellipse(xy, width, height, angle=np.rad2deg(np.arctan2(axes[1, 0], axes[0, 0])), **style)
