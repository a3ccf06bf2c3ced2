"""Checks of lesson 11: a partition's prior, a Gibbs move, poses eliminated, samples counted, a merger accepted."""

import math
from collections.abc import Callable
from functools import partial

import numpy as np

from npslam_teach.association.dirichlet_process import log_partition_prior
from npslam_teach.course.checking import Verdict, answer_of, as_array, judge, judge_function, right, wrong


def check_crp_probability(crp_probability: Callable) -> Verdict:
    """Exercise 1: ``crp_probability(counts, alpha)``, a number."""

    def true_value(counts, alpha):
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
    counts = ([3], [1, 1, 2], [4, 1], [2, 2, 3], [1, 1, 1, 1])
    trials = [(np.array(c), a) for c in counts for a in (0.4, 1.0, 2.5)]
    return _judge(
        "your number", crp_probability, trials, true_value, mistakes, "nothing in it asks who came first or sat where"
    )


def check_move_probabilities(move_probabilities: Callable) -> Verdict:
    """Exercise 2: ``move_probabilities(log_p, labels, k)``, (K+1,), the last for a new object."""

    def logs(log_p, labels, k, taken_out=True):
        others = np.unique(np.delete(labels, k) if taken_out else labels, return_inverse=True)[1]
        rest = others if taken_out else np.delete(others, k)
        places = range(others.max() + 2)
        return np.array([log_p(np.unique(np.insert(rest, k, i), return_inverse=True)[1]) for i in places])

    def true_value(*trial):
        w = np.exp(logs(*trial) - logs(*trial).max())
        return w / w.sum()

    mistakes = {
        "these are logarithms: take exp before you divide by the sum": lambda *t: logs(*t) / logs(*t).sum(),
        "these are logarithms of the weights: take exp, and divide by the sum": logs,
        "they do not add up to one: divide by the sum": lambda *t: np.exp(logs(*t) - logs(*t).max()),
        "a new object comes last, not first": lambda *t: np.roll(true_value(*t), 1),
        "the weights are right but their order is reversed": lambda *t: true_value(*t)[::-1],
        "the sighting was not taken out first: its own object, if it is alone there, counts twice": (
            lambda *t: _softmax(logs(*t, taken_out=False))
        ),
        "all places are alike to you: log_p is not used": lambda *t: np.full(len(logs(*t)), 1 / len(logs(*t))),
        "a new object has no place in your answer: K objects and one more": lambda *t: _softmax(logs(*t)[:-1]),
    }
    rng = np.random.default_rng(4)
    labelings = ([0, 0, 1, 1, 2], [0, 1, 0, 2, 1], [0, 1, 2, 3, 4], [0, 0, 0, 0, 0], [0, 1, 1, 2, 0])
    trials = [(_some_log_p(rng), np.array(labels), k) for labels in labelings for k in (0, 3)]
    praise = "every place is weighed by the whole posterior, and no distance was compared with a threshold"
    return _judge("your vector", move_probabilities, trials, true_value, mistakes, praise)


def check_eliminate(eliminate: Callable) -> Verdict:
    """Exercise 3: ``eliminate(H, b, num_poses)``: information (m, m) and gradient (m,) of the landmarks alone."""
    rng = np.random.default_rng(5)
    for n, m in ((1, 2), (3, 4), (6, 2), (2, 5)):
        root = rng.normal(size=(n + m, n + m))
        h, b = root @ root.T + 0.3 * np.eye(n + m), rng.normal(size=n + m)
        answer, verdict = answer_of(eliminate, h.copy(), b.copy(), n)
        verdict = verdict or _mistake_in_elimination(answer, h, b, n)
        if verdict is not None:
            return verdict
    return right("the poses are gone, and everything that they tied together is still tied")


def _mistake_in_elimination(answer, h: np.ndarray, b: np.ndarray, n: int) -> Verdict | None:
    if not (isinstance(answer, tuple | list) and len(answer) == 2):
        return wrong("return two things: the information and the gradient")
    xx, xl, ll = h[:n, :n], h[:n, n:], h[n:, n:]
    solved = np.linalg.solve(xx, np.column_stack([xl, b[:n]]))
    information, gradient = ll - xl.T @ solved[:, :-1], b[n:] - xl.T @ solved[:, -1]
    of_information = {
        "the landmarks' own block alone: so it would be if the poses were known exactly": ll,
        "what the poses take away is added: poses that are not known make the map less sure, not surer": (
            2 * ll - information
        ),
        "multiplied by H_xx instead of its inverse": ll - xl.T @ xx @ xl,
        "the inverse is taken number by number: a matrix has an inverse as a whole": ll - xl.T @ (1 / xx) @ xl,
        "that is the covariance of the landmarks; its inverse is the information": np.linalg.inv(h)[n:, n:],
    }
    of_gradient = {
        "the landmarks' own part of b alone: what the poses want has been forgotten": b[n:],
        "the sign of what the poses add to the gradient is wrong": 2 * b[n:] - gradient,
        "minus the gradient: keep the sign of b": -gradient,
    }
    hint = "the first num_poses rows and columns of H are those of the poses"
    parts = (("your information", information, of_information), ("your gradient", gradient, of_gradient))
    return _judge_parts(answer, parts, hint)


def check_summarise(summarise: Callable) -> Verdict:
    """Exercise 4: ``summarise(partitions, number)``: a probability, and (N, N) how often two are one object."""
    rng = np.random.default_rng(6)
    for count, size in ((40, 5), (17, 3), (60, 7)):
        drawn = [np.unique(rng.integers(0, 4, size), return_inverse=True)[1] for _ in range(count)]
        for number in (1, 2, 3, 4):
            answer, verdict = answer_of(summarise, np.array(drawn), number)
            verdict = verdict or _mistake_in_summary(answer, np.array(drawn), number)
            if verdict is not None:
                return verdict
    return right("two numbers that no single answer has: how many, and which pairs, with what probability")


def _mistake_in_summary(answer, partitions: np.ndarray, number: int) -> Verdict | None:
    if not (isinstance(answer, tuple | list) and len(answer) == 2):
        return wrong("return two things: the probability of the number, and the matrix of pairs")
    most = partitions.max(axis=1)
    share = float(np.mean(most + 1 == number))
    together = (partitions[:, :, None] == partitions[:, None, :]).mean(axis=0)
    of_share = {
        "labels count from 0: three objects have labels 0, 1 and 2": np.mean(most == number),
        "that is how many samples have so many objects; divide by the number of samples": share * len(most),
        "so many objects exactly, not at most": np.mean(most + 1 <= number),
        "so many objects exactly, not at least": np.mean(most + 1 >= number),
    }
    of_pairs = {
        "that is how often; divide by the number of samples": together * len(partitions),
        "a tracklet is one object with itself: the diagonal is 1": together - np.eye(len(together)),
        "that is how often they are apart": 1 - together,
        "one sample alone, the last, is no probability": (partitions[-1][:, None] == partitions[-1]).astype(float),
        "one sample alone, the first, is no probability": (partitions[0][:, None] == partitions[0]).astype(float),
    }
    hint = "compare labels within a sample, then average over the samples"
    parts = (("your probability", np.array(share), of_share), ("your matrix", together, of_pairs))
    return _judge_parts(answer, parts, hint)


def _judge_parts(answer, parts: tuple, hint: str) -> Verdict | None:
    """None if every part of the answer is right; else a verdict on the first that is not.

    Args:
        answer: as many parts.
        parts: of each the name, the right value, and by message what a mistake gives.
        hint: for an unknown mistake.
    """
    for part, (name, wanted, mistakes) in zip(answer, parts, strict=True):
        if part is ...:
            return wrong(f"{name} is still the dots")
        array, verdict = as_array(name, part, wanted.shape)
        if verdict is not None:
            return verdict
        verdict = judge(array, wanted, mistakes, f"{name} is off: {hint}")
        if verdict is not None:
            return verdict
    return None


def check_merge_acceptance(merge_acceptance: Callable) -> Verdict:
    """Exercise 5: ``merge_acceptance(log_apart, log_merged, log_weights, sits)``, a probability."""

    def log_shares(log_weights, sits):
        shares = log_weights - np.logaddexp(log_weights[:, 0], log_weights[:, 1])[:, None]
        return shares[np.arange(len(sits)), sits.astype(int)]

    def ratio(log_apart, log_merged, log_weights, sits, way_back=1.0, posterior=1.0):
        log_ratio = posterior * (log_merged - log_apart) + way_back * log_shares(log_weights, sits).sum()
        return math.exp(min(log_ratio, 700.0))

    def true_value(*trial):
        return min(1.0, ratio(*trial))

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
        "that is the logarithm; the probability is asked for": lambda *t: math.log(true_value(*t)),
    }
    rng = np.random.default_rng(7)
    trials = []
    for n in (1, 2, 3, 5, 2, 4):
        apart, weights, sits = rng.normal(-20, 3), rng.normal(0, 1.5, (n, 2)), rng.integers(0, 2, n)
        trials += [(apart, apart + gain, weights, sits) for gain in (-1.0, 0.7, 9.0)]
    praise = "with this number the merger and the split come in exactly as often as the posterior asks for"
    return _judge("your number", merge_acceptance, trials, true_value, mistakes, praise)


def _some_log_p(rng: np.random.Generator) -> Callable:
    """A log posterior of labels (N,), far from zero, as real ones are, and any two partitions apart."""
    tie, cost = rng.normal(0, 1, (9, 9)), rng.uniform(0.5, 2)

    def log_p(labels) -> float:
        labels = np.asarray(labels)
        if labels.ndim != 1 or set(labels.tolist()) != set(range(len(set(labels.tolist())))):
            raise ValueError(f"log_p wants labels from 0 without gaps, got {labels.tolist()}")
        same = labels[:, None] == labels
        return float(-900.0 - cost * (labels.max() + 1) + tie[: len(labels), : len(labels)][same].sum())

    return log_p


def _softmax(log_weights: np.ndarray) -> np.ndarray:
    weights = np.exp(log_weights - log_weights.max())
    return weights / weights.sum()


def _judge(name: str, function: Callable, trials: list, truth: Callable, mistakes: dict, praise: str) -> Verdict:
    def for_example(answers, expected):
        pairs = zip(answers, expected, trials, strict=True)
        off = next(trial for a, e, trial in pairs if np.shape(a) != np.shape(e) or not np.allclose(a, e))
        shown = [np.array2string(np.round(np.array(x), 2), separator=", ") for x in off if not callable(x)]
        return f"{name} is off, for example for {', '.join(shown).replace(chr(10), '')}"

    return judge_function(name, function, trials, truth, mistakes, praise, for_example)
