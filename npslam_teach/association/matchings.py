"""Marginals over matchings: how probable is each pair, when no object is seen twice in one frame?

A matching gives every observation of a frame an object or none, no object twice. Its weight is the product of the
weights of its pairs, where "none" weighs 1. The probability of a pair is the share of the weight of all matchings that
contain it (Bowman, Atanasov, Daniilidis and Pappas, "Probabilistic data association for semantic SLAM", 2017, write
it with permanents). ``plain_matching_probabilities`` says it as it is; ``matching_probabilities`` says the same by
dynamic programming over sets of observations, objects one after another.
"""

import itertools

import numpy as np

MOST_TOGETHER = 12  # observations that compete for the same objects, up to which the sum over matchings is exact


def plain_matching_probabilities(weights: np.ndarray) -> np.ndarray:
    """The probability (m, K) of each pair, by the sum over all matchings; for small frames.

    Args:
        weights: (m, K), of each pair, relative to "no object".
    """
    num_rows, num_columns = weights.shape
    with_none = np.column_stack([weights, np.ones(num_rows)])
    total, of_pair = 0.0, np.zeros(weights.shape)
    for chosen in itertools.product(range(num_columns + 1), repeat=num_rows):
        objects = [j for j in chosen if j < num_columns]
        if len(set(objects)) < len(objects):
            continue
        product = with_none[range(num_rows), chosen].prod()
        total += product
        for k, j in enumerate(chosen):
            if j < num_columns:
                of_pair[k, j] += product
    return of_pair / total


def matching_probabilities(weights: np.ndarray) -> np.ndarray:
    """The same, fast: groups of observations that compete for objects are independent of each other.

    Where more than MOST_TOGETHER compete, each is asked by itself, as if an object could be seen twice.

    Args:
        weights: (m, K), of each pair, relative to "no object"; 0 where a pair is out of the question.
    """
    probabilities, possible = np.zeros(weights.shape), weights > 0
    alone = ~(possible & (possible.sum(axis=0) > 1)).any(axis=1)  # nobody competes with these for any object
    # Added up in the order of ``_exact``, so that both say the same to the last digit.
    total = np.cumsum(np.column_stack([np.ones(alone.sum()), weights[alone, ::-1]]), axis=1)[:, -1:]
    probabilities[alone] = weights[alone] / total
    possible[alone] = False
    for rows, columns in _groups(possible):
        own = weights[np.ix_(rows, columns)]
        found = _exact(own) if len(rows) <= MOST_TOGETHER else own / (1.0 + own.sum(axis=1, keepdims=True))
        probabilities[np.ix_(rows, columns)] = found
    return probabilities


def _groups(possible: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """Rows and columns that possible pairs connect, group by group."""
    left, groups = possible.any(axis=1), []
    while left.any():
        rows = np.zeros(len(left), dtype=bool)
        rows[left.argmax()] = True
        while True:
            columns = possible[rows].any(axis=0)
            grown = rows | possible[:, columns].any(axis=1)
            if (grown == rows).all():
                break
            rows = grown
        groups.append((np.flatnonzero(rows), np.flatnonzero(columns)))
        left &= ~rows
    return groups


def _exact(weights: np.ndarray) -> np.ndarray:
    """One group. ``before[j][S]``, the first j objects take just the set S; ``after[j][S]``, the others none of S."""
    num_rows, num_columns = weights.shape
    sets = np.arange(1 << num_rows)
    without = [sets[(sets >> k) & 1 == 0] for k in range(num_rows)]  # sets without observation k
    before, after = np.zeros((num_columns + 1, len(sets))), np.ones((num_columns + 1, len(sets)))
    before[0, 0] = 1.0
    for j in range(num_columns):
        before[j + 1] = before[j]
        for k in range(num_rows):
            before[j + 1, without[k] | 1 << k] += weights[k, j] * before[j, without[k]]
    for j in reversed(range(num_columns)):
        after[j] = after[j + 1]
        for k in range(num_rows):
            after[j, without[k]] += weights[k, j] * after[j + 1, without[k] | 1 << k]
    of_pair = [
        [(before[j, without[k]] @ after[j + 1, without[k] | 1 << k]) * weights[k, j] for j in range(num_columns)]
        for k in range(num_rows)
    ]
    return np.array(of_pair) / after[0, 0]
