"""Lesson 03: wrong answers and right ones; see ``test_answers``."""

IN_PLACE_1 = """
def my_observation_residual(pose, landmark, measured):
    landmark -= pose[:2]
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    return np.array([cos * landmark[0] + sin * landmark[1], -sin * landmark[0] + cos * landmark[1]]) - measured
"""

FORWARD_DIFFERENCES_COARSE_2 = """
lambda p, x: np.stack(
    [(se2.apply_inverse(p + d, x) - se2.apply_inverse(p, x)) / 0.1 for d in 0.1 * np.eye(3)], axis=1
)
"""

MATRIX_1 = """
lambda p, x, z: np.array([[np.cos(p[2]), np.sin(p[2])], [-np.sin(p[2]), np.cos(p[2])]]) @ (x - p[:2]) - z
"""

CENTRAL_DIFFERENCES_2 = """
def my_observation_jacobian(pose, landmark):
    h = 1e-5
    f = lambda p: se2.apply_inverse(p, landmark)
    return np.stack([(f(pose + h * e) - f(pose - h * e)) / (2 * h) for e in np.eye(3)], axis=1)
"""

LIBRARY_2 = """
from npslam_teach.pose_graph import observation_jacobians

my_observation_jacobian = lambda p, x: observation_jacobians(p, x)[0]
"""

LIBRARY_3 = """
lambda a, b, z: (lambda r: [r[0] - z[0], r[1] - z[1], se2.wrap(r[2] - z[2])])(se2.between(a, b))
"""

PRIOR_ON_POSE_0_4 = """
def my_step(H, b):
    A = H + 0
    A[:3, :3] += np.eye(3)
    return np.linalg.solve(A, -b)
"""

SPARSE_5 = """
def my_landmark_covariance(H, num_poses, k):
    return np.linalg.inv(H.toarray())[3 * (num_poses - 1) + 2 * k :, 3 * (num_poses - 1) + 2 * k :][:2, :2]
"""

SPARSE_SOLVE_5 = """
from scipy.sparse.linalg import spsolve


def my_landmark_covariance(H, num_poses, k):
    at = 3 * (num_poses - 1) + 2 * k
    return np.array([spsolve(H.tocsc(), np.eye(H.shape[0])[at + i])[at : at + 2] for i in (0, 1)])
"""

SCHUR_COMPLEMENT_5 = """
def my_landmark_covariance(H, num_poses, k):
    first = 3 * (num_poses - 1) + 2 * k
    own = np.r_[first, first + 1]
    rest = np.setdiff1d(np.arange(H.shape[0]), own)
    A = H[np.ix_(own, own)] - H[np.ix_(own, rest)] @ np.linalg.solve(
        H[np.ix_(rest, rest)], H[np.ix_(rest, own)]
    )
    return np.linalg.inv(A)
"""

WRONG = {
    1: {
        "sign": ("return predicted - measured", "return measured - predicted"),
        "prediction alone": ("return predicted - measured", "return predicted"),
        "not turned": ("np.array([cos * east + sin * north, -sin * east + cos * north])", "np.array([east, north])"),
        "forwards": (
            "np.array([cos * east + sin * north, -sin * east + cos * north])",
            "np.array([cos * east - sin * north, sin * east + cos * north])",
        ),
        "no position": ("np.asarray(landmark) - pose[:2]", "np.asarray(landmark)"),
        "in the room": "lambda p, x, z: x - se2.apply(p, z)",
        "in place": IN_PLACE_1,
        "squared": ("return predicted - measured", "return (predicted - measured) ** 2"),
        "absolute": ("return predicted - measured", "return abs(predicted - measured)"),
        "length": ("return predicted - measured", "return np.linalg.norm(predicted - measured)"),
    },
    2: {
        "third sign": (
            "np.array([[-cos, -sin, left], [sin, -cos, -ahead]])",
            "np.array([[-cos, -sin, -left], [sin, -cos, ahead]])",
        ),
        "first signs": (
            "np.array([[-cos, -sin, left], [sin, -cos, -ahead]])",
            "np.array([[cos, sin, left], [-sin, cos, -ahead]])",
        ),
        "all signs": (
            "np.array([[-cos, -sin, left], [sin, -cos, -ahead]])",
            "np.array([[cos, sin, -left], [-sin, cos, ahead]])",
        ),
        "R": (
            "np.array([[-cos, -sin, left], [sin, -cos, -ahead]])",
            "np.array([[-cos, sin, left], [-sin, -cos, -ahead]])",
        ),
        "third zero": (
            "np.array([[-cos, -sin, left], [sin, -cos, -ahead]])",
            "np.array([[-cos, -sin, 0], [sin, -cos, 0]])",
        ),
        "third in the room": (
            "np.array([[-cos, -sin, left], [sin, -cos, -ahead]])",
            "np.array([[-cos, -sin, landmark[1] - pose[1]], [sin, -cos, pose[0] - landmark[0]]])",
        ),
        "swapped": (
            "np.array([[-cos, -sin, left], [sin, -cos, -ahead]])",
            "np.array([[-cos, -sin, -ahead], [sin, -cos, left]])",
        ),
        "transposed": (
            "np.array([[-cos, -sin, left], [sin, -cos, -ahead]])",
            "np.array([[-cos, -sin, left], [sin, -cos, -ahead]]).T",
        ),
        "forward differences, coarse": FORWARD_DIFFERENCES_COARSE_2,
    },
    3: {
        "not wrapped": ("se2.wrap(pose_j[2] - pose_i[2] - measured[2])", "pose_j[2] - pose_i[2] - measured[2]"),
        "wrapped early": (
            "se2.wrap(pose_j[2] - pose_i[2] - measured[2])",
            "se2.wrap(pose_j[2] - pose_i[2]) - measured[2]",
        ),
        "sign": ("return np.append(position, turn)", "return -np.append(position, turn)"),
        "not turned": (
            "my_observation_residual(pose_i, pose_j[:2], measured[:2])",
            "pose_j[:2] - pose_i[:2] - measured[:2]",
        ),
        "pose j's frame": (
            "my_observation_residual(pose_i, pose_j[:2], measured[:2])",
            "se2.rotate(-pose_j[2], pose_j[:2] - pose_i[:2]) - measured[:2]",
        ),
        "swapped": (
            "my_observation_residual(pose_i, pose_j[:2], measured[:2])",
            "my_observation_residual(pose_j, pose_i[:2], measured[:2])",
        ),
        "forwards": (
            "my_observation_residual(pose_i, pose_j[:2], measured[:2])",
            "se2.rotate(pose_i[2], pose_j[:2] - pose_i[:2]) - measured[:2]",
        ),
        "no measurement": ("measured[:2])", "0 * measured[:2])"),
        "absolute turn": ("np.append(position, turn)", "np.append(position, abs(turn))"),
        "measured as seen": "lambda a, b, z: se2.between(z, se2.between(a, b))",
    },
    4: {
        "sign": ("-b[3:]", "b[3:]"),
        "identity": "lambda H, b: -np.linalg.solve(H + np.eye(len(b)), b)",
        "shortest": "lambda H, b: -np.linalg.pinv(H) @ b",
        "last held": "lambda H, b: np.append(np.linalg.solve(H[:-3, :-3], -b[:-3]), np.zeros(3))",
        "diagonal": "lambda H, b: -b / np.diag(H)",
        "no zeros": "lambda H, b: np.linalg.solve(H[3:, 3:], -b[3:])",
        "singular": "lambda H, b: np.linalg.solve(H, -b)",
        "gradient": "lambda H, b: -b",
        "in place": ("dx = np.zeros(len(b))", ("dx = np.zeros(len(b))\n    b[:3] = 0")),
        "two held": ("dx[3:] = np.linalg.solve(H[3:, 3:], -b[3:])", "dx[2:] = np.linalg.solve(H[2:, 2:], -b[2:])"),
    },
    5: {
        "block of H": ("np.linalg.inv(H)[", "H["),
        "block inverted": (
            "np.linalg.inv(H)[first : first + 2, first : first + 2]",
            "np.linalg.inv(H[first : first + 2, first : first + 2])",
        ),
        "pose 0": ("num_poses - 1", "num_poses"),
        "a pose": ("first : first + 2, first : first + 2", "2 * k : 2 * k + 2, 2 * k : 2 * k + 2"),
        "root": ("return np.linalg.inv(H)", "return np.sqrt(abs(np.linalg.inv(H)))"),
        "first landmark": ("+ 2 * k", ""),
        "last landmark": ("[first : first + 2, first : first + 2]", "[-2:, -2:]"),
        "one number": ("first : first + 2, first : first + 2", "first, first"),
        "diagonal": (
            "return np.linalg.inv(H)[first : first + 2, first : first + 2]",
            "return np.diag(np.diag(np.linalg.inv(H))[first : first + 2])",
        ),
        "blocks of three": ("2 * k", "3 * k"),
    },
}
RIGHT = {
    1: {
        "library": "lambda p, x, z: se2.apply_inverse(p, x) - z",
        "matrix": MATRIX_1,
        "list": ("return predicted - measured", "return [float(a) - float(b) for a, b in zip(predicted, measured)]"),
    },
    2: {
        "central differences": CENTRAL_DIFFERENCES_2,
        "library": LIBRARY_2,
        "columns": (
            "np.array([[-cos, -sin, left], [sin, -cos, -ahead]])",
            "np.column_stack([[-cos, sin], [-sin, -cos], [left, -ahead]])",
        ),
    },
    3: {
        "library": LIBRARY_3,
        "arctan2": (
            "se2.wrap(pose_j[2] - pose_i[2] - measured[2])",
            "np.angle(np.exp(1j * (pose_j[2] - pose_i[2] - measured[2])))",
        ),
        "wrapped twice": (
            "se2.wrap(pose_j[2] - pose_i[2] - measured[2])",
            "se2.wrap(se2.wrap(pose_j[2] - pose_i[2]) - measured[2])",
        ),
    },
    4: {
        "prior on pose 0": PRIOR_ON_POSE_0_4,
        "least squares": ("np.linalg.solve(H[3:, 3:], -b[3:])", "np.linalg.lstsq(H[3:, 3:], -b[3:], rcond=None)[0]"),
        "Cholesky": (
            "np.linalg.solve(H[3:, 3:], -b[3:])",
            "(L := np.linalg.inv(np.linalg.cholesky(H[3:, 3:]))).T @ L @ -b[3:]",
        ),
    },
    5: {
        "sparse": SPARSE_5,
        "sparse solve": SPARSE_SOLVE_5,
        "Schur complement": SCHUR_COMPLEMENT_5,
    },
}
