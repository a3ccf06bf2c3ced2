"""Lesson 05: wrong answers and right ones; see ``test_answers``."""

REPETITIONS_LOST_1 = """
def my_votes(x, c, K, C):
    v = np.zeros((K, C + 1))
    v[:, 0] = 1
    v[x[x >= 0], c[x >= 0] + 1] += 1
    return v
"""

IN_PLACE_2 = """
def my_class_posterior(votes):
    votes /= votes.sum(axis=1, keepdims=True)
    return votes
"""

PRODUCT_4 = """
from scipy.special import gamma

my_log_density = lambda x, a: np.log(gamma(a.sum()) / np.prod(gamma(a)) * np.prod(x ** (a - 1)))
"""

ADD_AT_1 = """
def my_votes(x, c, K, C):
    v = np.zeros((K, C + 1), dtype=int)
    v[:, 0] = 1
    np.add.at(v, (x[x >= 0], c[x >= 0] + 1), 1)
    return v
"""

ONE_HOT_1 = """
lambda x, c, K, C: np.hstack(
    [np.ones((K, 1)), (x[:, None] == np.arange(K)).T.astype(float) @ (c[:, None] == np.arange(C))]
)
"""

LISTS_1 = """
lambda x, c, K, C: np.array([[1] + [sum((x == k) & (c == j)) for j in range(C)] for k in range(K)]).reshape(
    K, C + 1
)
"""

LIBRARY_4 = """
from scipy.stats import dirichlet

my_log_density = lambda x, a: dirichlet.logpdf(x, a)
"""

XLOGY_4 = """
from scipy.special import xlogy

my_log_density = lambda x, a: gammaln(a.sum()) + sum(xlogy(a - 1, x) - gammaln(a))
"""

MATH_4 = """
from math import lgamma, log

my_log_density = lambda x, a: lgamma(sum(a)) + sum((c - 1) * log(p) - lgamma(c) for p, c in zip(x, a))
"""

SOFTMAX_5 = """
from scipy.special import softmax

my_true_class = lambda v, c: softmax(np.log(c) @ v)
"""

ONE_BY_ONE_5 = """
def my_true_class(v, c):
    s = np.zeros(len(v))
    for u, n in enumerate(v):
        s += n * np.log(c[:, u])
    return [1 / sum(np.exp(s - x)) for x in s]
"""

LOGSUMEXP_5 = """
from scipy.special import logsumexp

my_true_class = lambda v, c: np.exp((s := (v * np.log(c)).sum(axis=1)) - logsumexp(s))
"""

WRONG = {
    1: {
        "sized by labels": (
            "np.zeros((num_objects, num_classes + 1))",
            "np.zeros((max(labels, default=0) + 1, num_classes + 1))",
        ),
        "sized by classes": (
            "np.zeros((num_objects, num_classes + 1))",
            "np.zeros((num_objects, max(obs_class, default=0) + 2))",
        ),
        "no doubt": ("votes[:, 0] = 1", "votes[:, 0] = 0"),
        "once": ("+= 1", "= 1"),
        "column c": ("c + 1] += 1", "c] += 1"),
        "last row": ("if label >= 0", "if True"),
        "no label 0": ("if label >= 0", "if label > 0"),
        "transposed": ("return votes", "return votes.T"),
        "no column": ("return votes", "return votes[:, 1:]"),
        "shares": ("return votes", "return votes / votes.sum(axis=1, keepdims=True)"),
        "repetitions lost": REPETITIONS_LOST_1,
    },
    2: {
        "without doubt below": ("votes.sum(axis=1, keepdims=True)", "votes[:, 1:].sum(axis=1, keepdims=True)"),
        "columns": ("axis=1, keepdims=True", "axis=0"),
        "everything": ("votes.sum(axis=1, keepdims=True)", "votes.sum()"),
        "softmax": "lambda v: np.exp(v) / np.exp(v).sum(axis=1, keepdims=True)",
        "mode": "lambda v: (v - 1) / np.maximum((v - 1).sum(axis=1, keepdims=True), 1)",
        "votes": "lambda v: v",
        "argmax": "lambda v: v.argmax(axis=1)",
        "no column": "lambda v: v[:, 1:] / v[:, 1:].sum(axis=1, keepdims=True)",
        "largest": ("votes.sum(axis=1, keepdims=True)", "votes.max(axis=1, keepdims=True)"),
        "in place": IN_PLACE_2,
    },
    3: {
        "kept": ("doubt > epsilon", "doubt <= epsilon"),
        "reaches": ("doubt > epsilon", "doubt >= epsilon"),
        "vote itself": ("votes[:, 0] / votes.sum(axis=1)", "votes[:, 0]"),
        "1 / m": ("votes.sum(axis=1)", "votes[:, 1:].sum(axis=1)"),
        "most common": ("votes.sum(axis=1)", "(1 + votes[:, 1:].max(axis=1))"),
        "all": "lambda v, e: np.ones(len(v), dtype=bool)",
        "none": "lambda v, e: np.zeros(len(v), dtype=bool)",
        "fixed": ("> epsilon", "> 0.4"),
        "indices": ("return doubt > epsilon", "return np.flatnonzero(doubt > epsilon)"),
        "doubt": ("return doubt > epsilon", "return doubt"),
        "text": ("return doubt > epsilon", "return (doubt > epsilon).astype(str)"),
    },
    4: {
        "no B": (" - log_beta", ""),
        "sign of B": (" - log_beta", " + log_beta"),
        "exponent": ("(a - 1)", "a"),
        "density": (
            "return ((a - 1) * np.log(x)).sum() - log_beta",
            "return np.exp(((a - 1) * np.log(x)).sum() - log_beta)",
        ),
        "no sum in B": (" - gammaln(a.sum())", ""),
        "product": PRODUCT_4,
        "factorials": (
            "log_beta = gammaln(a).sum() - gammaln(a.sum())",
            "log_beta = gammaln(a + 1).sum() - gammaln(a.sum() + 1)",
        ),
        "base 10": ("np.log(x)", "np.log10(x)"),
        "mean": (")).sum() - log_beta", ")).mean() - log_beta"),
        "zero": "lambda x, a: 0.0",
    },
    5: {
        "columns": ("np.log(confusion) @ votes", "np.log(confusion).T @ votes"),
        "shares": "lambda v, c: v / max(v.sum(), 1e-9)",
        "sums": ("np.log(confusion) @ votes", "np.log(confusion @ votes + 1e-300)"),
        "not normalised": ("likelihood / likelihood.sum()", "likelihood"),
        "next report": ("return likelihood / likelihood.sum()", "return (likelihood / likelihood.sum()) @ confusion"),
        "once": ("@ votes", "@ (votes > 0)"),
        "underflow": ("np.exp(log_likelihood - log_likelihood.max())", "np.exp(log_likelihood)"),
        "smallest taken off": ("log_likelihood.max()", "log_likelihood.min()"),
        "mean taken off": ("log_likelihood.max()", "log_likelihood.mean()"),
        "product": "lambda v, c: (p := np.prod(c ** v, axis=1)) / p.sum()",
        "argmax": ("return likelihood / likelihood.sum()", "return np.argmax(likelihood)"),
        "even": "lambda v, c: np.full(len(v), 1 / len(v))",
        "logarithms": ("return likelihood / likelihood.sum()", "return log_likelihood"),
    },
}
RIGHT = {
    1: {
        "add.at": ADD_AT_1,
        "one hot": ONE_HOT_1,
        "lists": LISTS_1,
    },
    2: {
        "transposed": "lambda v: (v.T / v.sum(axis=1)).T",
        "einsum": "lambda v: np.einsum('kc,k->kc', v, 1 / v.sum(axis=1))",
        "rows": "lambda v: np.array([row / sum(row) for row in v]).reshape(v.shape)",
    },
    3: {
        "through m": "lambda v, e: 1 / (v[:, 1:].sum(axis=1) + 1) > e",
        "bound of m": "lambda v, e: v[:, 1:].sum(axis=1) < 1 / e - 1",
        "ones": "lambda v, e: [int(row[0] / sum(row) > e) for row in v]",
    },
    4: {
        "library": LIBRARY_4,
        "xlogy": XLOGY_4,
        "math": MATH_4,
    },
    5: {
        "softmax": SOFTMAX_5,
        "one by one": ONE_BY_ONE_5,
        "logsumexp": LOGSUMEXP_5,
    },
}
