"""Solving ``H x = rhs`` again and again for one pattern of H: whatever depends on the pattern alone is done once.

`qdldl`, a small library for sparse symmetric systems, is used where it is installed; SciPy's SuperLU otherwise. Both
give the same solution up to rounding.
"""

from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import numpy as np

from npslam_teach.pose_graph.block_sparsity import SYMMETRIC, BlockStructure

SINGULAR = "expected factors that determine every pose and landmark, but H is singular"
LATEST = None  # in place of a matrix: the one that was factorised last
Solve = Callable[[np.ndarray], np.ndarray]


@cache
def has_qdldl() -> bool:
    """Whether the faster of the two libraries can be imported."""
    from importlib.util import find_spec

    return find_spec("qdldl") is not None


def factorizer(structure: BlockStructure, library: str | None = None) -> Callable[[np.ndarray], Solve]:
    """Prepare for matrices of one structure.

    Args:
        structure: their pattern.
        library: "qdldl" or "superlu"; None takes the faster one that is installed.

    Returns:
        a function that factorises the matrix of some ``data`` (nnz,), or takes the LATEST, and returns ``solve``: (n,)
        or (n, k) right-hand sides to solutions. A ``solve`` is good until the next matrix is factorised; asking again
        for the latest one costs nothing. Both raise
        ``numpy.linalg.LinAlgError`` where the matrix turns out to be singular.
    """
    if library is None:
        library = "qdldl" if has_qdldl() else "superlu"
    if library not in ("qdldl", "superlu"):
        raise ValueError(f"library: expected qdldl or superlu, got {library!r}")
    factorize = {"qdldl": _Qdldl, "superlu": _SuperLU}[library](structure)
    latest: list = [None, None]

    def factorize_once(data: np.ndarray) -> Solve:
        if data is not LATEST and data is not latest[0]:
            latest[:] = data, factorize(data)
        return latest[1]

    return factorize_once


class LinearSystem(NamedTuple):
    """What stays the same for all matrices of one pattern."""

    structure: BlockStructure
    factorize: Callable[[np.ndarray], Solve]

    def solve(self, data: np.ndarray, rhs: np.ndarray) -> np.ndarray:
        """The solution (n,) for a matrix of some ``data`` (nnz,); an infinite one where rounding makes it singular."""
        try:
            return self.factorize(data)(rhs)
        except np.linalg.LinAlgError:
            return np.full_like(rhs, np.inf)

    def solve_again(self, rhs: np.ndarray) -> np.ndarray:
        """The same for the matrix that ``solve`` was given last, whose factors are at hand."""
        return self.solve(LATEST, rhs)


def solve_once(matrix, rhs: np.ndarray, pivoting: bool = False) -> np.ndarray:
    """Solve one sparse symmetric or Hermitian system.

    Args:
        matrix: (n, n), SciPy sparse.
        rhs: (n,).
        pivoting: for a matrix that is not positive definite: pivots may lie off the diagonal.

    Raises:
        numpy.linalg.LinAlgError: the matrix is singular.
    """
    from scipy.sparse.linalg import splu

    try:
        return _finite(splu(matrix.tocsc(), **{} if pivoting else SYMMETRIC).solve(rhs)) if len(rhs) else rhs
    except RuntimeError:  # "Factor is exactly singular"
        raise np.linalg.LinAlgError(SINGULAR) from None


class _Qdldl:
    """L D L^T of the upper triangle; the library finds its own fill-reducing order, once."""

    def __init__(self, structure: BlockStructure):
        self._upper = structure.upper(np.zeros(len(structure.indices)))
        self._lower = self._upper.T
        self._diagonal = structure.diagonal
        self._solver = None

    def __call__(self, data: np.ndarray) -> Solve:
        import qdldl

        self._upper.data = self._lower.data = data
        if self._solver is not None:
            self._solver.update(self._upper, upper=True)
            return self._checked_solve
        try:
            self._solver = qdldl.Solver(self._upper, upper=True)
        except RuntimeError:  # a pivot is exactly zero
            raise np.linalg.LinAlgError(SINGULAR) from None
        return self._solve

    def _solve(self, rhs: np.ndarray) -> np.ndarray:
        if rhs.ndim == 1:
            return _finite(self._solver.solve(rhs))
        return _finite(np.stack([self._solver.solve(column) for column in rhs.T], axis=1))

    def _checked_solve(self, rhs: np.ndarray) -> np.ndarray:
        """Solve, and look at what is left over: of a pivot that is exactly zero, `update` says nothing."""
        x = self._solve(rhs)
        product = self._upper @ x + self._lower @ x - (self._upper.data[self._diagonal] * x.T).T
        size = np.abs(rhs).max() + np.abs(self._upper.data).max() * np.abs(x).max()
        if not np.abs(product - rhs).max() <= 1e-8 * size:
            self._solver = None
            raise np.linalg.LinAlgError(SINGULAR)
        return x


class _SuperLU:
    """L U of the whole matrix, its unknowns in the structure's elimination order."""

    def __init__(self, structure: BlockStructure):
        self._order = structure.elimination_order
        # The same steps carry the places of the numbers to where the numbers will have to go.
        places = structure.matrix(np.arange(1.0, len(structure.indices) + 1))
        self._matrix = places[self._order][:, self._order].tocsc()
        self._matrix.sort_indices()
        self._source = self._matrix.data.astype(np.int64) - 1

    def __call__(self, data: np.ndarray) -> Solve:
        from scipy.sparse.linalg import splu

        self._matrix.data = data[self._source]
        try:
            # H is already ordered, and panels of one column suit its short columns.
            factors = splu(self._matrix, **SYMMETRIC | {"permc_spec": "NATURAL"}, panel_size=1, relax=1)
        except RuntimeError:  # "Factor is exactly singular"
            raise np.linalg.LinAlgError(SINGULAR) from None

        def solve(rhs: np.ndarray) -> np.ndarray:
            solution = np.empty_like(rhs)
            solution[self._order] = factors.solve(rhs[self._order])
            return _finite(solution)

        return solve


def _finite(solution: np.ndarray) -> np.ndarray:
    if not np.isfinite(solution).all():
        raise np.linalg.LinAlgError(SINGULAR)
    return solution
