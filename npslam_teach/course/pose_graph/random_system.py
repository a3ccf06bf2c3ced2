"""The normal equations of a small random graph, for the check of one step of the solver."""

import numpy as np

from npslam_teach import se2
from npslam_teach.course.checking import numerical_jacobian
from npslam_teach.pose_graph import between_residual, observation_residual


def random_system(rng: np.random.Generator, num_landmarks: int) -> tuple[np.ndarray, np.ndarray]:
    """H and b of one small random graph of three poses, pose 0 not held."""
    poses = np.column_stack([rng.uniform(-3, 3, (3, 2)), rng.uniform(-3, 3, 3)])
    landmarks = rng.uniform(-3, 3, (num_landmarks, 2))

    def residuals(unknowns):
        x, points = unknowns[:9].reshape(3, 3), unknowns[9:].reshape(-1, 2)
        steps = [between_residual(x[t], x[t + 1], measured_steps[t]) for t in (0, 1)]
        seen = [observation_residual(x[t], points[k], measured[t, k]) for t in range(3) for k in range(num_landmarks)]
        return np.concatenate(steps + seen)

    measured_steps = se2.between(poses[:-1], poses[1:]) + rng.normal(0, 0.2, (2, 3))
    measured = se2.apply_inverse(poses[:, None], landmarks[None]) + rng.normal(0, 0.2, (3, num_landmarks, 2))
    at = np.concatenate([poses.ravel(), landmarks.ravel()])
    jacobian = numerical_jacobian(residuals, at)
    return 10 * jacobian.T @ jacobian, 10 * jacobian.T @ residuals(at)
