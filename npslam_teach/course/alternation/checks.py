"""The checks of lesson 06: the objective, votes without one's own, one alternation, and false positives."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from npslam_teach import association, se2
from npslam_teach.course import drawings
from npslam_teach.course.alternation.check_inputs import one_alternation_inputs
from npslam_teach.course.checking import Verdict, as_array, wrong
from npslam_teach.course.comparing import exactly, grouped_alike
from npslam_teach.course.trials import Part, check_function, fresh
from npslam_teach.course.verdict_page import exercise
from npslam_teach.pose_graph import chi2, optimize, with_associations
from npslam_teach.types import PoseGraph, RobotLog


@exercise("06", 1, of=4)
def check_objective(student: Callable) -> Verdict:
    """Exercise 1: ``student(chi2, votes, alpha, area)`` is the number that both half-steps bring down."""

    def truth(chi2, votes, alpha, area):
        return association.objective(chi2, votes, alpha, area)

    def variant(c, votes, alpha, area, half=0.5, seats=1.0, opens=1.0, crowd=math.lgamma, each=True, column=1):
        counts = votes[:, column:] if each else votes[:, 1:].sum(axis=1)
        opened = -len(votes) * math.log(alpha / area)
        return half * c + opens * opened - seats * sum(crowd(m) for m in counts[counts > 0].tolist())

    wrongly = {
        "chi2 is not halved: a normal density has exp(-chi2 / 2)": {"half": 1.0},
        "the false-positive votes in column 0 are a constant, leave them out": {"column": 0},
        "log Gamma(m) is log (m - 1)!, you counted log m!": {"crowd": lambda m: math.lgamma(m + 1)},
        "log Gamma(m) is the logarithm of (m - 1)!, not of m": {"crowd": math.log},
        "many votes in one object should make the number smaller: look at the sign of the log Gamma term": {
            "seats": -1.0
        },
        "a new object should cost something when alpha is small: look at the sign of the alpha term": {"opens": -1.0},
        "the votes of one object for different classes were added up first": {"each": False},
    }
    mistakes = {text: lambda *t, keys=keys: variant(*t, **keys) for text, keys in wrongly.items()}
    mistakes |= {
        "the area is missing: a new object may stand anywhere in it": lambda c, v, alpha, area: variant(
            c, v, alpha, 1.0
        ),
        "alpha is paid once for every object, you paid it once in all": lambda c, v, alpha, area: variant(
            c, v, alpha, area, opens=1 / len(v)
        ),
        "the sign is turned round: the objective is minus the log probability": lambda *t: -truth(*t),
    }
    hint = "the number differs from minus the log probability; check the three terms one at a time"
    praise = "this is the number that falls, whichever half-step is taken"
    return check_function(student, truth, Part("the objective", mistakes, hint=hint), *_objective_inputs(), praise)


def _objective_inputs() -> tuple[list, dict]:
    """Arguments of ``check_objective``: its trials, and its edges by the situation."""
    rng, trials = fresh(), []
    for rows, columns in ((4, 4), (3, 5), (6, 3), (2, 4), (4, 4)):
        votes = rng.integers(0, 6, (rows, columns)).astype(float)
        # Votes other than 1 in column 0 reveal whether it is counted; a class without votes reveals whether zeros are.
        votes[:, 0], votes[:, 1], votes[0, 2] = rng.integers(2, 5, rows), rng.integers(3, 7, rows), 0
        trials.append((float(rng.uniform(1, 50)), votes, float(rng.uniform(0.2, 0.9)), float(rng.uniform(2, 90))))
    many = np.column_stack([np.ones(3), rng.integers(200, 5000, (3, 2))]).astype(float)
    edges = {
        "with no object": [(3.0, np.empty((0, 3)), 0.5, 20.0)],
        "with one object, seen once": [(2.0, np.array([[1.0, 1.0, 0.0]]), 0.5, 20.0)],
        "with an alpha above 1": [(2.0, votes, 1.7, 20.0)],
        "with an alpha above the area, where a new object costs nothing": [(2.0, votes, 1.7, 0.8)],
        "with hundreds of votes or more, where (m - 1)! is too large a number": [(9.0, many, 0.5, 20.0)],
    }
    return trials, edges


@exercise("06", 2, of=4)
def check_votes_of_others(student: Callable) -> Verdict:
    """Exercise 2: ``student(k, labels, obs_class, num_objects)`` counts the votes that observation k is judged by."""

    def truth(k, labels, obs_class, num_objects):
        return with_own(k, labels, obs_class, num_objects) - own(k, labels, num_objects)

    def own(k, labels, num_objects):
        return np.eye(num_objects)[labels[k]]

    def with_own(k, labels, obs_class, num_objects):
        return np.bincount(labels[obs_class == obs_class[k]], minlength=num_objects)

    def any_class(k, labels, obs_class, num_objects):
        return np.bincount(labels, minlength=num_objects)

    mistakes = {
        "sighting k has voted for its own object: nothing would ever move": with_own,
        "votes for every class are counted, sighting k asks only about its own class": lambda k, x, c, n: (
            any_class(k, x, c, n) - own(k, x, n)
        ),
        "votes for every class are counted, that of sighting k itself among them": any_class,
        "all votes of its own object are gone: take back the one of sighting k only": lambda k, x, c, n: np.where(
            own(k, x, n), 0, truth(k, x, c, n)
        ),
        "one vote is taken from every object: only its own object loses one": lambda *t: with_own(*t) - 1,
    }
    rng = fresh()
    trials = [
        (int(rng.integers(m)), rng.integers(0, n, m), rng.integers(0, 2, m), n)
        for m, n in ((30, 4), (20, 3), (30, 5), (12, 2)) * 5
    ]
    k, labels, obs_class, num_objects = trials[0]
    edges = {
        "with objects at the end that nobody has seen": [(k, labels, obs_class, num_objects + 3)],
        "with a single sighting, which has no others": [(0, np.zeros(1, dtype=int), np.zeros(1, dtype=int), 1)],
        "with a class that nobody else has": [(3, np.zeros(6, dtype=int), np.array([0, 0, 0, 2, 0, 0]), 2)],
        "for the last sighting": [(len(labels) - 1, labels, obs_class, num_objects)],
    }
    part = Part("the votes", mistakes, exactly, hint="count, for each object, the other sightings of the class of k")
    praise = "a sighting is judged by the others, and can move"
    return check_function(student, truth, part, trials, edges, praise)


@exercise("06", 3, of=4)
def check_one_alternation(student: Callable) -> Verdict:
    """Exercise 3: ``student(log, graph, labels, alpha, observation_std)`` does one round: labels and graph."""

    def truth(log, graph, labels, alpha, observation_std):
        found, tied = _half(log, graph, labels, alpha, observation_std)
        return found, _numbers(optimize(tied))

    along_wheels = "the sightings are carried into the room along the wheels' path, not along the present one"
    of_labels = {
        "no label has changed: ask every sighting with the map held still, and keep the answer": lambda *t: t[2],
        along_wheels: lambda log, graph, *t: _half(log, _along_wheels(log, graph), *t)[0],
        "the objects stand where the graph has them, not at the means of their sightings: use graph.landmarks": (
            lambda log, graph, x, *t: _half(log, _at_means(log, graph, x), x, *t)[0]
        ),
        "the labels of the beginning are not used: begin with every sighting in its object": lambda log, graph, x, *t: (
            _half(log, graph, np.arange(len(x)), *t)[0]
        ),
    }
    of_graph = {
        "the labels are new, but the graph is the old one: tie the sightings to their objects, then solve": (
            lambda log, graph, *t: _numbers(graph)
        ),
        "the sightings are tied to their new objects, but the second half is missing: solve": lambda *t: _numbers(
            _half(*t)[1]
        ),
    }
    trials, edges = one_alternation_inputs()
    hints = (
        "the labels differ: carry every sighting into the room along graph.poses, and sweep once",
        "the labels are right, the graph is not: solve once, from the present poses, with observation_std",
    )
    parts = (
        Part("the labels", of_labels, grouped_alike, hint=hints[0]),
        Part("the graph", of_graph, _solved_alike, hint=hints[1], read=_read_graph),
    )
    praise = "repeat it until no label changes, and you have the whole method"
    return check_function(student, truth, parts, trials, edges, praise, drawings.one_alternation())


def _half(log, graph, labels, alpha, observation_std) -> tuple[np.ndarray, PoseGraph]:
    """New labels (M,), and the graph that is tied by them and not yet solved."""
    seen_at = se2.apply(graph.poses[log.obs_time], log.obs_xy)
    found = association.sweep(labels, graph.landmarks, seen_at, log.obs_class, alpha)
    return found.labels, with_associations(log, graph, found.labels, found.landmarks, observation_std)


def _along_wheels(log: RobotLog, graph: PoseGraph) -> PoseGraph:
    return replace(graph, poses=se2.dead_reckoning(log.odometry))


def _at_means(log: RobotLog, graph: PoseGraph, labels: np.ndarray) -> PoseGraph:
    seen_at = se2.apply(graph.poses[log.obs_time], log.obs_xy)
    return replace(graph, landmarks=np.array([seen_at[labels == i].mean(axis=0) for i in range(labels.max() + 1)]))


def _numbers(graph: PoseGraph) -> np.ndarray:
    """What identifies a solution, whatever its objects are called: its chi2, and its poses."""
    return np.append(chi2(graph), graph.poses)


def _solved_alike(answer: np.ndarray, truth, tolerance: float) -> bool:
    """Whether two solutions are one: a heading of pi is one of -pi, whichever sign rounding has given it."""
    if answer.shape != np.shape(truth):
        return False
    off = answer - truth
    off[3::3] = se2.wrap(off[3::3])
    return bool((np.abs(off) <= 1e-5 * (1 + np.abs(truth))).all())


def _read_graph(name: str, answer, shape: tuple):
    try:
        numbers = _numbers(answer)
    except Exception:  # whatever an object of any other kind does when it is asked for poses
        return None, wrong(f"{name}, the second thing, should be a graph, yours is {type(answer).__name__}")
    return as_array(name, numbers, shape)


@exercise("06", 4, of=4)
def check_kept(student: Callable) -> Verdict:
    """Exercise 4: ``student(votes, epsilon)`` says which objects stay."""

    def truth(votes, epsilon):
        return votes[:, 0] / votes.sum(axis=1) <= epsilon

    mistakes = {
        "these are the objects that go, asked for are those that stay": lambda v, e: v[:, 0] / v.sum(axis=1) > e,
        "an object exactly at epsilon stays: only above it does it go": lambda v, e: v[:, 0] / v.sum(axis=1) < e,
        "the vote against is compared with the other votes, not with all votes": lambda v, e: (
            v[:, 0] / v[:, 1:].sum(axis=1) <= e
        ),
        "the vote against is not yet a probability: divide by the votes of the object": lambda v, e: v[:, 0] <= e,
        "every object stays, whatever its votes": lambda v, e: np.ones(len(v)),
        "you divided by the votes of all objects, not by those of each": lambda v, e: v[:, 0] / v.sum() <= e,
        "column 0 holds the votes against the object, you looked at column 1": lambda v, e: (
            v[:, 1] / v.sum(axis=1) <= e
        ),
    }
    rng, trials = fresh(), []
    # Each object has one vote against it, as the lesson says. At powers of two it can be exactly at epsilon.
    for epsilon in (0.5, 0.4, 0.3, 0.25, 0.125, 0.01, *rng.uniform(0.05, 0.6, 15)):
        votes = rng.integers(0, 4, (8, 4)).astype(float)
        votes[:, 0], votes[:, 1], votes[:3, 1:] = 1.0, 1.0 + votes[:, 1], [[1, 0, 0], [0, 2, 1], [3, 0, 4]]
        trials.append((votes, float(epsilon)))
    edges = {
        "with an object that nobody has seen": [(np.array([[1.0, 0.0, 0.0], [1.0, 4.0, 0.0]]), 0.4)],
        "with no object": [(np.empty((0, 3)), 0.4)],
        "with thousands of votes": [(np.array([[1.0, 4000.0, 0.0], [1.0, 1.0, 1.0]]), 0.01)],
    }
    part = Part("the answer", mistakes, exactly, hint="compare column 0 of each object's class posterior with epsilon")
    praise = "each object has one vote against it from the start; the others must outweigh it"
    return check_function(student, truth, part, trials, edges, praise)
