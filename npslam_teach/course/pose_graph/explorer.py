"""The explorer of lesson 03: Gauss-Newton, one iteration per click."""

from dataclasses import replace

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from npslam_teach import plotting, se2, simulate
from npslam_teach.course.explorers import Explorer, choice, player
from npslam_teach.evaluation import true_association_fit
from npslam_teach.plotting import factor_graph
from npslam_teach.plotting.style import (
    ESTIMATE_COLOR,
    TRUTH_COLOR,
    class_style,
    label_axes,
    label_map,
    legend_below,
    path_handles,
)
from npslam_teach.pose_graph import Iteration, levenberg_marquardt
from npslam_teach.types import GroundTruth, PoseGraph


def bad_starts(seed: int = 0) -> tuple[dict[str, PoseGraph], GroundTruth]:
    """A drive of 70 m in steps of 1 m, with odometry noise of 0.1 m and 0.1 rad per step, and two bad initial guesses.

    Associations are known, positions are not: all objects start in the middle of the room.

    Args:
        seed: of the run and of the second guess; the room is that of ``fifteen_objects()``.

    Returns:
        by name: the odometry path, and the same with noise of 2 m and 0.5 rad on all poses but pose 0; and the truth.
    """
    rng = np.random.default_rng(seed)
    slippery = replace(simulate.paper_sensor(), odometry_std=(0.1, 0.1, 0.1))
    world = simulate.fifteen_objects()[1].world
    log, truth = simulate.simulate_run(world, simulate.designed_path(1.0), slippery, rng)
    graph = true_association_fit(log, truth)
    lost = replace(graph, landmarks=np.full(graph.landmarks.shape, 5.0))
    drifted = se2.dead_reckoning(log.odometry, truth.poses[0])
    thrown = drifted + rng.normal(size=drifted.shape) * (2.0, 2.0, 0.5)
    thrown[0] = drifted[0]
    return {"wheels": replace(lost, poses=drifted), "thrown about": replace(lost, poses=thrown)}, truth


def explore_gauss_newton(starts: dict[str, PoseGraph], true_xy: np.ndarray | None = None) -> Explorer:
    """A slider over the iterations of the solver, from each of several starts; the lines of the map are the factors.

    Args:
        starts: graphs with the same factors and different estimates, by the name that the list shows.
        true_xy: (T, 2) m, W, the true path, dashed grey when given.
    """
    runs = {name: list(levenberg_marquardt(graph)) for name, graph in starts.items()}
    figure, (left, right) = plotting.new_figure(1, 2, (10.0, 5.2), width_ratios=(3, 2))
    steps, observations, objects = _empty_map(left)
    if true_xy is not None:
        plotting.plot_trajectory(left, true_xy, truth=True)
    _fix_limits(left, [step.graph for run in runs.values() for step in run])
    curve, here = _chi2_curve(right, runs)
    legend_below(figure, _handles(objects, true_xy is not None))

    def update(start: str, iteration: int) -> str:
        run = runs[start]
        iteration = min(iteration, len(run) - 1)
        graph = run[iteration].graph
        steps.set_segments(factor_graph.odometry_segments(graph))
        observations.set_segments(factor_graph.observation_segments(graph))
        objects.set_data(*graph.landmarks.T)
        curve.set_data(range(len(run)), [step.chi2 for step in run])
        here.set_data([iteration], [run[iteration].chi2])
        left.set_title(f"iteration {iteration}")
        return words(run, iteration)

    last = max(len(run) for run in runs.values()) - 1
    names = choice("start", {name: name for name in runs})
    iterations = player("iteration", last)
    return Explorer(figure, update, {"iteration": iterations.grid()}, start=names, iteration=iterations)


def words(run: list[Iteration], iteration: int) -> str:
    """What an iteration did, in numbers."""
    step = run[iteration]
    if iteration == 0:
        return f"Iteration 0, the start: chi2 is {step.chi2:.0f}."
    before = run[iteration - 1]
    moved = np.linalg.norm(step.graph.poses[:, :2] - before.graph.poses[:, :2], axis=1).max()
    damped = " (damped)" if step.damping else ""
    end = " This is the last one: chi2 falls no more." if step.converged else ""
    fell = f"chi2 went from {before.chi2:.0f} to {step.chi2:.0f}"
    return f"Iteration {iteration}: {fell}; no pose moved more than {moved:.2f} m{damped}.{end}"


def _empty_map(ax) -> tuple[LineCollection, LineCollection, Line2D]:
    """The lines of the factors, and the objects, all without positions yet."""
    steps, observations = (
        LineCollection([], **style) for style in (factor_graph.ODOMETRY_LINE, factor_graph.OBSERVATION_LINE)
    )
    ax.add_collection(observations)
    ax.add_collection(steps)
    color, marker = class_style(0)
    (objects,) = ax.plot([], [], linestyle="none", marker=marker, markersize=8, color=color, zorder=2.4)
    return steps, observations, objects


def _fix_limits(ax, graphs: list[PoseGraph]) -> None:
    """Set limits that hold every iteration of every start, so that only the estimate moves."""
    points = np.concatenate([xy[:, :2] for graph in graphs for xy in (graph.poses, graph.landmarks)])
    low, high = points.min(axis=0) - 0.5, points.max(axis=0) + 0.5
    ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
    label_map(ax, "iteration 0")


def _chi2_curve(ax, runs: dict[str, list[Iteration]]) -> tuple[Line2D, Line2D]:
    """The curve of chi2 and the dot on it, on an axis that holds every run."""
    values = np.array([max(step.chi2, 1e-9) for run in runs.values() for step in run])
    (curve,) = ax.plot([], [], "o-", color=TRUTH_COLOR, markersize=5, linewidth=1.5)
    (here,) = ax.plot([], [], "o", color=ESTIMATE_COLOR, markersize=12, zorder=3)
    ax.set_yscale("log")
    ax.minorticks_off()  # on a log axis drawing them takes a third of the time
    longest = max(len(run) for run in runs.values())
    ax.set(xlim=(-0.4, longest - 0.6), ylim=(values.min() / 2, values.max() * 2))
    ax.xaxis.set_major_locator(MaxNLocator(integer=True))
    label_axes(ax, "iteration (number)", "$\\chi^2$ (no unit, log scale)", "$\\chi^2$ of every iteration")
    return curve, here


def _handles(objects: Line2D, with_truth: bool) -> list[Line2D]:
    objects = Line2D([], [], linestyle="none", marker=objects.get_marker(), color=objects.get_color(), label="object")
    lines = factor_graph.factor_handles(pull=False)[1:]
    return [*lines, objects, *path_handles(("true path",) if with_truth else ())]
