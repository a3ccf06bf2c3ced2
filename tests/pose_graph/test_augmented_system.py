"""The augmented system: the steps of H where H can hold them, and the right ones where it cannot."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from graphs import random_graph, whitened_system

from npslam_teach.pose_graph.augmented_system import augmented_step, weights_differ
from npslam_teach.pose_graph.linearization import graph_structure, linearize, normal_equations, residuals
from npslam_teach.pose_graph.linearization import second_order_term as second_order


def with_weights(graph, draw):
    """The graph with isotropic information, each factor's drawn anew."""

    def weighted(factors):
        size = factors.information.shape[1]
        return replace(
            factors, information=np.array([draw() * np.eye(size) for _ in factors.information]).reshape(-1, size, size)
        )

    return replace(graph, between=weighted(graph.between), observations=weighted(graph.observations))


def solved_exactly(matrix, rhs):
    """Gauss-Jordan elimination with fractions: no digit is lost."""
    rows = [[Fraction(float(v)) for v in row] for row in matrix]
    columns = list(zip(*rows, strict=True))
    right = [-sum(a * Fraction(float(r)) for a, r in zip(column, rhs, strict=True)) for column in columns]
    system = [[sum(a * b for a, b in zip(p, q, strict=True)) for q in columns] for p in columns]
    table = [[*row, value] for row, value in zip(system, right, strict=True)]
    for k in range(len(table)):
        pivot = next(i for i in range(k, len(table)) if table[i][k] != 0)
        table[k], table[pivot] = table[pivot], table[k]
        table[k] = [value / table[k][k] for value in table[k]]
        for i in range(len(table)):
            if i != k and table[i][k] != 0:
                table[i] = [a - table[i][k] * b for a, b in zip(table[i], table[k], strict=True)]
    return np.array([float(row[-1]) for row in table])


@pytest.mark.parametrize("seed", range(10))
def test_where_h_can_hold_the_weights_it_is_the_same_step(seed):
    graph = random_graph(seed, num_poses=12, num_landmarks=4, num_loops=5, start_noise=0.1)
    assert not weights_differ(graph)
    h, b, at = *linearize(graph)[:2], residuals(graph)
    structure = graph_structure(graph)
    term = structure.matrix(second_order(graph, structure, at))
    for damping, added in ((0.0, None), (0.3, None), (0.0, term)):
        whole = h.toarray() + damping * np.diag(h.diagonal()) + (0 if added is None else added.toarray())
        dx, predicted = augmented_step(graph, at, damping, added)
        np.testing.assert_allclose(dx, np.linalg.solve(whole, -b), rtol=1e-7, atol=1e-9)
        assert predicted == pytest.approx(-b @ dx, rel=1e-7)


@pytest.mark.parametrize("seed", range(12))
def test_where_it_cannot_the_step_is_that_of_exact_arithmetic(seed):
    """Of the normal equations the same step has no right digit in some of these."""
    rng = np.random.default_rng(seed)
    graph = random_graph(seed, num_poses=5, num_landmarks=seed % 3, num_loops=2, start_noise=0.1)
    graph = with_weights(graph, lambda: rng.choice([1e-6, 1e10]))
    at = residuals(graph)
    jacobian, whitened = whitened_system(graph)
    exact = solved_exactly(jacobian, whitened)
    dx, _ = augmented_step(graph, at)

    def left_over(step):
        return np.sum((jacobian @ step + whitened) ** 2)

    assert left_over(dx) <= left_over(exact) * (1 + 1e-9) + 1e-20 * len(whitened)


def test_the_normal_equations_do_lose_it():
    """Else the augmented system would have no purpose."""
    lost = 0
    for seed in range(30):
        rng = np.random.default_rng(seed)
        graph = random_graph(seed, num_poses=12, num_loops=2, start_noise=0.1)
        graph = with_weights(graph, lambda rng=rng: rng.choice([1e-6, 1e10], p=[0.8, 0.2]))
        at = residuals(graph)
        structure = graph_structure(graph)
        data, b = normal_equations(graph, structure, at)
        jacobian, whitened = whitened_system(graph)
        by_h = np.linalg.lstsq(structure.matrix(data).toarray(), -b, rcond=None)[0]
        with_h, without = (np.sum((jacobian @ dx + whitened) ** 2) for dx in (by_h, augmented_step(graph, at)[0]))
        lost += with_h > 1.001 * without
    assert lost >= 3


def test_weights_that_differ_are_seen_across_kinds_of_factors():
    graph = random_graph(0, num_landmarks=3)
    assert not weights_differ(graph)
    factors = graph.observations
    assert weights_differ(replace(graph, observations=replace(factors, information=1e10 * factors.information)))
    single = np.where(np.arange(len(factors.information))[:, None, None] == 0, 1e-10, 1.0) * factors.information
    assert weights_differ(replace(graph, observations=replace(factors, information=single)))


def test_information_that_says_nothing_in_some_direction_has_a_root_too():
    graph = random_graph(1, num_poses=8, num_landmarks=3, start_noise=0.1)
    flat = graph.between.information.copy()
    flat[2, 2, :] = flat[2, :, 2] = 0.0  # the heading of this step is not measured; a loop tells it
    graph = replace(graph, between=replace(graph.between, information=flat))
    assert not weights_differ(graph)  # nothing is not a small weight
    h, b, _ = linearize(graph)
    np.testing.assert_allclose(augmented_step(graph, residuals(graph))[0], np.linalg.solve(h.toarray(), -b), rtol=1e-6)
