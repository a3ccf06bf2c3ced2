"""Pictures of lesson 07: the results of many rooms, and of every pair of settings."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from npslam_teach.course.small_pictures import dots_figure
from npslam_teach.plotting.style import (
    CLASS_COLORS,
    TEXT_SIZE,
    class_style,
    label_axes,
    label_map,
    legend_beside,
    new_figure,
)

LINES = ("-", "--", "-.", ":")


def plot_rooms(ax: Axes, found, errors, num_objects_true: int = 15) -> Axes:
    """The error of the path against the number of objects found, one point for each room.

    Args:
        ax: any axes.
        found: (N,) numbers of objects.
        errors: (N,) m, mean pose errors.
        num_objects_true: rooms with this number of objects are marked.
    """
    found, errors = np.asarray(found), np.asarray(errors)
    exact = found == num_objects_true
    for k, (chosen, name) in enumerate([(exact, f"found {num_objects_true}"), (~exact, "found another number")]):
        color, marker = class_style(k)
        style = {"color": color, "markeredgecolor": "black", "alpha": 0.7}
        ax.plot(found[chosen], errors[chosen], marker, markersize=8, label=name, **style)
    ax.xaxis.set_major_locator(MaxNLocator(integer=True))
    ax.set_ylim(bottom=0.0)
    legend_beside(ax)
    title = f"{exact.sum()} of {len(found)} rooms find {num_objects_true}"
    if 0 < exact.sum() < len(found):
        title += f"\nmedian error {np.median(errors[exact]):.2f} m there, {np.median(errors[~exact]):.2f} m elsewhere"
    return label_axes(ax, "objects found (number)", "mean pose error (m)", title)


def plot_settings(ax: Axes, counts: np.ndarray, alphas, thresholds, num_objects_true: int = 15) -> Axes:
    """Heat map over alpha and threshold: the median number of objects, and in how many rooms it was right.

    Args:
        ax: any axes.
        counts: (A, P, N) objects found for each alpha, each threshold and each room.
        alphas: (A,).
        thresholds: (P,); None stands for "the most probable wins".
        num_objects_true: the right number.
    """
    medians, right = np.median(counts, axis=2), np.count_nonzero(counts == num_objects_true, axis=2)
    # Light where the number is small: dark text on it, white text on the dark cells.
    image = ax.imshow(medians, cmap="YlGnBu", norm=LogNorm(5, 1500), aspect="auto", origin="lower")
    for (a, p), median in np.ndenumerate(medians):
        color = "white" if median > 240 else "black"
        text = f"{median:.0f}\n{right[a, p]} of {counts.shape[2]}"
        weight = "bold" if right[a, p] == counts.shape[2] else "normal"
        ax.text(p, a, text, ha="center", va="center", color=color, fontsize=TEXT_SIZE["tick"], fontweight=weight)
    label_axes(ax, "threshold (probability)", "alpha (weight of a new object, in votes)")
    ax.set_xticks(range(len(thresholds)), ["most probable\nwins" if p is None else f"{p:g}" for p in thresholds])
    ax.set_yticks(range(len(alphas)), [f"{a:g}" for a in alphas])
    ax.grid(False)
    ax.set_title("median number of objects, and rooms with the right number", fontsize=TEXT_SIZE["title"])
    bar = ax.figure.colorbar(image, ax=ax)
    bar.set_label("objects (number, log scale)", fontsize=TEXT_SIZE["label"])
    bar.ax.tick_params(which="both", labelsize=TEXT_SIZE["tick"])
    return ax


def plot_robust_kernels(ax: Axes, residual: np.ndarray, costs: dict[str, np.ndarray]) -> Axes:
    """What a residual costs under several robust kernels, and in the title what the largest one costs.

    Args:
        ax: any axes.
        residual: (N,) in standard deviations.
        costs: by the name of a kernel: (N,).
    """
    for k, (name, cost) in enumerate(costs.items()):
        ax.plot(residual, cost, LINES[k % 4], color=CLASS_COLORS[k], linewidth=2.2, label=name)
    largest = np.argmax(residual)
    prices = ", ".join(f"{cost[largest]:.2g}" for cost in costs.values())
    legend_beside(ax)
    return label_axes(
        ax, "residual (standard deviations)", "cost (no unit)", f"an error of {residual[largest]:g} costs {prices}"
    )


def split_figure(seen_at: np.ndarray, halves: dict[str, np.ndarray]) -> Figure:
    """The sightings of one object, split in two in several ways.

    Args:
        seen_at: (M, 2) m, where they lie.
        halves: by the way, (M,) 0 or 1.
    """
    figure, axes = new_figure(1, len(halves), (9.5, 4.0), sharex=True, sharey=True)
    for ax, (name, half) in zip(axes, halves.items(), strict=True):
        for k in (0, 1):
            color, marker = class_style(k)
            ax.plot(*seen_at[half == k].T, marker, linestyle="none", color=color, markersize=6, alpha=0.8)
        label_map(ax, f"split by {name}")
    return figure


def noise_figure(found: dict[float, list[int]]) -> Figure:
    """The number of objects found in several rooms, by the noise."""
    labels, line = ("a dot for each room", "objects found (number)"), (15, "true number: 15")
    groups = {f"noise {noise:g}": counts for noise, counts in found.items()}
    return dots_figure(groups, labels, "more noise, more objects", line)
