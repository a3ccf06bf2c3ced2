"""The normal equations against central differences of residuals written out from the definition."""

from dataclasses import replace

import numpy as np
import pytest
from graphs import pack, random_graph, unpack, whitened_residuals

from npslam_teach import pose_graph
from npslam_teach.pose_graph import linearization


def test_chi2_is_the_sum_of_squared_whitened_residuals():
    graph = random_graph(11)
    assert linearization.chi2(graph) == pytest.approx((whitened_residuals(graph, pack(graph)) ** 2).sum(), rel=1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_normal_equations_are_j_transposed_j(seed):
    graph = random_graph(seed)
    x, step = pack(graph), 1e-6
    jacobian = np.column_stack(
        [
            (whitened_residuals(graph, x + step * e) - whitened_residuals(graph, x - step * e)) / (2 * step)
            for e in np.eye(len(x))
        ]
    )
    h, b, chi2 = pose_graph.linearize(graph)
    r = whitened_residuals(graph, pack(graph))
    np.testing.assert_allclose(h.toarray(), jacobian.T @ jacobian, rtol=1e-7, atol=1e-6)
    np.testing.assert_allclose(b, jacobian.T @ r, atol=1e-6)
    assert chi2 == pytest.approx(r @ r, rel=1e-12)
    np.testing.assert_allclose(h.toarray(), h.toarray().T, rtol=0, atol=1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_with_the_second_order_term_h_is_the_derivative_of_b(seed):
    """Gauss-Newton's H is not: it leaves out that the residuals themselves are curved."""
    graph = random_graph(seed, noise=1.0)
    structure, at = linearization.graph_structure(graph), linearization.residuals(graph)
    data, _ = linearization.normal_equations(graph, structure, at)
    curved = structure.matrix(data + linearization.second_order_term(graph, structure, at)).toarray()
    x, step, slope = pack(graph), 1e-5, []
    for e in np.eye(len(x)):
        ends = [unpack(graph, x + sign * step * e) for sign in (1, -1)]
        above, below = (pose_graph.linearize(replace(graph, poses=p, landmarks=m))[1] for p, m in ends)
        slope.append((above - below) / (2 * step))
    np.testing.assert_allclose(curved, slope, rtol=1e-6, atol=1e-5)
    assert np.abs(structure.matrix(data).toarray() - slope).max() > 1.0
