"""A world that somebody drew: a line for the robot's path, objects where they were dropped, and the noise.

A hand trembles and a mouse reports whole pixels, so the line is smoothed before the robot follows it.
"""

from dataclasses import dataclass, replace

import numpy as np

from npslam_teach.simulate.robot_run import carried, follow, paper_sensor, simulate_run, visible_objects
from npslam_teach.types import GroundTruth, RobotLog, SensorModel, World
from npslam_teach.validation import checked_array

STEP = 0.1  # m between two poses, as in the paper's simulation
HAND_STD = 0.15  # m along the line, of the Gaussian that smooths it: shorter wiggles are not meant
_SAMPLING = 0.02  # m between the points that are smoothed

# As much as a kernel can process while somebody waits for the picture to change.
MIN_LENGTH, MAX_LENGTH = 1.0, 100.0  # m
MAX_POINTS, MAX_OBJECTS, MAX_OBSERVATIONS = 20_000, 60, 5_000
MAX_NOISE, MAX_CLUTTER = 5.0, 1.0
MAX_SEED = 2**32


@dataclass(frozen=True, eq=False)
class Drawing:
    """Everything that a student decides. The seed decides the rest."""

    stroke: np.ndarray  # (N, 2) m, W: the line as it was drawn
    object_xy: np.ndarray  # (K, 2) m, W, at the first pose
    object_class: np.ndarray  # (K,) index into class_names
    class_names: tuple  # C names
    room: np.ndarray  # (4,) m, W: left, bottom, right, top
    object_goal: np.ndarray | None = None  # (K, 2) m, W, at the last pose; None: nothing moves
    noise: float = 1.0  # 1 is the paper's, see paper_sensor
    clutter_rate: float = 0.0  # false observations per pose
    seed: int = 1

    def __post_init__(self):
        shapes = {"stroke": (None, 2), "object_xy": (None, 2), "room": (4,)}
        for name, shape in shapes.items():
            object.__setattr__(self, name, checked_array(name, getattr(self, name), shape))
        goal = self.object_xy if self.object_goal is None else self.object_goal
        object.__setattr__(self, "object_goal", checked_array("object_goal", goal, self.object_xy.shape))
        self._require_size()
        self._require_inside()
        self._require_numbers()
        World(self.object_xy, self.object_class, self.class_names)

    def _require_size(self) -> None:
        if len(self.stroke) > MAX_POINTS:
            raise ValueError(f"path: expected at most {MAX_POINTS} points, got {len(self.stroke)}")
        if len(self.object_xy) > MAX_OBJECTS:
            raise ValueError(f"objects: expected at most {MAX_OBJECTS}, got {len(self.object_xy)}")
        length = stroke_length(self.stroke)
        if length < MIN_LENGTH:
            hint = "press and keep drawing, a click alone is no path"
            raise ValueError(f"path: expected at least {MIN_LENGTH:g} m, got {length:.2f} m; {hint}")
        if length > MAX_LENGTH:
            raise ValueError(f"path: expected at most {MAX_LENGTH:g} m, got {length:.1f} m; draw a shorter one")

    def _require_inside(self) -> None:
        left, bottom, right, top = self.room
        if not (left < right and bottom < top):
            raise ValueError(f"room: expected left < right and bottom < top, got {self.room.tolist()}")
        for what, xy in (("path", self.stroke), ("objects", self.object_xy), ("goals", self.object_goal)):
            outside = ((xy < self.room[:2]) | (xy > self.room[2:])).any(axis=1)
            if outside.any():
                x, y = xy[outside.argmax()]
                room = f"the room, x from {left:g} to {right:g} m and y from {bottom:g} to {top:g} m"
                raise ValueError(f"{what}: expected all inside {room}, got one at ({x:.2f}, {y:.2f}) m")

    def _require_numbers(self) -> None:
        for name, most in (("noise", MAX_NOISE), ("clutter_rate", MAX_CLUTTER)):
            value = getattr(self, name)
            if not 0 <= value <= most:
                raise ValueError(f"{name}: expected a number from 0 to {most:g}, got {value}")
        if self.seed != int(self.seed) or not 0 <= self.seed < MAX_SEED:
            raise ValueError(f"seed: expected an integer from 0 to {MAX_SEED - 1}, got {self.seed}")


def drawn_run(drawing: Drawing) -> tuple[RobotLog, GroundTruth]:
    """Drive the drawn path through the drawn world.

    Args:
        drawing: equal drawings give equal runs.

    Returns:
        what the robot measures, and the truth. Of an object that is carried, the truth holds the position at the first
        pose: the format has no other.

    Raises:
        ValueError: there are more observations than can be processed while somebody waits.
    """
    world = World(drawing.object_xy, drawing.object_class, drawing.class_names)
    path, sensor = drawn_path(drawing.stroke), drawn_sensor(drawing)
    moves = (drawing.object_goal != drawing.object_xy).any()
    object_paths = carried(drawing.object_xy, drawing.object_goal, len(path)) if moves else None
    expected = len(visible_objects(world, path, sensor, object_paths)[0]) + drawing.clutter_rate * len(path)
    if expected > MAX_OBSERVATIONS:
        hint = "draw a shorter path or fewer objects"
        raise ValueError(f"observations: expected at most {MAX_OBSERVATIONS}, got about {expected:.0f}; {hint}")
    return simulate_run(world, path, sensor, np.random.default_rng(int(drawing.seed)), object_paths)


def drawn_sensor(drawing: Drawing) -> SensorModel:
    """The paper's sensors, with the noise and the false observations of the drawing."""
    return replace(paper_sensor(drawing.noise), clutter_rate=float(drawing.clutter_rate))


def drawn_path(stroke: np.ndarray, step: float = STEP) -> np.ndarray:
    """The poses (T, 3) of a robot that follows a line drawn by hand, in steps of equal length.

    Short wiggles are smoothed away. The line is first extended by its point reflection at both ends, so that the ends
    stay where they were drawn and a straight line stays straight.

    Args:
        stroke: (N, 2) m, W, at least ``MIN_LENGTH`` long.
        step: m.

    Raises:
        ValueError: less than half of ``MIN_LENGTH`` is left of the line after smoothing.
    """
    along = _lengths(stroke)
    num_points = max(int(np.ceil(along[-1] / _SAMPLING)), 2) + 1
    even = np.linspace(0.0, along[-1], num_points)
    xy = np.column_stack([np.interp(even, along, stroke[:, axis]) for axis in (0, 1)])
    width = min(round(3 * HAND_STD / _SAMPLING), num_points - 1)
    kernel = np.exp(-0.5 * (np.arange(-width, width + 1) * _SAMPLING / HAND_STD) ** 2)
    padded = np.concatenate([2 * xy[0] - xy[width:0:-1], xy, 2 * xy[-1] - xy[-2 : -2 - width : -1]])
    smooth = np.column_stack([np.convolve(padded[:, axis], kernel / kernel.sum(), mode="valid") for axis in (0, 1)])
    length = stroke_length(smooth)
    if length < MIN_LENGTH / 2:
        raise ValueError(f"path: expected at least {MIN_LENGTH / 2:g} m after smoothing, got {length:.2f} m")
    return follow(smooth, step)


def stroke_length(stroke: np.ndarray) -> float:
    """The length of a line (N, 2) in m; that of a single point, or of none, is 0."""
    return float(_lengths(stroke)[-1])


def _lengths(xy: np.ndarray) -> np.ndarray:
    """The distance along a line to each of its points, (N,) m; one zero where there is no point."""
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(xy, axis=0), axis=1))])
