"""Checks of lesson 11: a partition's prior, a Gibbs move, poses eliminated, samples counted, a merger accepted."""

import math
from collections.abc import Callable
from functools import partial

import numpy as np

from npslam_teach.association.dirichlet_process import log_partition_prior
from npslam_teach.course import drawings
from npslam_teach.course.checking import Verdict
from npslam_teach.course.the_posterior.check_inputs import eliminate_inputs, merge_acceptance_inputs
from npslam_teach.course.trials import Part, check_function, fresh
from npslam_teach.course.verdict_page import exercise


@exercise("11", 1, of=5)
def check_crp_probability(crp_probability: Callable) -> Verdict:
    """Exercise 1: ``crp_probability(counts, alpha)``, a number."""

    def truth(counts, alpha):
        return math.exp(log_partition_prior(counts, alpha))

    def seated(counts, alpha, guests=lambda n: math.factorial(n - 1), power=True):
        return (alpha ** len(counts) if power else alpha) * math.prod(guests(int(n)) for n in counts)

    def arrivals(counts, alpha, first=0):
        return math.prod(alpha + i for i in range(first, first + int(np.sum(counts))))

    mistakes = {
        "the factors below the line are missing: one for every guest, and they make it a probability": seated,
        "alpha counts once for every table, not once in all": lambda c, a: seated(c, a, power=False) / arrivals(c, a),
        "the first guest of a table does not find one there: (n - 1)!, not n!": (
            lambda c, a: seated(c, a, guests=math.factorial) / arrivals(c, a)
        ),
        "below the line the first guest has alpha, not alpha + 1": lambda c, a: seated(c, a) / arrivals(c, a, first=1),
        "below the line stands n!: that is so only for alpha = 1": (
            lambda c, a: seated(c, a) / math.factorial(int(np.sum(c)))
        ),
        "the tables' own factors (n - 1)! are missing": lambda c, a: a ** len(c) / arrivals(c, a),
        "that is the logarithm; the probability is asked for": lambda c, a: log_partition_prior(c, a),
    }
    rng = fresh()
    some = ([3], [1, 1, 2], [4, 1], [2, 2, 3], [1, 1, 1, 1], rng.integers(1, 7, 3), rng.integers(1, 7, 4))
    trials = [(np.array(c), a) for c in some for a in (0.4, 1.0, float(rng.uniform(1.2, 4.0)))]
    edges = {
        "with one guest, who is certain to open a table": [(np.array([1]), 0.7)],
        "with tables of twenty and more, whose factors are too large for 64 bits": [(np.array([24, 31]), 0.6)],
        "with a table of 180, whose factors are too large for a floating-point number": [(np.array([180, 1]), 0.6)],
        "with nobody": [(np.empty(0, dtype=int), 0.6)],
    }
    praise = "nothing in it asks who came first or sat where"
    return check_function(
        crp_probability, truth, Part("your number", mistakes), trials, edges, praise, drawings.crp_probability()
    )


@exercise("11", 2, of=5)
def check_move_probabilities(move_probabilities: Callable) -> Verdict:
    """Exercise 2: ``move_probabilities(log_p, labels, k)``, (K+1,), the last for a new object."""

    def logs(log_p, labels, k, taken_out=True):
        others = np.unique(np.delete(labels, k) if taken_out else labels, return_inverse=True)[1]
        rest = others if taken_out else np.delete(others, k)
        places = range(others.max(initial=-1) + 2)
        return np.array([log_p(np.unique(np.insert(rest, k, i), return_inverse=True)[1]) for i in places])

    def truth(log_p, labels, k):
        return _softmax(logs(log_p, labels, k))

    mistakes = {
        "these are logarithms: take exp before you divide by the sum": lambda *t: logs(*t) / logs(*t).sum(),
        "these are logarithms of the weights: take exp, and divide by the sum": logs,
        "they do not add up to one: divide by the sum": lambda *t: np.exp(logs(*t) - logs(*t).max()),
        "a new object comes last, not first": lambda *t: np.roll(truth(*t), 1),
        "the weights are right but their order is reversed": lambda *t: truth(*t)[::-1],
        "the sighting was not taken out first: its own object, if it is alone there, counts twice": (
            lambda *t: _softmax(logs(*t, taken_out=False))
        ),
        "all places are alike to you: log_p is not used": lambda *t: np.full(len(logs(*t)), 1 / len(logs(*t))),
        "a new object has no place in your answer: K objects and one more": lambda *t: _softmax(logs(*t)[:-1]),
    }
    rng = fresh()
    labelings = ([0, 0, 1, 1, 2], [0, 1, 0, 2, 1], [0, 1, 2, 3, 4], [0, 0, 0, 0, 0], [0, 1, 1, 2, 0])
    trials = [(_some_log_p(rng), np.array(labels), k) for labels in labelings for k in (0, 3)]
    edges = {
        "for the last sighting": [(_some_log_p(rng), np.array([0, 1, 0, 2, 3]), 4)],
        "with log probabilities thousands apart: it is the largest that must become 0": [
            (_some_log_p(rng, 4000.0), np.array(labels), 2) for labels in labelings
        ],
        "with partitions that are impossible, whose log probability is minus infinity": [
            (_with_impossible(_some_log_p(rng)), np.array(labels), k) for labels in labelings for k in (1, 4)
        ],
        "with a single sighting, which has no object to join": [(_some_log_p(rng), np.array([0]), 0)],
        "with two sightings": [(_some_log_p(rng), np.array([0, 0]), 1), (_some_log_p(rng), np.array([0, 1]), 0)],
    }
    praise = "every place is weighed by the whole posterior, and no distance was compared with a threshold"
    return check_function(move_probabilities, truth, Part("your vector", mistakes), trials, edges, praise)


@exercise("11", 3, of=5)
def check_eliminate(eliminate: Callable) -> Verdict:
    """Exercise 3: ``eliminate(H, b, num_poses)``: information (m, m) and gradient (m,) of the landmarks alone."""

    def truth(H, b, num_poses):
        n = num_poses
        carried = np.linalg.solve(H[:n, :n], H[:n, n:]).T
        return H[n:, n:] - carried @ H[:n, n:], b[n:] - carried @ b[:n]

    def less(H, n, between):
        return H[n:, n:] - H[:n, n:].T @ between(H[:n, :n]) @ H[:n, n:]

    of_information = {
        "the landmarks' own block alone: so it would be if the poses were known exactly": lambda H, b, n: H[n:, n:],
        "what the poses take away is added: poses that are not known make the map less sure": lambda H, b, n: (
            2 * H[n:, n:] - truth(H, b, n)[0]
        ),
        "multiplied by H_xx instead of its inverse": lambda H, b, n: less(H, n, np.array),
        "the inverse is taken number by number: a matrix has an inverse as a whole": lambda H, b, n: less(
            H, n, lambda xx: 1 / xx
        ),
        "that is the covariance of the landmarks; its inverse is the information": lambda H, b, n: np.linalg.inv(H)[
            n:, n:
        ],
    }
    of_gradient = {
        "the landmarks' own part of b alone: what the poses want has been forgotten": lambda H, b, n: b[n:],
        "the sign of what the poses add to the gradient is wrong": lambda H, b, n: 2 * b[n:] - truth(H, b, n)[1],
        "minus the gradient: keep the sign of b": lambda H, b, n: -truth(H, b, n)[1],
    }
    hint = "the first num_poses rows and columns of H are those of the poses"
    parts = (Part("your information", of_information, hint=hint), Part("your gradient", of_gradient, hint=hint))
    praise = "the poses are gone, and everything that they tied together is still tied"
    return check_function(eliminate, truth, parts, *eliminate_inputs(), praise)


@exercise("11", 4, of=5)
def check_summarise(summarise: Callable) -> Verdict:
    """Exercise 4: ``summarise(partitions, number)``: a probability, and (N, N) how often two are one object."""

    def truth(partitions, number):
        return share(partitions, lambda found: found == number), together(partitions).mean(axis=0)

    def share(partitions, wanted, first=1):
        return float(np.mean(wanted(partitions.max(axis=1) + first)))

    def together(partitions):
        return partitions[:, :, None] == partitions[:, None, :]

    of_share = {
        "labels count from 0: three objects have labels 0, 1 and 2": lambda p, n: share(p, lambda k: k == n, first=0),
        "that is how many samples have so many objects; divide by the number of samples": lambda p, n: (
            share(p, lambda k: k == n) * len(p)
        ),
        "so many objects exactly, not at most": lambda p, n: share(p, lambda k: k <= n),
        "so many objects exactly, not at least": lambda p, n: share(p, lambda k: k >= n),
    }
    of_pairs = {
        "that is how often; divide by the number of samples": lambda p, n: together(p).sum(axis=0),
        "a tracklet is one object with itself: the diagonal is 1": lambda p, n: (
            together(p).mean(axis=0) - np.eye(p.shape[1])
        ),
        "that is how often they are apart": lambda p, n: 1 - together(p).mean(axis=0),
        "one sample alone, the last, is no probability": lambda p, n: together(p)[-1],
        "one sample alone, the first, is no probability": lambda p, n: together(p)[0],
    }
    rng, trials = fresh(), []
    for count, size in ((40, 5), (17, 3), (60, 7)):
        drawn = np.array([np.unique(rng.integers(0, 4, size), return_inverse=True)[1] for _ in range(count)])
        trials += [(drawn, number) for number in (1, 2, 3, 4)]
    edges = {
        "with a single sample": [(np.array([[0, 1, 0]]), 2)],
        "with a number that no sample has": [(np.array([[0, 1, 0], [0, 0, 1]]), 7)],
        "with a single tracklet": [(np.zeros((5, 1), dtype=int), 1)],
    }
    hint = "compare labels within a sample, then average over the samples"
    parts = (Part("your probability", of_share, hint=hint), Part("your matrix", of_pairs, hint=hint))
    praise = "two numbers that no single answer has: how many, and which pairs, with what probability"
    return check_function(summarise, truth, parts, trials, edges, praise)


@exercise("11", 5, of=5)
def check_merge_acceptance(merge_acceptance: Callable) -> Verdict:
    """Exercise 5: ``merge_acceptance(log_apart, log_merged, log_weights, sits)``, a probability."""

    def log_shares(log_weights, sits):
        shares = log_weights - np.logaddexp(log_weights[:, 0], log_weights[:, 1])[:, None]
        return shares[np.arange(len(sits)), sits.astype(int)]

    def ratio(log_apart, log_merged, log_weights, sits, way_back=1.0, posterior=1.0):
        log_ratio = posterior * (log_merged - log_apart) + way_back * log_shares(log_weights, sits).sum()
        return math.exp(min(log_ratio, 700.0))

    def truth(log_apart, log_merged, log_weights, sits):
        return min(1.0, ratio(log_apart, log_merged, log_weights, sits))

    def capped(*trial, **keys):
        return min(1.0, ratio(*trial, **keys))

    mistakes = {
        "a probability is never above 1: where the ratio is larger, it is 1": ratio,
        "the way back is missing: how probable is it that a split parts them just as they are?": partial(
            capped, way_back=0.0
        ),
        "the way back stands below the line: it belongs above": partial(capped, way_back=-1.0),
        "the two posteriors have changed places: the merged one stands above the line": partial(capped, posterior=-1.0),
        "only the way back: the posteriors are missing": partial(capped, posterior=0.0),
        "the shares are of the other place: take that where each sits": (
            lambda a, m, w, s: capped(a, m, w[:, ::-1], s)
        ),
        "the weights of a row must be divided by their sum before they are a probability": (
            lambda a, m, w, s: min(1.0, math.exp(min(m - a + w[np.arange(len(s)), s.astype(int)].sum(), 700.0)))
        ),
        "shares are multiplied (their logarithms added), not added": (
            lambda a, m, w, s: min(1.0, math.exp(m - a) * np.exp(log_shares(w, s)).sum())
        ),
        "that is the logarithm; the probability is asked for": lambda *t: math.log(truth(*t)),
    }
    praise = "with this number the merger and the split come in exactly as often as the posterior asks for"
    return check_function(merge_acceptance, truth, Part("your number", mistakes), *merge_acceptance_inputs(), praise)


def _some_log_p(rng: np.random.Generator, spread: float = 1.0) -> Callable:
    """A log posterior of labels (N,), far from zero, as real ones are, and any two partitions apart."""
    tie, cost = rng.normal(0, spread, (9, 9)), rng.uniform(0.5, 2)

    def log_p(labels) -> float:
        labels = np.asarray(labels)
        if labels.ndim != 1 or set(labels.tolist()) != set(range(len(set(labels.tolist())))):
            raise ValueError(f"log_p wants labels from 0 without gaps, got {labels.tolist()}")
        same = labels[:, None] == labels
        return float(-900.0 - cost * (labels.max() + 1) + tie[: len(labels), : len(labels)][same].sum())

    return log_p


def _with_impossible(log_p: Callable) -> Callable:
    """The same log posterior, where sightings 1 and 4 cannot be one object: they are of one frame."""
    return lambda labels: -math.inf if labels[1] == labels[4] else log_p(labels)


def _softmax(log_weights: np.ndarray) -> np.ndarray:
    weights = np.exp(log_weights - log_weights.max())
    return weights / weights.sum()
