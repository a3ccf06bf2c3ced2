"""A cluttered office whose aisle is walked twice: our stand-in for the paper's experiment (paper section V.B).

The plan is drawn by hand: ten desks, each with chairs, screens and small things, several of one class within arm's
reach of each other. The seed moves everything a little and draws the noise. Unlike in the fifteen-object scene the
detector confuses classes, misses objects, and reports some that are not there.
"""

from dataclasses import dataclass

import numpy as np

from npslam_teach import se2
from npslam_teach.simulate.robot_run import follow, simulate_run
from npslam_teach.types import GroundTruth, RobotLog, SensorModel, World

OFFICE_CLASSES = ("chair", "screen", "cup", "book", "keyboard", "phone", "plant", "bin")
ROOM_SIZE = (8.4, 7.2)  # m, from (0, 0)
DESK_SIZE = (1.6, 0.8)  # m; a desk's own frame has x along its front edge and y away from who sits there

# x, y in m and heading in rad of every desk: two back to back in the middle, eight along the walls.
EAST, NORTH, WEST, SOUTH = -np.pi / 2, 0.0, np.pi / 2, np.pi  # where a person at the desk looks
DESKS = np.array(
    [(4.2, 3.2, NORTH), (4.2, 4.0, SOUTH)]
    + [(2.2, 0.4, SOUTH), (4.2, 0.4, SOUTH), (6.2, 0.4, SOUTH)]
    + [(8.0, 2.6, EAST), (8.0, 4.6, EAST)]
    + [(5.6, 6.8, NORTH), (2.6, 6.8, NORTH), (0.4, 3.6, WEST)]
)
# What stands at a desk, in the desk's frame: class, x, y in m.
TWO_PLACES = (("chair", -0.4, -0.65), ("chair", 0.4, -0.65), ("screen", -0.35, 0.2), ("screen", 0.35, 0.2))
ONE_PLACE = (("chair", 0.0, -0.65), ("screen", 0.0, 0.2))
THINGS_AT = (
    TWO_PLACES + (("cup", 0.05, -0.1), ("keyboard", -0.4, -0.15)),
    ONE_PLACE + (("keyboard", 0.0, -0.15), ("book", 0.6, 0.0), ("phone", -0.55, 0.0)),
    TWO_PLACES + (("book", 0.0, -0.1),),
    ONE_PLACE + (("cup", 0.5, -0.1), ("keyboard", 0.0, -0.15)),
    TWO_PLACES + (("phone", -0.05, 0.1),),
    ONE_PLACE + (("book", -0.5, -0.1), ("book", 0.6, 0.1)),
    TWO_PLACES + (("cup", 0.0, 0.0),),
    ONE_PLACE + (("cup", -0.4, -0.1), ("cup", 0.5, -0.1)),
    TWO_PLACES + (("keyboard", 0.35, -0.15),),
    ONE_PLACE + (("phone", 0.5, 0.0), ("book", -0.55, 0.0)),
)
ON_THE_FLOOR = (  # class, x, y in m, W
    ("plant", 0.5, 0.5),
    ("plant", 7.9, 0.5),
    ("plant", 7.9, 6.7),
    ("plant", 0.5, 6.7),
    ("bin", 3.1, 3.6),
    ("bin", 4.1, 6.9),
)
CONFUSED = (  # true class, reported class, how often
    ("cup", "phone", 0.15),
    ("phone", "cup", 0.15),
    ("book", "keyboard", 0.20),
    ("keyboard", "book", 0.20),
    ("screen", "book", 0.05),
    ("bin", "chair", 0.15),
    ("plant", "chair", 0.05),
)


@dataclass(frozen=True, eq=False)
class OfficeScene:
    """Where everything stands, for a run through it and for a camera in it."""

    seed: int
    world: World
    yaw: np.ndarray  # (K,) rad, how each object is turned
    at_desk: np.ndarray  # (K,) index into DESKS; -1: on the floor
    path: np.ndarray  # (T, 3) true poses in W


def office(seed: int = 2016) -> tuple[RobotLog, GroundTruth]:
    """Walk twice around the office and record what an RGB-D camera and a detector report.

    Args:
        seed: of ``numpy.random.default_rng``; it moves the objects and draws all noise.

    Returns:
        what the estimator may see, and the truth.
    """
    scene = office_scene(seed)
    # A separate random stream, so that it has no influence on what `office_camera` draws.
    return simulate_run(scene.world, scene.path, office_sensor(), np.random.default_rng([seed, 1]))


def office_scene(seed: int = 2016) -> OfficeScene:
    """The plan with every object moved a little: chairs by 10 cm and turned, the rest by 3 cm."""
    rng = np.random.default_rng([seed, 0])
    name, x, y, desk = zip(*_plan(), strict=True)
    desk = np.array(desk)
    is_chair = np.array(name) == "chair"
    # Bounded: no chair may stand in the aisle.
    nudge = rng.normal(size=(len(name), 3)).clip(-1.5, 1.5) * np.where(is_chair, 0.10, 0.03)[:, None]
    origin = np.where(desk[:, None] >= 0, DESKS[desk], 0.0)
    # Chairs stand turned by some 20 degrees, the rest nearly straight.
    yaw = origin[:, 2] + nudge[:, 2] * np.where(is_chair, 3.5, 1.0)
    xy = se2.apply(origin, np.column_stack([x, y]) + nudge[:, :2])
    world = World(xy, [OFFICE_CLASSES.index(each) for each in name], OFFICE_CLASSES)
    return OfficeScene(seed, world, se2.wrap(yaw), desk, office_path())


def _plan() -> list[tuple]:
    """Every object as class name, x, y, desk; x and y in the frame of the desk, or in W without one."""
    at_desks = [(*thing, k) for k, things in enumerate(THINGS_AT) for thing in things]
    return at_desks + [(*thing, -1) for thing in ON_THE_FLOOR]


def office_sensor() -> SensorModel:
    """The odometry, the RGB-D camera and the detector of the office.

    The odometry noise is what ``load_stata_office`` assumes of the authors' visual odometry. The field of view is 57
    degrees, as that of the first Kinect, and the range 4 m. A measured centre errs more along the view than across it,
    because a camera sees only the front of an object; lesson 08 measures both errors on rendered frames.
    """
    confusion = np.eye(len(OFFICE_CLASSES))
    for true, reported, share in CONFUSED:
        row = OFFICE_CLASSES.index(true)
        confusion[row, OFFICE_CLASSES.index(reported)] += share
        confusion[row, row] -= share
    return SensorModel(
        odometry_std=(0.01, 0.01, 0.01),
        observation_std=(0.15, 0.10),
        max_range=4.0,
        field_of_view=np.deg2rad(57.0),
        class_confusion=confusion,
        detection_probability=0.4,
        clutter_rate=0.1,
    )


def office_path(step: float = 0.04) -> np.ndarray:
    """Twice around the aisle, 27 m in all, swaying a little as people do.

    Args:
        step: m between one pose and the next.

    Returns:
        (T, 3) poses in W, heading along the path.
    """
    straight, radius = np.array([2.4, 1.5]), 0.9  # m: a rectangle with round corners
    corners = np.array(ROOM_SIZE) / 2 + straight / 2 * np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    lap = []
    for k, corner in enumerate(np.roll(corners, -1, axis=0)):
        angle = np.pi / 2 * (k - 1 + np.linspace(0.0, 1.0, 200))
        lap.append(corner + radius * np.column_stack([np.cos(angle), np.sin(angle)]))
    lap = np.concatenate(lap)
    middle = follow(np.concatenate([lap, lap, lap[:1]]), 0.01)
    # A lap is not a whole number of sways, so no place is passed twice in the same way.
    sway = 0.1 * np.sin(2 * np.pi * 0.01 * np.arange(len(middle)) / 3.1)
    xy = se2.apply(middle, np.column_stack([np.zeros_like(sway), sway]))
    return follow(xy, step)
