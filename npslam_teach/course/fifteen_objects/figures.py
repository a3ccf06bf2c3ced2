"""Deck figures 14 to 17: the paper's simulation with every method."""

from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path

from npslam_teach import plotting, simulate
from npslam_teach.course.figure_file import FigureFile, draw_files
from npslam_teach.types import GroundTruth, RobotLog, Snapshot


@dataclass(frozen=True, eq=False)
class Comparison:
    """One scene and the results of every method."""

    log: RobotLog
    truth: GroundTruth
    runs: dict[str, list[Snapshot]]  # by the name of the method; every snapshot, frame by frame first

    @property
    def last(self) -> dict[str, Snapshot]:
        """The result of each method."""
        return {name: snapshots[-1] for name, snapshots in self.runs.items()}


def truth_figure(comparison: Comparison):
    """Deck figure 14: the true objects and path."""
    figure, ax = plotting.new_figure(size=(8.0, 6.0))
    plotting.plot_truth(ax, comparison.truth)
    return figure


def start_figure(comparison: Comparison):
    """Deck figure 15: every observation an object of its own."""
    figure, ax = plotting.new_figure(size=(8.0, 6.0))
    first = next(iter(comparison.runs.values()))[0]
    plotting.plot_snapshot(ax, first, comparison.log, comparison.truth)
    return figure


def iterations_figure(comparison: Comparison):
    """Deck figure 16: the iterations of the paper's method."""
    snapshots = comparison.runs["np-graph"]
    return plotting.plot_iterations(snapshots, comparison.log, comparison.truth)


def methods_figure(comparison: Comparison):
    """Deck figure 17: the result of each method."""
    return plotting.plot_methods(comparison.last, comparison.log, comparison.truth)


def errors_figure(comparison: Comparison):
    """Deck figure 17, the errors: along the path, and against the number of objects."""
    figure, (left, right) = plotting.new_figure(1, 2, (13.0, 5.0))
    plotting.plot_cumulative_error(left, comparison.last, comparison.truth)
    plotting.plot_error_against_objects(right, comparison.last, comparison.truth)
    return figure


TEXTS = {
    truth_figure: (
        "fig14_simulation_ground_truth",
        "Map of the simulated room: the closed path of the robot and 15 objects of five classes.",
    ),
    start_figure: (
        "fig15_simulation_frame_by_frame",
        "Map before any association: every sighting is drawn as an object of its own, in smeared clouds around each "
        "true object, and the estimated path has drifted from the true one.",
    ),
    iterations_figure: (
        "fig16_simulation_iterations",
        "The same map after each iteration of the paper's method: the clouds shrink to a few objects and then to one "
        "per true object, while the path moves onto the true path.",
    ),
    methods_figure: (
        "fig17_simulation_methods",
        "Four maps side by side: the NP-graph lies on the truth; robust SLAM keeps one object per class; open loop and "
        "frame by frame keep the drifted path with far too many objects.",
    ),
    errors_figure: (
        "fig17_simulation_errors",
        "Left, cumulative trajectory error along the path, lowest for the NP-graph. Right, object error against the "
        "number of objects found: only the NP-graph has a small error at the true number.",
    ),
}


def compare(log: RobotLog, truth: GroundTruth) -> Comparison:
    """Run every method of the paper on a log with its default settings."""
    from npslam_teach.methods import METHODS

    return Comparison(log, truth, {name: list(method(log)) for name, method in METHODS.items() if method.in_paper})


def draw_simulation(comparison: Comparison, folder: Path) -> None:
    """Draw deck figures 14 to 17 of any scene as PNG and SVG; figure 16 only where the NP-graph was run."""
    entries = [
        FigureFile(name, alt, partial(draw, comparison))
        for draw, (name, alt) in TEXTS.items()
        if draw is not iterations_figure or "np-graph" in comparison.runs
    ]
    draw_files(entries, folder)


@cache
def _own_scene() -> Comparison:
    return compare(*simulate.fifteen_objects())


FIGURES = tuple(FigureFile(name, alt, lambda draw=draw: draw(_own_scene())) for draw, (name, alt) in TEXTS.items())
