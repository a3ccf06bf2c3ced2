"""Checks of lesson 01: what argmax throws away, a front end, counting partitions, and an alarm."""

import math
from collections.abc import Callable

import numpy as np

from npslam_teach.course.checking import BLANK, Verdict, answer_of, array_from, as_array, is_blank, right, wrong


def check_argmax(argmax_and_doubt: Callable) -> Verdict:
    """Exercise 1: ``argmax_and_doubt(posteriors)`` returns the classes (M,) and the discarded probabilities (M,)."""
    rng = np.random.default_rng(0)
    for num_observations, num_classes in ((5, 3), (7, 4), (4, 4)):
        posteriors = rng.dirichlet(np.ones(num_classes), num_observations)
        answer, verdict = answer_of(argmax_and_doubt, posteriors.copy())
        if verdict is None and isinstance(answer, tuple | list) and len(answer) == 2:
            if any(is_blank(each) for each in answer):
                return wrong(BLANK)
            if np.shape(np.asarray(answer[0], dtype=object)) == (num_classes,) != (num_observations,):
                return wrong("you have one class per column: every sighting is a row, look along axis 1")
        if verdict is None:
            answer, verdict = as_array("the pair of classes and doubts", answer, (2, num_observations))
        if verdict is not None:
            return verdict
        message = _argmax_mistake(posteriors, *answer)
        if message:
            return wrong(message)
    return right("the second array is what no later step can know any more")


def _argmax_mistake(posteriors: np.ndarray, classes: np.ndarray, doubt: np.ndarray) -> str | None:
    best, most = posteriors.argmax(axis=1), posteriors.max(axis=1)
    second = np.sort(posteriors, axis=1)[:, -2]
    if np.allclose(classes, most) or np.allclose(doubt, best):
        return "the two are swapped: first the classes, then what is thrown away"
    if np.allclose(classes, best + 1):
        return "classes are counted from 0"
    if np.allclose(classes, posteriors.argmin(axis=1)):
        return "these are the least likely classes"
    if len(classes) == posteriors.shape[1] and np.allclose(classes, posteriors.argmax(axis=0)):
        return "you have one class per column: every sighting is a row, look along axis 1"
    if not np.allclose(classes, best):
        return "the classes are not those of the largest probability in each row"
    if np.allclose(doubt, most):
        return "the second array is what is kept; what is thrown away is the rest"
    if np.allclose(doubt, second):
        return "that is the runner-up alone: all other classes are thrown away too"
    return None if np.allclose(doubt, 1 - most) else "the classes are right, what is thrown away is not"


BROKEN_RULES = {
    "this joins sightings of different classes: a cup is no chair": {"by_class": False},
    "everything joins: a sighting further away than the reach opens a new object": {"reach_counts": False},
    "each sighting is compared with the first of an object only: compare it with every earlier one": {"firsts": True},
    "it joins the first sighting within reach, not the nearest": {"nearest": False},
}


def check_front_end(my_front_end: Callable) -> Verdict:
    """Exercise 2: ``my_front_end(obs_xy_world, obs_class, reach)`` returns a label for each observation, (M,)."""
    answers, trials = [], _clouds()
    for xy, obs_class, reach in trials:
        answer, verdict = array_from("the labels", my_front_end, (len(xy),), xy.copy(), obs_class.copy(), reach)
        if verdict is not None:
            return verdict
        answers.append(_canonical(answer))
    if _same(answers, [join(*trial) for trial in trials]):
        return right("this is a front end: it decides once, and never looks back")
    return wrong(_front_end_mistake(answers, trials))


def _front_end_mistake(answers: list, trials: list) -> str:
    if all(len(set(answer)) == len(answer) for answer in answers):
        return "nothing joins: every sighting has a label of its own"
    for message, rule in BROKEN_RULES.items():
        if _same(answers, [join(*trial, **rule) for trial in trials]):
            return message
    if _same(answers, [_nearest_index(*trial) for trial in trials]):
        return "a sighting takes the object of the one that it joins, not that one's place in the list"
    for answer, trial in zip(answers, trials, strict=True):
        found, wanted = len(set(answer)), len(set(join(*trial)))
        if found != wanted:
            return f"with {len(answer)} sightings you find {found} objects, not {wanted}"
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


def _clouds() -> list:
    """Observations of two classes in chains and clouds, where the rules give different labels."""
    rng = np.random.default_rng(1)
    scenes = [(rng.uniform(0, 3, (25, 2)), rng.integers(0, 2, 25), reach) for reach in (0.3, 0.5, 0.7)]
    chain = np.column_stack([np.arange(6) * 0.4, np.zeros(6)])
    return [*scenes, (chain, np.zeros(6, dtype=int), 0.5)]


def _canonical(labels) -> np.ndarray:
    """Labels renamed in the order in which they appear, so that names do not matter."""
    names = {}
    return np.array([names.setdefault(float(label), len(names)) for label in labels])


def _same(answers: list, others: list) -> bool:
    return all(np.array_equal(a, _canonical(b)) for a, b in zip(answers, others, strict=True))


def check_bell(bell: Callable) -> Verdict:
    """Exercise 3: ``bell(n)``, the number of ways to group n observations."""
    up_to, numbers, answers = range(1, 11), bell_numbers(11), []
    for n in up_to:
        answer, verdict = array_from("your count", bell, (), n)
        if verdict is not None:
            return verdict
        answers.append(float(answer))
    if answers == numbers[1:11]:
        digits = len(str(bell_numbers(1098)[1098]))
        return right(f"for the deck's 1098 sightings the count has {digits} digits, and nobody can try them all")
    for sequence, message in _other_counts(up_to, numbers):
        if answers == sequence:
            return wrong(message)
    n = next(n for n in up_to if answers[n - 1] != numbers[n])
    return wrong(f"{n} sighting{'s' * (n > 1)} can be grouped in another number of ways: draw them")


def _other_counts(up_to: range, numbers: list) -> tuple:
    """Other counts that may be mistaken for that of the groupings, each with a message."""
    one_off = "this is one off: how many ways are there for one sighting, and for two"
    return (
        (numbers[2:12], one_off),
        (numbers[:10], one_off),
        (
            [2 ** (n - 1) for n in up_to],
            "that is where a row can be cut: one object's sightings need not be neighbours",
        ),
        ([2**n for n in up_to], "that counts subsets: one group, and the rest left over"),
        ([math.factorial(n) for n in up_to], "that counts orders: the order within an object does not matter"),
        ([math.comb(2 * n, n) // (n + 1) for n in up_to], "that leaves out groups that cross each other"),
    )


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


WRONG_ALARMS = {
    "it is the wrong way round: it rings when all is well": {"flip": True},
    "every second right result would ring: leave room for chance, three standard deviations of chi2": {"spread": 0},
    "a sighting is two numbers and an object two unknowns": {"numbers": 1, "unknowns": 1},
    "objects have unknowns too: each takes two numbers to place": {"unknowns": 0},
    "2 dof is the variance of chi2, its standard deviation is the root": {"variance": True},
}


def check_alarm(alarm: Callable) -> Verdict:
    """Exercise 4: ``alarm(chi2, num_observations, num_objects)``, True when chi2 is too large to be chance."""
    trials = [(0.4 * j, m, k) for m, k in ((8, 5), (8, 4), (30, 5)) for j in range(1, 400)]
    answers, verdict = _rings(alarm, trials)
    if verdict is not None:
        return verdict
    if answers != [_alarm(*trial) for trial in trials]:
        for message, keys in WRONG_ALARMS.items():
            if answers == [_alarm(*trial, **keys) for trial in trials]:
                return wrong(message)
        if len(set(answers)) == 1:
            return wrong(f"it {'always' if answers[0] else 'never'} rings")
        return wrong("it rings at another chi2 than dof + 3 sqrt(2 dof): check the degrees of freedom first")
    # With an object for every observation nothing is contradictory: chi2 is only a rounding error.
    (rang,), verdict = _rings(alarm, [(1e-9, 8, 8)])
    if rang or verdict is not None:
        return wrong("with an object for every sighting there are 0 degrees of freedom: then it must not ring, or stop")
    return right("it rings for a wrong merger, and stays silent for a wrong split: chi2 cannot count")


def _rings(alarm: Callable, trials: list) -> tuple[list, Verdict | None]:
    """The answers of the student's alarm in every trial; up to its first failure, with a verdict, if there is one."""
    answers = []
    for trial in trials:
        answer, verdict = array_from("the alarm", alarm, (), *trial)
        answers.append(bool(answer))
        if verdict is not None:
            return answers, verdict
    return answers, None


def _alarm(chi2, num_observations, num_objects, numbers=2, unknowns=2, spread=3.0, flip=False, variance=False) -> bool:
    dof = numbers * num_observations - unknowns * num_objects
    width = 2 * dof if variance else math.sqrt(2 * dof)
    return (chi2 > dof + spread * width) != flip
