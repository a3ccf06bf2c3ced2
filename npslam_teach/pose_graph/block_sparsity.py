"""The machinery under the pose graph: where every block of H goes, so that it is worked out once and reused.

H is symmetric and made of small blocks, one for each pair of variables that share a factor. Which pairs these are does
not change while the estimates move. Only the upper triangle is kept, in compressed columns (CSC): column after column,
the row and the value of every number that may differ from zero.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate, pairwise
from typing import NamedTuple

import numpy as np

# For ``splu`` of a symmetric matrix: no pivoting off the diagonal, in an order of minimum degree, which keeps the
# factors sparse.
SYMMETRIC = {"permc_spec": "MMD_AT_PLUS_A", "diag_pivot_thresh": 0.0, "options": {"SymmetricMode": True}}
FIXED = -1  # the block index of a variable that is held still and has no place in H


class BlockGroup(NamedTuple):
    """Blocks of one shape that some kind of factor adds to H; each also stands mirrored across the diagonal."""

    rows: np.ndarray  # (B,) block index of the row variable, or FIXED
    cols: np.ndarray  # (B,) block index of the column variable, or FIXED
    height: int
    width: int


@dataclass(frozen=True, eq=False)
class BlockStructure:
    """The sparsity of a symmetric block matrix: n unknowns in N block variables, numbered block by block."""

    sizes: np.ndarray  # (N,) unknowns of each block variable
    block_rows: np.ndarray  # (B,) the distinct blocks right of the diagonal
    block_cols: np.ndarray  # (B,)
    indptr: np.ndarray  # (n+1,) where each column of the upper triangle begins
    indices: np.ndarray  # (nnz,) the row of each of its numbers
    shapes: tuple[tuple[int, int, int], ...]  # (height, width, B) of every group of blocks that is contributed
    slots: np.ndarray  # (V,) the place in `indices` of every contributed number; nnz = not in the upper triangle

    @property
    def num_unknowns(self) -> int:
        """n, the size of the matrix."""
        return len(self.indptr) - 1

    @property
    def diagonal(self) -> np.ndarray:
        """(n,) the place of the diagonal: the last number of each column of the upper triangle."""
        return self.indptr[1:] - 1

    @cached_property
    def elimination_order(self) -> np.ndarray:
        """(n,) the unknowns in an order that keeps the factors of the matrix sparse."""
        order = np.argsort(fill_reducing_order(len(self.sizes), self.block_rows, self.block_cols))
        return _runs(_starts(self.sizes)[order], self.sizes[order])

    @cached_property
    def scratch(self) -> np.ndarray:
        """(V,) room for all contributions, to be overwritten for each matrix: memory that is new has to be fetched."""
        return np.empty(len(self.slots))

    def blocks(self, values: np.ndarray) -> list[np.ndarray]:
        """The part of all contributions (V,) that is each group's, as (height, width, B), to be written into."""
        ends = list(accumulate((math.prod(shape) for shape in self.shapes), initial=0))
        return [values[a:b].reshape(shape) for shape, (a, b) in zip(self.shapes, pairwise(ends), strict=True)]

    def gather(self, values: np.ndarray) -> np.ndarray:
        """Add up all contributions (V,) that fall on the same entry: the upper triangle's ``data`` (nnz,)."""
        return np.bincount(self.slots, weights=values, minlength=len(self.indices) + 1)[:-1]

    def upper(self, data: np.ndarray):
        """The upper triangle, a ``scipy.sparse.csc_matrix`` (n, n)."""
        from scipy.sparse import csc_matrix

        return csc_matrix((data, self.indices, self.indptr), shape=(self.num_unknowns,) * 2)

    def matrix(self, data: np.ndarray):
        """The whole matrix, a ``scipy.sparse.csc_array`` (n, n); its pattern does not depend on which data are zero."""
        from scipy.sparse import csc_array

        rows, cols = self.indices, np.repeat(np.arange(self.num_unknowns), np.diff(self.indptr))
        off = rows < cols
        places = np.concatenate([rows, cols[off]]), np.concatenate([cols, rows[off]])
        return csc_array((np.concatenate([data, data[off]]), places), shape=(self.num_unknowns,) * 2)


def block_structure(sizes: np.ndarray, groups: list[BlockGroup]) -> BlockStructure:
    """Work out the structure of a symmetric block matrix, whose blocks arrive in groups.

    Args:
        sizes: (N,) the number of unknowns of each block variable.
        groups: what will be added. ``gather`` later takes the blocks' numbers group after group, where ``blocks`` has
            put them. A square block below the diagonal stands for its mirror image above; every
            variable needs a block on the diagonal.
    """
    sizes = np.asarray(sizes, dtype=np.int64)
    shapes = tuple((group.height, group.width, len(group.rows)) for group in groups)
    if len(sizes) == 0:  # everything is fixed, and no number has a place
        nothing = np.zeros(0, dtype=np.int64)
        slots = np.zeros(sum(math.prod(shape) for shape in shapes), dtype=np.int64)
        return BlockStructure(sizes, nothing, nothing, np.zeros(1, np.int32), np.zeros(0, np.int32), shapes, slots)
    low = np.concatenate([np.minimum(group.rows, group.cols) for group in groups])
    high = np.concatenate([np.maximum(group.rows, group.cols) for group in groups])
    apart = (low != FIXED) & (low < high)

    # The distinct blocks above the diagonal, column by column and from top to bottom, as compressed columns want them.
    keys, which = np.unique(high[apart] * len(sizes) + low[apart], return_inverse=True)
    block_cols, block_rows = np.divmod(keys, len(sizes))
    heights = sizes[block_rows]
    height_over_diagonal = np.bincount(block_cols, weights=heights, minlength=len(sizes)).astype(np.int64)
    # Column k of a diagonal block adds its first k+1 numbers to what stands above the block.
    column_heights = np.repeat(height_over_diagonal, sizes) + _runs(np.ones_like(sizes), sizes)
    indptr = np.append(0, np.cumsum(column_heights))

    # How many numbers stand above each contributed block in its own columns.
    above = height_over_diagonal[high]
    above[apart] = (_starts(heights) - _starts(height_over_diagonal)[block_cols])[which]
    slots, indices = _slots(groups, above, indptr, _starts(sizes))
    indptr, indices = indptr.astype(np.int32), indices.astype(np.int32)
    return BlockStructure(sizes, block_rows, block_cols, indptr, indices, shapes, slots)


def _slots(groups, above: np.ndarray, indptr: np.ndarray, first: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The place of every number of every group, and the row (nnz,) of every place."""
    slots, nowhere = [], indptr[-1]
    indices = np.zeros(nowhere + 1, dtype=np.int64)
    ends = np.cumsum([len(group.rows) for group in groups])
    for group, begin, end in zip(groups, np.append(0, ends), ends, strict=False):
        down, right = np.arange(group.height)[:, None, None], np.arange(group.width)[None, :, None]
        low, high = np.minimum(group.rows, group.cols), np.maximum(group.rows, group.cols)
        place = indptr[first[high] + right] + above[begin:end] + down
        place[(low == FIXED) | ((low == high) & (down > right))] = nowhere
        indices[place] = first[low] + down
        mirrored = (group.rows > group.cols) & (low != FIXED)
        if mirrored.any():
            place = np.where(mirrored, place.swapaxes(0, 1), place)
        slots.append(place.ravel())
    return np.concatenate(slots), indices[:-1]


def fill_reducing_order(num_blocks: int, rows: np.ndarray, cols: np.ndarray) -> np.ndarray:
    """Minimum-degree order of the graph of blocks: (N,) the new position of each block.

    SuperLU orders columns only on its way to a factorisation, so it is given a small diagonally dominant matrix with
    the pattern of the block graph, and nothing of the result is kept but the order.

    Args:
        num_blocks: N.
        rows: (B,) one end of each pair of blocks that share a factor.
        cols: (B,) the other end.
    """
    from scipy.sparse import csc_array
    from scipy.sparse.linalg import splu

    blocks = np.arange(num_blocks)
    ends, other_ends = np.concatenate([rows, cols]), np.concatenate([cols, rows])
    entries = np.concatenate([-np.ones(len(ends)), np.bincount(ends, minlength=num_blocks) + 1.0])
    places = np.concatenate([ends, blocks]), np.concatenate([other_ends, blocks])
    pattern = csc_array((entries, places), shape=(num_blocks, num_blocks))
    factors = splu(pattern, **SYMMETRIC)
    return factors.perm_c.astype(np.int64)


def _starts(lengths: np.ndarray) -> np.ndarray:
    """Where each of several runs begins when they are laid end to end."""
    return np.cumsum(lengths) - lengths


def _runs(first: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    """first, first+1, .. for each run, laid end to end."""
    return np.repeat(first - _starts(lengths), lengths) + np.arange(lengths.sum())
