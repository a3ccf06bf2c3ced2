"""How far a factor is from being satisfied, and how that changes when the estimates move.

Two kinds of factor make the graph of the paper (eq. 1-2, deck "Problem Formulation"), a third one goes past it:

* odometry: pose j as seen from pose i, compared with the odometry;
* observation: a landmark as seen from a pose, compared with what the camera said;
* heading: which way the landmark faces as seen from the pose, compared likewise.

All residuals live in the frame of the measuring pose. Every function is batched over the leading axis.
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
    pose_i, pose_j, measured = np.asarray(pose_i), np.asarray(pose_j), np.asarray(measured)
    residual = np.empty(np.broadcast_shapes(pose_i.shape, pose_j.shape, measured.shape))
    residual[..., :2] = se2.apply_inverse(pose_i, pose_j[..., :2]) - measured[..., :2]
    residual[..., 2] = se2.wrap(pose_j[..., 2] - pose_i[..., 2] - measured[..., 2])
    return residual


def between_jacobians(pose_i: np.ndarray, pose_j: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Derivatives of ``between_residual`` by pose i and by pose j.

    With ``[x, y] = p_j - p_i`` and ``R = R(theta_i)`` the residual is ``[R^T [x, y], theta_j - theta_i] - o``. Moving
    ``p_j`` moves it by ``R^T``, moving ``p_i`` by ``-R^T``, and turning ``theta_i`` by the derivative of ``R^T``: when
    the observer turns left, what he sees turns right.

    Args:
        pose_i: (..., 3) W.
        pose_j: (..., 3) W.

    Returns:
        two arrays (..., 3, 3).
    """
    cos, sin = np.cos(pose_i[..., 2]), np.sin(pose_i[..., 2])
    x, y = pose_j[..., 0] - pose_i[..., 0], pose_j[..., 1] - pose_i[..., 1]
    zero, one = np.zeros_like(cos), np.ones_like(cos)
    jacobian_i = [[-cos, -sin, cos * y - sin * x], [sin, -cos, -cos * x - sin * y], [zero, zero, -one]]
    jacobian_j = [[cos, sin, zero], [-sin, cos, zero], [zero, zero, one]]
    return _stacked(jacobian_i), _stacked(jacobian_j)


def observation_residual(pose: np.ndarray, landmark: np.ndarray, measured: np.ndarray) -> np.ndarray:
    """``R(theta)^T (l - p) - z``.

    Args:
        pose: (..., 3) W.
        landmark: (..., 2) m, W; a heading behind it does not count.
        measured: (..., 2) m, in the frame of the pose.

    Returns:
        (..., 2) m, in the frame of the pose.
    """
    return se2.apply_inverse(pose, landmark[..., :2]) - measured


def observation_jacobians(pose: np.ndarray, landmark: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Derivatives of ``observation_residual`` by the pose and by the landmark.

    Args:
        pose: (..., 3) W.
        landmark: (..., 2) m, W, or (..., 3) with a heading.

    Returns:
        (..., 2, 3) and (..., 2, 2), or (..., 2, 3) with zeros for the heading.
    """
    cos, sin = np.cos(pose[..., 2]), np.sin(pose[..., 2])
    x, y = landmark[..., 0] - pose[..., 0], landmark[..., 1] - pose[..., 1]
    jacobian_pose = [[-cos, -sin, cos * y - sin * x], [sin, -cos, -cos * x - sin * y]]
    jacobian_landmark = [[cos, sin], [-sin, cos]]
    if landmark.shape[-1] == 3:
        jacobian_landmark = [[*row, np.zeros_like(cos)] for row in jacobian_landmark]
    return _stacked(jacobian_pose), _stacked(jacobian_landmark)


def heading_residual(pose: np.ndarray, landmark: np.ndarray, measured: np.ndarray, symmetry: np.ndarray) -> np.ndarray:
    """``phi - theta - z``, wrapped to half of the turn after which the landmark looks alike.

    Args:
        pose: (..., 3) W.
        landmark: (..., 3) m, m, rad, W.
        measured: (...) rad, in the frame of the pose.
        symmetry: (...) how many headings look alike.

    Returns:
        (..., 1) rad.
    """
    return se2.wrap_symmetric(landmark[..., 2] - pose[..., 2] - measured, symmetry)[..., None]


def heading_jacobians(pose: np.ndarray, landmark: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Derivatives of ``heading_residual`` by the pose and by the landmark; symmetry does not change them.

    Args:
        pose: (..., 3) W.
        landmark: (..., 3) m, m, rad, W; or (0, 2), where no landmark has a heading.

    Returns:
        (..., 1, 3) and (..., 1, 3).
    """
    by_pose, by_landmark = (np.zeros((*array.shape[:-1], 1, array.shape[-1])) for array in (pose, landmark))
    by_pose[..., 2], by_landmark[..., 2:] = -1.0, 1.0
    return by_pose, by_landmark


def _stacked(rows: list) -> np.ndarray:
    """A matrix whose entries are arrays (...), as an array of matrices (..., height, width)."""
    array = np.array(rows)
    return array.transpose(*range(2, array.ndim), 0, 1)
