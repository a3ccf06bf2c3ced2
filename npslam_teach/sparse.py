"""The machinery under the pose graph: where every block of H goes, in which order, and how to solve.

H is made of small blocks, one for each pair of variables that share a factor. Which pairs these are does not change
while the estimates move, so the *structure* (a fill-reducing order of the variables and the place of every block in
SciPy's compressed columns) is worked out once and reused in every iteration.
"""

import itertools
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

SINGULAR = "expected factors that determine every pose and landmark, but H is singular"
FIXED = -1  # the block index of a variable that is held still and has no place in H


class BlockGroup(NamedTuple):
    """Blocks of one shape that some kind of factor adds to H."""

    rows: np.ndarray  # (B,) block index of the row variable, or FIXED
    cols: np.ndarray  # (B,) block index of the column variable, or FIXED
    height: int
    width: int


@dataclass(frozen=True, eq=False)
class BlockStructure:
    """The sparsity of a symmetric block matrix whose variables were reordered to keep its factors sparse.

    The unknowns are numbered block by block, in the caller's order ("natural") or in the fill-reducing order
    ("permuted"); ``permuted_of_natural[k]`` is the permuted index of natural unknown k.
    """

    permuted_of_natural: np.ndarray  # (n,)
    indptr: np.ndarray  # (n+1,) compressed columns of the permuted matrix
    indices: np.ndarray  # (nnz,)
    slots: np.ndarray  # (V,) the place of every contributed number in `data`; nnz = dropped
    diagonal: np.ndarray  # (n,) the place of the diagonal in `data`

    @property
    def num_unknowns(self) -> int:
        """n, the size of the matrix."""
        return len(self.permuted_of_natural)

    def gather(self, values: np.ndarray) -> np.ndarray:
        """Add up all contributions (V,) that fall on the same entry: the ``data`` (nnz,) of the permuted matrix."""
        return np.bincount(self.slots, weights=values, minlength=len(self.indices) + 1)[:-1]

    def matrix(self, data: np.ndarray):
        """The permuted matrix, a ``scipy.sparse.csc_array`` (n, n)."""
        from scipy.sparse import csc_array

        return csc_array((data, self.indices, self.indptr), shape=(self.num_unknowns,) * 2)

    def natural_matrix(self, data: np.ndarray):
        """The matrix in the caller's order, as a lesson shows it: a ``scipy.sparse.csc_array`` (n, n)."""
        order = self.permuted_of_natural
        return self.matrix(data)[order][:, order].tocsc()

    def factorize(self, data: np.ndarray):
        """Factorise the permuted matrix; returns a function that solves ``H x = rhs`` in natural order.

        Raises:
            numpy.linalg.LinAlgError: when the matrix is singular.
        """
        from scipy.sparse.linalg import splu

        try:
            # H is symmetric and already ordered: no pivoting, and panels of one column suit its short columns.
            factors = splu(
                self.matrix(data),
                permc_spec="NATURAL",
                diag_pivot_thresh=0.0,
                panel_size=1,
                relax=1,
                options={"SymmetricMode": True},
            )
        except RuntimeError:  # "Factor is exactly singular"
            raise np.linalg.LinAlgError(SINGULAR) from None
        order = self.permuted_of_natural

        def solve(rhs: np.ndarray) -> np.ndarray:
            permuted = np.empty_like(rhs)
            permuted[order] = rhs
            solution = factors.solve(permuted)[order]
            if not np.isfinite(solution).all():
                raise np.linalg.LinAlgError(SINGULAR)
            return solution

        return solve


def block_structure(sizes: np.ndarray, groups: list[BlockGroup]) -> BlockStructure:
    """Work out the structure of a symmetric block matrix, whose blocks arrive in groups.

    Args:
        sizes: (N,) the number of unknowns of each block variable.
        groups: what will be added. ``gather`` later takes the blocks' numbers, flattened, group after group.
            Every variable must contribute its diagonal block.
    """
    num_blocks = len(sizes)
    rows = np.concatenate([group.rows for group in groups])
    cols = np.concatenate([group.cols for group in groups])
    free = (rows != FIXED) & (cols != FIXED)
    position = fill_reducing_order(num_blocks, rows[free], cols[free])
    permuted_sizes = np.empty(num_blocks, dtype=np.int64)
    permuted_sizes[position] = sizes

    # The distinct blocks, column by column and from top to bottom, as compressed columns want them.
    keys, block_of = np.unique(position[cols[free]] * num_blocks + position[rows[free]], return_inverse=True)
    block_col, block_row = np.divmod(keys, num_blocks)
    columns = _compressed_columns(permuted_sizes, block_row, block_col)

    block = np.full(len(free), -1)
    block[free] = block_of
    permuted_of_natural = _unknowns(_starts(permuted_sizes)[position], np.asarray(sizes))
    diagonal_block = np.repeat(np.searchsorted(keys, np.arange(num_blocks) * (num_blocks + 1)), permuted_sizes)
    within = _unknowns(np.zeros(num_blocks, dtype=np.int64), permuted_sizes)
    return BlockStructure(
        permuted_of_natural=permuted_of_natural,
        indptr=columns.indptr,
        indices=columns.indices,
        slots=_slots(groups, block, columns),
        diagonal=columns.corner[diagonal_block] + within * (columns.stride[diagonal_block] + 1),
    )


def fill_reducing_order(num_blocks: int, rows: np.ndarray, cols: np.ndarray) -> np.ndarray:
    """Minimum-degree order of the graph of blocks: (N,) the new position of each block.

    SuperLU orders columns only on its way to a factorisation, so it is given a small diagonally dominant matrix with
    the pattern of the block graph, and nothing of the result is kept but the order.
    """
    from scipy.sparse import csc_array
    from scipy.sparse.linalg import splu

    apart = rows != cols
    degree = np.bincount(cols[apart], minlength=num_blocks)
    blocks = np.arange(num_blocks)
    entries = np.concatenate([-np.ones(np.count_nonzero(apart)), degree + 1.0])
    places = np.concatenate([rows[apart], blocks]), np.concatenate([cols[apart], blocks])
    pattern = csc_array((entries, places), shape=(num_blocks, num_blocks))
    factors = splu(pattern, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    return factors.perm_c.astype(np.int64)


class _Columns(NamedTuple):
    indptr: np.ndarray  # (n+1,)
    indices: np.ndarray  # (nnz,)
    corner: np.ndarray  # (B,) the place in `data` of each block's top-left number
    stride: np.ndarray  # (B,) and how far it is from one of the block's columns to the next


def _compressed_columns(sizes: np.ndarray, block_row: np.ndarray, block_col: np.ndarray) -> _Columns:
    """Lay distinct blocks, sorted by column and then by row, out as compressed columns."""
    heights, widths = sizes[block_row], sizes[block_col]
    column_height = np.bincount(block_col, weights=heights, minlength=len(sizes)).astype(np.int64)
    above = _starts(heights) - _starts(column_height)[block_col]  # numbers above the block in its own column
    corner = _starts(column_height * sizes)[block_col] + above
    stride = column_height[block_col]
    indptr = np.append(_starts(np.repeat(column_height, sizes)), (column_height * sizes).sum())
    indices = np.empty(indptr[-1], dtype=np.int32)
    first_row = _starts(sizes)[block_row]
    for height, width in itertools.product(np.unique(sizes), repeat=2):
        chosen = (heights == height) & (widths == width)
        places = _places(corner[chosen], stride[chosen], height, width)
        indices[places] = (first_row[chosen, None] + np.arange(height))[:, :, None]
    return _Columns(indptr.astype(np.int32), indices, corner, stride)


def _slots(groups: list[BlockGroup], block: np.ndarray, columns: _Columns) -> np.ndarray:
    """The place in ``data`` of every number of every group; ``block`` (B,) names the distinct block, -1 drops."""
    slots, begin = [], 0
    for group in groups:
        chosen = block[begin : begin + len(group.rows)]
        begin += len(group.rows)
        places = _places(columns.corner[chosen], columns.stride[chosen], group.height, group.width)
        places[chosen < 0] = len(columns.indices)
        slots.append(places.ravel())
    return np.concatenate(slots)


def _places(corner: np.ndarray, stride: np.ndarray, height: int, width: int) -> np.ndarray:
    """The places in ``data`` of the numbers of (B,) blocks: (B, height, width)."""
    return corner[:, None, None] + np.arange(height)[:, None] + stride[:, None, None] * np.arange(width)


def _starts(lengths: np.ndarray) -> np.ndarray:
    """Where each of several runs begins when they are laid end to end."""
    return np.cumsum(lengths) - lengths


def _unknowns(first: np.ndarray, sizes: np.ndarray) -> np.ndarray:
    """first, first+1, .. for each block, size of them, laid end to end."""
    return np.repeat(first - _starts(sizes), sizes) + np.arange(sizes.sum())
