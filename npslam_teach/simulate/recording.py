"""A recording as a real robot makes it: wheels that slip, a camera whose errors last, barcodes that are misread.

Nothing here errs as the methods assume. The two wheels of a differential drive are not as large as the robot assumes,
and slip for seconds on end; what the camera gets wrong about a landmark it gets wrong for a whole pass; a few sightings
carry the barcode of another landmark. Clocks tick unevenly, and the camera's stamp is late. All of it goes into text
files in the format of the UTIAS data set (see ``datasets.load_mrclam``), so that it is imported as a real recording is.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from npslam_teach import se2
from npslam_teach.system.files import atomic_write

ROOM = np.array([5.0, 7.0])  # m
FIRST_LANDMARK, NUM_LANDMARKS = 6, 15  # subjects 1 to 5 are robots
TICK, JITTER = 0.1, 0.004  # s, of the wheels' clock
SPEED, TURN_RATE, TRACK = 0.2, 0.6, 0.25  # m/s, rad/s at most, m between the wheels
# Of its speed a wheel gains or loses a share: by its size, by slipping alone and with the other; shaking in m/s.
SIZE_STD, SLIP_STD, BOTH_SLIP_STD, SLIP_LASTS, SHAKE_STD = 0.015, 0.025, 0.08, 5.0, 0.03
FRAME, LATE, SHORT, FAR, HALF_VIEW, READ = 0.8, 0.05, 0.5, 5.5, 0.55, 0.75  # s, s, m, m, rad, probability
PASS_ENDS = 3.0  # s out of view
RANGE_STD, BEARING_STD = 0.06, 0.010  # m, rad: anew in every sighting
PASS_RANGE_STD, PASS_BEARING_STD = 0.12, 0.020  # m, rad: for a whole pass
MISREAD_SHARE = 0.04  # of the sightings


@dataclass(frozen=True, eq=False)
class Recording:
    """What the five files of one robot hold. Times in s, lengths in m, angles in rad."""

    barcodes: np.ndarray  # (20, 2) subject, barcode
    landmarks: np.ndarray  # (15, 3) subject, x, y
    wheels: np.ndarray  # (n, 3) time, speed, turn rate: what they report, each until the next
    sightings: np.ndarray  # (m, 4) time, barcode, range, bearing
    motion_capture: np.ndarray  # (n, 4) time, x, y, heading


def recording(seed: int = 0, seconds: float = 120.0) -> Recording:
    """Drive a room with fifteen landmarks for a while and write down what wheels, camera and motion capture say.

    Args:
        seed: of everything: landmarks, path, errors.
        seconds: how long the robot drives.

    Raises:
        ValueError: the time is too short to see anything, or too long to be meant.
    """
    if not 30 <= seconds <= 36_000:
        raise ValueError(f"seconds: expected a number from 30 to 36000, got {seconds}")
    rng = np.random.default_rng([seed, 12])
    subjects = np.arange(1, FIRST_LANDMARK + NUM_LANDMARKS)
    barcodes = np.column_stack([subjects, rng.choice(np.arange(5, 100), len(subjects), replace=False)])
    landmark_xy = _landmarks(rng)
    time = 1000.0 + np.cumsum(TICK + rng.uniform(-JITTER, JITTER, round(seconds / TICK)))
    said, path = _drive(time, rng)
    seen, landmark, measured = _look(time, path, landmark_xy, rng)
    code = barcodes[_read(landmark, rng) + FIRST_LANDMARK - 1, 1]
    return Recording(
        barcodes,
        np.column_stack([subjects[FIRST_LANDMARK - 1 :], landmark_xy]),
        np.column_stack([time, said]),
        np.column_stack([seen, code, measured]),
        np.column_stack([time, path]),
    )


def write_mrclam(recorded: Recording, folder) -> None:
    """Write a recording as the five text files of robot 1, in an existing folder.

    Args:
        recorded: what to write.
        folder: where.
    """
    uncertain = np.full((len(recorded.landmarks), 2), 0.001)
    tables = {
        "Barcodes": ("Subject #    Barcode #", recorded.barcodes),
        "Landmark_Groundtruth": (
            "Subject #    x [m]    y [m]    x std-dev [m]    y std-dev [m]",
            np.hstack([recorded.landmarks, uncertain]),
        ),
        "Robot1_Odometry": ("Time [s]    forward velocity [m/s]    angular velocity [rad/s]", recorded.wheels),
        "Robot1_Measurement": ("Time [s]    Subject #    range [m]    bearing [rad]", recorded.sightings),
        "Robot1_Groundtruth": ("Time [s]    x [m]    y [m]    orientation [rad]", recorded.motion_capture),
    }
    for name, (columns, rows) in tables.items():
        with atomic_write(Path(folder) / f"{name}.dat") as stream:
            stream.write(f"# {columns}\n")
            stream.writelines("\t".join(_plain(number) for number in row) + "\n" for row in rows.tolist())


def _plain(number: float) -> str:
    return f"{number:.0f}" if number == round(number) else f"{number:.4f}"


def _landmarks(rng: np.random.Generator) -> np.ndarray:
    """(15, 2) m: along the walls, most of them in pairs that stand as near to each other as a hand is long."""
    around = np.sort((np.arange(8) + rng.uniform(-0.25, 0.25, 8)) / 8 * 2 * ROOM.sum())
    ends = np.cumsum([0, ROOM[0], ROOM[1], ROOM[0], ROOM[1]])
    corners = np.array([[0, 0], [ROOM[0], 0], ROOM, [0, ROOM[1]], [0, 0]])
    places = np.column_stack([np.interp(around % ends[-1], ends, corners[:, axis]) for axis in (0, 1)])
    angle, apart = rng.uniform(-np.pi, np.pi, 8), rng.uniform(0.18, 0.3, 8)
    beside = places + apart[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    return np.stack([places, beside], axis=1).reshape(-1, 2)[:NUM_LANDMARKS]


def _drive(time: np.ndarray, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """What the wheels say (n, 2) m/s and rad/s, and where the robot goes (n, 3), from one goal to the next."""
    slip = _slow(len(time), rng) @ np.array([[SLIP_STD, 0], [0, SLIP_STD], [BOTH_SLIP_STD, BOTH_SLIP_STD]])
    error = 1 + SIZE_STD * rng.normal(size=2) + slip
    shake = SHAKE_STD * rng.normal(size=(len(time), 2))
    pose, goal = np.array([*ROOM / 2, rng.uniform(-np.pi, np.pi)]), rng.uniform(1.0, ROOM - 1.0)
    said, path = np.zeros((len(time), 2)), np.empty((len(time), 3))
    for k, duration in enumerate(np.diff(time, append=time[-1] + TICK)):
        path[k] = pose
        while np.linalg.norm(goal - pose[:2]) < 0.3:
            goal = rng.uniform(1.0, ROOM - 1.0)
        off = np.arctan2(*se2.apply_inverse(pose, goal)[::-1])
        said[k] = SPEED * max(np.cos(off), 0.0), np.clip(1.5 * off, -TURN_RATE, TURN_RATE)
        wheels = (said[k, 0] + said[k, 1] * TRACK / 2 * np.array([-1, 1])) * error[k]
        wheels += shake[k] * (np.abs(wheels) > 0)
        step = duration * np.array([wheels.mean(), 0.0, (wheels[1] - wheels[0]) / TRACK])
        pose = se2.compose(pose, step)
    return said, path


def _slow(count: int, rng: np.random.Generator) -> np.ndarray:
    """(n, 3) of standard deviation 1; neighbours resemble each other for seconds."""
    keep, slow = np.exp(-TICK / SLIP_LASTS), rng.normal(size=(count, 3))
    for k in range(1, count):
        slow[k] = keep * slow[k - 1] + np.sqrt(1 - keep**2) * slow[k]
    return slow


def _look(time, path, landmark_xy, rng) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """When (m,), which landmark (m,), and its range and bearing (m, 2) with errors that last for a pass."""
    frames = np.arange(time[0] + FRAME, time[-1] - LATE, FRAME)
    frames += rng.uniform(-0.1, 0.1, len(frames))
    xy = se2.apply_inverse(se2.interpolate(frames, time, path)[:, None], landmark_xy)
    true = np.stack([np.linalg.norm(xy, axis=-1), np.arctan2(xy[..., 1], xy[..., 0])], axis=-1)
    in_view = (true[..., 0] > SHORT) & (true[..., 0] < FAR) & (np.abs(true[..., 1]) < HALF_VIEW)
    frame, landmark = np.nonzero(in_view & (rng.random(in_view.shape) < READ))
    # Within a frame in random order: otherwise the order itself would give the landmarks away.
    order = np.lexsort((rng.random(len(frame)), frame))
    frame, landmark = frame[order], landmark[order]
    seen, measured = frames[frame] + LATE, true[frame, landmark]
    measured = measured + rng.normal(size=measured.shape) * (RANGE_STD, BEARING_STD)
    for k in range(len(landmark_xy)):
        own = np.flatnonzero(landmark == k)
        for sightings in np.split(own, np.flatnonzero(np.diff(seen[own]) > PASS_ENDS) + 1):
            measured[sightings] += rng.normal(size=2) * (PASS_RANGE_STD, PASS_BEARING_STD)
    return seen, landmark, measured


def _read(landmark: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """The landmark (m,) whose barcode was read: now and then another one."""
    other = (landmark + rng.integers(1, NUM_LANDMARKS, len(landmark))) % NUM_LANDMARKS
    return np.where(rng.random(len(landmark)) < MISREAD_SHARE, other, landmark)
