"""Lesson 11: wrong answers and right ones; see ``test_answers``."""

A_64_BITS_1 = """
from scipy.special import poch

crp_probability = lambda c, a: (
    a ** len(c)
    * np.prod([np.prod(np.arange(1, n, dtype=np.int64)) for n in c], dtype=np.int64)
    / poch(a, sum(c))
)
"""

FACTORIALS_1 = """
from math import factorial, prod

crp_probability = lambda c, a: (
    a ** len(c) * prod(factorial(int(n) - 1) for n in c) / prod(a + i for i in range(int(sum(c))))
)
"""

SEATING_1 = """
def crp_probability(counts, alpha):
    p, there = 1.0, 0
    for n in counts:
        for sitting in range(n):
            p *= (sitting or alpha) / (there + alpha)
            there += 1
    return p
"""

GAMMAS_1 = """
from scipy.special import gammaln

crp_probability = lambda c, a: np.exp(
    len(c) * np.log(a) + gammaln(np.array(c, dtype=float)).sum() + gammaln(a) - gammaln(a + sum(c))
)
"""

FRACTIONS_1 = """
from fractions import Fraction
from math import factorial, prod

crp_probability = lambda c, a: (
    Fraction(a) ** len(c)
    * prod(factorial(int(n) - 1) for n in c)
    / prod(Fraction(a) + i for i in range(int(sum(c))))
)
"""

PLACES_2 = """
def move_probabilities(log_p, labels, k):
    rest = [int(x) for i, x in enumerate(labels) if i != k]
    names = sorted(set(rest))
    logs = []
    for place in [*names, max(names, default=-1) + 1]:
        tried = rest[:k] + [place] + rest[k:]
        order = sorted(set(tried))
        logs.append(log_p([order.index(x) for x in tried]))
    top = max(logs)
    return [np.exp(x - top) / sum(np.exp(y - top) for y in logs) for x in logs]
"""

SOFTMAX_2 = """
from scipy.special import softmax

move_probabilities = lambda log_p, x, k: softmax(
    [
        log_p(np.insert(o, k, i))
        for o in [np.unique(np.delete(x, k), return_inverse=True)[1]]
        for i in range(len(set(o)) + 1)
    ]
)
"""

INVERSE_3 = """
lambda H, b, n: (
    H[n:, n:] - H[n:, :n] @ np.linalg.inv(H[:n, :n]) @ H[:n, n:],
    b[n:] - H[n:, :n] @ np.linalg.inv(H[:n, :n]) @ b[:n],
)
"""

THROUGH_THE_COVARIANCE_3 = """
def eliminate(H, b, n):
    A = np.linalg.inv(np.linalg.inv(H)[n:, n:])
    return [A, A @ np.linalg.solve(H, b)[n:]]
"""

ONE_BY_ONE_3 = """
def eliminate(H, b, n):
    H, b = H.copy(), b.copy()
    for _ in range(n):
        b = b[1:] - H[1:, 0] * b[0] / H[0, 0]
        H = H[1:, 1:] - np.outer(H[1:, 0], H[0, 1:]) / H[0, 0]
    return H, b
"""

SETS_4 = """
lambda p, n: (
    sum(len(set(x)) == n for x in p.tolist()) / len(p),
    [[np.mean(p[:, i] == p[:, j]) for j in range(p.shape[1])] for i in range(p.shape[1])],
)
"""

ONE_HOT_4 = """
def summarise(p, n):
    hot = (p[:, :, None] == np.arange(p.max() + 1)).astype(float)
    return np.mean([len(np.unique(x)) == n for x in p]), np.einsum("sik,sjk->ij", hot, hot) / len(p)
"""

LIST_4 = """
lambda p, n: [float(np.mean(p.max(axis=1) == n - 1)), (p.T[:, None] == p.T).mean(axis=2).tolist()]
"""

PRODUCTS_5 = """
def merge_acceptance(la, lm, w, s):
    w = np.exp(w - w.max(axis=1, keepdims=True))
    q = np.prod([row[i] / row.sum() for row, i in zip(w, s)]) if len(s) else 1.0
    return min(1.0, np.exp(min(lm - la, 500.0)) * q) if lm - la < 500 else 1.0
"""

EXPIT_5 = """
from scipy.special import log_expit

merge_acceptance = lambda la, lm, w, s: np.exp(
    np.minimum(0, lm - la + log_expit((w[:, 0] - w[:, 1]) * (1 - 2 * s)).sum())
)
"""

LOOP_5 = """
from math import exp


def merge_acceptance(la, lm, w, s):
    total = lm - la
    for (a, b), i in zip(w, s):
        total += (a, b)[i] - np.logaddexp(a, b)
    return 1.0 if total > 0 else exp(total)
"""

WRONG = {
    1: {
        "not divided": (" - sum(log(alpha + i) for i in range(int(sum(counts))))", ""),
        "alpha once": ("len(counts) * log(alpha)", "log(alpha)"),
        "n!": ("lgamma(n)", "lgamma(n + 1)"),
        "from alpha + 1": ("log(alpha + i)", "log(alpha + i + 1)"),
        "n! below": ("sum(log(alpha + i) for i in range(int(sum(counts))))", "lgamma(int(sum(counts)) + 1)"),
        "tables alone": ("+ sum(lgamma(n) for n in counts)", ""),
        "logarithm": ("return exp(", "return ("),
        "factorials that overflow": FACTORIALS_1,
        "64 bits": A_64_BITS_1,
        "fixed alpha": ("    tables =", "    alpha = 1.0\n    tables ="),
        "orders counted": ("return exp(", "return exp(lgamma(int(sum(counts)) + 1) + "),
        "one": "lambda c, a: 1.0",
    },
    2: {
        "logarithms": ("np.exp(logs - logs.max())", "logs"),
        "not divided": ("weights / weights.sum()", "weights"),
        "underflow": ("np.exp(logs - logs.max())", "np.exp(logs)"),
        "smallest taken off": ("logs - logs.max()", "logs - logs.min()"),
        "mean taken off": ("logs - logs.max()", "logs - logs.mean()"),
        "stops for a single sighting": ("others.max(initial=-1)", "others.max()"),
        "no new": ("others.max(initial=-1) + 2", "others.max(initial=-1) + 1"),
        "one place too many": ("np.unique(np.delete(labels, k), return_inverse=True)[1]", "np.delete(labels, k)"),
        "new first": ("weights / weights.sum()", "np.roll(weights / weights.sum(), 1)"),
        "reversed": ("weights / weights.sum()", "(weights / weights.sum())[::-1]"),
        "log_p not used": ("log_p(np.insert(others, k, place))", "0.0"),
        "put last": ("np.insert(others, k, place)", "np.append(others, place)"),
        "best alone": ("weights / weights.sum()", "(weights == weights.max()).astype(float)"),
        "in place": ("weights = np", ("labels[k] = 0\n    weights = np")),
        "half temperature": ("np.exp(logs - logs.max())", "np.exp((logs - logs.max()) / 2)"),
    },
    3: {
        "own block": ("ll - carried @ xl", "ll"),
        "added": ("ll - carried @ xl", "ll + carried @ xl"),
        "gradient alone": ("b[num_poses:] - carried @ b[:num_poses]", "b[num_poses:]"),
        "gradient sign": ("b[num_poses:] - carried", "b[num_poses:] + carried"),
        "minus gradient": ("b[num_poses:] - carried @ b[:num_poses]", "carried @ b[:num_poses] - b[num_poses:]"),
        "not inverted": ("np.linalg.solve(xx, xl).T", "(xx @ xl).T"),
        "covariance": (
            "ll - carried @ xl, b[num_poses:] - carried @ b[:num_poses]",
            "np.linalg.inv(H)[num_poses:, num_poses:], b[num_poses:] - carried @ b[:num_poses]",
        ),
        "poses' block": ("ll - carried @ xl, b[num_poses:] - carried @ b[:num_poses]", "xx, b[:num_poses]"),
        "number by number": ("np.linalg.solve(xx, xl).T", "((1 / xx) @ xl).T"),
        "information alone": ("ll - carried @ xl, b[num_poses:] - carried @ b[:num_poses]", "ll - carried @ xl"),
        "in place": ("carried = np", ("ll -= xl.T @ np.linalg.solve(xx, xl)\n    carried = np")),
        "of three each": (
            "xx, xl, ll = H[:num_poses",
            ("num_poses = min(3 * num_poses, len(b) - 1)\n    xx, xl, ll = H[:num_poses"),
        ),
    },
    4: {
        "from 0": ("+ 1 == number", "== number"),
        "how many": ("np.mean(partitions", "np.sum(partitions"),
        "at most": ("== number)", "<= number)"),
        "at least": ("== number)", ">= number)"),
        "apart": ("== partitions[:, None, :]", "!= partitions[:, None, :]"),
        "how often": (
            "(partitions[:, :, None] == partitions[:, None, :]).mean(axis=0)",
            "(partitions[:, :, None] == partitions[:, None, :]).sum(axis=0)",
        ),
        "last": (
            "(partitions[:, :, None] == partitions[:, None, :]).mean(axis=0)",
            "(partitions[-1][:, None] == partitions[-1]) * 1.0",
        ),
        "first": (
            "(partitions[:, :, None] == partitions[:, None, :]).mean(axis=0)",
            "(partitions[0][:, None] == partitions[0]) * 1.0",
        ),
        "no diagonal": (
            "(partitions[:, :, None] == partitions[:, None, :]).mean(axis=0)",
            "(partitions[:, :, None] == partitions[:, None, :]).mean(axis=0) * (1 - np.eye(partitions.shape[1]))",
        ),
        "share alone": ("return share, ", "return share #"),
        "over samples": (
            "(partitions[:, :, None] == partitions[:, None, :]).mean(axis=0)",
            "(partitions[:, None] == partitions).mean(axis=2)",
        ),
        "last label": ("partitions.max(axis=1)", "partitions[:, -1]"),
    },
    5: {
        "above one": (
            "np.exp(min(0.0, log_merged - log_apart + log_way_back))",
            "np.exp(log_merged - log_apart + log_way_back)",
        ),
        "no way back": (" + log_way_back))", "))"),
        "below the line": (" + log_way_back))", " - log_way_back))"),
        "exchanged": ("log_merged - log_apart", "log_apart - log_merged"),
        "way back alone": ("np.exp(min(0.0, log_merged - log_apart + log_way_back))", "np.exp(log_way_back)"),
        "other place": ("sits] - log_sum", "1 - sits] - log_sum"),
        "not divided": (" - log_sum)", ")"),
        "added": (
            "(log_weights[np.arange(len(sits)), sits] - log_sum).sum()",
            "np.log(np.exp(log_weights[np.arange(len(sits)), sits] - log_sum).sum() + 1e-300)",
        ),
        "logarithm": (
            "np.exp(min(0.0, log_merged - log_apart + log_way_back))",
            "min(0.0, log_merged - log_apart + log_way_back)",
        ),
        "no exponential": (
            "np.logaddexp(log_weights[:, 0], log_weights[:, 1])",
            "np.log(np.exp(log_weights).sum(axis=1))",
        ),
        "always": "lambda *a: 1.0",
        "first place": ("sits] - log_sum", "0] - log_sum"),
    },
}
RIGHT = {
    1: {
        "seating": SEATING_1,
        "gammas": GAMMAS_1,
        "fractions": FRACTIONS_1,
    },
    2: {
        "places": PLACES_2,
        "softmax": SOFTMAX_2,
        "logsumexp": (
            ("weights = np.exp(logs - logs.max())\n"),
            ("weights = np.exp(logs - np.logaddexp.reduce(logs))\n"),
        ),
    },
    3: {
        "inverse": INVERSE_3,
        "through the covariance": THROUGH_THE_COVARIANCE_3,
        "one by one": ONE_BY_ONE_3,
    },
    4: {
        "sets": SETS_4,
        "one hot": ONE_HOT_4,
        "list": LIST_4,
    },
    5: {
        "products": PRODUCTS_5,
        "expit": EXPIT_5,
        "loop": LOOP_5,
    },
}
