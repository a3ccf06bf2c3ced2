"""A pose graph without its poses: chi2 as a quadratic form in the landmarks alone, all poses integrated out.

Around the present estimate ``chi2 = chi2_0 + 2 b^T dx + dx^T H dx``. For any map the best trajectory is known in closed
form, and put back it leaves ``c - 2 eta^T l + l^T Lambda l`` with the Schur complement
``Lambda = H_ll - H_lx H_xx^-1 H_xl`` (Thrun and Montemerlo, "The GraphSLAM algorithm", 2006; Triggs et al., "Bundle
adjustment", 2000, section 6.1). A few landmarks then stand for thousands of poses, exactly as far as the graph is
linear: drift, correlations and loop closures are all in Lambda.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from npslam_teach import se2
from npslam_teach.pose_graph.block_sparsity import SYMMETRIC
from npslam_teach.pose_graph.factorization import SINGULAR
from npslam_teach.pose_graph.linearization import linearize
from npslam_teach.types import PoseGraph

WIDEST_BAND = 5  # of a chain of poses: three unknowns each, tied to the next
STRETCH = 3 * 64  # unknowns of a chain that are eliminated together


@dataclass(frozen=True, eq=False)
class ReducedSystem:
    """``chi2(l) = constant - 2 vector^T l + l^T information l`` for landmarks l (2N,), m in W."""

    constant: float
    vector: np.ndarray  # (2N,) eta
    information: np.ndarray  # (2N, 2N) Lambda
    graph: PoseGraph  # around which it is linear
    _pose_gradient: np.ndarray  # (n,) b of the poses
    _of_both: object  # (n, 2N) H of the poses with the landmarks, SciPy sparse
    _solve: Callable[[np.ndarray], np.ndarray]  # a right-hand side (n,) with H of the poses

    def chi2(self, landmarks: np.ndarray) -> float:
        """The least chi2 that any trajectory allows with these landmarks (N, 2) m, W."""
        xy = np.ravel(landmarks)
        return float(self.constant + xy @ (self.information @ xy - 2 * self.vector))

    def graph_at(self, landmarks: np.ndarray) -> PoseGraph:
        """The graph with these landmarks (N, 2) m, W, and the trajectory that suits them best."""
        step = -self._solve(self._pose_gradient + self._of_both @ np.ravel(landmarks - self.graph.landmarks))
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
    solve, integrated_out = _eliminated(of_poses, of_both)
    step, information = -solve(b[:num_poses]), h[num_poses:, num_poses:].toarray() - integrated_out
    information = (information + information.T) / 2
    gradient = b[num_poses:] + of_both.T @ step
    xy = graph.landmarks.ravel()
    vector = information @ xy - gradient
    constant = chi2 + b[:num_poses] @ step + xy @ (information @ xy) - 2 * xy @ gradient
    return ReducedSystem(float(constant), vector, information, graph, b[:num_poses], of_both, solve)


def _eliminated(of_poses, of_both) -> tuple[Callable[[np.ndarray], np.ndarray], np.ndarray]:
    """How to solve with H of the poses (n, n), and what they take from the landmarks: ``H_lx H_xx^-1 H_xl`` (2N, 2N).

    Poses along a chain of odometry make a narrow band, for which there is a much faster way.
    """
    from scipy.linalg import LinAlgError, cho_solve_banded, cholesky_banded
    from scipy.sparse.linalg import splu

    if not of_poses.shape[0]:
        return lambda rhs: rhs, np.zeros((of_both.shape[1], of_both.shape[1]))
    entries = of_poses.tocoo()
    offsets = entries.col - entries.row
    try:
        if np.abs(offsets).max() > WIDEST_BAND:
            solve = splu(of_poses.tocsc(), **SYMMETRIC).solve
            return solve, of_both.T @ solve(of_both.toarray())
        upper = offsets >= 0
        band = np.zeros((WIDEST_BAND + 1, of_poses.shape[0]))
        band[WIDEST_BAND - offsets[upper], entries.col[upper]] = entries.data[upper]
        factor = cholesky_banded(band)
        return lambda rhs: cho_solve_banded((factor, False), rhs), _of_chain(factor, of_both.tocsr())
    except (RuntimeError, LinAlgError):  # "Factor is exactly singular", "not positive definite"
        raise np.linalg.LinAlgError(SINGULAR) from None


def _of_chain(factor: np.ndarray, of_both) -> np.ndarray:
    """``Y^T Y`` with ``Y = U^-T H_xl`` (n, 2N), for a chain whose H of the poses is ``U^T U``; by stretches of it.

    A landmark that is out of sight is tied to the later poses through the last one before them alone. Of a stretch,
    ``Y = Q last + Z``: ``last`` are the three rows of the pose before it, Q carries them on, and Z is zero but for
    landmarks in sight. So a stretch adds to all the others a matrix of rank three, whatever its length.

    Args:
        factor: (6, n) U in LAPACK's banded form.
        of_both: (n, 2N) H_xl, by rows.
    """
    from scipy.linalg.lapack import dtbtrs

    gram, last, ranks = np.zeros((of_both.shape[1],) * 2), np.zeros((3, of_both.shape[1])), []
    row, starts = np.repeat(np.arange(of_both.shape[0]), np.diff(of_both.indptr)), of_both.indptr
    for begin in range(0, of_both.shape[0], STRETCH):
        height = min(STRETCH, of_both.shape[0] - begin)
        entries = slice(starts[begin], starts[begin + height])
        seen, place = np.unique(of_both.indices[entries], return_inverse=True)
        rhs = np.zeros((height, 3 + len(seen)), order="F")
        rhs[:3, :3] = -_tie(factor, begin)
        rhs[row[entries] - begin, 3 + place] = of_both.data[entries]
        carried = dtbtrs(factor[:, begin : begin + STRETCH], rhs, uplo="U", trans="T")[0]
        q, z = carried[:, :3], carried[:, 3:]
        cross = last.T @ (q.T @ z)
        gram[:, seen] += cross
        gram[seen] += cross.T
        gram[np.ix_(seen, seen)] += z.T @ z
        ranks.append(np.linalg.qr(q, mode="r") @ last)
        last = q[-3:] @ last
        last[:, seen] += z[-3:]
    ranks = np.concatenate(ranks)
    return gram + ranks.T @ ranks


def _tie(factor: np.ndarray, begin: int) -> np.ndarray:
    """The block (3, 3) of ``U^T`` that ties the pose whose rows begin there to the one before it."""
    tie = np.zeros((3, 3))
    for i in range(3 if begin else 0):
        for j in range(3):
            tie[i, j] = factor[WIDEST_BAND - 3 - i + j, begin + i]
    return tie
