"""Lesson 10: wrong answers and right ones; see ``test_answers``."""

STANDARD_1 = """
lambda k, n, z: (k / n - z * np.sqrt(k / n * (1 - k / n) / n), k / n + z * np.sqrt(k / n * (1 - k / n) / n))
"""

ROOTS_1 = """
def wilson(k, n, z):
    a, b, c = 1 + z * z / n, -(2 * k / n + z * z / n), (k / n) ** 2
    d = np.sqrt(max(b * b - 4 * a * c, 0.0))
    return (-b - d) / (2 * a), (-b + d) / (2 * a)
"""

LIBRARY_1 = """
from scipy.stats import binomtest, norm


def wilson(k, n, z):
    found = binomtest(k, n).proportion_ci(2 * norm.cdf(z) - 1, method="wilson")
    return found.low, found.high
"""

ARRAY_1 = """
lambda k, n, z: (k + z * z / 2 + z * np.sqrt(k * (n - k) / n + z * z / 4) * np.array([-1, 1])) / (n + z * z)
"""

MATH_2 = """
from math import log, sqrt

reach = lambda n, a, s: s * sqrt(2) * sqrt(log(n) - log(a))
"""

SEARCHED_2 = """
from scipy.optimize import brentq

reach = lambda n, a, s: brentq(lambda d: np.log(n / a) - d * d / (2 * s * s), 0, 100, xtol=1e-12)
"""

DIFFERENCE_4 = """
def pass_distance(xy, C, i, j):
    D = np.zeros((2, len(C)))
    D[:, 2 * i : 2 * i + 2], D[:, 2 * j : 2 * j + 2] = np.eye(2), -np.eye(2)
    d = D @ xy.ravel()
    return np.sqrt(d @ np.linalg.inv(D @ C @ D.T) @ d)
"""

BLOCKS_4 = """
def pass_distance(xy, C, i, j):
    B = C.reshape(len(xy), 2, len(xy), 2)
    d = xy[j] - xy[i]
    return (d @ np.linalg.inv(B[i, :, i] + B[j, :, j] - B[i, :, j] - B[j, :, i]) @ d) ** 0.5
"""

WRONG = {
    1: {
        "standard": STANDARD_1,
        "middle": (
            "(share + rest / 2 - half) / (1 + rest), (share + rest / 2 + half) / (1 + rest)",
            "(share - half) / (1 + rest), (share + half) / (1 + rest)",
        ),
        "no floor": (" + rest / (4 * trials)", ""),
        "no division": (
            "(share + rest / 2 - half) / (1 + rest), (share + rest / 2 + half) / (1 + rest)",
            "share + rest / 2 - half, share + rest / 2 + half",
        ),
        "z": ("z**2 / trials", "z / trials"),
        "no root": (
            "np.sqrt(share * (1 - share) / trials + rest / (4 * trials))",
            "(share * (1 - share) / trials + rest / (4 * trials))",
        ),
        "reversed": ("return (", ("half = -half\n    return (")),
        "counts": "lambda k, n, z: [k, n]",
        "fixed z": ("half = z", ("z = 1.96\n    half = z")),
        "low alone": (
            "(share + rest / 2 - half) / (1 + rest), (share + rest / 2 + half) / (1 + rest)",
            "(share + rest / 2 - half) / (1 + rest)",
        ),
        "everything": "lambda k, n, z: (0.0, 1.0)",
        "clipped": "lambda k, n, z: (max(0.0, k / n - z / n**0.5 / 2), min(1.0, k / n + z / n**0.5 / 2))",
    },
    2: {
        "no root": ("np.sqrt(2 * np.log(votes / alpha))", "(2 * np.log(votes / alpha))"),
        "no 2": ("2 * np.log", "np.log"),
        "no width": ("kernel_std * ", ""),
        "times alpha": ("votes / alpha", "votes * alpha + 1"),
        "base 10": ("np.log", "np.log10"),
        "no votes": ("votes / alpha", "1 / min(alpha, 1)"),
        "no alpha": ("votes / alpha", "max(votes, 1)"),
        "under the root": ("kernel_std * np.sqrt(2 * ", "np.sqrt(kernel_std * 2 * "),
        "squared": ("kernel_std * np.sqrt(2 * np.log(votes / alpha))", "2 * kernel_std**2 * np.log(votes / alpha)"),
        "fixed width": ("return kernel_std", "return 0.354"),
        "log inside": ("np.log(votes / alpha)", "np.log(votes) / alpha"),
    },
    3: {
        "upside down": (
            "observation_std / paper_observation_std",
            "paper_observation_std / max(observation_std, 1e-9)",
        ),
        "squared": ("observation_std / paper_observation_std", "(observation_std / paper_observation_std) ** 2"),
        "as it was": (" * observation_std / paper_observation_std", ""),
        "added": ("* observation_std / paper_observation_std", "+ observation_std - paper_observation_std"),
        "ratio": ("paper_kernel_std * ", ""),
        "product": (" / paper_observation_std", ""),
        "root": ("observation_std / paper_observation_std", "np.sqrt(observation_std / paper_observation_std)"),
        "never narrower": (
            "observation_std / paper_observation_std",
            "max(1.0, observation_std / paper_observation_std)",
        ),
        "fixed": ("paper_kernel_std * ", "0.354 * "),
        "own noise": "lambda own, paper, kernel: own",
    },
    4: {
        "not shared": ("cov[a, a] + cov[b, b] - cov[a, b] - cov[b, a]", "cov[a, a] + cov[b, b]"),
        "shared added": (
            "cov[a, a] + cov[b, b] - cov[a, b] - cov[b, a]",
            "cov[a, a] + cov[b, b] + cov[a, b] + cov[b, a]",
        ),
        "shared once": (
            "cov[a, a] + cov[b, b] - cov[a, b] - cov[b, a]",
            "cov[a, a] + cov[b, b] - (cov[a, b] + cov[b, a]) / 2",
        ),
        "squared": (
            "np.sqrt(between @ np.linalg.solve(of_difference, between))",
            "between @ np.linalg.solve(of_difference, between)",
        ),
        "metres": "lambda xy, C, i, j: np.linalg.norm(xy[i] - xy[j])",
        "multiplied": ("np.linalg.solve(of_difference, between)", "of_difference @ between"),
        "diagonal": ("np.linalg.solve(of_difference, between)", "(between / np.diag(of_difference))"),
        "rows of one": ("slice(2 * i, 2 * i + 2), slice(2 * j, 2 * j + 2)", "slice(i, i + 2), slice(j, j + 2)"),
        "own block": ("cov[a, a] + cov[b, b] - cov[a, b] - cov[b, a]", "cov[a, a]"),
        "one order": ("cov[a, a] + cov[b, b] - cov[a, b] - cov[b, a]", "cov[a, a] + cov[b, b] - 2 * cov[a, b]"),
        "in place": ("between = xy[i] - xy[j]", ("xy[i] -= xy[j]\n    between = xy[i]")),
    },
}
RIGHT = {
    1: {
        "roots": ROOTS_1,
        "library": LIBRARY_1,
        "array": ARRAY_1,
    },
    2: {
        "exponent": "lambda n, a, s: (2 * s * s * np.log(n / a)) ** 0.5",
        "math": MATH_2,
        "searched": SEARCHED_2,
    },
    3: {
        "order": "lambda own, paper, kernel: own * kernel / paper",
        "ratio first": "lambda own, paper, kernel: kernel / paper * own",
        "array": "lambda own, paper, kernel: np.array(kernel) * (own / paper)",
    },
    4: {
        "difference": DIFFERENCE_4,
        "blocks": BLOCKS_4,
        "norm": (
            "np.sqrt(between @ np.linalg.solve(of_difference, between))",
            "np.linalg.norm(np.linalg.solve(np.linalg.cholesky(of_difference), between))",
        ),
    },
}
