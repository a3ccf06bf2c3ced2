"""A start without the drift of the odometry: all headings, then all positions, each by one linear solve.

Gauss-Newton depends on its start: from the end of a long integration of odometry it may climb, or end in a local
minimum. Only the headings make the problem nonlinear. Written as points on the unit circle, and let off the circle for
a moment, they solve a linear problem (Carlone et al., "Initialization techniques for 3D SLAM", ICRA 2015). With the
headings known, positions are linear too.
"""

from dataclasses import replace

import numpy as np

from npslam_teach.pose_graph.block_sparsity import BlockStructure
from npslam_teach.pose_graph.factor_kinds import FACTOR_KINDS
from npslam_teach.pose_graph.factorization import SINGULAR, LinearSystem, solve_once
from npslam_teach.pose_graph.linearization import linear_system, normal_equations, residuals
from npslam_teach.pose_graph.observability import require_connected
from npslam_teach.pose_graph.unknowns import retract, steps_by_variable, unknowns_of, within_bounds
from npslam_teach.types import PoseGraph

WEAK = 1e-12  # the weight, against the strongest, that keeps headings where they are which no between factor determines


def chordal_start(graph: PoseGraph, system: LinearSystem | None = None) -> PoseGraph:
    """The graph moved to the chordal start; what is fixed stays where it is.

    Headings come from the between factors alone. A pose that only observations tie to the rest keeps its heading.

    Args:
        graph: any connected graph. Of its estimate, only what the factors leave open is used.
        system: the graph's ``linear_system``, where it is at hand already; whoever has it knows the graph as connected,
            or finds out soon.

    Raises:
        numpy.linalg.LinAlgError: when a pose or landmark is not tied to a fixed one by any chain of factors, or the
            factors do not determine all positions once the headings are known.
    """
    if system is None:
        require_connected(graph)
        system = linear_system(graph)
    if system.structure.num_unknowns == 0:
        return graph
    graph = replace(graph, poses=np.column_stack([graph.poses[:, :2], _headings(graph, system)]))
    # With the headings held still the residuals are linear in all positions: one step of Gauss-Newton is exact.
    data, b = normal_equations(graph, system.structure, residuals(graph))
    held = _unknowns_at(graph, poses=[False, False, True])
    data, b = _without(system.structure, data, held), np.where(held, 0.0, b)
    dx = system.factorize(data)(-b)
    if not within_bounds(dx):
        raise np.linalg.LinAlgError(SINGULAR)
    return retract(graph, dx)


def chordal_headings(graph: PoseGraph) -> np.ndarray:
    """Headings (T,) rad that agree best with all between factors, as points on the unit circle.

    Heading j should be heading i turned by the measured angle. For complex numbers ``z = exp(i theta)`` that reads
    ``z_j = z_i exp(i dtheta)``, a linear equation; z of fixed poses is known. Of the solution only the directions are
    kept. ``chordal_start`` finds the same headings faster.
    """
    from scipy.sparse import csc_array, diags_array

    i, j, num_poses = graph.between.i, graph.between.j, len(graph.poses)
    rows, weight = np.arange(len(i)), graph.between.information[:, 2, 2]
    turn = np.exp(1j * graph.between.relative_pose[:, 2])
    entries = np.concatenate([np.ones(len(i)), -turn]), (np.tile(rows, 2), np.concatenate([j, i]))
    error = csc_array(entries, shape=(len(i), num_poses))  # times z: how far each factor is from being satisfied
    z = np.exp(1j * graph.poses[:, 2])
    weak = WEAK * weight.max(initial=1.0)
    normal = (error.conj().T @ diags_array(weight) @ error).tocsr()
    free, fixed = unknowns_of(graph).free["poses"], graph.fixed_poses
    headings = graph.poses[:, 2].copy()
    if len(free):
        h = normal[free][:, free] + weak * diags_array(np.ones(len(free)))
        headings[free] = np.angle(solve_once(h, weak * z[free] - normal[free][:, fixed] @ z[fixed]))
    return headings


def _headings(graph: PoseGraph, system: LinearSystem) -> np.ndarray:
    """``chordal_headings`` by the graph's own linear system: cos and sin of a heading stand where x and y would."""
    weight, turn = graph.between.information[:, 2, 2], np.exp(1j * graph.between.relative_pose[:, 2])
    weak, now = WEAK * weight.max(initial=1.0), np.exp(1j * graph.poses[:, 2])
    data = _heading_matrix(system.structure, weight, turn)
    used = _unknowns_at(graph, poses=[True, True, False])
    data[system.structure.diagonal] += np.where(used, weak, 1.0)
    # Fixed headings are known; what they ask of their neighbours is the right-hand side.
    z, i, j = np.zeros_like(now), graph.between.i, graph.between.j
    z[graph.fixed_poses] = now[graph.fixed_poses]
    pull = weight * (turn * z[i] - z[j])
    rhs = weak * now
    np.add.at(rhs, j, pull)
    np.add.at(rhs, i, -turn.conj() * pull)
    rhs = np.column_stack([rhs.real, rhs.imag, np.zeros(len(rhs))])
    rhs = unknowns_of(graph).flatten({"poses": rhs, "landmarks": np.zeros_like(graph.landmarks)})
    cos, sin, _ = steps_by_variable(graph, system.factorize(data)(rhs))["poses"].T
    headings = np.arctan2(sin, cos)
    headings[graph.fixed_poses] = graph.poses[graph.fixed_poses, 2]
    return headings


def _heading_matrix(structure: BlockStructure, weight: np.ndarray, turn: np.ndarray) -> np.ndarray:
    """The ``data`` (nnz,) of ``sum weight |z_j - turn z_i|^2`` over the between factors, in (cos, sin) of the poses."""
    values = structure.scratch
    values.fill(0.0)
    blocks = iter(structure.blocks(values))
    for kind in FACTOR_KINDS:
        aa, ab, bb = (next(blocks) for _ in range(3))
        if kind.name == "between":
            for k in range(2):
                aa[k, k] = bb[k, k] = weight
                ab[k, k] = -weight * turn.real
            ab[0, 1], ab[1, 0] = -weight * turn.imag, weight * turn.imag
    return structure.gather(values)


def _unknowns_at(graph: PoseGraph, poses: list[bool]) -> np.ndarray:
    """(n,) whether each unknown is one of these three of a pose; no unknown of a landmark is."""
    of_poses, of_landmarks = np.tile(poses, (len(graph.poses), 1)), np.zeros_like(graph.landmarks, dtype=bool)
    return unknowns_of(graph).flatten({"poses": of_poses, "landmarks": of_landmarks})


def _without(structure: BlockStructure, data: np.ndarray, held: np.ndarray) -> np.ndarray:
    """The matrix with the rows and columns of what is held replaced by those of the identity."""
    columns = np.repeat(held, np.diff(structure.indptr))
    data = np.where(columns | held[structure.indices], 0.0, data)
    data[structure.diagonal[held]] = 1.0
    return data
