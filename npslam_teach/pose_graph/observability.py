"""Do the measurements determine every pose and landmark? If not, which one is loose?

A variable that no chain of factors ties to pose 0 is found by walking the graph. Others are tied, and can still move
without any measurement noticing: a pose that sees a single object may circle around it. These show as a direction in
which H has no curvature.
"""

import numpy as np

from npslam_teach.pose_graph.block_sparsity import BlockStructure
from npslam_teach.pose_graph.residuals import between_jacobians, observation_jacobians
from npslam_teach.types import PoseGraph

SUSPICIOUS = 1e10  # how much weaker than its own diagonal H may be in some direction before anybody looks closer
UNNOTICED = 1e-20  # a squared change of all residuals that is nothing but rounding, for a step of unit size


def require_touched(graph: PoseGraph) -> None:
    """Raise ``numpy.linalg.LinAlgError`` that names a variable which has no factor at all."""
    num_nodes = len(graph.poses) + len(graph.landmarks)
    touched = np.bincount(np.concatenate(_factor_ends(graph), axis=1).ravel(), minlength=num_nodes)
    if not touched[1:].all():
        require_connected(graph)


def require_connected(graph: PoseGraph) -> None:
    """Raise ``numpy.linalg.LinAlgError`` that names a variable which no chain of factors ties to pose 0."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    num_nodes, ends = len(graph.poses) + len(graph.landmarks), np.concatenate(_factor_ends(graph), axis=1)
    edges = coo_array((np.ones(ends.shape[1]), tuple(ends)), shape=(num_nodes, num_nodes))
    _, component = connected_components(edges, directed=False)
    loose = np.flatnonzero(component != component[0])
    if loose.size:
        raise np.linalg.LinAlgError(f"{_name(graph, loose[0])} is not tied to pose 0 by any chain of factors")


def require_determined(graph: PoseGraph, structure: BlockStructure, data: np.ndarray, factorize) -> None:
    """Raise ``numpy.linalg.LinAlgError`` that names a variable which can move without any measurement noticing.

    Args:
        graph: the estimate at which H was assembled.
        structure: of H.
        data: (nnz,) the upper triangle of H.
        factorize: from ``factorization.factorizer``.
    """
    diagonal = data[structure.diagonal]
    if not (diagonal > 0).all():
        _refuse(graph, np.argmin(diagonal))
    # With its diagonal scaled to one, H has curvature about 1 where all is well. What H's inverse makes longest is the
    # direction of least curvature; any start finds it that is not at right angles to it.
    root = np.sqrt(diagonal)
    direction = np.random.default_rng(0).choice([-1.0, 1.0], len(root)) / np.sqrt(len(root))
    try:
        if np.linalg.norm(root * factorize(data)(root * direction)) < SUSPICIOUS:
            return
    except np.linalg.LinAlgError:
        pass  # a pivot is zero: all the more reason to look closer
    require_connected(graph)
    nearly = data.copy()
    nearly[structure.diagonal] *= 1 + 1e-12
    solve = factorize(nearly)
    for _ in range(5):
        direction = root * solve(root * direction)
        direction /= np.linalg.norm(direction)
    # H times the direction would drown in rounding; what each residual notices does not.
    if _noticed(graph, direction / root) < UNNOTICED:
        _refuse(graph, np.argmax(np.abs(direction)))


def _refuse(graph: PoseGraph, unknown: int) -> None:
    num_pose_unknowns = 3 * (len(graph.poses) - 1)
    node = unknown // 3 + 1 if unknown < num_pose_unknowns else (unknown - num_pose_unknowns) // 2 + len(graph.poses)
    raise np.linalg.LinAlgError(
        f"{_name(graph, node)} can move and no measurement would notice: its factors do not determine it, H is singular"
    )


def _name(graph: PoseGraph, node: int) -> str:
    num_poses = len(graph.poses)
    return f"pose {node}" if node < num_poses else f"landmark {node - num_poses}"


def _factor_ends(graph: PoseGraph) -> tuple[np.ndarray, np.ndarray]:
    """The two nodes (2, E) of every between factor and (2, M) of every observation; nodes are poses, then landmarks."""
    landmark = graph.observations.landmark + len(graph.poses)
    return np.stack([graph.between.i, graph.between.j]), np.stack([graph.observations.pose, landmark])


def _noticed(graph: PoseGraph, dx: np.ndarray) -> float:
    """The weighted square of what a step (n,) changes in all residuals."""
    split = 3 * (len(graph.poses) - 1)
    pose_steps = np.concatenate([np.zeros((1, 3)), dx[:split].reshape(-1, 3)])
    landmark_steps = dx[split:].reshape(-1, 2)
    between, observations = graph.between, graph.observations
    by_i, by_j = between_jacobians(graph.poses[between.i], graph.poses[between.j])
    seen = graph.landmarks[observations.landmark]
    by_pose, by_landmark = observation_jacobians(graph.poses[observations.pose], seen)
    total = 0.0
    for information, by_a, step_a, by_b, step_b in (
        (between.information, by_i, pose_steps[between.i], by_j, pose_steps[between.j]),
        (
            observations.information,
            by_pose,
            pose_steps[observations.pose],
            by_landmark,
            landmark_steps[observations.landmark],
        ),
    ):
        change = np.einsum("eij,ej->ei", by_a, step_a) + np.einsum("eij,ej->ei", by_b, step_b)
        total += np.einsum("ei,eij,ej->", change, information, change)
    return float(total)
