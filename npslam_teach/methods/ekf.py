"""The extended Kalman filter of ``ekf_slam`` in whole matrices: one Gaussian over the present pose and all objects.

``block_filter``, which the method runs, does the same on the blocks that it touches.

The state is ``[x, y, theta, l_1x, l_1y, l_2x, ...]`` in W and grows by two numbers with every new object. Its mean and
covariance are kept by filterpy's ``ExtendedKalmanFilter``; here stand the models that filterpy is fed with.

Of the path only the present pose is in the state: an error of the past can no longer be corrected.
"""

import numpy as np

from npslam_teach import se2
from npslam_teach.methods.gating import squared_mahalanobis
from npslam_teach.pose_graph import observation_jacobians

POSE = slice(0, 3)  # where the pose stands in the state


def new_filter():
    """A filter that is certain to stand at the origin, and knows of no object."""
    return _filter(np.zeros(3), np.zeros((3, 3)))


def predict(ekf, step: np.ndarray, odometry_std: np.ndarray) -> None:
    """Drive one odometry step: the mean moves along, the covariance grows.

    Args:
        ekf: the filter, changed in place.
        step: (3,) R_{t+1} in R_t: m, m, rad.
        odometry_std: (3,) m, m, rad.
    """
    by_pose, by_step = motion_jacobians(ekf.x[POSE], step)
    ekf.F, ekf.Q = np.eye(len(ekf.x)), np.zeros((len(ekf.x), len(ekf.x)))
    ekf.F[POSE, POSE] = by_pose
    ekf.Q[POSE, POSE] = by_step @ np.diag(odometry_std**2) @ by_step.T
    moved = se2.compose(ekf.x[POSE], step)
    ekf.predict()
    # filterpy carries the mean along by F too; but the motion is known without linearizing it.
    ekf.x[POSE] = moved


def motion_jacobians(pose: np.ndarray, step: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Derivatives of ``se2.compose(pose, step)`` by the pose and by the step.

    Args:
        pose: (3,) W.
        step: (3,) in the frame of the pose.

    Returns:
        two arrays (3, 3).
    """
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    dx, dy = se2.rotate(pose[2], step[:2])
    by_pose = np.array([[1.0, 0.0, -dy], [0.0, 1.0, dx], [0.0, 0.0, 1.0]])
    by_step = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
    return by_pose, by_step


def update(ekf, objects: np.ndarray, xy: np.ndarray, observation_std: np.ndarray) -> None:
    """Let the observations of one frame pull on the pose and on every object, all at once.

    An observation is in metres, so its innovation holds no angle. The heading in the state is one, and is wrapped.

    Args:
        ekf: the filter, changed in place; its ``y`` and ``S`` are then the innovation of the frame and its covariance.
        objects: (m,) the object of each observation.
        xy: (m, 2) m, in the frame of the robot.
        observation_std: (2,) m.
    """
    noise = np.diag(np.tile(observation_std**2, len(objects)))
    jacobian = np.concatenate(observation_state_jacobians(ekf.x, objects))
    expected = se2.apply_inverse(ekf.x[POSE], landmarks_of(ekf.x)[objects]).ravel()
    ekf.update(xy.ravel(), lambda mean: jacobian, lambda mean: expected, R=noise)
    ekf.x[2] = se2.wrap(ekf.x[2])
    ekf.P = (ekf.P + ekf.P.T) / 2  # rounding must not make it asymmetric


def expected_observations(
    mean: np.ndarray, cov: np.ndarray, objects: np.ndarray, observation_std: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Where objects should appear to the robot, and how far from there the next observation may well be.

    Args:
        mean: (n,) of the filter.
        cov: (n, n).
        objects: (m,) indices.
        observation_std: (2,) m.

    Returns:
        (m, 2) m, in the frame of the robot; (m, 2, 2) m^2, the innovation covariance ``H P H^T + R``.
    """
    jacobians = observation_state_jacobians(mean, objects)
    expected = se2.apply_inverse(mean[POSE], landmarks_of(mean)[objects])
    return expected, jacobians @ cov @ jacobians.swapaxes(1, 2) + np.diag(observation_std**2)


def observation_state_jacobians(mean: np.ndarray, objects: np.ndarray) -> np.ndarray:
    """Derivatives of where objects appear to the robot by the whole state: (m, 2, n), mostly zeros.

    Args:
        mean: (n,) of the filter.
        objects: (m,) indices.
    """
    pose = np.broadcast_to(mean[POSE], (len(objects), 3))
    jacobians = np.zeros((len(objects), 2, len(mean)))
    jacobians[:, :, POSE], by_landmark = observation_jacobians(pose, landmarks_of(mean)[objects])
    for k, first in enumerate(3 + 2 * objects):
        jacobians[k, :, first : first + 2] = by_landmark[k]
    return jacobians


def squared_distances(mean: np.ndarray, cov: np.ndarray, xy: np.ndarray, observation_std: np.ndarray) -> np.ndarray:
    """The squared Mahalanobis distance of every observation to every object, classes not looked at: (m, K).

    Args:
        mean: (3 + 2K,) of the filter.
        cov: (3 + 2K, 3 + 2K).
        xy: (m, 2) m, in the frame of the robot.
        observation_std: (2,) m.
    """
    every = np.arange(len(landmarks_of(mean)))
    expected, innovation_cov = expected_observations(mean, cov, every, observation_std)
    return squared_mahalanobis(xy[:, None, :] - expected, innovation_cov)


def with_new_object(ekf, xy: np.ndarray, observation_std: np.ndarray):
    """A filter of two more numbers: the object stands where it is seen, and shares the error of the pose.

    Args:
        ekf: the filter; it stays as it is.
        xy: (2,) m, in the frame of the robot.
        observation_std: (2,) m.
    """
    by_pose, by_observation = (jacobian[:2] for jacobian in motion_jacobians(ekf.x[POSE], np.append(xy, 0.0)))
    cross = by_pose @ ekf.P[POSE]  # (2, n): with the pose and all that is tied to it
    noise = by_observation[:, :2] @ np.diag(observation_std**2) @ by_observation[:, :2].T
    own = cross[:, POSE] @ by_pose.T + noise
    mean = np.append(ekf.x, se2.apply(ekf.x[POSE], xy))
    return _filter(mean, np.block([[ekf.P, cross.T], [cross, own]]))


def landmarks_of(mean: np.ndarray) -> np.ndarray:
    """The objects in a state (n,): (K, 2) m, W."""
    return mean[3:].reshape(-1, 2)


def _filter(mean: np.ndarray, cov: np.ndarray):
    """The filter of filterpy with this mean (n,) and covariance (n, n)."""
    from filterpy.kalman import ExtendedKalmanFilter

    ekf = ExtendedKalmanFilter(dim_x=len(mean), dim_z=2)
    ekf.x, ekf.P = mean, cov  # one-dimensional from the start: filterpy would begin with a column
    return ekf
