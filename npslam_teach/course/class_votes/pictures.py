"""Pictures of lesson 05: votes of clusters, the Dirichlet distribution on its triangle, and confused runs.

A point of the triangle is a triple of probabilities: a corner is certainty of one class, the middle is uniform.
"""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator
from matplotlib.tri import Triangulation

from npslam_teach.association.class_votes import log_density
from npslam_teach.course.dirichlet_process.pictures import NEW
from npslam_teach.plotting.maps import classes_of, laid_over_truth, plot_snapshot
from npslam_teach.plotting.style import ESTIMATE_COLOR, TEXT_SIZE, TRUTH_LINE, class_style, label_axes, new_figure
from npslam_teach.types import GroundTruth, RobotLog, Snapshot

CORNERS = np.array([[0.0, 0.0], [1.0, 0.0], [0.5, np.sqrt(3) / 2]])  # of the triangle, by class
DENSITY_TICKS = (0, 1 / 3, 1, 3, 10, 30)  # in units of the uniform density
SUMMARIES = {  # maximum likelihood is drawn around the mode, which it often equals
    "maximum likelihood": {"marker": "s", "markersize": 15, "markerfacecolor": "none", "markeredgewidth": 2.2},
    "mean": {"marker": "o", "markersize": 9, "markerfacecolor": "white", "markeredgewidth": 1.6},
    "mode": {"marker": "D", "markersize": 7, "markerfacecolor": "#d45e00", "markeredgewidth": 1.0},
}
_MARK = {"linestyle": "none", "markeredgecolor": ESTIMATE_COLOR}
KINDS = {  # of runs: look of their numbers of objects
    "classes never wrong": {"color": "#38ba8d", "marker": "^"},
    "confused, hard votes": {"color": "#d45e00", "marker": "s"},
    "confused, soft votes": {"color": "#00659f", "marker": "o"},
}


def plot_votes(ax: Axes, votes: np.ndarray, names: list[str], class_names, title: str) -> Axes:
    """Stacked votes of each cluster, every piece with its class and its number (deck figure 9).

    Args:
        ax: any axes.
        votes: (K, C+1); column 0 is the false-positive vote, drawn hatched at the foot.
        names: (K,) under the bars.
        class_names: (C,).
        title: of the plot.
    """
    votes = np.asarray(votes, dtype=float)
    foot = np.zeros(len(votes))
    looks = [NEW] + [{"facecolor": class_style(c)[0], "edgecolor": ESTIMATE_COLOR} for c in range(len(class_names))]
    for column, (name, look) in enumerate(zip(("nothing", *class_names), looks, strict=True)):
        cast = votes[:, column]
        some = np.flatnonzero(cast > 0)
        ax.bar(some, cast[some], bottom=foot[some], width=0.72, linewidth=0.8, label=name, **look)
        for i in some:
            style = {"ha": "center", "va": "center", "fontsize": TEXT_SIZE["tick"]}
            color = "white" if column and _is_dark(look["facecolor"]) else "black"
            box = {"bbox": {"facecolor": "white", "edgecolor": "none", "pad": 1.0}} if column == 0 else {}
            ax.text(i, foot[i] + cast[i] / 2, f"{name}\n{cast[i]:g}", color=color, **style, **box)
        foot += cast
    ax.set_xticks(np.arange(len(names)), names, fontsize=TEXT_SIZE["tick"])
    ax.set_ylim(0.0, 1.1 * foot.max())
    ax.yaxis.set_major_locator(MaxNLocator(integer=True))
    label_axes(ax, "", "votes (number)", title)
    ax.grid(False, axis="x")
    return ax


def _is_dark(color: str) -> bool:
    red, green, blue = (int(color[k : k + 2], 16) for k in (1, 3, 5))
    return 0.299 * red + 0.587 * green + 0.114 * blue < 130


def triangle_points(divisions: int = 48) -> tuple[np.ndarray, np.ndarray]:
    """A triangular grid: probabilities (N, 3) at its nodes, and its small triangles (F, 3) as indices of nodes."""
    rows = [[(i, j) for j in range(divisions + 1 - i)] for i in range(divisions + 1)]
    nodes = np.array([node for row in rows for node in row])
    number = {(int(i), int(j)): k for k, (i, j) in enumerate(nodes)}
    faces = []
    for i, j in number:
        if i + j < divisions:
            faces.append((number[i, j], number[i + 1, j], number[i, j + 1]))
        if i + j < divisions - 1:
            faces.append((number[i + 1, j], number[i + 1, j + 1], number[i, j + 1]))
    first, second = nodes.T / divisions
    return np.column_stack([1 - first - second, first, second]), np.array(faces)


def on_triangle(probabilities: np.ndarray) -> np.ndarray:
    """Where probabilities (..., 3) lie on the page: (..., 2)."""
    return np.asarray(probabilities) @ CORNERS


def shade(concentration: np.ndarray, points: np.ndarray) -> np.ndarray:
    """How dark the density is drawn, (N,) from 0 to 1: ``d / (1 + d)`` with d in units of the uniform density, 2.

    The scale is the same for every distribution. On an edge the density may be infinite, so it is evaluated slightly
    inside.
    """
    inside = np.clip(points, 0.004, None)
    inside = inside / inside.sum(axis=-1, keepdims=True)
    relative = np.clip(log_density(concentration, inside) - np.log(2.0), -50.0, 50.0)
    return 1 / (1 + np.exp(-relative))


def plot_triangle(ax: Axes, concentration: np.ndarray, class_names, title: str = "", key: bool = True):
    """The density of a Dirichlet distribution over three classes (deck figure 10).

    Args:
        ax: any axes; they are hidden, because a corner already means probability 1 of its class.
        concentration: (3,) positive.
        class_names: (3,) written at the corners.
        title: of the plot.
        key: whether to put the scale of the shading beside it.

    Returns:
        the shading.
    """
    points, faces = triangle_points()
    # Pixels even in an SVG, where thousands of shaded triangles would take megabytes.
    mesh = Triangulation(*on_triangle(points).T, faces)
    look = {"shading": "gouraud", "cmap": "Blues", "vmin": 0.0, "vmax": 1.0, "zorder": 1, "rasterized": True}
    shading = ax.tripcolor(mesh, shade(concentration, points), **look)
    ax.plot(*on_triangle(np.eye(3)[[0, 1, 2, 0]]).T, color=ESTIMATE_COLOR, linewidth=1.2, zorder=2)
    for corner, name, (side, up) in zip(CORNERS, class_names, ((0, -1), (0, -1), (0, 1)), strict=True):
        style = {"ha": "center", "va": "top" if up < 0 else "bottom", "fontsize": TEXT_SIZE["label"]}
        ax.annotate(f"{name}: 1", corner, (side, 6 * up), textcoords="offset points", **style)
    ax.set(aspect="equal", xlim=(-0.12, 1.12), ylim=(-0.12, 1.0))
    ax.set_axis_off()
    ax.set_title(title, fontsize=TEXT_SIZE["title"])
    if key:
        bar = ax.figure.colorbar(shading, ax=ax, shrink=0.75, ticks=[d / (1 + d) for d in DENSITY_TICKS])
        bar.ax.set_yticklabels(["0", "1/3", *(f"{d:g}" for d in DENSITY_TICKS[2:])], fontsize=TEXT_SIZE["tick"])
        bar.set_label("density (times the even one)", fontsize=TEXT_SIZE["label"])
    return shading


def plot_summaries(ax: Axes, summaries: dict) -> None:
    """Mark points of the triangle.

    Args:
        ax: from ``plot_triangle``.
        summaries: by a name of ``SUMMARIES``: (3,) probabilities, or None where there is none.
    """
    for name, point in summaries.items():
        if point is not None:
            ax.plot(*on_triangle(point)[:, None], clip_on=False, zorder=4, **_MARK | SUMMARIES[name])


def summary_handles(names) -> list[Line2D]:
    """Legend entries of these summaries."""
    return [Line2D([], [], label=name, **_MARK | SUMMARIES[name]) for name in names]


def plot_beta(ax: Axes, beta: np.ndarray, class_names, title: str, top: float) -> Axes:
    """The votes of one cluster side by side: nothing there, and every class (deck figure 11).

    Args:
        ax: any axes.
        beta: (C+1,), entry 0 is the false-positive vote.
        class_names: (C,).
        title: of the plot.
        top: of the axis, the same on both sides of a comparison.
    """
    bars = ax.bar(np.arange(len(beta)), beta, width=0.72, linewidth=0.8)
    for c, bar in enumerate(bars, -1):
        bar.set(**(NEW if c < 0 else {"facecolor": class_style(c)[0], "edgecolor": ESTIMATE_COLOR}))
    ax.bar_label(bars, [f"{count:g}" for count in beta], padding=3, fontsize=TEXT_SIZE["tick"])
    ax.set_ylim(0.0, top)
    ax.yaxis.set_major_locator(MaxNLocator(integer=True))
    label_axes(ax, "", "votes (number)", title)
    ax.set_xticks(np.arange(len(beta)), ["nothing\nthere", *class_names], fontsize=TEXT_SIZE["tick"])
    ax.grid(False, axis="x")
    return ax


def plot_doubt(beta: np.ndarray, class_names) -> Figure:
    """The votes of one cluster before and after the vote for nothing there (deck figure 11).

    Args:
        beta: (C+1,), entry 0 is the false-positive vote.
        class_names: (C,).
    """
    figure, axes = new_figure(1, 2, (10.0, 3.8), sharey=True)
    before = np.where(np.arange(len(beta)) > 0, beta, 0.0)
    plot_beta(axes[0], before, class_names, "beta_3, before", top=1.25 * beta.max())
    plot_beta(axes[1], beta, class_names, "beta_3, with one vote for nothing there", top=1.25 * beta.max())
    axes[1].set_ylabel("")
    return figure


def plot_doubles(ax: Axes, snapshot: Snapshot, log: RobotLog, truth: GroundTruth, pairs: np.ndarray) -> Axes:
    """A result with objects of different class at one place: the one with fewer votes again, small, on the other.

    Args:
        ax: a map.
        snapshot: the estimate.
        log: what it was made from.
        truth: drawn behind; the estimate is laid over it.
        pairs: (P, 2) indices of objects.
    """
    plot_snapshot(ax, snapshot, log, truth)
    _, landmarks = laid_over_truth(snapshot, truth)
    counts, object_class = snapshot.votes[:, 1:].sum(axis=1), classes_of(snapshot)
    for i in pairs[np.arange(len(pairs)), counts[pairs].argmin(axis=1)]:
        color, marker = class_style(object_class[i])
        look = {"markersize": 6, "markeredgecolor": "white", "zorder": 4}
        ax.plot(*landmarks[i], marker=marker, color=color, **look)
    found, real = snapshot.num_objects, len(truth.world.object_xy)
    ax.set_title(f"{found} objects for {real} things: {len(pairs)} pairs of two classes at one place")
    return ax


def plot_runs(ax: Axes, runs: dict[str, list], num_objects_true: int) -> Axes:
    """How many objects were found in each room, by kind of run.

    Args:
        ax: any axes.
        runs: by a name of ``KINDS``: (S,) ``evaluation.Metrics``, one for each room.
        num_objects_true: dashed grey.
    """
    counts = {name: [metrics.num_objects for metrics in found] for name, found in runs.items()}
    ax.axhline(num_objects_true, **TRUTH_LINE)
    for k, (name, found) in enumerate(counts.items()):
        beside = np.arange(len(found)) + 0.16 * (k - 1)  # equal numbers must not hide each other
        ax.plot(
            beside, found, label=name, linestyle="none", markersize=9, markeredgecolor=ESTIMATE_COLOR, **KINDS[name]
        )
    handles = ax.get_legend_handles_labels()[0]
    handles.append(Line2D([], [], label=f"true number: {num_objects_true}", **TRUTH_LINE))
    ax.legend(
        handles=handles, loc="upper left", bbox_to_anchor=(1.02, 1.0), frameon=False, fontsize=TEXT_SIZE["legend"]
    )
    ax.set_ylim(0, 1.12 * max(max(found) for found in counts.values()))
    ax.set_xticks(range(max(len(found) for found in counts.values())))
    clear, hard, soft = (f"{np.median(counts[name]):g}" for name in KINDS)
    title = f"median: {clear} when no class is wrong, {hard} with hard votes, {soft} with soft votes"
    return label_axes(ax, "room (seed)", "objects found (number)", title)
