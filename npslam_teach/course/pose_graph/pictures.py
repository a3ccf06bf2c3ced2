"""Pictures of lesson 03: a sighting that misses, the blocks of H, its factor, and chi2 over the iterations."""

from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle
from matplotlib.ticker import MaxNLocator

from npslam_teach.plotting import factor_graph
from npslam_teach.plotting.style import (
    ESTIMATE_COLOR,
    TEXT_SIZE,
    label_axes,
    legend_below,
    legend_beside,
    new_figure,
)
from npslam_teach.pose_graph import Iteration
from npslam_teach.pose_graph.fill_in import factor_pattern
from npslam_teach.types import PoseGraph

ON_DIAGONAL, OFF_DIAGONAL = "#f3c9a5", "#cfe3f1"  # blocks of one variable, and of two
HAS_NUMBER, FILL = ESTIMATE_COLOR, "#e58fb1"
CHI2_COLORS = ("#d45e00", ESTIMATE_COLOR)  # of Gauss-Newton, and of Levenberg-Marquardt
NUM_CELLS = 240  # of a sparsity picture, each way; larger matrices are drawn coarser


def landing_figure(graph: PoseGraph, class_name: str) -> Figure:
    """A small graph in which one sighting lands beside its object."""
    figure = factor_graph.factor_graph_figure(graph, class_name)
    figure.axes[0].set_title("the sighting from pose 2 lands beyond the chair", fontsize=TEXT_SIZE["title"])
    return figure


def blocks_figure(matrix: np.ndarray, sizes: list[int], names: list[str]) -> Figure:
    """The numbers of a small H, its blocks separated by lines; a block without numbers is white.

    Args:
        matrix: (n, n).
        sizes: of the variables' blocks, n in all.
        names: of the variables.
    """
    figure, ax = new_figure(size=(7.6, 6.4))
    edges = np.concatenate([[0], np.cumsum(sizes)])
    for i, rows in enumerate(pairwise(edges)):
        for j, columns in enumerate(pairwise(edges)):
            has_numbers = np.any(np.round(matrix[slice(*rows), slice(*columns)]))
            face = ("white", OFF_DIAGONAL, ON_DIAGONAL)[int(has_numbers) * (1 + (i == j))]
            corner, size = (columns[0] - 0.5, rows[0] - 0.5), (sizes[j], sizes[i])
            ax.add_patch(Rectangle(corner, *size, facecolor=face, edgecolor=ESTIMATE_COLOR, linewidth=1.6))
    for (i, j), value in np.ndenumerate(np.round(matrix).astype(int)):
        ax.text(j, i, f"{value}", ha="center", va="center", fontsize=10, color=ESTIMATE_COLOR if value else "0.55")
    middles = (edges[:-1] + edges[1:] - 1) / 2
    ax.set_xticks(middles, names)
    ax.set_yticks(middles, names)
    ax.set(xlim=(-0.7, edges[-1] - 0.3), ylim=(edges[-1] - 0.3, -0.7), aspect="equal")
    ax.grid(False)
    title = "$H$ has a block where two variables share a measurement"
    return label_axes(ax, "variable (its columns)", "variable (its rows)", title).figure


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


def plot_sparsity(ax: Axes, matrix, title: str) -> Axes:
    """Where a matrix has numbers, and where its factor has more; large matrices are drawn at a coarser resolution.

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


def chi2_figure(runs: dict[tuple[str, str], list[Iteration]]) -> Figure:
    """The fall, and sometimes the rise, of chi2 over the iterations of two solvers from two starts.

    Args:
        runs: by the names of the start and of the solver, all iterations.
    """
    figure, ax = new_figure(size=(10, 4.5))
    starts, solvers = (list(dict.fromkeys(names)) for names in zip(*runs, strict=True))
    for (start, solver), run in runs.items():
        line, marker = (("-", "o"), ("--", "s"))[starts.index(start)]
        style = {"color": CHI2_COLORS[solvers.index(solver)], "linestyle": line, "marker": marker, "markersize": 4}
        ax.plot([iteration.chi2 for iteration in run], label=f"{solver}, {start}", **style)
    ax.set_yscale("log")
    ax.xaxis.set_major_locator(MaxNLocator(integer=True))
    legend_beside(ax)
    label_axes(
        ax,
        "iteration (number)",
        "$\\chi^2$ (no unit, log scale)",
        "Gauss-Newton climbs and stops too high; with damping it only falls",
    )
    return figure
