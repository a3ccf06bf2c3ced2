"""The checks of lesson 06: the objective, votes without one's own, one alternation, and false positives."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from npslam_teach import se2, simulate
from npslam_teach.association import PAPER_KERNEL_STD, objective, sweep
from npslam_teach.course.checking import Verdict, answer_of, array_from, as_array, right, wrong
from npslam_teach.methods.snapshots import PAPER_ODOMETRY_STD, initial_snapshot
from npslam_teach.pose_graph import chi2, optimize, with_associations
from npslam_teach.types import PoseGraph, RobotLog

ALPHA = 0.5
STD = (PAPER_KERNEL_STD, PAPER_KERNEL_STD)


def check_objective(student: Callable) -> Verdict:
    """Exercise 1: ``student(chi2, votes, alpha, area)`` is the number that both half-steps bring down."""
    rng = np.random.default_rng(6)
    for _ in range(5):
        value, votes = float(rng.uniform(1, 50)), rng.integers(0, 6, (4, 4)).astype(float)
        # Votes other than 1 in column 0 reveal whether it is counted; a class without votes reveals whether zeros are.
        votes[:, 0], votes[:, 1], votes[0, 2] = rng.integers(2, 5, 4), rng.integers(3, 7, 4), 0
        arguments = (value, votes, float(rng.uniform(0.2, 0.9)), float(rng.uniform(2, 90)))
        number, verdict = array_from("the objective", student, (), arguments[0], votes.copy(), *arguments[2:])
        if verdict is not None:
            return verdict
        if not math.isclose(number, objective(*arguments), rel_tol=1e-9, abs_tol=1e-9):
            return wrong(_mistake_in_objective(float(number), *arguments))
    return right("this is the number that falls, whichever half-step is taken")


def _mistake_in_objective(answer: float, value: float, votes: np.ndarray, alpha: float, area: float) -> str:
    counts = votes[:, 1:][votes[:, 1:] > 0]
    seated = sum(math.lgamma(m) for m in counts)
    opened = -len(votes) * math.log(alpha / area)
    mistakes = {
        "chi2 is not halved: a normal density has exp(-chi2 / 2)": value + opened - seated,
        "the false-positive votes in column 0 are a constant, leave them out": value / 2
        + opened
        - seated
        - sum(math.lgamma(m) for m in votes[:, 0]),
        "log Gamma(m) is log (m - 1)!, you counted log m!": value / 2
        + opened
        - sum(math.lgamma(m + 1) for m in counts),
        "log Gamma(m) is the logarithm of (m - 1)!, not of m": value / 2 + opened - sum(map(math.log, counts)),
        "many votes in one object should make the number smaller: look at the sign of the log Gamma term": value / 2
        + opened
        + seated,
        "a new object should cost something when alpha is small: look at the sign of the alpha term": value / 2
        - opened
        - seated,
        "the area is missing: a new object may stand anywhere in it": value / 2 - len(votes) * math.log(alpha) - seated,
        "alpha is paid once for every object, you paid it once in all": value / 2 - math.log(alpha / area) - seated,
        "the votes of one object for different classes were added up first": value / 2
        + opened
        - sum(math.lgamma(m) for m in votes[:, 1:].sum(axis=1)),
    }
    for message, number in mistakes.items():
        if math.isclose(answer, number, rel_tol=1e-9, abs_tol=1e-9):
            return message
    if math.isclose(answer, -objective(value, votes, alpha, area), rel_tol=1e-9, abs_tol=1e-9):
        return "the sign is turned round: the objective is minus the log probability"
    return "the number differs from minus the log probability; check the three terms one at a time"


def check_votes_of_others(student: Callable) -> Verdict:
    """Exercise 2: ``student(k, labels, obs_class, num_objects)`` counts the votes that observation k is judged by."""
    rng = np.random.default_rng(5)
    for _ in range(20):
        num_objects = 4
        labels, obs_class, k = rng.integers(0, num_objects, 30), rng.integers(0, 2, 30), int(rng.integers(30))
        votes, verdict = array_from(
            "the votes", student, (num_objects,), k, labels.copy(), obs_class.copy(), num_objects
        )
        if verdict is not None:
            return verdict
        alike = obs_class == obs_class[k]
        with_own = np.bincount(labels[alike], minlength=num_objects)
        expected = with_own - np.eye(num_objects, dtype=int)[labels[k]]
        if not np.array_equal(votes, expected):
            return wrong(_mistake_in_votes(votes, k, labels, expected, with_own))
    return right("a sighting is judged by the others, and can move")


def _mistake_in_votes(votes, k, labels, expected, with_own) -> str:
    any_class = np.bincount(labels, minlength=len(votes))
    own = np.eye(len(votes), dtype=int)[labels[k]]
    mistakes = [
        ("sighting k has voted for its own object: nothing would ever move", with_own),
        ("votes for every class are counted, sighting k asks only about its own class", any_class - own),
        ("votes for every class are counted, that of sighting k itself among them", any_class),
        ("all votes of its own object are gone: take back the one of sighting k only", np.where(own, 0, expected)),
        ("one vote is taken from every object: only its own object loses one", with_own - 1),
    ]
    for message, count in mistakes:
        if np.array_equal(votes, count):
            return message
    return "the numbers of votes are off: count, for each object, the other sightings of the class of k"


def check_one_alternation(student: Callable) -> Verdict:
    """Exercise 3: ``student(log, graph, labels, alpha, observation_std)`` does one round: labels and graph."""
    for seed in range(3):
        log, better_poses = _shaken_toy(seed)
        first = initial_snapshot(log, PAPER_ODOMETRY_STD, STD, ALPHA)
        # Later the path is no longer that of the odometry: wrong answers may differ from right ones only there.
        seen_at = se2.apply(better_poses[log.obs_time], log.obs_xy)
        later = replace(first.graph, poses=better_poses, landmarks=seen_at)
        for graph in (first.graph, later):
            verdict = _check_round(student, log, graph, first.labels)
            if verdict is not None:
                return verdict
    return right("repeat it until no label changes, and you have the whole method")


def _check_round(student: Callable, log: RobotLog, graph: PoseGraph, labels: np.ndarray) -> Verdict | None:
    """None if the student's round gives what the library's gives."""
    answer, verdict = answer_of(student, log, graph, labels.copy(), ALPHA, STD)
    if verdict is not None:
        return verdict
    if not (isinstance(answer, tuple | list) and len(answer) == 2):
        return wrong("two things should come back: the labels and the graph")
    found, solved = answer
    found, verdict = as_array("the labels", found, labels.shape)
    if verdict is not None:
        return verdict
    if not isinstance(solved, PoseGraph):
        return wrong(f"the second thing should be a graph, yours is {type(solved).__name__}")
    expected, best, unsolved = _round(log, graph, labels)
    if _same(found, expected) and _same_graph(solved, best):
        return None
    return wrong(_mistake_in_round(found, solved, log, graph, labels, expected, unsolved))


def _mistake_in_round(found, solved, log, graph, labels, expected, unsolved) -> str:
    wheels = se2.dead_reckoning(log.odometry)
    along_wheels = _round(log, graph, labels, seen_from=wheels)[0]
    if _same(found, labels) and not _same(expected, labels):
        return "no label has changed: ask every sighting with the map held still, and keep the answer"
    if _same(found, along_wheels) and not _same(expected, along_wheels):
        return "the sightings are carried into the room along the wheels' path, not along the present one"
    if not _same(found, expected):
        return "the labels differ: carry every sighting into the room along graph.poses, and sweep once"
    if _same_graph(solved, graph):
        return "the labels are new, but the graph is the old one: tie the sightings to their objects, then solve"
    if _same_graph(solved, unsolved):
        return "the sightings are tied to their new objects, but the second half is missing: solve"
    return "the labels are right, the graph is not: solve once, from the present poses, with observation_std"


def _round(log: RobotLog, graph: PoseGraph, labels: np.ndarray, seen_from: np.ndarray | None = None):
    """New labels (M,), the graph solved with them, and the graph not yet solved."""
    poses = graph.poses if seen_from is None else seen_from
    seen_at = se2.apply(poses[log.obs_time], log.obs_xy)
    association = sweep(labels, graph.landmarks, seen_at, log.obs_class, ALPHA)
    tied = with_associations(log, graph, association.labels, association.landmarks, STD)
    return association.labels, optimize(tied), tied


def _shaken_toy(seed: int) -> tuple[RobotLog, np.ndarray]:
    """The toy scene observed three times, with a little noise and one more metre of slip; and its true path."""
    rng = np.random.default_rng(seed)
    log, truth = simulate.toy_objects()
    noisy = np.tile(log.obs_xy, (3, 1)) + rng.normal(0, 0.15, (24, 2))
    odometry = log.odometry.copy()
    odometry[2, 0] += 1.0
    times, classes = np.tile(log.obs_time, 3), np.tile(log.obs_class, 3)
    shaken = RobotLog(odometry, times, noisy, classes, log.num_classes, log.odometry_std, log.observation_std)
    return shaken, truth.poses


def _same(labels: np.ndarray, other: np.ndarray) -> bool:
    """Whether two labelings group alike, whatever the objects are called."""
    labels, other = np.asarray(labels), np.asarray(other)
    return np.array_equal(labels[:, None] == labels, other[:, None] == other)


def _same_graph(graph: PoseGraph, other: PoseGraph) -> bool:
    return (
        graph.poses.shape == other.poses.shape
        and graph.landmarks.shape == other.landmarks.shape
        and np.allclose(graph.poses, other.poses, atol=1e-5)
        and math.isclose(chi2(graph), chi2(other), rel_tol=1e-5, abs_tol=1e-9)
    )


def check_kept(student: Callable) -> Verdict:
    """Exercise 4: ``student(votes, epsilon)`` says which objects stay."""
    rng = np.random.default_rng(13)
    cases = [(np.array([[1.0, 1, 0], [1, 0, 2], [1, 3, 0]]), epsilon) for epsilon in (0.5, 0.4, 0.3, 0.25, 0.1)]
    cases += [(rng.integers(1, 6, (8, 4)).astype(float), float(rng.uniform(0.1, 0.6))) for _ in range(20)]
    answers = []
    for votes, epsilon in cases:
        kept, verdict = array_from("the answer", student, (len(votes),), votes.copy(), epsilon)
        if verdict is not None:
            return verdict
        answers.append(kept)
    if all(np.array_equal(a, v[:, 0] / v.sum(axis=1) <= e) for a, (v, e) in zip(answers, cases, strict=True)):
        return right("each object has one vote against it from the start; the others must outweigh it")
    return wrong(_mistake_in_kept(answers, cases))


def _mistake_in_kept(answers: list, cases: list) -> str:
    """The mistake that explains all of the answers, not only the first wrong one."""
    mistakes = {
        "these are the objects that go, asked for are those that stay": lambda v, e: v[:, 0] / v.sum(axis=1) > e,
        "an object exactly at epsilon stays: only above it does it go": lambda v, e: v[:, 0] / v.sum(axis=1) < e,
        "the vote against is compared with the other votes, not with all votes": lambda v, e: (
            v[:, 0] / v[:, 1:].sum(axis=1) <= e
        ),
        "the vote against is not yet a probability: divide by the votes of the object": lambda v, e: v[:, 0] <= e,
        "you divided by the votes of all objects, not by those of each": lambda v, e: v[:, 0] / v.sum() <= e,
        "column 0 holds the votes against the object, you looked at column 1": lambda v, e: (
            v[:, 1] / v.sum(axis=1) <= e
        ),
    }
    for message, rule in mistakes.items():
        if all(np.array_equal(a, rule(v, e)) for a, (v, e) in zip(answers, cases, strict=True)):
            return message
    return "some object is judged wrongly: compare column 0 of its class posterior with epsilon"
