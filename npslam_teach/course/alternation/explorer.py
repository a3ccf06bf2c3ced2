"""The explorer of lesson 06: the rounds of the method, half a step at a time, with a play button."""

import math

import numpy as np
from matplotlib.axes import Axes

from npslam_teach import plotting
from npslam_teach.course.alternation import pictures
from npslam_teach.course.explorers import Explorer, player
from npslam_teach.methods.np_graph import half_steps
from npslam_teach.plotting import moving_map
from npslam_teach.plotting.style import ESTIMATE_COLOR, label_axes, legend_below
from npslam_teach.types import GroundTruth, RobotLog, Snapshot


def explore_alternation(log: RobotLog, truth: GroundTruth, rounds: int = 10) -> Explorer:
    """Play the rounds: the map on the left, beside it the number of objects and the objective.

    Args:
        log: what the robot measured.
        truth: drawn behind; the estimate is aligned to it.
        rounds: the largest number of rounds.
    """
    snapshots = half_steps(log, rounds=rounds)
    figure, (left, middle, right) = plotting.new_figure(1, 3, (14.0, 5.6), width_ratios=(1.5, 1, 1))
    move_map = moving_map.plot_moving_map(left, snapshots, log, truth)
    counts, objectives = _curve(middle, [s.num_objects for s in snapshots]), [s.objective for s in snapshots]
    label_axes(middle, "half-step (number)", "objects (number, log scale)", "objects")
    middle.set_yscale("log")
    falls = _curve(right, objectives)
    label_axes(right, "half-step (number)", "objective (nats)", "objective")
    legend_below(figure, moving_map.moving_map_handles(truth), columns=8)

    def update(half_step: int) -> str:
        move_map(snapshots[half_step], pictures.HALVES[(half_step - 1) % 2] if half_step else "start")
        counts.set_data([half_step], [snapshots[half_step].num_objects])
        falls.set_data([half_step], [objectives[half_step]])
        return words(snapshots, half_step)

    position = player("half-step", len(snapshots) - 1)
    return Explorer(figure, update, {"half_step": position.grid()}, half_step=position)


def words(snapshots: list[Snapshot], half_step: int) -> str:
    """What a half-step did, in numbers."""
    now = snapshots[half_step]
    if half_step == 0:
        return f"The start: {now.num_objects} objects, one for each sighting; objective {now.objective:.1f}."
    before, is_sweep = snapshots[half_step - 1], half_step % 2 == 1
    what = pictures.HALVES[(half_step - 1) % 2]
    moved = np.linalg.norm(now.graph.poses[:, :2] - before.graph.poses[:, :2], axis=1).max()
    then = f"{before.num_objects} objects became {now.num_objects}" if is_sweep else f"the path moved by {moved:.2f} m"
    went = f"objective {before.objective:.1f} to {now.objective:.1f}"
    return f"Round {math.ceil(half_step / 2)}, {what}: {then}; {went}."


def _curve(ax: Axes, values: list):
    """A curve over all half-steps and the marker that moves on it."""
    ax.plot(values, color=ESTIMATE_COLOR, linewidth=1.4)
    (here,) = ax.plot([], [], "o", color=ESTIMATE_COLOR, markersize=10, zorder=3)
    return here
