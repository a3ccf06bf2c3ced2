"""Lesson 07: wrong answers and right ones; see ``test_answers``."""

MIRRORED_2 = """
def mean_pose_error(poses, true_poses):
    xy, ref = poses[:, :2], true_poses[:, :2]
    u, s, v = np.linalg.svd((xy - xy.mean(axis=0)).T @ (ref - ref.mean(axis=0)))
    R = u @ np.eye(2) @ v
    return np.linalg.norm(1.0 * (xy - xy.mean(axis=0)) @ R + ref.mean(axis=0) - ref, axis=1).mean()
"""

STRETCHED_2 = """
def mean_pose_error(poses, true_poses):
    xy, ref = poses[:, :2], true_poses[:, :2]
    u, s, v = np.linalg.svd((xy - xy.mean(axis=0)).T @ (ref - ref.mean(axis=0)))
    R = u @ np.diag([1.0, np.sign(np.linalg.det(u @ v))]) @ v
    return np.linalg.norm(
        s.sum() / ((xy - xy.mean(axis=0)) ** 2).sum() * (xy - xy.mean(axis=0)) @ R + ref.mean(axis=0) - ref,
        axis=1,
    ).mean()
"""

ROOT_MEAN_SQUARE_2 = """
def mean_pose_error(p, t):
    d = se2.apply(se2.align(p[:, :2], t[:, :2]), p[:, :2]) - t[:, :2]
    return np.sqrt((d**2).sum(axis=1).mean())
"""

FIRST_POSE_2 = """
lambda p, t: np.linalg.norm(se2.apply(se2.compose(t[0], se2.inverse(p[0])), p[:, :2]) - t[:, :2], axis=1).mean()
"""

SHIFTED_2 = """
lambda p, t: np.linalg.norm(p[:, :2] - p[:, :2].mean(axis=0) - t[:, :2] + t[:, :2].mean(axis=0), axis=1).mean()
"""

WITHOUT_1_3 = """
import warnings


def adjusted_rand(t, x):
    keep = (t >= 0) & (x >= 0)
    t, x = t[keep], x[keep]
    p = np.triu(np.ones((len(x), len(x)), dtype=bool), 1)
    u, v = (t[:, None] == t) & p, (x[:, None] == x) & p
    a, b, n = u.sum(), v.sum(), (u & v).sum()
    e = a * b / p.sum()
    return (n - e) / ((a + b) / 2 - e)
"""

FRACTION_1 = """
from fractions import Fraction

per_dof = lambda c, t, m, k: Fraction(c) / (2 * m - 2 * k)
"""

PROCRUSTES_2 = """
def mean_pose_error(poses, true_poses):
    xy, ref = poses[:, :2], true_poses[:, :2]
    u, s, v = np.linalg.svd((xy - xy.mean(axis=0)).T @ (ref - ref.mean(axis=0)))
    R = u @ np.diag([1.0, np.sign(np.linalg.det(u @ v))]) @ v
    return np.linalg.norm(1.0 * (xy - xy.mean(axis=0)) @ R + ref.mean(axis=0) - ref, axis=1).mean()
"""

COMPLEX_2 = """
def mean_pose_error(p, t):
    a, b = (q[:, 0] + 1j * q[:, 1] for q in (p, t))
    a, b = a - a.mean(), b - b.mean()
    z = (b * a.conj()).sum()
    return abs(a * z / abs(z) - b).mean()
"""

CONTINGENCY_3 = """
from math import comb


def adjusted_rand(true_labels, labels):
    table = {}
    for pair in zip(true_labels.tolist(), labels.tolist()):
        table[pair] = table.get(pair, 0) + 1

    def count(k):
        sizes = {}
        for pair, m in table.items():
            sizes[pair[k]] = sizes.get(pair[k], 0) + m
        return sum(comb(m, 2) for m in sizes.values())

    a, b, n = count(0), count(1), sum(comb(m, 2) for m in table.values())
    if a == b == n:
        return 1
    e = a * b / comb(len(labels), 2)
    return (n - e) / ((a + b) / 2 - e)
"""

LIBRARY_3 = """
from npslam_teach.evaluation import compare_partitions

adjusted_rand = lambda t, x: compare_partitions(t, x)[0]
"""

BOTH_ORDERS_3 = """
def adjusted_rand(t, x):
    u, v, p = t[:, None] == t, x[:, None] == x, ~np.eye(len(t), dtype=bool)
    a, b, n = (u & p).sum(), (v & p).sum(), (u & v & p).sum()
    if a + b == 2 * n:
        return 1.0
    e = a * b / p.sum()
    return (n - e) / ((a + b) / 2 - e)
"""

WRONG = {
    1: {
        "pose 0": ("unknown = 3 * (num_poses - 1)", "unknown = 3 * num_poses"),
        "one step more": ("measured = 3 * (num_poses - 1)", "measured = 3 * num_poses"),
        "measured alone": ("measured - unknown", "measured"),
        "objects forgotten": (" + 2 * num_objects", ""),
        "one number": ("2 * num_observations", "num_observations"),
        "three unknowns": ("2 * num_objects", "3 * num_objects"),
        "one unknown": ("2 * num_objects", "num_objects"),
        "counts": "lambda c, t, m, k: c / (m - k)",
        "half": ("return chi2", "return chi2 / 2"),
        "upside down": "lambda c, t, m, k: 2 * (m - k) / max(c, 1e-9)",
        "chi2": "lambda c, t, m, k: c",
    },
    2: {
        "not laid over": ("laid_over - true_xy", "xy - true_xy"),
        "mirrored": MIRRORED_2,
        "stretched": STRETCHED_2,
        "wrong way": ("se2.align(xy, true_xy)", "se2.align(true_xy, xy)"),
        "root mean square": ROOT_MEAN_SQUARE_2,
        "median": (
            "return np.linalg.norm(laid_over - true_xy, axis=1).mean()",
            "return np.median(np.linalg.norm(laid_over - true_xy, axis=1))",
        ),
        "largest": ("axis=1).mean()", "axis=1).max()"),
        "sum": ("axis=1).mean()", "axis=1).sum()"),
        "squares": (
            "return np.linalg.norm(laid_over - true_xy, axis=1).mean()",
            "return ((laid_over - true_xy) ** 2).sum(axis=1).mean()",
        ),
        "x and y apart": ("np.linalg.norm(laid_over - true_xy, axis=1).mean()", "np.abs(laid_over - true_xy).mean()"),
        "first pose": FIRST_POSE_2,
        "shifted": SHIFTED_2,
    },
    3: {
        "cut at zero": (
            "return (n - chance) / ((a + b) / 2 - chance)",
            "return max(0.0, (n - chance) / ((a + b) / 2 - chance))",
        ),
        "absolute": (
            "return (n - chance) / ((a + b) / 2 - chance)",
            "return abs((n - chance) / ((a + b) / 2 - chance))",
        ),
        "no label -1": (
            "in_found = (labels[:, None] == labels) & pair",
            "in_found = (labels[:, None] == labels) & pair & (labels >= 0)",
        ),
        "without -1": WITHOUT_1_3,
        "zero over zero": ("if a == b == n:", "if False:"),
        "zero for the same": ("return 1.0", "return 0.0"),
        "Rand": (
            "return (n - chance) / ((a + b) / 2 - chance)",
            "return ((in_true == in_found) & pair).sum() / pair.sum()",
        ),
        "no chance": ("return (n - chance) / ((a + b) / 2 - chance)", "return n / ((a + b) / 2)"),
        "chance above": ("return (n - chance) / ((a + b) / 2 - chance)", "return (n - chance) / ((a + b) / 2)"),
        "larger": ("(a + b) / 2 - chance", "max(a, b) - chance"),
        "sum": ("(a + b) / 2 - chance", "(a + b) - chance"),
        "with itself": ("k=1", "k=0"),
        "same names": "lambda t, x: np.mean(t == x)",
        "one": "lambda t, x: 1.0",
    },
}
RIGHT = {
    1: {
        "cancelled": "lambda c, t, m, k: c / 2 / (m - k)",
        "fraction": FRACTION_1,
        "array": "lambda c, t, m, k: np.array(c / (2 * (m - k)))",
    },
    2: {
        "Procrustes": PROCRUSTES_2,
        "hypot": ("np.linalg.norm(laid_over - true_xy, axis=1).mean()", "np.hypot(*(laid_over - true_xy).T).mean()"),
        "complex": COMPLEX_2,
    },
    3: {
        "contingency": CONTINGENCY_3,
        "library": LIBRARY_3,
        "both orders": BOTH_ORDERS_3,
    },
}
