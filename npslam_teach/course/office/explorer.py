"""The explorer of lesson 08: how many observations make an object valid? The map of any method, epsilon on a slider."""

import math

import numpy as np

from npslam_teach.association import class_posterior
from npslam_teach.course.explorers import Explorer, choice, slider
from npslam_teach.evaluation import map_quality
from npslam_teach.plotting import new_figure, plot_objects, plot_trajectory
from npslam_teach.plotting.maps import classes_of, laid_over_truth
from npslam_teach.plotting.style import (
    ESTIMATE_COLOR,
    ESTIMATE_LINE,
    TRUTH_COLOR,
    TRUTH_LINE,
    class_handles,
    class_style,
    label_axes,
    label_map,
    legend_below,
    path_handles,
)
from npslam_teach.types import GroundTruth, RobotLog, Snapshot

EPSILONS = np.arange(2, 51) / 100


def explore_office(snapshots: dict[str, Snapshot], log: RobotLog, truth: GroundTruth) -> Explorer:
    """A map of the valid objects, and how their number and their observations depend on epsilon.

    Args:
        snapshots: the result of each method before false positives are removed, by its name.
        log: what they were made from.
        truth: for the map alone.

    Returns:
        the explorer, with the sliders ``method`` and ``epsilon``.
    """
    figure, (ax, left, right) = new_figure(1, 3, (13.5, 5.2), width_ratios=(1.5, 1, 1))
    plot_trajectory(ax, truth.poses, truth=True)
    plot_objects(ax, truth.world.object_xy, truth.world.object_class, truth.world.class_names, truth=True)
    classes = range(len(truth.world.class_names))
    legend_below(figure, class_handles(classes, truth.world.class_names) + path_handles(("estimated path",)), 9)
    update = _Update(ax, left, right, snapshots, log, truth)
    methods = choice("method", {name: name for name in snapshots})
    epsilon = slider("epsilon", 0.1, 0.02, 0.5, 0.01)
    frames = {"method": methods.grid(), "epsilon": (0.05, 0.1, 0.5)}
    return Explorer(figure, update, frames, method=methods, epsilon=epsilon)


class _Update:
    """Makes the artists once, and moves them."""

    def __init__(self, ax, left, right, snapshots, log, truth):
        self.snapshots, self.log = snapshots, log
        self.placed = {name: laid_over_truth(snapshot, truth) for name, snapshot in snapshots.items()}
        self.curves = {name: _curves(snapshot, log) for name, snapshot in snapshots.items()}
        self.num_true = len(np.unique(truth.obs_object[truth.obs_object >= 0]))
        (self.path,) = ax.plot([], [], **ESTIMATE_LINE)
        self.rejected = ax.scatter([], [], s=6, c=TRUTH_COLOR, zorder=1.8)
        self.of_class = [_empty_class(ax, c) for c in range(log.num_classes)]
        everything = np.concatenate([truth.world.object_xy, truth.poses[:, :2]])
        low, high = everything.min(axis=0) - 0.8, everything.max(axis=0) + 0.8
        ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
        label_map(ax, " ")
        self.title = ax.title
        left.axhline(self.num_true, **TRUTH_LINE)
        self.counts = _curve(left, "valid objects (number)")
        # Linear to ten and logarithmic beyond, so that zero, forty and a thousand can all be shown.
        left.set_yscale("symlog", linthresh=10)
        left.set_yticks([0, 10, 100, 1000], ["0", "10", "100", "1000"])
        left.set_ylim(-0.5, 2 * max(log.num_observations, 50))
        self.inliers = _curve(right, "inlier sightings (number)")
        right.set_ylim(-0.02 * log.num_observations, 1.05 * log.num_observations)

    def __call__(self, method: str, epsilon: float) -> str:
        snapshot, (poses, landmarks) = self.snapshots[method], self.placed[method]
        now = map_quality(snapshot, self.log, epsilon)
        valid = class_posterior(snapshot.votes)[:, 0] <= epsilon
        self.path.set_data(*poses[:, :2].T)
        self.rejected.set_offsets(landmarks[~valid])
        for c, scatter in enumerate(self.of_class):
            scatter.set_offsets(landmarks[valid & (classes_of(snapshot) == c)])
        for (line, dot), curve, value in zip(
            (self.counts, self.inliers), self.curves[method], (now.num_valid, now.num_inliers), strict=True
        ):
            line.set_data(EPSILONS, curve)
            dot.set_data([epsilon], [value])
        self.title.set_text(f"{method}, {now.num_valid} valid objects")
        # 1 / (m + 1) <= epsilon; 1e-9 is for values such as 0.1, which are not exact in binary.
        least = max(math.ceil(1 / epsilon - 1 - 1e-9), 1)
        share = 100 * now.num_inliers / max(self.log.num_observations, 1)
        return (
            f"{method}, epsilon {epsilon:.2f}: an object needs {least} sighting{'s' if least > 1 else ''} or more. "
            f"{now.num_valid} of {snapshot.num_objects} objects are valid, where {self.num_true} real ones were seen; "
            f"they hold {now.num_inliers} of {self.log.num_observations} sightings ({share:.0f}%)."
        )


def _curves(snapshot: Snapshot, log: RobotLog) -> tuple[list, list]:
    results = [map_quality(snapshot, log, epsilon) for epsilon in EPSILONS]
    return [each.num_valid for each in results], [each.num_inliers for each in results]


def _empty_class(ax, c: int):
    color, marker = class_style(c)
    return ax.scatter([], [], s=75, c=color, marker=marker, edgecolors=ESTIMATE_COLOR, linewidths=0.6, zorder=2.5)


def _curve(ax, label: str) -> tuple:
    """An empty curve over epsilon and the dot that moves on it."""
    (line,) = ax.plot([], [], color=ESTIMATE_COLOR, linewidth=1.8)
    (dot,) = ax.plot([], [], "o", color="#d45e00", markersize=11, markeredgecolor="white", zorder=3)
    ax.set_xlim(0, 0.51)
    label_axes(ax, "epsilon (probability)", label)
    return line, dot
