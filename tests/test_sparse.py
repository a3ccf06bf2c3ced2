"""The block machinery against dense matrices."""

import numpy as np
import pytest

from npslam_teach.sparse import FIXED, BlockGroup, block_structure


def random_problem(seed, num_blocks=9):
    """Blocks of mixed sizes, some of them dropped, some falling on the same place; and the dense sum of them."""
    rng = np.random.default_rng(seed)
    sizes = rng.choice([2, 3], num_blocks)
    start = np.cumsum(sizes) - sizes
    dense = np.zeros((sizes.sum(), sizes.sum()))
    groups, values = [], []
    for height in (2, 3):
        for width in (2, 3):
            rows = rng.choice(np.flatnonzero(sizes == height), 10)
            cols = rng.choice(np.flatnonzero(sizes == width), 10)
            rows[0] = FIXED
            blocks = rng.normal(size=(10, height, width))
            # With every block comes its mirror image: the matrix is symmetric.
            groups += [BlockGroup(rows, cols, height, width), BlockGroup(cols, rows, width, height)]
            values += [blocks.ravel(), blocks.swapaxes(1, 2).ravel()]
            for r, c, block in zip(rows, cols, blocks, strict=True):
                if FIXED not in (r, c):
                    dense[start[r] : start[r] + height, start[c] : start[c] + width] += block
                    dense[start[c] : start[c] + width, start[r] : start[r] + height] += block.T
    for size in (2, 3):
        on = np.flatnonzero(sizes == size)
        groups.append(BlockGroup(on, on, size, size))
        values.append(np.tile(20 * np.eye(size), (len(on), 1, 1)).ravel())
    dense += 20 * np.eye(len(dense))
    return sizes, groups, np.concatenate(values), dense


@pytest.mark.parametrize("seed", range(10))
def test_structure_builds_and_solves_the_dense_matrix(seed):
    sizes, groups, values, dense = random_problem(seed)
    structure = block_structure(sizes, groups)
    data = structure.gather(values)
    np.testing.assert_allclose(structure.natural_matrix(data).toarray(), dense, atol=1e-12)
    np.testing.assert_allclose(data[structure.diagonal], structure.matrix(data).diagonal())
    rhs = np.random.default_rng(seed).normal(size=(len(dense), 2))
    solve = structure.factorize(data)
    np.testing.assert_allclose(solve(rhs), np.linalg.solve(dense, rhs), atol=1e-10)
    np.testing.assert_allclose(solve(rhs[:, 0]), np.linalg.solve(dense, rhs[:, 0]), atol=1e-10)


def test_columns_are_sorted_and_without_duplicates():
    sizes, groups, values, _ = random_problem(1)
    structure = block_structure(sizes, groups)
    matrix = structure.matrix(structure.gather(values))
    assert matrix.has_canonical_format


def test_the_order_keeps_the_factors_of_a_star_sparse():
    """The hub of a star must be eliminated last: then nothing fills in; first, everything does."""
    from scipy.sparse.linalg import splu

    leaves = np.arange(1, 60)
    hub = np.zeros_like(leaves)
    everything = np.arange(60)
    groups = [BlockGroup(everything, everything, 2, 2), BlockGroup(leaves, hub, 2, 2), BlockGroup(hub, leaves, 2, 2)]
    values = np.concatenate([np.tile(200 * np.eye(2), (60, 1, 1)).ravel(), np.ones(59 * 4), np.ones(59 * 4)])
    structure = block_structure(np.full(60, 2), groups)
    data = structure.gather(values)
    fill = splu(structure.matrix(data), permc_spec="NATURAL", diag_pivot_thresh=0.0).L.nnz
    assert fill < 1.2 * len(structure.indices) / 2 + 120


def test_a_singular_matrix_is_refused():
    everything = np.arange(3)
    structure = block_structure(np.full(3, 2), [BlockGroup(everything, everything, 2, 2)])
    values = np.tile(np.eye(2), (3, 1, 1))
    values[1] = 0.0
    with pytest.raises(np.linalg.LinAlgError):
        structure.factorize(structure.gather(values.ravel()))
