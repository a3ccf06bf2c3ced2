"""Checks of lesson 02: motions of the plane, dead reckoning, and the uncertainty of an observation."""

from collections.abc import Callable

import numpy as np

from npslam_teach import se2
from npslam_teach.course.checking import Verdict, judge_function

NOT_WRAPPED = "the angle is not wrapped: one direction has two numbers, keep the one from -180 up to 180 degrees"
NOT_TURNED = "nothing is turned: 'forward' and 'left' are the robot's directions, not the room's"
TURNED_BACKWARDS = "the rotation goes the wrong way round: look at the sign before the sine"


def check_compose(compose: Callable) -> Verdict:
    """Exercise 1: ``compose(pose, step)``, (3,), the angle wrapped."""

    def raw(pose, step, turn=1.0):
        return np.append(pose[:2] + se2.rotate(turn * pose[2], step[:2]), pose[2] + step[2])

    mistakes = [
        (lambda p, o: se2.compose(o, p), "the two motions are chained in the wrong order: the step begins at the pose"),
        (lambda p, o: raw(p, o, 0.0), NOT_TURNED),
        (lambda p, o: raw(p, o, -1.0), TURNED_BACKWARDS),
        (lambda p, o: _with(se2.compose(p, o), 2, se2.wrap(p[2])), "the robot never turns: the two headings add up"),
        (
            lambda p, o: np.append(p[:2] + se2.rotate(p[2] + o[2], o[:2]), p[2] + o[2]),
            "the step is turned by the new heading: it was driven before the turn",
        ),
    ]
    trials = list(zip(_poses(8), _poses(8, 1), strict=True))
    return _judge("your pose", compose, trials, se2.compose, mistakes, "a step takes you from one pose to the next")


def check_between(between: Callable) -> Verdict:
    """Exercise 2: ``between(pose_a, pose_b)``, (3,), the angle wrapped."""

    def raw(a, b, turn):
        return np.append(se2.rotate(turn * a[2], b[:2] - a[:2]), b[2] - a[2])

    mistakes = [
        (lambda a, b: raw(a, b, 0.0), "the difference is still in the room's directions: turn it back by a's heading"),
        (lambda a, b: raw(a, b, 1.0), TURNED_BACKWARDS),
        (lambda a, b: se2.between(b, a), "this is a as seen from b: the two poses are swapped"),
        (lambda a, b: se2.compose(a, b), "this goes on from a instead of undoing it: that was compose"),
        (lambda a, b: np.append(se2.rotate(-b[2], b[:2] - a[:2]), b[2] - a[2]), "it is turned back by b's heading"),
    ]
    trials = list(zip(_poses(8, 2), _poses(8, 3), strict=True))
    return _judge("your step", between, trials, se2.between, mistakes, "this is what wheels measure")


def check_dead_reckoning(dead_reckoning: Callable) -> Verdict:
    """Exercise 3: ``dead_reckoning(odometry, start)``, (T, 3)."""

    def chained(odometry, start, step):
        path = [start]
        for each in odometry:
            path.append(step(path[-1], each))
        return np.array(path)

    mistakes = [
        (lambda o, s: chained(o, s, lambda p, q: se2.compose(q, p)), "compose has its arguments in the wrong order"),
        (lambda o, s: chained(o, s, np.add), f"steps are added number by number: {NOT_TURNED}"),
        (lambda o, s: se2.dead_reckoning(o), "the path always starts at the origin: use the start you are given"),
        (lambda o, s: se2.dead_reckoning(o, [*s[:2], 0.0]), "the heading of the start is lost"),
        (lambda o, s: se2.dead_reckoning(o, s)[1:], "the start itself is missing: T - 1 steps make T poses"),
        (lambda o, s: se2.dead_reckoning(o, s)[:-1], "the last step is missing: T - 1 steps make T poses"),
    ]
    trials = [(_poses(5, seed), _poses(1, seed + 50)[0]) for seed in range(10, 16)]
    praise = "every pose is built on the one before it"
    return _judge("your path", dead_reckoning, trials, se2.dead_reckoning, mistakes, praise)


def check_to_world(to_world: Callable) -> Verdict:
    """Exercise 4: ``to_world(pose, xy_robot)``, (2,)."""
    mistakes = [
        (lambda p, z: p[:2] + z, NOT_TURNED),
        (lambda p, z: p[:2] + se2.rotate(-p[2], z), TURNED_BACKWARDS),
        (lambda p, z: se2.rotate(p[2], z), "the robot's own position is missing"),
        (lambda p, z: se2.rotate(p[2], p[:2] + z), "turn first, then add: the position is in the room's directions"),
        (se2.apply_inverse, "this goes from the room to the robot: that is the way back"),
        (lambda p, z: p[:2] + se2.rotate(p[2], z[::-1]), "'ahead' and 'left' are swapped"),
    ]
    trials = [(pose, step[:2]) for pose, step in zip(_poses(8, 4), _poses(8, 5), strict=True)]
    return _judge("your point", to_world, trials, se2.apply, mistakes, "every sighting can go onto the map")


def check_sighting_covariance(sighting_covariance: Callable) -> Verdict:
    """Exercise 5: ``sighting_covariance(pose, pose_cov, xy_robot, observation_std)``, (2, 2)."""

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
    mistakes = [(lambda *a, keys=keys: variant(*a, **keys), message) for message, keys in wrongly.items()]
    rng, trials = np.random.default_rng(6), []
    for pose, observation in zip(_poses(6, 7), _poses(6, 8), strict=True):
        root = rng.normal(size=(3, 3))
        trials.append((pose, root @ root.T, observation[:2], rng.uniform(0.1, 1.5, 2)))
    praise = "the map is less sure than the path, and the more so the further away the object"
    return _judge("your covariance", sighting_covariance, trials, variant, mistakes, praise)


def _poses(count: int, seed: int = 0) -> np.ndarray:
    """Random poses (count, 3) with large turns, so that many sums of headings must be wrapped."""
    rng = np.random.default_rng(seed)
    return np.column_stack([rng.uniform(-3, 3, (count, 2)), rng.uniform(-np.pi, np.pi, count)])


def _with(pose: np.ndarray, index: int, value: float) -> np.ndarray:
    changed = np.array(pose)
    changed[index] = value
    return changed


def _judge(name: str, function: Callable, trials: list, truth: Callable, mistakes: list, praise: str) -> Verdict:
    """Look for a missing wrap first, then for all other mistakes, whether or not the angles are wrapped."""
    by_message = {message: mistake for mistake, message in mistakes}
    if np.shape(truth(*trials[0]))[-1] == 3:
        by_message = {NOT_WRAPPED: truth} | by_message

    def otherwise(answers, expected):
        return _difference(name, answers, expected)

    return judge_function(
        name, function, trials, truth, by_message, praise, otherwise, same=_same, like=_same_up_to_turns
    )


def _same_up_to_turns(answers: list, others: list) -> bool:
    return _same(answers, others, up_to_turns=True)


def _same(answers: list, others: list, up_to_turns: bool = False) -> bool:
    """Whether all answers equal the others; angles stand in the last of three columns."""
    for answer, other in zip(answers, others, strict=True):
        if answer.shape != np.shape(other):
            return False
        difference = answer - other
        if up_to_turns and answer.shape[-1] == 3:
            difference[..., 2] = se2.wrap(difference[..., 2])
        if np.abs(difference).max() > 1e-6:
            return False
    return True


def _difference(name: str, answers: list, expected: list) -> str:
    """What can be said about an unknown mistake."""
    if answers[0].shape[-1] != 3 or answers[0].shape != np.shape(expected[0]):
        return f"{name} is off: try a heading of 0 first, then one of 90 degrees, on paper"
    wrapped = [se2.wrap((a - e)[..., 2]) for a, e in zip(answers, expected, strict=True)]
    moved = max(np.abs((a - e)[..., :2]).max() for a, e in zip(answers, expected, strict=True))
    turned = max(np.abs(each).max() for each in wrapped)
    if moved <= 1e-6:
        return f"the position of {name} is right, its angle is not"
    return f"the {'position' if turned <= 1e-6 else 'position and the angle'} of {name} is off"
