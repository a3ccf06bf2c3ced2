"""Lesson 04: wrong answers and right ones; see ``test_answers``."""

IN_PLACE_1 = """
def my_weights(votes, distance, s):
    votes *= np.exp(-(distance**2) / (2 * s**2))
    return votes
"""

IN_PLACE_2 = """
def my_reweight(weights, alpha):
    total = weights.sum() + alpha
    weights /= total
    return np.append(weights, alpha / total)
"""

NORMAL_DENSITY_1 = """
from scipy.stats import norm

my_weights = lambda n, d, s: n * norm.pdf(d, scale=s) / norm.pdf(0, scale=s)
"""

IN_TWO_PARTS_2 = """
def my_reweight(w, a):
    p = np.zeros(len(w) + 1)
    p[:-1], p[-1] = w, a
    return p / p.sum()
"""

TWO_RULES_3 = """
def my_decision(p, threshold=None):
    K = len(p) - 1
    if K == 0:
        return 0
    best = np.argmax(p[:K])
    if threshold is None:
        return best if p[best] > p[K] else K
    return best if p[best] > threshold else K
"""

SORTED_3 = """
lambda p, t=None: next(
    (i for i in sorted(range(len(p) - 1), key=lambda i: -p[i]) if p[i] > (p[-1] if t is None else t)),
    len(p) - 1,
)
"""

RECURSION_4 = """
def my_expected_tables(n, alpha):
    return 1 if n == 1 else my_expected_tables(n - 1, alpha) + alpha / (alpha + n - 1)
"""

DIGAMMA_4 = """
from scipy.special import digamma

my_expected_tables = lambda n, a: a * (digamma(a + n) - digamma(a))
"""

LOOP_4 = """
def my_expected_tables(n, a):
    total = 0
    for i in range(n):
        total += a / (a + i)
    return total
"""

LIBRARY_5 = """
from npslam_teach import sweep

my_sweep = lambda *a: sweep(*a).labels
"""

WRONG = {
    1: {
        "no votes": ("votes * ", ""),
        "not squared": ("distance**2", "distance"),
        "width not squared": ("kernel_std**2", "kernel_std"),
        "no 2": ("(2 * kernel_std**2)", "kernel_std**2"),
        "sign": ("-(distance", "(distance"),
        "shares": "lambda n, d, s: (w := n * np.exp(-(d**2) / (2 * s**2))) / w.sum()",
        "fixed width": ("(2 * kernel_std**2)", "0.25"),
        "log": "lambda n, d, s: np.log(n + 1e-300) - d**2 / (2 * s**2)",
        "density": "lambda n, d, s: n * np.exp(-(d**2) / (2 * s**2)) / (2 * np.pi * s**2)",
        "at least one vote": ("votes * ", "np.maximum(votes, 1) * "),
        "in place": IN_PLACE_1,
    },
    2: {
        "alpha left out below": ("with_new.sum()", "weights.sum()"),
        "weights": ("with_new / with_new.sum()", "with_new"),
        "new first": ("np.append(weights, alpha)", "np.append(alpha, weights)"),
        "no new": "lambda w, a: w / (w.sum() + a)",
        "without alpha": "lambda w, a: w / w.sum()",
        "alpha a probability": "lambda w, a: np.append(w / (w.sum() + a), a)",
        "alpha everywhere": "lambda w, a: (v := np.append(w + a, a)) / v.sum()",
        "softmax": "lambda w, a: (v := np.exp(np.append(w, a))) / v.sum()",
        "fixed alpha": ("np.append(weights, alpha)", "np.append(weights, 0.5)"),
        "in place": IN_PLACE_2,
    },
    3: {
        "zero taken for None": ("new if threshold is None else threshold", "threshold or new"),
        "no threshold": ("new if threshold is None else threshold", "new"),
        "threshold alone": ("new if threshold is None else threshold", "threshold or 0.5"),
        "reaches": (" > bar", " >= bar"),
        "never new": "lambda p, t=None: int(np.argmax(p[:-1])) if len(p) > 1 else 0",
        "new takes part": "lambda p, t=None: int(np.argmax(p)) if t is None or max(p) > t else len(p) - 1",
        "one short": ("else len(objects)", "else len(objects) - 1"),
        "minus one": ("else len(objects)", "else -1"),
        "a boolean": "lambda p, t=None: bool(max(p[:-1], default=0) > (p[-1] if t is None else t))",
        "the probability": ("int(np.argmax(objects))", "max(objects)"),
        "threshold is required": ("threshold=None", "threshold"),
        "always 0": "lambda p, t=None: 0",
        "text": "lambda p, t=None: str(int(np.argmax(p)))",
    },
    4: {
        "first guest late": ("np.arange(num_guests)", "np.arange(1, num_guests + 1)"),
        "last alone": ("return (alpha / (alpha + others)).sum()", "return alpha / (alpha + num_guests - 1)"),
        "logarithm": ("return (alpha / (alpha + others)).sum()", "return alpha * np.log(1 + num_guests / alpha)"),
        "no alpha above": ("(alpha / (", "(1 / ("),
        "one too many": ("np.arange(num_guests)", "np.arange(num_guests + 1)"),
        "fixed alpha": ("(alpha / (alpha + others))", "(0.9 / (0.9 + others))"),
        "all guests": ("return (alpha / (alpha + others)).sum()", "return num_guests"),
        "rounded": ("return (alpha / (alpha + others)).sum()", "return round((alpha / (alpha + others)).sum())"),
        "list": (").sum()", ")"),
        "one try": (
            "return (alpha / (alpha + others)).sum()",
            "return 1 + sum(np.random.random() < alpha / (alpha + n) for n in others[1:])",
        ),
    },
    5: {
        "fixed alpha": ("weights.max() > alpha", "weights.max() > 0.6"),
        "reaches": ("weights.max() > alpha", "weights.max() >= alpha"),
        "kernel of 4.2": ("-4 * distance**2", "-4.2 * distance**2"),
        "kernel of 3.8": ("-4 * distance**2", "-3.8 * distance**2"),
        "back into the emptied object": (
            "labels[k] = np.argmax(weights) if weights.max() > alpha else len(places)",
            "labels[k] = np.argmax(weights) if weights.max() > alpha else "
            "(len(places) if sum(votes[labels[k]]) else labels[k])",
        ),
        "stops without a sighting": ("obs_class.max(initial=-1)", "obs_class.max()"),
        "own vote": (("votes[labels[k]][obs_class[k]] -= 1\n"), ("pass\n")),
        "first first": ("reversed(range(len(labels)))", "range(len(labels))"),
        "no class": ("np.array(votes)[:, obs_class[k]]", "np.array(votes).sum(axis=1)"),
        "never new": ("if weights.max() > alpha else len(places)", "if True else 0"),
        "wider kernel": ("-4 * distance**2", "-distance**2"),
        "narrower kernel": ("-4 * distance**2", "-8 * distance**2"),
        "nothing moves": ("for k in reversed(range(len(labels)))", "for k in []"),
        "vote not given back": (("votes[labels[k]][obs_class[k]] += 1\n    return"), "return"),
        "new at the origin": ("places.append(xy[k])", "places.append(0 * xy[k])"),
        "in place": ("labels, places = labels.copy()", "labels, places = labels"),
        "nearest": (
            "np.array(votes)[:, obs_class[k]] * np.exp(-4 * distance**2)",
            "(np.array(votes)[:, obs_class[k]] > 0) * np.exp(-4 * distance**2)",
        ),
    },
}
RIGHT = {
    1: {
        "loop": "lambda n, d, s: [m * 2.718281828459045 ** (-x * x / 2 / s / s) for m, x in zip(n, d)]",
        "normal density": NORMAL_DENSITY_1,
        "logs": "lambda n, d, s: np.exp(np.log(n) - (d / s) ** 2 / 2)",
    },
    2: {
        "concatenate": "lambda w, a: np.concatenate([w, [a]]) / (np.sum(w) + a)",
        "list": "lambda w, a: [x / (sum(w) + a) for x in (*w, a)]",
        "in two parts": IN_TWO_PARTS_2,
    },
    3: {
        "of NumPy": ("int(np.argmax(objects))", "np.argmax(objects)"),
        "two rules": TWO_RULES_3,
        "sorted": SORTED_3,
    },
    4: {
        "recursion": RECURSION_4,
        "digamma": DIGAMMA_4,
        "loop": LOOP_4,
    },
    5: {
        "other names": ("return labels", "return 50 - labels"),
        "library": LIBRARY_5,
        "list": ("return labels", "return list(map(float, labels))"),
    },
}
