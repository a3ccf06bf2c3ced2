"""The explorer of lesson 06 for false positives: a slider on epsilon (deck figure 13)."""

import numpy as np

from npslam_teach import plotting
from npslam_teach.association import false_positives
from npslam_teach.course.alternation import pictures
from npslam_teach.course.explorers import Explorer, slider
from npslam_teach.methods import np_graph
from npslam_teach.plotting.style import class_style, legend_below
from npslam_teach.types import GroundTruth, RobotLog, Snapshot


def explore_false_positives(log: RobotLog, truth: GroundTruth, alpha: float = 0.5) -> Explorer:
    """Move epsilon and see which objects are removed, and what that does to the path.

    Args:
        log: what the robot measured; the solver uses its own standard deviations.
        truth: drawn behind.
        alpha: concentration.
    """
    settings = {"alpha": alpha, "odometry_std": log.odometry_std, "observation_std": log.observation_std}
    *_, before = np_graph(log, **settings)
    names = pictures.member_names(before.labels)
    figure, (left, right) = plotting.new_figure(1, 2, (13.0, 4.8), width_ratios=(1, 1.6))
    pictures.plot_nothing_there(left, before.votes, names, 0.5)
    pictures.plot_kept_objects(right, before, truth, np.zeros((0, 2)), names)
    # The odometry path is the widest of all, and must fit on the map.
    first = next(np_graph(log, **settings))
    right.update_datalim(np.vstack([first.graph.poses[:, :2], first.graph.landmarks]))
    right.autoscale_view()
    legend_below(figure, pictures.kept_handles(truth), columns=7)
    move = _artists(left, right, before)

    def update(epsilon: float) -> str:
        *_, after = np_graph(log, **settings, false_positive_threshold=epsilon)
        rejected = false_positives(before.votes, epsilon)
        move(epsilon, rejected, after)
        off = np.linalg.norm(after.graph.poses[:, :2] - truth.poses[:, :2], axis=1).max()
        return words(epsilon, [name for name, gone in zip(names, rejected, strict=True) if gone], after, off)

    epsilon = slider("epsilon", 0.5, 0.0, 0.6, 0.01)
    return Explorer(figure, update, {"epsilon": (0, 0.2, 0.26, 0.34, 0.49, 0.5, 0.6)}, epsilon=epsilon)


def words(epsilon: float, gone: list[str], after: Snapshot, off: float) -> str:
    """What epsilon takes away, in words."""
    what = "nothing is taken away" if not gone else f"{', '.join(gone)} {'is' if len(gone) == 1 else 'are'} taken away"
    remain = f"{after.num_objects} of {after.num_objects + len(gone)} objects remain"
    return f"Epsilon {epsilon:.2f}: {what}, {remain}; the path is off by up to {off:.2f} m."


def _artists(left, right, before: Snapshot):
    """Find the artists that follow epsilon; returns what moves them."""
    level, bars = left.lines[0], left.patches
    path, crosses = right.lines[1], right.lines[2]
    classes = before.votes[:, 1:].argmax(axis=1)
    # After the hollow true objects come the found ones, one collection for each class in increasing order.
    found = dict(zip(np.unique(classes), right.collections[-len(np.unique(classes)) :], strict=True))

    def move(epsilon: float, rejected: np.ndarray, after: Snapshot) -> None:
        level.set_ydata([epsilon, epsilon])
        xy = before.graph.landmarks.copy()
        xy[~rejected] = after.graph.landmarks
        crosses.set_data(*xy[rejected].T)
        path.set_data(*after.graph.poses[:, :2].T)
        for c, artist in found.items():
            artist.set_offsets(xy[~rejected & (classes == c)])
        for bar, color, gone in zip(bars, [class_style(c)[0] for c in classes], rejected, strict=True):
            bar.set(facecolor="white" if gone else color, hatch="xx" if gone else "")
        for label, point, gone in zip(right.texts, xy, rejected, strict=True):
            label.xy = point
            label.set_visible(not gone)
        right.set_title(f"{np.count_nonzero(~rejected)} of {len(rejected)} objects remain")

    return move
