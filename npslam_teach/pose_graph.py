"""The pose graph: the trajectory and the map that agree best with all measurements, by Gauss-Newton.

chi2 is the sum of ``r^T Omega r`` over all factors (no one-half). Around the present estimate every residual is
nearly linear, ``r + J dx``, and the best step of the linear problem solves the normal equations ``H dx = -b`` with
``H = sum J^T Omega J`` and ``b = sum J^T Omega r`` (Grisetti et al., "A Tutorial on Graph-Based SLAM", 2010).

* The unknowns are the world coordinates ``[x, y, theta]`` of poses 1, 2, ... and then ``[x, y]`` of the landmarks;
  the update is a plain addition with theta wrapped. ``scipy.optimize.least_squares`` on the same vector is therefore
  an exact oracle, and the marginal covariances are world ellipses.
* The whole map could be shifted and turned without any measurement noticing. This freedom, the *gauge*, is removed by
  leaving pose 0 out of the system. Adding the identity to H would give the same map and wrong covariances.
"""

import warnings
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from npslam_teach import se2
from npslam_teach.data import PoseGraph, checked_index
from npslam_teach.residuals import (
    between_jacobians,
    between_residual,
    observation_jacobians,
    observation_residual,
)
from npslam_teach.sparse import BlockGroup, BlockStructure, block_structure


@dataclass(frozen=True, eq=False)
class Step:
    """One Gauss-Newton iteration; iteration 0 is the graph as it was given."""

    iteration: int
    graph: PoseGraph  # after the step
    chi2: float  # after the step
    dx: np.ndarray  # (n,) the step itself: poses 1.., then landmarks
    damping: float  # 0 for a pure Gauss-Newton step
    converged: bool
    status: str  # why the iteration stopped, or "running"


def chi2(graph: PoseGraph) -> float:
    """The sum of ``r^T Omega r`` over all factors of the graph."""
    r_between, r_observation = _residuals(graph)
    return _weighted_square(r_between, graph.between.information) + _weighted_square(
        r_observation, graph.observations.information
    )


def linearize(graph: PoseGraph):
    """The normal equations at the present estimate.

    Returns:
        H (n, n) ``scipy.sparse.csc_array``, b (n,) and chi2. Unknowns: poses 1.. (three each), then landmarks (two
        each). Pose 0 is left out.
    """
    structure = graph_structure(graph)
    data, b, value = _assemble(graph, structure)
    return structure.natural_matrix(data), b, value


def gauss_newton(graph: PoseGraph, tolerance: float = 1e-9, max_iterations: int = 100) -> Iterator[Step]:
    """Improve the graph step by step.

    A step that would raise chi2 is shortened by damping (a multiple of H's own diagonal, Levenberg and Marquardt)
    until it lowers it.

    Args:
        graph: the start; pose 0 stays where it is.
        tolerance: stop when a step lowers chi2 by less than this share of it.
        max_iterations: stop after this many steps, converged or not.

    Yields:
        the start as iteration 0, then every step. The last one says whether it ``converged``.

    Raises:
        numpy.linalg.LinAlgError: when a pose or landmark is not determined by the factors.
    """
    if max_iterations < 1:
        raise ValueError(f"max_iterations: expected a positive number, got {max_iterations}")
    structure = graph_structure(graph)
    # A heading of many turns would swallow small steps in rounding.
    graph = replace(graph, poses=np.column_stack([graph.poses[:, :2], se2.wrap(graph.poses[:, 2])]))
    if structure.num_unknowns == 0:
        yield Step(0, graph, chi2(graph), np.zeros(0), 0.0, True, "converged")
        return
    step = Step(0, graph, chi2(graph), np.zeros(structure.num_unknowns), 0.0, False, "running")
    yield step
    while step.status == "running":
        data, b, before = _assemble(step.graph, structure)
        # A perfect fit ends at rounding error, of which no relative decrease can be asked.
        negligible = tolerance * before + 1e-20 * len(b)
        moved, after, dx, damping = _descend(step.graph, structure, data, b, before, negligible, step.damping)
        iteration, converged = step.iteration + 1, before - after <= negligible
        status = "converged" if converged else "iteration limit" if iteration >= max_iterations else "running"
        step = Step(iteration, moved, after, dx, damping, converged, status)
        yield step


def optimize(graph: PoseGraph, tolerance: float = 1e-9, max_iterations: int = 100) -> PoseGraph:
    """The graph at the minimum of chi2; warns where ``gauss_newton`` did not converge."""
    *_, last = gauss_newton(graph, tolerance, max_iterations)
    if not last.converged:
        warnings.warn(f"the solver stopped after {last.iteration} iterations: {last.status}", stacklevel=2)
    return last.graph


def marginal_covariance(graph: PoseGraph, poses=(), landmarks=()) -> tuple[np.ndarray, np.ndarray]:
    """Covariances of single poses and landmarks, all others integrated out: blocks of the inverse of H.

    They are relative to pose 0, whose own covariance is zero, and mean what they say at the minimum of chi2.

    Args:
        graph: at its minimum.
        poses: (P,) indices.
        landmarks: (L,) indices.

    Raises:
        ValueError: for an index that does not exist.

    Returns:
        (P, 3, 3) m, m, rad in W and (L, 2, 2) m in W.
    """
    structure = graph_structure(graph)
    solve = structure.factorize(_assemble(graph, structure)[0])
    poses = checked_index("poses", poses, len(graph.poses))
    landmarks = checked_index("landmarks", landmarks, len(graph.landmarks))
    free_pose_unknowns = 3 * (poses[poses > 0, None] - 1) + np.arange(3)
    landmark_unknowns = 3 * (len(graph.poses) - 1) + 2 * landmarks[:, None] + np.arange(2)
    pose_cov = np.zeros((len(poses), 3, 3))
    pose_cov[poses > 0] = _inverse_blocks(solve, free_pose_unknowns, structure.num_unknowns)
    return pose_cov, _inverse_blocks(solve, landmark_unknowns, structure.num_unknowns)


def graph_structure(graph: PoseGraph) -> BlockStructure:
    """Where the blocks of H go: blocks 0.. are poses 1.., then come the landmarks; pose 0 is held still.

    Raises:
        numpy.linalg.LinAlgError: when a pose or landmark is not tied to pose 0 by any chain of factors.
    """
    _require_connected(graph)
    free_poses = len(graph.poses) - 1
    i, j, pose = graph.between.i - 1, graph.between.j - 1, graph.observations.pose - 1  # pose 0 becomes FIXED
    landmark = graph.observations.landmark + free_poses
    groups = [
        BlockGroup(i, i, 3, 3),
        BlockGroup(i, j, 3, 3),
        BlockGroup(j, i, 3, 3),
        BlockGroup(j, j, 3, 3),
        BlockGroup(pose, pose, 3, 3),
        BlockGroup(pose, landmark, 3, 2),
        BlockGroup(landmark, pose, 2, 3),
        BlockGroup(landmark, landmark, 2, 2),
    ]
    return block_structure(np.repeat([3, 2], [free_poses, len(graph.landmarks)]), groups)


def _residuals(graph: PoseGraph) -> tuple[np.ndarray, np.ndarray]:
    poses, between, observations = graph.poses, graph.between, graph.observations
    return (
        between_residual(poses[between.i], poses[between.j], between.relative_pose),
        observation_residual(poses[observations.pose], graph.landmarks[observations.landmark], observations.xy),
    )


def _weighted_square(residual: np.ndarray, information: np.ndarray) -> float:
    return float(np.einsum("ei,eij,ej->", residual, information, residual))


def _assemble(graph: PoseGraph, structure: BlockStructure) -> tuple[np.ndarray, np.ndarray, float]:
    """All blocks ``J^T Omega J`` in their places, ``b`` (n,) and chi2."""
    poses, between, observations = graph.poses, graph.between, graph.observations
    seen = graph.landmarks[observations.landmark]
    r_between, r_observation = _residuals(graph)
    blocks, b_i, b_j = _normal_blocks(
        *between_jacobians(poses[between.i], poses[between.j]), between.information, r_between
    )
    observation_blocks, b_pose, b_landmark = _normal_blocks(
        *observation_jacobians(poses[observations.pose], seen), observations.information, r_observation
    )
    b_poses, b_landmarks = np.zeros_like(poses), np.zeros_like(graph.landmarks)
    np.add.at(b_poses, between.i, b_i)
    np.add.at(b_poses, between.j, b_j)
    np.add.at(b_poses, observations.pose, b_pose)
    np.add.at(b_landmarks, observations.landmark, b_landmark)
    data = structure.gather(np.concatenate([block.ravel() for block in blocks + observation_blocks]))
    value = _weighted_square(r_between, between.information)
    value += _weighted_square(r_observation, observations.information)
    return data, np.concatenate([b_poses[1:].ravel(), b_landmarks.ravel()]), value


def _normal_blocks(jacobian_a, jacobian_b, information, residual):
    """What factors between variables a and b add: blocks of H at aa, ab, ba, bb, and to b at a and b."""
    a_omega = jacobian_a.swapaxes(1, 2) @ information
    b_omega = jacobian_b.swapaxes(1, 2) @ information
    blocks = [a_omega @ jacobian_a, a_omega @ jacobian_b, b_omega @ jacobian_a, b_omega @ jacobian_b]
    return blocks, (a_omega @ residual[..., None])[..., 0], (b_omega @ residual[..., None])[..., 0]


def _descend(graph, structure, data, b, before, negligible, damping):
    """The Gauss-Newton step, damped as little as lowers chi2: the moved graph, its chi2, dx and the damping."""
    damping = damping / 10 if damping > 1e-8 else 0.0
    diagonal = data[structure.diagonal]
    while True:
        damped = data.copy()
        damped[structure.diagonal] += damping * diagonal
        dx = structure.factorize(damped)(-b)
        moved = _moved(graph, dx)
        after = chi2(moved)
        if after <= before:
            return moved, after, dx, damping
        if -b @ dx <= negligible:  # all that the linear problem still promises
            return graph, before, np.zeros_like(dx), damping
        damping = max(10 * damping, 1e-6)


def _moved(graph: PoseGraph, dx: np.ndarray) -> PoseGraph:
    poses, num_pose_unknowns = graph.poses.copy(), 3 * (len(graph.poses) - 1)
    poses[1:] += dx[:num_pose_unknowns].reshape(-1, 3)
    poses[:, 2] = se2.wrap(poses[:, 2])
    return replace(graph, poses=poses, landmarks=graph.landmarks + dx[num_pose_unknowns:].reshape(-1, 2))


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


def _require_connected(graph: PoseGraph) -> None:
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    num_poses, num_nodes = len(graph.poses), len(graph.poses) + len(graph.landmarks)
    ends = np.concatenate([graph.between.i, graph.observations.pose])
    other_ends = np.concatenate([graph.between.j, graph.observations.landmark + num_poses])
    edges = coo_array((np.ones(len(ends)), (ends, other_ends)), shape=(num_nodes, num_nodes))
    _, component = connected_components(edges, directed=False)
    loose = np.flatnonzero(component != component[0])
    if loose.size:
        node = loose[0]
        name = f"pose {node}" if node < num_poses else f"landmark {node - num_poses}"
        raise np.linalg.LinAlgError(f"{name} is not tied to pose 0 by any chain of factors")
