"""How ``import`` is asked: a format, what to read and to write, and what a recording does not say itself."""

import argparse

from npslam_teach.cli.option_types import count, number, numbers
from npslam_teach.cli.output_files import Once

OPTIONS = {  # of the formats that have any, as their functions call them
    "mrclam": {"robot": "robot", "classes": "num_classes"},
    "rosbag": {
        name: name
        for name in (
            "odometry_topic detection_topic depth_topic camera_info_topic mount optical min_score rate "
            "odometry_std observation_std"
        ).split()
    },
}


def given_options(options) -> dict:
    """What was asked for, by the names of the format's function.

    Raises:
        ValueError: an option belongs to another format.
    """
    given = {}
    for owner, names in OPTIONS.items():
        for option, name in names.items():
            value = getattr(options, option)
            if value is not None and options.format != owner:
                raise ValueError(f"--{option.replace('_', '-')}: expected with {owner} only, got {options.format}")
            if value is not None:
                given[name] = value
    return given


def add_import_options(recording: argparse.ArgumentParser) -> None:
    """The format, the files, and what each format needs to be told; see ``given_options``."""
    text = "mrclam: the text files of that data set; victoria-park: any .g2o of known landmarks; csv: our tables; "
    text += "rosbag: odometry and detections of ROS 1 or 2"
    recording.add_argument("format", choices=("mrclam", "victoria-park", "csv", "rosbag"), help=text)
    recording.add_argument("path", metavar="PATH", help="a folder or a file")
    text = "the log to write: .npz, or .csv; identities are hidden, and stand in its truth"
    recording.add_argument("--out", action=Once, metavar="LOG", required=True, help=text)
    recording.add_argument("--robot", type=count, metavar="N", help="mrclam: which (default 1)")
    text = "mrclam: a landmark's class is its number modulo C (default 5); 1: all look alike"
    recording.add_argument("--classes", type=count, metavar="C", help=text)
    _add_rosbag(recording.add_argument_group("rosbag", "A topic need be named only where the bag has several."))


def _add_rosbag(group) -> None:
    """What a bag does not say itself."""
    group.add_argument("--odometry-topic", metavar="TOPIC", help="nav_msgs/Odometry")
    text = "vision_msgs/Detection3DArray or Detection2DArray (default: boxes in space before those in pictures)"
    group.add_argument("--detection-topic", metavar="TOPIC", help=text)
    text = "for boxes in pictures: sensor_msgs/Image, 32FC1 or 16UC1, registered to them"
    group.add_argument("--depth-topic", metavar="TOPIC", help=text)
    group.add_argument("--camera-info-topic", metavar="TOPIC", help="and sensor_msgs/CameraInfo")
    text = "where the sensor is on the robot: m ahead, m left, rad (default: as /tf_static says, else 0 0 0)"
    group.add_argument("--mount", type=number, nargs=3, metavar=("X", "Y", "YAW"), help=text)
    text = "whether z is ahead in the sensor's frame, or x (default: by its name, ..._optical_frame)"
    group.add_argument("--optical", action=argparse.BooleanOptionalAction, default=None, help=text)
    text = "leave out what the detector is less sure of (default 0)"
    group.add_argument("--min-score", type=number, metavar="S", help=text)
    text = "at most so many messages with detections a second (default: all); each makes a pose"
    group.add_argument("--rate", type=number, metavar="HZ", help=text)
    text = "how much a step errs: m,m,rad (default: a tenth of the typical step)"
    group.add_argument("--odometry-std", type=numbers(3), metavar="X,Y,T", help=text)
    group.add_argument(
        "--observation-std", type=numbers(2), metavar="X,Y", help="and an observation: m,m (default 0.1,0.1)"
    )
