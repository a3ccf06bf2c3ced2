"""Pictures of lesson 11: partitions and their probabilities, tracklets on a map, samples, and reliability.

Observations are numbered from 1, so that a partition reads ``{1 3} {2 4 7 8} {5 6}``.
"""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from npslam_teach import se2
from npslam_teach.evaluation.reliability import Reliability
from npslam_teach.plotting.maps import plot_objects, plot_trajectory
from npslam_teach.plotting.style import (
    CLASS_COLORS,
    CLASS_MARKERS,
    ESTIMATE_COLOR,
    TEXT_SIZE,
    TRUTH_COLOR,
    TRUTH_LINE,
    label_axes,
    label_map,
    legend_below,
    legend_beside,
    new_figure,
    path_handles,
)
from npslam_teach.plotting.uncertainty import ellipse
from npslam_teach.types import GroundTruth, RobotLog

SAME_PLACE = 0.05  # m: observations that are nearer to each other share one label
TRUE_MARK = "  (true)"


def partition_name(labels) -> str:
    """``{1 3} {2 4}`` for the labels 0, 1, 0, 1."""
    labels = np.asarray(labels, dtype=int)
    parts = [" ".join(str(k + 1) for k in np.flatnonzero(labels == i)) for i in range(labels.max(initial=-1) + 1)]
    return " ".join("{" + part + "}" for part in parts)


def plot_numbered_sightings(ax: Axes, log: RobotLog, truth: GroundTruth, title: str | None = None) -> Axes:
    """Every observation with its number along the odometry path, over the true path and the true objects.

    Args:
        ax: a map.
        log: a short one.
        truth: drawn behind; its first pose is the origin.
        title: of the map.
    """
    poses = se2.dead_reckoning(log.odometry)
    xy, world = se2.apply(poses[log.obs_time], log.obs_xy), truth.world
    plot_trajectory(ax, truth.poses, truth=True)
    plot_trajectory(ax, poses)
    plot_objects(ax, world.object_xy, world.object_class, world.class_names, truth=True)
    plot_objects(ax, xy, log.obs_class, world.class_names)
    for k, point in enumerate(xy):
        near = np.flatnonzero(np.linalg.norm(xy - point, axis=1) < SAME_PLACE)
        if near[0] == k:
            # Of two close neighbours, one number is written above and one below.
            above = sum(np.linalg.norm(xy[near[0]] - each) < 0.45 for each in xy[:k]) > 0
            text = ", ".join(str(i + 1) for i in near)
            style = {"ha": "center", "va": "bottom" if above else "top", "fontsize": TEXT_SIZE["label"]}
            ax.annotate(text, point, (0, 9 if above else -9), textcoords="offset points", **style)
    for k, point in enumerate(world.object_xy):
        style = {"ha": "center", "va": "top", "fontsize": TEXT_SIZE["legend"], "color": "0.35"}
        ax.annotate(chr(ord("A") + k), point, (0, -26), textcoords="offset points", **style)
    ax.margins(0.18)
    legend_beside(ax, path_handles(("estimated path", "true path", "true object")))
    return label_map(ax, title)


def plot_atoms(ax: Axes, weight: np.ndarray, xy: np.ndarray, title: str) -> Axes:
    """A draw of a Dirichlet process over places: a disc for every object, its area in proportion to its weight.

    Args:
        ax: a map.
        weight: (N,) adding up to one, or nearly.
        xy: (N, 2) m.
        title: of the map.
    """
    ax.scatter(*xy.T, s=2500 * weight, color=CLASS_COLORS[0], alpha=0.6, edgecolors=ESTIMATE_COLOR, linewidths=0.6)
    ax.set(xlim=(-0.5, 4.5), ylim=(-0.5, 4.5))
    return label_map(ax, title)


class PartitionBars:
    """Horizontal bars of the most probable partitions, their names beside them; ``show`` sets them."""

    def __init__(self, ax: Axes, rows: int, title: str):
        """Draw bars of zero length.

        Args:
            ax: any axes.
            rows: how many partitions.
            title: of the plot.
        """
        self.bars = ax.barh(np.arange(rows), np.zeros(rows), 0.68, edgecolor=ESTIMATE_COLOR, linewidth=0.8)
        style = {"va": "center", "ha": "left", "fontsize": TEXT_SIZE["tick"]}
        self.texts = [ax.text(0.01, k, "", **style) for k in range(rows)]
        ax.set(xlim=(0.0, 1.0), ylim=(rows - 0.4, -0.6), yticks=[])
        label_axes(ax, "probability (no unit)", "partitions, most probable first", title)
        ax.grid(False, axis="y")

    def show(self, partitions: list, probabilities: np.ndarray, true_labels=None) -> list[int]:
        """Set the bars to the most probable partitions; returns which, most probable first.

        Args:
            partitions: labels of each.
            probabilities: of each.
            true_labels: of the partition that is marked; numbered in the order of first observation.
        """
        order = np.argsort(-probabilities, kind="stable")[: len(self.bars)].tolist()
        for bar, text, k in zip(self.bars, self.texts, order, strict=True):
            is_true = true_labels is not None and np.array_equal(partitions[k], true_labels)
            bar.set(width=probabilities[k], facecolor=CLASS_COLORS[0] if is_true else "0.75")
            name = partition_name(partitions[k]) + TRUE_MARK * is_true
            text.set_text(f"{probabilities[k]:.3f}  {name}")
            # Beside a short bar, inside a long one.
            inside = probabilities[k] > 0.5
            text.set(x=0.01 if inside else probabilities[k] + 0.01, color="white" if inside and is_true else "black")
        return order


def plot_partitions(ax: Axes, partitions: list, probabilities: np.ndarray, true_labels=None, rows: int = 8) -> Axes:
    """The most probable partitions as horizontal bars.

    Args:
        ax: any axes.
        partitions: labels of each.
        probabilities: of each.
        true_labels: of the partition that is marked.
        rows: how many are shown.
    """
    both = np.sort(probabilities)[-2:].sum()
    most = PartitionBars(ax, rows, f"of {len(partitions)} partitions two hold {both:.2f}")
    most.show(partitions, probabilities, true_labels)
    return ax


def plot_num_objects(ax: Axes, shares: dict, num_true: int, title: str | None = None) -> Axes:
    """How probable each number of objects is: bars side by side for every case.

    Args:
        ax: any axes.
        shares: by the name of a case: number of objects to probability.
        num_true: dashed grey.
        title: of the plot; by default how probable the true number is.
    """
    numbers = sorted({number for share in shares.values() for number in share} | {num_true - 1, num_true + 1})
    width = 0.8 / len(shares)
    for k, (name, share) in enumerate(shares.items()):
        at = np.array(numbers) + (k - (len(shares) - 1) / 2) * width
        color, hatch = CLASS_COLORS[k % 8], ("", "//", "..", "xx")[k % 4]
        style = {"color": color, "hatch": hatch, "edgecolor": "white", "linewidth": 0.6}
        ax.bar(at, [share.get(number, 0.0) for number in numbers], width, label=name, **style)
    ax.axvline(num_true, label=f"true number: {num_true}", **TRUTH_LINE | {"zorder": 3.0})
    ax.set_xticks(numbers)
    ax.set_ylim(0.0, 1.02)
    legend_beside(ax)
    said = ", ".join(f"{name} {share.get(num_true, 0.0):.2f}" for name, share in shares.items())
    return label_axes(ax, "objects (number)", "probability (no unit)", title or f"probability of {num_true}: {said}")


def plot_together(ax: Axes, together: np.ndarray, best: np.ndarray, title: str) -> Axes:
    """The probability that two tracklets are one object as an image, those of one object side by side.

    Args:
        ax: any axes.
        together: (N, N).
        best: (N,) the objects that the tracklets are sorted by; framed.
        title: of the plot.
    """
    order = np.argsort(best, kind="stable")
    image = ax.imshow(together[np.ix_(order, order)], cmap="Greys", vmin=0.0, vmax=1.0, interpolation="nearest")
    edges = np.flatnonzero(np.diff(best[order], prepend=-1, append=-1)) - 0.5
    for low, high in zip(edges[:-1], edges[1:], strict=True):
        ax.plot([low, high, high, low, low], [low, low, high, high, low], color=CLASS_COLORS[1], linewidth=1.4)
    bar = ax.figure.colorbar(image, ax=ax, shrink=0.85)
    bar.set_label("probability of being one object (no unit)", fontsize=TEXT_SIZE["label"])
    label_axes(ax, "tracklet (number, sorted by object)", "tracklet (number, sorted by object)", title)
    ax.grid(False)
    return ax


def plot_credible(ax: Axes, xy: np.ndarray, cov: np.ndarray, true_xy: np.ndarray, title: str) -> Axes:
    """Objects in the ellipses that hold them with 95 % probability, over the true ones.

    Args:
        ax: a map.
        xy: (K, 2) m, in the frame of the first pose.
        cov: (K, 2, 2) m^2.
        true_xy: (L, 2) m, in the same frame.
        title: of the map.
    """
    for k, (point, spread) in enumerate(zip(xy, cov, strict=True)):
        label = "95 % ellipse" if k == 0 else None
        style = {"edgecolor": CLASS_COLORS[0], "facecolor": CLASS_COLORS[0] + "30", "linewidth": 1.5}
        ax.add_patch(ellipse(point, spread, label=label, **style))
    ax.plot(*xy.T, "o", color=CLASS_COLORS[0], markersize=4, label="object found")
    ax.plot(*true_xy.T, "x", color=TRUTH_COLOR, markersize=8, markeredgewidth=2, label="true object")
    ax.autoscale_view()
    legend_beside(ax)
    return label_map(ax, title)


def chains_figure(cases: dict) -> Figure:
    """The running mean of a number along every chain of a sampler, and where it should end; two cases in a row.

    Args:
        cases: by title: the chains (C, n), and the exact mean, dashed grey.
    """
    rows = -(-len(cases) // 2)
    figure, axes = new_figure(rows, 2, (10.5, 1.0 + 2.7 * rows), sharex=True, sharey=True, squeeze=False)
    for k, (ax, (title, (chains, exact))) in enumerate(zip(axes.flat, cases.items(), strict=True)):
        _plot_running_means(ax, np.asarray(chains), exact)
        sweeps = "sweeps (number)" if k // 2 == rows - 1 else ""
        label_axes(ax, sweeps, "objects, mean so far (number)" if k % 2 == 0 else "", title)
    return legend_below(figure, axes[0, 0].get_legend_handles_labels()[0], columns=5)


def _plot_running_means(ax: Axes, chains: np.ndarray, exact: float) -> None:
    counts = np.arange(1, chains.shape[1] + 1)
    for k, chain in enumerate(chains):
        # Later curves are thinner, because equal chains coincide.
        size = {"linewidth": max(4.0 - k, 1.2), "markersize": max(11.0 - 2 * k, 5.0)}
        style = {"color": CLASS_COLORS[k % 8], "marker": CLASS_MARKERS[k % 8]}
        style["markevery"] = (4 * k, max(len(chain) // 5, 1))
        ax.plot(counts, np.cumsum(chain) / counts, label=f"chain {k + 1}", **size, **style)
    ax.axhline(exact, label="exact", **TRUTH_LINE)


def plot_reliability(ax: Axes, table: Reliability, title: str) -> Axes:
    """Of the pairs that were given a probability, the share that is really one object.

    Args:
        ax: any axes.
        table: pairs in groups.
        title: of the plot.
    """
    ax.plot([0, 1], [0, 1], label="as it should be", **TRUTH_LINE)
    style = {"color": CLASS_COLORS[0], "marker": "o", "markersize": 8, "linestyle": "none", "capsize": 4}
    ax.errorbar(table.said, table.happened, table.margin, label="pairs, two standard errors", **style)
    ax.set(xlim=(-0.03, 1.03), ylim=(-0.06, 1.06), aspect="equal")
    legend_beside(ax)
    title += f":\n{np.sum(table.within)} of {len(table.said)} groups as it should be"
    return label_axes(ax, "probability of being one chair (no unit)", "share that is one (no unit)", title)
