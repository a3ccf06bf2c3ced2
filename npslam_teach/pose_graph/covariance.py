"""How sure the answer is: covariances of single poses and landmarks, all others integrated out."""

import numpy as np

from npslam_teach.pose_graph.factorization import factorizer
from npslam_teach.pose_graph.linearization import graph_structure, normal_equations, residuals
from npslam_teach.pose_graph.observability import require_determined, require_touched
from npslam_teach.types import PoseGraph
from npslam_teach.validation import checked_index


def marginal_covariance(graph: PoseGraph, poses=(), landmarks=()) -> tuple[np.ndarray, np.ndarray]:
    """Covariances of single poses and landmarks, all others integrated out: blocks of the inverse of H.

    They are relative to pose 0, whose own covariance is zero, and mean what they say at the minimum of chi2.

    Args:
        graph: at its minimum.
        poses: (P,) indices.
        landmarks: (L,) indices.

    Raises:
        ValueError: for an index that does not exist.
        numpy.linalg.LinAlgError: when a pose or landmark is not determined by the factors.

    Returns:
        (P, 3, 3) m, m, rad in W and (L, 2, 2) m in W.
    """
    poses = checked_index("poses", poses, len(graph.poses))
    landmarks = checked_index("landmarks", landmarks, len(graph.landmarks))
    solve, num_unknowns = _solver_of(graph)
    pose_cov = np.zeros((len(poses), 3, 3))
    pose_cov[poses > 0] = _inverse_blocks(solve, _pose_unknowns(poses[poses > 0]), num_unknowns)
    return pose_cov, _inverse_blocks(solve, _landmark_unknowns(graph, landmarks), num_unknowns)


def joint_covariance(graph: PoseGraph, pose: int, landmarks) -> np.ndarray:
    """Covariances of one pose together with each of several landmarks: what gating an observation needs.

    Args:
        graph: at its minimum.
        pose: index.
        landmarks: (L,) indices.

    Raises:
        ValueError: for an index that does not exist.
        numpy.linalg.LinAlgError: when a pose or landmark is not determined by the factors.

    Returns:
        (L, 5, 5): ``[x, y, theta]`` of the pose in W, then ``[x, y]`` of the landmark in W.
    """
    pose = checked_index("pose", pose, len(graph.poses))
    landmarks = checked_index("landmarks", landmarks, len(graph.landmarks))
    solve, num_unknowns = _solver_of(graph)
    of_landmarks = _landmark_unknowns(graph, landmarks)
    covariance = np.zeros((len(landmarks), 5, 5))
    if pose[0] == 0:  # it is known
        covariance[:, 3:, 3:] = _inverse_blocks(solve, of_landmarks, num_unknowns)
        return covariance
    unknowns = np.column_stack([np.repeat(_pose_unknowns(pose), len(landmarks), axis=0), of_landmarks])
    return _inverse_blocks(solve, unknowns, num_unknowns)


def _solver_of(graph: PoseGraph):
    """A function that solves with H, and how many unknowns it has."""
    require_touched(graph)
    structure = graph_structure(graph)
    data, _ = normal_equations(graph, structure, residuals(graph))
    factorize = factorizer(structure)
    require_determined(graph, structure, data, factorize)
    return factorize(data), structure.num_unknowns


def _pose_unknowns(poses: np.ndarray) -> np.ndarray:
    return 3 * (poses[:, None] - 1) + np.arange(3)


def _landmark_unknowns(graph: PoseGraph, landmarks: np.ndarray) -> np.ndarray:
    return 3 * (len(graph.poses) - 1) + 2 * landmarks[:, None] + np.arange(2)


def _inverse_blocks(solve, unknowns: np.ndarray, num_unknowns: int, batch: int = 256) -> np.ndarray:
    """Diagonal blocks of the inverse of H: (B, k, k) for (B, k) unknowns, a batch of columns at a time."""
    num_blocks, size = unknowns.shape
    columns = np.empty((num_blocks, size, size))
    for begin in range(0, num_blocks, batch):
        wanted = unknowns[begin : begin + batch]
        rhs = np.zeros((num_unknowns, wanted.size))
        rhs[wanted.ravel(), np.arange(wanted.size)] = 1.0
        solution = solve(rhs).reshape(num_unknowns, len(wanted), size)
        columns[begin : begin + batch] = solution[wanted, np.arange(len(wanted))[:, None], :]
    return 0.5 * (columns + columns.swapaxes(1, 2))
