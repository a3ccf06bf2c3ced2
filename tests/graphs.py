"""Small random pose graphs for the tests."""

import numpy as np

from npslam_teach import se2
from npslam_teach.data import BetweenFactors, ObservationFactors, PoseGraph


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
    xy = se2.transform_from(poses[pose], landmarks[landmark]) + noise * rng.normal(size=(len(pose), 2))
    start = poses + start_noise * rng.normal(size=poses.shape) * (np.arange(num_poses) > 0)[:, None]
    return PoseGraph(
        start,
        landmarks + start_noise * rng.normal(size=landmarks.shape),
        BetweenFactors(i, j, relative, random_information(rng, len(i), 3)),
        ObservationFactors(pose, landmark, xy, random_information(rng, len(pose), 2)),
    )
