"""How sure the answer is: covariances of single poses and landmarks, all others integrated out."""

import math

import numpy as np

from npslam_teach.pose_graph.block_sparsity import FIXED
from npslam_teach.pose_graph.factor_kinds import FACTOR_KINDS
from npslam_teach.pose_graph.factorization import factorizer
from npslam_teach.pose_graph.linearization import graph_structure, normal_equations, residuals
from npslam_teach.pose_graph.observability import require_factors, require_observable
from npslam_teach.pose_graph.unknowns import unknowns_of
from npslam_teach.types import PoseGraph
from npslam_teach.validation import checked_index


def marginal_covariance(graph: PoseGraph, poses=(), landmarks=()) -> tuple[np.ndarray, np.ndarray]:
    """Covariances of single poses and landmarks, all others integrated out: blocks of the inverse of H.

    They are relative to what is fixed (pose 0), whose own covariance is zero, and hold at the minimum of chi2.

    Args:
        graph: at its minimum.
        poses: (P,) indices.
        landmarks: (L,) indices.

    Raises:
        ValueError: for an index that does not exist.
        numpy.linalg.LinAlgError: when a pose or landmark is not determined by the factors.

    Returns:
        (P, 3, 3) m, m, rad in W and (L, 2, 2) m in W; (L, 3, 3) of landmarks with headings.
    """
    poses = checked_index("poses", poses, len(graph.poses))
    landmarks = checked_index("landmarks", landmarks, len(graph.landmarks))
    solve, unknowns, size = _solver_of(graph), unknowns_of(graph), graph.landmarks.shape[1]
    of_poses, of_landmarks = unknowns.of("poses", poses, 3), unknowns.of("landmarks", landmarks, size)
    return _inverse_blocks(solve, of_poses, unknowns.count), _inverse_blocks(solve, of_landmarks, unknowns.count)


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
    solve, unknowns = _solver_of(graph), unknowns_of(graph)
    of_pose, of_landmarks = unknowns.of("poses", pose, 3), unknowns.of("landmarks", landmarks, 2)
    both = np.column_stack([np.repeat(of_pose, len(landmarks), axis=0), of_landmarks])
    return _inverse_blocks(solve, both, unknowns.count)


def squared_radius(probability: float) -> float:
    """The squared Mahalanobis radius of the ellipse that holds a share of a Gaussian in the plane.

    With two degrees of freedom chi2 is exponential with mean 2, so its quantile is ``-2 log(1 - p)``.

    Args:
        probability: in [0, 1).
    """
    return -2 * math.log1p(-probability)


def _solver_of(graph: PoseGraph):
    """A function that solves with H."""
    require_factors(graph)
    structure = graph_structure(graph)
    data, _ = normal_equations(graph, structure, residuals(graph))
    factorize = factorizer(structure)
    require_observable(graph, structure, data, factorize)
    return factorize(data)


def _inverse_blocks(solve, unknowns: np.ndarray, num_unknowns: int, batch: int = 256) -> np.ndarray:
    """Diagonal blocks of the inverse of H, a batch of columns at a time; what is fixed is certain.

    Args:
        solve: solves with H for (n, k) right-hand sides.
        unknowns: (B, k) of each block; FIXED for what has no place in H.
        num_unknowns: n.
        batch: how many blocks at once.

    Returns:
        (B, k, k).
    """
    num_blocks, size = unknowns.shape
    covariance = np.zeros((num_blocks, size, size))
    for begin in range(0, num_blocks if num_unknowns else 0, batch):
        wanted = unknowns[begin : begin + batch]
        free = wanted != FIXED
        rhs = np.zeros((num_unknowns, wanted.size))
        rhs[wanted[free], np.flatnonzero(free)] = 1.0
        solution = solve(rhs).reshape(num_unknowns, len(wanted), size)
        columns = solution[wanted, np.arange(len(wanted))[:, None], :]
        covariance[begin : begin + batch] = np.where(free[:, :, None], columns, 0.0)
    return 0.5 * (covariance + covariance.swapaxes(1, 2))


def mean_leverages(graph: PoseGraph, most: int = 300) -> list[np.ndarray]:
    """How much of the error of a measured number the fit takes up: the mean diagonal of ``J H^-1 J^T Omega``.

    Over all factors these shares add up to the number of unknowns; what is left over is seen in the residuals.

    Args:
        graph: at its minimum; information without correlations counts by its diagonal.
        most: factors of a kind for which it is worked out, evenly spaced; it differs little among them.

    Returns:
        for every kind of factor (d,), 0 to 1; nothing (0) where there is no factor.
    """
    solve, unknowns, found = _solver_of(graph), unknowns_of(graph), []
    for kind in FACTOR_KINDS:
        ends, information = kind.ends(graph), kind.information(graph)
        if len(information) == 0:
            found.append(np.zeros(information.shape[1]))
            continue
        some = np.unique(np.linspace(0, len(information) - 1, min(len(information), most)).astype(int))
        jacobians = np.zeros((len(some), information.shape[1], unknowns.count))
        for end, jacobian in zip(ends, kind.jacobians(*(end.estimate[some] for end in ends)), strict=True):
            where = unknowns.of(end.variable, end.index[some], end.estimate.shape[1])
            free = where[:, 0] != FIXED
            rows, numbers = np.arange(len(some))[free, None, None], np.arange(information.shape[1])[:, None]
            jacobians[rows, numbers, where[free][:, None]] = jacobian[free]
        solved = solve(jacobians.reshape(-1, unknowns.count).T).T.reshape(jacobians.shape)
        leverage = (jacobians * solved).sum(axis=2) * np.diagonal(information[some], axis1=1, axis2=2)
        found.append(leverage.mean(axis=0))
    return found
