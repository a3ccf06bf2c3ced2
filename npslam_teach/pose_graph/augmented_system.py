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
from npslam_teach.pose_graph.unknowns import unknowns_of, within_bounds
from npslam_teach.types import PoseGraph

MOST_SPREAD = 1e8  # of the weights in a graph for which H does: half of the digits
SCALE = 1e-6  # c above, for columns of A of unit length: small beside them, large beside rounding


def weights_differ(graph: PoseGraph) -> bool:
    """Whether the largest and the smallest information on the diagonals are further apart than H can hold."""
    weights = np.concatenate([np.einsum("eii->ei", kind.information(graph)).ravel() for kind in FACTOR_KINDS])
    weights = weights[weights > 0]
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
    from scipy.sparse import csc_array

    (rows, columns, values), whitened = _whitened_entries(graph, at)
    num_rows, num_unknowns = len(whitened), unknowns_of(graph).count
    lengths = np.sqrt(np.bincount(columns, weights=values**2, minlength=num_unknowns))
    lengths[lengths == 0] = 1.0  # an unknown without any weight leaves the system singular, as it should
    values, below = values / lengths[columns], num_rows + columns
    i = j = np.arange(num_unknowns)
    added = np.full(num_unknowns, damping)
    if second_order is not None:
        term = second_order.tocoo()
        i, j = np.append(i, term.row), np.append(j, term.col)
        added = np.append(added, term.data / (lengths[term.row] * lengths[term.col]))
    own = np.arange(num_rows)
    entries = np.concatenate([np.full(num_rows, SCALE), values, values, -added / SCALE])
    places = np.concatenate([own, rows, below, num_rows + i]), np.concatenate([own, below, rows, num_rows + j])
    system = csc_array((entries, places), shape=(num_rows + num_unknowns,) * 2)
    try:
        step = -solve_once(system, np.append(whitened, np.zeros(num_unknowns)), pivoting=True)[num_rows:]
    except np.linalg.LinAlgError:
        return np.full(num_unknowns, np.inf), np.inf
    if not within_bounds(step / lengths):
        return step / lengths, np.inf
    change = np.bincount(rows, weights=values * step[columns], minlength=num_rows)
    return step / lengths, float(change @ change + (added * step[i]) @ step[j])


def _whitened_entries(graph: PoseGraph, at: Residuals) -> tuple[tuple[np.ndarray, ...], np.ndarray]:
    """The Jacobian and the residuals of all factors, divided by their standard deviations.

    Args: as in ``augmented_step``.

    Returns:
        row, column and value of every entry of ``A = L^T J``, and ``L^T r`` (m,), where ``Omega = L L^T``.
    """
    unknowns, entries, whitened, first = unknowns_of(graph), [], [], 0
    for kind, residual in zip(FACTOR_KINDS, at.by_kind, strict=True):
        if len(residual) == 0:
            continue
        ends, root = kind.ends(graph), _roots(kind.information(graph))
        row = first + np.arange(residual.size).reshape(*residual.shape, 1)
        for end, jacobian in zip(ends, kind.jacobians(*(end.estimate for end in ends)), strict=True):
            block = root @ jacobian
            column = np.broadcast_to(unknowns.of(end.variable, end.index, block.shape[2])[:, None, :], block.shape)
            free = column != FIXED
            entries.append((np.broadcast_to(row, block.shape)[free], column[free], block[free]))
        whitened.append((root @ residual[..., None]).ravel())
        first += residual.size
    rows, columns, values = (np.concatenate(each) for each in zip(*entries, strict=True))
    return (rows, columns, values), np.concatenate(whitened)


def _roots(information: np.ndarray) -> np.ndarray:
    """``L^T`` (E, d, d) of ``Omega = L L^T``; of what says nothing in some direction, another root."""
    try:
        return np.linalg.cholesky(information).swapaxes(1, 2)
    except np.linalg.LinAlgError:
        values, vectors = np.linalg.eigh(information)
        return np.sqrt(np.maximum(values, 0.0))[:, :, None] * vectors.swapaxes(1, 2)
