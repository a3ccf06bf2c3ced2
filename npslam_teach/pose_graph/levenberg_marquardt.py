"""The pose graph: the trajectory and the map that agree best with all measurements, by Gauss-Newton.

chi2 is the sum of ``r^T Omega r`` over all factors (no one-half). ``linearization`` turns the factors into the normal
equations ``H dx = -b`` of one step, ``factorize`` solves them, and here the steps are strung together.

* The update is a plain addition to the world coordinates, with theta wrapped. ``scipy.optimize.least_squares`` on the
  same vector is therefore an exact oracle, and the marginal covariances are world ellipses.
* Pose 0 is held still. Adding the identity to H would give the same map and wrong covariances.
"""

import warnings
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from npslam_teach import se2
from npslam_teach.pose_graph.covariance import marginal_covariance
from npslam_teach.pose_graph.factorization import factorizer
from npslam_teach.pose_graph.initialization import chordal_start
from npslam_teach.pose_graph.linearization import (
    Residuals,
    chi2,
    graph_structure,
    linearize,
    normal_equations,
    residuals,
    second_order_term,
)
from npslam_teach.pose_graph.observability import require_determined, require_touched
from npslam_teach.types import PoseGraph
from npslam_teach.validation import LARGEST

__all__ = ["Step", "chi2", "chordal_start", "descend", "gauss_newton", "linearize", "marginal_covariance", "optimize"]

ROUNDING = 1e-13  # the share of chi2 that is lost when it is added up
MOST_DAMPING = 1e12
MOST_CORRECTIONS = 3
BELIEVED = 0.75  # the share of what the linear problem promised that corrections must bring
CREEPING = 0.02  # a step that still brings this share of what the one before has brought, and little of chi2,
LITTLE = 0.01  # is one of many that will follow


@dataclass(frozen=True, eq=False)
class Step:
    """One iteration of ``gauss_newton``; iteration 0 is the graph as it was given."""

    iteration: int
    graph: PoseGraph  # after the step
    chi2: float  # after the step
    dx: np.ndarray  # (n,) the step itself: poses 1.., then landmarks
    damping: float  # 0 for a pure Gauss-Newton step, and for Newton's
    converged: bool
    status: str  # "running", "converged", or why the iteration stopped without


def gauss_newton(
    graph: PoseGraph, tolerance: float = 1e-9, max_iterations: int = 100, library: str | None = None
) -> Iterator[Step]:
    """Improve the graph step by step.

    A step that would raise chi2 is followed by the next ones, which may make up for it; if they do not, it is taken
    back and shortened by damping (a multiple of H's own diagonal, Levenberg and Marquardt) until it lowers chi2.

    Near the minimum of most graphs each step brings a small fraction of what the one before has brought. Where it is
    more, wheels and camera disagree about long soft bends; from then on Newton's steps, with the
    ``second_order_term`` that Gauss-Newton leaves out, are taken where they lower chi2.

    Args:
        graph: the start; pose 0 stays where it is.
        tolerance: stop when a step lowers chi2 by less than this share of it.
        max_iterations: stop after this many steps, converged or not.
        library: that solves the linear systems, see ``factorization.factorizer``.

    Yields:
        the start as iteration 0, then every step. The last one says whether it ``converged``, or why not.

    Raises:
        numpy.linalg.LinAlgError: when a pose or landmark is not determined by the factors; it is named.
    """
    _require_settings(tolerance, max_iterations)
    require_touched(graph)
    # A heading of many turns would swallow small steps in rounding.
    graph = replace(graph, poses=np.column_stack([graph.poses[:, :2], se2.wrap(graph.poses[:, 2])]))
    structure, at = graph_structure(graph), residuals(graph)
    status = "running" if structure.num_unknowns else "converged"
    step = Step(0, graph, at.chi2, np.zeros(structure.num_unknowns), 0.0, status == "converged", status)
    yield step
    factorize = factorizer(structure, library)
    gain, creeping = np.inf, False
    while step.status == "running":
        data, b = normal_equations(step.graph, structure, at)
        if step.iteration == 0:
            require_determined(step.graph, structure, data, factorize)
        # A perfect fit ends at rounding error, of which no relative decrease can be asked.
        negligible = max(tolerance, ROUNDING) * at.chi2 + 1e-20 * len(b)
        trial = _newton(step, at, data, b, structure, factorize) if creeping else None
        trial = trial or _descend(step, at, data, b, structure, factorize, negligible)
        status = _status(step, at.chi2, trial, negligible, max_iterations)
        previous_gain, gain = gain, at.chi2 - trial.at.chi2
        creeping = creeping or CREEPING * previous_gain < gain < LITTLE * at.chi2
        at = trial.at
        step = Step(step.iteration + 1, trial.graph, at.chi2, trial.dx, trial.damping, status == "converged", status)
        yield step


def descend(graph: PoseGraph, tolerance: float = 1e-9, max_iterations: int = 100) -> list[Step]:
    """``gauss_newton`` from the given start and, where that proves to be a bad one, from the chordal start.

    A start is bad when a step from it had to be damped, or when nothing converged. The chordal start can be better only
    where factors between poses close loops: along a mere chain it is the odometry.

    Args: as in ``gauss_newton``.

    Returns:
        the steps of the descent that ended lower.
    """
    steps = list(gauss_newton(graph, tolerance, max_iterations))
    well_begun = steps[-1].converged and not any(step.damping for step in steps)
    if well_begun or len(graph.between.i) < len(graph.poses):
        return steps
    others = list(gauss_newton(chordal_start(graph), tolerance, max_iterations))
    return min((steps, others), key=lambda descent: descent[-1].chi2)


def optimize(graph: PoseGraph, tolerance: float = 1e-9, max_iterations: int = 100) -> PoseGraph:
    """The graph at the minimum of chi2, from whichever start ``descend`` finds it; warns where nothing converged."""
    last = descend(graph, tolerance, max_iterations)[-1]
    if not last.converged:
        warnings.warn(f"the solver stopped after {last.iteration} iterations: {last.status}", stacklevel=2)
    return last.graph


class _Trial(NamedTuple):
    graph: PoseGraph
    at: Residuals
    dx: np.ndarray
    damping: float
    stuck: bool  # the linear problem promises a better fit, and no step finds it


def _descend(step: Step, at: Residuals, data, b, structure, factorize, negligible: float) -> _Trial:
    """The Gauss-Newton step, damped as little as lowers chi2; no step at all where nothing lowers it."""
    damping, stuck = step.damping / 10 if step.damping > 1e-8 else 0.0, False
    while damping <= MOST_DAMPING:
        dx = _solution(factorize, _damped(data, structure.diagonal, damping), -b)
        moved, after = _moved(step.graph, dx)
        promised = -b @ dx if after.chi2 < np.inf else np.inf
        if at.chi2 < after.chi2 < np.inf and damping == 0:
            moved, after, dx = _corrected(moved, after, dx, at.chi2 - BELIEVED * promised, structure, factorize)
        if after.chi2 <= at.chi2:
            return _Trial(moved, after, dx, damping, False)
        if promised <= negligible or after.chi2 - at.chi2 <= ROUNDING * at.chi2:
            break
        stuck = True
        damping = max(10 * damping, 1e-6)
    return _Trial(step.graph, at, np.zeros_like(b), damping, stuck)


def _newton(step: Step, at: Residuals, data, b, structure, factorize) -> _Trial | None:
    """The step with all second derivatives; None where it does not lead down."""
    dx = _solution(factorize, data + second_order_term(step.graph, structure, at), -b)
    moved, after = _moved(step.graph, dx)
    return _Trial(moved, after, dx, 0.0, False) if -b @ dx > 0 and after.chi2 < at.chi2 else None


def _corrected(moved: PoseGraph, after: Residuals, dx, believed: float, structure, factorize):
    """Follow a step that has overshot: chi2's valley is curved, and from its slope further steps may reach its floor.

    A long chain that has to bend is such a valley: damping would stop the bend along with the overshoot, and creep.
    Below ``believed`` the steps together have brought what the first one promised; if they never come there, they may
    have left for another valley, and the first step is returned as it was.
    """
    first = moved, after, dx
    for _ in range(MOST_CORRECTIONS):
        data, b = normal_equations(moved, structure, after)
        correction = _solution(factorize, data, -b)
        nearer, lower = _moved(moved, correction)
        if not lower.chi2 < after.chi2:
            break
        moved, after, dx = nearer, lower, dx + correction
        if after.chi2 <= believed:
            return moved, after, dx
    return first


def _solution(factorize, data: np.ndarray, rhs: np.ndarray) -> np.ndarray:
    """The step that solves the linear problem; an infinite one where rounding has made H singular on the way."""
    try:
        return factorize(data)(rhs)
    except np.linalg.LinAlgError:
        return np.full_like(rhs, np.inf)


def _damped(data: np.ndarray, diagonal: np.ndarray, damping: float) -> np.ndarray:
    if damping == 0:
        return data
    damped = data.copy()
    damped[diagonal] *= 1 + damping
    return damped


def _require_settings(tolerance: float, max_iterations: int) -> None:
    if max_iterations < 1:
        raise ValueError(f"max_iterations: expected a positive number, got {max_iterations}")
    if not 0 <= tolerance < 1:
        raise ValueError(f"tolerance: expected a share from 0 to 1, got {tolerance}")


def _status(step: Step, before: float, trial: _Trial, negligible: float, max_iterations: int) -> str:
    if trial.stuck:
        return "no step lowers chi2"
    if before - trial.at.chi2 <= negligible:
        return "converged"
    return "running" if step.iteration + 1 < max_iterations else "iteration limit"


def _moved(graph: PoseGraph, dx: np.ndarray) -> tuple[PoseGraph, Residuals]:
    """The graph after a step, and its residuals; the same graph and an infinite chi2 for a step out of this world."""
    if not np.abs(dx).max() < LARGEST / 10:
        return graph, Residuals(np.empty((0, 3)), np.empty((0, 2)), np.inf)
    poses, num_pose_unknowns = graph.poses.copy(), 3 * (len(graph.poses) - 1)
    poses[1:] += dx[:num_pose_unknowns].reshape(-1, 3)
    poses[:, 2] = se2.wrap(poses[:, 2])
    moved = replace(graph, poses=poses, landmarks=graph.landmarks + dx[num_pose_unknowns:].reshape(-1, 2))
    return moved, residuals(moved)
