"""Lesson 14: wrong answers and right ones; see ``test_answers``."""

LOOP_1 = """
def smallest_turn(turn, symmetry):
    if not symmetry:
        return [0.0] * len(turn)
    part, found = 2 * np.pi / symmetry, []
    for each in turn:
        while each >= part / 2:
            each -= part
        while each < -part / 2:
            each += part
        found.append(float(each))
    return found
"""

CIRCLE_1 = """
def smallest_turn(turn, symmetry):
    return np.angle(np.exp(1j * symmetry * turn)) / max(symmetry, 1)
"""

MODULO_1 = """
def smallest_turn(turn, symmetry):
    if symmetry == 0:
        return 0 * turn
    part = 2 * np.pi / symmetry
    return ((turn + part / 2) % part - part / 2).astype(np.float64)
"""

COMPLEX_3 = """
def mean_heading(theta, symmetry):
    return np.angle(np.mean(np.exp(1j * symmetry * theta))) / symmetry
"""

MATH_3 = """
import math

def mean_heading(theta, symmetry):
    y = sum(math.sin(symmetry * each) for each in theta)
    x = sum(math.cos(symmetry * each) for each in theta)
    return math.atan2(y, x) / symmetry
"""

LIBRARY_3 = """
from npslam_teach.pose_graph import mean_headings

def mean_heading(theta, symmetry):
    count = len(theta)
    return mean_headings(np.zeros(count, dtype=int), theta, np.full(count, symmetry))[0]
"""

CHOLESKY_4 = """
def joint_distance(seen, expected, cov, symmetry):
    off = np.append(seen[:2] - expected[:2], se2.wrap(symmetry * (seen[2] - expected[2])) / symmetry)
    return np.sum(np.linalg.solve(np.linalg.cholesky(cov), off) ** 2)
"""

NEAREST_4 = """
def joint_distance(seen, expected, cov, symmetry):
    off = seen - expected
    part = 2 * np.pi / symmetry
    off[2] -= part * np.round(off[2] / part)
    return float(off @ np.linalg.inv(cov) @ off)
"""

LIBRARY_4 = """
from npslam_teach.methods.gating import squared_mahalanobis

def joint_distance(seen, expected, cov, symmetry):
    turn = se2.wrap_symmetric(seen[2] - expected[2], symmetry)
    return squared_mahalanobis(np.array([*(seen - expected)[:2], turn]), cov)
"""

WRONG = {
    1: {
        "not wrapped": ("se2.wrap(symmetry * turn) / symmetry", "turn"),
        "no symmetry": ("se2.wrap(symmetry * turn) / symmetry", "se2.wrap(turn)"),
        "from zero": ("se2.wrap(symmetry * turn) / symmetry", "np.mod(turn, 2 * np.pi / symmetry)"),
        "not divided": ("se2.wrap(symmetry * turn) / symmetry", "se2.wrap(symmetry * turn)"),
        "half the part": ("se2.wrap(symmetry * turn) / symmetry", "se2.wrap(2 * symmetry * turn) / (2 * symmetry)"),
        "without sign": ("return se2.wrap(symmetry * turn)", "return abs(se2.wrap(symmetry * turn))"),
        "wrapped first": ("se2.wrap(symmetry * turn) / symmetry", "se2.wrap(turn) / symmetry"),
        "round is turned": ("return np.zeros_like(turn)", "return turn"),
        "degrees": ("se2.wrap(symmetry * turn) / symmetry", "np.rad2deg(se2.wrap(symmetry * turn) / symmetry)"),
        "text": "lambda turn, n: ['0.1'] * len(turn)",
        "the argument changed": "lambda turn, n: turn.__imul__(0)",
    },
    2: {
        "no heading": (" - turn**2 / (2 * heading_std**2)", ""),
        "no position": ("-(distance**2) / (2 * kernel_std**2) - ", "-"),
        "no votes": ("votes * np.exp", "np.exp"),
        "no halves": "lambda v, d, t, s, h: v * np.exp(-(d**2) / s**2 - t**2 / h**2)",
        "sum": "lambda v, d, t, s, h: v * (np.exp(-(d**2) / (2 * s**2)) + np.exp(-(t**2) / (2 * h**2)))",
        "width not squared": ("(2 * heading_std**2)", "(2 * heading_std)"),
        "turn not squared": ("turn**2", "np.abs(turn)"),
        "widths exchanged": "lambda v, d, t, s, h: v * np.exp(-(d**2) / (2 * h**2) - t**2 / (2 * s**2))",
        "a share": "lambda v, d, t, s, h: v / max(v.sum(), 1)",
        "sign": ("- turn**2", "+ turn**2"),
    },
    3: {
        "mean of numbers": "lambda theta, n: theta.mean()",
        "median": "lambda theta, n: np.median(theta)",
        "no symmetry": "lambda theta, n: np.arctan2(np.sin(theta).sum(), np.cos(theta).sum())",
        "not divided": ("np.arctan2(sines, cosines) / symmetry", "np.arctan2(sines, cosines)"),
        "exchanged": ("np.arctan2(sines, cosines)", "np.arctan2(cosines, sines)"),
        "wrapped numbers": "lambda theta, n: np.mean(se2.wrap(n * theta) / n)",
        "the first": "lambda theta, n: se2.wrap(n * theta[0]) / n",
        "zero": "lambda theta, n: 0.0",
        "atan of a ratio": ("np.arctan2(sines, cosines)", "np.arctan(sines / cosines)"),
        "text": "lambda theta, n: '0'",
    },
    4: {
        "not wrapped": ("se2.wrap_symmetric(off[2], symmetry)", "off[2]"),
        "no symmetry": ("se2.wrap_symmetric(off[2], symmetry)", "se2.wrap(off[2])"),
        "not inverted": ("np.linalg.solve(cov, off)", "cov @ off"),
        "diagonal": ("np.linalg.solve(cov, off)", "(off / np.diag(cov))"),
        "place alone": "lambda s, e, c, n: (s - e)[:2] @ np.linalg.solve(c[:2, :2], (s - e)[:2])",
        "root": ("return off @ np.linalg.solve(cov, off)", "return np.sqrt(off @ np.linalg.solve(cov, off))"),
        "apart": (
            "return off @ np.linalg.solve(cov, off)",
            "return off[:2] @ np.linalg.solve(cov[:2, :2], off[:2]) + off[2] ** 2 / cov[2, 2]",
        ),
        "sum of both": ("seen - expected", "seen + expected"),
        "zero": "lambda s, e, c, n: 0.0",
        "the argument changed": ("off = seen - expected", "off = seen; off -= expected"),
    },
}
RIGHT = {
    1: {"loop": LOOP_1, "circle": CIRCLE_1, "modulo": MODULO_1},
    2: {
        "two kernels": "lambda v, d, t, s, h: v * np.exp(-0.5 * (d / s) ** 2) * np.exp(-0.5 * (t / h) ** 2)",
        "list": "lambda v, d, t, s, h: [a * np.exp(-(b / s) ** 2 / 2 - (c / h) ** 2 / 2) for a, b, c in zip(v, d, t)]",
        "hypot": "lambda v, d, t, s, h: v * np.exp(-np.hypot(d / s, t / h) ** 2 / 2)",
    },
    3: {"complex": COMPLEX_3, "math": MATH_3, "library": LIBRARY_3},
    4: {"cholesky": CHOLESKY_4, "nearest": NEAREST_4, "library": LIBRARY_4},
}
