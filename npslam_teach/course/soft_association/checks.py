"""Checks of lesson 13: marginals over matchings, Bayes' rule for reports, class and position together, the M-step."""

import itertools
from collections.abc import Callable
from functools import partial

import numpy as np

from npslam_teach.course import drawings
from npslam_teach.course.checking import Verdict
from npslam_teach.course.trials import Part, check_function, fresh
from npslam_teach.course.verdict_page import exercise


@exercise("13", 1, of=4)
def check_pair_probabilities(pair_probabilities: Callable) -> Verdict:
    """Exercise 1: ``pair_probabilities(weights)``, (m, K) to (m, K)."""

    def variant(weights, exclusive=True, none=1.0, best=False):
        count, total, pairs = weights.shape[1], 0.0, np.zeros(weights.shape)
        padded = np.column_stack([weights, np.full(len(weights), none)])
        largest = -1.0
        for chosen in itertools.product(range(count + 1), repeat=len(weights)):
            used = [j for j in chosen if j < count]
            product = padded[range(len(weights)), chosen].prod()
            if exclusive and len(set(used)) < len(used):
                continue
            if best:
                if product > largest:
                    largest, total, pairs = product, 1.0, np.zeros(weights.shape)
                    pairs[[k for k, j in enumerate(chosen) if j < count], used] = 1.0
                continue
            total += product
            for k, j in enumerate(chosen):
                if j < count:
                    pairs[k, j] += product
        return pairs / total if total else pairs

    mistakes = {
        "two observations may share an object here: leave out matchings that take one twice": partial(
            variant, exclusive=False
        ),
        "an observation may be of no object: the matchings with none, of weight 1, are missing": partial(
            variant, none=0.0
        ),
        "this is the best matching alone: add up the weights of all": partial(variant, best=True),
        "these are sums of weights: divide by the weight of all matchings": lambda w: variant(w) * _total(w),
        "the weights themselves are no probabilities": lambda w: w,
        "each row is divided by its own sum: the other observations do not count": lambda w: (
            w / w.sum(axis=1, keepdims=True)
        ),
        "rows and columns are exchanged: one row for each observation": lambda w: variant(w).T,
    }
    praise = "no object is taken twice, and what one observation is says something about the others"
    return check_function(
        pair_probabilities, variant, Part("your table", mistakes), *_pair_probabilities_inputs(), praise
    )


def _pair_probabilities_inputs() -> tuple[list, dict]:
    """Arguments of ``check_pair_probabilities``: its trials, and its edges by the situation."""
    rng = fresh()
    trials = [(np.exp(rng.normal(size=shape)),) for shape in ((1, 1), (2, 1), (1, 2), (2, 2), (3, 2), (2, 3), (3, 3))]
    edges = {
        "with no object in reach": [(np.zeros((2, 0)),)],
        "with no observation": [(np.zeros((0, 3)),)],
        "with weights of zero": [(np.array([[0.0, 2.0], [0.0, 0.0]]),)],
        "with large weights": [(np.array([[1e9, 1e3], [1e8, 1e-3]]),)],
    }
    return trials, edges


def _total(weights: np.ndarray) -> float:
    """The weight of all one-to-one matchings."""
    if len(weights) == 0:
        return 1.0
    rest = _total(weights[1:])
    for j in range(weights.shape[1]):
        without = weights[1:].copy()
        without[:, j] = 0.0
        rest += weights[0, j] * _total(without)
    return rest


@exercise("13", 2, of=4)
def check_true_class(true_class: Callable) -> Verdict:
    """Exercise 2: ``true_class(reports, confusion)``, the posterior (C,) of an object's class."""

    def truth(reports, confusion):
        logs = np.log(confusion)[:, reports].sum(axis=1)
        return np.exp(logs - logs.max()) / np.exp(logs - logs.max()).sum()

    def mean(reports, confusion):
        return confusion[:, reports].mean(axis=1) / confusion[:, reports].mean(axis=1).sum()

    mistakes = {
        "rows and columns of the confusion matrix are exchanged: row c is of the true class c": lambda r, c: truth(
            r, c.T
        ),
        "independent reports multiply, they do not average": mean,
        "divide by the sum, so that the probabilities sum to one": lambda r, c: c[:, r].prod(axis=1),
        "these are shares of votes: what a report says of other classes is left out": lambda r, c: (
            np.bincount(r, minlength=len(c)) / max(len(r), 1)
        ),
        "only the last report counts here": lambda r, c: truth(r[-1:], c),
        "only the first report counts here": lambda r, c: truth(r[:1], c),
        "every kind of report counts once here, however often it came": lambda r, c: truth(np.unique(r), c),
    }
    rng, trials = fresh(), []
    for size, count in ((2, 1), (2, 5), (3, 4), (4, 7), (5, 9), (5, 12)):
        confusion = 0.5 * np.eye(size) + 0.5 * rng.dirichlet(np.ones(size), size)
        trials.append((rng.integers(0, size, count), confusion))
    trials.append((np.array([0, 0, 1]), np.array([[0.9, 0.1], [0.4, 0.6]])))
    praise = "every report speaks for all classes, for each as much as it is likely to be its report"
    edges = {
        "with no report, when all classes are alike": [(np.empty(0, dtype=int), trials[2][1])],
        "with hundreds of reports or more, whose product is too small for a number: add logarithms": [
            (np.full(500, int(rng.integers(5))), 0.5 * np.eye(5) + 0.1),
            (rng.integers(0, 2, 3000), np.array([[0.6, 0.4], [0.4, 0.6]])),
        ],
        "with one report": [(np.array([1]), np.array([[0.9, 0.1], [0.4, 0.6]]))],
        "with reports that are certain": [(np.array([2, 2]), np.eye(3))],
        "with a single class": [(np.array([0, 0]), np.ones((1, 1)))],
    }
    return check_function(true_class, truth, Part("your posterior", mistakes), trials, edges, praise)


@exercise("13", 3, of=4)
def check_class_distance(class_distance: Callable) -> Verdict:
    """Exercise 3: ``class_distance(belief, likelihood)``, what the classes add to the squared distance."""

    def variant(belief, likelihood, factor=-2.0, against="mean", log=np.log):
        agreement = belief @ likelihood
        by = {"mean": likelihood.mean(), "max": likelihood.max(), "sum": likelihood.sum(), "nothing": 1.0}[against]
        return factor * log(agreement / by)

    mistakes = {
        "the sign is wrong: what agrees well is near": partial(variant, factor=2.0),
        "the 2 is missing: a squared distance is -2 log of a density": partial(variant, factor=-1.0),
        "the likelihood must be compared with that of nothing, its mean over the classes": partial(
            variant, against="nothing"
        ),
        "this compares with the best class: compare with the mean over all": partial(variant, against="max"),
        "this compares with the sum over the classes: compare with the mean": partial(variant, against="sum"),
        "this is log to the base 10": partial(variant, log=np.log10),
        "this is the ratio itself: take -2 log of it": lambda b, v: b @ v / v.mean(),
        "only the most probable class of the object counts here": lambda b, v: -2 * np.log(v[b.argmax()] / v.mean()),
    }
    rng = fresh()
    trials = [(rng.dirichlet(np.ones(c)), rng.dirichlet(np.ones(c)) * rng.uniform(0.2, 3)) for c in (2, 3, 4, 5, 5)]
    praise = "negative where the classes agree better than chance, positive where they agree worse"
    edges = {
        "with a belief that is certain": [(np.array([0.0, 1.0, 0.0]), np.array([0.2, 0.5, 0.3]))],
        "with likelihoods that say nothing": [(np.array([0.7, 0.3]), np.array([0.5, 0.5]))],
        "with a single class": [(np.array([1.0]), np.array([0.3]))],
    }
    return check_function(class_distance, variant, Part("your distance", mistakes), trials, edges, praise)


@exercise("13", 4, of=4)
def check_m_step(m_step: Callable) -> Verdict:
    """Exercise 4: ``m_step(seen, weights, information)``, the best places (K, 2) of the objects."""

    def variant(seen, weights, information, power=1, alike=False, metric=None):
        information = np.broadcast_to(np.eye(2), information.shape) if alike else information
        if metric is not None:
            information = metric(information)
        strength = (weights**power).T[:, :, None, None] * information  # (K, M, 2, 2)
        return np.linalg.solve(strength.sum(axis=1), (strength @ seen[:, :, None]).sum(axis=1))[..., 0]

    def diagonal(information):
        return information * np.eye(2)

    mistakes = {
        "the information matrices are not used: this is the weighted mean of equal observations": partial(
            variant, alike=True
        ),
        "these are covariances to you: an observation of much information counts more, not less": partial(
            variant, metric=np.linalg.inv
        ),
        "only the diagonals of the information matrices are used": partial(variant, metric=diagonal),
        "the weights are squared": partial(variant, power=2),
        "every observation counts alike for every object here: the weights are not used": partial(variant, power=0),
        "the sum is not solved for the place: divide by the sum of the weighted information, as a matrix": (
            lambda x, w, info: np.einsum("mk,mij,mj->ki", w, info, x)
        ),
        "each object stands on its most probable observation": lambda x, w, info: x[w.argmax(axis=0)],
        "this is the mean weighted by probability times information entry by entry: matrices do not divide so": (
            lambda x, w, info: np.einsum("mk,mij,mj->ki", w, info, x) / np.einsum("mk,mij->ki", w, info)
        ),
    }
    rng, trials = fresh(), []
    for m, k in ((1, 1), (3, 2), (4, 3), (8, 2), (20, 5)):
        root = rng.normal(size=(m, 2, 2))
        trials.append((rng.normal(size=(m, 2)), rng.uniform(0.01, 1, (m, k)), root @ root.swapaxes(1, 2) + np.eye(2)))
    praise = "the minimum of a sum of squares, each as strong as its pair is probable"
    edges = {
        "with one observation": [(np.array([[1.0, 2.0]]), np.array([[0.3, 0.7]]), 4.0 * np.eye(2)[None])],
        "with a weight of zero": [
            (np.array([[1.0, 2.0], [3.0, 5.0]]), np.array([[1.0, 0.2], [0.0, 0.8]]), np.tile(np.eye(2), (2, 1, 1)))
        ],
    }
    return check_function(m_step, variant, Part("your places", mistakes), trials, edges, praise, drawings.m_step())
