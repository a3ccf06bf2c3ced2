"""The original data of Mu et al., IROS 2016: what its numbers mean in this package's conventions."""

import numpy as np

from npslam_teach.datasets.mat_files import read_mat
from npslam_teach.se2 import between, wrap
from npslam_teach.system.files import prefix_errors
from npslam_teach.types import GroundTruth, RobotLog, World
from npslam_teach.validation import checked_array

SIMULATION_VARIABLES = ("node_edge", "lm_edge", "truth_traj", "truth_objects")
STATA_VARIABLES = ("stata_frames",)
MAX_CLASSES = 10_000  # a file that claims more is damaged; its word would cost memory in every table of votes


def load_mu2016_simulation(path) -> tuple[RobotLog, GroundTruth]:
    """Read the simulation of the paper into this package's conventions.

    Two traps are taken care of, and each is invisible to the eye and shows in chi2:

    - *Signs.* The authors rotate by R(-theta), so their theta is the negative of the usual heading. Headings
      and turns are negated on the way in.
    - *Off by one.* Their odometry step k (counted from 0) leads from pose k-1 to pose k, so step 0 leads *to*
      the first pose and has nothing before it. It is dropped; pose k is ``truth_traj[k]`` and ``lm_edge.id1``
      counts poses from 0.

    Labels and object numbers, which count from 1 in the file, count from 0 here. The standard deviations are
    those of the noise in the file: 0.01 m and 0.01 rad per step, 0.1 m per observation.

    Args:
        path: the file, see `datasets.fetch_mu2016_simulation`, or another with the same variables.

    Returns:
        The log (766 poses, 1098 observations, 5 classes in the original) and what really happened.

    Raises:
        FileNotFoundError: no such file.
        ValueError: damaged, or not in this format; the message names the file and the variable.
    """
    variables = read_mat(path, SIMULATION_VARIABLES)
    with prefix_errors(path):
        return simulation_from(variables)


def simulation_from(variables: dict) -> tuple[RobotLog, GroundTruth]:
    """What `load_mu2016_simulation` does once the file has been read."""
    _require_names(variables, SIMULATION_VARIABLES, "the variables")
    poses = checked_array("truth_traj", variables["truth_traj"], (None, 3)) * [1, 1, -1]
    if len(poses) == 0:
        raise ValueError("truth_traj: expected at least one pose, got none")
    poses[:, 2] = wrap(poses[:, 2])
    objects = checked_array("truth_objects", variables["truth_objects"], (None, 3))
    object_class = _integers("truth_objects(:, 3)", objects[:, 2], len(objects), 0, MAX_CLASSES)
    seen = _single_structure(variables, "lm_edge", ("id1", "id2", "dpos", "label"))
    obs_xy = checked_array("lm_edge.dpos", seen["dpos"], (2, None)).T
    labels = _integers("lm_edge.label", seen["label"], len(obs_xy), 1, MAX_CLASSES)
    num_classes = int(max(labels.max(initial=0), object_class.max(initial=0))) + 1
    log = RobotLog(
        odometry=_simulation_odometry(variables, len(poses)),
        obs_time=_integers("lm_edge.id1", seen["id1"], len(obs_xy), 0, len(poses)),
        obs_xy=obs_xy,
        obs_class=labels,
        num_classes=num_classes,
        odometry_std=(0.01, 0.01, 0.01),
        observation_std=(0.1, 0.1),
    )
    world = World(objects[:, :2], object_class, [f"class {c}" for c in range(num_classes)])
    return log, GroundTruth(world, poses, _integers("lm_edge.id2", seen["id2"], len(obs_xy), 1, len(objects)))


def _simulation_odometry(variables: dict, num_poses: int) -> np.ndarray:
    """(T-1, 3) from the file's T steps, of which the first leads to the first pose."""
    steps = _single_structure(variables, "node_edge", ("dpos", "dtheta"))
    xy = checked_array("node_edge.dpos", steps["dpos"], (2, num_poses)).T
    theta = -_vector("node_edge.dtheta", steps["dtheta"], num_poses)
    return np.column_stack([xy, theta])[1:]


def load_stata_office(path) -> RobotLog:
    """Read the paper's office experiment (MIT's Stata Center), projected on the floor.

    The file holds the camera's pose in the frame of its first image, by visual odometry, and the objects that
    a detector found, as the centres of their point clouds in the camera's frame (x right, y down, z forward).
    On the floor x = z_cam and y = -x_cam, both for poses and for objects, and the heading is that of the
    forward axis. The camera's tilt, up to 15 degrees against the first image, is ignored. Odometry is the
    motion from one pose to the next (696 poses, 27 m).

    Two steps of the original turn by about -2.1 rad without moving, ``odometry[264]`` and ``odometry[580]``;
    the next largest turn is 0.11 rad. They are left as they are: an estimator has to live with them.

    The detector's class ids become 0, 1, ... in increasing order: 6, 9, 11, 12, 14, 16, 17 and 19 in the
    original (75, 201, 99, 69, 291, 172, 681 and 3 of its 1591 observations). There is no ground truth.

    The standard deviations are our assumption; the file has none. Odometry: 0.01 m and 0.01 rad per step,
    about a third of the mean step of 0.04 m and 0.03 rad, and what the paper's simulation uses. Objects:
    0.2 m, because the centre of the part of an object that the camera sees moves as the camera does: ten
    images later the nearest observation of the same class is 0.25 m away in the median, which makes 0.15 m on
    each axis of each observation, and the tails are heavier than a normal distribution's.

    Args:
        path: the file, see `datasets.fetch_stata_office`, or another with the same variables.

    Raises:
        FileNotFoundError: no such file.
        ValueError: damaged, or not in this format; the message names the file and the variable.
    """
    variables = read_mat(path, STATA_VARIABLES)
    with prefix_errors(path):
        return stata_office_from(variables)


def stata_office_from(variables: dict) -> RobotLog:
    """What `load_stata_office` does once the file has been read."""
    _require_names(variables, STATA_VARIABLES, "the variable")
    frames = _structures("stata_frames", variables["stata_frames"], ("T", "objects"))
    if not frames:
        raise ValueError("stata_frames: expected at least one frame, got none")
    poses = _floor_poses(frames)
    obs_time, obs_xy, class_id = [], [], []
    for k, frame in enumerate(frames):
        name = f"stata_frames({k + 1}).objects"
        for n, found in enumerate(_structures(name, frame["objects"], ("T", "label"))):
            centre = checked_array(f"{name}({n + 1}).T", found["T"], (4, 4))[:3, 3]
            obs_time.append(k)
            obs_xy.append((centre[2], -centre[0]))
            class_id.append(_integers(f"{name}({n + 1}).label", found["label"], 1, 0, MAX_CLASSES)[0])
    ids, obs_class = np.unique(np.array(class_id, int), return_inverse=True)
    return RobotLog(
        odometry=between(poses[:-1], poses[1:]),
        obs_time=np.array(obs_time, int),
        obs_xy=np.reshape(obs_xy, (-1, 2)),
        obs_class=obs_class,
        num_classes=max(len(ids), 1),
        odometry_std=(0.01, 0.01, 0.01),
        observation_std=(0.2, 0.2),
    )


def _floor_poses(frames: list) -> np.ndarray:
    """(T, 3) poses on the floor, from the camera's poses in space."""
    names = [f"stata_frames({k + 1}).T" for k in range(len(frames))]
    camera = np.array([checked_array(name, f["T"], (4, 4)) for name, f in zip(names, frames, strict=True)])
    rotation = camera[:, :3, :3]
    with np.errstate(over="ignore", invalid="ignore"):  # absurd numbers make an absurd error, and that is said
        error = np.abs(rotation @ rotation.swapaxes(1, 2) - np.eye(3)).max(axis=(1, 2))
    is_rotation = error < 1e-3
    if not is_rotation.all():
        first = np.argmin(is_rotation)
        raise ValueError(f"{names[first]}: expected a rotation, got a matrix off by {error[first]:.2g}")
    forward = rotation[:, :, 2]
    return np.column_stack([camera[:, 2, 3], -camera[:, 0, 3], np.arctan2(-forward[:, 0], forward[:, 2])])


def _require_names(found, names: tuple, what: str) -> None:
    missing = [name for name in names if name not in found]
    if missing:
        raise ValueError(f"expected {what} {', '.join(names)}, missing {', '.join(missing)}")


def _structures(name: str, value, fields: tuple) -> list:
    """A structure array as a list of dicts that have ``fields``; MATLAB's ``[]`` is an empty one."""
    if not isinstance(value, list):
        if value.size:
            raise ValueError(f"{name}: expected structures, got numbers of shape {value.shape}")
        return []
    for structure in value:
        with prefix_errors(name):
            _require_names(structure, fields, "the fields")
    return value


def _single_structure(variables: dict, name: str, fields: tuple) -> dict:
    structures = _structures(name, variables[name], fields)
    if len(structures) != 1:
        raise ValueError(f"{name}: expected one structure, got {len(structures)}")
    return structures[0]


def _vector(name: str, value, size: int) -> np.ndarray:
    """(size,) from a row or a column of MATLAB."""
    return checked_array(name, np.ravel(value), (size,))


def _integers(name: str, value, size: int, first: int, count: int) -> np.ndarray:
    """(size,) whole numbers in [0, count), counted from 0 here and from ``first`` in the file."""
    numbers = _vector(name, value, size)
    last = first + count - 1
    bad = np.flatnonzero((numbers != np.round(numbers)) | (numbers < first) | (numbers > last))
    if bad.size:
        got = f"{numbers[bad[0]]:g} at entry {bad[0] + 1}"
        raise ValueError(f"{name}: expected whole numbers from {first} to {last}, got {got}")
    return numbers.astype(int) - first
