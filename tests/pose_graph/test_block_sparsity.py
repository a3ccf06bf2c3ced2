"""The block machinery and the factorisations against dense matrices."""

import numpy as np
import pytest

from npslam_teach.pose_graph import factorization
from npslam_teach.pose_graph.block_sparsity import FIXED, BlockGroup, block_structure

LIBRARIES = [
    "superlu",
    pytest.param("qdldl", marks=pytest.mark.skipif(not factorization.has_qdldl(), reason="no qdldl")),
]


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
            if height != width:  # only square blocks may come below the diagonal
                above = (sizes[rows] == height) & (rows < cols)
                rows, cols = rows[above], cols[above]
                if not len(rows):
                    continue
            rows[0] = FIXED
            blocks = rng.normal(size=(len(rows), height, width))
            on_diagonal = rows == cols
            if height == width:  # what falls on the diagonal is symmetric
                blocks[on_diagonal] += blocks[on_diagonal].swapaxes(1, 2)
            groups.append(BlockGroup(rows, cols, height, width))
            values.append(np.moveaxis(blocks, 0, -1).ravel())
            for r, c, block in zip(rows, cols, blocks, strict=True):
                if FIXED in (r, c):
                    continue
                dense[start[r] : start[r] + height, start[c] : start[c] + width] += block
                if r != c:
                    dense[start[c] : start[c] + width, start[r] : start[r] + height] += block.T
    for size in (2, 3):
        on = np.flatnonzero(sizes == size)
        groups.append(BlockGroup(on, on, size, size))
        values.append(np.repeat(20 * np.eye(size)[:, :, None], len(on), axis=2).ravel())
    dense += 20 * np.eye(len(dense))
    return sizes, groups, np.concatenate(values), dense


@pytest.mark.parametrize("seed", range(10))
def test_structure_builds_the_dense_matrix(seed):
    sizes, groups, values, dense = random_problem(seed)
    structure = block_structure(sizes, groups)
    data = structure.gather(values)
    np.testing.assert_allclose(structure.matrix(data).toarray(), dense, atol=1e-12)
    np.testing.assert_allclose(structure.upper(data).toarray(), np.triu(dense), atol=1e-12)
    np.testing.assert_allclose(data[structure.diagonal], dense.diagonal())
    assert structure.matrix(np.zeros_like(data)).nnz == 2 * len(data) - len(dense)


@pytest.mark.parametrize("library", LIBRARIES)
@pytest.mark.parametrize("seed", range(10))
def test_factorisation_solves_the_dense_system_again_and_again(seed, library):
    sizes, groups, values, dense = random_problem(seed)
    structure = block_structure(sizes, groups)
    solver = factorization.factorizer(structure, library)
    rng = np.random.default_rng(seed)
    for _ in range(3):
        data = structure.gather(values)
        rhs = rng.normal(size=(len(dense), 2))
        solve = solver(data)
        np.testing.assert_allclose(solve(rhs), np.linalg.solve(dense, rhs), atol=1e-10)
        np.testing.assert_allclose(solve(rhs[:, 0]), np.linalg.solve(dense, rhs[:, 0]), atol=1e-10)
        assert solver(data) is solve
        factor = rng.uniform(0.5, 2.0)
        values, dense = factor * values, factor * dense


def test_columns_are_sorted_and_without_duplicates():
    sizes, groups, values, _ = random_problem(1)
    structure = block_structure(sizes, groups)
    assert structure.upper(structure.gather(values)).has_canonical_format


def test_the_order_keeps_the_factors_of_a_star_sparse():
    """The hub of a star must be eliminated last: then nothing fills in; first, everything does."""
    from scipy.sparse.linalg import splu

    leaves = np.arange(1, 60)
    everything = np.arange(60)
    groups = [BlockGroup(everything, everything, 2, 2), BlockGroup(leaves, np.zeros_like(leaves), 2, 2)]
    values = np.concatenate([np.repeat(200 * np.eye(2)[:, :, None], 60, axis=2).ravel(), np.ones(59 * 4)])
    structure = block_structure(np.full(60, 2), groups)
    matrix = structure.matrix(structure.gather(values))
    order = structure.elimination_order
    np.testing.assert_array_equal(np.sort(order), np.arange(120))
    fill = splu(matrix[order][:, order].tocsc(), permc_spec="NATURAL", diag_pivot_thresh=0.0).L.nnz
    assert fill < 1.2 * matrix.nnz / 2 + 120


@pytest.mark.parametrize("library", LIBRARIES)
def test_a_singular_matrix_is_refused(library):
    """The first time, when it comes after a good one, and good ones are taken again after it."""
    pair = [BlockGroup(np.arange(2), np.arange(2), 1, 1), BlockGroup(np.array([0]), np.array([1]), 1, 1)]
    structure = block_structure(np.full(2, 1), pair)
    good, singular = structure.gather(np.array([2.0, 2.0, 1.0])), structure.gather(np.ones(3))
    with pytest.raises(np.linalg.LinAlgError):
        factorization.factorizer(structure, library)(singular)(np.ones(2))
    solver, rhs = factorization.factorizer(structure, library), np.array([3.0, 0.0])
    np.testing.assert_allclose(solver(good)(rhs), [2.0, -1.0])
    with pytest.raises(np.linalg.LinAlgError):
        solver(singular)(rhs)
    np.testing.assert_allclose(solver(good.copy())(rhs), [2.0, -1.0])


def test_an_unknown_library_is_refused():
    structure = block_structure(np.full(1, 1), [BlockGroup(np.zeros(1, dtype=int), np.zeros(1, dtype=int), 1, 1)])
    with pytest.raises(ValueError, match="library: expected qdldl or superlu, got 'cholmod'"):
        factorization.factorizer(structure, "cholmod")
