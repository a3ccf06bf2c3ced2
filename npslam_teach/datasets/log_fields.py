"""What every file of a log holds, whatever its format: named arrays, and what is known of the truth."""

from dataclasses import replace

import numpy as np

from npslam_teach.datasets.mu2016 import MAX_CLASSES
from npslam_teach.system.files import prefix_errors
from npslam_teach.types import UNKNOWN, GroundTruth, RobotLog, World
from npslam_teach.validation import checked_array

LOG_FIELDS = ("odometry", "obs_time", "obs_xy", "obs_class", "num_classes", "odometry_std", "observation_std")
TRUTH_FIELDS = ("true_poses", "true_object", "object_xy", "object_class", "object_theta")
HEADING_FIELDS = ("obs_theta", "observation_theta_std", "class_symmetry")
OPTIONAL_FIELDS = ("odometry_cov", "observation_cov", "class_probabilities", *HEADING_FIELDS)
NAMES_FIELD = "class_names"
FIELDS = (*LOG_FIELDS, *OPTIONAL_FIELDS, *TRUTH_FIELDS, NAMES_FIELD)


def run_from(fields: dict) -> tuple[RobotLog, GroundTruth | None]:
    """The log in these fields, and the truth; None where there is nothing of it.

    Raises:
        ValueError: names the field, what was expected and what came.
    """
    missing = [name for name in LOG_FIELDS if name not in fields]
    if missing:
        raise ValueError(f"expected the fields {', '.join(LOG_FIELDS)}, missing {', '.join(missing)}")
    num_classes = checked_array("num_classes", fields["num_classes"], ()).item()
    if num_classes > MAX_CLASSES:
        raise ValueError(f"num_classes: expected at most {MAX_CLASSES}, got {num_classes:g}")
    _require_enough_steps(fields)
    used = {name: fields[name] for name in (*LOG_FIELDS, *OPTIONAL_FIELDS) if name in fields}
    log = RobotLog(**used | {"num_classes": num_classes})
    log = replace(log, class_names=_class_names(fields, log.num_classes))
    return log, _truth_from(fields, log)


def _require_enough_steps(fields: dict) -> None:
    """A pose that no step leads to is a missing row more often than a wrong index."""
    odometry, times = np.shape(fields["odometry"]), np.asarray(fields["obs_time"])
    if (
        len(odometry) == 2
        and times.dtype.kind in "iu"
        and times.ndim == 1
        and times.max(initial=0) > (last := odometry[0])
    ):
        entry = int(np.argmax(times > last))
        text = f"obs_time: expected the index of a pose from 0 to {last}, got {times[entry]} at entry {entry}"
        counted = ", or are poses counted from 1?" if times.min() > 0 else "?"
        raise ValueError(f"{text}: {last} steps of odometry lead no further; is it a row too few{counted}")


def fields_of(log: RobotLog, truth: GroundTruth | None) -> dict:
    """The same as arrays by name; of the truth, only what is known."""
    fields = {name: np.asarray(getattr(log, name)) for name in LOG_FIELDS}
    fields |= {name: np.asarray(getattr(log, name)) for name in OPTIONAL_FIELDS if getattr(log, name) is not None}
    names = log.class_names if truth is None else truth.world.class_names
    if names is not None:
        fields[NAMES_FIELD] = np.array(names, dtype=str)
    if truth is not None:
        world = truth.world
        fields |= {"true_poses": truth.poses, "true_object": truth.obs_object}
        fields |= {"object_xy": world.object_xy, "object_class": world.object_class}
        fields |= {} if world.object_theta is None else {"object_theta": world.object_theta}
    return fields


def _class_names(fields: dict, num_classes: int) -> tuple | None:
    names = fields.get(NAMES_FIELD)
    if names is None:
        return None
    if names.dtype.kind != "U" or names.shape != (num_classes,):
        got = f"{names.dtype} of shape {names.shape}"
        raise ValueError(f"{NAMES_FIELD}: expected text of shape ({num_classes},), got {got}")
    return tuple(names.tolist())


def _truth_from(fields: dict, log: RobotLog) -> GroundTruth | None:
    """The truth that belongs to ``log``, unknown wherever a field is missing; None if all are."""
    if not any(name in fields for name in TRUTH_FIELDS):
        return None
    obs_object = fields.get("true_object", np.full(log.num_observations, UNKNOWN))
    obs_object = checked_array("true_object", obs_object, (log.num_observations,), int)
    poses = _true_poses(fields.get("true_poses", np.full((log.num_poses, 3), np.nan)), log.num_poses)
    names = log.class_names or tuple(f"class {c}" for c in range(log.num_classes))
    world = World(*_objects(fields, log, obs_object), names, fields.get("object_theta"))
    with prefix_errors("true_object"):
        return GroundTruth(world, poses, obs_object)


def _true_poses(value, num_poses: int) -> np.ndarray:
    """Positions alone get headings that are unknown."""
    size = 2 if np.ndim(value) == 2 and np.shape(value)[1] == 2 else 3
    if np.ndim(value) == 2 and len(value) == num_poses - 1:
        problem = f"expected shape ({num_poses}, {size}), got {np.shape(value)}"
        raise ValueError(f"true_poses: {problem}: one pose more than steps of odometry; has that one row too many?")
    known = checked_array("true_poses", value, (num_poses, size), gaps=True)
    return np.column_stack([known, np.full((num_poses, 3 - size), np.nan)])


def _objects(fields: dict, log: RobotLog, obs_object: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Positions and classes of the real objects; a class that the file does not tell is the one most often reported."""
    known = [len(fields[name]) for name in ("object_xy", "object_class") if name in fields and np.ndim(fields[name])]
    num_objects = known[0] if known else int(obs_object.max(initial=-1)) + 1
    object_xy = fields.get("object_xy", np.full((num_objects, 2), np.nan))
    if "object_class" in fields:
        return object_xy, fields["object_class"]
    seen = (obs_object >= 0) & (obs_object < num_objects)
    reports = np.zeros((num_objects, log.num_classes))
    np.add.at(reports, (obs_object[seen], log.obs_class[seen]), 1)
    # An object that nobody saw, and of which nothing is known, stands for a number that was left out.
    untold = np.flatnonzero(~reports.any(axis=1) & ("object_xy" in fields))
    if untold.size:
        raise ValueError(f"object_class: expected it beside object_xy, because no observation is of object {untold[0]}")
    return object_xy, reports.argmax(axis=1)
