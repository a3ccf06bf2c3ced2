"""Checks of lesson 05: votes, class posterior, false positives, the Dirichlet density, and a detector that errs."""

import numpy as np

from npslam_teach.association import class_posterior, count_votes, false_positives
from npslam_teach.course.checking import Verdict, answer_of, array_from, as_array, judge, right, wrong


def check_count_votes(function) -> Verdict:
    """Exercise 1: ``(labels, obs_class, num_objects, num_classes) -> (K, C+1)``."""
    rng = np.random.default_rng(51)
    for num_objects, num_classes in ((4, 2), (3, 5), (2, 2)):
        labels = np.append(rng.integers(-1, num_objects, 14), [-1, 0, 0])
        obs_class = np.append(rng.integers(0, num_classes, 14), [0, 1, 1])
        sizes = num_objects, num_classes
        answer, verdict = answer_of(function, labels.copy(), obs_class.copy(), *sizes)
        if verdict:
            return verdict
        array, verdict = as_array("the votes", answer, (num_objects, num_classes + 1))
        if verdict:
            return _wrong_shape(answer, verdict, sizes)
        verdict = _judged_votes(array, labels, obs_class, sizes)
        if verdict:
            return verdict
    return right("every row is one object's beta, and the first column doubts that there is anything at all")


def _wrong_shape(answer, verdict: Verdict, sizes: tuple) -> Verdict:
    num_objects, num_classes = sizes
    if as_array("", answer, (num_objects, num_classes))[1] is None:
        return wrong("the column of the false-positive vote is missing: C classes need C + 1 columns")
    if as_array("", answer, (num_classes + 1, num_objects))[1] is None:
        return wrong("rows and columns are exchanged: one row for each object")
    return verdict


def _judged_votes(answer, labels, obs_class, sizes: tuple) -> Verdict | None:
    exact = count_votes(labels, obs_class, *sizes)
    no_doubt = exact.copy()
    no_doubt[:, 0] = 0.0
    used = labels >= 0
    once = (exact > 0).astype(float)
    left = np.zeros_like(exact)
    np.add.at(left, (labels[used], obs_class[used]), 1.0)
    left_with_doubt = left.copy()
    left_with_doubt[:, 0] += 1.0
    overwritten = left.copy()
    overwritten[:, 0] = 1.0
    last = exact.copy()
    np.add.at(last, (labels[~used], obs_class[~used] + 1), 1.0)
    return judge(
        answer,
        exact,
        {
            "column 0 holds no false-positive vote; every object has one from the start": no_doubt,
            "several votes for one entry count once: votes[i, c] += 1 with arrays of indices forgets repetitions": once,
            "class c belongs in column c + 1, because column 0 is taken": left,
            "class c belongs in column c + 1; class 0 votes for nothing there": left_with_doubt,
            "class c belongs in column c + 1; class 0 is lost": overwritten,
            "a label of -1 means no object, and casts no vote; as an index it means the last row": last,
        },
        f"some count is off: your votes add up to {answer.sum():g}",
    )


def check_class_posterior(function) -> Verdict:
    """Exercise 2: ``(K, C+1) votes -> (K, C+1)`` probabilities."""
    rng = np.random.default_rng(52)
    for num_objects, num_columns in ((4, 4), (3, 6), (5, 3)):
        votes = rng.integers(1, 9, (num_objects, num_columns)).astype(float)
        votes[:, 0] = 1.0
        array, verdict = array_from("the posterior", function, votes.shape, votes.copy())
        if verdict:
            return verdict
        verdict = _judged_posterior(array, votes)
        if verdict:
            return verdict
    return right("each row adds up to 1, the doubt included")


def _judged_posterior(answer, votes) -> Verdict | None:
    above = votes - 1
    classes = np.where(np.arange(votes.shape[1]) > 0, votes, 0.0)
    softmax = np.exp(votes) / np.exp(votes).sum(axis=1, keepdims=True)
    return judge(
        answer,
        class_posterior(votes),
        {
            "you divided by the votes without the false-positive vote; it counts among them": votes
            / classes.sum(axis=1, keepdims=True),
            "the false-positive vote has been left out altogether": classes / classes.sum(axis=1, keepdims=True),
            "the columns add up to 1; each object, a row, must": votes / votes.sum(axis=0),
            "everything together adds up to 1; each object, a row, must": votes / votes.sum(),
            "that is a softmax: votes are counts, and need no exponential": softmax,
            "that is the mode of Dir(votes); asked is votes over their sum": above
            / np.maximum(above.sum(axis=1, keepdims=True), 1e-300),
        },
        f"the first row adds up to {answer[0].sum():.3f}, and some probability is off",
    )


def check_false_positives(function) -> Verdict:
    """Exercise 3: ``(votes, epsilon) -> (K,)`` bool, True for a false positive."""
    votes = np.zeros((5, 4))
    votes[:, 0], votes[np.arange(5), [1, 2, 3, 1, 2]] = 1.0, [1, 2, 3, 5, 9]
    votes[3, 2] = 2.0
    answers = []
    for epsilon in (0.5, 0.49, 0.3, 0.25, 0.15):
        array, verdict = array_from("the answer", function, (5,), votes.copy(), epsilon)
        if verdict:
            return verdict
        if not np.isin(array, [0, 1]).all():
            return wrong(f"True or False for each object is asked, yours holds {array[~np.isin(array, [0, 1])][0]:.3f}")
        answers.append((epsilon, array.astype(bool)))
    if all((answer == false_positives(votes, epsilon)).all() for epsilon, answer in answers):
        return right("an object is believed once enough sightings agree that something is there")
    return _wrong_false_positives(answers, votes)


def _wrong_false_positives(answers: list, votes) -> Verdict:
    doubt, seen = class_posterior(votes)[:, 0], votes[:, 1:].sum(axis=1)
    rules = {
        "True must mark what is rather nothing; yours marks what is kept": lambda epsilon: doubt <= epsilon,
        "a probability equal to epsilon does not exceed it": lambda epsilon: doubt >= epsilon,
        "the vote itself, 1, is compared with epsilon; its probability is to be": lambda epsilon: votes[:, 0] > epsilon,
        "the doubt is 1 / (m + 1), not 1 / m: it has a vote of its own in the sum": lambda epsilon: 1 / seen > epsilon,
        "only the most common class is counted; all votes of the object stand in the sum": lambda epsilon: (
            1 / (1 + votes[:, 1:].max(axis=1)) > epsilon
        ),
    }
    for message, rule in rules.items():
        if all((answer == rule(epsilon)).all() for epsilon, answer in answers):
            return wrong(message)
    epsilon, answer = next((e, a) for e, a in answers if (a != false_positives(votes, e)).any())
    i = np.flatnonzero(answer != false_positives(votes, epsilon))[0]
    return wrong(f"an object of {seen[i]:g} sightings with epsilon {epsilon} is not {answer[i]}")


def check_log_density(function) -> Verdict:
    """Exercise 4: ``(point, concentration) -> number``, the logarithm of the Dirichlet density."""
    from scipy.stats import dirichlet

    rng = np.random.default_rng(54)
    for size in (3, 4, 2):
        concentration, point = rng.uniform(0.5, 6.0, size), rng.dirichlet(np.full(size, 3.0))
        array, verdict = array_from("the log density", function, (), point.copy(), concentration.copy())
        if verdict:
            return verdict
        verdict = _judged_log_density(array, point, concentration)
        if verdict:
            return verdict
    many = np.array([400.0, 300.0, 1.0])
    point = np.array([0.57, 0.42, 0.01])
    if not _gives(dirichlet.logpdf(point, many), function, point, many):
        return wrong("with 700 votes it breaks: Gamma(400) is too large a number, so work with its logarithm")
    return right("a number that any count of votes can be put into")


def _judged_log_density(answer, x, a) -> Verdict | None:
    from scipy.special import gammaln
    from scipy.stats import dirichlet

    log_beta = gammaln(a).sum() - gammaln(a.sum())
    exact = ((a - 1) * np.log(x)).sum() - log_beta
    return judge(
        answer,
        dirichlet.logpdf(x, a),
        {
            "the factor 1 / B(a) is missing": exact + log_beta,
            "B(a) stands under the fraction: its logarithm is subtracted": exact + 2 * log_beta,
            "the exponents are a_i - 1, not a_i": (a * np.log(x)).sum() - log_beta,
            "that is the density; its logarithm is asked": np.exp(exact),
            "B(a) is the product of all Gamma(a_i) over Gamma of their sum; the sum is missing": exact
            - gammaln(a.sum()),
        },
        "it is off; with all a_i = 1 it must be the same number at every point",
    )


def check_true_class(function) -> Verdict:
    """Exercise 5: ``(votes (C,), confusion (C, C)) -> (C,)``, the posterior of the true class given the reports."""
    rng = np.random.default_rng(55)
    for size in (3, 4, 3):
        confusion = 0.6 * np.eye(size) + 0.4 * rng.dirichlet(np.ones(size), size)
        votes = rng.integers(0, 4, size).astype(float) + np.eye(size)[0]
        array, verdict = array_from("the posterior", function, (size,), votes.copy(), confusion.copy())
        if verdict:
            return verdict
        verdict = _judged_true_class(array, votes, confusion)
        if verdict:
            return verdict
    confusion, votes = np.array([[0.7, 0.3], [0.4, 0.6]]), np.array([3000.0, 1500.0])
    if not _gives(true_class(votes, confusion), function, votes, confusion):
        return wrong("with 4500 votes the product is too small for a number: add logarithms, and take off the largest")
    return right("hard votes only count; these also know how the detector errs")


def true_class(votes: np.ndarray, confusion: np.ndarray) -> np.ndarray:
    """Posterior of the true class under a uniform prior: ``prod_u confusion[c, u]^votes[u]``, normalised.

    Args:
        votes: (..., C) how often each class was reported.
        confusion: (C, C) positive; row c is the distribution of the report when the truth is c.
    """
    log_likelihood = votes @ np.log(confusion).T
    posterior = np.exp(log_likelihood - log_likelihood.max(axis=-1, keepdims=True))
    return posterior / posterior.sum(axis=-1, keepdims=True)


def _judged_true_class(answer, votes, confusion) -> Verdict | None:
    by_column = true_class(votes, confusion.T)
    product = np.exp(votes @ np.log(confusion).T)
    return judge(
        answer,
        true_class(votes, confusion),
        {
            "rows and columns are exchanged: row c of the matrix belongs to the true class c": by_column,
            "the confusion matrix is not used: these are the shares of the votes": votes / votes.sum(),
            "the probabilities of the reports are added; independent reports multiply": confusion
            @ votes
            / (confusion @ votes).sum(),
            "they do not add up to 1: divide by their sum": product,
            "that is the probability of the next report; asked is the true class": true_class(votes, confusion)
            @ confusion,
            "each report counts once, however often it came: the votes are exponents": true_class(
                (votes > 0).astype(float), confusion
            ),
        },
        f"your probabilities add up to {answer.sum():.3f}, and one of them is off",
    )


def _gives(expected, function, *arguments) -> bool:
    """Whether the function is right in an extreme case, in which it may overflow."""
    with np.errstate(all="ignore"):
        array, verdict = array_from("the answer", function, np.shape(expected), *arguments)
    return verdict is None and np.allclose(array, expected)
