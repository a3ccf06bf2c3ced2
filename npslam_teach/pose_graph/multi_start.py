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
from npslam_teach.pose_graph.linearization import chi2, linear_system
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
    return _minimize(graph, tolerance, max_iterations, library)[1]


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
    name, run = _minimize(graph, tolerance, max_iterations, library)
    solved, ends = time.perf_counter(), {name: run[-1].chi2}
    certificate = certify(run[-1].graph)
    for other, start in _all_starts(graph):
        if certificate.status == "certified":
            break
        attempt = list(levenberg_marquardt(start, tolerance, max_iterations))
        ends[other] = attempt[-1].chi2
        if attempt[-1].chi2 < run[-1].chi2 * (1 - tolerance):
            name, run, certificate = other, attempt, certify(attempt[-1].graph)
    return Optimum(name, run, certificate, solved - begin, time.perf_counter() - solved, ends)


def _minimize(graph: PoseGraph, tolerance: float, max_iterations: int, library) -> tuple[str, list[Iteration]]:
    """The start of ``minimize``, and its iterations."""
    require_settings(tolerance, max_iterations)
    require_factors(graph)
    system, best = linear_system(graph, library), None
    for name, start in sorted(_cheap_starts(graph, system).items(), key=lambda named: chi2(named[1])):
        run = list(levenberg_marquardt(start, tolerance, max_iterations, system))
        if best is None or run[-1].chi2 < best[1][-1].chi2:
            best = name, run
        if run[-1].converged and not any(iteration.damping for iteration in run):
            break
    return best


def _cheap_starts(graph: PoseGraph, system: LinearSystem) -> dict[str, PoseGraph]:
    starts = {"given": graph}
    if (graph.poses == graph.poses[0]).all():
        starts = {"odometry": odometry_start(graph)}
    if len(graph.between.i) >= len(graph.poses):
        with contextlib.suppress(np.linalg.LinAlgError):  # headings are needed to determine the positions
            starts["chordal"] = chordal_start(graph, system)
    return starts


def _all_starts(graph: PoseGraph) -> Iterator[tuple[str, PoseGraph]]:
    yield "given", graph
    for name, make in (("chordal", chordal_start), ("odometry", odometry_start), ("relaxed", relaxed_start)):
        with contextlib.suppress(np.linalg.LinAlgError):  # the factors do not determine this start
            yield name, make(graph)


def optimize(graph: PoseGraph, tolerance: float = 1e-9, max_iterations: int = 100) -> PoseGraph:
    """The graph at the minimum of chi2, from whichever start ``minimize`` finds it; warns where nothing converged."""
    last = minimize(graph, tolerance, max_iterations)[-1]
    if not last.converged:
        warnings.warn(f"the solver stopped after {last.iteration} iterations: {last.status}", stacklevel=2)
    return last.graph
