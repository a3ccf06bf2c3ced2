"""Small pose graphs for the tests, and their residuals written out from the definition."""

import numpy as np

from npslam_teach import se2
from npslam_teach.pose_graph.factor_kinds import FACTOR_KINDS
from npslam_teach.pose_graph.unknowns import unknowns_of
from npslam_teach.types import BetweenFactors, ObservationFactors, PoseGraph


def random_information(rng, count, size):
    """Well-conditioned symmetric positive definite matrices that are not diagonal."""
    a = rng.normal(size=(count, size, size))
    return a @ a.swapaxes(1, 2) + size * np.eye(size)


def random_graph(seed, num_poses=12, num_landmarks=4, num_loops=3, noise=0.05, start_noise=0.2) -> PoseGraph:
    """A wandering chain with loop closures, in which every landmark is seen from several poses."""
    rng = np.random.default_rng(seed)
    steps = np.column_stack([np.ones(num_poses - 1), np.zeros(num_poses - 1), rng.normal(0, 0.8, num_poses - 1)])
    poses = se2.dead_reckoning(steps, [0.5, -0.3, 2.9])
    landmarks = rng.uniform(-4, 4, (num_landmarks, 2))
    i = np.concatenate([np.arange(num_poses - 1), rng.integers(0, num_poses - 3, num_loops)])
    j = np.concatenate([np.arange(1, num_poses), rng.integers(num_poses - 2, num_poses, num_loops)])
    pose, landmark = np.divmod(np.arange(num_poses * num_landmarks), max(num_landmarks, 1))
    relative = se2.between(poses[i], poses[j]) + noise * rng.normal(size=(len(i), 3))
    xy = se2.apply_inverse(poses[pose], landmarks[landmark]) + noise * rng.normal(size=(len(pose), 2))
    start = poses + start_noise * rng.normal(size=poses.shape) * (np.arange(num_poses) > 0)[:, None]
    return PoseGraph(
        start,
        landmarks + start_noise * rng.normal(size=landmarks.shape),
        BetweenFactors(i, j, relative, random_information(rng, len(i), 3)),
        ObservationFactors(pose, landmark, xy, random_information(rng, len(pose), 2)),
    )


def quarrelling_graph(seed, num_poses=40, num_loops=6, quarrel=2.0) -> PoseGraph:
    """A chain whose steps are good to 0.1 m and whose loop closures, as sure of themselves, are wrong by metres."""
    rng = np.random.default_rng(seed)
    poses = np.cumsum(rng.normal(size=(num_poses, 3)) * [1.0, 1.0, 0.5], axis=0)
    i = np.concatenate([np.arange(num_poses - 1), rng.integers(0, num_poses // 2, num_loops)])
    j = np.concatenate([np.arange(1, num_poses), rng.integers(num_poses // 2, num_poses, num_loops)])
    relative = se2.between(poses[i], poses[j]) + 0.1 * rng.normal(size=(len(i), 3))
    relative[num_poses - 1 :, :2] += quarrel * rng.normal(size=(num_loops, 2))
    factors = BetweenFactors(i, j, relative, np.tile(100.0 * np.eye(3), (len(i), 1, 1)))
    nothing = ObservationFactors([], [], np.zeros((0, 2)), np.zeros((0, 2, 2)))
    return PoseGraph(poses, np.zeros((0, 2)), factors, nothing)


def three_pose_graph():
    """A robot drives 1 m, 1 m, and then recognises that it stands 1.8 m from where it began; headings are known.

    All weights are 1. With x1, x2 free the cost is (x1-1)^2 + (x2-x1-1)^2 + (x2-1.8)^2. Setting both derivatives to
    zero gives 2 x1 = x2 and x2 - x1 - 1 + x2 - 1.8 = 0, so x2 = 28/15, x1 = 14/15 and every residual is 1/15 in size.
    """
    steps = np.array([[1.0, 0, 0], [1.0, 0, 0], [1.8, 0, 0]])
    factors = BetweenFactors([0, 1, 0], [1, 2, 2], steps, np.tile(np.eye(3), (3, 1, 1)))
    return PoseGraph(
        np.zeros((3, 3)), np.zeros((0, 2)), factors, ObservationFactors([], [], np.zeros((0, 2)), np.zeros((0, 2, 2)))
    )


def unpack(graph, x):
    poses = graph.poses.copy()
    split = 3 * (len(poses) - 1)
    poses[1:] = x[:split].reshape(-1, 3)
    return poses, x[split:].reshape(-1, 2)


def whitened_residuals(graph, x):
    """Written out factor by factor, from the definition, without any of the package's residual functions."""
    poses, landmarks = unpack(graph, x)
    out = []
    for i, j, o, information in zip(
        graph.between.i,
        graph.between.j,
        graph.between.relative_pose,
        graph.between.information,
        strict=True,
    ):
        c, s = np.cos(poses[i, 2]), np.sin(poses[i, 2])
        d = poses[j, :2] - poses[i, :2]
        turn = (poses[j, 2] - poses[i, 2] - o[2] + np.pi) % (2 * np.pi) - np.pi
        r = np.array([c * d[0] + s * d[1] - o[0], -s * d[0] + c * d[1] - o[1], turn])
        out.append(np.linalg.cholesky(information).T @ r)
    obs = graph.observations
    for p, k, z, information in zip(obs.pose, obs.landmark, obs.xy, obs.information, strict=True):
        c, s = np.cos(poses[p, 2]), np.sin(poses[p, 2])
        d = landmarks[k] - poses[p, :2]
        r = np.array([c * d[0] + s * d[1] - z[0], -s * d[0] + c * d[1] - z[1]])
        out.append(np.linalg.cholesky(information).T @ r)
    return np.concatenate(out)


def pack(graph):
    return np.concatenate([graph.poses[1:].ravel(), graph.landmarks.ravel()])


def whitened_system(graph):
    """The Jacobian and the residuals of all factors, dense, each divided by its standard deviations."""
    unknowns, jacobians, residuals = unknowns_of(graph), [], []
    for kind in FACTOR_KINDS:
        ends = kind.ends(graph)
        by_end = kind.jacobians(*(end.estimate for end in ends))
        root = np.linalg.cholesky(kind.information(graph)).swapaxes(1, 2)
        for e, residual in enumerate(kind.residuals(graph)):
            row = np.zeros((len(residual), unknowns.count + 1))  # what is fixed goes into the last column
            for end, jacobian in zip(ends, by_end, strict=True):
                row[:, unknowns.of(end.variable, end.index[e : e + 1], jacobian.shape[2])[0]] += jacobian[e]
            jacobians.append(root[e] @ row[:, :-1])
            residuals.append(root[e] @ residual)
    return np.concatenate(jacobians), np.concatenate(residuals)
