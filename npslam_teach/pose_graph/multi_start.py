"""Several starts, and the lowest end: what ``optimize`` does against local minima."""

import warnings
from collections.abc import Iterator
from dataclasses import dataclass, replace

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
    better only where factors between poses close loops: along a mere chain it is the odometry.

    Args:
        graph: the given start.
        tolerance: as in ``levenberg_marquardt``.
        max_iterations: as in ``levenberg_marquardt``, for each start.
        library: that solves the linear systems, see ``factorization.factorizer``.

    Returns:
        the iterations of the run that ended lowest.
    """
    require_settings(tolerance, max_iterations)
    require_factors(graph)
    system = linear_system(graph, library)
    best: list[Iteration] = []
    for start in sorted(_cheap_starts(graph, system), key=chi2):
        run = list(levenberg_marquardt(start, tolerance, max_iterations, system))
        best = min((best or run), run, key=lambda each: each[-1].chi2)
        if run[-1].converged and not any(iteration.damping for iteration in run):
            break
    return best


@dataclass(frozen=True, eq=False)
class Optimum:
    """The lowest minimum that was found, and what is known about others."""

    iterations: list[Iteration]  # that led to it
    certificate: Certificate
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
    run = minimize(graph, tolerance, max_iterations, library)
    best = Optimum(run, certify(run[-1].graph), {"quick": run[-1].chi2})
    if best.certificate.status == "certified":
        return best
    for name, start in _all_starts(graph):
        run = list(levenberg_marquardt(start, tolerance, max_iterations))
        ends = best.chi2_by_start | {name: run[-1].chi2}
        if run[-1].chi2 < best.iterations[-1].chi2 * (1 - tolerance):
            best = Optimum(run, certify(run[-1].graph), ends)
        best = replace(best, chi2_by_start=ends)
        if best.certificate.status == "certified":
            break
    return best


def _all_starts(graph: PoseGraph) -> Iterator[tuple[str, PoseGraph]]:
    yield "given", graph
    for make in (chordal_start, odometry_start, relaxed_start):
        try:
            yield make.__name__.removesuffix("_start"), make(graph)
        except np.linalg.LinAlgError:
            continue  # a start that the factors do not determine


def _cheap_starts(graph: PoseGraph, system: LinearSystem) -> list[PoseGraph]:
    if len(graph.between.i) < len(graph.poses):
        return [graph]
    try:
        return [graph, chordal_start(graph, system)]
    except np.linalg.LinAlgError:  # headings are needed to determine the positions
        return [graph]


def optimize(graph: PoseGraph, tolerance: float = 1e-9, max_iterations: int = 100) -> PoseGraph:
    """The graph at the minimum of chi2, from whichever start ``minimize`` finds it; warns where nothing converged."""
    last = minimize(graph, tolerance, max_iterations)[-1]
    if not last.converged:
        warnings.warn(f"the solver stopped after {last.iteration} iterations: {last.status}", stacklevel=2)
    return last.graph
