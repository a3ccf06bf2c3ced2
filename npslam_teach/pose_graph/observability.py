"""Do the measurements determine every pose and landmark? If not, which one is under-constrained?

A variable that no chain of factors ties to a fixed one is found by walking the graph. Others are tied and still not
observable: a pose that sees a single landmark may circle around it. They show as a direction in the null space of H.
"""

import numpy as np

from npslam_teach.pose_graph.block_sparsity import BlockStructure
from npslam_teach.pose_graph.factor_kinds import FACTOR_KINDS
from npslam_teach.pose_graph.unknowns import name_of, named, steps_by_variable
from npslam_teach.types import PoseGraph

CONDITION_LIMIT = 1e10  # how much weaker than its own diagonal H may be in some direction before it is looked at closer
NULL = 1e-20  # a squared change of all residuals that is nothing but rounding, for a step of unit size


def require_factors(graph: PoseGraph) -> None:
    """Raise ``numpy.linalg.LinAlgError`` that names a variable which has no factor at all."""
    num_nodes = len(graph.poses) + len(graph.landmarks)
    has_factor = np.bincount(_edges(graph).ravel(), minlength=num_nodes) > 0
    has_factor[_fixed_nodes(graph)] = True
    if not has_factor.all():
        require_connected(graph)


def require_connected(graph: PoseGraph) -> None:
    """Raise ``numpy.linalg.LinAlgError`` that names a variable which no chain of factors ties to a fixed one."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    num_nodes, edges = len(graph.poses) + len(graph.landmarks), _edges(graph)
    adjacency = coo_array((np.ones(edges.shape[1]), tuple(edges)), shape=(num_nodes, num_nodes))
    _, component = connected_components(adjacency, directed=False)
    fixed = _fixed_nodes(graph)
    apart = np.flatnonzero(~np.isin(component, component[fixed]))
    if apart.size:
        anchor = _node_name(graph, fixed[0]) if len(fixed) == 1 else "any fixed vertex"
        raise np.linalg.LinAlgError(f"{_node_name(graph, apart[0])} is not tied to {anchor} by any chain of factors")


def require_observable(graph: PoseGraph, structure: BlockStructure, data: np.ndarray, factorize) -> None:
    """Raise ``numpy.linalg.LinAlgError`` that names a variable which the factors do not determine.

    Args:
        graph: the estimate at which H was assembled.
        structure: of H.
        data: (nnz,) the upper triangle of H.
        factorize: from ``factorization.factorizer``.
    """
    diagonal = data[structure.diagonal]
    if not (diagonal > 0).all():
        _refuse(graph, np.argmin(diagonal))
    # With its diagonal scaled to one, H has curvature about 1 where all is well. Its inverse makes the direction of
    # least curvature longest: power iteration finds it from any start that is not at right angles to it.
    root = np.sqrt(diagonal)
    direction = np.random.default_rng(0).choice([-1.0, 1.0], len(root)) / np.sqrt(len(root))
    try:
        if np.linalg.norm(root * factorize(data)(root * direction)) < CONDITION_LIMIT:
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
    # H times the direction would drown in rounding; the change of each residual does not.
    if _change_of_residuals(graph, direction / root) < NULL:
        _refuse(graph, np.argmax(np.abs(direction)))


def _refuse(graph: PoseGraph, unknown: int) -> None:
    raise np.linalg.LinAlgError(f"{name_of(graph, unknown)} is not determined by its factors: H is singular")


def _node_name(graph: PoseGraph, node: int) -> str:
    num_poses = len(graph.poses)
    return named(graph, "poses", node) if node < num_poses else named(graph, "landmarks", node - num_poses)


def _fixed_nodes(graph: PoseGraph) -> np.ndarray:
    return np.concatenate([graph.fixed_poses, graph.fixed_landmarks + len(graph.poses)])


def _edges(graph: PoseGraph) -> np.ndarray:
    """The two nodes (2, E) of every factor; nodes are poses, then landmarks."""
    first = {"poses": 0, "landmarks": len(graph.poses)}
    ends = [[end.index + first[end.variable] for end in kind.ends(graph)] for kind in FACTOR_KINDS]
    return np.concatenate(ends, axis=1)


def _change_of_residuals(graph: PoseGraph, dx: np.ndarray) -> float:
    """The weighted square of what a step (n,) changes in all residuals, to first order."""
    steps, total = steps_by_variable(graph, dx), 0.0
    for kind in FACTOR_KINDS:
        ends = kind.ends(graph)
        jacobians = kind.jacobians(*(end.estimate for end in ends))
        change = sum(
            np.einsum("eij,ej->ei", jacobian, steps[end.variable][end.index])
            for end, jacobian in zip(ends, jacobians, strict=True)
        )
        total += np.einsum("ei,eij,ej->", change, kind.information(graph), change)
    return float(total)
