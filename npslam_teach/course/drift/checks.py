"""Checks of lesson 02: motions of the plane, dead reckoning, and the uncertainty of an observation."""

from collections.abc import Callable
from functools import partial

import numpy as np

from npslam_teach import se2
from npslam_teach.course import drawings
from npslam_teach.course.checking import Verdict
from npslam_teach.course.comparing import close
from npslam_teach.course.drawn import Drawing
from npslam_teach.course.trials import Part, check_function, fresh
from npslam_teach.course.verdict_page import exercise

NOT_WRAPPED = "the angle is not wrapped: one direction has two numbers, keep the one from -180 up to 180 degrees"
NOT_TURNED = "nothing is turned: 'forward' and 'left' are the robot's directions, not the room's"
TURNED_BACKWARDS = "the rotation goes the wrong way round: look at the sign before the sine"


@exercise("02", 1, of=5)
def check_compose(compose: Callable) -> Verdict:
    """Exercise 1: ``compose(pose, step)``, (3,), the angle wrapped."""

    def truth(pose, step):
        return se2.compose(pose, step)

    def raw(pose, step, turn=1.0):
        return np.append(pose[:2] + se2.rotate(turn * pose[2], step[:2]), pose[2] + step[2])

    mistakes = {
        "the two motions are chained in the wrong order: the step begins at the pose": lambda p, o: se2.compose(o, p),
        NOT_TURNED: partial(raw, turn=0.0),
        TURNED_BACKWARDS: partial(raw, turn=-1.0),
        "the robot never turns: the two headings add up": lambda p, o: _with(se2.compose(p, o), 2, se2.wrap(p[2])),
        "the step is turned by the new heading: it was driven before the turn": lambda p, o: np.append(
            p[:2] + se2.rotate(p[2] + o[2], o[:2]), p[2] + o[2]
        ),
    }
    edges = {"with a step of zero": [(_poses(1)[0], np.zeros(3))], "from the origin": [(np.zeros(3), _poses(1)[0])]}
    trials = list(zip(_poses(30), _poses(30), strict=True))
    return _check("your pose", compose, truth, mistakes, trials, edges, "a step takes you from one pose to the next")


@exercise("02", 2, of=5)
def check_between(between: Callable) -> Verdict:
    """Exercise 2: ``between(pose_a, pose_b)``, (3,), the angle wrapped."""

    def truth(pose_a, pose_b):
        return se2.between(pose_a, pose_b)

    def raw(a, b, turn):
        return np.append(se2.rotate(turn * a[2], b[:2] - a[:2]), b[2] - a[2])

    mistakes = {
        "the difference is still in the room's directions: turn it back by a's heading": partial(raw, turn=0.0),
        TURNED_BACKWARDS: partial(raw, turn=1.0),
        "this is a as seen from b: the two poses are swapped": lambda a, b: se2.between(b, a),
        "this goes on from a instead of undoing it: that was compose": se2.compose,
        "it is turned back by b's heading": lambda a, b: np.append(se2.rotate(-b[2], b[:2] - a[:2]), b[2] - a[2]),
    }
    same = _poses(1)[0]
    edges = {
        "between a pose and itself": [(same, same)],
        "with headings of 170 and -170 degrees": [
            (np.array([1.0, 2.0, np.radians(170)]), np.array([3.0, 1.0, np.radians(-170)]))
        ],
    }
    trials = list(zip(_poses(30), _poses(30), strict=True))
    return _check("your step", between, truth, mistakes, trials, edges, "this is what wheels measure")


@exercise("02", 3, of=5)
def check_dead_reckoning(dead_reckoning: Callable) -> Verdict:
    """Exercise 3: ``dead_reckoning(odometry, start)``, (T, 3)."""

    def truth(odometry, start):
        return se2.dead_reckoning(odometry, start)

    def chained(odometry, start, step):
        path = [start]
        for each in odometry:
            path.append(step(path[-1], each))
        return np.array(path)

    mistakes = {
        "compose has its arguments in the wrong order": lambda o, s: chained(o, s, lambda p, q: se2.compose(q, p)),
        f"steps are added number by number: {NOT_TURNED}": lambda o, s: chained(o, s, np.add),
        "the path always starts at the origin: use the start you are given": lambda o, s: se2.dead_reckoning(o),
        "the heading of the start is lost": lambda o, s: se2.dead_reckoning(o, [*s[:2], 0.0]),
        "the start itself is missing: T - 1 steps make T poses": lambda o, s: truth(o, s)[1:],
        "the last step is missing: T - 1 steps make T poses": lambda o, s: truth(o, s)[:-1],
    }
    trials = [(_poses(5 + n), _poses(1)[0]) for n in range(8)]
    edges = {
        "with a single step": [(_poses(1), _poses(1)[0])],
        "with a start of integers": [(_poses(3), np.array([1, -2, 1]))],
        "without a step, when the path is the start alone": [(np.empty((0, 3)), _poses(1)[0])],
    }
    praise = "every pose is built on the one before it"
    return _check("your path", dead_reckoning, truth, mistakes, trials, edges, praise, drawings.dead_reckoning())


@exercise("02", 4, of=5)
def check_to_world(to_world: Callable) -> Verdict:
    """Exercise 4: ``to_world(pose, xy_robot)``, (2,)."""

    def truth(pose, xy_robot):
        return se2.apply(pose, xy_robot)

    mistakes = {
        NOT_TURNED: lambda p, z: p[:2] + z,
        TURNED_BACKWARDS: lambda p, z: p[:2] + se2.rotate(-p[2], z),
        "the robot's own position is missing": lambda p, z: se2.rotate(p[2], z),
        "turn first, then add: the position is in the room's directions": lambda p, z: se2.rotate(p[2], p[:2] + z),
        "this goes from the room to the robot: that is the way back": se2.apply_inverse,
        "'ahead' and 'left' are swapped": lambda p, z: p[:2] + se2.rotate(p[2], z[::-1]),
    }
    trials = [(pose, step[:2]) for pose, step in zip(_poses(20), _poses(20), strict=True)]
    edges = {"with a sighting at the robot itself": [(_poses(1)[0], np.zeros(2))]}
    return _check("your point", to_world, truth, mistakes, trials, edges, "every sighting can go onto the map")


@exercise("02", 5, of=5)
def check_sighting_covariance(sighting_covariance: Callable) -> Verdict:
    """Exercise 5: ``sighting_covariance(pose, pose_cov, xy_robot, observation_std)``, (2, 2)."""

    def truth(pose, pose_cov, xy_robot, observation_std):
        return variant(pose, pose_cov, xy_robot, observation_std)

    def variant(pose, cov, xy, std, lever=1.0, turned=True, power=2, noise=True, robot_lever=False, pose_noise=True):
        rotation = se2.rotate(pose[2], np.eye(2)).T  # rows of the argument are rotated: columns of R
        dx, dy = xy if robot_lever else rotation @ xy
        by_pose = np.array([[1.0, 0.0, -lever * dy], [0.0, 1.0, lever * dx]])
        camera = np.diag(std**power)
        camera = rotation @ camera @ rotation.T if turned else camera
        return pose_noise * (by_pose @ cov @ by_pose.T) + noise * camera

    wrongly = {
        "the camera's error is not turned into the room": {"turned": False},
        "the heading's error is left out: a turned robot swings the sighting sideways": {"lever": 0.0},
        "the swing has the wrong sign: turning left moves what is ahead to the left": {"lever": -1.0},
        "the swing is in the robot's directions: it must be seen in the room": {"robot_lever": True},
        "a standard deviation must be squared before it is added to a covariance": {"power": 1},
        "the camera's own error is missing": {"noise": False},
        "the error of the pose is missing": {"pose_noise": False},
    }
    mistakes = {message: partial(variant, **keys) for message, keys in wrongly.items()}
    rng, trials = fresh(), []
    for pose, observation in zip(_poses(8), _poses(8), strict=True):
        root = rng.normal(size=(3, 3))
        trials.append((pose, root @ root.T, observation[:2], rng.uniform(0.1, 1.5, 2)))
    pose, cov, xy, std = trials[0]
    edges = {
        "with a pose that is known exactly": [(pose, np.zeros((3, 3)), xy, std)],
        "with a sighting at the robot itself": [(pose, cov, np.zeros(2), std)],
    }
    praise = "the map is less sure than the path, and the more so the further away the object"
    return _check("your covariance", sighting_covariance, truth, mistakes, trials, edges, praise)


def _poses(count: int) -> np.ndarray:
    """Random poses (count, 3) with large turns, so that many sums of headings must be wrapped."""
    rng = fresh()
    return np.column_stack([rng.uniform(-3, 3, (count, 2)), rng.uniform(-np.pi, np.pi, count)])


def _with(pose: np.ndarray, index: int, value: float) -> np.ndarray:
    changed = np.array(pose)
    changed[index] = value
    return changed


def _check(
    name: str,
    function: Callable,
    truth: Callable,
    mistakes: dict,
    trials: list,
    edges: dict,
    praise: str,
    drawing: Drawing | None = None,
):
    """Look for a missing wrap first, then for all other mistakes, whether or not the angles are wrapped."""
    with_angles = np.shape(truth(*trials[0]))[-1] == 3
    mistakes = {NOT_WRAPPED: truth} | mistakes if with_angles else mistakes
    same, like = (_wrapped, _up_to_turns) if with_angles else (close, None)
    hint = partial(_difference, name)
    return check_function(function, truth, Part(name, mistakes, same, like, hint), trials, edges, praise, drawing)


def _wrapped(answer: np.ndarray, truth, tolerance: float) -> bool:
    """Right up to the two numbers of the one direction straight back, whose sign is a matter of rounding."""
    return _up_to_turns(answer, truth, tolerance) and bool((np.abs(answer[..., 2]) <= np.pi + 10 * tolerance).all())


def _up_to_turns(answer: np.ndarray, other, tolerance: float) -> bool:
    """Whether motions (..., 3) are equal, their angles up to whole turns."""
    other = np.asarray(other, dtype=float)
    if answer.shape != other.shape:
        return False
    difference = answer - other
    difference[..., 2] = se2.wrap(difference[..., 2])
    return bool(np.abs(difference).max(initial=0.0) <= 10 * tolerance)


def _difference(name: str, answers: list, expected: list) -> str:
    """What can be said about an unknown mistake."""
    if answers[0].shape[-1:] != (3,) or answers[0].shape != expected[0].shape:
        return f"{name} is off: try a heading of 0 first, then one of 90 degrees, on paper"
    wrapped = [se2.wrap((a - e)[..., 2]) for a, e in zip(answers, expected, strict=True)]
    moved = max(np.abs((a - e)[..., :2]).max() for a, e in zip(answers, expected, strict=True))
    turned = max(np.abs(each).max() for each in wrapped)
    if moved <= 1e-5:
        return f"the position of {name} is right, its angle is not"
    return f"the {'position' if turned <= 1e-5 else 'position and the angle'} of {name} is off"
