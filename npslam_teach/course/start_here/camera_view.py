"""What the robot's camera sees: the things of a room as icons, in perspective, and boxes around the sightings."""

import numpy as np

from npslam_teach import se2
from npslam_teach.course.scene import Panel, Scene
from npslam_teach.plotting.style import class_style
from npslam_teach.types import GroundTruth, RobotLog

VIEW = Panel((540.0, 36.0, 420.0, 330.0), (-210.0, 210.0), (330.0, 0.0))  # px, from the middle and from above
FIELD_OF_VIEW = np.deg2rad(120.0)
EYE, HORIZON = 0.6, 130.0  # m above the floor; px from above
NEAREST, FARTHEST = 0.02, 12.0  # m ahead
FOCAL = VIEW.box[2] / 2 / np.tan(FIELD_OF_VIEW / 2)  # px
# Outlines in metres, x to the right and up from the floor under the middle of the thing; by class.
_LEFT_HALF = {
    "chair": [(-0.24, 0.45), (-0.24, 0.95), None, (-0.16, 0.38), (-0.16, 0.0), (-0.22, 0.0), (-0.22, 0.38)],
    "screen": [(-0.36, 0.4), (-0.36, 0.9), None, (-0.05, 0.4), (-0.05, 0.08), (-0.2, 0.08), (-0.2, 0.0)],
    "lamp": [(-0.26, 0.85), (-0.12, 1.2), None, (-0.03, 0.85), (-0.03, 0.07), (-0.16, 0.07), (-0.16, 0.0)],
}
_CUP = [(-0.2, 0), (-0.2, 0.45), (0.2, 0.45), (0.2, 0.36), (0.32, 0.36), (0.32, 0.1), (0.2, 0.1), (0.2, 0)]
_BOOK = [(-0.26, 0), (-0.26, 0.46), (0, 0.5), (0.26, 0.46), (0.26, 0), (0, 0.04)]
HALF_WIDTH = {"chair": 0.24, "screen": 0.36, "cup": 0.32, "book": 0.26, "lamp": 0.26}
HEIGHT = {"chair": 0.95, "screen": 0.9, "cup": 0.45, "book": 0.5, "lamp": 1.2}


def outline_of(name: str) -> np.ndarray:
    """The outline of a thing, (N, 2) m: to the right of its middle, and up from the floor."""
    if name in ("cup", "book"):
        return np.array({"cup": _CUP, "book": _BOOK}[name], dtype=float)
    half = _LEFT_HALF[name]
    gap = half.index(None)
    upper, lower = half[:gap], half[gap + 1 :]
    mirrored = [(-x, y) for x, y in upper[::-1]]
    return np.array([*upper, *mirrored, *((-x, y) for x, y in lower), *lower[::-1]], dtype=float)


def project(pose: np.ndarray, xy: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Where things that stand on the floor appear to a pinhole camera, and how large.

    Args:
        pose: (3,) m, m, rad, W, of the camera, which looks along its heading.
        xy: (N, 2) m, W.

    Returns:
        (N, 2) px in ``VIEW``, of their feet; (N,) px per metre, not positive for what lies behind.
    """
    ahead, left = se2.apply_inverse(pose, xy).T
    with np.errstate(divide="ignore"):
        scale = FOCAL / ahead
    return np.column_stack([-left * scale, HORIZON + EYE * scale]), scale


def draw(scene: Scene, log: RobotLog, truth: GroundTruth, time: int) -> None:
    """The things before the camera, the far ones first, and a box around each that was sighted.

    Args:
        scene: gets them.
        log: has the sightings.
        truth: the pose of the camera, and the world.
        time: the pose.
    """
    left, top, width, height = VIEW.box
    scene.add("view title", "text", "what its camera sees", x=left, y=top - 10, class_="title")
    floor = {"x": left, "y": top + HORIZON, "width": width, "height": height - HORIZON, "fill": "#8a8a8a"}
    scene.add("floor", "rect", fill_opacity=0.18, **floor)
    for metres in (1, 2, 4):
        y = top + HORIZON + EYE * FOCAL / metres
        scene.add(f"floor {metres}", "line", x1=left, x2=left + width, y1=y, y2=y, class_="grid")
        scene.add(f"floor text {metres}", "text", f"{metres} m", x=left + 6, y=y - 3, class_="quiet small")
    world, (feet, scale) = truth.world, project(truth.poses[time], truth.world.object_xy)
    ahead = FOCAL / scale
    near = (ahead > NEAREST) & (ahead < FARTHEST) & (np.abs(feet[:, 0]) < width)
    for j in sorted(np.flatnonzero(near).tolist(), key=lambda j: -ahead[j]):
        _draw_thing(scene, j, feet[j], scale[j], int(world.object_class[j]), world.class_names)
    sighted = np.flatnonzero(log.obs_time == time)
    sighted = sighted[truth.obs_object[sighted] >= 0]
    for rank, k in enumerate(sighted[np.argsort(feet[truth.obs_object[sighted], 0])].tolist()):
        name = world.class_names[log.obs_class[k]]
        _draw_box(scene, int(truth.obs_object[k]), feet, scale, name, below=rank % 2 == 1)
    scene.add("view frame", "rect", x=left, y=top, width=width, height=height, class_="frame")


def _draw_thing(scene: Scene, j: int, foot: np.ndarray, scale: float, object_class: int, class_names) -> None:
    corners = VIEW.to_page(foot + scale * outline_of(class_names[object_class]) * (1, -1))
    points = " ".join(f"{x:.0f},{y:.0f}" for x, y in corners)
    look = {"fill": class_style(object_class)[0], "class_": "mark", "style": VIEW.clip(scene)}
    scene.add(f"thing {j}", "polygon", points=points, **look)


def _draw_box(scene: Scene, j: int, feet: np.ndarray, scale: np.ndarray, name: str, below: bool) -> None:
    """The detector's box with what it says, of a sighting that is of this thing."""
    half, height = HALF_WIDTH[name] * scale[j] + 5, HEIGHT[name] * scale[j] + 8
    x, y = VIEW.to_page(feet[j])[0]
    box = {"x": x - half, "y": y - height + 4, "width": 2 * half, "height": height, "style": VIEW.clip(scene)}
    scene.add(f"box {j}", "rect", class_="level", **box)
    # One above, the next below: two that stand side by side have room for their names.
    y += 20 if below else -height - 2
    scene.add(f"box name {j}", "text", name, x=x, y=y, class_="middle bold over", style=VIEW.clip(scene))
