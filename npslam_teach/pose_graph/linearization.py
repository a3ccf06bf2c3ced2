"""The normal equations of a pose graph: from factors to ``H dx = -b``, all factors of a kind at once.

Around the present estimate every residual is nearly linear, ``r + J dx``. The step that makes
``sum (r + J dx)^T Omega (r + J dx)`` smallest solves ``H dx = -b`` with ``H = sum J^T Omega J`` and
``b = sum J^T Omega r`` (Grisetti et al., "A Tutorial on Graph-Based SLAM", 2010). ``unknowns`` says which number of dx
is which.
"""

from typing import NamedTuple

import numpy as np

from npslam_teach import se2
from npslam_teach.pose_graph.block_sparsity import BlockGroup, BlockStructure, block_structure
from npslam_teach.pose_graph.factor_kinds import FACTOR_KINDS
from npslam_teach.pose_graph.factorization import LinearSystem, factorizer
from npslam_teach.pose_graph.unknowns import VARIABLES, unknowns_of
from npslam_teach.types import PoseGraph


class Residuals(NamedTuple):
    """How far every factor is from being satisfied, and all of it in one number."""

    by_kind: tuple[np.ndarray, ...]  # (E, d) for every kind of factor, in the frame of the measuring pose
    chi2: float  # the sum of r^T Omega r, no one-half


def residuals(graph: PoseGraph) -> Residuals:
    """The residuals of all factors at the present estimate."""
    by_kind = tuple(kind.residuals(graph) for kind in FACTOR_KINDS)
    parts = zip(by_kind, (kind.information(graph) for kind in FACTOR_KINDS), strict=True)
    return Residuals(by_kind, sum(_weighted_square(residual, information) for residual, information in parts))


def chi2(graph: PoseGraph) -> float:
    """The sum of ``r^T Omega r`` over all factors of the graph."""
    return residuals(graph).chi2


def linearize(graph: PoseGraph):
    """The normal equations at the present estimate.

    Returns:
        H (n, n) ``scipy.sparse.csc_array``, b (n,) and chi2. Unknowns: the free poses (three each; pose 0 is fixed
        unless the graph says otherwise), then the landmarks (two each).
    """
    structure, at = graph_structure(graph), residuals(graph)
    data, b = normal_equations(graph, structure, at)
    return structure.matrix(data), b, at.chi2


def graph_structure(graph: PoseGraph) -> BlockStructure:
    """Where the blocks of H go: a row and a column of blocks for every free variable, in the order of dx."""
    unknowns, groups = unknowns_of(graph), []
    for kind in FACTOR_KINDS:
        (a, size_a), (b, size_b) = (
            (unknowns.block[end.variable][end.index], end.estimate.shape[1]) for end in kind.ends(graph)
        )
        groups += [BlockGroup(a, a, size_a, size_a), BlockGroup(a, b, size_a, size_b), BlockGroup(b, b, size_b, size_b)]
    return block_structure(unknowns.sizes, groups)


def linear_system(graph: PoseGraph, library: str | None = None) -> LinearSystem:
    """The linear systems of a graph, whatever its estimate.

    Args:
        graph: whose factors say which variables are tied together.
        library: that solves them, see ``factorization.factorizer``.
    """
    structure = graph_structure(graph)
    return LinearSystem(structure, factorizer(structure, library))


def normal_equations(graph: PoseGraph, structure: BlockStructure, at: Residuals) -> tuple[np.ndarray, np.ndarray]:
    """All blocks of H in their places, and b.

    Args:
        graph: the present estimate.
        structure: from ``graph_structure``; it depends on who is tied to whom, not on the estimate.
        at: the residuals there.

    Returns:
        the ``data`` (nnz,) of the structure's upper triangle, and b (n,).
    """
    values = structure.scratch
    blocks, b = iter(structure.blocks(values)), {name: np.zeros_like(getattr(graph, name)) for name in VARIABLES}
    for kind, residual in zip(FACTOR_KINDS, at.by_kind, strict=True):
        of_kind = [next(blocks) for _ in range(3)]
        if len(residual) == 0:
            continue
        ends = kind.ends(graph)
        jacobians = kind.jacobians(*(end.estimate for end in ends))
        shares = _fill(of_kind, *jacobians, kind.information(graph), residual)
        for end, share in zip(ends, shares, strict=True):
            b[end.variable] = b[end.variable] + _added_up(end.index, share, len(getattr(graph, end.variable)))
    return structure.gather(values), unknowns_of(graph).flatten(b)


def gradient(graph: PoseGraph, at: Residuals) -> np.ndarray:
    """The vector b (n,) alone, half the derivative of chi2 by the unknowns: ``sum J^T Omega r``.

    Args: as in ``normal_equations``.
    """
    b = {name: np.zeros_like(getattr(graph, name)) for name in VARIABLES}
    for kind, residual in zip(FACTOR_KINDS, at.by_kind, strict=True):
        ends, force = kind.ends(graph), _weighted(residual, kind.information(graph))
        jacobians = kind.jacobians(*(end.estimate for end in ends)) if len(force) else ()
        for end, jacobian in zip(ends, jacobians, strict=False):
            b[end.variable] += _added_up(end.index, np.einsum("eki,ek->ie", jacobian, force), len(b[end.variable]))
    return unknowns_of(graph).flatten(b)


def second_order_term(graph: PoseGraph, structure: BlockStructure, at: Residuals) -> np.ndarray:
    """What Gauss-Newton leaves out of the second derivative of chi2 / 2: ``sum (Omega r)^T d^2 r``, in its places.

    It is small beside H where the residuals are small or nearly linear. In a large-residual problem, such as a long
    chain that odometry and observations bend against each other, it matters: there ``H + second_order_term`` is the
    derivative of b, and H alone is not (Nocedal and Wright, "Numerical Optimization", 2006, section 10.3).

    Args: as in ``normal_equations``.

    Returns:
        (nnz,) for the upper triangle, like the ``data`` of H. Their sum need not be positive definite.
    """
    values = structure.scratch
    values.fill(0.0)
    blocks = iter(structure.blocks(values))
    for kind, residual in zip(FACTOR_KINDS, at.by_kind, strict=True):
        (a, b), (aa, ab, _) = kind.ends(graph), (next(blocks) for _ in range(3))
        if not kind.displaces:
            continue
        force = _weighted(residual, kind.information(graph))[:, :2]
        _fill_second_order_term(aa, ab, a.estimate[:, 2], b.estimate[:, :2] - a.estimate[:, :2], force)
    return structure.gather(values)


def _fill_second_order_term(aa: np.ndarray, ab: np.ndarray, theta, difference, force) -> None:
    """Write the second derivatives of ``force . R(theta)^T (b - a)``, by pose a = (xy, theta) and by b.

    The derivative by b, ``R force``, turns with theta; whatever depends on b - a alone is linear.

    Args:
        aa: (3, 3, E), zero.
        ab: (3, 2 or 3, E), zero.
        theta: (E,) rad.
        difference: (E, 2) m, b - a in W.
        force: (E, 2) Omega r, held still.
    """
    gradient = se2.rotate(theta, force).T
    turned = np.stack([-gradient[1], gradient[0]])
    aa[:2, 2] = aa[2, :2] = -turned
    aa[2, 2] = -(gradient * difference.T).sum(axis=0)
    ab[2, :2] = turned


def _weighted(residual: np.ndarray, information: np.ndarray) -> np.ndarray:
    """``Omega r`` of every factor, (E, d)."""
    return np.einsum("eij,ej->ei", information, residual)


def _weighted_square(residual: np.ndarray, information: np.ndarray) -> float:
    return float(np.einsum("ei,ei->", residual, _weighted(residual, information)))


def _fill(blocks: list[np.ndarray], jacobian_a, jacobian_b, information, residual) -> tuple[np.ndarray, np.ndarray]:
    """Write what factors between variables a and b add to H into its blocks aa, ab and bb; return what they add to b.

    The factors are moved to the last axis, where one sum over k or l runs through all of them at once: several times
    faster than thousands of products of matrices of three rows.
    """
    a, b, omega, r = (_factors_last(array) for array in (jacobian_a, jacobian_b, information, residual))
    omega_a, omega_b, omega_r = (np.einsum("kle,l...e->k...e", omega, array) for array in (a, b, r))
    for block, pair in zip(blocks, ((a, omega_a), (a, omega_b), (b, omega_b)), strict=True):
        np.einsum("kie,kje->ije", *pair, out=block)
    return np.einsum("kie,ke->ie", a, omega_r), np.einsum("kie,ke->ie", b, omega_r)


def _factors_last(array: np.ndarray) -> np.ndarray:
    """An array (E, ...) as one of (..., E), without holes."""
    return np.ascontiguousarray(array.transpose(*range(1, array.ndim), 0))


def _added_up(index: np.ndarray, values: np.ndarray, length: int) -> np.ndarray:
    """Values (d, E) added up by the variable (E,) they belong to: (length, d)."""
    return np.column_stack([np.bincount(index, weights=row, minlength=length) for row in values])
