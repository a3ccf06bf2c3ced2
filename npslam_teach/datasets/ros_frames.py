"""Where a sensor sits on the robot: 4x4 matrices that carry its points into the robot's frame.

ROS's frames (REP 103): of a body x points ahead, y left, z up; of a camera's picture (``..._optical_frame``) x right,
y down, z ahead. A transform that does not change is on /tf_static; one that does (a camera that pans) is not asked for.
"""

import math

import numpy as np

from npslam_teach.datasets.ros_messages import Bag
from npslam_teach.validation import LARGEST

TRANSFORMS = ("tf2_msgs/msg/TFMessage", "tf/msg/tfMessage")
STATIC_TOPIC = "/tf_static"
# From a camera's right, down, ahead to a body's ahead, left, up.
FROM_OPTICAL = np.array([[0.0, 0, 1, 0], [-1, 0, 0, 0], [0, -1, 0, 0], [0, 0, 0, 1]])


def mounting(bag: Bag, sensor: str, robot: str, mount, optical: bool | None) -> tuple[np.ndarray, str]:
    """How a sensor's points become the robot's, and a sentence that says on whose word.

    Args:
        bag: may hold /tf_static.
        sensor: the frame of the points.
        robot: the frame of which the odometry is.
        mount: (3,) m, m, rad of the sensor in the robot's frame; None: as /tf_static says, else at its origin.
        optical: whether the sensor's frame is a picture's; None: when its name ends in ``optical_frame``. With
            ``mount`` or ``optical`` /tf_static is not asked.

    Returns:
        (4, 4), and the sentence.

    Raises:
        ValueError: the bag is damaged.
    """
    if mount is None and optical is None:
        matrix = _static_transform(bag, sensor.strip("/"), robot.strip("/"))
        if matrix is not None:
            return matrix, f"{sensor or 'the sensor'}: mounted as {STATIC_TOPIC} says, {_placed(matrix)}"
    is_optical = sensor.endswith("optical_frame") if optical is None else optical
    x, y, yaw = (0.0, 0.0, 0.0) if mount is None else mount
    matrix = np.eye(4)
    matrix[:2, :2] = [[math.cos(yaw), -math.sin(yaw)], [math.sin(yaw), math.cos(yaw)]]
    matrix[:2, 3] = x, y
    why = "as --mount says" if mount is not None else f"so assumed, without --mount and a way on {STATIC_TOPIC}"
    axes = "z ahead (optical)" if is_optical else "x ahead"
    placed = f"{x:g} m ahead and {y:g} m left of {robot or 'the robot'}, turned by {yaw:g} rad"
    return matrix @ (FROM_OPTICAL if is_optical else np.eye(4)), f"{sensor or 'the sensor'}: {axes}, {placed}, {why}"


def rotation_of(quaternion) -> np.ndarray:
    """The rotation (3, 3) of a quaternion with any length; NaN for one without a length."""
    q = np.array([quaternion.w, quaternion.x, quaternion.y, quaternion.z], dtype=float)
    largest = np.abs(q).max()  # squares of the largest numbers do not exist
    if not 0 < largest < np.inf:
        return np.full((3, 3), np.nan)
    w, x, y, z = (q / largest) / np.linalg.norm(q / largest)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def _static_transform(bag: Bag, sensor: str, robot: str) -> np.ndarray | None:
    """The matrix along the tree of /tf_static; None when it does not lead from one frame to the other."""
    if STATIC_TOPIC not in bag.topics(*TRANSFORMS):
        return None
    parents = {}
    for message in bag.messages(STATIC_TOPIC):
        for each in message.transforms:
            matrix, shift = np.eye(4), each.transform.translation
            matrix[:3, :3] = rotation_of(each.transform.rotation)
            matrix[:3, 3] = shift.x, shift.y, shift.z
            if (np.abs(matrix) < LARGEST).all():
                parents[each.child_frame_id.strip("/")] = each.header.frame_id.strip("/"), matrix
    (top, sensor_in_top), (robots_top, robot_in_top) = _up(sensor, parents), _up(robot, parents)
    return np.linalg.inv(robot_in_top) @ sensor_in_top if top == robots_top else None


def _up(frame: str, parents: dict) -> tuple[str, np.ndarray]:
    """The top of the tree over a frame, and the frame in it; a ring, which is no tree, is followed once."""
    matrix = np.eye(4)
    for _ in range(len(parents)):
        if frame not in parents:
            break
        frame, step = parents[frame]
        matrix = step @ matrix
    return frame, matrix


def _placed(matrix: np.ndarray) -> str:
    return f"{matrix[0, 3]:.3f} m ahead, {matrix[1, 3]:.3f} m left and {matrix[2, 3]:.3f} m up"
