"""A start without the drift of the odometry: all headings, then all positions, each by one linear solve.

Gauss-Newton depends on its start: from the end of a long integration of odometry it may climb, or end in a local
minimum. Only the headings make the problem nonlinear. Written as points on the unit circle, and let off the circle for
a moment, they solve a linear problem (Carlone et al., "Initialization techniques for 3D SLAM", ICRA 2015). With the
headings known, positions are linear too.
"""

from dataclasses import replace

import numpy as np

from npslam_teach.pose_graph.factorization import solve_once
from npslam_teach.pose_graph.linearization import linearize
from npslam_teach.pose_graph.observability import require_connected
from npslam_teach.pose_graph.unknowns import retract, unknowns_of
from npslam_teach.types import PoseGraph

WEAK = 1e-12  # the weight, against the strongest, that keeps headings where they are which no between factor determines


def chordal_start(graph: PoseGraph) -> PoseGraph:
    """The graph moved to the chordal start; what is fixed stays where it is.

    Headings come from the between factors alone. A pose that only observations tie to the rest keeps its heading.

    Args:
        graph: any connected graph. Of its estimate, only what the factors leave open is used.

    Raises:
        numpy.linalg.LinAlgError: when a pose or landmark is not tied to a fixed one by any chain of factors.
    """
    require_connected(graph)
    graph = replace(graph, poses=np.column_stack([graph.poses[:, :2], chordal_headings(graph)]))
    unknowns = unknowns_of(graph)
    if unknowns.count == 0:
        return graph
    # With the headings held still the residuals are linear in all positions: one step of Gauss-Newton is exact.
    h, b, _ = linearize(graph)
    of_poses = np.tile([True, True, False], (len(graph.poses), 1))
    of_landmarks = np.tile([True, True], (len(graph.landmarks), 1))
    positions = np.flatnonzero(unknowns.flatten({"poses": of_poses, "landmarks": of_landmarks}))
    dx = np.zeros(unknowns.count)
    dx[positions] = solve_once(h[positions][:, positions], -b[positions])
    return retract(graph, dx)


def chordal_headings(graph: PoseGraph) -> np.ndarray:
    """Headings (T,) rad that agree best with all between factors, as points on the unit circle.

    Heading j should be heading i turned by the measured angle. For complex numbers ``z = exp(i theta)`` that reads
    ``z_j = z_i exp(i dtheta)``, a linear equation; z of fixed poses is known.
    Of the solution only the directions are kept.
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
