"""One noisy run along a path through a world: what the robot measures, and the noise of the paper.

Every function that draws random numbers takes a generator; the same seed gives the same run on every machine.
"""

from dataclasses import replace

import numpy as np

from npslam_teach import se2
from npslam_teach.types import GroundTruth, RobotLog, SensorModel, World
from npslam_teach.validation import checked_array

# The authors' file holds some noise, and their script adds more before every run.
FILE_ODOMETRY_STD = np.array([0.01, 0.01, 0.01])  # m, m, rad per step
FILE_OBSERVATION_STD = np.array([0.1, 0.1])  # m
ADDED_ODOMETRY_STD = np.array([0.02, 0.02, 0.01])  # m, m, rad per step
ADDED_OBSERVATION_STD = np.array([0.1, 0.1])  # m

STRETCH = 1000  # poses that are processed together when visible objects are looked for


def paper_sensor(noise: float = 1.0) -> SensorModel:
    """The sensors of the paper's simulation: 4 m range, 120 degrees, classes never confused (paper section V.A).

    Args:
        noise: 1 is the paper's run, 0 the file as it is; the added standard deviations grow in proportion.
    """
    _require_noise(noise)
    return SensorModel(
        odometry_std=np.hypot(FILE_ODOMETRY_STD, noise * ADDED_ODOMETRY_STD),
        observation_std=np.hypot(FILE_OBSERVATION_STD, noise * ADDED_OBSERVATION_STD),
        max_range=4.0,
        field_of_view=np.deg2rad(120.0),
    )


def add_noise(log: RobotLog, noise: float, rng: np.random.Generator) -> RobotLog:
    """Add the noise that the authors' script adds before every run, times ``noise``.

    Args:
        log: what the robot measured.
        noise: 0 leaves the log as it is; 1 is the paper's run.
        rng: draws in the order of the authors' script: positions of objects, steps, turns.
    """
    _require_noise(noise)
    obs_noise = rng.normal(size=log.obs_xy.shape) * (noise * ADDED_OBSERVATION_STD)
    step_noise, turn_noise = rng.normal(size=(len(log.odometry), 2)), rng.normal(size=(len(log.odometry), 1))
    odometry_noise = np.hstack([step_noise, turn_noise]) * (noise * ADDED_ODOMETRY_STD)
    noisier = {}
    for name, added in (("odometry", noise * ADDED_ODOMETRY_STD), ("observation", noise * ADDED_OBSERVATION_STD)):
        noisier[f"{name}_std"] = np.hypot(getattr(log, f"{name}_std"), added)
        if getattr(log, f"{name}_cov") is not None:
            noisier[f"{name}_cov"] = getattr(log, f"{name}_cov") + np.diag(np.square(added))
    return replace(log, odometry=log.odometry + odometry_noise, obs_xy=log.obs_xy + obs_noise, **noisier)


def _require_noise(noise: float) -> None:
    if not 0 <= noise <= 1e6:
        raise ValueError(f"noise: expected a non-negative number up to 1e6, got {noise}")


def simulate_run(
    world: World,
    path: np.ndarray,
    sensor: SensorModel,
    rng: np.random.Generator,
    object_paths: np.ndarray | None = None,
) -> tuple[RobotLog, GroundTruth]:
    """Drive a path through a world and record what the robot measures.

    Args:
        world: the objects.
        path: (T, 3) true poses in W.
        sensor: how odometry and the detector err. Standard deviations must be positive.
        rng: draws odometry noise, detections, position noise, class errors, clutter, the order within each frame and,
            where the sensor sees headings, these.
        object_paths: (T, K, 2) m, W: where each object is at each pose, see ``carried``; None: where the world has it.

    Returns:
        what the estimator may see, and the truth, which holds the world as given even when objects moved.
    """
    path, num_classes = _checked_path(path), len(world.class_names)
    _require_confusion(sensor.class_confusion, num_classes)
    odometry = se2.between(path[:-1], path[1:]) + rng.normal(size=(len(path) - 1, 3)) * sensor.odometry_std

    time, obj, xy = visible_objects(world, path, sensor, object_paths)
    detected = rng.random(len(time)) < sensor.detection_probability
    time, obj, xy = time[detected], obj[detected], xy[detected]
    xy = xy + rng.normal(size=xy.shape) * sensor.observation_std
    obs_class = _reported_class(world.object_class[obj], sensor.class_confusion, rng)
    clutter_time, clutter_xy, clutter_class = _clutter(len(path), num_classes, sensor, rng)

    time = np.concatenate([time, clutter_time])
    # Within a frame in random order: otherwise the order itself would reveal the objects' identities.
    in_time = np.lexsort((rng.random(len(time)), time))
    log = RobotLog(
        odometry=odometry,
        obs_time=time[in_time],
        obs_xy=np.concatenate([xy, clutter_xy])[in_time],
        obs_class=np.concatenate([obs_class, clutter_class])[in_time],
        num_classes=num_classes,
        odometry_std=sensor.odometry_std,
        observation_std=sensor.observation_std,
    )
    obs_object = np.concatenate([obj, np.full(len(clutter_time), -1)])[in_time]
    return _with_headings(log, truth := GroundTruth(world, path, obs_object), sensor, rng), truth


def _with_headings(log: RobotLog, truth: GroundTruth, sensor: SensorModel, rng: np.random.Generator) -> RobotLog:
    """The log with a heading for each observation, where the sensor sees them.

    Of what looks alike the sensor reports any with the same probability, and any at all of clutter and of the round.
    """
    std, object_theta, count = sensor.observation_theta_std, truth.world.object_theta, log.num_observations
    if std is None:
        return log
    if object_theta is None:
        raise ValueError("world.object_theta: expected headings, because the sensor sees them, got none")
    symmetry = np.ones(log.num_classes, dtype=int) if sensor.class_symmetry is None else sensor.class_symmetry
    alike = np.append(symmetry[truth.world.object_class], 0)[truth.obs_object]
    noise, part = rng.normal(size=count) * std, rng.random(count)
    turn = np.where(alike == 0, part, np.floor(part * alike) / np.maximum(alike, 1)) * 2 * np.pi
    theta = np.append(object_theta, 0.0)[truth.obs_object] - truth.poses[log.obs_time, 2] + noise + turn
    return replace(log, obs_theta=se2.wrap(theta), observation_theta_std=std, class_symmetry=sensor.class_symmetry)


def _require_confusion(class_confusion: np.ndarray | None, num_classes: int) -> None:
    if class_confusion is not None and len(class_confusion) != num_classes:
        raise ValueError(f"class_confusion: expected {num_classes} rows, got {len(class_confusion)}")


def _checked_path(path) -> np.ndarray:
    path = checked_array("path", path, (None, 3))
    if len(path) == 0:
        raise ValueError("path: expected at least one pose, got none")
    return path


def visible_objects(
    world: World, path: np.ndarray, sensor: SensorModel, object_paths: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Which objects are within range and field of view of which pose.

    Returns:
        (V,) pose index, in increasing order; (V,) object index; (V, 2) m, the object in the frame of the pose.
    """
    checked_array("world.object_xy", world.object_xy, (None, 2))  # a truth may hold NaN, a scene may not
    shape, observations = (len(path), *world.object_xy.shape), []
    if object_paths is None:
        object_xy = np.broadcast_to(world.object_xy, shape)
    else:
        object_xy = checked_array("object_paths", object_paths, shape)
    for begin in range(0, len(path), STRETCH):
        stretch, places = path[begin : begin + STRETCH], object_xy[begin : begin + STRETCH]
        # On a long path, most objects are far from any one stretch of it.
        low, high = stretch[:, :2].min(axis=0) - sensor.max_range, stretch[:, :2].max(axis=0) + sensor.max_range
        near = np.flatnonzero(((places >= low) & (places <= high)).all(axis=2).any(axis=0))
        xy = se2.apply_inverse(stretch[:, None, :], places[:, near])
        time, obj = np.nonzero(np.linalg.norm(xy, axis=-1) < sensor.max_range)
        xy = xy[time, obj]
        in_view = np.abs(np.arctan2(xy[:, 1], xy[:, 0])) < sensor.field_of_view / 2
        observations.append((begin + time[in_view], near[obj[in_view]], xy[in_view]))
    return tuple(np.concatenate(parts) for parts in zip(*observations, strict=True))


def carried(object_xy: np.ndarray, goal_xy: np.ndarray, num_poses: int) -> np.ndarray:
    """Positions of objects that are carried at constant speed along a straight line, during the whole run.

    Args:
        object_xy: (K, 2) m, W, at the first pose.
        goal_xy: (K, 2) m, W, at the last pose; the same place for an object that stays.
        num_poses: T.

    Returns:
        (T, K, 2) m, W, for ``simulate_run``. Only the simulator knows them: a log does not record what moved.
    """
    share = np.linspace(0.0, 1.0, num_poses)[:, None, None]
    return object_xy + share * (np.asarray(goal_xy) - object_xy)


def follow(xy: np.ndarray, step: float) -> np.ndarray:
    """Drive along a line in steps of equal length.

    Args:
        xy: (N, 2) m, a finely sampled line.
        step: m.

    Returns:
        (T, 3) poses in W; each faces the next, and the last has the heading of the one before it.
    """
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(xy, axis=0), axis=1))])
    stops = np.arange(0.0, length[-1] + 1e-9, step)
    points = np.column_stack([np.interp(stops, length, xy[:, axis]) for axis in (0, 1)])
    ahead = np.diff(points, axis=0)
    heading = np.arctan2(ahead[:, 1], ahead[:, 0])
    return np.column_stack([points, np.append(heading, heading[-1])])


def _reported_class(true_class: np.ndarray, confusion: np.ndarray | None, rng: np.random.Generator) -> np.ndarray:
    """Draw the class that the detector reports, from the row of the true class."""
    if confusion is None:
        return true_class
    below = np.cumsum(confusion, axis=1)[true_class] <= rng.random(len(true_class))[:, None]
    return np.minimum(below.sum(axis=1), len(confusion) - 1)


def _clutter(num_poses: int, num_classes: int, sensor: SensorModel, rng: np.random.Generator):
    """False detections: their number is Poisson, their position uniform over the field of view, their class uniform."""
    time = np.repeat(np.arange(num_poses), rng.poisson(sensor.clutter_rate, num_poses))
    distance = sensor.max_range * np.sqrt(rng.random(len(time)))
    bearing = sensor.field_of_view * (rng.random(len(time)) - 0.5)
    xy = np.column_stack([distance * np.cos(bearing), distance * np.sin(bearing)])
    return time, xy, rng.integers(0, num_classes, len(time))
