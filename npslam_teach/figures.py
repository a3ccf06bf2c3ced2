"""Every figure file of the course: what it is called, what it shows and how it is drawn.

The numbers are those of the deck that the course replaces.
"""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from npslam_teach import plotting
from npslam_teach.data import GroundTruth, RobotLog, Snapshot
from npslam_teach.files import atomic_write


@dataclass(frozen=True, eq=False)
class Comparison:
    """One scene and what every method made of it."""

    log: RobotLog
    truth: GroundTruth
    runs: dict[str, list[Snapshot]]  # by the name of the method; every snapshot, frame by frame first

    @property
    def last(self) -> dict[str, Snapshot]:
        """The result of each method."""
        return {name: snapshots[-1] for name, snapshots in self.runs.items()}


@dataclass(frozen=True)
class FigureFile:
    """A figure, its file name without suffix, and its alternative text."""

    name: str
    alt: str
    draw: Callable


def truth_figure(comparison: Comparison):
    """Deck figure 14: where everything really is."""
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


SIMULATION = (
    FigureFile(
        "fig14_simulation_ground_truth",
        "Map of the simulated room: the closed path of the robot and 15 objects of five classes.",
        truth_figure,
    ),
    FigureFile(
        "fig15_simulation_frame_by_frame",
        "Map before any association: every sighting is drawn as an object of its own, in smeared clouds around each "
        "true object, and the estimated path has drifted from the true one.",
        start_figure,
    ),
    FigureFile(
        "fig16_simulation_iterations",
        "The same map after each iteration of the paper's method: the clouds shrink to a few objects and then to one "
        "per true object, while the path moves onto the true path.",
        iterations_figure,
    ),
    FigureFile(
        "fig17_simulation_methods",
        "Four maps side by side: the NP-graph lies on the truth; robust SLAM keeps one object per class; open loop and "
        "frame by frame keep the drifted path with far too many objects.",
        methods_figure,
    ),
    FigureFile(
        "fig17_simulation_errors",
        "Left, cumulative trajectory error along the path, lowest for the NP-graph. Right, object error against the "
        "number of objects found: only the NP-graph has a small error at the true number.",
        errors_figure,
    ),
)


def compare(log: RobotLog, truth: GroundTruth) -> Comparison:
    """Run every method on a log with its default settings."""
    from npslam_teach.methods import METHODS

    return Comparison(log, truth, {name: list(method(log)) for name, method in METHODS.items()})


def draw_simulation(comparison: Comparison, folder: Path) -> list[FigureFile]:
    """Draw deck figures 14 to 17 of a scene as PNG and SVG; figure 16 only where the NP-graph was run."""
    drawn = [entry for entry in SIMULATION if entry.draw is not iterations_figure or "np-graph" in comparison.runs]
    for entry in drawn:
        plotting.save(entry.draw(comparison), folder / entry.name)
    return drawn


def draw_all(folder: Path) -> None:
    """Draw every figure of the course, and an index page with the alternative texts."""
    from npslam_teach import simulate

    drawn = draw_simulation(compare(*simulate.fifteen_objects()), folder)
    with atomic_write(folder / "README.md") as stream:
        stream.write("# Figures\n\n`python3 -m npslam_teach figures` draws them anew, byte for byte.\n")
        for entry in drawn:
            stream.write(f"\n## {entry.name}\n\n![{entry.alt}]({entry.name}.png)\n\n{entry.alt}\n")
