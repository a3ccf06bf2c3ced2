"""Bags of a robot that is known, written by rosbags' own writers: odometry, and detections in space or in pictures.

Definitions are those of vision_msgs 4 for ROS 2 and of 0.0.1 for ROS 1, written here once more: what reads must not
check itself.
"""

import sqlite3
from contextlib import contextmanager
from functools import cache
from pathlib import Path

import numpy as np
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from npslam_teach import se2

BEGIN = 1_790_000_000_123_456_789  # ns
FRAME = 100_000_000  # ns between two poses
MOUNT = (0.2, -0.1, 0.3)  # of the sensor on the robot: m, m, rad
FOCAL, WIDTH, HEIGHT = 60.0, 640, 120  # px; so wide that whatever is ahead is in the picture
ODOMETRY, BOXES, PICTURES = (
    "nav_msgs/msg/Odometry",
    "vision_msgs/msg/Detection3DArray",
    "vision_msgs/msg/Detection2DArray",
)
IMAGE, CAMERA, TRANSFORMS = "sensor_msgs/msg/Image", "sensor_msgs/msg/CameraInfo", "tf2_msgs/msg/TFMessage"

COMMON = {
    "Detection2DArray": "std_msgs/Header header\nDetection2D[] detections",
    "Detection3DArray": "std_msgs/Header header\nDetection3D[] detections",
    "BoundingBox3D": "geometry_msgs/Pose center\ngeometry_msgs/Vector3 size",
}
RESULTS = "std_msgs/Header header\nvision_msgs/ObjectHypothesisWithPose[] results\n"
LAYOUT_OF_ROS = {
    1: {
        "Detection2D": RESULTS + "vision_msgs/BoundingBox2D bbox\nsensor_msgs/Image source_img",
        "Detection3D": RESULTS + "vision_msgs/BoundingBox3D bbox\nsensor_msgs/PointCloud2 source_cloud",
        "ObjectHypothesisWithPose": "int64 id\nfloat64 score\ngeometry_msgs/PoseWithCovariance pose",
        "BoundingBox2D": "geometry_msgs/Pose2D center\nfloat64 size_x\nfloat64 size_y",
    },
    2: {
        "Detection2D": RESULTS + "vision_msgs/BoundingBox2D bbox\nstring id",
        "Detection3D": RESULTS + "vision_msgs/BoundingBox3D bbox\nstring id",
        "ObjectHypothesisWithPose": "ObjectHypothesis hypothesis\ngeometry_msgs/PoseWithCovariance pose",
        "ObjectHypothesis": "string class_id\nfloat64 score",
        "BoundingBox2D": "vision_msgs/Pose2D center\nfloat64 size_x\nfloat64 size_y",
        "Pose2D": "vision_msgs/Point2D position\nfloat64 theta",
        "Point2D": "float64 x\nfloat64 y",
    },
}


@cache
def _types(ros):
    types = {}
    for name, text in (COMMON | LAYOUT_OF_ROS[ros]).items():
        types |= get_types_from_msg(text, f"vision_msgs/msg/{name}")
    if ros == 1:  # which rosbags does not know for ROS 1
        types |= get_types_from_msg("geometry_msgs/TransformStamped[] transforms", TRANSFORMS)
    store = get_typestore(Stores.ROS1_NOETIC if ros == 1 else Stores.ROS2_HUMBLE)
    store.register(types)
    return store


class Messages:
    """Makes messages of one version of ROS out of plain numbers."""

    def __init__(self, ros):
        self.ros, self.store = ros, _types(ros)

    def make(self, name, *arguments):
        package, _, short = name.partition("/")
        return self.store.types[f"{package}/msg/{short}"](*arguments)

    def header(self, stamp, frame):
        time = self.make("builtin_interfaces/Time", int(stamp // 10**9), int(stamp % 10**9))
        return self.make("std_msgs/Header", *([0] if self.ros == 1 else []), time, frame)

    def point(self, xyz, kind="Point"):
        return self.make(f"geometry_msgs/{kind}", *map(float, xyz))

    def pose(self, xyz, quaternion=(0, 0, 0, 1)):
        turned = self.make("geometry_msgs/Quaternion", *map(float, quaternion))
        return self.make("geometry_msgs/Pose", self.point(xyz), turned)

    def uncertain(self, pose):
        return self.make("geometry_msgs/PoseWithCovariance", pose, np.zeros(36))

    def odometry(self, stamp, xyz, quaternion, frame="base_link"):
        still = self.make("geometry_msgs/Twist", self.point((0, 0, 0), "Vector3"), self.point((0, 0, 0), "Vector3"))
        twist = self.make("geometry_msgs/TwistWithCovariance", still, np.zeros(36))
        return self.make(
            "nav_msgs/Odometry", self.header(stamp, "odom"), frame, self.uncertain(self.pose(xyz, quaternion)), twist
        )

    def results(self, scores):
        """One result for each class and its score; classes are numbers in ROS 1."""
        nowhere = self.uncertain(self.pose((0, 0, 0)))
        if self.ros == 1:
            return [self.make("vision_msgs/ObjectHypothesisWithPose", int(c), s, nowhere) for c, s in scores.items()]
        pairs = [self.make("vision_msgs/ObjectHypothesis", str(c), s) for c, s in scores.items()]
        return [self.make("vision_msgs/ObjectHypothesisWithPose", pair, nowhere) for pair in pairs]

    def boxes(self, stamp, frame, seen):
        """Detections in space: (scores, x, y, z) each."""
        header = self.header(stamp, frame)
        found = [
            self.make(
                "vision_msgs/Detection3D",
                header,
                self.results(scores),
                self.make("vision_msgs/BoundingBox3D", self.pose(xyz), self.point((0.4, 0.4, 0.8), "Vector3")),
                self.source("PointCloud2", header),
            )
            for scores, *xyz in seen
        ]
        return self.make("vision_msgs/Detection3DArray", header, found)

    def pictures(self, stamp, frame, seen):
        """Detections in a picture: (scores, column, row, width, height) each."""
        header, found = self.header(stamp, frame), []
        for scores, u, v, width, height in seen:
            if self.ros == 1:
                centre = self.make("geometry_msgs/Pose2D", float(u), float(v), 0.0)
            else:
                point = self.make("vision_msgs/Point2D", float(u), float(v))
                centre = self.make("vision_msgs/Pose2D", point, 0.0)
            box = self.make("vision_msgs/BoundingBox2D", centre, float(width), float(height))
            results = self.results(scores)
            found.append(self.make("vision_msgs/Detection2D", header, results, box, self.source("Image", header)))
        return self.make("vision_msgs/Detection2DArray", header, found)

    def source(self, kind, header):
        """What ROS 1 puts beside a detection, left empty; ROS 2 has a tracker's name there, which nobody may read."""
        nothing = np.zeros(0, np.uint8)
        if self.ros == 2:
            return "the same for all"
        if kind == "Image":
            return self.make("sensor_msgs/Image", header, 0, 0, "", 0, 0, nothing)
        return self.make("sensor_msgs/PointCloud2", header, 0, 0, [], False, 0, 0, nothing, True)

    def image(self, stamp, pixels, encoding, big=False, padding=0, frame="camera_optical_frame"):
        """An image of (H, W) numbers of the type that the encoding means, rows padded by so many bytes."""
        kind = np.dtype({"32FC1": "f4", "16UC1": "u2", "rgb8": "u1"}[encoding]).newbyteorder(">" if big else "<")
        height, width = pixels.shape
        rows = pixels.astype(kind).view(np.uint8).reshape(height, -1)
        rows = np.hstack([rows, np.full((height, padding), 77, np.uint8)])
        header = self.header(stamp, frame)
        return self.make("sensor_msgs/Image", header, height, width, encoding, int(big), rows.shape[1], rows.ravel())

    def camera(self, stamp, frame="camera_optical_frame", width=WIDTH, height=HEIGHT, focal=FOCAL):
        k = np.array([focal, 0, (width - 1) / 2, 0, focal, (height - 1) / 2, 0, 0, 1.0])
        region = self.make("sensor_msgs/RegionOfInterest", 0, 0, 0, 0, False)
        r, p = np.eye(3).ravel(), np.zeros(12)
        header = self.header(stamp, frame)
        return self.make(
            "sensor_msgs/CameraInfo", header, height, width, "plumb_bob", np.zeros(5), k, r, p, 0, 0, region
        )

    def transforms(self, edges):
        """A message of (parent, child, xyz, quaternion) each."""
        found = []
        for parent, child, xyz, quaternion in edges:
            turned = self.make("geometry_msgs/Quaternion", *map(float, quaternion))
            move = self.make("geometry_msgs/Transform", self.point(xyz, "Vector3"), turned)
            found.append(self.make("geometry_msgs/TransformStamped", self.header(0, parent), child, move))
        return self.make("tf2_msgs/TFMessage", found)


@contextmanager
def bag_writer(path, ros=2, storage="sqlite3"):
    """A function ``write(topic, type, message, time)`` that adds to a new bag, and the maker of its messages.

    A message that is bytes already is written as it is.
    """
    messages, topics = Messages(ros), {}
    plugin = StoragePlugin.MCAP if storage == "mcap" else StoragePlugin.SQLITE3
    with Writer1(path) if ros == 1 else Writer2(path, version=9, storage_plugin=plugin) as bag:

        def write(topic, kind, message, time):
            if topic not in topics:
                topics[topic] = bag.add_connection(topic, kind, typestore=messages.store)
            serialize = messages.store.serialize_ros1 if ros == 1 else messages.store.serialize_cdr
            raw = message if isinstance(message, bytes) else serialize(message, kind)
            bag.write(topics[topic], int(time), raw)

        yield write, messages


def write_run(path, log, ros=2, storage="sqlite3", what="boxes", **pictures):
    """A bag of a log: a pose for each of its frames, and an array of detections, be it empty, for each.

    Quaternions are not normalised, messages are recorded late, and odometry after the detections of its time.
    """
    poses = se2.dead_reckoning(log.odometry, (1.0, -2.0, 2.5))
    with bag_writer(path, ros, storage) as (write, messages):
        for t, pose in enumerate(poses):
            stamp = BEGIN + t * FRAME
            late = stamp + 30_000_000
            mine = np.flatnonzero(log.obs_time == t)
            scores = [{9: 0.25, int(c): 0.75} if c != 9 else {9: 1.0} for c in log.obs_class[mine]]
            if what == "boxes":
                ahead, left = se2.apply_inverse(MOUNT, log.obs_xy[mine]).T
                seen = zip(scores, -left, np.full(len(mine), 0.1), ahead, strict=True)
                write("/detections", BOXES, messages.boxes(stamp, "camera_optical_frame", seen), late)
            else:
                _write_pictures(write, messages, stamp, scores, log.obs_xy[mine], **pictures)
            turned = np.array([0, 0, np.sin(pose[2] / 2), np.cos(pose[2] / 2)]) * 3.0
            write("/odom", ODOMETRY, messages.odometry(stamp, (*pose[:2], 0.0), turned), late + 1)
    return path


def _write_pictures(write, messages, stamp, scores, xy, encoding="32FC1", **image):
    """The camera is at the robot's origin. Each object has rows of its own, and a wall stands behind its edges."""
    depth, seen = np.full((HEIGHT, WIDTH), 0.0), []
    for k, (score, (ahead, left)) in enumerate(zip(scores, xy, strict=True)):
        u, v = FOCAL * -left / ahead + (WIDTH - 1) / 2, 10.0 * k + 5
        column = round(u)
        depth[10 * k : 10 * k + 10, max(column - 6, 0) : column + 7] = 9.0
        depth[10 * k + 2 : 10 * k + 9, max(column - 4, 0) : column + 5] = ahead
        depth[10 * k + 4, column] = np.nan if encoding == "32FC1" else 0.0
        seen.append((score, u, v, 12, 8))
    unit = 1.0 if encoding == "32FC1" else 1000.0
    pixels = depth * unit if encoding == "32FC1" else np.rint(depth * unit)
    late = stamp + 40_000_000
    write("/camera/depth/image_raw", IMAGE, messages.image(stamp + 4_000_000, pixels, encoding, **image), late)
    write("/camera/depth/camera_info", CAMERA, messages.camera(stamp), late)
    write("/camera/color/image_raw", IMAGE, messages.image(stamp, np.zeros((2, 2)), "rgb8"), late)
    write("/detections", PICTURES, messages.pictures(stamp, "camera_optical_frame", seen), late)


def forget_definitions(folder: Path):
    """Make a bag of ROS 2 as old as Humble, which stores no definitions."""
    (database,) = Path(folder).glob("*.db3")
    with sqlite3.connect(database) as connection:
        connection.execute("DELETE FROM message_definitions")
    connection.close()
