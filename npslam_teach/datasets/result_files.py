"""Results for other programs: a trajectory in TUM's format, as ``evo`` reads it, and a table of objects."""

import csv
import io

import numpy as np

from npslam_teach.system.files import atomic_write
from npslam_teach.types import RobotLog, Snapshot


def save_tum(path, poses: np.ndarray) -> None:
    """Write a path in TUM's format, ``timestamp tx ty tz qx qy qz qw`` in every line.

    A log has no clock, so the timestamp is the index of the pose. The robot moves in the plane z = 0.

    Args:
        path: the file to make or replace.
        poses: (T, 3) m, m, rad, W. Poses of unknown position are left out; an unknown heading is written as 0.

    Raises:
        FileNotFoundError: the folder does not exist.
        ValueError: the file cannot be written.
    """
    time = np.flatnonzero(~np.isnan(poses[:, :2]).any(axis=1))
    half = np.nan_to_num(poses[time, 2]) / 2
    rows = np.column_stack([time, poses[time, :2], np.zeros((len(time), 3)), np.sin(half), np.cos(half)])
    with atomic_write(path) as stream:
        stream.write("# timestamp tx ty tz qx qy qz qw\n")
        stream.writelines(" ".join(map(repr, row)) + "\n" for row in rows.tolist())


def save_objects(path, snapshot: Snapshot, log: RobotLog) -> None:
    """Write the objects that a method found: ``object, x, y, class, num_observations`` in every row.

    Args:
        path: the file to make or replace.
        snapshot: the result.
        log: what it was made from; its names of classes are written where it has any.

    Raises:
        FileNotFoundError: the folder does not exist.
        ValueError: the file cannot be written.
    """
    names = log.class_names or range(log.num_classes)
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(["object", "x", "y", "class", "num_observations"])
    for k, (xy, votes) in enumerate(zip(snapshot.graph.landmark_xy.tolist(), snapshot.votes[:, 1:], strict=True)):
        writer.writerow([k, *map(repr, xy), names[votes.argmax()], int(votes.sum())])
    with atomic_write(path) as file:
        file.write(stream.getvalue())
