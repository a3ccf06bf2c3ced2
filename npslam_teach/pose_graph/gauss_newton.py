"""Gauss-Newton as the lecture tells it: linearise, solve, move, until nothing changes any more.

chi2 is the sum of ``r^T Omega r`` over all factors (no one-half). Around the present estimate every residual is nearly
linear; ``linearize`` collects the linear problem as ``H dx = -b``, and its solution is the step. The update is a plain
addition to the world coordinates, with theta wrapped, so that ``scipy.optimize.least_squares`` on the same vector is an
exact oracle. Pose 0 stays where it is; adding the identity to H instead would give the same map and wrong covariances.

This loop trusts every step. From a bad start it may climb, and end in a local minimum or nowhere:
``levenberg_marquardt`` is the same loop with the precautions that ``optimize`` needs.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from npslam_teach.pose_graph.factorization import solve_once
from npslam_teach.pose_graph.linearization import chi2, linearize
from npslam_teach.pose_graph.observability import require_connected
from npslam_teach.pose_graph.unknowns import retract, unknowns_of, within_bounds
from npslam_teach.types import PoseGraph

ROUNDING = 1e-13  # the share of chi2 that is lost when it is added up


@dataclass(frozen=True, eq=False)
class Iteration:
    """One iteration of a solver; iteration 0 is the graph as it was given."""

    iteration: int
    graph: PoseGraph  # after the step
    chi2: float  # after the step
    dx: np.ndarray  # (n,) the step itself, see ``unknowns``
    damping: float  # 0 for a pure Gauss-Newton step, and for Newton's
    converged: bool
    status: str  # "running", "converged", or why the iteration stopped without


def gauss_newton(graph: PoseGraph, tolerance: float = 1e-9, max_iterations: int = 100) -> Iterator[Iteration]:
    """Improve the graph step by step, every step in full (deck step 3; Grisetti et al. 2010, algorithm 1).

    Args:
        graph: the start; its fixed poses (pose 0 unless it says otherwise) stay where they are.
        tolerance: stop when a step changes chi2 by less than this share of it.
        max_iterations: stop after this many steps, converged or not.

    Yields:
        the start as iteration 0, then every step. The last one says whether it ``converged``, or why not.

    Raises:
        numpy.linalg.LinAlgError: when a pose or landmark is not determined by the factors.
    """
    require_settings(tolerance, max_iterations)
    require_connected(graph)
    before, status, dx = chi2(graph), "running", np.zeros(unknowns_of(graph).count)
    yield Iteration(0, graph, before, dx, 0.0, False, status)
    for iteration in range(1, max_iterations + 1):
        h, b, _ = linearize(graph)
        dx = solve_once(h, -b)
        if not within_bounds(dx):
            raise np.linalg.LinAlgError("expected a step within bounds, but Gauss-Newton diverges")
        graph = retract(graph, dx)
        after = chi2(graph)
        if abs(before - after) <= max(tolerance, ROUNDING) * before + 1e-20 * len(b):
            status = "converged"
        elif iteration == max_iterations:
            status = "iteration limit"
        yield Iteration(iteration, graph, after, dx, 0.0, status == "converged", status)
        if status != "running":
            return
        before = after


def require_settings(tolerance: float, max_iterations: int) -> None:
    """Raise ``ValueError`` that names the first setting of a solver that makes no sense."""
    if max_iterations < 1:
        raise ValueError(f"max_iterations: expected a positive number, got {max_iterations}")
    if not 0 <= tolerance < 1:
        raise ValueError(f"tolerance: expected a share from 0 to 1, got {tolerance}")
