"""How far a factor is from being satisfied, and how that changes when the estimates move.

Two kinds of factor make the whole graph (paper eq. 1-2, deck "Problem Formulation"):

* odometry: pose j as seen from pose i, compared with what the wheels said;
* observation: a landmark as seen from a pose, compared with what the camera said.

Both residuals live in the frame of the measuring pose. Every function is batched over the leading axis.
Jacobians are with respect to the world coordinates ``[x, y, theta]`` and ``[x, y]`` themselves, which is why the
update of the solver is a plain addition.
"""

import numpy as np

from npslam_teach import se2


def between_residual(pose_i: np.ndarray, pose_j: np.ndarray, measured: np.ndarray) -> np.ndarray:
    """``between(x_i, x_j) - o``, the angle wrapped.

    Args:
        pose_i: (..., 3) W.
        pose_j: (..., 3) W.
        measured: (..., 3) R_j in R_i.

    Returns:
        (..., 3) m, m, rad, in R_i.
    """
    difference = se2.between(pose_i, pose_j) - measured
    difference[..., 2] = se2.wrap(difference[..., 2])
    return difference


def between_jacobians(pose_i: np.ndarray, pose_j: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Derivatives of ``between_residual`` by pose i and by pose j.

    With ``d = p_j - p_i`` and ``R = R(theta_i)`` the residual is ``[R^T d, theta_j - theta_i] - o``. Moving ``p_j``
    moves it by ``R^T``, moving ``p_i`` by ``-R^T``, and turning ``theta_i`` by the derivative of ``R^T``.

    Args:
        pose_i: (..., 3) W.
        pose_j: (..., 3) W.

    Returns:
        two arrays (..., 3, 3).
    """
    xy_in_i = se2.transform_from(pose_i, pose_j[..., :2])
    rotation_t = _rotation_transposed(pose_i[..., 2])
    jacobian_i = np.zeros(pose_i.shape[:-1] + (3, 3))
    jacobian_j = np.zeros_like(jacobian_i)
    jacobian_i[..., :2, :2] = -rotation_t
    jacobian_i[..., :2, 2] = _turned(xy_in_i)
    jacobian_i[..., 2, 2] = -1.0
    jacobian_j[..., :2, :2] = rotation_t
    jacobian_j[..., 2, 2] = 1.0
    return jacobian_i, jacobian_j


def observation_residual(pose: np.ndarray, landmark: np.ndarray, measured: np.ndarray) -> np.ndarray:
    """``R(theta)^T (l - p) - z``.

    Args:
        pose: (..., 3) W.
        landmark: (..., 2) m, W.
        measured: (..., 2) m, in the frame of the pose.

    Returns:
        (..., 2) m, in the frame of the pose.
    """
    return se2.transform_from(pose, landmark) - measured


def observation_jacobians(pose: np.ndarray, landmark: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Derivatives of ``observation_residual`` by the pose and by the landmark.

    Args:
        pose: (..., 3) W.
        landmark: (..., 2) m, W.

    Returns:
        (..., 2, 3) and (..., 2, 2).
    """
    rotation_t = _rotation_transposed(pose[..., 2])
    jacobian_pose = np.empty(pose.shape[:-1] + (2, 3))
    jacobian_pose[..., :2] = -rotation_t
    jacobian_pose[..., 2] = _turned(se2.transform_from(pose, landmark))
    return jacobian_pose, rotation_t


def _rotation_transposed(theta: np.ndarray) -> np.ndarray:
    cos, sin = np.cos(theta), np.sin(theta)
    return np.stack([np.stack([cos, sin], axis=-1), np.stack([-sin, cos], axis=-1)], axis=-2)


def _turned(xy: np.ndarray) -> np.ndarray:
    # When the observer turns left, what he sees turns right: d/dtheta R^T v = [y, -x] for R^T v = [x, y].
    return np.stack([xy[..., 1], -xy[..., 0]], axis=-1)
