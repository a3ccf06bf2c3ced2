"""The pictures of a result on somebody's own log: the map, and how it came about."""

from matplotlib.figure import Figure

from npslam_teach.evaluation import align_to_truth
from npslam_teach.plotting.maps import plot_snapshot
from npslam_teach.plotting.panels import plot_iterations
from npslam_teach.plotting.style import new_figure
from npslam_teach.types import GroundTruth, RobotLog, Snapshot


def result_figures(snapshots: list[Snapshot], log: RobotLog, truth: GroundTruth | None = None) -> dict[str, Figure]:
    """The last map alone, large; and all iterations side by side where there are several.

    Args:
        snapshots: of one run.
        log: what they were made from.
        truth: drawn behind where it is known; left out where too little of the path is known to lay them over it.

    Returns:
        figures by the name of their file.
    """
    if truth is not None and align_to_truth(snapshots[-1].graph.poses, truth) is None:
        truth = None
    figure, ax = new_figure(size=(10.0, 7.0))
    plot_snapshot(ax, snapshots[-1], log, truth)
    figures = {"map": figure}
    if len(snapshots) > 1:
        figures["iterations"] = plot_iterations(snapshots, log, truth)
    return figures
