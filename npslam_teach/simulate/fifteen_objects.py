"""The fifteen-object scene: our own version of the paper's simulation (paper section V.A; deck figure 14)."""

from dataclasses import replace
from functools import cache

import numpy as np

from npslam_teach.simulate.robot_run import follow, paper_sensor, simulate_run, visible_objects
from npslam_teach.types import GroundTruth, RobotLog, SensorModel, World

FIFTEEN_CLASSES = ("chair", "screen", "cup", "book", "lamp")


def fifteen_objects(
    seed: int = 2016, noise: float = 1.0, class_confusion: np.ndarray | None = None
) -> tuple[RobotLog, GroundTruth]:
    """Our own version of the paper's simulation: 15 objects, 5 classes of 3, a path that sees each several times.

    The seed determines both the world and the noise, so a result over many seeds is a result over many worlds. Worlds
    in which the path passes some object fewer than two times are drawn again. The number of observations differs from
    seed to seed, between about 1050 and 1300.

    Args:
        seed: of ``numpy.random.default_rng``; the default is the year of the paper.
        noise: 1 is the paper's run; see ``paper_sensor``.
        class_confusion: (5, 5), see ``SensorModel``; None: no class is ever confused, as in the paper.
    """
    rng = np.random.default_rng(seed)
    path, sensor = designed_path(), replace(paper_sensor(noise), class_confusion=class_confusion)
    world = scattered_world(3, FIFTEEN_CLASSES, rng)
    while num_visits(world, path, sensor).min() < 2:
        world = scattered_world(3, FIFTEEN_CLASSES, rng)
    return simulate_run(world, path, sensor, rng)


def num_visits(world: World, path: np.ndarray, sensor: SensorModel, gap: int = 20) -> np.ndarray:
    """How often the path passes each object, (K,). Observations more than ``gap`` poses apart are two visits."""
    time, obj, _ = visible_objects(world, path, sensor)
    times = [time[obj == k] for k in range(len(world.object_xy))]
    return np.array([np.count_nonzero(np.diff(t) > gap) + (len(t) > 0) for t in times])


def scattered_world(
    objects_per_class: int,
    class_names: tuple,
    rng: np.random.Generator,
    size: float = 10.0,
    separation: float = 0.5,
    class_separation: float = 2.0,
) -> World:
    """Objects scattered evenly over a square, none too close to another.

    In the paper's own scene the nearest two objects of one class are 2.9 m apart. Two chairs that stand closer together
    than the drift cannot be distinguished by position and class.

    Args:
        objects_per_class: how many of each.
        class_names: (C,).
        rng: the generator.
        size: m, the side of the square [0, size]^2.
        separation: m, the least distance between any two objects.
        class_separation: m, the least distance between two objects of one class.

    Raises:
        ValueError: when there is no room.
    """
    num_objects = objects_per_class * len(class_names)
    object_class = np.arange(num_objects) % len(class_names)
    placed = np.empty((0, 2))
    for _ in range(1000 * num_objects):
        candidate = rng.uniform(0.0, size, 2)
        alike = object_class[: len(placed)] == object_class[len(placed)]
        apart = np.linalg.norm(placed - candidate, axis=1)
        if (apart >= np.where(alike, class_separation, separation)).all():
            placed = np.vstack([placed, candidate])
        if len(placed) == num_objects:
            return World(placed, object_class, class_names)
    raise ValueError(f"size: expected room for {num_objects} separate objects, got a square of {size} m")


@cache
def designed_path(step: float = 0.1) -> np.ndarray:
    """The designed path of the fifteen-object scene: a closed line of 70 m that loops three times.

    It is an epitrochoid about the middle of the 10 m x 10 m room, and each loop passes through the middle. Within a
    loop an object is seen again after some 12 m, and the whole path closes at the end.

    Args:
        step: m between one pose and the next.

    Returns:
        (T, 3) poses in W, heading along the path; read-only, because many runs share them.
    """
    phase = np.linspace(0.0, 2 * np.pi, 20_001)
    radius, loops = 2.75, 3
    x = np.cos(phase) + np.cos((loops + 1) * phase)
    y = np.sin(phase) + np.sin((loops + 1) * phase)
    path = follow(5.0 + radius * np.column_stack([x, y]), step)
    path.setflags(write=False)
    return path
