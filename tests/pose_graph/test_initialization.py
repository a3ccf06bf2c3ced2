"""The chordal start: exact where there is no noise, and a good place to begin where odometry is not."""

from dataclasses import replace

import numpy as np
import pytest
from graphs import random_graph

from npslam_teach import datasets, pose_graph, se2, simulate
from npslam_teach.pose_graph import chordal_headings, chordal_start
from npslam_teach.types import BetweenFactors, ObservationFactors, PoseGraph

NOTHING_SEEN = ObservationFactors([], [], np.zeros((0, 2)), np.zeros((0, 2, 2)))


def lost(graph, seed=0):
    """The same factors, and an estimate that knows nothing but pose 0."""
    rng = np.random.default_rng(seed)
    poses = rng.uniform(-9, 9, graph.poses.shape)
    poses[0] = graph.poses[0]
    return replace(graph, poses=poses, landmarks=rng.uniform(-9, 9, graph.landmarks.shape))


@pytest.mark.parametrize("seed", range(10))
def test_without_noise_it_is_the_solution_from_anywhere(seed):
    graph = random_graph(seed, noise=0.0, start_noise=0.0)
    found = chordal_start(lost(graph, seed))
    assert pose_graph.chi2(found) < 1e-12
    np.testing.assert_allclose(found.poses[:, :2], graph.poses[:, :2], atol=1e-6)
    np.testing.assert_allclose(found.landmarks, graph.landmarks, atol=1e-6)
    np.testing.assert_array_equal(found.poses[0], graph.poses[0])


@pytest.mark.parametrize("seed", range(10))
def test_with_noise_the_descent_from_it_ends_where_that_from_the_truth_does(seed):
    graph = random_graph(seed, num_poses=30, num_loops=12, start_noise=0.0)
    *_, best = pose_graph.levenberg_marquardt(graph)
    *_, last = pose_graph.levenberg_marquardt(chordal_start(lost(graph, seed)))
    assert last.converged
    assert last.chi2 == pytest.approx(best.chi2, rel=1e-8)


def test_headings_minimise_the_chordal_distance():
    """Against a dense least-squares solution of the same linear equations."""
    graph = random_graph(2, num_poses=20, num_loops=8, num_landmarks=0)
    i, j, weight = graph.between.i, graph.between.j, np.sqrt(graph.between.information[:, 2, 2])
    a = np.zeros((len(i), 20), dtype=complex)
    a[np.arange(len(i)), j] += weight
    a[np.arange(len(i)), i] -= weight * np.exp(1j * graph.between.relative_pose[:, 2])
    z = np.linalg.lstsq(a[:, 1:], -a[:, 0] * np.exp(1j * graph.poses[0, 2]), rcond=None)[0]
    difference = se2.wrap(chordal_headings(graph)[1:] - np.angle(z))
    np.testing.assert_allclose(difference, 0, atol=1e-8)


@pytest.mark.parametrize("seed", range(10))
@pytest.mark.parametrize("fixed", [((0,), ()), ((3, 7), (1,))])
def test_the_fast_headings_are_those_of_the_plain_equations(seed, fixed):
    graph = lost(random_graph(seed, num_poses=20, num_loops=8), seed)
    graph = replace(graph, fixed_poses=fixed[0], fixed_landmarks=fixed[1])
    difference = se2.wrap(chordal_start(graph).poses[:, 2] - chordal_headings(graph))
    np.testing.assert_allclose(difference, 0, atol=1e-9)


def test_a_pose_without_between_factors_keeps_its_heading():
    """Two objects, seen from two poses that no step connects: positions follow, headings cannot."""
    landmarks = np.array([[2.0, 1.0], [2.0, -1.0]])
    poses = np.array([[0.0, 0, 0], [4.0, 0, 3.0]])
    pose, landmark = np.array([0, 0, 1, 1]), np.array([0, 1, 0, 1])
    xy = se2.apply_inverse(poses[pose], landmarks[landmark])
    seen = ObservationFactors(pose, landmark, xy, np.tile(np.eye(2), (4, 1, 1)))
    no_steps = BetweenFactors([], [], np.zeros((0, 3)), np.zeros((0, 3, 3)))
    found = chordal_start(PoseGraph(poses + [[0, 0, 0], [1.0, 1.0, 0.0]], landmarks, no_steps, seen))
    np.testing.assert_allclose(found.poses, poses, atol=1e-9)


def test_a_single_pose_is_its_own_start():
    no_steps = BetweenFactors([], [], np.zeros((0, 3)), np.zeros((0, 3, 3)))
    alone = PoseGraph(np.array([[1.0, 2.0, 3.0]]), np.zeros((0, 2)), no_steps, NOTHING_SEEN)
    np.testing.assert_array_equal(chordal_start(alone).poses, alone.poses)


def test_a_chain_with_objects_is_solved_from_its_odometry():
    """Without loops between poses the chordal headings are the odometry's: nothing could be gained."""
    log, _ = simulate.toy_objects()
    headings = se2.dead_reckoning(log.odometry)[:, 2]
    steps = np.arange(len(log.odometry))
    factors = BetweenFactors(steps, steps + 1, log.odometry, np.tile(np.eye(3), (len(steps), 1, 1)))
    start = PoseGraph(np.zeros((log.num_poses, 3)), np.zeros((0, 2)), factors, NOTHING_SEEN)
    np.testing.assert_allclose(se2.wrap(chordal_headings(start) - headings), 0, atol=1e-9)


@pytest.mark.parametrize(("name", "expected"), [("intel", 45.004696), ("manhattan", 3549.0368)])
def test_standard_graphs_reach_their_minimum_from_nowhere(data_folder, name, expected):
    graph = lost(datasets.load_g2o(data_folder / f"{name}.g2o"))
    *_, last = pose_graph.levenberg_marquardt(chordal_start(graph))
    assert last.chi2 == pytest.approx(expected, rel=2e-8)
