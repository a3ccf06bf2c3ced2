"""A pose graph without its poses: chi2 as a quadratic form in the landmarks alone, all poses integrated out.

Around the present estimate ``chi2 = chi2_0 + 2 b^T dx + dx^T H dx``. For any map the best trajectory is known in closed
form, and put back it leaves ``c - 2 eta^T l + l^T Lambda l`` with the Schur complement
``Lambda = H_ll - H_lx H_xx^-1 H_xl`` (Thrun and Montemerlo, "The GraphSLAM algorithm", 2006; Triggs et al., "Bundle
adjustment", 2000, section 6.1). A few landmarks then stand for thousands of poses, exactly as far as the graph is
linear: drift, correlations and loop closures are all in Lambda.
"""

from dataclasses import dataclass, replace

import numpy as np

from npslam_teach import se2
from npslam_teach.pose_graph.block_sparsity import SYMMETRIC
from npslam_teach.pose_graph.factorization import SINGULAR
from npslam_teach.pose_graph.linearization import linearize
from npslam_teach.types import PoseGraph

WIDEST_BAND = 5  # of a chain of poses: three unknowns each, tied to the next


@dataclass(frozen=True, eq=False)
class ReducedSystem:
    """``chi2(l) = constant - 2 vector^T l + l^T information l`` for landmarks l (2N,), m in W."""

    constant: float
    vector: np.ndarray  # (2N,) eta
    information: np.ndarray  # (2N, 2N) Lambda
    graph: PoseGraph  # around which it is linear
    _pose_step: np.ndarray  # (n,) of the poses while the landmarks stay
    _pose_response: np.ndarray  # (n, 2N) how the poses follow the landmarks

    def chi2(self, landmarks: np.ndarray) -> float:
        """The least chi2 that any trajectory allows with these landmarks (N, 2) m, W."""
        xy = np.ravel(landmarks)
        return float(self.constant + xy @ (self.information @ xy - 2 * self.vector))

    def graph_at(self, landmarks: np.ndarray) -> PoseGraph:
        """The graph with these landmarks (N, 2) m, W, and the trajectory that suits them best."""
        step = self._pose_step + self._pose_response @ np.ravel(landmarks - self.graph.landmarks)
        poses = np.array(self.graph.poses)
        poses[1:] += step.reshape(-1, 3)
        poses[:, 2] = se2.wrap(poses[:, 2])
        return replace(self.graph, poses=poses, landmarks=landmarks)


def reduced_system(graph: PoseGraph) -> ReducedSystem:
    """Linearize and eliminate the poses.

    Args:
        graph: the present estimate; its one fixed variable is pose 0.

    Raises:
        ValueError: something else is fixed.
        numpy.linalg.LinAlgError: the poses are not determined by the landmarks and the odometry.
    """
    if graph.fixed_poses.tolist() != [0] or len(graph.fixed_landmarks):
        raise ValueError("graph: expected pose 0 to be fixed and nothing else")
    (h, b, chi2), num_poses = linearize(graph), 3 * (len(graph.poses) - 1)
    of_poses, of_both = h[:num_poses, :num_poses], h[:num_poses, num_poses:]
    rhs = np.column_stack([b[:num_poses], of_both.toarray()])
    if num_poses:
        rhs = _solve(of_poses, rhs)
    step, response = -rhs[:, 0], -rhs[:, 1:]
    information = h[num_poses:, num_poses:].toarray() + of_both.T @ response
    information = (information + information.T) / 2
    gradient = b[num_poses:] + of_both.T @ step
    xy = graph.landmarks.ravel()
    vector = information @ xy - gradient
    constant = chi2 + b[:num_poses] @ step + xy @ (information @ xy) - 2 * xy @ gradient
    return ReducedSystem(float(constant), vector, information, graph, step, response)


def _solve(matrix, rhs: np.ndarray) -> np.ndarray:
    """Solve a sparse positive definite system for many right-hand sides (n, k).

    Poses along a chain of odometry make a narrow band, for which there is a much faster routine.
    """
    from scipy.linalg import LinAlgError, solveh_banded
    from scipy.sparse.linalg import splu

    entries = matrix.tocoo()
    offsets = entries.col - entries.row
    try:
        if np.abs(offsets).max() > WIDEST_BAND:
            return splu(matrix.tocsc(), **SYMMETRIC).solve(rhs)
        upper = offsets >= 0
        band = np.zeros((WIDEST_BAND + 1, matrix.shape[0]))
        band[WIDEST_BAND - offsets[upper], entries.col[upper]] = entries.data[upper]
        return solveh_banded(band, rhs)
    except (RuntimeError, LinAlgError):  # "Factor is exactly singular", "not positive definite"
        raise np.linalg.LinAlgError(SINGULAR) from None
