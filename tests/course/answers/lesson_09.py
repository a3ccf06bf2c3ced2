"""Lesson 09: wrong answers and right ones; see ``test_answers``."""

GREEDY_3 = """
def match_frame(d, gate):
    d, chosen = d.copy(), []
    for row in d:
        j = row.argmin() if len(row) else -1
        chosen.append(j if len(row) and row[j] < gate else -1)
        if chosen[-1] >= 0:
            d[:, j] = np.inf
    return chosen
"""

ASKED_LATE_3 = """
def match_frame(d, gate):
    chosen = np.full(len(d), -1)
    for i, j in zip(*linear_sum_assignment(d)):
        chosen[i] = j if d[i, j] < gate else -1
    return chosen
"""

LARGE_NUMBER_3 = """
def match_frame(d, gate):
    chosen = np.full(len(d), -1)
    dear = np.where(d < gate, d, 1e6)
    for i, j in zip(*linear_sum_assignment(dear)):
        chosen[i] = j if d[i, j] < gate else -1
    return chosen
"""

GAUSSIAN_5 = """
from scipy.stats import norm

nis_bounds = lambda n, p: 2 + norm.ppf([(1 - p) / 2, (1 + p) / 2]) * 2 / n**0.5
"""

BY_HAND_2 = """
lambda y, S: (
    (S[1, 1] * y[0] ** 2 - 2 * S[0, 1] * y[0] * y[1] + S[0, 0] * y[1] ** 2) / (S[0, 0] * S[1, 1] - S[0, 1] ** 2)
)
"""

ALL_OF_THEM_3 = """
from itertools import permutations


def match_frame(d, gate):
    m, K = d.shape
    if m == 0:
        return []
    cost = np.hstack([d, np.full((m, m), gate)])
    best = min(permutations(range(K + m), m), key=lambda c: sum(cost[i, j] for i, j in enumerate(c)))
    return [j if j < K else -1 for j in best]
"""

CLIPPED_3 = """
def match_frame(d, gate):
    chosen = np.full(len(d), -1)
    rows, columns = linear_sum_assignment(np.minimum(d, gate))
    chosen[rows] = np.where(d[rows, columns] < gate, columns, -1)
    return chosen
"""

BY_DIFFERENCES_4 = """
def add_object(mean, cov, xy, std):
    n = len(mean)
    g = lambda v: np.append(
        v[:n],
        v[:2] + [np.cos(v[2]) * v[n] - np.sin(v[2]) * v[n + 1], np.sin(v[2]) * v[n] + np.cos(v[2]) * v[n + 1]],
    )
    v = np.append(mean, xy)
    J = np.stack([(g(v + d) - g(v - d)) / 2e-5 for d in 1e-5 * np.eye(n + 2)], axis=1)
    full = np.zeros((n + 2, n + 2))
    full[:n, :n], full[n:, n:] = cov, np.diag(std**2)
    return g(v), J @ full @ J.T
"""

GAMMA_5 = """
from scipy.stats import gamma

nis_bounds = lambda n, p: (gamma.ppf((1 - p) / 2, n, scale=2 / n), gamma.isf((1 - p) / 2, n, scale=2 / n))
"""

WRONG = {
    1: {
        "not squared": ("noise_std**2", "noise_std"),
        "no noise": (" + noise_std**2", " + 1e-12"),
        "sign lost": ("return variance * slope", "return variance * abs(slope)"),
        "slope once": ("slope * variance * slope", "slope * variance"),
        "no slope above": ("variance * slope /", "variance /"),
        "other share": ("variance * slope /", "noise_std**2 /"),
        "explained": ("variance * slope /", "variance * slope**2 /"),
        "slope of one": "lambda p, h, s: p / (p + s**2)",
        "twice": ("return variance", "return 2 * variance"),
        "new variance": "lambda p, h, s: p * s**2 / (h * h * p + s**2)",
    },
    2: {
        "root": (
            "return innovation @ np.linalg.solve(innovation_cov, innovation)",
            "return np.sqrt(innovation @ np.linalg.solve(innovation_cov, innovation))",
        ),
        "multiplied": ("np.linalg.solve(innovation_cov, innovation)", "innovation_cov @ innovation"),
        "no covariance": ("np.linalg.solve(innovation_cov, innovation)", "innovation"),
        "diagonal": ("np.linalg.solve(innovation_cov, innovation)", "(innovation / np.diag(innovation_cov))"),
        "number by number": "lambda y, S: y @ (1 / S) @ y",
        "twice inverted": "lambda y, S: np.sum(np.linalg.solve(S, y) ** 2)",
        "vector": "lambda y, S: np.linalg.solve(S, y) * y",
        "halved": ("return innovation", "return 0.5 * innovation"),
        "over the determinant": "lambda y, S: y @ y / np.linalg.det(S)",
        "likelihood": "lambda y, S: np.exp(-0.5 * y @ np.linalg.solve(S, y))",
        "root of S": "lambda y, S: abs(np.linalg.solve(np.linalg.cholesky(S), y)).sum()",
    },
    3: {
        "nearest": "lambda d, g: [int(np.argmin(r)) if len(r) and min(r) < g else -1 for r in d]",
        "greedy": GREEDY_3,
        "asked late": ASKED_LATE_3,
        "a large number beyond the gate": LARGE_NUMBER_3,
        "no gate": ("np.full((num_sightings, num_sightings), gate)", "np.full((num_sightings, num_sightings), 1e9)"),
        "one column": ("np.full((num_sightings, num_sightings), gate)", "np.full((num_sightings, 1), gate)"),
        "largest": (
            "np.hstack([squared_distance, leave_out])",
            "np.hstack([np.minimum(squared_distance, 1e3), leave_out]), maximize=True",
        ),
        "objects' columns": ("np.where(column < num_objects, column, -1)", "column"),
        "zero left out": ("column, -1)", "column, 0)"),
        "half the gate": ("num_sightings), gate)", "num_sightings), gate / 2)"),
        "nothing": "lambda d, g: np.full(len(d), -1)",
        "in turn": "lambda d, g: [i if i < d.shape[1] and d[i, i] < g else -1 for i in range(len(d))]",
        "in place": (
            "num_sightings, num_objects =",
            ("squared_distance[squared_distance > gate] = gate\n    num_sightings, num_objects ="),
        ),
    },
    4: {
        "not turned": ("dx, dy = G @ xy", "dx, dy = xy"),
        "no lever": ("[1, 0, -dy], [0, 1, dx]", "[1, 0, 0], [0, 1, 0]"),
        "sign of lever": ("[1, 0, -dy], [0, 1, dx]", "[1, 0, dy], [0, 1, -dx]"),
        "not squared": ("observation_std**2", "observation_std"),
        "noise not turned": ("G @ np.diag(observation_std**2) @ G.T", "np.diag(observation_std**2)"),
        "no noise": (" + G @ np.diag(observation_std**2) @ G.T", ""),
        "independent": ("[[cov, (F @ cov).T], [F @ cov, own]]", "[[cov, 0 * (F @ cov).T], [0 * F @ cov, own]]"),
        "shared with the pose": (
            "[[cov, (F @ cov).T], [F @ cov, own]]",
            "[[cov, (S := F @ cov * (np.arange(len(mean)) < 3)).T], [S, own]]",
        ),
        "not symmetric": ("[[cov, (F @ cov).T]", "[[cov, 0 * (F @ cov).T]"),
        "x and y": ("[dx, dy]), grown", "[dx, dy])[::1], grown * 1.01"),
        "mean alone": ("np.append(mean, mean[:2] + [dx, dy]), grown", "np.append(mean, mean[:2] + [dx, dy])"),
        "in place": ("dx, dy = G @ xy", ("dx, dy = G @ xy\n    mean[2] = 0")),
        "swapped": ("np.append(mean, mean[:2] + [dx, dy]), grown", "grown, np.append(mean, mean[:2] + [dx, dy])"),
    },
    5: {
        "one number": ("2 * num_matches", "num_matches"),
        "sums": (" / num_matches", ""),
        "per degree": ("/ num_matches", "/ (2 * num_matches)"),
        "one tail": ("(1 - probability) / 2", "1 - probability"),
        "reversed": ("[tail, 1 - tail]", "[1 - tail, tail]"),
        "one match": "lambda n, p: chi2.ppf([(1 - p) / 2, (1 + p) / 2], 2)",
        "Gaussian": GAUSSIAN_5,
        "fixed": ("(1 - probability) / 2", "0.025"),
        "low from 0": ("[tail, 1 - tail]", "[0.0, probability]"),
        "high alone": ("[tail, 1 - tail]", "1 - tail"),
        "density": ("chi2.ppf", "chi2.pdf"),
    },
}
RIGHT = {
    1: {
        "information": "lambda p, h, s: 0.0 if p == 0 else h / s**2 / (1 / p + h * h / s**2) if s else (1 / h)",
        "matrices": "lambda p, h, s: (np.array([[p]]) @ [[h]] @ np.linalg.inv([[h * p * h + s * s]]))[0, 0]",
        "array": ("return variance * slope", "return np.array(variance) * slope"),
    },
    2: {
        "inverse": "lambda y, S: y.T @ np.linalg.inv(S) @ y",
        "Cholesky": "lambda y, S: np.sum(np.linalg.solve(np.linalg.cholesky(S), y) ** 2)",
        "by hand": BY_HAND_2,
    },
    3: {
        "all of them": ALL_OF_THEM_3,
        "clipped": CLIPPED_3,
        "list": (
            "return np.where(column < num_objects, column, -1)",
            "return [int(j) if j < num_objects else -1 for j in column]",
        ),
    },
    4: {
        "by differences": BY_DIFFERENCES_4,
        "list": ("np.append(mean, mean[:2] + [dx, dy]), grown", "[[*mean, mean[0] + dx, mean[1] + dy], grown]"),
        "one matrix": (
            "grown = np.block([[cov, (F @ cov).T], [F @ cov, own]])",
            ("A = np.vstack([np.eye(len(mean)), F])\n    grown = A @ cov @ A.T\n    grown[-2:, -2:] = own"),
        ),
    },
    5: {
        "interval": "lambda n, p: np.array(chi2.interval(p, 2 * n)) / n",
        "gamma": GAMMA_5,
        "scaled": "lambda n, p: [chi2.ppf(q, 2 * n, scale=1 / n) for q in ((1 - p) / 2, (1 + p) / 2)]",
    },
}
