"""The scene of the gates in lesson 09: objects with their gates, the robot on its path, and what it sees."""

import numpy as np

from npslam_teach import se2
from npslam_teach.course.filtering.moments import Moment
from npslam_teach.course.scene import Panel, Scene
from npslam_teach.methods.ekf import landmarks_of
from npslam_teach.plotting.style import class_style

SIZE = (980.0, 548.0)  # px
BOX = (70.0, 36.0, 890.0, 440.0)
DASHES = ("none", "2 4")  # of the gate and of the second gate
ROBOT = np.array([(0.2, 0.0), (-0.15, 0.11), (-0.08, 0.0), (-0.15, -0.11)])  # m, its outline, ahead and left


def draw_map(scene: Scene, room: Panel, moment: Moment, gates: tuple[float, float], names: list[str]) -> None:
    """The objects that the filter knows, and around where it expects them the gates.

    Args:
        scene: gets them.
        room: the map.
        moment: of the filter.
        gates: two Mahalanobis distances, solid and dotted.
        names: of the objects.
    """
    step = moment.step
    ticks = [np.arange(np.ceil(low), high, _spacing(high - low)) + 0.0 for low, high in (room.x, room.y)]
    title = f"before the sightings of pose {step.time} are used"
    room.axes(scene, "map", title, ("x (m)", "y (m)"), tuple(ticks))
    for j in moment.gated:
        for gate, dashes in zip(gates, DASHES, strict=True):
            _draw_gate(scene, room, moment, int(j), gate, dashes)
    for j, (xy, c) in enumerate(zip(landmarks_of(step.prior_mean), step.object_class.tolist(), strict=True)):
        room.mark(scene, f"object {j}", xy, c, 9.0)
    for j in moment.gated:  # the others would crowd the map
        room.text(scene, f"name {j}", landmarks_of(step.prior_mean)[j], names[j], (0.0, 26.0), "middle over")


def _spacing(length: float) -> float:
    return 1.0 if length < 12 else 5.0


def _draw_gate(scene: Scene, room: Panel, moment: Moment, j: int, gate: float, dashes: str) -> None:
    """An ellipse: the innovation's covariance, turned with the robot; the map has one scale for both axes."""
    pose, scale = moment.step.prior_mean[:3], room.scale[0]
    variances, axes = np.linalg.eigh(moment.innovation_cov[j])
    x, y = room.to_page(se2.apply(pose, moment.expected[j]))[0]
    turn = -(pose[2] + np.arctan2(axes[1, 1], axes[0, 1])) % np.pi  # on the page y runs downwards
    long, short = gate * np.sqrt(variances[::-1]) * scale
    ends = np.array([x, y]) + np.outer((1, -1), long * np.array([np.cos(turn), np.sin(turn)]))
    (a, b), (c, d) = ends.round(1)
    arc = f"A{long:.1f},{short:.1f} {np.rad2deg(turn):.1f} 1 1 "
    look = {"fill": "none", "stroke": class_style(int(moment.step.object_class[j]))[0], "stroke_dasharray": dashes}
    name = f"gate {j}" if dashes == "none" else f"second gate {j}"
    outline = f"M{a},{b}{arc}{c},{d}{arc}{a},{b}"
    scene.add(name, "path", d=outline, stroke_width=1.8, style=room.clip(scene), **look)


def draw_sightings(scene: Scene, room: Panel, moment: Moment, seen_at, answers: list, order: list) -> None:
    """Each observation of this pose with its answer, tied to its object, and a handle to lead it by.

    Args:
        scene: gets them.
        room: the map.
        moment: of the filter.
        seen_at: (m, 2) m, W.
        answers: (m,) the object, negative where there is none, and the same in words.
        order: the observations in the order in which the control has them.
    """
    step = moment.step
    for k, xy, (chosen, text) in zip(step.observations.tolist(), seen_at, answers, strict=True):
        room.line(scene, f"sight {k}", [step.prior_mean[:2], xy], "grid")
        if chosen >= 0:
            room.line(scene, f"tie {k}", [xy, landmarks_of(step.prior_mean)[chosen]], "pull")
        x, y = room.to_page(xy)[0]
        cross = f"M{x - 6:.1f},{y - 6:.1f}l12,12M{x + 6:.1f},{y - 6:.1f}l-12,12"
        scene.add(f"sighting {k}", "path", d=cross, class_="estimate", style="stroke-width: 2.6")
        room.text(scene, f"answer {k}", xy, f"Obj_{k + 1}: {text}", (16.0, 5.0), "bold over")
    for k, xy in zip(step.observations.tolist(), seen_at, strict=True):
        label = f"Obj_{k + 1} at {xy[0]:.2f} m, {xy[1]:.2f} m"
        room.handle(scene, f"handle {k}", xy, ("xy", order.index(k)), label, radius=13.0)


def draw_path(scene: Scene, room: Panel, poses: dict[int, np.ndarray]) -> None:
    """The path along which the robot can be led.

    Args:
        scene: gets it.
        room: the map.
        poses: (3,) m, m, rad, W, by their number.
    """
    path = np.array(list(poses.values()))
    room.line(scene, "path", path[:, :2], "estimate")
    room.dots(scene, "poses", path[:, :2], 8)


def draw_robot(scene: Scene, room: Panel, poses: dict[int, np.ndarray], now: int) -> None:
    """The robot with its ring.

    Args:
        scene: gets them.
        room: the map.
        poses: (3,) m, m, rad, W, by their number: where it can be led.
        now: where it is.
    """
    outline = se2.apply(poses[now], ROBOT * max(1.0, 26 / room.scale[0]))
    corners = " ".join(f"{x:.1f},{y:.1f}" for x, y in room.to_page(outline))
    scene.add("robot", "polygon", points=corners, class_="ink")
    stops = [(pose[:2], {"pose": t}) for t, pose in poses.items()]
    label = f"robot at pose {now}; arrow keys lead it along its path"
    room.grip(scene, "robot ring", poses[now][:2], stops, label, r=19.0)
    style = {"y": room.box[1] + room.box[3] + 58, "class_": "quiet small"}
    scene.add("hint", "text", "lead the robot along its path by its ring", x=BOX[0], **style, data_hint="true")
    also = "; with the kernel running, a sighting can be dragged as well"
    scene.add("hint also", "text", also, x=BOX[0] + 236, **style, data_places="xy")
