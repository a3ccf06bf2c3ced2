"""Lesson 15: wrong answers and right ones; see ``test_answers``."""

COVARIANCE_1 = """
def without(information, gone):
    kept = np.setdiff1d(np.arange(len(information)), gone)
    return np.linalg.inv(np.linalg.inv(information)[np.ix_(kept, kept)])
"""

ONE_BY_ONE_1 = """
def without(information, gone):
    left, names = np.array(information), list(range(len(information)))
    for variable in gone:
        k = names.index(variable)
        left = left - np.outer(left[:, k], left[k]) / left[k, k]
        left = np.delete(np.delete(left, k, axis=0), k, axis=1)
        names.pop(k)
    return left
"""

LIBRARY_1 = """
from npslam_teach.pose_graph.submaps import eliminate

def without(information, gone):
    kept = np.setdiff1d(np.arange(len(information)), gone)
    return eliminate(information, np.zeros(len(information)), 0.0, np.asarray(gone), kept).information.tolist()
"""

CARRY_2 = """
def tree_sizes(count):
    sizes = []
    for _ in range(count):
        sizes.append(1)
        while len(sizes) > 1 and sizes[-1] == sizes[-2]:
            sizes[-2:] = [2 * sizes[-1]]
    return sizes
"""

LARGEST_2 = """
def tree_sizes(count):
    sizes, size = [], 1 << 20
    while count:
        if size <= count:
            sizes.append(size)
            count -= size
        size //= 2
    return np.array(sizes, dtype=float)
"""

SCIPY_3 = """
from scipy.stats import multivariate_normal

join_gain = lambda off, cov, density: multivariate_normal([0, 0], cov).logpdf(off) - np.log(density)
"""

LIBRARY_3 = """
from npslam_teach.association.gibbs import log_normal

join_gain = lambda off, cov, density: log_normal(off, cov) - np.log(density)
"""

WRONG = {
    1: {
        "struck out": ("- tie @ np.linalg.solve(own, tie.T)", ""),
        "sign": ("- tie @", "+ tie @"),
        "not inverted": ("np.linalg.solve(own, tie.T)", "own @ tie.T"),
        "covariance": "lambda H, g: np.delete(np.delete(np.linalg.inv(H), g, 0), g, 1)",
        "those that go": "lambda H, g: H[np.ix_(g, g)]",
        "the same": "lambda H, g: H",
        "half": ("- tie @", "- 0.5 * tie @"),
        "diagonal only": ("np.linalg.solve(own, tie.T)", "np.linalg.solve(own * np.eye(len(own)), tie.T)"),
        "zeros": "lambda H, g: np.zeros((len(H) - len(g),) * 2)",
        "text": "lambda H, g: 'H'",
    },
    2: {
        "smallest first": "lambda n: [2**k for k in range(n.bit_length()) if n >> k & 1]",
        "digits": "lambda n: [int(d) for d in f'{n:b}']",
        "levels": "lambda n: [k for k in range(n.bit_length()) if n >> k & 1][::-1]",
        "ones": "lambda n: [1] * n",
        "largest alone": "lambda n: [2 ** (n.bit_length() - 1)]",
        "nodes": "lambda n: [2 * 2**k - 1 for k in range(n.bit_length()) if n >> k & 1][::-1]",
        "zeros": ('digit == "1"', 'digit == "0"'),
        "all powers": ('if digit == "1"', ""),
        "count": "lambda n: [n]",
        "twice": ("2 ** (len(digits) - 1 - k)", "2 ** (len(digits) - k)"),
    },
    3: {
        "no half": ("-squared / 2", "-squared"),
        "no determinant": ("- np.log(np.linalg.det(cov)) / 2", ""),
        "whole determinant": ("np.log(np.linalg.det(cov)) / 2", "np.log(np.linalg.det(cov))"),
        "no pi": ("- np.log(2 * np.pi)", ""),
        "half pi": ("np.log(2 * np.pi)", "np.log(2 * np.pi) / 2"),
        "no density": ("log_density - np.log(density)", "log_density"),
        "sign": ("log_density - np.log(density)", "log_density + np.log(density)"),
        "not inverted": ("np.linalg.solve(cov, off) @ off", "off @ cov @ off"),
        "ratio": ("return log_density - np.log(density)", "return np.exp(log_density) / density"),
        "zero": "lambda off, cov, density: 0.0",
    },
}
RIGHT = {
    1: {"block of the covariance": COVARIANCE_1, "one by one": ONE_BY_ONE_1, "library": LIBRARY_1},
    2: {
        "carry": CARRY_2,
        "largest first": LARGEST_2,
        "shifts": "lambda n: tuple(1 << k for k in reversed(range(n.bit_length())) if n & 1 << k)",
    },
    3: {
        "scipy": SCIPY_3,
        "library": LIBRARY_3,
        "slogdet": "lambda x, S, d: -(x @ np.linalg.inv(S) @ x + np.linalg.slogdet(2 * np.pi * S)[1]) / 2 - np.log(d)",
    },
}
