"""A pose graph without its poses: its chi2 is that of the linear problem in which the poses are free."""

import sys
from dataclasses import replace

import numpy as np
import pytest

from npslam_teach import simulate
from npslam_teach.pose_graph import chi2, fit, gauss_newton, linearize
from npslam_teach.pose_graph.reduced_system import reduced_system


@pytest.fixture(params=range(5))
def graph(request):
    log, truth = simulate.toy_objects() if request.param == 0 else simulate.fifteen_objects(request.param)
    labels = np.unique(truth.obs_object, return_inverse=True)[1]
    return fit(log, labels)


def test_at_the_landmarks_of_the_graph_it_is_the_least_that_poses_can_reach(graph, request):
    """By the whole linear system, with the landmarks held still: another way round than the Schur complement."""
    rng = np.random.default_rng(0)
    reduced, (h, b, at_start) = reduced_system(graph), linearize(graph)
    h, num = h.toarray(), 3 * (len(graph.poses) - 1)
    for _ in range(2):
        landmarks = graph.landmarks + rng.normal(0, 0.1, graph.landmarks.shape)
        dl = (landmarks - graph.landmarks).ravel()
        dx = np.concatenate([np.linalg.solve(h[:num, :num], -b[:num] - h[:num, num:] @ dl), dl])
        assert reduced.chi2(landmarks) == pytest.approx(at_start + 2 * b @ dx + dx @ h @ dx, rel=1e-9)
        moved = reduced.graph_at(landmarks)
        np.testing.assert_allclose(moved.poses[1:, :2], graph.poses[1:, :2] + dx[:num].reshape(-1, 3)[:, :2], atol=1e-9)


def test_its_minimum_is_a_step_of_gauss_newton(graph):
    rng = np.random.default_rng(1)
    start = replace(graph, landmarks=graph.landmarks + rng.normal(0, 0.05, graph.landmarks.shape))
    reduced = reduced_system(start)
    best = np.linalg.solve(reduced.information, reduced.vector).reshape(-1, 2)
    _, step, *_ = gauss_newton(start)
    np.testing.assert_allclose(best, step.graph.landmarks, atol=1e-8)
    np.testing.assert_allclose(reduced.graph_at(best).poses, step.graph.poses, atol=1e-8)


def test_a_linear_problem_has_the_chi2_of_the_solver():
    """No turn is uncertain: then the least chi2 for given landmarks is that of the solver, to the last digits."""
    log, truth = simulate.fifteen_objects(0)
    log = replace(log, odometry_std=(0.02, 0.02, 1e-6))
    graph = fit(log, np.unique(truth.obs_object, return_inverse=True)[1])
    assert reduced_system(graph).chi2(graph.landmarks) == pytest.approx(chi2(graph), rel=1e-9)


def test_what_is_fixed_but_pose_0_is_refused(graph):
    with pytest.raises(ValueError, match="graph: expected pose 0 to be fixed and nothing else"):
        reduced_system(replace(graph, fixed_landmarks=(0,)))


@pytest.mark.parametrize("stretch", [3, 21, 192, 10_000])
def test_stretches_of_a_chain_add_up_to_the_schur_complement(graph, stretch, monkeypatch):
    """By dense matrices; whatever the length of the stretches, that of a single pose among them."""
    monkeypatch.setattr(sys.modules[reduced_system.__module__], "STRETCH", stretch)
    h, num = linearize(graph)[0].toarray(), 3 * (len(graph.poses) - 1)
    schur = h[num:, num:] - h[num:, :num] @ np.linalg.solve(h[:num, :num], h[:num, num:])
    np.testing.assert_allclose(reduced_system(graph).information, schur, rtol=1e-7, atol=1e-7 * np.abs(schur).max())
