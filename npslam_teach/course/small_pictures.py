"""Small pictures that several lessons share: bars, dots in columns, and curves, each with one message in its title."""

import numpy as np
from matplotlib.figure import Figure

from npslam_teach.plotting.style import (
    CLASS_COLORS,
    CLASS_MARKERS,
    ESTIMATE_COLOR,
    TRUTH_LINE,
    label_axes,
    legend_beside,
    new_figure,
)


def bars_figure(values: dict[str, float], labels: tuple[str, str], title: str, line=None) -> Figure:
    """A bar for each name, with its number above, on a linear axis: on any other its length says nothing.

    Args:
        values: by name, in their order.
        labels: of both axes, with their units.
        title: what the picture says.
        line: (value, name) of a dashed line across.
    """
    figure, ax = new_figure(size=(7.5, 3.4))
    ax.bar(list(values), list(values.values()), 0.55, color=CLASS_COLORS[0], edgecolor=ESTIMATE_COLOR, linewidth=0.6)
    for k, value in enumerate(values.values()):
        above = value >= 0
        place = {"textcoords": "offset points", "ha": "center", "va": "bottom" if above else "top"}
        ax.annotate(
            f"{value:.3g}" if abs(value) < 1000 else f"{value:.0f}", (k, value), (0, 3 if above else -3), **place
        )
    if line is not None:
        ax.axhline(line[0], label=line[1], **TRUTH_LINE)
        legend_beside(ax)
    ax.margins(y=0.15)
    ax.grid(False, axis="x")
    return label_axes(ax, *labels, title).figure


def dots_figure(groups: dict[str, list], labels: tuple[str, str], title: str, line=None) -> Figure:
    """A column of dots for each name, side by side where they are alike.

    Args:
        groups: by name, the values.
        labels: of both axes, with their units.
        title: what the picture says.
        line: (value, name) of a dashed line across.
    """
    figure, ax = new_figure(size=(7.5, 3.4))
    for k, values in enumerate(groups.values()):
        values = np.sort(np.asarray(values, dtype=float))
        before = np.array([np.sum(values[:i] == value) for i, value in enumerate(values)])
        alike = np.array([np.sum(values == value) for value in values])
        x = k + min(0.09, 1.0 / alike.max()) * (before - (alike - 1) / 2)
        ax.plot(x, values, CLASS_MARKERS[0], markersize=9, color=CLASS_COLORS[0], mec=ESTIMATE_COLOR)
    if line is not None:
        ax.axhline(line[0], label=line[1], **TRUTH_LINE | {"zorder": 1})
        legend_beside(ax)
    ax.set_xticks(range(len(groups)), list(groups))
    ax.set_xlim(-0.6, len(groups) - 0.4)
    ax.margins(y=0.15)
    ax.grid(False, axis="x")
    return label_axes(ax, *labels, title).figure


def curves_figure(
    x, curves: dict[str, np.ndarray], labels: tuple[str, str], title: str, line=None, log: bool = False
) -> Figure:
    """Curves over one axis, each with a colour and a marker of its own.

    Args:
        x: (N,) of the points.
        curves: by name, (N,) values.
        labels: of both axes, with their units.
        title: what the picture says.
        line: (value, name) of a dashed line across.
        log: whether the axis of values is logarithmic.
    """
    figure, ax = new_figure(size=(7.5, 3.4))
    every = max(1, len(x) // 12)
    for k, (name, values) in enumerate(curves.items()):
        ax.plot(x, values, marker=CLASS_MARKERS[k], markevery=every, color=CLASS_COLORS[k], linewidth=2.0, label=name)
    if line is not None:
        ax.axhline(line[0], label=line[1], **TRUTH_LINE)
    if log:
        ax.set_yscale("log")
    if len(curves) > 1 or line is not None:
        legend_beside(ax)
    return label_axes(ax, *labels, title).figure
