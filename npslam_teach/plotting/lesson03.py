"""Pictures of lesson 03: the factor graph, what pulls in it, where H has numbers, and how sure the answer is."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Ellipse, Patch
from matplotlib.ticker import MaxNLocator

from npslam_teach import se2
from npslam_teach.data import PoseGraph
from npslam_teach.linearization import graph_structure, linearize
from npslam_teach.plotting.maps import plot_objects
from npslam_teach.plotting.style import (
    ESTIMATE_COLOR,
    TEXT_SIZE,
    class_handles,
    class_style,
    label_axes,
    label_map,
    legend_below,
    legend_beside,
    new_figure,
)
from npslam_teach.pose_graph import marginal_covariance

STEP_LINE = {"colors": ESTIMATE_COLOR, "linewidths": 1.8, "zorder": 2.0}
SIGHTING_LINE = {"colors": "#8a8a8a", "linewidths": 0.9, "zorder": 1.8}
PULL_LINE = {"colors": "#c2185b", "linewidths": 3.5, "zorder": 2.2}
POSE = {"linestyle": "none", "marker": "o", "color": ESTIMATE_COLOR, "zorder": 2.3}
HAS_NUMBER, FILL = ESTIMATE_COLOR, "#e58fb1"
NUM_CELLS = 240  # of a sparsity picture, each way; larger matrices are drawn coarser


def step_segments(graph: PoseGraph) -> np.ndarray:
    """The lines (E, 2, 2) m, W, from pose to pose, of the odometry factors."""
    between = graph.between
    return np.stack([graph.poses[between.i, :2], graph.poses[between.j, :2]], axis=1)


def sighting_segments(graph: PoseGraph) -> np.ndarray:
    """The lines (M, 2, 2) m, W, from pose to object, of the observation factors."""
    observations = graph.observations
    return np.stack([graph.poses[observations.pose, :2], graph.landmarks[observations.landmark]], axis=1)


def pull_segments(graph: PoseGraph) -> np.ndarray:
    """The residuals of the observations, (M, 2, 2) m, W: from where a sighting lands to its object."""
    observations = graph.observations
    landed = se2.transform_to(graph.poses[observations.pose], observations.xy)
    return np.stack([landed, graph.landmarks[observations.landmark]], axis=1)


def plot_factor_graph(
    ax: Axes, graph: PoseGraph, object_class=None, class_names=("object",), title: str | None = None
) -> Axes:
    """Poses, objects, a line for every factor, and a thick one wherever a sighting misses its object (deck figure 12).

    Args:
        ax: a map.
        graph: a small one; every pose is named.
        object_class: (K,) class indices; all of class 0 when None.
        class_names: a name for every class index.
        title: of the map.
    """
    object_class = np.zeros(len(graph.landmarks), dtype=int) if object_class is None else object_class
    for segments, style in ((step_segments(graph), STEP_LINE), (sighting_segments(graph), SIGHTING_LINE)):
        ax.add_collection(LineCollection(segments, **style))
        # A small square in the middle: in a factor graph every measurement is a node of its own.
        square = {"linestyle": "none", "marker": "s", "markersize": 4, "zorder": style["zorder"]}
        ax.plot(*segments.mean(axis=1).T, color=style["colors"], **square)
    ax.add_collection(LineCollection(pull_segments(graph), **PULL_LINE))
    plot_objects(ax, graph.landmarks, object_class, class_names)
    _name_poses(ax, graph.poses)
    ax.margins(0.1)
    return label_map(ax, title)


def _name_poses(ax: Axes, poses: np.ndarray) -> None:
    """White discs with the pose's number, each with a short line in the direction in which the robot looks."""
    ahead = se2.transform_to(poses, np.array([0.22, 0.0]))
    ax.add_collection(LineCollection(np.stack([poses[:, :2], ahead], axis=1), **STEP_LINE | {"linewidths": 3.0}))
    ax.plot(*poses[:, :2].T, **POSE | {"markersize": 17, "markerfacecolor": "white", "zorder": 2.6})
    for t, (x, y, _) in enumerate(poses):
        text = {"ha": "center", "va": "center", "fontsize": TEXT_SIZE["tick"], "zorder": 2.7}
        ax.text(x, y, str(t), **text)


def factor_handles(pull: bool = True) -> list[Line2D]:
    """Legend entries of the lines in ``plot_factor_graph``, and of the robot's poses."""
    disc = POSE | {"markerfacecolor": "white", "markersize": 11}
    lines = [("step of the wheels", STEP_LINE), ("sighting", SIGHTING_LINE)] + [("residual", PULL_LINE)] * pull
    handles = [Line2D([], [], color=s["colors"], linewidth=s["linewidths"], label=label) for label, s in lines]
    return [Line2D([], [], label="pose", **disc), *handles]


def factor_graph_figure(graph: PoseGraph, class_name: str) -> Figure:
    """A small graph whose objects are all of one class, with its legend."""
    figure, ax = new_figure(size=(7.5, 4.6))
    plot_factor_graph(ax, graph, class_names=(class_name,))
    legend_beside(ax, factor_handles() + class_handles([0], (class_name,)))
    return figure


def in_three_orders(graph: PoseGraph) -> dict:
    """H of a graph with its variables in three orders, by the name of the order."""
    matrix, structure = linearize(graph)[0], graph_structure(graph)
    orders = {
        "objects first": np.roll(np.arange(structure.num_unknowns), 2 * len(graph.landmarks)),
        "poses first": np.arange(structure.num_unknowns),
        "reordered": structure.elimination_order,
    }
    return {name: matrix[order][:, order].tocsc() for name, order in orders.items()}


def sparsity_figure(panels: list, columns: int = 3) -> Figure:
    """Matrices and their fill side by side, row after row.

    Args:
        panels: pairs (title, H), SciPy sparse.
        columns: how many in a row.
    """
    rows = -(-len(panels) // columns)
    figure, axes = new_figure(rows, columns, (3.6 * columns, 4.2 * rows + 0.4), squeeze=False)
    for k, (title, matrix) in enumerate(panels):
        plot_sparsity(axes.flat[k], matrix, title)
        if k % columns:
            axes.flat[k].set_ylabel("")
    for ax in axes.flat[len(panels) :]:
        ax.set_axis_off()
    patches = [Patch(color=HAS_NUMBER, label="number of $H$"), Patch(color=FILL, label="fill in its factor")]
    return legend_below(figure, patches)


def factor_pattern(matrix):
    """Where the factor of a symmetric positive definite matrix has numbers, in the order given.

    Variables are taken out one after the other, and each ties together all the neighbours that it has left. Only the
    pattern is followed: real numbers cancel or underflow here and there, on one machine and not on the next.

    Args:
        matrix: (n, n), SciPy sparse.

    Returns:
        L (n, n), SciPy sparse, lower triangular with its diagonal; every number is 1.
    """
    from scipy.sparse import csc_array, tril

    below = csc_array(tril(matrix, k=-1))
    size = matrix.shape[0]
    left = [set(below.indices[below.indptr[k] : below.indptr[k + 1]].tolist()) for k in range(size)]
    for neighbours in left:
        if neighbours:
            # The first neighbour stands for all: it is taken out next, and hands on what it inherits.
            heir = min(neighbours)
            left[heir] |= neighbours - {heir}
    rows = np.concatenate([[k, *sorted(neighbours)] for k, neighbours in enumerate(left)])
    cols = np.repeat(np.arange(size), [1 + len(neighbours) for neighbours in left])
    return csc_array((np.ones(len(rows)), (rows, cols)), shape=matrix.shape)


def plot_sparsity(ax: Axes, matrix, title: str) -> Axes:
    """Where a matrix has numbers, and where its factor has more. Large matrices are drawn coarser than they are.

    Args:
        ax: any axes.
        matrix: (n, n), SciPy sparse.
        title: put above; under it, how many numbers both have.
    """
    size, factor = matrix.shape[0], factor_pattern(matrix)
    cells = min(size, NUM_CELLS)
    picture = np.zeros((cells, cells))
    for value, entries in ((1, factor.tocoo()), (2, matrix.tocoo())):
        picture[entries.row.astype(int) * cells // size, entries.col.astype(int) * cells // size] = value
    extent = (-0.5, size - 0.5, size - 0.5, -0.5)
    colors = ListedColormap(["white", FILL, HAS_NUMBER])
    ax.imshow(picture, cmap=colors, vmin=0, vmax=2, extent=extent, interpolation="nearest")
    heading = f"{title}\n$H$ {matrix.nnz}, factor {factor.nnz} numbers"
    label_axes(ax, "unknown (index)", "unknown (index)")
    ax.set_title(heading, fontsize=TEXT_SIZE["title"], pad=12)  # clear of the topmost tick's number
    ax.grid(False)
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_major_locator(MaxNLocator(4, integer=True))
    return ax


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
    for xy, cov, c in zip(graph.landmarks, landmark_cov, object_class, strict=True):
        color = class_style(c)[0]
        ax.add_patch(ellipse(xy, cov, edgecolor=color, facecolor=color + "30", linewidth=1.5, zorder=1.7))
    plot_objects(ax, graph.landmarks, object_class, class_names)
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
    width, height = 2 * np.sqrt(-2 * np.log(1 - probability) * np.maximum(variances, 0.0))
    return Ellipse(xy, width, height, angle=np.rad2deg(np.arctan2(axes[1, 0], axes[0, 0])), **style)
