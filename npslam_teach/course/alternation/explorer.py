"""The explorer of lesson 06: the rounds of the method, half a step at a time, with a play button."""

import math

import numpy as np

from npslam_teach.course import moving_scene
from npslam_teach.course.alternation import pictures
from npslam_teach.course.explorers import Explorer, player
from npslam_teach.course.scene import Panel, Scene
from npslam_teach.methods.np_graph import half_steps
from npslam_teach.types import GroundTruth, RobotLog, Snapshot

SIZE = (980.0, 560.0)  # px
MAP, COUNTS, OBJECTIVE = (60.0, 36.0, 560.0, 440.0), (700.0, 36.0, 260.0, 180.0), (700.0, 296.0, 260.0, 180.0)


def explore_alternation(log: RobotLog, truth: GroundTruth, rounds: int = 10) -> Explorer:
    """Play the rounds: the map on the left, beside it the number of objects and the objective.

    Args:
        log: what the robot measured.
        truth: drawn behind; the estimate is aligned to it.
        rounds: the largest number of rounds.
    """
    snapshots = half_steps(log, rounds=rounds)
    room = moving_scene.room_of(snapshots, truth, MAP)
    counts = np.array([s.num_objects for s in snapshots])
    objectives = np.array([s.objective for s in snapshots])
    panels = _panels(np.log10(counts), objectives)

    def update(half_step: int) -> tuple[str, Scene]:
        scene = Scene(SIZE)
        title = pictures.HALVES[(half_step - 1) % 2] if half_step else "start"
        moving_scene.draw_snapshot(scene, room, snapshots[half_step], log, truth, title)
        _draw_curves(scene, panels, counts, objectives, half_step)
        moving_scene.draw_key(scene, truth, (MAP[0], SIZE[1] - 12))
        return words(snapshots, half_step), scene

    position = player("half-step", len(snapshots) - 1)
    return Explorer(None, update, {"half_step": position.grid()}, half_step=position)


def _panels(powers: np.ndarray, objectives: np.ndarray) -> tuple[Panel, Panel]:
    """Axes of the two curves: powers of ten, and nats."""
    x, room = (-0.5, len(powers) - 0.5), 0.06 * np.ptp(objectives) + 1.0
    y = (float(np.floor(powers.min())), float(np.ceil(powers.max())))
    return Panel(COUNTS, x, y), Panel(OBJECTIVE, x, (float(objectives.min() - room), float(objectives.max() + room)))


def _draw_curves(scene: Scene, panels: tuple[Panel, Panel], counts, objectives, now: int) -> None:
    ticks = range(0, len(counts), 2)
    moving_scene.log_axes(scene, panels[0], "counts", f"{counts[now]} objects (log scale)", "", ticks)
    moving_scene.draw_curve(scene, panels[0], "counts", np.log10(counts), now)
    low, high = panels[1].y
    step = 10.0 ** np.floor(np.log10(high - low))
    y_ticks = np.arange(np.ceil(low / step) * step, high, step) + 0.0
    title = f"objective: {objectives[now]:.1f} nats"
    panels[1].axes(scene, "falls", title, ("half-step (number)", ""), (ticks, y_ticks))
    moving_scene.draw_curve(scene, panels[1], "falls", objectives, now)


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
