"""How many objects are found: by the error that is taken away, and in each of twenty rooms."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from npslam_teach.course.small_pictures import bars_figure, curves_figure
from npslam_teach.plotting.style import (
    ESTIMATE_COLOR,
    TEXT_SIZE,
    TRUTH_LINE,
    class_style,
    label_axes,
    legend_beside,
    new_figure,
)


def causes_figure(counts: dict[str, list[int]], thresholds, num_objects_true: int = 15) -> Figure:
    """The objects that a front end finds, a group of points for each threshold.

    Args:
        counts: by what is exact, the number of objects for each threshold.
        thresholds: of the likeness.
        num_objects_true: dashed.
    """
    figure, ax = new_figure(size=(10.0, 4.4))
    at = np.arange(len(thresholds))
    for k, (name, heights) in enumerate(counts.items()):
        x = at + 0.2 * (k - (len(counts) - 1) / 2)
        color, marker = class_style(k)
        # Points and no bars: on a logarithmic axis the length of a bar says nothing.
        ax.plot(x, heights, marker, color=color, markersize=10, markeredgecolor=ESTIMATE_COLOR, label=name)
        for left, height in zip(x, heights, strict=True):
            ax.annotate(f"{height}", (left, height), (0, 8), textcoords="offset points", ha="center")
    ax.axhline(num_objects_true, label=f"true number: {num_objects_true}", **TRUTH_LINE)
    ax.set_yscale("log")
    ax.set(ylim=(10, 400), xticks=at)
    ax.set_xticklabels([f"{threshold:g}" for threshold in thresholds])
    ax.grid(False, axis="x")
    legend_beside(ax)
    title = "either error alone splits objects"
    return label_axes(ax, "threshold (likeness, no unit)", "objects (number, log scale)", title).figure


def rooms_figure(divided: list[int], in_turns: list[int], num_objects_true: int = 15) -> Figure:
    """The number of objects found in each room by names given once, and by taking turns.

    Args:
        divided: (S,) objects in each room.
        in_turns: (S,) the same, after taking turns.
        num_objects_true: dashed.
    """
    figure, ax = new_figure(size=(10.0, 4.2))
    for k, (name, counts) in enumerate({"divided": divided, "in turns": in_turns}.items()):
        color, marker = class_style(k)
        ax.plot(counts, linestyle="none", marker=marker, markersize=9, color=color, mec=ESTIMATE_COLOR, label=name)
    ax.axhline(num_objects_true, label=f"true number: {num_objects_true}", **TRUTH_LINE | {"zorder": 1})
    ax.xaxis.set_major_locator(MaxNLocator(10, integer=True))
    legend_beside(ax)
    right = [counts.count(num_objects_true) for counts in (divided, in_turns)]
    title = f"divided finds {num_objects_true} in {right[0]} rooms, in turns in {right[1]} of {len(divided)}"
    label_axes(ax, "room (seed)", "objects found (number)")
    ax.set_title(title, fontsize=TEXT_SIZE["title"])
    return figure


def thresholds_figure(found: dict[str, int]) -> Figure:
    """The number of objects that the front end finds, by its threshold."""
    labels, line = ("threshold (likeness, no unit)", "objects found (number)"), (15, "true number: 15")
    return bars_figure(found, labels, "too many at each threshold", line)


def scores_figure(scores: dict[str, float]) -> Figure:
    """How far chi2 is from what is expected, by the threshold of the front end."""
    labels = ("threshold (likeness, no unit)", "chi2 off by (standard deviations)")
    return bars_figure(scores, labels, "only at the highest threshold chi2 shows it", (-3, "three too low: an alarm"))


def partitions_figure(ways: list[int]) -> Figure:
    """How many ways there are to group one, two, three, ... sightings."""
    labels = ("sightings (number)", "ways to group them (log scale)")
    title = "steeper than a straight line: faster than any exponential"
    return curves_figure(range(1, len(ways) + 1), {"ways": np.array(ways)}, labels, title, log=True)


def alarms_figure(ratios: dict[str, float]) -> Figure:
    """Chi2 per degree of freedom, by who named the sightings."""
    labels, line = ("who names the sightings", "chi2 per degree of freedom"), (1, "expected: 1")
    return bars_figure(ratios, labels, "both wrong answers give themselves away", line)
