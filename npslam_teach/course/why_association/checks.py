"""Checks of lesson 01: what argmax throws away, a front end, counting partitions, and an alarm."""

import math
import time
from collections.abc import Callable
from functools import cache, partial
from numbers import Rational

import numpy as np

from npslam_teach.course import drawings
from npslam_teach.course.checking import Verdict, answer_of, as_array, wrong
from npslam_teach.course.comparing import SINGLE, exactly, grouped_alike
from npslam_teach.course.trials import Part, check_function, fresh
from npslam_teach.course.verdict_page import exercise


@exercise("01", 1, of=4)
def check_argmax(argmax_and_doubt: Callable) -> Verdict:
    """Exercise 1: ``argmax_and_doubt(posteriors)`` returns the classes (M,) and the discarded probabilities (M,)."""

    def truth(posteriors):
        return posteriors.argmax(axis=1), 1 - posteriors.max(axis=1)

    by_column = "you have one class per column: every sighting is a row, look along axis 1"
    of_classes = {
        by_column: lambda p: p.argmax(axis=0),
        "the two are swapped: first the classes, then what is thrown away": lambda p: 1 - p.max(axis=1),
        "the first array holds the largest probabilities; the classes are asked for": lambda p: p.max(axis=1),
        "classes are counted from 0": lambda p: p.argmax(axis=1) + 1,
        "these are the least likely classes": lambda p: p.argmin(axis=1),
    }
    of_doubt = {
        "the second array is what is kept; what is thrown away is the rest": lambda p: p.max(axis=1),
        "that is the runner-up alone: all other classes are thrown away too": lambda p: np.sort(p, axis=1)[:, -2],
        by_column: lambda p: 1 - p.max(axis=0),
    }
    rng = fresh()
    trials = [(rng.dirichlet(np.ones(c), m),) for m, c in ((5, 3), (7, 4), (4, 4), (3, 6), (40, 3))]
    edges = {
        "with a single sighting": [(rng.dirichlet(np.ones(4), 1),)],
        "with a single class, which leaves no doubt": [(np.ones((3, 1)),)],
        "with no sighting at all": [(np.empty((0, 3)),)],
    }
    parts = (
        Part("your array of classes", of_classes, exactly, hint="these are not the classes of the largest probability"),
        Part("what is thrown away", of_doubt, hint="the classes are right, what is thrown away is not"),
    )
    praise = "the second array is what no later step can know any more"
    return check_function(argmax_and_doubt, truth, parts, trials, edges, praise)


@exercise("01", 2, of=4)
def check_front_end(my_front_end: Callable) -> Verdict:
    """Exercise 2: ``my_front_end(obs_xy_world, obs_class, reach)`` returns a label for each observation, (M,)."""

    def truth(obs_xy_world, obs_class, reach):
        return join(obs_xy_world, obs_class, reach)

    mistakes = {
        "nothing joins: every sighting has a label of its own": lambda xy, obs_class, reach: np.arange(len(xy)),
        "this joins sightings of different classes: a cup is no chair": partial(join, by_class=False),
        "everything joins: a sighting further away than the reach opens a new object": partial(
            join, reach_counts=False
        ),
        "each sighting is compared with the first of an object only: compare it with every earlier one": partial(
            join, firsts=True
        ),
        "it joins the first sighting within reach, not the nearest": partial(join, nearest=False),
        "a sighting takes the object of the one that it joins, not that one's place in the list": _nearest_index,
    }
    rng = fresh()
    trials = [(rng.uniform(0, 3, (25, 2)), rng.integers(0, 2, 25), reach) for reach in (0.3, 0.5, 0.7, 0.4, 0.6)]
    trials.append((np.column_stack([np.arange(6) * 0.4, np.zeros(6)]), np.zeros(6, dtype=int), 0.5))
    second_is_nearer = np.array([[0.0, 0.0], [0.8, 0.0], [0.45, 0.0]])
    trials.append((second_is_nearer, np.zeros(3, dtype=int), 0.5))
    edges = {
        "with no sighting at all": [(np.empty((0, 2)), np.empty(0, dtype=int), 0.5)],
        "with a single sighting": [(rng.uniform(0, 3, (1, 2)), np.array([2]), 0.5)],
        "with two objects within reach, of which one is nearer": [
            (np.array([[0.0, 0.0], [0.8, 0.0], [x, 0.0]]), np.zeros(3, dtype=int), 0.5) for x in (0.45, 0.35)
        ],
        "with a sighting at the reach exactly, which is not nearer": [
            (np.array([[0.0, 0.0], [0.5, 0.0]]), np.zeros(2, dtype=int), 0.5)
        ],
        "with two classes at one place": [(np.zeros((4, 2)), np.array([0, 1, 1, 0]), 0.5)],
    }
    part = Part("your labels", mistakes, grouped_alike, hint=_counted)
    praise = "this is a front end: it decides once, and never looks back"
    return check_function(my_front_end, truth, part, trials, edges, praise, drawings.front_end())


def _counted(answers: list, expected: list) -> str:
    for answer, wanted in zip(answers, expected, strict=True):
        found, right_number = len(set(answer.tolist())), len(set(wanted.tolist()))
        if found != right_number:
            return f"with {len(answer)} sightings you find {found} objects, not {right_number}"
    return "the number of objects is right, but they hold other sightings"


def join(xy, obs_class, reach, by_class=True, reach_counts=True, firsts=False, nearest=True) -> list:
    """The front end of the exercise; each of the last four arguments can break one of its rules."""
    labels, first = [], []
    for k in range(len(xy)):
        candidates = [j for j in (first if firsts else range(k)) if not by_class or obs_class[j] == obs_class[k]]
        distance = np.array([math.dist(xy[j], xy[k]) for j in candidates])
        within = np.flatnonzero(distance < (reach if reach_counts else np.inf))
        if len(within):
            labels.append(labels[candidates[within[np.argmin(distance[within])] if nearest else within[0]]])
        else:
            labels.append(len(first))
            first.append(k)
    return labels


def _nearest_index(xy, obs_class, reach) -> list:
    labels = []
    for k in range(len(xy)):
        distance = np.where(obs_class[:k] == obs_class[k], np.linalg.norm(xy[:k] - xy[k], axis=1), np.inf)
        labels.append(int(np.argmin(distance)) if len(distance) and distance.min() < reach else k)
    return labels


@exercise("01", 3, of=4)
def check_bell(bell: Callable) -> Verdict:
    """Exercise 3: ``bell(n)``, the number of ways to group n observations."""

    def truth(n):
        return bell_numbers(n)[n]

    one_off = "this is one off: how many ways are there for one sighting, and for two"
    mistakes = {
        one_off: lambda n: truth(n + 1),
        f"{one_off}, and for three": lambda n: truth(n - 1),
        "that is where a row can be cut: one object's sightings need not be neighbours": lambda n: 2 ** (n - 1),
        "that counts subsets: one group, and the rest left over": lambda n: 2**n,
        "that counts orders: the order within an object does not matter": math.factorial,
        "that leaves out groups that cross each other": lambda n: math.comb(2 * n, n) // (n + 1),
    }
    trials = [(int(n),) for n in fresh().permutation(np.arange(1, 12))]
    praise = f"for the deck's 1098 sightings the count has {_digits(1098)} digits, and nobody can try them all"
    part = Part("your count", mistakes, hint="that many sightings can be grouped in another number of ways: draw them")
    edges = {"with no sighting at all, for which there is one way, that without a group": [(0,)]}
    verdict = check_function(bell, truth, part, trials, edges, praise)
    return (_large_counts(bell) if verdict.passed else None) or verdict


def _large_counts(bell: Callable) -> Verdict | None:
    """None if larger counts are right too, up to what a plain recursion, whose time doubles with n, can reach."""
    numbers = bell_numbers(60)
    for n in (13, 15, 20, int(fresh().integers(26, 40)), 60):
        begun = time.thread_time()
        answer, verdict = answer_of(bell, n)
        if verdict is not None:
            return verdict
        value, verdict = as_array(f"bell({n})", answer, ())
        if verdict is not None:
            return verdict
        if not _same_count(answer, value, numbers[n]):
            return wrong(_count_difference(n, answer, numbers[n]))
        if time.thread_time() - begun > 0.02:
            return None
    return None


def _same_count(answer, value: np.ndarray, number: int) -> bool:
    """Whether a count is right: whole numbers and fractions to the last digit, others to their precision."""
    plain = answer.item() if isinstance(answer, np.ndarray) else answer
    if isinstance(plain, Rational):
        return plain == number
    single = np.asarray(answer).dtype in (np.float32, np.float16)
    return math.isclose(float(value), number, rel_tol=SINGLE if single else 1e-9)


def _count_difference(n: int, answer, number: int) -> str:
    if np.asarray(answer).dtype.kind in "iu" and (int(answer) - number) % 2**64 == 0:
        return f"bell({n}) is {number}, more than NumPy's 64 bits hold: count with Python's own integers"
    return f"bell({n}) should be {number} and is {answer}"


@cache
def _digits(n: int) -> int:
    return len(str(bell_numbers(n)[n]))


def bell_numbers(highest: int) -> list[int]:
    """B(0) to B(highest), exactly, by the triangle: a row begins with the end of the one before it."""
    row, numbers = [1], [1]
    for _ in range(highest):
        below = [row[-1]]
        for value in row:
            below.append(below[-1] + value)
        numbers.append(below[0])
        row = below
    return numbers


@exercise("01", 4, of=4)
def check_alarm(alarm: Callable) -> Verdict:
    """Exercise 4: ``alarm(chi2, num_observations, num_objects)``, True when chi2 is too large to be chance."""

    def truth(chi2, num_observations, num_objects):
        return _alarm(chi2, num_observations, num_objects)

    mistakes = {
        "it always rings": lambda *trial: True,
        "it never rings": lambda *trial: False,
        "it is the wrong way round: it rings when all is well": partial(_alarm, flip=True),
        "every second right result would ring: leave room for chance, three standard deviations of chi2": partial(
            _alarm, spread=0
        ),
        "a sighting is two numbers and an object two unknowns": partial(_alarm, numbers=1, unknowns=1),
        "objects have unknowns too: each takes two numbers to place": partial(_alarm, unknowns=0),
        "2 dof is the variance of chi2, its standard deviation is the root": partial(_alarm, variance=True),
    }
    rng = fresh()
    sizes = [(8, 5), (8, 4), (30, 5), *((int(m), int(rng.integers(1, m))) for m in rng.integers(5, 1200, 3))]
    trials = [(float(c), m, k) for m, k in sizes for c in rng.uniform(0, 8 * m + 20, 120)]
    edges = {
        "with an object for every sighting there are 0 degrees of freedom, then it must not ring, or stop": [
            (1e-9, 8, 8),
            (0.0, 1, 1),
        ],
        "with chi2 of 20 at 8 degrees of freedom, three standard deviations above exactly and not more": [(20.0, 8, 4)],
        "with chi2 just below and just above its bound, 16.39 at 6 degrees of freedom": [
            (chi2, 8, 5) for chi2 in (16.05, 16.35, 16.39, 16.4, 16.45, 16.95)
        ],
    }
    hint = "it rings at another chi2 than dof + 3 sqrt(2 dof): check the degrees of freedom first"
    praise = "it rings for a wrong merger, and stays silent for a wrong split: chi2 cannot count"
    return check_function(alarm, truth, Part("the alarm", mistakes, exactly, hint=hint), trials, edges, praise)


def _alarm(chi2, num_observations, num_objects, numbers=2, unknowns=2, spread=3.0, flip=False, variance=False) -> bool:
    dof = numbers * num_observations - unknowns * num_objects
    width = 2 * dof if variance else math.sqrt(2 * dof)
    return dof > 0 and (chi2 > dof + spread * width) != flip
