"""The checks of lesson 07: chi2 per degree of freedom, the error of a path, and the adjusted Rand index."""

from collections.abc import Callable

import numpy as np

from npslam_teach import se2
from npslam_teach.course import drawings
from npslam_teach.course.checking import Verdict
from npslam_teach.course.comparing import close
from npslam_teach.course.trials import Part, check_function, fresh
from npslam_teach.course.verdict_page import exercise
from npslam_teach.evaluation import compare_partitions


@exercise("07", 1, of=3)
def check_per_dof(student: Callable) -> Verdict:
    """Exercise 1: ``student(chi2, num_poses, num_observations, num_objects)`` is chi2 per degree of freedom."""

    def truth(chi2, num_poses, num_observations, num_objects):
        return chi2 / (2 * num_observations - 2 * num_objects)

    # By message the degrees of freedom that the mistake counts, from the numbers of poses, sightings and objects.
    counts = {
        "pose 0 is held still: it is the gauge, not an unknown": lambda t, m, k: 2 * m - 2 * k - 3,
        "there is one step less than there are poses": lambda t, m, k: 2 * m - 2 * k + 3,
        "the unknowns are not taken off: what is left over is measured minus unknown": lambda t, m, k: (
            3 * (t - 1) + 2 * m
        ),
        "the objects are not taken off: each has two unknown coordinates": lambda t, m, k: 2 * m,
        "a sighting measures two numbers": lambda t, m, k: m - 2 * k,
        "an object has two unknown coordinates": lambda t, m, k: 2 * m - 3 * k,
        "an object has two unknown coordinates, not one": lambda t, m, k: 2 * m - k,
        "sightings and objects were counted, their coordinates are wanted": lambda t, m, k: m - k,
        "a pose has three unknowns, a step three measured numbers": lambda t, m, k: 2 * m - 2 * k + t - 1,
        "chi2 is the whole sum here, not half of it": lambda t, m, k: 2 * (2 * m - 2 * k),
    }
    mistakes = {message: lambda c, *sizes, dof=dof: c / dof(*sizes) for message, dof in counts.items()}
    rng, trials = fresh(), []
    for _ in range(12):
        objects = int(rng.integers(1, 30))
        seen = int(rng.integers(2 * objects + 3, 1500))
        trials.append((float(rng.uniform(10, 3000)), int(rng.integers(5, 900)), seen, objects))
    edges = {
        "with a chi2 of zero": [(0.0, 5, 20, 4)],
        "with a single pose, which no step leads to": [(7.0, 1, 9, 3)],
        "with a single degree too many for an object each": [(3.0, 10, 5, 4)],
    }
    hint = "count the measured numbers of all steps and sightings, and take off the unknown ones"
    praise = "near 1 when the model and the data agree"
    return check_function(student, truth, Part("the answer", mistakes, hint=hint), trials, edges, praise)


@exercise("07", 2, of=3)
def check_mean_pose_error(student: Callable) -> Verdict:
    """Exercise 2: ``student(poses, true_poses)`` is the mean distance after the best rigid alignment."""

    def errors(poses, true_poses):
        motion = se2.align(poses[:, :2], true_poses[:, :2])
        return np.linalg.norm(se2.apply(motion, poses[:, :2]) - true_poses[:, :2], axis=1)

    def truth(poses, true_poses):
        return errors(poses, true_poses).mean()

    mistakes = {
        "the path was not laid over the truth before measuring": lambda p, t: _apart(p[:, :2], t[:, :2]),
        "the path was only shifted onto the truth: it must be turned too": lambda p, t: _apart(
            p[:, :2] - p[:, :2].mean(axis=0) + t[:, :2].mean(axis=0), t[:, :2]
        ),
        "the motion was applied the wrong way round": lambda p, t: _apart(
            se2.apply(se2.inverse(se2.align(p[:, :2], t[:, :2])), p[:, :2]), t[:, :2]
        ),
        "only the first poses were laid on each other: use the motion that fits the whole path best": lambda p, t: (
            _apart(se2.apply(se2.compose(t[0], se2.inverse(p[0])), p[:, :2]), t[:, :2])
        ),
        "a motion turns and shifts, and your fit may mirror the path too": lambda p, t: _fitted(p, t, mirror=True),
        "a motion turns and shifts, and your fit stretches the path too": lambda p, t: _fitted(p, t, stretch=True),
        "this is the root of the mean square, asked for is the mean": lambda p, t: np.sqrt((errors(p, t) ** 2).mean()),
        "these are squared metres: take the root of each": lambda p, t: (errors(p, t) ** 2).mean(),
        "the errors are added up: divide by the number of poses": lambda p, t: errors(p, t).sum(),
        "this is the median, asked for is the mean": lambda p, t: np.median(errors(p, t)),
        "this is the largest error, asked for is the mean": lambda p, t: errors(p, t).max(),
    }
    rng, trials = fresh(), []
    for count in (60, 40, 80, 25, 60):
        true_poses = np.cumsum(rng.normal(0, 0.4, (count, 3)), axis=0)
        motion = np.array([rng.uniform(2, 5), rng.uniform(-5, -2), rng.uniform(0.5, 2.5)])
        poses = se2.compose(motion, true_poses)
        poses[:, :2] += np.cumsum(rng.normal(0, 0.1, (count, 2)), axis=0)
        trials.append((poses, true_poses))
    mirrored = trials[1][0] * [1, -1, -1]
    trials.append((mirrored, trials[1][1]))
    edges = {"with two poses that are too far apart": [(np.array([[0.0, 0, 0], [3, 0, 0]]), np.eye(3)[:2])]}
    hint = "the number is off: align the x and y of the path, carry it over, and average the distances"
    praise = "a map may lie anywhere; only its shape is judged"
    return check_function(student, truth, Part("the error", mistakes, hint=hint), trials, edges, praise)


def _apart(xy: np.ndarray, other_xy: np.ndarray) -> float:
    return float(np.linalg.norm(xy - other_xy, axis=1).mean())


def _fitted(poses: np.ndarray, truth: np.ndarray, mirror: bool = False, stretch: bool = False) -> float:
    """The mean error after a fit that has too much freedom."""
    xy, true_xy = (each[:, :2] - each[:, :2].mean(axis=0) for each in (poses, truth))
    left, sizes, right = np.linalg.svd(xy.T @ true_xy)
    keep = np.array([1.0, 1.0 if mirror else np.sign(np.linalg.det(left @ right))])
    scale = (sizes * keep).sum() / (xy**2).sum() if stretch else 1.0
    return _apart(scale * xy @ (left * keep) @ right, true_xy)


@exercise("07", 3, of=3)
def check_adjusted_rand(student: Callable) -> Verdict:
    """Exercise 3: ``student(true_labels, labels)`` is the adjusted Rand index, by counting pairs."""

    def truth(true_labels, labels):
        return compare_partitions(true_labels, labels)[0]

    def index(t, x, below=lambda a, b, mean: mean, chance_above=True, chance_below=True, own=False):
        a, b, n, pairs = _pairs(t, x, own)
        chance = a * b / pairs
        return (n - chance_above * chance) / (below(a, b, (a + b) / 2) - chance_below * chance)

    mistakes = {
        "this is the Rand index: take off what chance would give": lambda t, x: (
            1 - (_pairs(t, x)[0] + _pairs(t, x)[1] - 2 * _pairs(t, x)[2]) / _pairs(t, x)[3]
        ),
        "chance is not taken off: subtract the expected number of pairs above and below": lambda t, x: index(
            t, x, chance_above=False, chance_below=False
        ),
        "chance is taken off above the line only": lambda t, x: index(t, x, chance_below=False),
        "below the line stands the mean of the two numbers of pairs, you took the larger": lambda t, x: index(
            t, x, below=lambda a, b, mean: max(a, b)
        ),
        "below the line stands the mean of the two numbers of pairs, you took their sum": lambda t, x: index(
            t, x, below=lambda a, b, mean: a + b
        ),
        "a sighting is no pair with itself": lambda t, x: index(t, x, own=True),
        "this is the share of right labels, but names of objects mean nothing: count pairs": lambda t, x: np.mean(
            t == x
        ),
        "worse than chance is below zero, and must not be cut off there": lambda t, x: max(0.0, truth(t, x)),
    }
    hint = "the number is off: count the pairs that are together in the truth, in the result, and in both"
    praise = "1 is perfect and 0 is what chance would give, whatever the objects are called"
    return check_function(
        student,
        truth,
        Part("the index", mistakes, _as_index, hint=hint),
        *_adjusted_rand_inputs(),
        praise,
        drawings.adjusted_rand(),
    )


def _adjusted_rand_inputs() -> tuple[list, dict]:
    """Arguments of ``check_adjusted_rand``: its trials, and its edges by the situation."""
    rng, trials = fresh(), []
    for count in (40, 25, 60, 40):
        true_labels = rng.integers(0, 4, count)
        trials.append((true_labels, np.where(rng.random(count) < 0.6, true_labels, rng.integers(0, 6, count))))
    rows = np.arange(12) // 4  # each group of the one meets each group of the other once: less than by chance
    trials.append((rows, np.arange(12) % 4))
    left_out = np.where(rng.random(40) < 0.3, -1, trials[0][1])
    edges = {
        "with labels of -1, a group like any other here": [(trials[0][0], left_out), (left_out, trials[0][0])],
        "with the same groups under other names": [(rows, 7 - rows)],
        "with large numbers for names": [(rows * 1000, np.arange(12) % 4 * 10**6)],
        "with everything in one group, twice, which agree: 1": [(np.zeros(6, dtype=int), np.ones(6, dtype=int))],
        "with no two sightings together, twice, which agree: 1": [(np.arange(6), np.arange(6)[::-1].copy())],
        "with a single sighting, about which nothing can differ: 1": [(np.array([2]), np.array([0]))],
        "with one group against several, which is what chance would give: 0": [(rows, np.zeros(12, dtype=int))],
        "with hundreds of sightings": [(rng.integers(0, 5, 600), rng.integers(0, 5, 600))],
    }
    return trials, edges


def _as_index(answer: np.ndarray, truth, tolerance: float) -> bool:
    """An index near zero is a small difference of large counts, and good to the precision of 1."""
    return close(answer, truth, tolerance) or (answer.shape == () and abs(float(answer) - truth) < tolerance / 10)


def _pairs(true_labels: np.ndarray, labels: np.ndarray, own: bool = False) -> tuple:
    """Pairs together in the truth, in the result, in both, and all; with both orders and pairs with itself, or once."""
    in_true, in_found = (x[:, None] == x for x in (true_labels, labels))
    pair = np.ones(in_true.shape, dtype=bool) if own else np.triu(np.ones(in_true.shape, dtype=bool), k=1)
    return tuple(np.count_nonzero(each & pair) for each in (in_true, in_found, in_true & in_found, pair))
