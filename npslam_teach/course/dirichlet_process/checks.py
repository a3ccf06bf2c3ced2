"""Checks of lesson 04: weights, the reweighting, the decision, the restaurant, and a whole sweep."""

import math
from collections.abc import Callable
from functools import partial

import numpy as np

from npslam_teach import association
from npslam_teach.association import association_weights, expected_num_objects
from npslam_teach.course import drawings
from npslam_teach.course.checking import Verdict, as_array, wrong
from npslam_teach.course.comparing import exactly, grouped_alike
from npslam_teach.course.dirichlet_process.check_inputs import sweep_inputs
from npslam_teach.course.dirichlet_process.mistakes import sweep_with
from npslam_teach.course.trials import Part, check_function, fresh
from npslam_teach.course.verdict_page import exercise


@exercise("04", 1, of=5)
def check_weights(function: Callable) -> Verdict:
    """Exercise 1: ``(votes, distance, kernel_std) -> (K,)`` weights."""

    def truth(votes, distance, kernel_std):
        return association_weights(votes, distance, kernel_std)

    def near(distance, s):
        return np.exp(-(distance**2) / (2 * s**2))

    mistakes = {
        "the votes are missing: a sighting of another class has the same weight as one of its own": lambda n, d, s: (
            near(d, s)
        ),
        "the distance is not squared in the exponent": lambda n, d, s: n * np.exp(-d / (2 * s**2)),
        "the kernel width is not squared in the exponent": lambda n, d, s: n * np.exp(-(d**2) / (2 * s)),
        "the 2 under the fraction is missing": lambda n, d, s: n * np.exp(-(d**2) / s**2),
        "the exponent has the wrong sign: weights grow with distance": lambda n, d, s: n / near(d, s),
        "these are shares, not weights: they add up to 1 before alpha has come in": lambda n, d, s: (
            truth(n, d, s) / truth(n, d, s).sum()
        ),
    }
    rng, trials = fresh(), []
    for count in (5, 4, 7, 5, 6):
        votes = rng.integers(1, 6, count).astype(float)
        votes[rng.integers(count)] = 0.0
        trials.append((votes, rng.uniform(0.2, 1.5, count), float(rng.uniform(0.3, 0.9))))
    edges = {
        "with no object yet": [(np.empty(0), np.empty(0), 0.5)],
        "with one vote at distance zero, which must weigh 1": [(np.ones(1), np.zeros(1), 0.5)],
        "with many votes far away": [(np.array([1e6, 3.0]), np.array([2.0, 0.1]), 0.4)],
        "with votes for another class only": [(np.zeros(3), rng.uniform(0, 1, 3), 0.5)],
    }
    hint = "some weight is off; try one vote at distance zero, which must weigh 1"
    praise = "votes say how rich an object is, and distance fades its pull"
    return check_function(function, truth, Part("the weights", mistakes, hint=hint), trials, edges, praise)


@exercise("04", 2, of=5)
def check_reweight(function: Callable) -> Verdict:
    """Exercise 2: ``(weights, alpha) -> (K+1,)`` probabilities, the last one "new"."""

    def truth(weights, alpha):
        return association.reweight(weights, alpha)

    no_entry = 'there is one more possibility than objects, "new", which has no entry'
    mistakes = {
        "the sum under the fraction leaves alpha out, so the probabilities add up to more than 1": lambda w, a: (
            np.append(w, a) / w.sum()
        ),
        "these are the weights themselves: nothing was divided by their sum": np.append,
        '"new" stands first; it belongs at the end': lambda w, a: np.roll(truth(w, a), 1),
        "alpha is taken for a probability; it is a weight like the others, to be divided by the sum too": lambda w, a: (
            np.append(w / (w.sum() + a), a)
        ),
        'alpha is added to every object; only "new" has it': lambda w, a: (
            np.append(w + a, a) / (w.sum() + a * (len(w) + 1))
        ),
        no_entry: lambda w, a: w / (w.sum() + a),
        f"{no_entry}, and alpha does not count": lambda w, a: w / w.sum(),
    }
    rng = fresh()
    trials = [(rng.uniform(0.1, 3.0, count), float(rng.uniform(0.3, 2.0))) for count in (4, 1, 3, 8, 2)]
    edges = {
        "with no object yet, where all is new": [(np.empty(0), 0.7)],
        "with weights of zero, where all is new": [(np.zeros(3), 0.2)],
        "with weights in the thousands": [(rng.uniform(1e3, 1e5, 4), 0.5)],
    }
    part = Part("the probabilities", mistakes, hint=lambda a, _: f"the first of them add up to {a[0].sum():.3f}")
    praise = "one more chair at the table, and everybody moves up a little"
    return check_function(function, truth, part, trials, edges, praise)


@exercise("04", 3, of=5)
def check_decide(function: Callable) -> Verdict:
    """Exercise 3: ``(probabilities, threshold) -> index``, the number of objects meaning "new"."""

    def truth(probabilities, threshold=None):
        return association.decide(probabilities, threshold)

    def everything(p, threshold):
        return int(np.argmax(p)) if threshold is None or p.max() > threshold else len(p) - 1

    def at_least(p, threshold):
        best, bar = int(np.argmax(p[:-1])), p[-1] if threshold is None else threshold
        return best if p[best] >= bar else len(p) - 1

    def one_short(p, threshold):
        chosen = truth(p, threshold)
        return chosen - 1 if chosen == len(p) - 1 else chosen

    mistakes = {
        "the threshold is not used: only the most probable wins": lambda p, threshold: truth(p),
        'with a threshold "new" still takes part; only the objects are to be held against the bar': everything,
        "a tie must open a new object: the best has to exceed the bar, not to reach it": at_least,
        '"new" is the number of objects, one past the last object': one_short,
        "a new object is never opened": lambda p, threshold: int(np.argmax(p[:-1])),
    }
    rng = fresh()
    trials = [
        (rng.dirichlet(np.full(rng.integers(2, 7), 0.8)), threshold)
        for threshold in (None, 0.2, 0.4, 0.6, float(rng.uniform(0.1, 0.9)))
        for _ in range(40)
    ]
    trials += [(np.array([0.5, 0.0, 0.5]), None), (np.array([0.25, 0.5, 0.25]), 0.5)]  # ties
    trials += [(np.array([0.1, 0.3, 0.6]), 0.2), (np.array([0.1, 0.45, 0.25, 0.2]), 0.5)]
    edges = {
        "with a threshold of 0, which is not None": [(np.array([0.1, 0.2, 0.7]), 0.0), (np.array([0.05, 0.95]), 0.0)],
        "with a threshold of 1": [(np.array([0.9, 0.06, 0.04]), 1.0)],
        "without a threshold": [(np.array([0.1, 0.5, 0.4]),), (np.array([0.3, 0.7]),)],
        "with no object yet, where all is new": [(np.ones(1), None), (np.ones(1), 0.5)],
    }
    part = Part("the index", mistakes, exactly, read=_read_index)
    praise = "one function serves the authors' rule and the deck's"
    return check_function(function, truth, part, trials, edges, praise)


def _read_index(name: str, answer, shape: tuple):
    kind = np.asarray(answer).dtype.kind if isinstance(answer, int | np.integer | np.ndarray) else ""
    if kind not in ("i", "u"):
        return None, wrong(f"expected the index of an object, a whole number, yours is {type(answer).__name__}")
    return as_array(name, answer, shape)


@exercise("04", 4, of=5)
def check_expected_tables(function: Callable) -> Verdict:
    """Exercise 4: ``(num_guests, alpha) -> number``."""

    def truth(num_guests, alpha):
        return expected_num_objects(num_guests, alpha)

    def late(n, alpha):
        return alpha / (alpha + np.arange(1, n + 1))

    mistakes = {
        "the first guest comes when 0 others sit there, and opens a table for certain": lambda n, a: late(n, a).sum(),
        "that is the chance of the last guest alone; add up those of all": lambda n, a: a / (a + n - 1),
        "that is what the logarithm comes near to with many guests; the sum itself is asked": lambda n, a: (
            a * math.log(1 + n / a)
        ),
        "alpha is missing above the fraction": lambda n, a: (1 / (a + np.arange(n))).sum(),
        "one guest too many: n guests meet 0 to n - 1 others": lambda n, a: 1 + late(n, a).sum(),
    }
    rng = fresh()
    # A plain recursion over the guests is right too: Python allows about 1000 calls within calls.
    trials = [(int(n), float(a)) for n, a in zip(rng.integers(2, 300, 8), rng.uniform(0.1, 5.0, 8), strict=True)]
    edges = {"with one guest, who needs exactly 1 table": [(1, float(a)) for a in rng.uniform(0.1, 5.0, 2)]}
    praise = "the number of tables grows with every guest, ever more slowly, and never stops"
    part = Part("the expected number", mistakes, hint="one guest needs exactly 1 table")
    return check_function(function, truth, part, trials, edges, praise, drawings.expected_tables())


@exercise("04", 5, of=5)
def check_sweep(function: Callable) -> Verdict:
    """Exercise 5: ``(labels, landmarks, xy, obs_class, alpha) -> (M,)`` labels, grouped as ``sweep`` does."""

    def truth(labels, landmarks, xy, obs_class, alpha):
        return association.sweep(labels, landmarks, xy, obs_class, alpha).labels

    mistakes = {
        "a sighting must take its vote back before it is asked: it still votes for itself": "own vote",
        "the order matters, because each answer counts for the next question: begin with the last sighting": "order",
        "all were asked with the votes of the beginning; each answer must count for the next question": "old votes",
        "the class is left out: votes of another class must count for nothing": "class",
        "the best match is taken however bad it is: a new object is never opened": "never new",
        "alpha is 0.5 whatever is given: use the argument": "alpha",
    }
    mistakes = {message: partial(sweep_with, mistake) for message, mistake in mistakes.items()}
    part = Part("your labels", mistakes, grouped_alike, hint=_counted)
    praise = "that is the heart of the method; lesson 06 takes turns between it and the pose graph"
    return check_function(function, truth, part, *sweep_inputs(), praise)


def _counted(answers: list, expected: list) -> str:
    off = [k for k, (a, e) in enumerate(zip(answers, expected, strict=True)) if not grouped_alike(a, e)]
    found, wanted = (len(set(each[off[0]].tolist())) for each in (answers, expected))
    return (
        f"{len(off)} of {len(answers)} random scenes are grouped otherwise; in the first of them you have {found} "
        f"objects where there should be {wanted}"
    )
