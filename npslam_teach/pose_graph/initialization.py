"""A start that owes nothing to the odometry's drift: all headings, then all positions, each by one linear solve.

Gauss-Newton goes downhill from where it is put. Put at the end of a long integration of odometry, it may go down into
the wrong valley. Headings are what makes the problem curved. Written as points on the unit circle, and let off the
circle for a moment, they solve a linear problem (Carlone et al., "Initialization techniques for 3D SLAM", ICRA 2015).
With the headings known, positions are linear too.
"""

from dataclasses import replace

import numpy as np

from npslam_teach.pose_graph.linearization import linearize
from npslam_teach.pose_graph.observability import require_connected
from npslam_teach.types import PoseGraph

WEAK = 1e-12  # the weight, against the strongest, that keeps headings where they are which no between factor determines


def chordal_start(graph: PoseGraph) -> PoseGraph:
    """The graph moved to the chordal start; pose 0 stays where it is.

    Headings come from the between factors alone. A pose that only sightings tie to the rest keeps the heading it has.

    Args:
        graph: any connected graph. Of its estimate, only what the factors leave open is used.

    Raises:
        numpy.linalg.LinAlgError: when a pose or landmark is not tied to pose 0 by any chain of factors.
    """
    require_connected(graph)
    graph = replace(graph, poses=np.column_stack([graph.poses[:, :2], chordal_headings(graph)]))
    num_moving, num_landmarks = len(graph.poses) - 1, len(graph.landmarks)
    if num_moving + num_landmarks == 0:
        return graph
    # With the headings held still the residuals are linear in all positions: one step of Gauss-Newton is exact.
    h, b, _ = linearize(graph)
    positions = np.flatnonzero(np.append(np.tile([True, True, False], num_moving), np.ones(2 * num_landmarks, bool)))
    step = _solve(h[positions][:, positions], -b[positions])
    poses = graph.poses.copy()
    poses[1:, :2] += step[: 2 * num_moving].reshape(-1, 2)
    return replace(graph, poses=poses, landmarks=graph.landmarks + step[2 * num_moving :].reshape(-1, 2))


def chordal_headings(graph: PoseGraph) -> np.ndarray:
    """Headings (T,) rad that agree best with all between factors, as points on the unit circle.

    Heading j should be heading i turned by the measured angle. For complex numbers ``z = exp(i theta)`` that reads
    ``z_j = z_i exp(i dtheta)``, a linear equation; z_0 is known. Of the solution only the directions are kept.
    """
    from scipy.sparse import csc_array, diags_array

    i, j, num_poses = graph.between.i, graph.between.j, len(graph.poses)
    rows, weight = np.arange(len(i)), graph.between.information[:, 2, 2]
    turn = np.exp(1j * graph.between.relative_pose[:, 2])
    entries = np.concatenate([np.ones(len(i)), -turn]), (np.tile(rows, 2), np.concatenate([j, i]))
    error = csc_array(entries, shape=(len(i), num_poses))  # times z: how far each factor is from being satisfied
    start = np.exp(1j * graph.poses[:, 2])
    weak = WEAK * weight.max(initial=1.0)
    normal = error.conj().T @ diags_array(weight) @ error
    h = (normal + weak * diags_array(np.ones(num_poses))).tocsc()[1:, 1:]
    rhs = weak * start[1:] - normal[1:, [0]].toarray()[:, 0] * start[0]
    return np.append(graph.poses[0, 2], np.angle(_solve(h, rhs)) if num_poses > 1 else [])


def _solve(h, rhs: np.ndarray) -> np.ndarray:
    """Solve a sparse Hermitian system, once."""
    from scipy.sparse.linalg import splu

    options = {"SymmetricMode": True}
    return splu(h.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options).solve(rhs)
