"""Lesson 02: wrong answers and right ones; see ``test_answers``."""

MATRICES_1 = """
def matrix(p):
    c, s = np.cos(p[2]), np.sin(p[2])
    return np.array([[c, -s, p[0]], [s, c, p[1]], [0, 0, 1]])


def vector(m):
    return [m[0, 2], m[1, 2], np.arctan2(m[1, 0], m[0, 0])]


compose = lambda p, o: vector(matrix(p) @ matrix(o))
"""

COMPLEX_NUMBERS_1 = """
def compose(p, o):
    z = complex(*p[:2]) + complex(*o[:2]) * np.exp(1j * p[2])
    return z.real, z.imag, np.angle(np.exp(1j * (p[2] + o[2])))
"""

LIBRARY_2 = """
def between(pose_a, pose_b):
    return se2.compose(se2.inverse(pose_a), pose_b)
"""

MATRICES_2 = """
def matrix(p):
    c, s = np.cos(p[2]), np.sin(p[2])
    return np.array([[c, -s, p[0]], [s, c, p[1]], [0, 0, 1]])


def vector(m):
    return [m[0, 2], m[1, 2], np.arctan2(m[1, 0], m[0, 0])]


between = lambda a, b: vector(np.linalg.inv(matrix(a)) @ matrix(b))
"""

ACCUMULATE_3 = """
from itertools import accumulate


def dead_reckoning_by_hand(odometry, start):
    return list(accumulate(odometry, se2.compose, initial=start))
"""

FILLED_3 = """
def dead_reckoning_by_hand(o, start):
    path = np.zeros((len(o) + 1, 3))
    path[0] = start
    for t in range(len(o)):
        path[t + 1] = se2.compose(path[t], o[t])
    return path
"""

MATRIX_4 = """
lambda p, z: np.array([[np.cos(p[2]), -np.sin(p[2])], [np.sin(p[2]), np.cos(p[2])]]) @ z + p[:2]
"""

BY_DIFFERENCES_5 = """
def sighting_covariance(pose, cov, xy, std):
    f = lambda v: se2.apply(v[:3], v[3:])
    v = np.append(pose, xy)
    J = np.stack([(f(v + d) - f(v - d)) / 2e-6 for d in 1e-6 * np.eye(5)], axis=1)
    full = np.zeros((5, 5))
    full[:3, :3], full[3:, 3:] = cov, np.diag(np.square(std))
    return J @ full @ J.T
"""

WRONG = {
    1: {
        "not wrapped": ("(theta + turn + np.pi) % (2 * np.pi) - np.pi", "theta + turn"),
        "not turned": ("cos * forward - sin * left, y + sin * forward + cos * left", "forward, y + left"),
        "backwards": ("cos, sin = np.cos(theta), np.sin(theta)", "cos, sin = np.cos(theta), -np.sin(theta)"),
        "degrees": ("np.cos(theta), np.sin(theta)", "np.cos(np.radians(theta)), np.sin(np.radians(theta))"),
        "turned before": ("np.cos(theta), np.sin(theta)", "np.cos(theta + turn), np.sin(theta + turn)"),
        "no turn": ("theta + turn + np.pi", "theta + np.pi"),
        "wrong order": "lambda p, o: se2.compose(o, p)",
        "from 0 to 2 pi": ("(theta + turn + np.pi) % (2 * np.pi) - np.pi", "(theta + turn) % (2 * np.pi)"),
        "wrapped once too little": ("(theta + turn + np.pi) % (2 * np.pi) - np.pi", "(theta + turn) % np.pi"),
        "position alone": ("+ cos * left, heading]", "+ cos * left]"),
    },
    2: {
        "not wrapped": ("(turn + np.pi) % (2 * np.pi) - np.pi", "turn"),
        "not turned": ("cos * dx + sin * dy, -sin * dx + cos * dy", "dx, dy"),
        "forwards": ("cos * dx + sin * dy, -sin * dx + cos * dy", "cos * dx - sin * dy, sin * dx + cos * dy"),
        "swapped": ("np.array(pose_b) - np.array(pose_a)", "np.array(pose_a) - np.array(pose_b)"),
        "b's heading": ("np.cos(pose_a[2]), np.sin(pose_a[2])", "np.cos(pose_b[2]), np.sin(pose_b[2])"),
        "absolute turn": ("np.array([cos * dx", "np.abs([cos * dx"),
        "compose": "se2.compose",
        "distance": ("cos * dx + sin * dy, -sin * dx + cos * dy", "np.hypot(dx, dy), 0.0"),
        "sum of headings": ("(turn + np.pi)", "(pose_a[2] + pose_b[2] + np.pi)"),
    },
    3: {
        "without the start": ("return np.array(path)", "return np.array(path[1:])"),
        "integers of the start": (
            "return np.array(path)",
            "return np.array(path).astype(np.asarray(start).dtype)",
        ),
        "without the end": ("return np.array(path)", "return np.array(path[:-1])"),
        "from the origin": ("np.array(start, dtype=float)", "np.zeros(3)"),
        "wrong order": ("se2.compose(path[-1], step)", "se2.compose(step, path[-1])"),
        "added": ("se2.compose(path[-1], step)", "path[-1] + step"),
        "always from the start": ("se2.compose(path[-1], step)", "se2.compose(path[0], step)"),
        "backwards": ("in odometry", "in odometry[::-1]"),
        "positions alone": ("return np.array(path)", "return np.array(path)[:, :2]"),
        "five steps only": ("in odometry", "in odometry[:5]"),
        "the end alone": ("return np.array(path)", "return path[-1]"),
    },
    4: {
        "not turned": ("x + cos * ahead - sin * left, y + sin * ahead + cos * left", "x + ahead, y + left"),
        "backwards": ("np.cos(theta), np.sin(theta)", "np.cos(theta), -np.sin(theta)"),
        "at the origin": ("[x + cos", "[cos"),
        "swapped": ("ahead, left = xy_robot", "left, ahead = xy_robot"),
        "way back": "se2.apply_inverse",
        "position turned": "lambda p, z: se2.rotate(p[2], p[:2] + z)",
        "y forgotten": ("left, y + sin", "left, sin"),
        "degrees": ("np.cos(theta), np.sin(theta)", "np.cos(np.radians(theta)), np.sin(np.radians(theta))"),
        "with heading": ("cos * left]", "cos * left, theta]"),
    },
    5: {
        "not squared": ("np.square(observation_std)", "observation_std"),
        "not turned": ("R @ np.diag(np.square(observation_std)) @ R.T", "np.diag(np.square(observation_std))"),
        "turned backwards": (
            "R @ np.diag(np.square(observation_std)) @ R.T",
            "R.T @ np.diag(np.square(observation_std)) @ R",
        ),
        "no lever": ("[1, 0, -dy], [0, 1, dx]", "[1, 0, 0], [0, 1, 0]"),
        "lever of the robot": ("dx, dy = R @ xy_robot", "dx, dy = xy_robot"),
        "sign": ("[1, 0, -dy], [0, 1, dx]", "[1, 0, dy], [0, 1, -dx]"),
        "no camera": ("+ R @ np.diag(np.square(observation_std)) @ R.T", ""),
        "no pose": ("F @ pose_cov @ F.T +", ""),
        "std out": "lambda p, P, z, s: np.sqrt(np.abs(P[:2, :2]))",
        "diagonal": "lambda p, P, z, s: np.diag(np.diag(P)[:2] + s**2)",
    },
}
RIGHT = {
    1: {
        "matrices": MATRICES_1,
        "complex numbers": COMPLEX_NUMBERS_1,
        "while": (
            "(theta + turn + np.pi) % (2 * np.pi) - np.pi",
            (
                "theta + turn\n"
                "    while heading >= np.pi:\n"
                "        heading -= 2 * np.pi\n"
                "    while heading < -np.pi:\n"
                "        heading += 2 * np.pi"
            ),
        ),
    },
    2: {
        "library": LIBRARY_2,
        "matrices": MATRICES_2,
        "arctan2": ("(turn + np.pi) % (2 * np.pi) - np.pi", "np.arctan2(np.sin(turn), np.cos(turn))"),
    },
    3: {
        "library": "se2.dead_reckoning",
        "accumulate": ACCUMULATE_3,
        "filled": FILLED_3,
    },
    4: {
        "library": "se2.apply",
        "matrix": MATRIX_4,
        "through compose": "lambda p, z: se2.compose(p, [*z, 0.0])[:2]",
    },
    5: {
        "by differences": BY_DIFFERENCES_5,
        "powers": ("np.square(observation_std)", "observation_std**2"),
        "einsum": ("F @ pose_cov @ F.T", "np.einsum('ij,jk,lk->il', F, pose_cov, F)"),
    },
}
