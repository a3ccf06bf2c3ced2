"""Lesson 13: wrong answers and right ones; see ``test_answers``."""

RECURSIVE_1 = """
def pair_probabilities(w):
    def total(w):
        if len(w) == 0:
            return 1.0
        rest = total(w[1:])
        for j in range(w.shape[1]):
            others = np.delete(w[1:], j, axis=1)
            rest += w[0, j] * total(others)
        return rest

    pairs = np.zeros(w.shape)
    for k in range(len(w)):
        for j in range(w.shape[1]):
            pairs[k, j] = w[k, j] * total(np.delete(np.delete(w, k, axis=0), j, axis=1))
    return pairs / total(w)
"""

LIBRARY_1 = """
from npslam_teach.association.matchings import matching_probabilities as pair_probabilities
"""

LIST_1 = """
from npslam_teach.association.matchings import plain_matching_probabilities

pair_probabilities = lambda w: np.asarray(plain_matching_probabilities(w), dtype=np.float32)
"""

LOGS_2 = """
def true_class(reports, confusion):
    with np.errstate(divide="ignore"):
        total = np.log(confusion)[:, reports].sum(axis=1)
    total = np.exp(total - total.max())
    return list(total / total.sum())
"""

ONE_BY_ONE_2 = """
def true_class(reports, confusion):
    belief = np.full(len(confusion), 1 / len(confusion))
    for report in reports:
        belief = belief * confusion[:, report]
        belief = belief / belief.sum()
    return belief
"""

POWERS_2 = """
def true_class(reports, confusion):
    counts = np.bincount(reports, minlength=len(confusion))
    product = np.prod(confusion**counts, axis=1)
    return product / product.sum()
"""

COUNTS_2 = """
from scipy.special import xlogy


def true_class(reports, confusion):
    counts = np.bincount(reports, minlength=len(confusion))
    logs = xlogy(counts, confusion).sum(axis=1)
    weights = np.exp(logs - logs.max())
    return [each / sum(weights) for each in weights]
"""

EINSUM_4 = """
def m_step(x, w, info):
    strength = np.einsum("mk,mij->kij", w, info)
    right = np.einsum("mk,mij,mj->ki", w, info, x)
    return np.linalg.solve(strength, right[..., None])[..., 0]
"""

INVERSE_4 = """
def m_step(x, w, info):
    return [
        np.linalg.inv(sum(a * b for a, b in zip(own, info))) @ sum(a * b @ z for a, b, z in zip(own, info, x))
        for own in w.T
    ]
"""

LSTSQ_4 = """
def m_step(x, w, info):
    places = []
    for own in w.T:
        roots = np.sqrt(own)[:, None, None] * np.linalg.cholesky(info).swapaxes(1, 2)
        places.append(np.linalg.lstsq(roots.reshape(-1, 2), (roots @ x[:, :, None]).reshape(-1), rcond=None)[0])
    return np.array(places)
"""

WRONG = {
    1: {
        "objects shared": ("if len({j for _, j in matched}) == len(matched):", "if True:"),
        "never none": ("range(-1, K)", "range(K)"),
        "not divided": ("return pairs / total", "return pairs"),
        "rows by their sums": "lambda w: w / np.maximum(w.sum(axis=1, keepdims=True), 1e-300)",
        "rows with none by their sums": "lambda w: w / (1 + w.sum(axis=1, keepdims=True))",
        "transposed": ("return pairs / total", "return (pairs / total).T"),
        "the weights": "lambda w: w",
        "text": "lambda w: [['0.5'] * w.shape[1]] * len(w)",
        "the argument changed": ("total, pairs = 0.0, np.zeros((m, K))", "total, pairs = 0.0, weights; pairs[:] = 0"),
        "even": "lambda w: np.full(w.shape, 0.5)",
    },
    2: {
        "rows of the matrix": ("np.log(confusion)[:, reports].sum(axis=1)", "np.log(confusion)[reports].sum(axis=0)"),
        "mean": ("[:, reports].sum(axis=1)", "[:, reports].mean(axis=1)"),
        "not divided": ("return likelihood / likelihood.sum()", "return likelihood"),
        "product": "lambda r, C: (p := C[:, r].prod(axis=1)) / p.sum()",
        "powers": POWERS_2,
        "smallest taken off": ("logs.max()", "logs.min()"),
        "votes": "lambda r, C: np.bincount(r, minlength=len(C)) / len(r)",
        "the last": "lambda r, C: C[:, r[-1]] / C[:, r[-1]].sum()",
        "the first": "lambda r, C: C[:, r[0]] / C[:, r[0]].sum()",
        "each kind once": ("[:, reports]", "[:, np.unique(reports)]"),
        "even": "lambda r, C: np.full(len(C), 1 / len(C))",
        "complex": ("return likelihood / likelihood.sum()", "return likelihood / likelihood.sum() + 0j"),
    },
    3: {
        "sign": "lambda p, L: 2 * np.log(p @ L / L.mean())",
        "half": "lambda p, L: -np.log(p @ L / L.mean())",
        "against nothing": "lambda p, L: -2 * np.log(p @ L)",
        "against the best": "lambda p, L: -2 * np.log(p @ L / L.max())",
        "against the sum": "lambda p, L: -2 * np.log(p @ L / L.sum())",
        "base 10": "lambda p, L: -2 * np.log10(p @ L / L.mean())",
        "ratio": "lambda p, L: p @ L / L.mean()",
        "only the best class": "lambda p, L: -2 * np.log(L[p.argmax()] / L.mean())",
        "zero": "lambda p, L: 0.0",
        "text": "lambda p, L: '0.5'",
    },
    4: {
        "no information": "lambda x, w, info: (w.T @ x) / w.sum(axis=0)[:, None]",
        "inverse information": ("own[:, None, None] * information", "own[:, None, None] * np.linalg.inv(information)"),
        "diagonal": ("own[:, None, None] * information", "own[:, None, None] * information * np.eye(2)"),
        "squared weights": ("for own in weights.T:", "for own in weights.T**2:"),
        "no weights": ("for own in weights.T:", "for own in np.ones_like(weights.T):"),
        "not solved": ("np.linalg.solve(strength.sum(axis=0), right)", "right"),
        "the most probable": "lambda x, w, info: x[w.argmax(axis=0)]",
        "zeros": "lambda x, w, info: np.zeros((w.shape[1], 2))",
        "transposed": ("return np.array(places)", "return np.array(places).T.reshape(-1, 2)[::-1]"),
    },
}
RIGHT = {
    1: {"recursive": RECURSIVE_1, "library": LIBRARY_1, "in single precision": LIST_1},
    2: {"logarithms": LOGS_2, "one by one": ONE_BY_ONE_2, "counts": COUNTS_2},
    3: {
        "difference of logs": "lambda p, L: 2 * np.log(L.sum() / len(L)) - 2 * np.log(np.dot(p, L))",
        "numpy array": "lambda p, L: np.array(-2 * np.log((p * L).sum() / L.mean()))",
        "python sum": "lambda p, L: float(-2 * np.log(sum(a * b for a, b in zip(p, L)) * len(L) / sum(L)))",
    },
    4: {"einsum": EINSUM_4, "inverse": INVERSE_4, "least squares": LSTSQ_4},
}
