"""The checks of lesson 07: chi2 per degree of freedom, the error of a path, and the adjusted Rand index."""

import math
from collections.abc import Callable

import numpy as np

from npslam_teach import se2
from npslam_teach.course.checking import Verdict, array_from, right, wrong
from npslam_teach.evaluation import compare_partitions


def check_per_dof(student: Callable) -> Verdict:
    """Exercise 1: ``student(chi2, num_poses, num_observations, num_objects)`` is chi2 per degree of freedom."""
    rng = np.random.default_rng(7)
    for _ in range(6):
        poses, objects = int(rng.integers(5, 900)), int(rng.integers(1, 30))
        seen, value = int(rng.integers(2 * objects + 3, 1500)), float(rng.uniform(10, 3000))
        number, verdict = array_from("the answer", student, (), value, poses, seen, objects)
        if verdict is not None:
            return verdict
        measured, unknown = 3 * (poses - 1) + 2 * seen, 3 * (poses - 1) + 2 * objects
        if not math.isclose(number, value / (measured - unknown), rel_tol=1e-9):
            return wrong(_mistake_in_per_dof(float(number), value, poses, seen, objects))
    return right("near 1 when the model and the data agree")


def _mistake_in_per_dof(answer: float, value: float, poses: int, seen: int, objects: int) -> str:
    steps = 3 * (poses - 1)
    mistakes = {
        "pose 0 is held still: it is the gauge, not an unknown": steps + 2 * seen - 3 * poses - 2 * objects,
        "there is one step less than there are poses": 3 * poses + 2 * seen - steps - 2 * objects,
        "the unknowns are not taken off: what is left over is measured minus unknown": steps + 2 * seen,
        "the objects are not taken off: each has two unknown coordinates": 2 * seen,
        "a sighting measures two numbers": steps + seen - steps - 2 * objects,
        "an object has two unknown coordinates": steps + 2 * seen - steps - 3 * objects,
        "an object has two unknown coordinates, not one": steps + 2 * seen - steps - objects,
        "sightings and objects were counted, their coordinates are wanted": seen - objects,
        "a pose has three unknowns, a step three measured numbers": 2 * seen - 2 * objects + (poses - 1),
    }
    for message, dof in mistakes.items():
        if dof and math.isclose(answer, value / dof, rel_tol=1e-9):
            return message
    if math.isclose(answer, 0.5 * value / (2 * seen - 2 * objects), rel_tol=1e-9):
        return "chi2 is the whole sum here, not half of it"
    return "count the measured numbers of all steps and sightings, and take off the unknown ones"


def check_mean_pose_error(student: Callable) -> Verdict:
    """Exercise 2: ``student(poses, true_poses)`` is the mean distance after the best rigid alignment."""
    rng = np.random.default_rng(17)
    for _ in range(4):
        truth = np.cumsum(rng.normal(0, 0.4, (60, 3)), axis=0)
        motion = np.array([rng.uniform(2, 5), rng.uniform(-5, -2), rng.uniform(0.5, 2.5)])
        poses = se2.compose(motion, truth)
        poses[:, :2] += np.cumsum(rng.normal(0, 0.1, (60, 2)), axis=0)
        number, verdict = array_from("the error", student, (), poses.copy(), truth.copy())
        if verdict is not None:
            return verdict
        errors = _aligned_errors(poses, truth)
        if not math.isclose(number, errors.mean(), rel_tol=1e-9):
            return wrong(_mistake_in_error(float(number), poses, truth, errors))
    return right("a map may lie anywhere; only its shape is judged")


def _aligned_errors(poses: np.ndarray, truth: np.ndarray) -> np.ndarray:
    motion = se2.align(poses[:, :2], truth[:, :2])
    return np.linalg.norm(se2.apply(motion, poses[:, :2]) - truth[:, :2], axis=1)


def _mean_distance(xy: np.ndarray, other_xy: np.ndarray) -> float:
    return float(np.linalg.norm(xy - other_xy, axis=1).mean())


def _mistake_in_error(answer: float, poses: np.ndarray, truth: np.ndarray, errors: np.ndarray) -> str:
    here, there = poses[:, :2], truth[:, :2]
    back = se2.inverse(se2.align(here, there))
    by_first = se2.compose(truth[0], se2.inverse(poses[0]))
    shifted = here - here.mean(axis=0) + there.mean(axis=0)
    candidates = {
        "the path was not laid over the truth before measuring": _mean_distance(here, there),
        "the path was only shifted onto the truth: it must be turned too": _mean_distance(shifted, there),
        "the motion was applied the wrong way round": _mean_distance(se2.apply(back, here), there),
        "only the first poses were laid on each other: use the motion that fits the whole path best": _mean_distance(
            se2.apply(by_first, here), there
        ),
        "this is the root of the mean square, asked for is the mean": np.sqrt((errors**2).mean()),
        "these are squared metres: take the root of each": (errors**2).mean(),
        "the errors are added up: divide by the number of poses": errors.sum(),
        "this is the median, asked for is the mean": np.median(errors),
        "this is the largest error, asked for is the mean": errors.max(),
    }
    for message, number in candidates.items():
        if math.isclose(answer, number, rel_tol=1e-9):
            return message
    return "the number is off: align the x and y of the path, carry it over, and average the distances"


def check_adjusted_rand(student: Callable) -> Verdict:
    """Exercise 3: ``student(true_labels, labels)`` is the adjusted Rand index, by counting pairs."""
    rng = np.random.default_rng(27)
    for _ in range(6):
        true_labels = rng.integers(0, 4, 40)
        labels = np.where(rng.random(40) < 0.6, true_labels, rng.integers(0, 6, 40))
        number, verdict = array_from("the index", student, (), true_labels.copy(), labels.copy())
        if verdict is not None:
            return verdict
        expected = compare_partitions(true_labels, labels)[0]
        if not math.isclose(number, expected, rel_tol=1e-9, abs_tol=1e-12):
            return wrong(_mistake_in_rand(float(number), true_labels, labels))
    return right("1 is perfect and 0 is what chance would give, whatever the objects are called")


def _mistake_in_rand(answer: float, true_labels: np.ndarray, labels: np.ndarray) -> str:
    in_true, in_found = (x[:, None] == x for x in (true_labels, labels))
    pair = np.triu(np.ones(in_true.shape, dtype=bool), k=1)
    both, true_pairs, found_pairs, pairs = (
        np.count_nonzero(m & pair) for m in (in_true & in_found, in_true, in_found, pair)
    )
    expected, mean = true_pairs * found_pairs / pairs, (true_pairs + found_pairs) / 2
    # The same with both orders of a pair and with pairs of an observation and itself.
    own = [np.count_nonzero(m) for m in (in_true & in_found, in_true, in_found, np.ones(in_true.shape))]
    own_expected = own[1] * own[2] / own[3]
    mistakes = {
        "this is the Rand index: take off what chance would give": np.count_nonzero((in_true == in_found) & pair)
        / pairs,
        "chance is not taken off: subtract the expected number of pairs above and below": both / mean,
        "chance is taken off above the line only": (both - expected) / mean,
        "below the line stands the mean of the two numbers of pairs, you took the larger": (both - expected)
        / (max(true_pairs, found_pairs) - expected),
        "below the line stands the mean of the two numbers of pairs, you took their sum": (both - expected)
        / (2 * mean - expected),
        "a sighting is no pair with itself": (own[0] - own_expected) / ((own[1] + own[2]) / 2 - own_expected),
        "this is the share of right labels, but names of objects mean nothing: count pairs": np.mean(
            true_labels == labels
        ),
    }
    for message, number in mistakes.items():
        if math.isclose(answer, number, rel_tol=1e-9):
            return message
    return "the number is off: count the pairs that are together in the truth, in the result, and in both"
