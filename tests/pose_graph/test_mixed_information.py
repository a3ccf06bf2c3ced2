"""Information from 1e10 down to 1e-6 in one graph: the minimum is reached, or it is said that it is not."""

from dataclasses import replace

import numpy as np
import pytest
from graphs import random_graph, whitened_system

from npslam_teach.pose_graph import certified_minimum, chi2, retract

KINDS = ("each factor of its own size", "weak or strong", "each axis of its own size")


def descended(graph, most_steps=60):
    """chi2 after Gauss-Newton with orthogonal factors of the scaled Jacobian, which never squares its condition."""
    best = chi2(graph)
    for _ in range(most_steps):
        jacobian, residual = whitened_system(graph)
        scale = np.linalg.norm(jacobian, axis=0)
        dx = -np.linalg.lstsq(jacobian / scale, residual, rcond=1e-15)[0] / scale
        trials = [retract(graph, share * dx) for share in 3.0 ** -np.arange(9)]
        values = [chi2(trial) for trial in trials]
        if min(values) >= best * (1 - 1e-13):
            break
        graph, best = trials[int(np.argmin(values))], min(values)
    return best


def drawn(kind, size, rng):
    """An information matrix with sizes from 1e-6 to 1e10."""
    if kind == "each factor of its own size":
        return 10.0 ** rng.uniform(-6, 10) * np.eye(size)
    if kind == "weak or strong":
        return rng.choice([1e-6, 1e10]) * np.eye(size)
    return np.diag(10.0 ** rng.uniform(-6, 10, size))


def scaled(factors, rng):
    """The factors as they are, each scaled to a size from 1e-6 to 1e10."""
    size = 10.0 ** rng.uniform(-6, 10, len(factors.information))
    largest = np.abs(factors.information).max(axis=(1, 2))
    return replace(factors, information=factors.information * (size / largest)[:, None, None])


def redrawn(kind, factors, rng):
    """The factors with information of a kind."""
    size = factors.information.shape[1]
    matrices = [drawn(kind, size, rng) for _ in factors.information]
    return replace(factors, information=np.array(matrices).reshape(-1, size, size))


def assert_minimum(graph):
    """Where it says that it has converged, a dense solver from there and from the start finds nothing lower."""
    found = certified_minimum(graph)
    if found.iterations[-1].converged:
        assert chi2(found.graph) <= min(descended(found.graph), descended(graph)) * (1 + 1e-6)


@pytest.mark.parametrize("seed", range(30))
def test_the_minimum_is_that_of_a_dense_solver(seed):
    rng = np.random.default_rng(seed)
    graph = random_graph(seed, num_poses=15 + seed, num_landmarks=seed % 4, num_loops=8, start_noise=0.3)
    between, observations = scaled(graph.between, rng), scaled(graph.observations, rng)
    assert_minimum(replace(graph, between=between, observations=observations))


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("kind", KINDS)
def test_it_is_so_however_the_weights_differ(kind, seed):
    rng = np.random.default_rng(seed)
    num_loops, start_noise = (2, 4, 8)[seed % 3], (0.05, 0.3, 1.0)[seed % 5 % 3]
    graph = random_graph(seed, 4 + 2 * seed % 27, seed % 4, num_loops=num_loops, start_noise=start_noise)
    between, observations = (redrawn(kind, each, rng) for each in (graph.between, graph.observations))
    assert_minimum(replace(graph, between=between, observations=observations))


def test_it_does_converge_but_for_a_few():
    """The one above must not pass because nothing does. In narrow valleys that bend it crawls, and says so."""
    converged = 0
    for seed in range(20):
        rng = np.random.default_rng(seed)
        graph = random_graph(seed, 4 + seed % 9, num_loops=4, start_noise=0.3)
        weights = 10.0 ** rng.uniform(-6, 10, (len(graph.between.i), 3))
        graph = replace(graph, between=replace(graph.between, information=weights[:, :, None] * np.eye(3)))
        converged += certified_minimum(graph).iterations[-1].converged
    assert converged >= 18
