"""Pictures of lesson 03: the factor graph, what pulls in it, where H has numbers, and how sure the answer is."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from npslam_teach.plotting.style import (
    ESTIMATE_COLOR,
    TEXT_SIZE,
    label_axes,
    legend_below,
    new_figure,
)
from npslam_teach.pose_graph.fill_in import factor_pattern

HAS_NUMBER, FILL = ESTIMATE_COLOR, "#e58fb1"
NUM_CELLS = 240  # of a sparsity picture, each way; larger matrices are drawn coarser


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
