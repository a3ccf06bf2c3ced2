"""Pictures of lesson 04: which object is it? Bars of weights and probabilities, the restaurant, the cliff at alpha = 1.

Objects have the colour of their class, "new" is hatched grey. ``Obj_1`` is the name of index 0, as in the deck.
"""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from npslam_teach.plotting.maps import plot_objects, plot_trajectory
from npslam_teach.plotting.style import (
    ESTIMATE_COLOR,
    TEXT_SIZE,
    TRUTH_LINE,
    class_handles,
    class_style,
    label_axes,
    legend_below,
    legend_beside,
    new_figure,
    path_handles,
)

NEW = {"facecolor": "#d9d9d9", "hatch": "///", "edgecolor": ESTIMATE_COLOR}
LEVEL_COLOR = "#712553"
ON_WHITE = {"facecolor": "white", "edgecolor": "none", "pad": 0.8}  # for numbers that lie on a line
CURVE_STYLES = ("-", "-.", ":")  # beside the colour, so that curves differ on a grey printer too


def sighting_names(obs_class: np.ndarray, class_names) -> list[str]:
    """What to write under the bar of each observation: ``Obj_1`` and its class, one above the other."""
    return [f"Obj_{k + 1}\n{class_names[c]}" for k, c in enumerate(obs_class)]


def plot_sightings(ax: Axes, poses: np.ndarray, xy: np.ndarray, obs_class, class_names, asks: int) -> Axes:
    """Map of the observations along the odometry path, and the distances from one to all others of its class.

    Args:
        ax: a map.
        poses: (T, 3) W, from the odometry.
        xy: (M, 2) m, W: each observation carried into the room.
        obs_class: (M,).
        class_names: (C,).
        asks: index of the observation whose distances are drawn.
    """
    plot_trajectory(ax, poses)
    alike = [k for k in np.flatnonzero(np.asarray(obs_class) == obs_class[asks]) if k != asks]
    for rank, k in enumerate(sorted(alike, key=lambda k: np.linalg.norm(xy[k] - xy[asks]))):
        _draw_distance(ax, xy[asks], xy[k], bend=0.3 + 0.13 * rank)
    plot_objects(ax, xy, obs_class, class_names, sizes=np.where(np.arange(len(xy)) == asks, 190.0, 90.0))
    for k, point in enumerate(xy):
        weight = "bold" if k == asks else "normal"
        style = {"ha": "right", "va": "center", "fontsize": TEXT_SIZE["label"], "fontweight": weight}
        ax.annotate(f"Obj_{k + 1}", point, (-11, 0), textcoords="offset points", **style)
    # Below, because the map needs the width.
    legend_below(ax.figure, class_handles(np.unique(obs_class), class_names) + path_handles(("estimated path",)))
    return ax


def _draw_distance(ax: Axes, start: np.ndarray, end: np.ndarray, bend: float) -> None:
    """An arc from one point to another, bent to the right, with the distance written at its outermost point."""
    across = end - start
    side = np.array([across[1], -across[0]])
    side = side if side[0] >= 0 else -side
    t = np.linspace(0.0, 1.0, 30)[:, None]
    bow = start + t * across + 4 * t * (1 - t) * bend * side
    ax.plot(*bow.T, color="0.45", linewidth=1.2, zorder=1.8)
    text = f"{np.linalg.norm(across):.1f} m"
    where = {"textcoords": "offset points", "va": "center", "fontsize": TEXT_SIZE["legend"], "color": "0.25"}
    ax.annotate(text, bow[15], (3, 0), bbox=ON_WHITE, **where)


def plot_bars(ax: Axes, values: np.ndarray, names: list[str], bar_class: list, label: str, title: str) -> Axes:
    """A bar with its value on top for every object, and a hatched one for "new" (deck figures 6 to 8).

    Args:
        ax: any axes.
        values: (N,) weights or probabilities; NaN is the observation that asks, which has no bar.
        names: (N,) under the bars.
        bar_class: (N,) class index of each bar, None for "new".
        label: of the y axis, with its unit.
        title: of the plot.
    """
    bars = ax.bar(np.arange(len(values)), np.zeros(len(values)), width=0.72, linewidth=0.8)
    for bar, c in zip(bars, bar_class, strict=True):
        bar.set(**(NEW if c is None else {"facecolor": class_style(c)[0], "edgecolor": ESTIMATE_COLOR}))
        style = {"ha": "center", "va": "bottom", "fontsize": TEXT_SIZE["tick"], "bbox": ON_WHITE, "zorder": 4}
        middle = bar.get_x() + bar.get_width() / 2
        ax.annotate("", (middle, 0.0), (0, 3), textcoords="offset points", **style)
    set_bars(ax, values)
    ax.set_ylim(0.0, 1.18 * max(np.nanmax(values), 0.05))
    label_axes(ax, "", label, title)
    ax.set_xticks(np.arange(len(names)), names, fontsize=TEXT_SIZE["tick"])
    ax.grid(False, axis="x")
    return ax


def set_bars(ax: Axes, values: np.ndarray) -> None:
    """Move the bars that ``plot_bars`` drew, and the numbers on them."""
    for bar, text, value in zip(ax.containers[0], ax.texts, values, strict=False):
        height = 0.0 if np.isnan(value) else float(value)
        bar.set_height(height)
        text.xy = (text.xy[0], height)
        # A weight of 0.004 is written as 0.00, and exactly zero as 0.
        text.set_text("itself" if np.isnan(value) else "0" if height == 0 else f"{height:.2f}")


def plot_bar_panels(panels: dict, names: list[str], bar_class: list, thresholds=()) -> Figure:
    """Bars of probabilities side by side, on one scale (deck figures 7 and 8).

    Args:
        panels: by title: (N,) probabilities of the others, or (N+1,) with "new" at the end.
        names: (N,) under the bars.
        bar_class: (N,) class index of each.
        thresholds: a level for each panel, or none at all.
    """
    width = 13.0 if len(panels) > 1 else 8.0
    figure, axes = new_figure(1, len(panels), (width, 4.2), sharey=True, squeeze=False)
    for ax, (title, values) in zip(axes[0], panels.items(), strict=True):
        with_new = len(values) > len(names)
        label = "probability (no unit)" if ax is axes[0, 0] else ""
        plot_bars(ax, values, names + ["new"] * with_new, list(bar_class) + [None] * with_new, label, title)
    axes[0, 0].set_ylim(0.0, 1.18 * max(np.max(values) for values in panels.values()))
    for ax, threshold in zip(axes[0], thresholds, strict=False):
        plot_threshold(ax, threshold)
    return figure


def plot_threshold(ax: Axes, threshold: float) -> Axes:
    """A dashed level across the bars, named beside them (deck figure 8)."""
    ax.axhline(threshold, color=LEVEL_COLOR, linestyle=(0, (5, 3)), linewidth=2.0, zorder=3)
    style = {"ha": "left", "va": "center", "fontsize": TEXT_SIZE["legend"], "color": LEVEL_COLOR}
    ax.text(1.01, threshold, f"threshold\n{threshold:.2f}", transform=ax.get_yaxis_transform(), **style)
    ax.set_ylim(top=max(ax.get_ylim()[1], 1.18 * threshold))
    return ax


def plot_tables(ax: Axes, tables: dict[float, np.ndarray], expected: dict[float, np.ndarray]) -> Axes:
    """How many tables are open after each guest: the mean over evenings, the range of 8 in 10, and the expectation.

    Args:
        ax: any axes.
        tables: by alpha: (E, N), for every evening, the tables open after guest 1, 2, ...
        expected: by alpha: (N,) their expected number by the formula.
    """
    for k, (alpha, counts) in enumerate(tables.items()):
        color, guests = class_style(k)[0], np.arange(1, counts.shape[1] + 1)
        low, high = np.quantile(counts, [0.1, 0.9], axis=0)
        ax.fill_between(guests, low, high, color=color, alpha=0.18, linewidth=0)
        style = CURVE_STYLES[k % len(CURVE_STYLES)]
        ax.plot(guests, counts.mean(axis=0), color=color, linestyle=style, linewidth=2.4, label=f"alpha {alpha:g}")
        ax.plot(guests, expected[alpha], **TRUTH_LINE | {"zorder": 3})
    handles = ax.get_legend_handles_labels()[0][::-1]
    legend_beside(ax, handles + [Line2D([], [], label="by the formula", **TRUTH_LINE)])
    return label_axes(
        ax,
        "guests (number)",
        "tables (number)",
        "tables grow like the logarithm of the guests (band: 8 evenings in 10)",
    )


def plot_cliff(ax: Axes, alphas, counts: np.ndarray, num_objects_true: int) -> Axes:
    """The number of objects found for each alpha, a curve for every seed, and the cliff at alpha = 1.

    Args:
        ax: any axes.
        alphas: (A,).
        counts: (S, A) objects found with each seed and alpha.
        num_objects_true: dashed grey.
    """
    for seed, row in enumerate(counts):
        color, marker = class_style(seed)
        # Later curves are thinner and smaller, because rooms with equal results coincide.
        size = {"linewidth": max(4.5 - seed, 1.0), "markersize": max(11.0 - 2 * seed, 4.0)}
        ax.plot(alphas, row, color=color, marker=marker, label=f"room {seed}", **size)
    ax.axhline(num_objects_true, label=f"true number: {num_objects_true}", **TRUTH_LINE)
    ax.axvline(1.0, color=ESTIMATE_COLOR, linestyle=":", linewidth=1.6, label="alpha = 1")
    ax.set_yscale("log")
    ax.xaxis.set_major_locator(MaxNLocator(8))
    legend_beside(ax)
    return label_axes(
        ax,
        "alpha (a weight, no unit)",
        "objects found (number, log scale)",
        "level up to 0.99; from 1 on nothing joins",
    )


def plot_new_objects(ax: Axes, known: list, expected: np.ndarray) -> Axes:
    """How many different objects the first 1, 2, ... observations are of, and how many tables a restaurant expects.

    Args:
        ax: any axes.
        known: for every room, (M,) objects among the first observations.
        expected: (M,) tables for as many guests.
    """
    for seed, counts in enumerate(known):
        line = (0, (6, 1.5 * seed)) if seed else "-"  # beside the colour, for a grey printer
        style = {"color": class_style(seed)[0], "linestyle": line, "linewidth": 2.0}
        ax.step(np.arange(1, len(counts) + 1), counts, where="post", label=f"room {seed}", **style)
    ax.plot(np.arange(1, len(expected) + 1), expected, label="a restaurant expects", **TRUTH_LINE)
    legend_beside(ax)
    ax.yaxis.set_major_locator(MaxNLocator(integer=True))
    title = "the number of objects comes to rest; the restaurant's never does"
    return label_axes(ax, "sightings (number)", "objects or tables (number)", title)
