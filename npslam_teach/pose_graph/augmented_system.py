"""A Gauss-Newton step for measurements of very different weight, from which nothing is lost by adding up.

``H = J^T Omega J`` adds up the information of all factors of a variable. Where one weighs 1e10 and another 1e-6,
sixteen digits do not hold the sum, and what the weak one says drowns. With ``A = L^T J`` and ``e = L^T r``, where
``Omega = L L^T``, the same step is part of the solution of the *augmented* system

    [ c I   A ] [ f / c ]   [ e ]
    [ A^T   0 ] [  -dx  ] = [ 0 ],        f = e + A dx,

in which every factor keeps rows of its own, for any c > 0 (Bjorck, "Numerical Methods for Least Squares Problems",
1996, sections 2.5 and 4.4.2). It is several times as large as H, and has to be solved with pivoting.
"""

import numpy as np

from npslam_teach.pose_graph.block_sparsity import FIXED
from npslam_teach.pose_graph.factor_kinds import FACTOR_KINDS
from npslam_teach.pose_graph.factorization import solve_once
from npslam_teach.pose_graph.linearization import Residuals
from npslam_teach.pose_graph.unknowns import unknowns_of
from npslam_teach.types import PoseGraph

MOST_SPREAD = 1e8  # of the weights in a graph for which H does: half of the digits
SCALE = 1e-6  # c above, for columns of A of unit length: small beside them, large beside rounding


def weights_differ(graph: PoseGraph) -> bool:
    """Whether the largest and the smallest information on the diagonals are further apart than H can hold."""
    weights = np.concatenate([np.einsum("eii->ei", kind.information(graph)).ravel() for kind in FACTOR_KINDS])
    return weights.max(initial=0.0) > MOST_SPREAD * weights.min(initial=np.inf)


def augmented_step(
    graph: PoseGraph, at: Residuals, damping: float = 0.0, second_order=None
) -> tuple[np.ndarray, float]:
    """The step of Gauss-Newton at the present estimate.

    Args:
        graph: the present estimate.
        at: the residuals there.
        damping: how much of its own diagonal is added to H (Levenberg 1944, Marquardt 1963).
        second_order: (n, n) SciPy sparse, what else is added to it; None is nothing.

    Returns:
        dx (n,), infinite where the system is singular, and the reduction of chi2 that it brings if all is linear.
    """
    from scipy.sparse import block_array, eye_array

    jacobian, whitened = whitened_system(graph, at)
    lengths = np.sqrt(jacobian.multiply(jacobian).sum(axis=0))
    scaled, (num_rows, num_unknowns) = jacobian.multiply(1 / lengths), jacobian.shape
    added = damping * eye_array(num_unknowns)
    if second_order is not None:
        added = added + second_order.multiply(1 / lengths).multiply(1 / lengths[:, None])
    blocks = [[SCALE * eye_array(num_rows), scaled], [scaled.T, -added / SCALE]]
    try:
        solution = solve_once(block_array(blocks), np.append(whitened, np.zeros(num_unknowns)), pivoting=True)
    except np.linalg.LinAlgError:
        return np.full(num_unknowns, np.inf), np.inf
    step = -solution[num_rows:]
    change = scaled @ step
    return step / lengths, float(change @ change + step @ (added @ step))


def whitened_system(graph: PoseGraph, at: Residuals):
    """The Jacobian and the residuals of all factors, divided by their standard deviations.

    Args: as in ``augmented_step``.

    Returns:
        ``L^T J``, a ``scipy.sparse.csc_array`` (m, n), and ``L^T r`` (m,), where ``Omega = L L^T``.
    """
    from scipy.sparse import csc_array

    unknowns, values, rows, columns, whitened, first = unknowns_of(graph), [], [], [], [], 0
    for kind, residual in zip(FACTOR_KINDS, at.by_kind, strict=True):
        if len(residual) == 0:
            continue
        ends, root = kind.ends(graph), np.linalg.cholesky(kind.information(graph)).swapaxes(1, 2)
        row = first + np.arange(residual.size).reshape(*residual.shape, 1)
        for end, jacobian in zip(ends, kind.jacobians(*(end.estimate for end in ends)), strict=True):
            block = root @ jacobian
            column = np.broadcast_to(unknowns.of(end.variable, end.index, block.shape[2])[:, None, :], block.shape)
            free = column != FIXED
            values.append(block[free])
            rows.append(np.broadcast_to(row, block.shape)[free])
            columns.append(column[free])
        whitened.append((root @ residual[..., None]).ravel())
        first += residual.size
    places = np.concatenate(rows), np.concatenate(columns)
    return csc_array((np.concatenate(values), places), shape=(first, unknowns.count)), np.concatenate(whitened)
