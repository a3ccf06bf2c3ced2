"""Results in the office: the centre of a box by three rules, and the screens that became one object."""

import numpy as np
from matplotlib.figure import Figure

from npslam_teach import se2
from npslam_teach.course.small_pictures import curves_figure
from npslam_teach.plotting.maps import laid_over_truth
from npslam_teach.plotting.style import ESTIMATE_COLOR, TRUTH_OBJECT, class_style, label_map, new_figure
from npslam_teach.types import GroundTruth, RobotLog, Snapshot


def screens_figure(log: RobotLog, truth: GroundTruth, last: Snapshot, screens: list[int]) -> Figure:
    """Sightings of screens along the estimated path, with the colour and the marker of the object that has them.

    Args:
        log: what the robot measured.
        truth: where the screens are.
        last: the estimate.
        screens: indices of true objects.
    """
    figure, ax = new_figure(size=(9.0, 4.6))
    poses, _ = laid_over_truth(last, truth)
    seen_at = se2.apply(poses[log.obs_time], log.obs_xy)
    for k, found in enumerate(np.unique(last.labels[np.isin(truth.obs_object, screens)])):
        own = seen_at[(last.labels == found) & np.isin(truth.obs_object, screens)]
        color, marker = class_style(k)
        ax.plot(*own.T, marker, linestyle="none", color=color, markersize=5, alpha=0.7)
    at = truth.world.object_xy[screens]
    ax.scatter(*at.T, s=190, marker="s", zorder=3, **TRUTH_OBJECT | {"edgecolors": ESTIMATE_COLOR})
    return label_map(ax, "two squares (true screens) with one sign have become one object").figure


def boxes_figure(rows: np.ndarray, names: list[str]) -> Figure:
    """The median error of each rule for the centre of a box, by how much the depths in the box scatter.

    Args:
        rows: (N, 1 + rules) m, the scatter and the errors of each box.
        names: of the rules.
    """
    medians = np.array([np.median(part, axis=0) for part in np.array_split(rows[np.argsort(rows[:, 0])], 10)])
    curves = {name: medians[:, k + 1] for k, name in enumerate(names)}
    labels = ("standard deviation of the depths in a box (m)", "median error (m)")
    title = "the mean is good where the depths agree, and bad where they scatter"
    return curves_figure(medians[:, 0], curves, labels, title)
