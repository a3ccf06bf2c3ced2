"""Detections on a ROS topic as points in the frame of the sensor: vision_msgs of ROS 2, and its older layouts.

A 3-D box has its centre. A box in a picture has a place only with the depth behind its pixels and the camera's matrix.
"""

from collections import Counter
from dataclasses import dataclass, replace

import numpy as np

from npslam_teach.camera import Intrinsics, back_project
from npslam_teach.datasets.ros_messages import Bag, stamp_of
from npslam_teach.system.files import shorten
from npslam_teach.validation import LARGEST

BOXES_2D, BOXES_3D = ("vision_msgs/msg/Detection2DArray",), ("vision_msgs/msg/Detection3DArray",)
IMAGE, CAMERA = ("sensor_msgs/msg/Image",), ("sensor_msgs/msg/CameraInfo",)
ENCODINGS = {"32FC1": ("f4", 1.0), "16UC1": ("u2", 0.001), "mono16": ("u2", 0.001)}  # type, m per unit
LEAST_FOCAL = 1e-3  # px; what is below was never a camera
SAME_TIME = 50_000_000  # ns between a picture's boxes and its depth


@dataclass(frozen=True, eq=False)
class Seen:
    """What one message tells."""

    stamp: int  # ns
    frame: str  # the name of the sensor's frame
    names: tuple[str, ...]  # n classes
    boxes: np.ndarray  # (n, 3) m, the centre; of a picture (n, 4) px: column and row of the centre, width, height


def read_detections(bag: Bag, topic: str, min_score: float, dropped: Counter) -> list[Seen]:
    """All messages of a topic; what cannot be used is left out and counted.

    Args:
        bag: open.
        topic: of either type.
        min_score: a detection's largest score is at least this.
        dropped: counts by reason; added to.
    """
    is_3d, found = topic in bag.topics(*BOXES_3D), []
    for message in bag.messages(topic):
        headers = [message.header, *(each.header for each in message.detections[:1])]
        stamp = next((stamp_of(each) for each in headers if stamp_of(each)), 0)
        frame = next((each.frame_id for each in headers if each.frame_id), "")
        if not stamp:
            dropped["detections without a time stamp"] += len(message.detections)
            continue
        kept = _usable(message.detections, is_3d, min_score, dropped)
        boxes = np.array([box for _, box in kept], dtype=float).reshape(-1, 3 if is_3d else 4)
        found.append(Seen(stamp, frame, tuple(name for name, _ in kept), boxes))
    return found


def with_depth(bag: Bag, seen: list[Seen], depth_topic, camera_topic, dropped: Counter) -> tuple[list[Seen], str]:
    """Boxes in pictures as points in space, each from the depth image next in time.

    The depth of a box is the median of the readings in its middle, half as wide and as high as the box.

    Args:
        bag: open.
        seen: with boxes in pictures.
        depth_topic: depth registered to the pictures; None: the only image topic that has depth in its name.
        camera_topic: the camera's matrix; None: the only one, or the one beside the depth images.
        dropped: counts by reason; added to.

    Returns:
        the same with (n, 3) m right, down, ahead, in the camera's frame, and a sentence about what was used.

    Raises:
        ValueError: no such topic, an unknown encoding, images of another size than the camera's.
    """
    depth_topic = _depth_topic(bag, depth_topic)
    camera_topic = _camera_topic(bag, camera_topic, depth_topic)
    intrinsics, frame, is_distorted = _camera(bag, camera_topic)
    seen = sorted(seen, key=lambda each: each.stamp)
    stamps, points = np.array([each.stamp for each in seen]), [None] * len(seen)
    nearest = np.full(len(seen), SAME_TIME + 1)
    for image in bag.messages(depth_topic):
        away = np.abs(stamps - stamp_of(image.header))
        closer = np.flatnonzero(away < nearest)
        depth = _metres(image, intrinsics, depth_topic) if closer.size else None
        for k in closer:
            points[k], nearest[k] = _points(depth, seen[k].boxes, intrinsics), away[k]
    located = []
    for each, xyz in zip(seen, points, strict=True):
        if xyz is None:
            dropped["detections without a depth image of their time"] += len(each.names)
            xyz = np.full((len(each.names), 3), np.nan)
        else:
            dropped["detections without a valid depth"] += int(np.isnan(xyz[:, 2]).sum())
        kept = np.flatnonzero(~np.isnan(xyz[:, 2]))
        names = tuple(each.names[i] for i in kept)
        located.append(replace(each, frame=frame or each.frame, names=names, boxes=xyz[kept]))
    distortion = "; the lens's distortion is not undone" if is_distorted else ""
    return located, f"depth of {depth_topic}, camera matrix of {camera_topic}{distortion}"


def _usable(detections, is_3d: bool, min_score: float, dropped: Counter) -> list[tuple[str, list[float]]]:
    """Class and box of each detection that has both; the others are counted."""
    kept = []
    for each in detections:
        name, score = _best(each.results)
        box = _box_3d(each.bbox) if is_3d else _box_2d(each.bbox)
        if name is None:
            dropped["detections without a class"] += 1
        elif score < min_score:
            dropped[f"detections scored below {min_score:g}"] += 1
        elif box is None:
            dropped["detections without a position"] += 1
        else:
            kept.append((name, box))
    return kept


def _best(results) -> tuple[str | None, float]:
    """Class and score of the result with the largest score, in either layout; None without one."""
    scored = [getattr(each, "hypothesis", each) for each in results]
    scored = [each for each in scored if not np.isnan(each.score)]
    if not scored:
        return None, 0.0
    best = max(scored, key=lambda each: each.score)
    return str(getattr(best, "class_id", getattr(best, "id", ""))), float(best.score)


def _box_3d(bbox) -> list[float] | None:
    """The centre; None where nobody filled it in, which would be an object inside the sensor."""
    centre = bbox.center.position
    xyz = [centre.x, centre.y, centre.z]
    return xyz if _is_sane(xyz) and any(xyz) else None


def _box_2d(bbox) -> list[float] | None:
    centre = getattr(bbox.center, "position", bbox.center)  # vision_msgs 4, or before
    box = [centre.x, centre.y, bbox.size_x, bbox.size_y]
    return box if _is_sane(box) and bbox.size_x > 0 and bbox.size_y > 0 else None


def _is_sane(numbers: list[float]) -> bool:
    return bool(np.all(np.abs(numbers) < LARGEST))  # false for NaN


def _depth_topic(bag: Bag, asked: str | None) -> str:
    named = [topic for topic in bag.topics(*IMAGE) if "depth" in topic.lower()]
    return bag.topic_of(named[0] if asked is None and len(named) == 1 else asked, IMAGE, "--depth-topic")


def _camera_topic(bag: Bag, asked: str | None, depth_topic: str) -> str:
    beside = depth_topic.rpartition("/")[0] + "/camera_info"
    if asked is None and beside in bag.topics(*CAMERA):
        asked = beside
    return bag.topic_of(asked, CAMERA, "--camera-info-topic")


def _camera(bag: Bag, topic: str) -> tuple[Intrinsics, str, bool]:
    """The camera, its frame, and whether its lens distorts, by the first message."""
    message = next(bag.messages(topic), None)
    if message is None:
        raise ValueError(f"{topic}: expected a message with the camera's matrix, got none")
    k = np.asarray(message.k if hasattr(message, "k") else message.K, dtype=float).reshape(3, 3)
    distortion = message.d if hasattr(message, "d") else message.D
    if not ((np.abs(k) < LARGEST).all() and min(k[0, 0], k[1, 1]) > LEAST_FOCAL):
        raise ValueError(f"{topic}: expected a matrix K with focal lengths above zero, got {shorten(k.tolist())}")
    camera = Intrinsics(int(message.width), int(message.height), k[0, 0], k[1, 1], k[0, 2], k[1, 2])
    return camera, message.header.frame_id, bool(np.any(distortion))


def _metres(image, intrinsics: Intrinsics, topic: str) -> np.ndarray:
    """A depth image (H, W) in metres, 0 where it has no reading."""
    if image.encoding not in ENCODINGS:
        raise ValueError(f"{topic}: expected the encoding {' or '.join(ENCODINGS)}, got {shorten(image.encoding)}")
    kind, unit = ENCODINGS[image.encoding]
    kind = np.dtype(kind).newbyteorder(">" if image.is_bigendian else "<")
    size, wanted = (image.width, image.height), (intrinsics.width, intrinsics.height)
    if size != wanted:
        registered = "depth must be registered to the pictures"
        raise ValueError(f"{topic}: expected images of the camera's {wanted} pixels, got {size}: {registered}")
    row, data = image.width * kind.itemsize, np.asarray(image.data, dtype=np.uint8)
    if image.step < row or len(data) < image.step * image.height:
        raise ValueError(f"{topic}: expected {image.height} rows of at least {row} bytes, got {len(data)} bytes")
    rows = data[: image.step * image.height].reshape(image.height, image.step)[:, :row]
    depth = np.ascontiguousarray(rows).view(kind).astype(float) * unit
    return np.where((depth > 0) & (depth < LARGEST), depth, 0.0)


def _points(depth: np.ndarray, boxes: np.ndarray, intrinsics: Intrinsics) -> np.ndarray:
    """(n, 3) m right, down, ahead of boxes (n, 4) px; NaN where the middle of a box has no reading."""
    metres = np.full(len(boxes), np.nan)
    for k, (u, v, width, height) in enumerate(boxes):
        rows, columns = _middle(v, height, depth.shape[0]), _middle(u, width, depth.shape[1])
        readings = depth[rows, columns]
        readings = readings[readings > 0]
        if readings.size:
            metres[k] = np.median(readings)
    return back_project(boxes[:, 0], boxes[:, 1], metres, intrinsics)


def _middle(centre: float, size: float, limit: int) -> slice:
    """The pixels of the half around the middle, at least one, of those that a picture has."""
    low, high = np.clip(np.rint([centre - size / 4, centre + size / 4]), -1, limit).astype(int)
    return slice(max(low, 0), high + 1)
