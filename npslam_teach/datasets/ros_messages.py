"""ROS bags through the package ``rosbags``, of ROS 1 and 2: which topics there are, and their messages one by one.

A bag that holds the definitions of its messages is read by them. Bags of ROS 2 before Iron hold none: their messages
are taken for those of Humble, and detections for vision_msgs 4.
"""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from pathlib import Path

REQUIREMENT = "rosbags>=0.11.9"  # the extra `ros` of pyproject.toml
MOST_CHARACTERS = 160  # of rosbags' own words in an error
# Names and order of the fields, which is all that a definition says. The detections' `id` is not read anywhere: a
# tracker's opinion of who is who is what a log must not hold.
_VISION_MSGS = {
    "Detection2DArray": "std_msgs/Header header\nDetection2D[] detections",
    "Detection3DArray": "std_msgs/Header header\nDetection3D[] detections",
    "Detection2D": "std_msgs/Header header\nObjectHypothesisWithPose[] results\nBoundingBox2D bbox\nstring id",
    "Detection3D": "std_msgs/Header header\nObjectHypothesisWithPose[] results\nBoundingBox3D bbox\nstring id",
    "ObjectHypothesisWithPose": "ObjectHypothesis hypothesis\ngeometry_msgs/PoseWithCovariance pose",
    "ObjectHypothesis": "string class_id\nfloat64 score",
    "BoundingBox2D": "Pose2D center\nfloat64 size_x\nfloat64 size_y",
    "BoundingBox3D": "geometry_msgs/Pose center\ngeometry_msgs/Vector3 size",
    "Pose2D": "Point2D position\nfloat64 theta",
    "Point2D": "float64 x\nfloat64 y",
}


@dataclass(frozen=True, eq=False)
class Bag:
    """An open bag."""

    reader: object  # rosbags' AnyReader

    def topics(self, *types: str) -> list[str]:
        """Names of the topics of these types, such as ``nav_msgs/msg/Odometry``, sorted; of all when none is given."""
        return sorted({each.topic for each in self.reader.connections if not types or each.msgtype in types})

    def topic_of(self, asked: str | None, types: tuple[str, ...], option: str) -> str:
        """The topic that is asked for, or the only one of these types.

        Args:
            asked: its name; None: the only one.
            types: what it may be.
            option: how to ask for it, for the error.

        Raises:
            ValueError: there is none, or there are several; lists them.
        """
        found, kinds = self.topics(*types), " or ".join(types)
        if asked is not None and asked in found:
            return asked
        if asked is not None and asked in self.topics():
            raise ValueError(f"{option}: expected a topic of {kinds}, got {asked} of another type")
        if asked is not None:
            raise ValueError(f"{option}: expected one of the topics {_listed(found or self.topics())}, got {asked!r}")
        if not found:
            raise ValueError(f"expected a topic of {kinds}, got the topics {_listed(self.topics())}")
        if len(found) > 1:
            raise ValueError(f"expected one topic of {kinds}, got {_listed(found)}: choose by {option}")
        return found[0]

    def messages(self, topic: str) -> Iterator:
        """The messages of a topic in the order in which they were recorded.

        Raises:
            ValueError: the bag is damaged, or its messages are not of the type that is assumed.
        """
        wanted = [each for each in self.reader.connections if each.topic == topic]
        with _one_sentence():
            found = self.reader.messages(connections=wanted)
        while True:
            with _one_sentence(f" on {topic}"):
                try:
                    connection, _, raw = next(found)
                except StopIteration:
                    return
                message = self.reader.deserialize(raw, connection.msgtype)
            yield message


@contextmanager
def open_bag(path) -> Iterator[Bag]:
    """A bag to read from.

    Args:
        path: of ROS 1 a .bag; of ROS 2 a folder with metadata.yaml, or one of its .db3 or .mcap files.

    Raises:
        FileNotFoundError: nothing is there.
        ValueError: rosbags is not installed, or this is no bag.
    """
    _require_rosbags()
    from rosbags.highlevel import AnyReader

    path = Path(path)
    if not path.exists():
        raise FileNotFoundError(f"{path}: no such file or folder")
    if path.is_dir() and path.suffix == ".bag":
        raise ValueError("expected a folder with another name, for .bag is the name of a file of ROS 1: rename it")
    defaults = _default_types()
    with _one_sentence():
        reader = AnyReader([path], default_typestore=defaults)
        reader.open()
    try:
        with _one_sentence():
            _add_missing_types(reader, defaults)
        yield Bag(reader)
    finally:
        reader.close()


def stamp_of(header) -> int:
    """Nanoseconds of when something was measured, not of when it was recorded; 0 when the sender left it out."""
    return int(header.stamp.sec) * 10**9 + int(header.stamp.nanosec)


def _require_rosbags() -> None:
    try:
        import rosbags.highlevel  # noqa: F401
    except ImportError:
        remedy = f'run "{sys.executable}" -m pip install "{REQUIREMENT}"'
        raise ValueError(f"a ROS bag needs the package {REQUIREMENT}, which is not installed: {remedy}") from None


@cache
def _default_types():
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    store, types = get_typestore(Stores.ROS2_HUMBLE), {}
    for name, text in _VISION_MSGS.items():
        types |= get_types_from_msg(text, f"vision_msgs/msg/{name}")
    store.register(types)
    return store


def _add_missing_types(reader, defaults) -> None:
    """Where a bag defines some of its types only, the others are as in a bag that defines none."""
    known = reader.typestore.fielddefs
    if any(each.msgtype not in known and each.msgtype in defaults.fielddefs for each in reader.connections):
        reader.typestore.register({name: fields for name, fields in defaults.fielddefs.items() if name not in known})


@contextmanager
def _one_sentence(where: str = ""):
    """Whatever rosbags meets in a damaged file - and each of its parts has exceptions of its own - in one sentence."""
    try:
        yield
    except MemoryError:
        raise ValueError(f"expected a ROS bag that can be read, got{where} a length that no file has") from None
    except Exception as error:
        words = " ".join(f"{type(error).__name__}: {' '.join(map(str, error.args))}".rstrip(": .").split())
        reason = words if len(words) <= MOST_CHARACTERS else words[:MOST_CHARACTERS] + "..."
        raise ValueError(f"expected a ROS bag that can be read, got{where} {reason}") from None


def _listed(names: list[str]) -> str:
    """At most ten of them."""
    more = f" and {len(names) - 10} more" if len(names) > 10 else ""
    return (", ".join(names[:10]) or "(none)") + more
