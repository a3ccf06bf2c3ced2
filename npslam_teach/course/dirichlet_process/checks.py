"""Checks of lesson 04: weights, the reweighting, the decision, the restaurant, and a whole sweep."""

import math

import numpy as np

from npslam_teach.association import association_weights, decide, expected_num_objects, reweight, sweep
from npslam_teach.course.checking import Verdict, answer_of, array_from, as_array, judge, right, wrong


def check_weights(function) -> Verdict:
    """Exercise 1: ``(votes, distance, kernel_std) -> (K,)`` weights."""
    rng = np.random.default_rng(41)
    for _ in range(3):
        votes, distance = rng.integers(1, 6, 5).astype(float), rng.uniform(0.2, 1.5, 5)
        votes[rng.integers(5)] = 0.0
        kernel_std = rng.uniform(0.4, 0.8)
        array, shape_verdict = array_from("the weights", function, (5,), votes.copy(), distance.copy(), kernel_std)
        if shape_verdict:
            return shape_verdict
        verdict = _judged_weights(array, votes, distance, kernel_std)
        if verdict:
            return verdict
    return right("votes say how rich an object is, and distance fades its pull")


def _judged_weights(answer, votes, distance, s) -> Verdict | None:
    exact = association_weights(votes, distance, s)
    near = np.exp(-(distance**2) / (2 * s**2))
    return judge(
        answer,
        exact,
        {
            "the votes are missing: a sighting of another class has the same weight as one of its own": near,
            "the distance is not squared in the exponent": votes * np.exp(-distance / (2 * s**2)),
            "the kernel width is not squared in the exponent": votes * np.exp(-(distance**2) / (2 * s)),
            "the 2 under the fraction is missing": votes * np.exp(-(distance**2) / s**2),
            "the exponent has the wrong sign: weights grow with distance": votes / near,
            "these are shares, not weights: they add up to 1 before alpha has come in": exact / exact.sum(),
        },
        "some weight is off; try one vote at distance zero, which must weigh 1",
    )


def check_reweight(function) -> Verdict:
    """Exercise 2: ``(weights, alpha) -> (K+1,)`` probabilities, the last one "new"."""
    rng = np.random.default_rng(42)
    for num_objects in (4, 1, 3):
        weights, alpha = rng.uniform(0.1, 3.0, num_objects), rng.uniform(0.3, 2.0)
        answer, verdict = answer_of(function, weights.copy(), alpha)
        if verdict:
            return verdict
        if isinstance(answer, np.ndarray | list | tuple) and len(answer) == num_objects:
            return wrong(f'there are {num_objects} objects and one more possibility, "new", which has no entry')
        array, verdict = as_array("the probabilities", answer, (num_objects + 1,))
        if verdict:
            return verdict
        verdict = _judged_reweight(array, weights, alpha)
        if verdict:
            return verdict
    return right("one more chair at the table, and everybody moves up a little")


def _judged_reweight(answer, weights, alpha) -> Verdict | None:
    exact, total = reweight(weights, alpha), weights.sum()
    both = np.append(weights, alpha)
    return judge(
        answer,
        exact,
        {
            "the sum under the fraction leaves alpha out, so the probabilities add up to more than 1": both / total,
            "these are the weights themselves: nothing was divided by their sum": both,
            '"new" stands first; it belongs at the end': np.roll(exact, 1),
            "alpha is taken for a probability; it is a weight like the others, to be divided by the sum too": np.append(
                weights / (total + alpha), alpha
            ),
            'alpha is added to every object; only "new" has it': np.append(weights + alpha, alpha)
            / (total + alpha * len(both)),
        },
        f"the probabilities add up to {answer.sum():.3f}, and one of them is off",
    )


def check_decide(function) -> Verdict:
    """Exercise 3: ``(probabilities, threshold) -> index``, the number of objects meaning "new"."""
    rng = np.random.default_rng(43)
    cases = [(rng.dirichlet(np.full(5, 0.8)), threshold) for threshold in (None, 0.2, 0.4, 0.6) for _ in range(40)]
    cases += [(np.array([0.5, 0.0, 0.5]), None), (np.array([0.25, 0.5, 0.25]), 0.5)]  # ties
    cases += [(np.array([0.1, 0.3, 0.6]), 0.2), (np.array([0.1, 0.45, 0.25, 0.2]), 0.5)]
    answers = []
    for probabilities, threshold in cases:
        answer, verdict = answer_of(function, probabilities.copy(), threshold)
        if verdict:
            return verdict
        if not isinstance(answer, int | np.integer) or isinstance(answer, bool):
            return wrong(f"expected the index of an object, a whole number, yours is {type(answer).__name__}")
        answers.append(int(answer))
    if answers == [decide(*case) for case in cases]:
        return right("one function serves the authors' rule and the deck's")
    return _wrong_decision(answers, cases)


def _wrong_decision(answers: list[int], cases: list) -> Verdict:
    def everything(p, threshold):
        return int(np.argmax(p)) if threshold is None or p.max() > threshold else len(p) - 1

    def at_least(p, threshold):
        best, bar = int(np.argmax(p[:-1])), p[-1] if threshold is None else threshold
        return best if p[best] >= bar else len(p) - 1

    def one_short(p, threshold):
        chosen = decide(p, threshold)
        return chosen - 1 if chosen == len(p) - 1 else chosen

    mistakes = {
        "the threshold is not used: only the most probable wins": lambda p, threshold: decide(p),
        'with a threshold "new" still takes part; only the objects are to be held against the bar': everything,
        "a tie must open a new object: the best has to exceed the bar, not to reach it": at_least,
        '"new" is the number of objects, one past the last object': one_short,
        "a new object is never opened": lambda p, threshold: int(np.argmax(p[:-1])),
    }
    for message, rule in mistakes.items():
        if answers == [rule(*case) for case in cases]:
            return wrong(message)
    (p, threshold), answer = next((c, a) for c, a in zip(cases, answers, strict=True) if a != decide(*c))
    return wrong(f"for {np.round(p, 2).tolist()} with threshold {threshold} the answer is not {answer}")


def check_expected_tables(function) -> Verdict:
    """Exercise 4: ``(num_guests, alpha) -> number``."""
    for num_guests, alpha in ((1, 0.9), (8, 0.5), (60, 3.0), (1098, 0.9)):
        array, verdict = array_from("the expected number", function, (), num_guests, alpha)
        if verdict:
            return verdict
        verdict = _judged_tables(float(array), num_guests, alpha)
        if verdict:
            return verdict
    return right("the number of tables grows with every guest, ever more slowly, and never stops")


def _judged_tables(answer: float, n: int, alpha: float) -> Verdict | None:
    late = alpha / (alpha + np.arange(1, n + 1))
    return judge(
        np.array(answer),
        np.array(expected_num_objects(n, alpha)),
        {
            "the first guest comes when 0 others sit there, and opens a table for certain": late.sum(),
            "that is the chance of the last guest alone; add up those of all": alpha / (alpha + n - 1),
            "that is what the logarithm comes near to with many guests; the sum itself is asked": alpha
            * math.log(1 + n / alpha),
            "alpha is missing above the fraction": (1 / (alpha + np.arange(n))).sum(),
            "one guest too many: n guests meet 0 to n - 1 others": alpha / (alpha + n) + late[:-1].sum() + 1,
        },
        f"for {n} guests and alpha {alpha} it is not {answer:.4f}; one guest needs exactly 1 table",
    )


def check_sweep(function) -> Verdict:
    """Exercise 5: ``(labels, landmarks, xy, obs_class, alpha) -> (M,)`` labels, grouped as ``sweep`` does."""
    rng = np.random.default_rng(44)
    scenes = [_scene(rng, start) for start in ("alone", "grouped") * 4]
    groupings = []
    for scene in scenes:
        array, verdict = array_from(
            "the labels", function, scene[0].shape, *(np.copy(part) for part in scene[:-1]), scene[-1]
        )
        if verdict:
            return verdict
        groupings.append(_grouping(array))
    if groupings == [_grouping(sweep(*scene).labels) for scene in scenes]:
        return right("that is the heart of the method; lesson 06 takes turns between it and the pose graph")
    for message, mistake in _SWEEP_MISTAKES.items():
        if groupings == [_grouping(_sweep_with(mistake, *scene)) for scene in scenes]:
            return wrong(message)
    off = [k for k, scene in enumerate(scenes) if groupings[k] != _grouping(sweep(*scene).labels)]
    found, expected = len(set(groupings[off[0]])), len(set(_grouping(sweep(*scenes[off[0]]).labels)))
    return wrong(
        f"{len(off)} of {len(scenes)} random scenes are grouped otherwise; in the first of them you have {found} "
        f"objects where there should be {expected}"
    )


_SWEEP_MISTAKES = {
    "a sighting must take its vote back before it is asked: it still votes for itself": "own vote",
    "the order matters, because each answer counts for the next question: begin with the last sighting": "order",
    "all were asked with the votes of the beginning; each answer must count for the next question": "old votes",
    "the class is left out: votes of another class must count for nothing": "class",
    "the best match is taken however bad it is: a new object is never opened": "never new",
}


def _scene(rng: np.random.Generator, start: str) -> tuple:
    """Observations around five places, as arguments of a sweep: each alone, or in groups that are partly wrong."""
    place = rng.integers(0, 5, 18)
    xy = rng.uniform(0.0, 2.0, (5, 2))[place] + rng.normal(size=(18, 2)) * 0.12
    obs_class = np.where(rng.random(18) < 0.8, place % 2, rng.integers(0, 2, 18))
    labels = np.arange(18) if start == "alone" else _numbered(np.where(rng.random(18) < 0.7, place, place % 3 + 5))
    landmarks = np.array([xy[labels == i].mean(axis=0) for i in range(labels.max() + 1)])
    return labels, landmarks, xy, obs_class, 0.6


def _numbered(labels: np.ndarray) -> np.ndarray:
    return np.unique(labels, return_inverse=True)[1]


def _grouping(labels: np.ndarray) -> tuple:
    """The partition, whatever its groups are called: for each observation the first one it is grouped with."""
    return tuple(int(np.argmax(labels == label)) for label in labels)


def _sweep_with(mistake: str, labels, landmarks, xy, obs_class, alpha) -> np.ndarray:
    """A sweep with one typical mistake in it."""
    labels, room = labels.copy(), len(labels)
    places, num_objects = np.vstack([landmarks, np.zeros((room, 2))]), len(landmarks)
    obs_class = np.zeros_like(obs_class) if mistake == "class" else obs_class
    votes = np.zeros((len(places), 2))
    np.add.at(votes, (labels, obs_class), 1.0)
    for k in range(room) if mistake == "order" else reversed(range(room)):
        c, own = obs_class[k], labels[k]
        votes[own, c] -= mistake != "own vote"
        weights = association_weights(votes[:num_objects, c], np.linalg.norm(places[:num_objects] - xy[k], axis=1))
        chosen = int(np.argmax(weights)) if mistake == "never new" else decide(reweight(weights, alpha))
        labels[k] = chosen
        if chosen == num_objects:
            places[chosen], num_objects = xy[k], num_objects + 1
        votes[own if mistake == "old votes" else chosen, c] += mistake != "own vote" or chosen != own
        votes[own, c] -= mistake == "own vote" and chosen != own
    return labels
