"""Curves: over iterations, along the path, and over methods."""

from collections.abc import Iterable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from npslam_teach.evaluation import distances_to_truth
from npslam_teach.plotting.style import (
    ESTIMATE_COLOR,
    TEXT_SIZE,
    TRUTH_LINE,
    label_axes,
    legend_beside,
    method_style,
)
from npslam_teach.types import GroundTruth, Snapshot


def plot_object_counts(ax: Axes, snapshots: Iterable[Snapshot], num_objects_true: int | None = None) -> Axes:
    """The number of objects in every iteration, each written at its point (deck figures 15 and 16).

    Args:
        ax: any axes.
        snapshots: of one run, frame by frame first.
        num_objects_true: dashed grey when given.
    """
    snapshots = list(snapshots)
    counts = [snapshot.num_objects for snapshot in snapshots]
    if num_objects_true is not None:
        ax.axhline(num_objects_true, label=f"true number: {num_objects_true}", **TRUTH_LINE)
        ax.legend(loc="upper right", frameon=False, fontsize=TEXT_SIZE["legend"])
    _plot_over_iterations(ax, snapshots, counts)
    for snapshot, count in zip(snapshots, counts, strict=True):
        # Above and to the right: a falling curve leaves this side free.
        ax.annotate(
            str(count),
            (snapshot.iteration, count),
            (5, 6),
            textcoords="offset points",
            fontsize=TEXT_SIZE["label"],
        )
    ax.set_yscale("log", nonpositive="mask")
    ax.margins(x=0.12, y=0.15)
    return label_axes(ax, "iteration (number)", "objects (number, log scale)", "objects per iteration")


def plot_objective(ax: Axes, snapshots: Iterable[Snapshot]) -> Axes:
    """The objective of every iteration, the number that the method descends on.

    Args:
        ax: any axes.
        snapshots: of one run.
    """
    snapshots = list(snapshots)
    _plot_over_iterations(ax, snapshots, [snapshot.objective for snapshot in snapshots])
    return label_axes(ax, "iteration (number)", "objective (nats)", "objective per iteration")


def _plot_over_iterations(ax: Axes, snapshots: list, values: list) -> None:
    style = {"color": ESTIMATE_COLOR, "linestyle": "-", "linewidth": 1.8, "marker": "o", "markersize": 7}
    ax.plot([snapshot.iteration for snapshot in snapshots], values, **style)
    ax.xaxis.set_major_locator(MaxNLocator(integer=True))


def plot_cumulative_error(ax: Axes, last_snapshots: dict[str, Snapshot], truth: GroundTruth) -> Axes:
    """The error of the trajectory added up along the path, one curve per method (deck figure 17, paper figure 6).

    Args:
        ax: any axes.
        last_snapshots: the last snapshot of each method, by its name.
        truth: what really happened.
    """
    for k, (name, snapshot) in enumerate(last_snapshots.items()):
        # A logarithmic axis has no zero: a nanometre stands for a path without error.
        cumulative = np.maximum(np.cumsum(distances_to_truth(snapshot, truth)[0]), 1e-9)
        # Markers at different places, so that no curve hides those of another.
        spacing = max(len(cumulative) // 8, 1)
        offset = k * spacing // max(len(last_snapshots), 1)
        markers = {"markevery": (offset, spacing), "markersize": 8, "markeredgecolor": "white"}
        ax.plot(cumulative, label=name, **markers, **method_style(name))
    ax.set_yscale("log")
    legend_beside(ax)
    return label_axes(ax, "pose t (index)", "cumulative trajectory error (m, log scale)", "trajectory")


def plot_error_against_objects(ax: Axes, last_snapshots: dict[str, Snapshot], truth: GroundTruth) -> Axes:
    """How far objects lie from the truth over how many there are, one point per method (deck figure 17).

    A method that left out every observation has no such error, and no point.

    Args:
        ax: any axes.
        last_snapshots: the last snapshot of each method, by its name.
        truth: what really happened.
    """
    num_true = len(np.unique(truth.obs_object[truth.obs_object >= 0]))
    ax.axvline(num_true, label=f"true number: {num_true}", **TRUTH_LINE)
    for name, snapshot in last_snapshots.items():
        errors = distances_to_truth(snapshot, truth)[1]
        style = {key: method_style(name)[key] for key in ("color", "marker")}
        if errors.size:
            ax.plot(snapshot.num_objects, errors.mean(), linestyle="none", markersize=11, label=name, **style)
    ax.set_xscale("log")
    ax.margins(x=0.1, y=0.1)
    ax.set_ylim(bottom=0.0)
    legend_beside(ax)
    return label_axes(ax, "objects found (number, log scale)", "mean object error (m)", "objects")
