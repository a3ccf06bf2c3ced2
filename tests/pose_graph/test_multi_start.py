"""Several starts: where each begins, and that the lowest end is what comes out."""

from dataclasses import replace

import numpy as np
import pytest
from graphs import random_graph

from npslam_teach import datasets, pose_graph, se2
from npslam_teach.pose_graph import chi2, levenberg_marquardt, minimize, odometry_start, relaxed_start
from npslam_teach.types import BetweenFactors, ObservationFactors, PoseGraph

NOTHING_SEEN = ObservationFactors([], [], np.zeros((0, 2)), np.zeros((0, 2, 2)))


def ring(seed, num_poses=300):
    """Six rounds of a circle with a closure to the round before at every tenth pose; the start is the odometry."""
    rng = np.random.default_rng(seed)
    turn = 2 * np.pi * 6 / num_poses
    path = se2.dead_reckoning(np.tile([1.0, 0.0, turn], (num_poses - 1, 1)))
    closing = np.arange(50, num_poses, 10)
    i = np.concatenate([np.arange(num_poses - 1), closing - 50])
    j = np.concatenate([np.arange(1, num_poses), closing])
    std = np.array([0.05, 0.05, 0.15])
    measured = se2.between(path[i], path[j]) + rng.normal(size=(len(i), 3)) * std
    factors = BetweenFactors(i, j, measured, np.tile(np.diag(1 / std**2), (len(i), 1, 1)))
    odometry = se2.dead_reckoning(measured[: num_poses - 1])
    return PoseGraph(odometry, np.zeros((0, 2)), factors, NOTHING_SEEN), replace(
        PoseGraph(path, np.zeros((0, 2)), factors, NOTHING_SEEN)
    )


def test_minimize_finds_the_minimum_below_the_truth_from_bad_odometry():
    """Over forty drives: never worse than the solver from odometry alone, and better in some."""
    alone, descended, best = [], [], []
    for seed in range(40):
        odometry, truth = ring(seed)
        alone.append(list(pose_graph.levenberg_marquardt(odometry))[-1].chi2)
        descended.append(pose_graph.minimize(odometry)[-1].chi2)
        best.append(list(pose_graph.levenberg_marquardt(truth))[-1].chi2)
    assert (np.array(descended) <= np.array(alone) * (1 + 1e-9)).all()
    np.testing.assert_allclose(descended, best, rtol=1e-6)
    assert (np.array(alone) > 1.01 * np.array(best)).any()


@pytest.mark.parametrize("seed", range(5))
def test_the_start_with_the_lower_chi2_is_taken(seed):
    graph = random_graph(seed, num_poses=20, num_loops=8)
    solved = pose_graph.optimize(graph)
    assert len(minimize(solved)) == 2
    lost = replace(graph, poses=np.zeros_like(graph.poses))
    assert minimize(lost)[0].chi2 == pytest.approx(chi2(pose_graph.chordal_start(lost)))
    assert minimize(lost)[-1].chi2 == pytest.approx(chi2(solved), rel=1e-9)


def test_the_wrong_minimum_of_a_given_start_is_left(cases_folder):
    graph = datasets.load_g2o(cases_folder / "wrong_minimum.g2o")
    assert chi2(pose_graph.optimize(graph)) == pytest.approx(15.889198, abs=1e-5)


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("make", [odometry_start, relaxed_start])
def test_without_noise_every_start_is_the_solution(make, seed):
    graph = random_graph(seed, noise=0.0, start_noise=0.0, num_landmarks=3)
    for fixed in ((0,), (4,)):
        lost = replace(graph, poses=np.where(np.isin(np.arange(len(graph.poses)), fixed)[:, None], graph.poses, 9.0))
        lost = replace(lost, landmarks=np.full_like(graph.landmarks, 9.0), fixed_poses=fixed)
        found = make(lost)
        assert chi2(found) < 1e-12
        np.testing.assert_allclose(found.poses[:, :2], graph.poses[:, :2], atol=1e-6)
        np.testing.assert_allclose(found.landmarks, graph.landmarks, atol=1e-6)
        np.testing.assert_array_equal(found.poses[list(fixed)], graph.poses[list(fixed)])


def test_the_odometry_start_takes_steps_before_loop_closures():
    graph, _ = ring(0)
    np.testing.assert_allclose(odometry_start(replace(graph, poses=0 * graph.poses)).poses, graph.poses, atol=1e-9)


def test_of_poses_that_no_step_ties_to_a_fixed_one_the_first_keeps_its_estimate():
    steps = BetweenFactors([0, 3], [1, 2], [[1.0, 0, 0]] * 2, np.tile(np.eye(3), (2, 1, 1)))
    graph = PoseGraph(np.full((4, 3), 2.0) * [[0], [0], [1], [7]], np.zeros((0, 2)), steps, NOTHING_SEEN)
    expected = [[0, 0, 0], [1, 0, 0], [2, 2, 2], se2.compose([2.0, 2, 2], [-1.0, 0, 0])]
    np.testing.assert_allclose(odometry_start(graph).poses, expected, atol=1e-12)


def test_the_relaxed_start_uses_what_landmarks_say():
    """A drive whose odometry says nothing of headings: the objects that it keeps in sight do."""
    rng = np.random.default_rng(0)
    path = se2.dead_reckoning(np.tile([1.0, 0.0, 0.4], (11, 1)))
    objects = rng.uniform(-3, 6, (4, 2))
    pose, landmark = np.repeat(np.arange(12), 4), np.tile(np.arange(4), 12)
    seen = ObservationFactors(pose, landmark, se2.apply_inverse(path[pose], objects[landmark]), [np.eye(2)] * 48)
    steps = se2.between(path[:-1], path[1:]) * [1, 1, 0]
    blind = BetweenFactors(np.arange(11), np.arange(1, 12), steps, [np.diag([1.0, 1.0, 0.0])] * 11)
    found = relaxed_start(PoseGraph(np.zeros((12, 3)), np.zeros((4, 2)), blind, seen))
    np.testing.assert_allclose(found.poses[:, :2], path[:, :2], atol=1e-9)
    np.testing.assert_allclose(se2.wrap(found.poses[:, 2] - path[:, 2]), 0, atol=1e-9)
    np.testing.assert_allclose(found.landmarks, objects, atol=1e-9)


def test_every_start_that_was_tried_is_reported(cases_folder):
    graph = datasets.load_g2o(cases_folder / "wrong_minimum.g2o")
    optimum = pose_graph.certified_minimum(graph)
    assert min(optimum.chi2_by_start.values()) == optimum.certificate.chi2 == optimum.iterations[-1].chi2
    assert chi2(optimum.graph) == pytest.approx(optimum.certificate.chi2, rel=1e-12)
    assert list(levenberg_marquardt(graph))[-1].chi2 > optimum.certificate.chi2


@pytest.mark.parametrize("fixed", [range(20), [0]])
def test_a_graph_with_nothing_to_solve_is_solved(fixed):
    """All poses held still; or one pose alone, and no factor."""
    graph = random_graph(0, num_poses=20, num_landmarks=0)
    graph = replace(graph, poses=np.column_stack([graph.poses[:, :2], se2.wrap(graph.poses[:, 2])]))
    if len(fixed) == 1:
        nothing = BetweenFactors([], [], np.zeros((0, 3)), np.zeros((0, 3, 3)))
        graph = replace(graph, poses=graph.poses[:1], between=nothing)
    graph = replace(graph, fixed_poses=list(fixed))
    optimum = pose_graph.certified_minimum(graph)
    np.testing.assert_array_equal(optimum.graph.poses, graph.poses)
    assert optimum.iterations[-1].converged and optimum.certificate.status == "certified"


def test_far_from_the_origin_a_graph_of_two_poses_gets_an_answer():
    """The rounding of numbers of 1e14 m is no proof of anything, and no reason to stop."""
    step = BetweenFactors([0], [1], [[1.0, 0, 0]], [np.eye(3)])
    graph = PoseGraph([[1e14, 1e14, 0], [1e14 + 1, 1e14, 0]], np.zeros((0, 2)), step, NOTHING_SEEN)
    optimum = pose_graph.certified_minimum(graph)
    assert optimum.certificate.chi2 == 0 and np.isfinite(optimum.certificate.gap)
