"""Draw your own world: a world beside the same world without its defect, and how far a path is bent.

What the gallery holds, and what one number a run shows, is in ``overviews``.
"""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from npslam_teach.course.draw_your_own_world.messages import SolvedWorld, num_seen
from npslam_teach.plotting.maps import laid_over_truth, map_handles, plot_snapshot
from npslam_teach.plotting.style import (
    CLASS_COLORS,
    ESTIMATE_LINE,
    TRUTH_LINE,
    class_style,
    label_axes,
    label_map,
    legend_below,
    legend_beside,
    new_figure,
)

_EDGE = 0.8  # m around the room's objects, so that no marker stands on the frame
_WIDE = 2.0  # a room that is wider than this many times its height is drawn above its pair, not beside it


def pair_figure(solved: SolvedWorld, cured: SolvedWorld, titles: tuple[str, str]) -> Figure:
    """Two solved worlds with one scale: side by side, or one above the other where the room is long.

    A long room has a third panel: how far the path is off to the side, stretched, for on a map a bend of decimetres
    over tens of metres cannot be seen.

    Args:
        solved: the world with the defect.
        cured: the same world without it.
        titles: of the two maps.
    """
    limits = _limits(solved, cured)
    is_long = np.ptp(limits[0]) > _WIDE * np.ptp(limits[1])
    rows, cols, size = (3, 1, (12.0, 9.0)) if is_long else (1, 2, (13.0, 5.4))
    figure, axes = new_figure(rows, cols, size)
    for ax, world, title in zip(axes, (solved, cured), titles, strict=False):
        last = world.snapshots[-1]
        plot_snapshot(ax, last, world.log, world.truth, legend=False)
        count = f"{last.num_objects} objects, {num_seen(world)} are there"
        label_map(ax, f"{title}: {count}").set(xlim=limits[0], ylim=limits[1])
    if is_long:
        _plot_bend(axes[2], solved).set_xlim(limits[0])
    handles = map_handles([solved.snapshots[-1]], solved.truth, solved.truth.world.class_names)
    legend_below(figure, handles, columns=9)
    return figure


def tremor_figure(drawn: np.ndarray, smooth: np.ndarray) -> Figure:
    """A line as a hand draws it, and averaged along its length; the height is stretched.

    Args:
        drawn: (N, 2) m.
        smooth: (M,) m, averaged heights, of the points in the middle of ``drawn``.
    """
    figure, ax = new_figure(size=(9.0, 3.6))
    cut = (len(drawn) - len(smooth)) // 2
    ax.plot(*drawn.T, color=CLASS_COLORS[5], linewidth=1.0, label="drawn")
    ax.plot(drawn[cut : cut + len(smooth), 0], smooth, label="averaged", **ESTIMATE_LINE | {"linewidth": 2.5})
    legend_beside(ax)
    title = f"a tremor of {100 * drawn[:, 1].std():.1f} cm becomes {100 * smooth.std():.1f} cm"
    label_axes(ax, "x (m)", "y (m), stretched", title)
    return figure


def headings_figure(drawn: np.ndarray, path: np.ndarray) -> Figure:
    """Which way a line leads from point to point, and which way the robot looks that follows it.

    Args:
        drawn: (N, 2) m, by hand.
        path: (T, 3) m, m, rad, the poses on it.
    """
    figure, ax = new_figure(size=(9.0, 3.6))
    steps = np.diff(drawn, axis=0)
    raw, looks = np.rad2deg(np.arctan2(steps[:, 1], steps[:, 0])), np.rad2deg(path[:, 2])
    ax.plot(drawn[:-1, 0], raw, color=CLASS_COLORS[5], linewidth=1.0, label="line as drawn")
    ax.plot(path[:, 0], looks, label="robot", **ESTIMATE_LINE | {"linewidth": 2.5})
    legend_beside(ax)
    turns = [np.std(np.diff(each)) for each in (raw, looks)]
    title = f"the hand turns by {turns[0]:.0f} degrees at each point, the robot by {turns[1]:.0f}"
    label_axes(ax, "x (m)", "heading (degrees)", title)
    return figure


def alarms_figure(alarms: dict, limit: float = 3.0) -> Figure:
    """What each world's runs say of themselves: how far chi2 is too high, and how many objects were seen once.

    Args:
        alarms: by title: (2, N), chi2 in standard deviations above 1 and lone objects, of every run.
        limit: of chi2, dashed.
    """
    figure, axes = new_figure(1, 2, (13.0, 4.4), sharey=True)
    for k, values in enumerate(alarms.values()):
        for ax, own in zip(axes, values, strict=True):
            color, marker = class_style(k)
            ax.plot(own, k + 0.2 * np.linspace(-1, 1, len(own)), marker, color=color, markeredgecolor="0.3")
    axes[0].axvline(limit, **TRUTH_LINE)
    axes[0].set_yticks(range(len(alarms)), list(alarms))
    axes[0].set_ylim(len(alarms) - 0.5, -0.5)
    silent = [title for title, (high, lone) in alarms.items() if max(high) <= limit and np.median(lone) == 0]
    label_axes(axes[0], "chi2 too high (st. deviations); dashed: alarm", "", "silent: " + ", ".join(silent))
    label_axes(axes[1], "objects seen once (number)", "", "false sightings are seen once")
    return figure


def _limits(*worlds: SolvedWorld) -> tuple[tuple, tuple]:
    """Left and right, bottom and top, around all that is drawn, in m."""
    points = [each.truth.world.object_xy for each in worlds] + [each.truth.poses[:, :2] for each in worlds]
    points += [xy[:, :2] for each in worlds for xy in laid_over_truth(each.snapshots[-1], each.truth)]
    points = np.concatenate(points)
    low, high = points.min(axis=0) - _EDGE, points.max(axis=0) + _EDGE
    return (low[0], high[0]), (low[1], high[1])


def _plot_bend(ax: Axes, world: SolvedWorld) -> Axes:
    poses, _ = laid_over_truth(world.snapshots[-1], world.truth)
    true = world.truth.poses
    ax.plot(true[:, 0], np.zeros(len(true)), **TRUTH_LINE)
    ax.plot(true[:, 0], poses[:, 1] - true[:, 1], **ESTIMATE_LINE)
    return label_axes(ax, "x (m)", "off to the left (m)", "the first path, stretched sideways")
