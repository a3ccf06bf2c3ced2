"""Information from 1e10 down to 1e-6 in one graph: the minimum is reached, or it is said that it is not."""

from dataclasses import replace

import numpy as np
import pytest
from graphs import random_graph

from npslam_teach.pose_graph import certified_minimum, chi2, retract
from npslam_teach.pose_graph.factor_kinds import FACTOR_KINDS
from npslam_teach.pose_graph.unknowns import unknowns_of


def whitened_system(graph):
    """The Jacobian and the residuals of all factors, dense, each divided by its standard deviations."""
    unknowns, jacobians, residuals = unknowns_of(graph), [], []
    for kind in FACTOR_KINDS:
        ends = kind.ends(graph)
        by_end = kind.jacobians(*(end.estimate for end in ends))
        root = np.linalg.cholesky(kind.information(graph)).swapaxes(1, 2)
        for e, residual in enumerate(kind.residuals(graph)):
            row = np.zeros((len(residual), unknowns.count + 1))  # what is fixed goes into the last column
            for end, jacobian in zip(ends, by_end, strict=True):
                row[:, unknowns.of(end.variable, end.index[e : e + 1], jacobian.shape[2])[0]] += jacobian[e]
            jacobians.append(root[e] @ row[:, :-1])
            residuals.append(root[e] @ residual)
    return np.concatenate(jacobians), np.concatenate(residuals)


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


@pytest.mark.parametrize("seed", range(30))
def test_the_minimum_is_that_of_a_dense_solver(seed):
    rng = np.random.default_rng(seed)

    def rescaled(factors):
        size = 10.0 ** rng.uniform(-6, 10, len(factors.information))
        largest = np.abs(factors.information).max(axis=(1, 2))
        return replace(factors, information=factors.information * (size / largest)[:, None, None])

    graph = random_graph(seed, num_poses=15 + seed, num_landmarks=seed % 4, num_loops=8, start_noise=0.3)
    graph = replace(graph, between=rescaled(graph.between), observations=rescaled(graph.observations))
    found = certified_minimum(graph)
    if found.iterations[-1].converged:
        assert chi2(found.graph) <= min(descended(found.graph), descended(graph)) * (1 + 1e-6)
