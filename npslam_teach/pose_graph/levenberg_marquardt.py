"""The robust solver: Gauss-Newton with the precautions that a bad start or contradicting measurements call for.

Where no precaution is needed its steps are those of ``gauss_newton``. Three precautions, in the words of Nocedal and
Wright, "Numerical Optimization" (2006), and one more:

* Damping (section 10.3; Levenberg 1944, Marquardt 1963): a multiple of H's own diagonal is added to H until the step
  lowers chi2. The reduction that the linear model predicts is ``-b^T dx``.
* Watchdog steps, also called nonmonotone (section 15.6; Chamberlain et al. 1982): a full step that raises chi2 is
  followed by up to three more, and accepted if together they bring most of the predicted reduction. The minimum often
  lies at the end of a curved valley: a long chain of poses that has to bend is one. Damping alone would crawl.
* A hybrid with Newton's method (section 10.3; Fletcher and Xu 1987): in a large-residual problem Gauss-Newton
  converges only linearly. Where it does, steps with the second-order term are taken if they lower chi2.
* Where weights differ by more than H can hold, all these steps are solved for without it (``augmented_system``).

``linearization`` turns the factors into the normal equations of one step, ``factorization`` solves them.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from npslam_teach.pose_graph.augmented_system import augmented_step, weights_differ
from npslam_teach.pose_graph.factorization import LinearSystem
from npslam_teach.pose_graph.gauss_newton import ROUNDING, Iteration, require_settings
from npslam_teach.pose_graph.linearization import (
    Residuals,
    gradient,
    linear_system,
    normal_equations,
    residuals,
    second_order_term,
)
from npslam_teach.pose_graph.observability import require_factors, require_observable
from npslam_teach.pose_graph.unknowns import retract, within_bounds
from npslam_teach.types import PoseGraph

MAX_DAMPING = 1e12
MAX_WATCHDOG_STEPS = 3
SUFFICIENT = 0.75  # the ratio of actual to predicted reduction that watchdog steps must reach together
FAST_CONVERGENCE = 0.1  # a reduction below this share of the one before
LINEAR_CONVERGENCE = 0.02  # a reduction above this share of the one before, and
NEAR_THE_END = 0.01  # below this share of chi2, is the mark of a large-residual problem
Step = tuple[np.ndarray, float]  # (n,) and the reduction of chi2 that it brings if all is linear


class _NormalEquations:
    """The steps of one system: ``H dx = -b``, with or without what is added to H."""

    def __init__(self, system: LinearSystem):
        """Nothing is worked out yet."""
        self.system, self._latest = system, (None, None, None)

    def equations(self, graph: PoseGraph, at: Residuals) -> tuple[np.ndarray, np.ndarray]:
        """The upper triangle of H, (nnz,), and b (n,) at an estimate; kept for the one that was asked for last."""
        if self._latest[0] is not graph:
            self._latest = graph, *normal_equations(graph, self.system.structure, at)
        return self._latest[1:]

    def step(self, graph: PoseGraph, at: Residuals, damping: float = 0.0, newton: bool = False) -> Step:
        """One step.

        Args:
            graph: an estimate.
            at: the residuals there.
            damping: how much of H's own diagonal is added, so that metres and radians are damped alike.
            newton: add the second-order term.
        """
        data, b = self.equations(graph, at)
        data = data + second_order_term(graph, self.system.structure, at) if newton else data
        dx = self.system.solve(_damped(data, self.system.structure.diagonal, damping), -b)
        return dx, -b @ dx if within_bounds(dx) else np.inf

    def step_again(self, graph: PoseGraph, at: Residuals) -> np.ndarray | None:
        """A step (n,) with the factors of the latest one; None where there are none."""
        return self.system.solve_again(-gradient(graph, at))


class _AugmentedSystem(_NormalEquations):
    """The same steps where weights differ by more than H can hold."""

    def step(self, graph: PoseGraph, at: Residuals, damping: float = 0.0, newton: bool = False) -> Step:
        """As of the normal equations."""
        structure = self.system.structure
        term = structure.matrix(second_order_term(graph, structure, at)) if newton else None
        return augmented_step(graph, at, damping, term)

    def step_again(self, graph: PoseGraph, at: Residuals) -> np.ndarray | None:
        """Its factors are not kept."""
        return None


class _Trial(NamedTuple):
    """Where a step leads to."""

    graph: PoseGraph
    at: Residuals
    dx: np.ndarray
    damping: float
    stuck: bool = False  # the linear model predicts a reduction, and no step brings any


def levenberg_marquardt(
    graph: PoseGraph,
    tolerance: float = 1e-9,
    max_iterations: int = 100,
    system: LinearSystem | None = None,
    at: Residuals | None = None,
) -> Iterator[Iteration]:
    """Improve the graph step by step; chi2 never rises.

    Args:
        graph: the start; its fixed poses and landmarks stay where they are.
        tolerance: stop when a step lowers chi2 by less than this share of it.
        max_iterations: stop after this many steps, converged or not.
        system: the graph's ``linear_system``, where it is at hand already, and every variable has a factor.
        at: the residuals of the start, likewise.

    Yields:
        the start as iteration 0, then every step. The last one says whether it ``converged``, or why not.

    Raises:
        numpy.linalg.LinAlgError: when a pose or landmark is not determined by the factors; it is named.
    """
    require_settings(tolerance, max_iterations)
    if system is None:
        require_factors(graph)
        system = linear_system(graph)
    structure = system.structure
    if np.abs(graph.poses[:, 2]).max() > np.pi:  # a heading of many turns would swallow small steps in rounding
        graph, at = retract(graph, np.zeros(structure.num_unknowns)), None
    at = at or residuals(graph)
    status = "running" if structure.num_unknowns else "converged"
    now = Iteration(0, graph, at.chi2, np.zeros(structure.num_unknowns), 0.0, status == "converged", status)
    yield now
    equations = (_AugmentedSystem if weights_differ(graph) else _NormalEquations)(system)
    reduction, next_reduction, large_residuals = np.inf, np.inf, False
    while now.status == "running":
        # A perfect fit ends at rounding error, of which no relative decrease can be asked.
        negligible = max(tolerance, ROUNDING) * at.chi2 + 1e-20 * structure.num_unknowns
        trial = _last_step(now, at, equations) if next_reduction <= negligible else None
        trial = trial or _full_step(now, at, equations, negligible, large_residuals)
        previous, reduction = reduction, at.chi2 - trial.at.chi2
        next_reduction = np.inf if now.damping or trial.damping else _next_reduction(previous, reduction)
        status = _status(now, trial, reduction <= negligible, max_iterations)
        large_residuals = large_residuals or LINEAR_CONVERGENCE * previous < reduction < NEAR_THE_END * at.chi2
        at = trial.at
        now = Iteration(now.iteration + 1, trial.graph, at.chi2, trial.dx, trial.damping, status == "converged", status)
        yield now


def _full_step(
    now: Iteration, at: Residuals, equations: _NormalEquations, negligible: float, large_residuals: bool
) -> _Trial:
    """The step from equations of its own."""
    if now.iteration == 0:
        system, (data, _) = equations.system, equations.equations(now.graph, at)
        require_observable(now.graph, system.structure, data, system.factorize)
    trial = _newton_step(now, at, equations) if large_residuals else None
    return trial or _damped_step(now, at, equations, negligible)


def _last_step(now: Iteration, at: Residuals, equations: _NormalEquations) -> _Trial | None:
    """A step that will hardly bring anything, for which the factors of the one before do.

    None where there is none, or it raises chi2; no step at all where that is only by rounding.
    """
    dx = equations.step_again(now.graph, at)
    if dx is None:
        return None
    trial = _trial(now.graph, dx)
    if at.chi2 < trial.at.chi2 <= (1 + ROUNDING) * at.chi2:
        return _Trial(now.graph, at, np.zeros_like(trial.dx), 0.0)
    return trial if trial.at.chi2 <= at.chi2 else None


def _damped_step(now: Iteration, at: Residuals, equations: _NormalEquations, negligible: float) -> _Trial:
    """The Gauss-Newton step, damped as little as lowers chi2; no step at all where nothing lowers it."""
    damping, stuck = now.damping / 10 if now.damping > 1e-8 else 0.0, False
    while damping <= MAX_DAMPING:
        dx, predicted = equations.step(now.graph, at, damping)
        trial = _trial(now.graph, dx, damping)
        if at.chi2 < trial.at.chi2 < np.inf and damping == 0:
            trial = _watchdog_steps(trial, at.chi2 - SUFFICIENT * predicted, equations)
        if trial.at.chi2 <= at.chi2:
            return trial
        if predicted <= negligible or trial.at.chi2 - at.chi2 <= ROUNDING * at.chi2:
            break
        stuck = True
        damping = max(10 * damping, 1e-6)
    return _Trial(now.graph, at, np.zeros_like(dx), damping, stuck)


def _watchdog_steps(first: _Trial, sufficient: float, equations: _NormalEquations) -> _Trial:
    """Follow a step that has raised chi2 until it is below ``sufficient``.

    Where the steps never come there, they may have left for another valley, and the first one is returned as it was.
    """
    trial = first
    for _ in range(MAX_WATCHDOG_STEPS):
        following = _trial(trial.graph, equations.step(trial.graph, trial.at)[0])
        if not following.at.chi2 < trial.at.chi2:
            break
        trial = following._replace(dx=trial.dx + following.dx)
        if trial.at.chi2 <= sufficient:
            return trial
    return first


def _newton_step(now: Iteration, at: Residuals, equations: _NormalEquations) -> _Trial | None:
    """The step with all second derivatives; None where it does not lower chi2."""
    dx, predicted = equations.step(now.graph, at, newton=True)
    trial = _trial(now.graph, dx)
    return trial if predicted > 0 and trial.at.chi2 < at.chi2 else None


def _trial(graph: PoseGraph, dx: np.ndarray, damping: float = 0.0) -> _Trial:
    """Where a step leads to; the same graph and an infinite chi2 for a step out of all bounds."""
    if not within_bounds(dx):
        return _Trial(graph, Residuals((), np.inf), dx, damping)
    moved = retract(graph, dx)
    return _Trial(moved, residuals(moved), dx, damping)


def _damped(data: np.ndarray, diagonal: np.ndarray, damping: float) -> np.ndarray:
    """H plus a multiple of its own diagonal, so that metres and radians are damped alike."""
    if damping == 0:
        return data
    damped = data.copy()
    damped[diagonal] *= 1 + damping
    return damped


def _next_reduction(previous: float, reduction: float) -> float:
    """What one more step is expected to bring, after two full ones; infinite where that cannot be said.

    Close to a minimum Gauss-Newton converges linearly at worst: the next reduction is to this one at most as this one
    was to the one before. That is relied on only where they fall fast.
    """
    return reduction**2 / previous if 0 < reduction < FAST_CONVERGENCE * previous < np.inf else np.inf


def _status(now: Iteration, trial: _Trial, converged: bool, max_iterations: int) -> str:
    if trial.stuck:
        return "no step lowers chi2"
    if converged:
        return "converged"
    return "running" if now.iteration + 1 < max_iterations else "iteration limit"
