"""What elimination adds to H: the pattern of its triangular factor in a given order of the variables (lesson 03)."""

import numpy as np

from npslam_teach.pose_graph.linearization import graph_structure, linearize
from npslam_teach.types import PoseGraph


def in_three_orders(graph: PoseGraph) -> dict:
    """H of a graph with its variables in three orders, by the name of the order."""
    matrix, structure = linearize(graph)[0], graph_structure(graph)
    orders = {
        "objects first": np.roll(np.arange(structure.num_unknowns), 2 * len(graph.landmarks)),
        "poses first": np.arange(structure.num_unknowns),
        "reordered": structure.elimination_order,
    }
    return {name: matrix[order][:, order].tocsc() for name, order in orders.items()}


def factor_pattern(matrix):
    """Where the factor of a symmetric positive definite matrix has numbers, in the order given.

    Variables are taken out one after the other, and each ties together all the neighbours that it has left. Only the
    pattern is followed: real numbers cancel or underflow here and there, on one machine and not on the next.

    Args:
        matrix: (n, n), SciPy sparse.

    Returns:
        L (n, n), SciPy sparse, lower triangular with its diagonal; every number is 1.
    """
    from scipy.sparse import csc_array, tril

    below = csc_array(tril(matrix, k=-1))
    size = matrix.shape[0]
    left = [set(below.indices[below.indptr[k] : below.indptr[k + 1]].tolist()) for k in range(size)]
    for neighbours in left:
        if neighbours:
            # The first neighbour stands for all: it is taken out next, and hands on what it inherits.
            heir = min(neighbours)
            left[heir] |= neighbours - {heir}
    rows = np.concatenate([[k, *sorted(neighbours)] for k, neighbours in enumerate(left)])
    cols = np.repeat(np.arange(size), [1 + len(neighbours) for neighbours in left])
    return csc_array((np.ones(len(rows)), (rows, cols)), shape=matrix.shape)
