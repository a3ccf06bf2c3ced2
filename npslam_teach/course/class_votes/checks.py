"""Checks of lesson 05: votes, class posterior, false positives, the Dirichlet density, and a detector that errs."""

from collections.abc import Callable

import numpy as np

from npslam_teach import association
from npslam_teach.association import class_posterior
from npslam_teach.course import drawings
from npslam_teach.course.checking import Verdict
from npslam_teach.course.class_votes.check_inputs import count_votes_inputs
from npslam_teach.course.comparing import close, exactly
from npslam_teach.course.trials import Part, check_function, fresh
from npslam_teach.course.verdict_page import exercise


@exercise("05", 1, of=5)
def check_count_votes(function: Callable) -> Verdict:
    """Exercise 1: ``(labels, obs_class, num_objects, num_classes) -> (K, C+1)``."""

    def truth(labels, obs_class, num_objects, num_classes):
        return association.count_votes(labels, obs_class, num_objects, num_classes)

    def left(labels, obs_class, num_objects, num_classes, doubt=0.0, overwrite=False):
        counts, used = np.zeros((num_objects, num_classes + 1)), labels >= 0
        np.add.at(counts, (labels[used], obs_class[used]), 1.0)
        counts[:, 0] = 1.0 if overwrite else counts[:, 0] + doubt
        return counts

    def last(labels, obs_class, *sizes):
        counts = truth(labels, obs_class, *sizes)
        np.add.at(counts, (labels[labels < 0], obs_class[labels < 0] + 1), 1.0)
        return counts

    mistakes = {
        "column 0 holds no false-positive vote; every object has one from the start": lambda *t: (
            truth(*t) * (np.arange(t[3] + 1) > 0)
        ),
        "several votes for one entry count once: votes[i, c] += 1 with arrays of indices forgets repetitions": (
            lambda *t: (truth(*t) > 0).astype(float)
        ),
        "class c belongs in column c + 1, because column 0 is taken": left,
        "class c belongs in column c + 1; class 0 votes for nothing there": lambda *t: left(*t, doubt=1.0),
        "class c belongs in column c + 1; class 0 is lost": lambda *t: left(*t, overwrite=True),
        "a label of -1 means no object, and casts no vote; as an index it means the last row": last,
        "the column of the false-positive vote is missing: C classes need C + 1 columns": lambda *t: truth(*t)[:, 1:],
        "rows and columns are exchanged: one row for each object": lambda *t: truth(*t).T,
    }
    part = Part("the votes", mistakes, exactly, hint=lambda a, _: f"some count is off: they add up to {a[0].sum():g}")
    praise = "every row is one object's beta, and the first column doubts that there is anything at all"
    return check_function(function, truth, part, *count_votes_inputs(), praise)


@exercise("05", 2, of=5)
def check_class_posterior(function: Callable) -> Verdict:
    """Exercise 2: ``(K, C+1) votes -> (K, C+1)`` probabilities."""

    def truth(votes):
        return class_posterior(votes)

    def classes(votes):
        return np.where(np.arange(votes.shape[1]) > 0, votes, 0.0)

    mistakes = {
        "you divided by the votes without the false-positive vote; it counts among them": lambda v: (
            v / classes(v).sum(axis=1, keepdims=True)
        ),
        "the false-positive vote has been left out altogether": lambda v: (
            classes(v) / classes(v).sum(axis=1, keepdims=True)
        ),
        "the columns add up to 1; each object, a row, must": lambda v: v / v.sum(axis=0),
        "everything together adds up to 1; each object, a row, must": lambda v: v / v.sum(),
        "that is a softmax: votes are counts, and need no exponential": lambda v: (
            np.exp(v) / np.exp(v).sum(axis=1, keepdims=True)
        ),
        "that is the mode of Dir(votes); asked is votes over their sum": lambda v: (
            (v - 1) / np.maximum((v - 1).sum(axis=1, keepdims=True), 1e-300)
        ),
    }
    rng = fresh()
    trials = [(_some_votes(rng, *shape),) for shape in ((4, 4), (3, 6), (5, 3), (3, 3))]
    edges = {
        "with one object": [(_some_votes(rng, 1, 4),)],
        "with no object": [(np.empty((0, 4)),)],
        "with an object without a sighting": [(np.array([[1.0, 0.0, 0.0], [1.0, 2.0, 0.0]]),)],
        "with thousands of votes": [(_some_votes(rng, 3, 4) * [1, 1e3, 1e4, 1e5],)],
    }
    part = Part("the posterior", mistakes, hint=lambda a, _: f"the first row adds up to {a[0][0].sum():.3f}")
    return check_function(function, truth, part, trials, edges, "each row adds up to 1, the doubt included")


@exercise("05", 3, of=5)
def check_false_positives(function: Callable) -> Verdict:
    """Exercise 3: ``(votes, epsilon) -> (K,)`` bool, True for a false positive."""

    def truth(votes, epsilon):
        return association.false_positives(votes, epsilon)

    def doubt(votes):
        return class_posterior(votes)[:, 0]

    mistakes = {
        "True must mark what is rather nothing; yours marks what is kept": lambda v, e: doubt(v) <= e,
        "a probability equal to epsilon does not exceed it": lambda v, e: doubt(v) >= e,
        "the vote itself, 1, is compared with epsilon; its probability is to be": lambda v, e: v[:, 0] > e,
        "the doubt is 1 / (m + 1), not 1 / m: it has a vote of its own in the sum": lambda v, e: (
            1 / v[:, 1:].sum(axis=1) > e
        ),
        "only the most common class is counted; all votes of the object stand in the sum": lambda v, e: (
            1 / (1 + v[:, 1:].max(axis=1)) > e
        ),
    }
    rng = fresh()
    # At the thresholds that are powers of two an object can be exactly at it, whatever the rounding.
    trials = [(_few_votes(rng), epsilon) for epsilon in (0.5, 0.49, 0.3, 0.25, 0.2, 0.125, *rng.uniform(0.05, 0.6, 8))]
    edges = {
        "with an object without a sighting": [(np.array([[1.0, 0.0, 0.0], [1.0, 3.0, 0.0]]), 0.4)],
        "with no object": [(np.empty((0, 3)), 0.4)],
        "with one object": [(np.array([[1.0, 1.0, 1.0]]), 0.3)],
        "with thousands of votes": [(np.array([[1.0, 5e3, 4e3], [1.0, 0.0, 2.0]]), 1e-3)],
    }
    part = Part("the answer", mistakes, exactly, hint=_not_truth_values)
    praise = "an object is believed once enough sightings agree that something is there"
    return check_function(function, truth, part, trials, edges, praise)


def _not_truth_values(answers: list, expected: list) -> str:
    every = np.concatenate(answers)
    odd = every[~np.isin(every, [0, 1])]
    return f"True or False for each object is asked, yours holds {odd[0]:.3f}" if len(odd) else ""


def _some_votes(rng: np.random.Generator, num_objects: int, num_columns: int) -> np.ndarray:
    votes = rng.integers(1, 9, (num_objects, num_columns)).astype(float)
    votes[:, 0] = 1.0
    return votes


def _few_votes(rng: np.random.Generator) -> np.ndarray:
    """Objects of 1, 2, 3, 5, 7 and 9 sightings, one of them with votes for two classes; (6, 4), in any order."""
    votes = np.zeros((6, 4))
    votes[:, 0], votes[np.arange(6), rng.integers(1, 4, 6)] = 1.0, [1, 2, 3, 3, 7, 9]
    votes[3, 1 + np.argmin(votes[3, 1:])] += 2.0
    return rng.permutation(votes)


@exercise("05", 4, of=5)
def check_log_density(function: Callable) -> Verdict:
    """Exercise 4: ``(x, a) -> number``, the logarithm of the Dirichlet density."""
    from scipy.special import gammaln
    from scipy.stats import dirichlet

    def truth(x, a):
        return dirichlet.logpdf(x, a)

    def log_beta(a):
        return gammaln(a).sum() - gammaln(a.sum())

    mistakes = {
        "the factor 1 / B(a) is missing": lambda x, a: truth(x, a) + log_beta(a),
        "B(a) stands under the fraction: its logarithm is subtracted": lambda x, a: truth(x, a) + 2 * log_beta(a),
        "the exponents are a_i - 1, not a_i": lambda x, a: (a * np.log(x)).sum() - log_beta(a),
        "that is the density; its logarithm is asked": lambda x, a: np.exp(truth(x, a)),
        "B(a) is the product of all Gamma(a_i) over Gamma of their sum; the sum is missing": lambda x, a: (
            truth(x, a) - gammaln(a.sum())
        ),
    }
    rng = fresh()
    trials = [(rng.dirichlet(np.full(n, 3.0)), rng.uniform(0.5, 6.0, n)) for n in (3, 4, 2, 3, 5)]
    many = [(rng.dirichlet(a), a) for a in (np.array([400.0, 300.0, 1.0]) + rng.uniform(0, 9, 3), np.full(4, 5e4))]
    edges = {
        "with all a_i = 1, where it is the same number at every point": [(rng.dirichlet(np.ones(3)), np.ones(3))],
        "with hundreds of votes or more, where Gamma(400) is too large a number: work with its logarithm": many,
    }
    part = Part("the log density", mistakes, _log_close, hint="with all a_i = 1 it must be the same number everywhere")
    praise = "a number also for hundreds and for thousands of votes"
    return check_function(function, truth, part, trials, edges, praise, drawings.log_density())


def _log_close(answer: np.ndarray, truth, tolerance: float) -> bool:
    """A logarithm near zero is the difference of large numbers: half a millionth is as good as none."""
    return close(answer, truth, tolerance) or (np.shape(truth) == () and abs(float(answer) - truth) < tolerance)


@exercise("05", 5, of=5)
def check_true_class(function: Callable) -> Verdict:
    """Exercise 5: ``(votes (C,), confusion (C, C)) -> (C,)``, the posterior of the true class given the reports."""

    def truth(votes, confusion):
        return true_class(votes, confusion)

    def by_sum(votes, confusion):
        return confusion @ votes / (confusion @ votes).sum()

    mistakes = {
        "rows and columns are exchanged: row c of the matrix belongs to the true class c": lambda v, c: truth(v, c.T),
        "the confusion matrix is not used: these are the shares of the votes": lambda v, c: v / v.sum(),
        "the probabilities of the reports are added; independent reports multiply": by_sum,
        "they do not add up to 1: divide by their sum": lambda v, c: np.exp(v @ np.log(c).T),
        "that is the probability of the next report; asked is the true class": lambda v, c: truth(v, c) @ c,
        "each report counts once, however often it came: the votes are exponents": lambda v, c: truth(
            (v > 0).astype(float), c
        ),
    }
    rng = fresh()
    trials = [(rng.integers(0, 4, n) + 2.0 * np.eye(n)[0], _confusion(rng, n)) for n in (3, 4, 3, 2)]
    pair = np.array([[0.7, 0.3], [0.4, 0.6]])
    # As many votes as make both classes possible, so that neither is lost in rounding.
    count, balance = int(rng.integers(3000, 9000)), np.log(0.7 / 0.4) / np.log(0.6 / 0.3)
    edges = {
        "without a vote, when all classes are alike": [(np.zeros(3), _confusion(rng, 3))],
        "with thousands of votes, whose product is too small for a number: add logarithms, take off the largest": [
            (np.array([3000.0, 1500.0]), pair),
            (np.array([count, round(count * balance)], dtype=float), pair),
        ],
        "with thousands of votes for one class alone: it is the largest logarithm that must become 0": [
            (np.array([4000.0, 0.0]), pair),
            (np.array([0.0, float(count), 0.0]), _confusion(rng, 3)),
        ],
    }
    hint = "they must add up to 1, and the product runs over the reports"
    part = Part("the posterior", mistakes, hint=hint)
    return check_function(
        function, truth, part, trials, edges, "hard votes only count; these also know how the detector errs"
    )


def _confusion(rng: np.random.Generator, size: int) -> np.ndarray:
    return 0.6 * np.eye(size) + 0.4 * rng.dirichlet(np.ones(size), size)


def true_class(votes: np.ndarray, confusion: np.ndarray) -> np.ndarray:
    """Posterior of the true class under a uniform prior: ``prod_u confusion[c, u]^votes[u]``, normalised.

    Args:
        votes: (..., C) how often each class was reported.
        confusion: (C, C) positive; row c is the distribution of the report when the truth is c.
    """
    log_likelihood = votes @ np.log(confusion).T
    posterior = np.exp(log_likelihood - log_likelihood.max(axis=-1, keepdims=True))
    return posterior / posterior.sum(axis=-1, keepdims=True)
