"""Several starts, and the lowest end: what ``optimize`` does against local minima."""

import contextlib
import time
import warnings
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from npslam_teach.pose_graph.certificate import Certificate, certify
from npslam_teach.pose_graph.factorization import LinearSystem
from npslam_teach.pose_graph.gauss_newton import Iteration, require_settings
from npslam_teach.pose_graph.initialization import chordal_start
from npslam_teach.pose_graph.levenberg_marquardt import levenberg_marquardt
from npslam_teach.pose_graph.linearization import linear_system, residuals
from npslam_teach.pose_graph.observability import require_factors
from npslam_teach.pose_graph.relaxation import relaxed_start
from npslam_teach.pose_graph.spanning_tree import odometry_start
from npslam_teach.types import PoseGraph


def minimize(
    graph: PoseGraph, tolerance: float = 1e-9, max_iterations: int = 100, library: str | None = None
) -> list[Iteration]:
    """``levenberg_marquardt`` from the given start or the chordal one, whichever has the lower chi2.

    Where a step from it had to be damped, or nothing converged, the other start is tried too. The chordal start can be
    better only where factors between poses close loops: along a mere chain it is the odometry. A graph whose poses all
    are at one place has no start of its own, and is laid out along its odometry.

    Args:
        graph: the given start.
        tolerance: as in ``levenberg_marquardt``.
        max_iterations: as in ``levenberg_marquardt``, for each start.
        library: that solves the linear systems, see ``factorization.factorizer``.

    Returns:
        the iterations of the run that ended lowest.
    """
    runs = _runs(graph, _checked_system(graph, tolerance, max_iterations, library), tolerance, max_iterations)
    return runs[_lowest(runs)]


@dataclass(frozen=True, eq=False)
class Optimum:
    """The lowest minimum that was found, and what is known about others."""

    start: str  # "given", "chordal", "odometry" or "relaxed": from where it was found
    iterations: list[Iteration]  # that led to it
    certificate: Certificate
    seconds: float  # for what ``minimize`` does
    certificate_seconds: float  # for the rest: the certificate, and other starts where there is none
    chi2_by_start: dict[str, float]  # where each start that was tried has ended

    @property
    def graph(self) -> PoseGraph:
        """The graph at the minimum."""
        return self.iterations[-1].graph


def certified_minimum(
    graph: PoseGraph, tolerance: float = 1e-9, max_iterations: int = 100, library: str | None = None
) -> Optimum:
    """``minimize`` and ``certify``; where there is no certificate, all starts are tried, and the lowest end counts.

    Args: as in ``minimize``.
    """
    begin = time.perf_counter()
    system = _checked_system(graph, tolerance, max_iterations, library)
    runs = _runs(graph, system, tolerance, max_iterations)
    name, solved = _lowest(runs), time.perf_counter()
    certificate = certify(runs[name][-1].graph)
    for other, start in _other_starts(graph, system, tried=frozenset(runs)):
        if certificate.status == "certified":
            break
        runs[other] = list(levenberg_marquardt(start, tolerance, max_iterations, system))
        if runs[other][-1].chi2 < runs[name][-1].chi2 * (1 - tolerance):
            name, certificate = other, certify(runs[other][-1].graph)
    ends = {start: run[-1].chi2 for start, run in runs.items()}
    return Optimum(name, runs[name], certificate, solved - begin, time.perf_counter() - solved, ends)


def _checked_system(graph: PoseGraph, tolerance: float, max_iterations: int, library: str | None) -> LinearSystem:
    require_settings(tolerance, max_iterations)
    require_factors(graph)
    return linear_system(graph, library)


def _runs(graph: PoseGraph, system: LinearSystem, tolerance: float, max_iterations: int) -> dict[str, list[Iteration]]:
    """The iterations from each start that ``minimize`` tries, by its name."""
    runs, starts = {}, _cheap_starts(graph, system)
    at = {name: residuals(start) for name, start in starts.items()}
    for name in sorted(starts, key=lambda name: at[name].chi2):
        runs[name] = run = list(levenberg_marquardt(starts[name], tolerance, max_iterations, system, at[name]))
        if run[-1].converged and not any(iteration.damping for iteration in run):
            break
    return runs


def _lowest(runs: dict[str, list[Iteration]]) -> str:
    return min(runs, key=lambda name: runs[name][-1].chi2)


def _cheap_starts(graph: PoseGraph, system: LinearSystem) -> dict[str, PoseGraph]:
    given = given_start(graph)
    starts = {"given" if given is graph else "odometry": given}
    if len(graph.between.i) >= len(graph.poses):
        with contextlib.suppress(np.linalg.LinAlgError):  # headings are needed to determine the positions
            starts["chordal"] = chordal_start(graph, system)
    return starts


def _other_starts(graph: PoseGraph, system: LinearSystem, tried: frozenset) -> Iterator[tuple[str, PoseGraph]]:
    starts = {
        "given": lambda: graph,
        "chordal": lambda: chordal_start(graph, system),
        "odometry": lambda: odometry_start(graph),
        "relaxed": lambda: relaxed_start(graph),
    }
    for name in (name for name in starts if name not in tried):
        with contextlib.suppress(np.linalg.LinAlgError):  # the factors do not determine this start
            yield name, starts[name]()


def given_start(graph: PoseGraph) -> PoseGraph:
    """The graph as it is given; where all poses are at one place, it is laid out along its odometry."""
    return odometry_start(graph) if (graph.poses == graph.poses[0]).all() else graph


def optimize(graph: PoseGraph, tolerance: float = 1e-9, max_iterations: int = 100) -> PoseGraph:
    """The graph at the minimum of chi2, from whichever start ``minimize`` finds it; warns where nothing converged."""
    last = minimize(graph, tolerance, max_iterations)[-1]
    if not last.converged:
        warnings.warn(f"the solver stopped after {last.iteration} iterations: {last.status}", stacklevel=2)
    return last.graph
