"""The normal equations of a pose graph: from factors to ``H dx = -b``, all factors of a kind at once.

Around the present estimate every residual is nearly linear, ``r + J dx``. The step that makes
``sum (r + J dx)^T Omega (r + J dx)`` smallest solves ``H dx = -b`` with ``H = sum J^T Omega J`` and
``b = sum J^T Omega r`` (Grisetti et al., "A Tutorial on Graph-Based SLAM", 2010).

The unknowns are the world coordinates ``[x, y, theta]`` of poses 1, 2, ... and then ``[x, y]`` of the landmarks. Pose 0
is left out: the whole map could be shifted and turned without any measurement noticing, and this freedom, the *gauge*,
is removed by holding one pose still.
"""

from typing import NamedTuple

import numpy as np

from npslam_teach import se2
from npslam_teach.pose_graph.block_sparsity import BlockGroup, BlockStructure, block_structure
from npslam_teach.pose_graph.residuals import (
    between_jacobians,
    between_residual,
    observation_jacobians,
    observation_residual,
)
from npslam_teach.types import PoseGraph


class Residuals(NamedTuple):
    """How far every factor is from being satisfied, and all of it in one number."""

    between: np.ndarray  # (E, 3) m, m, rad
    observations: np.ndarray  # (M, 2) m
    chi2: float  # the sum of r^T Omega r, no one-half


def residuals(graph: PoseGraph) -> Residuals:
    """The residuals of all factors at the present estimate."""
    poses, between, observations = graph.poses, graph.between, graph.observations
    r_between = between_residual(poses[between.i], poses[between.j], between.relative_pose)
    seen = graph.landmarks[observations.landmark]
    r_observations = observation_residual(poses[observations.pose], seen, observations.xy)
    value = _weighted_square(r_between, between.information) + _weighted_square(
        r_observations, observations.information
    )
    return Residuals(r_between, r_observations, value)


def chi2(graph: PoseGraph) -> float:
    """The sum of ``r^T Omega r`` over all factors of the graph."""
    return residuals(graph).chi2


def linearize(graph: PoseGraph):
    """The normal equations at the present estimate.

    Returns:
        H (n, n) ``scipy.sparse.csc_array``, b (n,) and chi2. Unknowns: poses 1.. (three each), then landmarks (two
        each). Pose 0 is left out.
    """
    structure, at = graph_structure(graph), residuals(graph)
    data, b = normal_equations(graph, structure, at)
    return structure.matrix(data), b, at.chi2


def graph_structure(graph: PoseGraph) -> BlockStructure:
    """Where the blocks of H go: blocks 0.. are poses 1.., then come the landmarks; pose 0 is held still."""
    free_poses = len(graph.poses) - 1
    i, j, pose = graph.between.i - 1, graph.between.j - 1, graph.observations.pose - 1  # pose 0 becomes FIXED
    landmark = graph.observations.landmark + free_poses
    groups = [
        BlockGroup(i, i, 3, 3),
        BlockGroup(i, j, 3, 3),
        BlockGroup(j, j, 3, 3),
        BlockGroup(pose, pose, 3, 3),
        BlockGroup(pose, landmark, 3, 2),
        BlockGroup(landmark, landmark, 2, 2),
    ]
    return block_structure(np.repeat([3, 2], [free_poses, len(graph.landmarks)]), groups)


def normal_equations(graph: PoseGraph, structure: BlockStructure, at: Residuals) -> tuple[np.ndarray, np.ndarray]:
    """All blocks of H in their places, and b.

    Args:
        graph: the present estimate.
        structure: from ``graph_structure``; it depends on who is tied to whom, not on the estimate.
        at: the residuals there.

    Returns:
        the ``data`` (nnz,) of the structure's upper triangle, and b (n,).
    """
    poses, landmarks, between, observations = graph.poses, graph.landmarks, graph.between, graph.observations
    i, j, pose, landmark = between.i, between.j, observations.pose, observations.landmark
    values = structure.scratch
    blocks = structure.blocks(values)
    jacobians = between_jacobians(poses[i], poses[j])
    b_i, b_j = _fill(blocks[:3], *jacobians, between.information, at.between)
    jacobians = observation_jacobians(poses[pose], landmarks[landmark])
    b_pose, b_landmark = _fill(blocks[3:], *jacobians, observations.information, at.observations)

    b_poses = sum(_added_up(k, b, len(poses)) for k, b in ((i, b_i), (j, b_j), (pose, b_pose)))
    b_landmarks = _added_up(landmark, b_landmark, len(landmarks))
    return structure.gather(values), np.concatenate([b_poses[1:].ravel(), b_landmarks.ravel()])


def second_order_term(graph: PoseGraph, structure: BlockStructure, at: Residuals) -> np.ndarray:
    """What Gauss-Newton leaves out of the second derivative of chi2 / 2: ``sum (Omega r)^T d^2 r``, in its places.

    Residuals that are small or nearly straight make it small beside H. A long chain that wheels and camera bend against
    each other makes it matter: there ``H + second_order_term`` is the slope of b, and H alone is not.

    Args: as in ``normal_equations``.

    Returns:
        (nnz,) for the upper triangle, like the ``data`` of H. Their sum need not be positive definite.
    """
    poses, landmarks, between, observations = graph.poses, graph.landmarks, graph.between, graph.observations
    steps = poses[between.j, :2] - poses[between.i, :2]
    sights = landmarks[observations.landmark] - poses[observations.pose, :2]
    pulls = _weighted(at.between, between.information)[:, :2]
    more_pulls = _weighted(at.observations, observations.information)
    values = structure.scratch
    values.fill(0.0)
    blocks = structure.blocks(values)
    _fill_second_order_term(blocks[:2], poses[between.i, 2], steps, pulls)
    _fill_second_order_term(blocks[3:5], poses[observations.pose, 2], sights, more_pulls)
    return structure.gather(values)


def _fill_second_order_term(
    blocks: list[np.ndarray], theta: np.ndarray, difference: np.ndarray, pull: np.ndarray
) -> None:
    """Write the second derivatives of ``pull . R(theta)^T (b - a)``, by pose a = (xy, theta) and b, into blocks aa, ab.

    The derivative by b, ``R pull``, turns with theta; whatever depends on b - a alone is linear and does not curve.

    Args:
        blocks: (3, 3, E) and (3, 2 or 3, E), zero.
        theta: (E,) rad.
        difference: (E, 2) m, b - a in W.
        pull: (E, 2) Omega r, held still.
    """
    aa, ab = blocks
    gradient = se2.rotate(theta, pull).T
    turned = np.stack([-gradient[1], gradient[0]])
    aa[:2, 2] = aa[2, :2] = -turned
    aa[2, 2] = -(gradient * difference.T).sum(axis=0)
    ab[2, :2] = turned


def _weighted(residual: np.ndarray, information: np.ndarray) -> np.ndarray:
    """``Omega r`` of every factor, (E, d)."""
    return np.einsum("eij,ej->ei", information, residual)


def _weighted_square(residual: np.ndarray, information: np.ndarray) -> float:
    return float(np.einsum("ei,ei->", residual, _weighted(residual, information)))


def _fill(blocks: list[np.ndarray], jacobian_a, jacobian_b, information, residual) -> tuple[np.ndarray, np.ndarray]:
    """Write what factors between variables a and b add to H into its blocks aa, ab and bb; return what they add to b.

    The factors are moved to the last axis, where one sum over k or l runs through all of them at once: several times
    faster than thousands of products of matrices of three rows.
    """
    a, b, omega, r = (
        np.ascontiguousarray(np.moveaxis(array, 0, -1)) for array in (jacobian_a, jacobian_b, information, residual)
    )
    omega_a, omega_b, omega_r = (np.einsum("kle,l...e->k...e", omega, array) for array in (a, b, r))
    for block, pair in zip(blocks, ((a, omega_a), (a, omega_b), (b, omega_b)), strict=True):
        np.einsum("kie,kje->ije", *pair, out=block)
    return np.einsum("kie,ke->ie", a, omega_r), np.einsum("kie,ke->ie", b, omega_r)


def _added_up(index: np.ndarray, values: np.ndarray, length: int) -> np.ndarray:
    """Values (d, E) added up by the variable (E,) they belong to: (length, d)."""
    return np.column_stack([np.bincount(index, weights=row, minlength=length) for row in values])
