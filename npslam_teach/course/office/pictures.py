"""Pictures of lesson 08: from a box in an RGB-D frame to an observation, and the office mapped by several methods."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.patheffects import withStroke
from mpl_toolkits.mplot3d import Axes3D

from npslam_teach.camera import centroid_from_box, foreground, on_floor, points_in_box
from npslam_teach.plotting.maps import classes_of, how_many, laid_over_truth, map_handles, names_of_classes
from npslam_teach.plotting.style import (
    ESTIMATE_COLOR,
    ESTIMATE_LINE,
    TEXT_SIZE,
    TRUTH_COLOR,
    TRUTH_LINE,
    class_handles,
    class_style,
    label_axes,
    label_map,
    legend_below,
    legend_beside,
    method_style,
    new_figure,
)
from npslam_teach.types import GroundTruth, RobotLog, Snapshot

# Three estimates of a centre: their markers and colours.
CENTRES = {"mean": ("X", "#d45e00"), "median": ("D", "#38ba8d"), "foreground": ("o", "#00659f")}


def plot_picture(ax: Axes, frame, class_names, chosen: int | None = None) -> Axes:
    """The camera's picture with the detector's boxes, each with the colour and the marker of its class.

    Args:
        ax: any axes.
        frame: an ``RgbdFrame``.
        class_names: (C,).
        chosen: index of a box to draw with a wider line.
    """
    ax.imshow(frame.rgb, interpolation="nearest")
    for k, (box, c) in enumerate(zip(frame.boxes, frame.obs_class, strict=True)):
        color, marker = class_style(c)
        wide = 4.0 if k == chosen else 2.0
        outline = [withStroke(linewidth=wide + 2.0, foreground="white")]
        ax.add_patch(_rectangle(box, edgecolor=color, linewidth=wide, path_effects=outline))
        ax.plot(*(box[:2] + [-0.5, -0.5]), marker=marker, color=color, markersize=9, markeredgecolor="white", zorder=4)
    legend_beside(ax, class_handles(np.unique(frame.obs_class), class_names))
    return _label_pixels(ax, "picture and boxes")


def _label_pixels(ax: Axes, title: str) -> Axes:
    label_axes(ax, "column u (px)", "row v (px)", title).grid(False)  # its lines would look like edges in the picture
    return ax


def _rectangle(box, **looks) -> Rectangle:
    x1, y1, x2, y2 = box
    return Rectangle((x1 - 0.5, y1 - 0.5), x2 - x1, y2 - y1, fill=False, **looks)


def plot_depth(ax: Axes, frame, box=None) -> Axes:
    """The depth image; white where the sensor has no reading.

    Args:
        ax: any axes.
        frame: an ``RgbdFrame``.
        box: (4,) px, drawn when given.
    """
    image = ax.imshow(np.where(frame.depth > 0, frame.depth, np.nan), cmap="cividis_r", interpolation="nearest")
    bar = ax.figure.colorbar(image, ax=ax)
    bar.set_label("depth along the view (m)", fontsize=TEXT_SIZE["label"])
    bar.ax.tick_params(labelsize=TEXT_SIZE["tick"])
    if box is not None:
        outline = [withStroke(linewidth=6.0, foreground="white")]
        ax.add_patch(_rectangle(box, edgecolor=ESTIMATE_COLOR, linewidth=3.0, path_effects=outline))
    return _label_pixels(ax, "depth (white: no reading)")


def plot_box_from_above(ax: Axes, frame, box, true_xy=None) -> Axes:
    """The point cloud of a box, seen from above, with three centres and the true one.

    Args:
        ax: a map in the robot's frame.
        frame: an ``RgbdFrame``.
        box: (4,) px.
        true_xy: (2,) m, ahead and left, drawn when given.
    """
    points = points_in_box(frame.depth, box, frame.intrinsics)
    front, xy = foreground(points), on_floor(points)
    ax.plot(*xy[~front].T, ".", color=TRUTH_COLOR, markersize=3, label="background", zorder=1.5)
    ax.plot(*xy[front].T, ".", color="#4b98dc", markersize=4, label="foreground", zorder=1.8)
    centres, title = {use: centroid_from_box(frame.depth, box, frame.intrinsics, use) for use in CENTRES}, "from above"
    for use, (marker, color) in CENTRES.items():
        looks = {"marker": marker, "color": color, "markersize": 13, "markeredgecolor": "white", "linestyle": "none"}
        ax.plot(*centres[use], label=f"centre: {use}", zorder=3, **looks)
    if true_xy is not None:
        off = [f"{use} off by {np.linalg.norm(centres[use] - true_xy):.2f} m" for use in ("mean", "foreground")]
        title = f"from above: {off[0]},\n{off[1]}"
        ring = {"marker": "o", "markersize": 20, "markerfacecolor": "none", "markeredgecolor": TRUTH_COLOR}
        ax.plot(*true_xy, linestyle="none", markeredgewidth=2, label="true centre", zorder=2.5, **ring)
    label_map(ax, title)
    ax.set(xlabel="ahead (m)", ylabel="left (m)")
    return legend_beside(ax)


def plot_cloud(ax: Axes3D, frame, box, every: int = 3) -> Axes3D:
    """The point cloud of the frame in space, with that of one box on top of it.

    Args:
        ax: axes in space.
        frame: an ``RgbdFrame``.
        box: (4,) px.
        every: one of so many rows and columns is drawn.
    """
    height, width = frame.depth.shape
    thin = np.zeros_like(frame.depth)
    thin[::every, ::every] = frame.depth[::every, ::every]
    # From the camera's right, down, ahead to ahead, left, up.
    everything = points_in_box(thin, (0, 0, width, height), frame.intrinsics)
    inside = points_in_box(frame.depth, box, frame.intrinsics)
    for points, color, size in ((everything, "0.6", 2), (inside, "#4b98dc", 4)):
        ax.scatter(points[:, 2], -points[:, 0], -points[:, 1], c=color, s=size, depthshade=False, linewidths=0)
    ax.set_box_aspect(np.ptp(everything[:, [2, 0, 1]], axis=0), zoom=0.95)
    ax.view_init(elev=30, azim=-140)
    _label_space(ax, ("ahead (m)", "left (m)", "up (m)"), "point cloud: in the box (blue) is more than the chair")
    ax.zaxis.set_rotate_label(False)  # it would stand on its head
    ax.zaxis.label.set_rotation(90)
    return ax


def plot_office_3d(ax: Axes3D, snapshot: Snapshot, log: RobotLog, truth: GroundTruth | None = None) -> Axes3D:
    """A result on the floor of axes with three dimensions, as in the deck (deck figure 19).

    The third axis is free, so each object stands on a stem as high as the number of its observations.

    Args:
        ax: axes in space.
        snapshot: the estimate.
        log: what it was made from.
        truth: when given, the estimate is aligned to it and its path is drawn.
    """
    poses, landmarks = laid_over_truth(snapshot, truth)
    counts, object_class = snapshot.votes[:, 1:].sum(axis=1), classes_of(snapshot)
    if truth is not None:
        ax.plot(*truth.poses[:, :2].T, 0.0, **TRUTH_LINE)
    ax.plot(*poses[:, :2].T, 0.0, **ESTIMATE_LINE)
    for (x, y), count in zip(landmarks, counts, strict=True):
        ax.plot([x, x], [y, y], [0.0, count], color="0.7", linewidth=0.8, zorder=1.5)
    for c in np.unique(object_class):
        color, marker = class_style(c)
        of_class = object_class == c
        looks = {"c": color, "marker": marker, "edgecolors": ESTIMATE_COLOR, "linewidths": 0.5, "depthshade": False}
        ax.scatter(*landmarks[of_class].T, counts[of_class], s=40, **looks)
    return _label_space(ax, ("x (m)", "y (m)", "sightings (number)"), how_many(snapshot))


def _label_space(ax: Axes3D, names: tuple, title: str) -> Axes3D:
    """Name three axes, with their units."""
    for set_label, name in zip((ax.set_xlabel, ax.set_ylabel, ax.set_zlabel), names, strict=True):
        set_label(name, fontsize=TEXT_SIZE["label"], labelpad=8)
    ax.tick_params(labelsize=TEXT_SIZE["tick"])
    ax.locator_params(nbins=4)
    ax.set_title(title, fontsize=TEXT_SIZE["title"])
    return ax


def office_3d_figure(
    snapshots: dict[str, Snapshot], log: RobotLog, truth: GroundTruth | None = None, class_names=None
) -> Figure:
    """Several results in space, side by side (deck figure 19).

    Args:
        snapshots: the result of each method, by its name.
        log: what they were made from.
        truth: see ``plot_office_3d``.
        class_names: (C,); those of the truth when None.
    """
    cols = min(len(snapshots), 2)
    rows = -(-len(snapshots) // cols)
    figure, axes = new_figure(
        rows, cols, (5.6 * cols, 3.9 * rows + 0.9), squeeze=False, subplot_kw={"projection": "3d"}
    )
    drawn = [laid_over_truth(snapshot, truth) for snapshot in snapshots.values()]
    points = np.concatenate([xy[:, :2] for pair in drawn for xy in pair])
    low, high = points.min(axis=0) - 0.2, points.max(axis=0) + 0.2
    highest = max(snapshot.votes[:, 1:].sum(axis=1).max(initial=1.0) for snapshot in snapshots.values())
    for ax in axes.flat[len(snapshots) :]:
        ax.set_axis_off()
    for ax, (name, snapshot) in zip(axes.flat, snapshots.items(), strict=False):
        plot_office_3d(ax, snapshot, log, truth).set_title(f"{name}: {how_many(snapshot)}", fontsize=TEXT_SIZE["title"])
        ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(0, highest))
        # Equal scales along x and y.
        ax.set_box_aspect([*(high - low), 0.55 * (high - low).max()], zoom=1.05)
    # The automatic layout cuts the labels of 3D axes.
    figure.set_layout_engine(None)
    figure.subplots_adjust(
        left=0.02, right=0.96, bottom=0.9 / figure.get_figheight(), top=0.96, wspace=0.06, hspace=0.1
    )
    names = names_of_classes(log, truth, class_names)
    handles = map_handles(list(snapshots.values()), truth, names)
    return legend_below(figure, [handle for handle in handles if handle.get_label() != "true object"], columns=5)


def quality_figure(qualities: dict[str, list], num_true: float | None = None) -> Figure:
    """The paper's three measures, a row for every method and a point for every run (paper section V.B).

    Args:
        qualities: lists of ``evaluation.MapQuality`` by the name of the method.
        num_true: dashed grey when given.
    """
    figure, axes = new_figure(1, 3, (13.0, 3.4), sharey=True)
    measures = {
        "num_valid": ("valid objects (number)", "best near the true number (dashed)"),
        "num_inliers": ("inlier sightings (number)", "more is better"),
        "position_variance": ("variance of positions (m²)", "small alone proves nothing"),
    }
    for ax, (measure, (label, title)) in zip(axes, measures.items(), strict=True):
        for row, (name, runs) in enumerate(qualities.items()):
            values = np.array([getattr(each, measure) for each in runs], dtype=float)
            looks = {key: method_style(name)[key] for key in ("color", "marker")}
            spread = row + 0.24 * np.linspace(-1, 1, len(values))  # on one line equal values would hide each other
            ax.plot(values, spread, linestyle="none", markersize=8, markeredgecolor="white", **looks)
        label_axes(ax, label, "", title)
        ax.set_xlim(left=min(0.0, ax.get_xlim()[0]))
    axes[0].set_yticks(range(len(qualities)), list(qualities))
    axes[0].invert_yaxis()
    if num_true is not None:
        axes[0].axvline(num_true, **TRUTH_LINE)
    return figure


def frame_figure(frame, class_names, chosen: int) -> Figure:
    """Picture and depth side by side, with one box chosen (deck figure 18, first half)."""
    figure, (left, right) = new_figure(1, 2, (12.0, 4.0))
    plot_picture(left, frame, class_names, chosen)
    plot_depth(right, frame, frame.boxes[chosen])
    return figure


def centre_figure(frame, chosen: int, true_xy=None) -> Figure:
    """The point cloud and the centres of one box (deck figure 18, second half)."""
    figure = new_figure(1, 1, (12.5, 4.6))[0]
    figure.clear()
    figure.set_layout_engine(None)
    space = figure.add_axes((0.0, 0.04, 0.42, 0.86), projection="3d")
    plot_cloud(space, frame, frame.boxes[chosen])
    plot_box_from_above(figure.add_axes((0.48, 0.14, 0.34, 0.76)), frame, frame.boxes[chosen], true_xy)
    return figure
