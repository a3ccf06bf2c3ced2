"""Where each variable stands in dx, and what is fixed."""

from dataclasses import replace

import numpy as np
import pytest
from graphs import random_graph

from npslam_teach import pose_graph
from npslam_teach.pose_graph import linearize, retract
from npslam_teach.pose_graph.block_sparsity import FIXED
from npslam_teach.pose_graph.unknowns import name_of, steps_by_variable, unknowns_of

CASES = [((0,), ()), ((3,), ()), ((0, 5), (1,)), ((), (0, 2))]


def fixed_graph(seed, poses, landmarks):
    return replace(random_graph(seed), fixed_poses=poses, fixed_landmarks=landmarks)


@pytest.mark.parametrize(("poses", "landmarks"), CASES)
def test_every_free_number_has_one_place_and_fixed_ones_none(poses, landmarks):
    graph = fixed_graph(0, poses, landmarks)
    unknowns = unknowns_of(graph)
    of_poses = unknowns.of("poses", np.arange(len(graph.poses)), 3)
    of_landmarks = unknowns.of("landmarks", np.arange(len(graph.landmarks)), 2)
    assert (of_poses[list(poses)] == FIXED).all() and (of_landmarks[list(landmarks)] == FIXED).all()
    places = np.concatenate([of_poses.ravel(), of_landmarks.ravel()])
    np.testing.assert_array_equal(np.sort(places[places != FIXED]), np.arange(unknowns.count))
    assert linearize(graph)[1].shape == (unknowns.count,)


@pytest.mark.parametrize(("poses", "landmarks"), CASES)
def test_a_step_is_split_as_it_was_flattened(poses, landmarks):
    graph = fixed_graph(1, poses, landmarks)
    dx = 0.01 * np.random.default_rng(0).normal(size=unknowns_of(graph).count)
    np.testing.assert_array_equal(unknowns_of(graph).flatten(steps_by_variable(graph, dx)), dx)
    moved = retract(graph, dx)
    np.testing.assert_array_equal(moved.poses[list(poses)], graph.poses[list(poses)])
    np.testing.assert_array_equal(moved.landmarks[list(landmarks)], graph.landmarks[list(landmarks)])


@pytest.mark.parametrize(("poses", "landmarks"), CASES)
def test_a_step_in_one_unknown_moves_the_variable_that_is_named(poses, landmarks):
    graph = fixed_graph(1, poses, landmarks)
    graph = retract(graph, np.zeros(unknowns_of(graph).count))  # with headings in (-pi, pi]
    for unknown, dx in enumerate(1e-3 * np.eye(unknowns_of(graph).count)):
        moved = retract(graph, dx)
        changed = [f"pose {k}" for k in np.flatnonzero((moved.poses != graph.poses).any(axis=1))]
        changed += [f"landmark {k}" for k in np.flatnonzero((moved.landmarks != graph.landmarks).any(axis=1))]
        assert changed == [name_of(graph, unknown)]


@pytest.mark.parametrize(("poses", "landmarks"), CASES)
def test_what_is_fixed_stays_and_no_free_variable_finds_anything_better(poses, landmarks):
    graph = fixed_graph(2, poses, landmarks)
    solved = pose_graph.optimize(graph, tolerance=1e-13)
    np.testing.assert_array_equal(solved.poses[list(poses)], graph.poses[list(poses)])
    np.testing.assert_array_equal(solved.landmarks[list(landmarks)], graph.landmarks[list(landmarks)])
    least = pose_graph.chi2(solved)
    for dx in 1e-3 * np.eye(unknowns_of(graph).count):
        assert pose_graph.chi2(retract(solved, dx)) > least and pose_graph.chi2(retract(solved, -dx)) > least


def test_covariances_are_relative_to_what_is_fixed():
    solved = pose_graph.optimize(fixed_graph(3, (4,), (2,)))
    inverse = np.linalg.inv(linearize(solved)[0].toarray())
    pose_cov, landmark_cov = pose_graph.marginal_covariance(solved, [4, 0, 5], [2, 3])
    np.testing.assert_array_equal(pose_cov[0], 0.0)
    np.testing.assert_array_equal(landmark_cov[0], 0.0)
    np.testing.assert_allclose(pose_cov[1], inverse[:3, :3], rtol=1e-8, atol=1e-14)
    np.testing.assert_allclose(pose_cov[2], inverse[12:15, 12:15], rtol=1e-8, atol=1e-14)
    np.testing.assert_allclose(landmark_cov[1], inverse[-2:, -2:], rtol=1e-8, atol=1e-14)


def test_one_fixed_landmark_does_not_fix_the_gauge():
    with pytest.raises(np.linalg.LinAlgError, match="H is singular"):
        pose_graph.optimize(fixed_graph(0, (), (1,)))


def test_a_graph_with_nothing_fixed_is_refused():
    with pytest.raises(ValueError, match="fixed_poses: expected at least one"):
        fixed_graph(0, (), ())
    with pytest.raises(ValueError, match="fixed_landmarks: expected the index of a landmark"):
        fixed_graph(0, (0,), (9,))
