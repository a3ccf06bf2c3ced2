"""Pictures of lesson 15: what elimination leaves, the tree, the work of a frame, many rooms, and all methods."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from npslam_teach.course.online import table
from npslam_teach.evaluation import wilson_interval
from npslam_teach.plotting.style import (
    CLASS_COLORS,
    ESTIMATE_COLOR,
    TEXT_SIZE,
    TRUTH_LINE,
    label_axes,
    legend_below,
    legend_beside,
    method_style,
    new_figure,
)

REDONE, KEPT = CLASS_COLORS[1], "0.8"


def plot_information(ax: Axes, information: np.ndarray, names, title: str) -> Axes:
    """An information matrix, a number in every entry that is not zero.

    Args:
        ax: any axes.
        information: (n, n).
        names: of the variables.
        title: of the plot.
    """
    largest = np.abs(information).max()
    ax.imshow(information, cmap="PuOr", vmin=-largest, vmax=largest)
    for (i, j), value in np.ndenumerate(information):
        if abs(value) > 1e-12:
            dark = abs(value) > 0.45 * largest
            ax.text(j, i, f"{value:.3g}", ha="center", va="center", color="white" if dark else "black")
    ax.set_xticks(range(len(names)), names)
    ax.set_yticks(range(len(names)), names)
    label_axes(ax, "variable", "variable", title).grid(False)
    return ax


def plot_tree(ax: Axes, sizes: list[int], title: str) -> Axes:
    """Complete trees over the leaves of a drive; what the newest frame redoes is in colour.

    Args:
        ax: any axes.
        sizes: of the complete trees, in leaves; the newest stretch is one leaf more.
        title: of the plot, to which the number of submaps that are redone is added.
    """
    begin = 0
    for size in sizes:
        for level in range(int(np.log2(size)) + 1):
            width = 2**level
            for left in range(begin, begin + size, width):
                ax.add_patch(_box(left, level, width, KEPT))
        begin += size
    ax.add_patch(_box(begin, 0, 1, REDONE))
    top = int(np.log2(max(sizes))) + 1
    ax.add_patch(_box(0, top + 0.4, begin + 1, REDONE))
    ax.set(xlim=(-0.2, begin + 1.2), ylim=(-0.2, top + 1.6))
    ax.yaxis.set_major_locator(MaxNLocator(integer=True))
    total = sum(2 * size - 1 for size in sizes) + len(sizes) + 1
    return label_axes(ax, "stretch of 32 poses (number)", "level (number)", f"{title}: 2 of {total} submaps redone")


def _box(left: float, level: float, width: float, color):
    from matplotlib.patches import Rectangle

    return Rectangle((left + 0.06, level + 0.1), width - 0.12, 0.8, facecolor=color, edgecolor="0.35")


def work_figure(work: np.ndarray, num_stretches: int) -> Figure:
    """How many submaps each frame condenses, and how many there are by then.

    Args:
        work: (T,).
        num_stretches: at the end of the drive.
    """
    figure, ax = new_figure(size=(9.5, 4.0))
    ax.plot(np.arange(len(work)), work, ".", color=REDONE, markersize=5, label="redone")
    ax.plot([0, len(work)], [1, 2 * num_stretches], label="all there are", **TRUTH_LINE)
    legend_beside(ax)
    seeing = work[work > 0]
    label_axes(
        ax, "frame (number)", "submaps (number)", f"a frame redoes {np.median(seeing):.0f} submaps in the median"
    )
    return figure


def gains_figure(distances: np.ndarray, gains: dict) -> Figure:
    """What it gains to take a new pass for an old object, over the distance between the two.

    Args:
        distances: (n,) m.
        gains: by the standard deviation in m: (n,) nats.
    """
    figure, ax = new_figure(size=(9.0, 4.2))
    for k, (std, gain) in enumerate(gains.items()):
        ax.plot(distances, gain, color=CLASS_COLORS[k], linestyle=("-", "--", "-.")[k], label=f"{std:g} m", linewidth=2)
    ax.axhline(0.0, **TRUTH_LINE)
    ax.set_ylim(-8, 8)
    legend_beside(ax)
    ends = ", ".join(f"{distances[np.flatnonzero(gain > 0)[-1]]:.1f}" for gain in gains.values())
    label_axes(ax, "distance (m)", "gain of joining (nats)", f"joined up to {ends} m")
    return figure


def counts_figure(counts: np.ndarray, true: int) -> Figure:
    """How many objects a robot believes in, frame by frame.

    Args:
        counts: (T,).
        true: at the end, dashed.
    """
    figure, ax = new_figure(size=(9.5, 3.8))
    ax.plot(counts, color=method_style("online")["color"], linewidth=2, label="online")
    ax.axhline(true, label="truth, at the end", **TRUTH_LINE)
    ax.yaxis.set_major_locator(MaxNLocator(integer=True))
    legend_beside(ax)
    falls = np.count_nonzero(np.diff(counts) < 0)
    label_axes(ax, "frame (number)", "objects (number)", f"{counts[-1]} objects; the count fell {falls} times")
    return figure


def times_figure(runs: list[tuple]) -> Figure:
    """Time per frame over the drive: medians of each tenth, and of a hundred frames the slowest.

    Args:
        runs: of (case, rooms, seed) in the table.
    """
    figure, ax = new_figure(size=(9.5, 4.6))
    for k, (case, rooms, seed) in enumerate(runs):
        poses, color = table.column("poses", case, rooms, seed), CLASS_COLORS[k]
        name = f"{case}, {rooms} rooms"
        ax.plot(poses, table.column("median_ms", case, rooms, seed), "o-", color=color, label=f"{name}: median")
        ax.plot(poses, table.column("p99_ms", case, rooms, seed), "v--", color=color, label="99 of 100 below")
        ax.plot(poses, table.column("batch_ms", case, rooms, seed), "s:", color=color, label="solving all anew")
    ax.axhline(50.0, **TRUTH_LINE)
    ax.set(xscale="log", yscale="log")
    legend_beside(ax)
    label_axes(ax, "poses so far (log scale)", "time of a frame (ms, log scale)", "dashed grey: 50 ms")
    return figure


def errors_figure(runs: list[tuple]) -> Figure:
    """Pose error over the drive: of the robot then and there, and of a batch with the same associations."""
    figure, axes = new_figure(1, len(runs), (min(5.5 * len(runs), 15.5), 4.4))
    for ax, run in zip(np.atleast_1d(axes), runs, strict=True):
        looks = {
            "error": ("on the way", method_style("online") | {"linestyle": "-"}),
            "error_batch": ("batch, same labels", {"color": ESTIMATE_COLOR, "linestyle": "--", "marker": "s"}),
            "error_told": ("batch, true labels", TRUTH_LINE | {"marker": "v"}),
        }
        for name, (words, look) in looks.items():
            ax.plot(table.column("poses", *run), table.column(name, *run), label=words, markersize=7, **look)
        off = table.column("error", *run)[-1] / table.column("error_batch", *run)[-1] - 1
        label_axes(
            ax, "poses so far (number)", "mean pose error (m)", f"{run[0]}, building {run[2]}: {off:+.0%} at the end"
        )
        ax.tick_params(labelsize=TEXT_SIZE["tick"])
    return legend_below(figure, np.atleast_1d(axes)[0].get_legend_handles_labels()[0], columns=3)


def alphas_figure(objects: dict) -> Figure:
    """How many objects are found for each alpha, one mark a room."""
    figure, ax = new_figure(size=(9.0, 3.8))
    for k, values in enumerate(objects.values()):
        ax.plot(k + 0.15 * np.linspace(-1, 1, len(values)), values, "o", color=CLASS_COLORS[k], markersize=9)
    ax.axhline(15, **TRUTH_LINE)
    ax.set_xticks(range(len(objects)), [f"{alpha:g}" for alpha in objects])
    found = "; ".join(f"{alpha:g}: {', '.join(map(str, values))}" for alpha, values in objects.items())
    label_axes(ax, "alpha (objects expected, per object seen)", "objects (number)", found)
    return figure


def methods_figure(rows: tuple[dict, ...]) -> Figure:
    """Every method: how often it is exact at each noise, and what a run costs.

    Args:
        rows: of ``table.all_methods``.
    """
    figure, (left, right) = new_figure(1, 2, (14.0, 5.0), width_ratios=(2.2, 1))
    plot_exact(left, rows)
    plot_seconds(right, rows)
    return legend_below(figure, left.get_legend_handles_labels()[0], columns=8)


def plot_exact(ax: Axes, rows: tuple[dict, ...]) -> Axes:
    """The share of exact runs of each method, with Wilson's interval; at each noise the methods stand side by side."""
    by_method = _by_method(rows)
    for k, (name, own) in enumerate(by_method.items()):
        exact, runs = (np.array([row[key] for row in own]) for key in ("exact", "runs"))
        low, high = wilson_interval(exact, runs)
        at, share = np.arange(len(own)) + 0.84 / len(by_method) * (k - (len(by_method) - 1) / 2), exact / runs
        ax.errorbar(at, share, [share - low, high - share], capsize=3, label=name, **_mark(name))
    noises = [row["noise"] for row in own]
    ax.set_xticks(range(len(noises)), [f"{noise:g}" for noise in noises])
    ax.set_xticks(np.arange(1, len(noises)) - 0.5, minor=True)
    totals = {name: sum(row["exact"] for row in own) for name, own in by_method.items()}
    first, second = sorted(totals, key=totals.get, reverse=True)[:2]
    title = f"{first} is exact in {totals[first]} of {runs.sum()} runs; the next, {second}, in {totals[second]}"
    label_axes(ax, "noise (times the paper's)", "exact (share of the rooms, 95 % bars)", title)
    ax.grid(False, axis="x")
    ax.grid(axis="x", which="minor")  # between the noises
    return ax


def plot_seconds(ax: Axes, rows: tuple[dict, ...]) -> Axes:
    """The time of a run of each method at the least noise; the title names the slowest."""
    first = {name: own[0] for name, own in _by_method(rows).items()}
    for k, (name, row) in enumerate(first.items()):
        ax.plot(row["seconds"], k, **_mark(name))
    ax.set(xscale="log", ylim=(len(first) - 0.5, -0.5))
    ax.xaxis.set_major_formatter("{x:g}")
    ax.set_yticks(range(len(first)), list(first))
    slowest = max(first, key=lambda name: first[name]["seconds"])
    noise, title = rows[0]["noise"], f"the slowest, {slowest}, takes {first[slowest]['seconds']:.1f} s"
    return label_axes(ax, f"median run at noise {noise:g} (s, log scale)", "method (name)", title)


def _mark(name: str) -> dict:
    return method_style(name) | {"linestyle": "none", "linewidth": 2.0, "zorder": 2.0, "markersize": 8}


def _by_method(rows: tuple[dict, ...]) -> dict[str, list[dict]]:
    return {name: [row for row in rows if row["method"] == name] for name in dict.fromkeys(r["method"] for r in rows)}
