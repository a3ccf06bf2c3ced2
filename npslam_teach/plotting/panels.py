"""Several maps in one figure, or one after another: iterations and methods side by side, and the animation."""

import numpy as np
from matplotlib.figure import Figure

from npslam_teach.plotting.export import gif_bytes
from npslam_teach.plotting.maps import how_many, laid_over_truth, map_handles, name_of, names_of_classes, plot_snapshot
from npslam_teach.plotting.style import label_map, legend_below, legend_inside, new_figure
from npslam_teach.types import GroundTruth, RobotLog, Snapshot

MAX_PANELS = 6
SECONDS_PER_ITERATION, SECONDS_ON_THE_LAST = 1.2, 2.5


def plot_iterations(snapshots, log: RobotLog, truth: GroundTruth | None = None, class_names=None) -> Figure:
    """Frame by frame and the iterations after it, side by side (deck figure 16).

    Args:
        snapshots: of one run; of more than six, the first five and the last are drawn.
        log: what they were made from.
        truth: drawn behind when given.
        class_names: (C,).
    """
    snapshots = _at_least_one("snapshots", snapshots)
    if len(snapshots) > MAX_PANELS:
        snapshots = snapshots[: MAX_PANELS - 1] + snapshots[-1:]
    titles = [f"{name_of(snapshot)}\n{how_many(snapshot)}" for snapshot in snapshots]
    cols = {1: 1, 2: 2, 4: 2}.get(len(snapshots), 3)
    return _panels(snapshots, titles, cols, log, truth, class_names)


def plot_methods(
    last_snapshots: dict[str, Snapshot], log: RobotLog, truth: GroundTruth | None = None, class_names=None
) -> Figure:
    """The results of several methods side by side (deck figure 17).

    Args:
        last_snapshots: the last snapshot of each method, by its name.
        log: what they were made from.
        truth: drawn behind when given.
        class_names: (C,).
    """
    snapshots = _at_least_one("last_snapshots", last_snapshots.values())
    titles = [f"{name}: {how_many(snapshot)}" for name, snapshot in last_snapshots.items()]
    cols = 2 if len(titles) in (2, 4) else min(len(titles), 3)
    return _panels(snapshots, titles, cols, log, truth, class_names)


def _at_least_one(name: str, snapshots) -> list:
    snapshots = list(snapshots)
    if not snapshots:
        raise ValueError(f"{name}: expected at least one snapshot, got none")
    return snapshots


def _panels(snapshots: list, titles: list, cols: int, log, truth, class_names) -> Figure:
    """A map for every snapshot, all of one scale, and one legend below."""
    rows = -(-len(snapshots) // cols)
    height = 3.4 * _height_over_width(*_extent(snapshots, truth)) + 0.25 * (1 + titles[0].count("\n"))
    size = (0.6 + 3.4 * cols, 1.2 + height * rows)
    figure, axes = new_figure(rows, cols, size, sharex=True, sharey=True, squeeze=False)
    for k, (ax, snapshot, title) in enumerate(zip(axes.flat, snapshots, titles, strict=False)):
        plot_snapshot(ax, snapshot, log, truth, class_names, legend=False)
        label_map(ax, title)
        # Labels on the outer panels only; "outer" includes those above a free place in the last row.
        is_lowest, is_leftmost = k + cols >= len(snapshots), k % cols == 0
        ax.set(xlabel="x (m)" if is_lowest else "", ylabel="y (m)" if is_leftmost else "")
        ax.tick_params(labelbottom=is_lowest, labelleft=is_leftmost)
    handles = map_handles(snapshots, truth, names_of_classes(log, truth, class_names))
    spare = axes.flat[len(snapshots) :]
    for ax in spare:
        ax.set_axis_off()
    return legend_inside(spare[-1], handles).figure if len(spare) else legend_below(figure, handles)


def animate(snapshots, log: RobotLog, truth: GroundTruth | None = None, class_names=None) -> bytes:
    """The iterations of a run one after another, as an animated GIF that starts over at its end.

    Every frame shows the same square metres, so that what moves is the estimate.

    Args:
        snapshots: of one run, frame by frame first.
        log: what they were made from.
        truth: drawn behind when given.
        class_names: (C,).

    Returns:
        the file; ``show_animation`` puts it in a notebook.
    """
    snapshots = _at_least_one("snapshots", snapshots)
    low, high = _extent(snapshots, truth)
    handles = map_handles(snapshots, truth, names_of_classes(log, truth, class_names))
    figures = []
    for snapshot in snapshots:
        figure, ax = new_figure(1, 1, (6.8, 5.6 * _height_over_width(low, high) + 2.0))
        plot_snapshot(ax, snapshot, log, truth, class_names, legend=False)
        ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
        ax.set_title(f"{name_of(snapshot)}\n{how_many(snapshot)}", fontsize=24)
        figures.append(legend_below(figure, handles))
    seconds = [SECONDS_PER_ITERATION] * (len(snapshots) - 1) + [SECONDS_ON_THE_LAST]
    return gif_bytes(figures, [int(1000 * s) for s in seconds])


def _extent(snapshots: list, truth: GroundTruth | None) -> tuple[np.ndarray, np.ndarray]:
    """The corners (2,) m of a box around everything that is drawn, with a margin."""
    points = [xy[:, :2] for snapshot in snapshots for xy in laid_over_truth(snapshot, truth)]
    points = np.concatenate(points + ([truth.poses[:, :2], truth.world.object_xy] if truth else []))
    low, high = np.nanmin(points, axis=0), np.nanmax(points, axis=0)
    margin = 0.05 * (high - low).max() + 0.1
    return low - margin, high + margin


def _height_over_width(low: np.ndarray, high: np.ndarray) -> float:
    """The shape of a map, kept within what fits on a page."""
    width, height = high - low
    return float(np.clip(height / width, 0.4, 1.6))
