"""Recordings of real robots as logs, their identities hidden from whoever estimates.

``load_mrclam``: the text files of the UTIAS Multi-Robot Cooperative Localization and Mapping data set (Leung, Halpern,
Barfoot and Liu, IJRR 2011): wheels, a camera that reads barcodes on fifteen landmarks, motion capture as truth.
``load_hidden``: any pose graph of known landmarks, such as Victoria Park, whose landmarks are then the truth.
"""

from pathlib import Path

import numpy as np

from npslam_teach import se2
from npslam_teach.datasets.g2o import load_g2o
from npslam_teach.datasets.trajectories import keyframes
from npslam_teach.system.files import prefix_errors
from npslam_teach.types import CLUTTER, GroundTruth, RobotLog, World
from npslam_teach.validation import checked_array

FIRST_LANDMARK = 6  # subjects 1 to 5 are robots
MISREAD = 1.0  # m; a barcode that is read so far from its landmark was read wrongly


def load_mrclam(folder, robot: int = 1, num_classes: int = 5) -> tuple[RobotLog, GroundTruth]:
    """One robot of a data set of MRCLAM; other robots that it sees are left out.

    There is a pose wherever a landmark is seen, and one for every step or turn of ``trajectories``. The class of a
    landmark is its number modulo ``num_classes``; which one it is only the truth knows. The standard deviations are the
    root mean square of the differences to the truth.

    Args:
        folder: with Barcodes.dat, Landmark_Groundtruth.dat, and of the robot Odometry, Measurement and Groundtruth.
        robot: 1 to 5.
        num_classes: 1 for landmarks that all look alike.

    Raises:
        FileNotFoundError: a file is missing.
        ValueError: a file is not what it should be; names it.
    """
    if num_classes < 1:
        raise ValueError(f"num_classes: expected a positive integer, got {num_classes}")
    folder = Path(folder)
    if folder.is_file():
        raise ValueError(f"{folder}: expected a folder, got a file")
    barcodes = _table(folder / "Barcodes.dat", 2, whole=(0, 1))
    landmarks = _table(folder / "Landmark_Groundtruth.dat", 5, whole=(0,))
    wheels, truth = (
        _table(folder / f"Robot{robot}_{name}.dat", n) for name, n in (("Odometry", 3), ("Groundtruth", 4))
    )
    seen = _table(folder / f"Robot{robot}_Measurement.dat", 4, whole=(1,))
    with prefix_errors(folder):
        _require_identities(robot, barcodes, landmarks, seen)
    subject = {int(code): int(number) for number, code in barcodes}
    number = np.array([subject.get(int(code), 0) for code in seen[:, 1]], dtype=int)
    inside = (number >= FIRST_LANDMARK) & (seen[:, 0] >= wheels[0, 0]) & (seen[:, 0] <= wheels[-1, 0])
    seen, number = seen[inside], number[inside] - FIRST_LANDMARK
    landmarks = landmarks[:, 1:3]
    with prefix_errors(folder):
        _require_truth(robot, seen, number, truth, len(landmarks))
        return _log_of(wheels, seen, number, truth, landmarks, num_classes)


def load_hidden(path) -> tuple[RobotLog, GroundTruth]:
    """A pose graph as a log of one class: its chain of poses is the odometry, who is who becomes the truth.

    Poses and landmarks of the truth are those of the file. Loop closures between poses are not taken.

    Args:
        path: a .g2o file whose poses are tied in their order.

    Raises:
        FileNotFoundError: no such file.
        ValueError: it is no chain, or no landmark is seen.
    """
    graph = load_g2o(path)
    between, seen = graph.between, graph.observations
    chain = np.flatnonzero(between.j == between.i + 1)
    order = chain[np.argsort(between.i[chain], kind="stable")]
    with prefix_errors(path):
        if not np.array_equal(between.i[order], np.arange(len(graph.poses) - 1)):
            raise ValueError(f"expected one edge from every pose to the next of {len(graph.poses)}, got {len(order)}")
        if len(seen.pose) == 0:
            raise ValueError("expected observations of landmarks, got none")
        stds = [_typical_std(factors.information) for factors in (between, seen)]
        zeros = np.zeros(len(seen.pose), dtype=int)
        log = RobotLog(between.relative_pose[order], seen.pose, seen.xy, zeros, 1, *stds)
        world = World(graph.landmark_xy, np.zeros(len(graph.landmarks), dtype=int), ("landmark",))
        return log, GroundTruth(world, graph.poses, seen.landmark)


def _require_identities(robot: int, barcodes, landmarks, seen) -> None:
    """Raise ``ValueError`` unless it is clear which landmark stands where, and whose a barcode is."""
    expected = FIRST_LANDMARK + np.arange(len(landmarks))
    if not np.array_equal(landmarks[:, 0], expected):
        got = ", ".join(f"{number:.0f}" for number in landmarks[:, 0])
        raise ValueError(f"Landmark_Groundtruth.dat: expected subjects 6 to {expected[-1]}, each once, got {got}")
    owners = np.unique(barcodes, axis=0)
    codes, often = np.unique(owners[:, 1], return_counts=True)
    if often.max() > 1:
        raise ValueError(f"Barcodes.dat: expected one subject for barcode {codes[often.argmax()]:.0f}, got several")
    if seen[:, 2].min() < 0:
        raise ValueError(f"Robot{robot}_Measurement.dat: expected distances from 0, got {seen[:, 2].min():g}")


def _require_truth(robot: int, seen, number, truth, num_landmarks: int) -> None:
    """Raise ``ValueError`` unless landmarks are seen, all of them known, some while the pose is."""
    if len(seen) == 0:
        raise ValueError(f"Robot{robot}_Measurement.dat: expected a landmark in view while the robot drives")
    if number.max() >= num_landmarks:
        unknown = number.max() + FIRST_LANDMARK
        raise ValueError(f"Landmark_Groundtruth.dat: expected subject {unknown}, which is seen, among its landmarks")
    known = (seen[:, 0] >= truth[0, 0]) & (seen[:, 0] <= truth[-1, 0])
    if len(np.unique(seen[known, 0])) < 2:
        raise ValueError(f"Robot{robot}_Groundtruth.dat: expected the pose at two sights or more, got {known.sum()}")


def _log_of(wheels, seen, number, truth, places, num_classes: int) -> tuple[RobotLog, GroundTruth]:
    """The log of tables (n, columns): wheels, sights, the landmark (M,) of each, motion capture, landmarks (K, 2)."""
    path = _driven(wheels)
    times = np.union1d(wheels[keyframes(path), 0], seen[:, 0])
    poses, true_poses = se2.interpolate(times, wheels[:, 0], path), se2.interpolate(times, truth[:, 0], truth[:, 1:])
    true_poses[(times < truth[0, 0]) | (times > truth[-1, 0])] = np.nan
    odometry, obs_time = se2.between(poses[:-1], poses[1:]), np.searchsorted(times, seen[:, 0])
    obs_xy = seen[:, 2, None] * np.column_stack([np.cos(seen[:, 3]), np.sin(seen[:, 3])])
    off = obs_xy - se2.apply_inverse(true_poses[obs_time], places[number])
    true_object = np.where(np.linalg.norm(off, axis=1) > MISREAD, CLUTTER, number)
    steps = odometry - se2.between(true_poses[:-1], true_poses[1:])
    steps[:, 2] = se2.wrap(steps[:, 2])
    stds = [np.sqrt(np.nanmean(errors**2, axis=0)) for errors in (steps, off[true_object != CLUTTER])]
    log = RobotLog(odometry, obs_time, obs_xy, number % num_classes, num_classes, *stds)
    names = tuple(f"class {c}" for c in range(num_classes))
    world = World(places, np.arange(len(places)) % num_classes, names)
    return log, GroundTruth(world, true_poses, true_object)


def _driven(wheels: np.ndarray) -> np.ndarray:
    """Dead reckoning of time, speed (m/s) and turn rate (rad/s), each held until the next: (n, 3) poses."""
    time = np.diff(wheels[:, 0])
    steps = np.column_stack([wheels[:-1, 1] * time, np.zeros(len(time)), wheels[:-1, 2] * time])
    return se2.dead_reckoning(steps)


def _typical_std(information: np.ndarray) -> np.ndarray:
    """The standard deviations (d,) that most factors (E, d, d) have."""
    typical = np.median(np.diagonal(information, axis1=1, axis2=2), axis=0)
    if not (typical > 0).all():
        raise ValueError(f"expected information above 0, got a median of {typical.min():g}")
    return 1 / np.sqrt(typical)


def _table(path: Path, width: int, whole: tuple[int, ...] = ()) -> np.ndarray:
    """So many columns, some of whole numbers, in the order of the first; lines that begin with # are comments."""
    if not path.is_file():
        raise FileNotFoundError(f"{path}: no such file")
    with prefix_errors(path):
        try:
            lines = path.read_text(encoding="utf-8-sig").splitlines()
        except UnicodeDecodeError:
            raise ValueError("expected text in UTF-8") from None
        rows = [
            _numbers(line, number, width, whole) for number, line in enumerate(lines, 1) if line.split("#")[0].strip()
        ]
        if len(rows) < 2:
            raise ValueError(f"expected at least two lines of numbers, got {len(rows)}")
        table = checked_array("numbers", rows, (None, width))
        return table[np.argsort(table[:, 0], kind="stable")]


def _numbers(line: str, number: int, width: int, whole: tuple[int, ...]) -> list[float]:
    """The numbers of a line."""
    words = line.split()
    if len(words) != width:
        raise ValueError(f"line {number}: expected {width} columns, got {len(words)}")
    try:
        found = [float(word) for word in words]
    except ValueError:
        raise ValueError(f"line {number}: expected numbers only, got {line.strip()[:40]!r}") from None
    for column in whole:
        if not found[column].is_integer():
            raise ValueError(f"line {number}: expected a whole number in column {column + 1}, got {words[column][:20]}")
    return found
