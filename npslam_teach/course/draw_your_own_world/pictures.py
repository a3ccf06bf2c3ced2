"""Draw your own world: a world beside the same world without its defect, and how far a path is bent."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from npslam_teach.course.draw_your_own_world.messages import SolvedWorld
from npslam_teach.plotting.maps import laid_over_truth, map_handles, plot_snapshot
from npslam_teach.plotting.style import (
    ESTIMATE_LINE,
    TRUTH_LINE,
    label_axes,
    label_map,
    legend_below,
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
        label_map(ax, f"{title}: {last.num_objects} objects").set(xlim=limits[0], ylim=limits[1])
    if is_long:
        _plot_bend(axes[2], solved).set_xlim(limits[0])
    handles = map_handles([solved.snapshots[-1]], solved.truth, solved.truth.world.class_names)
    legend_below(figure, handles, columns=9)
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
