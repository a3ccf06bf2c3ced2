"""An RGB-D camera in the office: a small ray-traced image with depth, and the boxes that a detector finds in it.

Every object is a few boxes and upright cylinders, the room a box seen from inside. A ray enters a convex body where it
has entered all the slabs that bound it, and has not yet left any (Kay and Kajiya 1986). A pixel shows the body that its
ray enters first.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from npslam_teach import se2
from npslam_teach.camera import Intrinsics
from npslam_teach.simulate.office import DESKS, OFFICE_CLASSES, ROOM_SIZE, OfficeScene, office_scene
from npslam_teach.simulate.office import office_sensor as _office_sensor
from npslam_teach.simulate.office_shapes import (
    COLORS,
    DESK_COLOR,
    DESK_SHAPE,
    DESK_TOP,
    FLOOR_COLOR,
    SHAPES,
    WALL_COLOR,
)

CAMERA_HEIGHT = 1.1  # m above the floor; the optical axis is horizontal
CEILING = 2.7  # m
MAX_DEPTH = 4.5  # m; beyond it the sensor gives no reading
MIN_PIXELS, MIN_SHARE = 20, 0.6  # visible pixels of an object, and their share, that the detector needs
TOP_LIGHT, FRONT_LIGHT, SIDE_LIGHT = 1.0, 0.85, 0.7  # share of the light on a horizontal face and on the others


@dataclass(frozen=True, eq=False)
class RgbdFrame:
    """What the camera and the detector report; it holds no identity of an object."""

    rgb: np.ndarray  # (H, W, 3) in [0, 1]
    depth: np.ndarray  # (H, W) m along the optical axis; 0 is no reading
    boxes: np.ndarray  # (N, 4) x1 y1 x2 y2 px, without column x2 and row y2
    obs_class: np.ndarray  # (N,) the detector's most likely class
    score: np.ndarray  # (N,) how sure it is, in [0, 1]
    intrinsics: Intrinsics


@dataclass(frozen=True, eq=False)
class FrameTruth:
    """The ground truth of a frame; for pictures and for evaluation."""

    object_at: np.ndarray  # (H, W) index of the object that a pixel shows; -1: room or desk
    obs_object: np.ndarray  # (N,) the object in each box
    obs_xy: np.ndarray  # (N, 2) m, its true centre: ahead, left


class Body(NamedTuple):
    """One box or upright cylinder in W."""

    is_round: bool
    pose: np.ndarray  # (3,) of its own frame in W
    half: np.ndarray  # (2,) m
    z: tuple  # m, from and to
    color: tuple
    of_object: int  # -1: furniture


def rendered_frame(scene: OfficeScene | int, pose_index: int) -> RgbdFrame:
    """What the camera sees and the detector finds from one pose of the true path (deck figure 18).

    Depth errs as measured for the first Kinect, ``0.0012 + 0.0019 (z - 0.4)^2`` m (Nguyen, Izadi and Lovell 2012). The
    detector finds what shows at least 20 pixels and is hidden by less than about half, draws its box up to 3 pixels too
    wide on each side, and confuses classes as ``office_sensor`` says.

    Args:
        scene: from ``office_scene``, or its seed.
        pose_index: which pose; the same scene and pose always give the same frame.
    """
    return rendered_frame_and_truth(scene, pose_index)[0]


def rendered_frame_and_truth(scene: OfficeScene | int, pose_index: int) -> tuple[RgbdFrame, FrameTruth]:
    """The frame of ``rendered_frame``, and its ground truth."""
    scene = scene if isinstance(scene, OfficeScene) else office_scene(scene)
    rng = np.random.default_rng([scene.seed, 2, pose_index])
    camera, pose = office_camera(), scene.path[pose_index]
    exact, rgb, object_at, whole = cast(bodies_of(scene), pose, camera)
    noise = 0.0012 + 0.0019 * (exact - 0.4) ** 2
    depth = np.where(exact < MAX_DEPTH, exact + noise * rng.normal(size=exact.shape), 0.0)
    pixels = np.bincount(object_at[(object_at >= 0) & (depth > 0)], minlength=len(whole))
    obj = np.flatnonzero((pixels >= MIN_PIXELS) & (pixels >= MIN_SHARE * whole))
    boxes = np.array([_widened_box(object_at == k, rng) for k in obj]).reshape(-1, 4)
    confusion = _office_sensor().class_confusion
    obs_class = [rng.choice(len(confusion), p=confusion[c]) for c in scene.world.object_class[obj]]
    frame = RgbdFrame(rgb, depth, boxes, np.array(obs_class, int), rng.uniform(0.6, 1.0, len(obj)).round(2), camera)
    return frame, FrameTruth(object_at, obj, se2.apply_inverse(pose, scene.world.object_xy[obj]))


def office_camera() -> Intrinsics:
    """160 x 120 pixels, as wide as the sensor of the office."""
    return Intrinsics.from_field_of_view(160, 120, _office_sensor().field_of_view)


def bodies_of(scene: OfficeScene) -> list[Body]:
    """The desks and every object, as boxes and cylinders."""
    bodies = [body for desk in DESKS for body in _placed(DESK_SHAPE, desk, 0.0, DESK_COLOR, -1)]
    for k, (xy, c) in enumerate(zip(scene.world.object_xy, scene.world.object_class, strict=True)):
        name = OFFICE_CLASSES[c]
        on_desk = scene.at_desk[k] >= 0 and name != "chair"
        pose = np.append(xy, scene.yaw[k])
        bodies += _placed(SHAPES[name], pose, DESK_TOP if on_desk else 0.0, COLORS[name], k)
    return bodies


def _placed(shape: tuple, pose: np.ndarray, base: float, color: tuple, of_object: int) -> list[Body]:
    return [
        Body(
            is_round,
            se2.compose(pose, [0, y, 0]),
            np.array([half_x, half_y]),
            (base + low, base + high),
            color,
            of_object,
        )
        for is_round, half_x, half_y, low, high, y in shape
    ]


def cast(
    bodies: list[Body], pose: np.ndarray, camera: Intrinsics
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """The nearest body along the ray of every pixel.

    Args:
        bodies: what stands in the room.
        pose: (3,) of the robot, W.
        camera: at ``CAMERA_HEIGHT`` over it.

    Returns:
        (H, W) m, depth; (H, W, 3) colour; (H, W) index of the object, -1 for room and furniture; (K,) how many pixels
        each object would cover if nothing hid it.
    """
    v, u = np.mgrid[: camera.height, : camera.width]
    # How far a ray goes to the left and up for each metre ahead: so the parameter along the ray is the depth.
    left, up = (camera.cx - u) / camera.fx, (camera.cy - v) / camera.fy
    depth, rgb = _room(pose, left, up)
    object_at = np.full(depth.shape, -1)
    whole = np.zeros(1 + max(body.of_object for body in bodies), int)
    for body in bodies:
        rows, cols = _window(body, pose, camera)
        enter, light = _enter(body, pose, left[rows, cols], up[rows, cols])
        seen = enter < depth[rows, cols]
        depth[rows, cols][seen] = enter[seen]
        rgb[rows, cols][seen] = light[seen, None] * np.array(body.color)
        object_at[rows, cols][seen] = body.of_object
        if body.of_object >= 0:
            whole[body.of_object] += np.count_nonzero(np.isfinite(enter))
    return depth, rgb, object_at, whole


def _room(pose, left, up) -> tuple[np.ndarray, np.ndarray]:
    """Depth and colour of floor, walls and ceiling: where each ray leaves the room."""
    direction = se2.rotate(pose[2], np.stack([np.ones_like(left), left], axis=-1))
    leave_x = _slab(pose[0], direction[..., 0], 0.0, ROOM_SIZE[0])[1]
    leave_y = _slab(pose[1], direction[..., 1], 0.0, ROOM_SIZE[1])[1]
    leave_z = _slab(CAMERA_HEIGHT, up, 0.0, CEILING)[1]
    depth = np.minimum(np.minimum(leave_x, leave_y), leave_z)
    on_floor = (leave_z == depth) & (up < 0)
    light = np.where(leave_z == depth, TOP_LIGHT, np.where(leave_x == depth, FRONT_LIGHT, TOP_LIGHT))
    tile = np.floor(pose[:2] + depth[..., None] * direction).sum(axis=-1) % 2  # squares of one metre
    light = np.where(on_floor, light - 0.08 * tile, light)
    return depth, light[..., None] * np.where(on_floor[..., None], FLOOR_COLOR, WALL_COLOR)


def _enter(body: Body, pose: np.ndarray, left: np.ndarray, up: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Depth at which rays enter a body, infinite where they miss it, and the light on that face."""
    in_body = se2.between(body.pose, pose)
    direction = se2.rotate(in_body[2], np.stack([np.ones_like(left), left], axis=-1))
    if body.is_round:
        spans = [_disc(in_body[:2], direction, body.half[0])]
    else:
        spans = [_slab(in_body[axis], direction[..., axis], -body.half[axis], body.half[axis]) for axis in (1, 0)]
    spans.append(_slab(CAMERA_HEIGHT, up, *body.z))
    enters = np.stack([enter for enter, _ in spans])
    enter, leave = enters.max(axis=0), np.stack([leave for _, leave in spans]).min(axis=0)
    lights = np.array([FRONT_LIGHT, SIDE_LIGHT, TOP_LIGHT] if len(spans) == 3 else [FRONT_LIGHT, TOP_LIGHT])
    return np.where((enter < leave) & (enter > 0), enter, np.inf), lights[enters.argmax(axis=0)]


def _slab(origin: float, direction: np.ndarray, low: float, high: float) -> tuple[np.ndarray, np.ndarray]:
    """Where rays enter and leave the space between two parallel planes."""
    direction = np.where(np.abs(direction) < 1e-12, 1e-12, direction)  # parallel rays enter and leave very far away
    a, b = (low - origin) / direction, (high - origin) / direction
    return np.minimum(a, b), np.maximum(a, b)


def _disc(origin: np.ndarray, direction: np.ndarray, radius: float) -> tuple[np.ndarray, np.ndarray]:
    """Where rays enter and leave an upright tube around the origin."""
    a, b = (direction**2).sum(axis=-1), direction @ origin
    root = b**2 - a * (origin @ origin - radius**2)
    half = np.sqrt(np.maximum(root, 0.0))
    return np.where(root > 0, (-b - half) / a, np.inf), np.where(root > 0, (-b + half) / a, -np.inf)


def _window(body: Body, pose: np.ndarray, camera: Intrinsics) -> tuple[slice, slice]:
    """The rows and columns in which a body can appear; the rays of all other pixels are not tested against it."""
    corners = body.half * np.array([(-1, -1), (-1, 1), (1, -1), (1, 1)])
    ahead, left = se2.apply_inverse(pose, se2.apply(body.pose, corners)).T
    if ahead.max() <= 0.05:
        return slice(0, 0), slice(0, 0)
    if ahead.min() <= 0.05:
        return slice(None), slice(None)
    u = camera.cx - camera.fx * left / ahead
    v = camera.cy - camera.fy * (np.array(body.z)[:, None] - CAMERA_HEIGHT) / ahead
    return _clipped(v, camera.height), _clipped(u, camera.width)


def _clipped(pixels: np.ndarray, size: int) -> slice:
    low, high = np.floor(pixels.min()), np.ceil(pixels.max()) + 1
    return slice(int(np.clip(low, 0, size)), int(np.clip(high, 0, size)))


def _widened_box(mask: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """The box around the pixels of a mask, up to 3 pixels too wide on each side."""
    v, u = np.nonzero(mask)
    slack = rng.integers(0, 4, 4)
    height, width = mask.shape
    low = np.maximum([u.min() - slack[0], v.min() - slack[1]], 0)
    high = np.minimum([u.max() + 1 + slack[2], v.max() + 1 + slack[3]], [width, height])
    return np.concatenate([low, high])
