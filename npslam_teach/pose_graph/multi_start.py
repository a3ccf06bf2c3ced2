"""Several starts, and the lowest end: what ``optimize`` does against local minima."""

import warnings

from npslam_teach.pose_graph.gauss_newton import Iteration
from npslam_teach.pose_graph.initialization import chordal_start
from npslam_teach.pose_graph.levenberg_marquardt import levenberg_marquardt
from npslam_teach.types import PoseGraph


def minimize(graph: PoseGraph, tolerance: float = 1e-9, max_iterations: int = 100) -> list[Iteration]:
    """``levenberg_marquardt`` from the given start and, where that proves to be a bad one, from the chordal start.

    A start is bad when a step from it had to be damped, or when nothing converged. The chordal start can be better only
    where factors between poses close loops: along a mere chain it is the odometry.

    Args: as in ``levenberg_marquardt``.

    Returns:
        the iterations of the run that ended lower.
    """
    run = list(levenberg_marquardt(graph, tolerance, max_iterations))
    good_start = run[-1].converged and not any(iteration.damping for iteration in run)
    if good_start or len(graph.between.i) < len(graph.poses):
        return run
    other = list(levenberg_marquardt(chordal_start(graph), tolerance, max_iterations))
    return min((run, other), key=lambda each: each[-1].chi2)


def optimize(graph: PoseGraph, tolerance: float = 1e-9, max_iterations: int = 100) -> PoseGraph:
    """The graph at the minimum of chi2, from whichever start ``minimize`` finds it; warns where nothing converged."""
    last = minimize(graph, tolerance, max_iterations)[-1]
    if not last.converged:
        warnings.warn(f"the solver stopped after {last.iteration} iterations: {last.status}", stacklevel=2)
    return last.graph
