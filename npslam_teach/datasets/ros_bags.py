"""Bags of ROS 1 and 2 as logs: ``nav_msgs/Odometry``, and ``vision_msgs`` with boxes in space or in pictures.

The rest is in three parts: ``ros_messages`` (the bag), ``ros_detections`` (what was seen, in the sensor's frame) and
``ros_frames`` (where the sensor is on the robot). Everything is put on the floor: heights, roll and pitch are left out.
"""

import math
from collections import Counter

import numpy as np

from npslam_teach import se2
from npslam_teach.datasets.ros_detections import BOXES_2D, BOXES_3D, Seen, read_detections, with_depth
from npslam_teach.datasets.ros_frames import mounting, rotation_of
from npslam_teach.datasets.ros_messages import Bag, open_bag, stamp_of
from npslam_teach.datasets.trajectories import keyframes
from npslam_teach.system.files import prefix_errors
from npslam_teach.types import RobotLog
from npslam_teach.validation import LARGEST, checked_array

ODOMETRY = ("nav_msgs/msg/Odometry",)
SECOND = 1e9  # ns
LONG_GAP = 1.0  # s; a pose inside of it is hardly more than a guess
TOO_FAST = 10.0  # m/s; odometry that began anew, not a robot
# Without anybody's word: a step errs by a tenth of the typical one, and by no less than a wheel that slips a little.
STEP_SHARE, LEAST_STEP_STD, LEAST_TURN_STD = 0.1, 0.005, 0.005  # m, rad
OBSERVATION_STD = (0.1, 0.1)  # m, that of the paper's sensor


def load_rosbag(
    path,
    *,
    odometry_topic: str | None = None,
    detection_topic: str | None = None,
    depth_topic: str | None = None,
    camera_info_topic: str | None = None,
    mount=None,
    optical: bool | None = None,
    min_score: float = 0.0,
    rate: float | None = None,
    odometry_std=None,
    observation_std=None,
) -> tuple[RobotLog, list[str]]:
    """A recording of a robot that runs ROS.

    There is a pose wherever something was detected, interpolated at the time of the picture, and between these one of
    the odometry for every step or turn of ``trajectories``. Times are those of measurement (header.stamp). Nothing is
    known of the truth, and a tracker's identities are not read.

    Args:
        path: of ROS 1 a .bag; of ROS 2 a folder with metadata.yaml, or one of its .db3 or .mcap files.
        odometry_topic: of nav_msgs/Odometry; None: the only one, as for the other topics.
        detection_topic: of vision_msgs/Detection3DArray or Detection2DArray; None: boxes in space before pictures.
        depth_topic: sensor_msgs/Image, for boxes in pictures: registered to them.
        camera_info_topic: sensor_msgs/CameraInfo, for boxes in pictures.
        mount: (3,) m, m, rad of the sensor in the robot's frame; None: as /tf_static says, else at its origin.
        optical: whether z is ahead in the sensor's frame; None: in ``..._optical_frame``, and of pictures.
        min_score: detections whose largest score is below are left out.
        rate: at most so many messages with detections per second; None: all. Each makes a pose, and poses make work.
        odometry_std: (3,) m, m, rad per step; None: a tenth of the root mean square step, at least 5 mm and 5 mrad.
        observation_std: (2,) m; None: 0.1 m.

    Returns:
        the log, and sentences on what was used, assumed and left out.

    Raises:
        FileNotFoundError: nothing is there.
        ValueError: rosbags is not installed, the bag is damaged, a topic is missing or ambiguous, nothing was detected
            while there is odometry, depth images are of an unknown encoding.
    """
    dropped = Counter()
    with prefix_errors(path), open_bag(path) as bag:
        mount = None if mount is None else checked_array("mount", mount, (3,))
        if rate is not None and not 0 < rate < math.inf:
            raise ValueError(f"rate: expected a positive number of messages per second, got {rate}")
        odometry_topic = bag.topic_of(odometry_topic, ODOMETRY, "--odometry-topic")
        detection_topic = _detection_topic(bag, detection_topic)
        time, poses, base, remarks = _driven(bag, odometry_topic, dropped)
        remarks = [f"odometry of {odometry_topic}, detections of {detection_topic}", *remarks]
        seen = read_detections(bag, detection_topic, min_score, dropped)
        seen = seen if rate is None else _thinned(seen, rate, dropped)
        if detection_topic in bag.topics(*BOXES_2D):
            seen, used = with_depth(bag, seen, depth_topic, camera_info_topic, dropped)
            remarks.append(used)
            optical = _optical_picture(seen, optical)
        stamps, xy, names, said = _observations(bag, seen, base, mount, optical)
        inside = (stamps >= time[0]) & (stamps <= time[-1])
        _require_inside(detection_topic, stamps, inside, time, dropped)
        dropped["detections before or after the odometry"] += int((~inside).sum())
        stamps, xy, names = stamps[inside], xy[inside], names[inside]
        log = _log_of(time, poses, stamps, xy, names, odometry_std, observation_std)
        remarks += [*said, *_noise_remarks(log, odometry_std, observation_std), *_gap_remarks(time, stamps)]
    return log, remarks + [f"left out: {count} {what}" for what, count in dropped.items() if count]


def _detection_topic(bag: Bag, asked: str | None) -> str:
    """Boxes in space are preferred: they need no depth, and a bag that has both made them out of the others."""
    both = BOXES_3D + BOXES_2D
    kinds = both if asked is not None or not bag.topics(*BOXES_3D) else BOXES_3D
    return bag.topic_of(asked, kinds, "--detection-topic")


def _driven(bag: Bag, topic: str, dropped: Counter) -> tuple[np.ndarray, np.ndarray, str, list[str]]:
    """Odometry in the order of measurement: times (n,) ns, poses (n, 3), the robot's frame, what was left out."""
    rows, base, tilt = {}, "", 0.0
    for message in bag.messages(topic):
        stamp, place = stamp_of(message.header), message.pose.pose.position
        rotation = rotation_of(message.pose.pose.orientation)
        row = [place.x, place.y, math.atan2(rotation[1, 0], rotation[0, 0]), place.z]
        if not stamp or not np.all(np.abs(row) < LARGEST):
            dropped["odometry messages without a time stamp or a pose"] += 1
        elif stamp in rows:
            dropped["odometry messages of a time that another one has"] += 1
        else:
            rows[stamp], base = row, message.child_frame_id
            tilt = max(tilt, math.acos(np.clip(rotation[2, 2], -1, 1)))
    if len(rows) < 2:
        raise ValueError(f"{topic}: expected at least two poses with different time stamps, got {len(rows)}")
    time = np.array(sorted(rows))
    table = np.array([rows[stamp] for stamp in time.tolist()])
    return time, table[:, :3], base, _path_remarks(time, table, tilt)


def _path_remarks(time: np.ndarray, table: np.ndarray, tilt: float) -> list[str]:
    """What a path on the floor leaves out, and whether it is one: times (n,) ns, x y heading z (n, 4), rad."""
    heights, remarks = np.ptp(table[:, 3]), []
    if heights > 1e-6 or tilt > 1e-6:
        leaning = f"roll and pitch up to {math.degrees(tilt):.1f} degrees"
        remarks.append(f"put on the floor: heights over {heights:.2f} m, {leaning}")
    speeds = np.hypot(*np.diff(table[:, :2], axis=0).T) / (np.diff(time) / SECOND)
    jumps, fastest = int((speeds > TOO_FAST).sum()), speeds.max()
    if jumps:
        remarks.append(f"beware: jumps of the odometry at up to {fastest:.3g} m/s, {jumps} in all: did it begin anew?")
    return remarks


def _thinned(seen: list[Seen], rate: float, dropped: Counter) -> list[Seen]:
    """The first messages with detections of each ``1 / rate`` seconds, and those of the very same time."""
    slots = [int((each.stamp - seen[0].stamp) * rate // SECOND) for each in seen]
    first = {}
    for each, slot in zip(seen, slots, strict=True):
        if each.names:
            first[slot] = min(each.stamp, first.get(slot, each.stamp))
    kept = [each for each, slot in zip(seen, slots, strict=True) if first.get(slot) == each.stamp]
    dropped[f"detections beyond {rate:g} messages a second"] = sum(len(s.names) for s in seen) - sum(
        len(s.names) for s in kept
    )
    return kept


def _optical_picture(seen: list[Seen], optical: bool | None) -> bool | None:
    """Points out of pictures have z ahead whatever their frame is called; only /tf_static could know better."""
    named = all(each.frame.endswith("optical_frame") for each in seen)
    return optical if named or optical is not None else True


def _observations(bag: Bag, seen: list[Seen], base: str, mount, optical) -> tuple:
    """All detections in the order of time: stamps (M,) ns, (M, 2) m in the robot's frame, names (M,), sentences."""
    ways = {each.frame: mounting(bag, each.frame, base, mount, optical) for each in seen if each.names}
    seen = sorted((each for each in seen if each.names), key=lambda each: each.stamp)
    stamps = np.repeat([each.stamp for each in seen], [len(each.names) for each in seen]).astype(np.int64)
    places = [(each.boxes @ ways[each.frame][0][:2, :3].T) + ways[each.frame][0][:2, 3] for each in seen]
    names = np.array([name for each in seen for name in each.names], dtype=str)
    return stamps, np.concatenate([np.zeros((0, 2)), *places]), names, [sentence for _, sentence in ways.values()]


def _require_inside(topic: str, stamps, inside, time, dropped: Counter) -> None:
    if len(stamps) == 0:
        why = "; ".join(f"{count} {what}" for what, count in dropped.items() if count) or "its messages are empty"
        raise ValueError(f"{topic}: expected detections, got none that can be used: {why}")
    if not inside.any():
        spans = [f"{first / SECOND:.3f} to {last / SECOND:.3f} s" for first, last in (time[[0, -1]], stamps[[0, -1]])]
        raise ValueError(
            f"{topic}: expected detections within the odometry's {spans[0]}, got all of them in {spans[1]}"
        )


def _log_of(time, poses, stamps, xy, names, odometry_std, observation_std) -> RobotLog:
    """The log of odometry (n,), (n, 3) and observations (M,), (M, 2), (M,); times in ns."""
    since = time[0]  # whole nanoseconds since the epoch would not fit into a float
    known, frames = (time - since) / SECOND, np.unique(stamps)
    times = np.union1d(time, frames)
    path = se2.interpolate((times - since) / SECOND, known, poses)
    kept = keyframes(path, np.isin(times, frames))
    path, times = path[kept], times[kept]
    odometry = se2.between(path[:-1], path[1:])
    classes = sorted(set(names.tolist()), key=_class_order)
    number = {name: c for c, name in enumerate(classes)}
    return RobotLog(
        odometry=odometry,
        obs_time=np.searchsorted(times, stamps),
        obs_xy=xy,
        obs_class=[number[name] for name in names.tolist()],
        num_classes=len(classes),
        odometry_std=_usual_std(odometry) if odometry_std is None else odometry_std,
        observation_std=OBSERVATION_STD if observation_std is None else observation_std,
        class_names=tuple(classes),
    )


def _usual_std(odometry: np.ndarray) -> tuple[float, float, float]:
    """A share of the root mean square step and turn of (T-1, 3) steps, see ``STEP_SHARE``."""
    x, y, turn = np.sqrt((odometry**2).mean(axis=0))
    std = max(LEAST_STEP_STD, STEP_SHARE * math.hypot(x, y))
    return std, std, max(LEAST_TURN_STD, STEP_SHARE * turn)


def _class_order(name: str) -> tuple:
    """Numbers by their value, then words."""
    return (0, int(name), name) if name.isdecimal() else (1, 0, name)


def _noise_remarks(log: RobotLog, odometry_std, observation_std) -> list[str]:
    """The standard deviations that nobody gave."""
    words = []
    if odometry_std is None:
        words.append("odometry_std " + ",".join(f"{std:.3g}" for std in log.odometry_std) + " (a tenth of a step)")
    if observation_std is None:
        words.append("observation_std " + ",".join(f"{std:.3g}" for std in log.observation_std))
    return [f"assumed: {' and '.join(words)}; notebooks/your_own_robot.md tells how to know better"] if words else []


def _gap_remarks(time: np.ndarray, stamps: np.ndarray) -> list[str]:
    """Detections at times where the odometry is silent."""
    after = np.clip(np.searchsorted(time, stamps), 1, len(time) - 1)
    count = int((time[after] - time[after - 1] > LONG_GAP * SECOND).sum())
    return [f"beware: {count} detections fall into gaps of the odometry longer than {LONG_GAP:g} s"] if count else []
