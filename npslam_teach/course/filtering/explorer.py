"""The filter's gates, which follow the robot: lead it along its path, or a sighting across the gates (lesson 09)."""

from itertools import islice

import numpy as np

from npslam_teach import evaluation, se2
from npslam_teach.course.explorers import Explorer, places, slider
from npslam_teach.course.filtering import gate_scene, pictures
from npslam_teach.course.filtering.moments import Moment, moment_of
from npslam_teach.course.scene import Panel, Scene
from npslam_teach.methods.ekf import landmarks_of
from npslam_teach.methods.ekf_slam import filter_steps
from npslam_teach.methods.gating import NEW, UNASSIGNED, assign
from npslam_teach.types import RobotLog

WIDEST = 6.0  # standard deviations
FARTHEST = 20  # poses before and behind the first one to which the robot can be led
FRAMES = {"gate": (0.5, 1.5, 3.0, 6.0), "second_gate": (0.5, 3.0, 5.3, 6.0)}  # without a kernel
MARGIN = 0.8  # m


def explore_gate(log: RobotLog, time: int, class_names: tuple, labels=None) -> Explorer:
    """Stop the filter before it uses the observations of a pose; move its gates, the robot, and what it sees.

    Args:
        log: what the robot measured.
        time: the pose at the start.
        class_names: (C,).
        labels: (M,) known associations, used instead of decisions before a pose; see ``filter_steps``.

    Raises:
        ValueError: no observation of this pose has the class of an object that is in the map by then.
    """
    moments = _moments(log, time, labels)
    names = pictures.object_names(moments[max(moments)].step.object_class, class_names)
    order = np.concatenate([each.step.observations for each in moments.values()]).tolist()
    room, poses = _room(moments), {t: each.step.prior_mean[:3] for t, each in moments.items()}

    def update(pose: int, gate: float, second_gate: float, xy: np.ndarray) -> tuple[str, Scene]:
        moment, second_gate = moments[pose], max(gate, second_gate)
        seen_at = xy[[order.index(k) for k in moment.step.observations.tolist()]]
        squared = moment.squared_distance_of(se2.apply_inverse(poses[pose], seen_at))
        answers = assign(squared, gate**2, second_gate**2).tolist()
        told = [{UNASSIGNED: "left out", NEW: "new"}.get(each) or names[each] for each in answers]
        scene = Scene(gate_scene.SIZE)
        gate_scene.draw_map(scene, room, moment, (gate, second_gate), names)
        gate_scene.draw_path(scene, room, poses)
        gate_scene.draw_sightings(scene, room, moment, seen_at, list(zip(answers, told, strict=True)), order)
        gate_scene.draw_robot(scene, room, poses, pose)
        return in_words(moment, squared, told, names, (gate, second_gate)), scene

    seen_at = np.concatenate([se2.apply(poses[t], each.xy_robot) for t, each in moments.items()])
    sliders = _sliders(time, moments)
    frames = ({"pose": sliders["pose"].grid()} if len(moments) <= FARTHEST else {}) | FRAMES
    return Explorer(None, update, frames, **sliders, xy=places("sightings", seen_at, room))


def _moments(log: RobotLog, time: int, labels) -> dict[int, Moment]:
    """The moments to which the robot can be led, by their pose; ValueError where there is nothing to ask."""
    if not 0 <= time < log.num_poses:
        raise ValueError(f"time: expected a pose from 0 to {log.num_poses - 1}, got {time}")
    steps = islice(filter_steps(log, labels=labels), max(0, time - FARTHEST), time + FARTHEST + 1)
    moments = {step.time: moment_of(step, log) for step in steps}
    if not np.isfinite(moments[time].squared_distance).any():
        raise ValueError(f"time: expected a pose that sees a known object's class, pose {time} does not")
    return moments


def _sliders(time: int, moments: dict[int, Moment]) -> dict:
    return {
        "pose": slider("the robot is at pose", time, min(moments), max(moments), 1),
        "gate": slider("gate (st. deviations)", 3.0, 0.5, WIDEST, 0.1),
        "second_gate": slider("second gate (st. dev.)", 5.3, 0.5, WIDEST, 0.1),
    }


def in_words(moment: Moment, squared: np.ndarray, told: list[str], names: list[str], gates: tuple) -> str:
    """The gates, and for every observation its distances to the three nearest objects and the decision."""
    share = 100 * evaluation.share_within(gates[0])
    sizes = f"Gates at {gates[0]:.1f} and {gates[1]:.1f} standard deviations"
    parts = [f"{sizes}; {share:.1f} % of right matches pass the first."]
    for k, row, answer in zip(moment.step.observations, squared, told, strict=True):
        order = [j for j in np.argsort(row, kind="stable")[:3] if np.isfinite(row[j])]
        far = ", ".join(f"{names[j]} at {np.sqrt(row[j]):.2f}" for j in order) or "no object of its class"
        parts.append(f"Obj_{k + 1}: {far}; {answer}.")
    return " ".join(parts) if told else f"{parts[0]} Nothing is seen from pose {moment.step.time}."


def _room(moments: dict[int, Moment]) -> Panel:
    """A map that holds path, objects, observations and what is expected of the objects, one scale for both axes."""
    points = []
    for moment in moments.values():
        pose = moment.step.prior_mean[:3]
        points += [pose[None, :2], landmarks_of(moment.step.prior_mean), se2.apply(pose, moment.xy_robot)]
    return Panel.around(np.concatenate(points), MARGIN, gate_scene.BOX)
