"""The lecture's loop: the steps of the robust one where no precaution is needed, and what it does where one is."""

from dataclasses import replace

import numpy as np
import pytest
from graphs import random_graph, three_pose_graph

from npslam_teach import datasets, pose_graph, simulate
from npslam_teach.course.pose_graph.explorer import bad_starts
from npslam_teach.pose_graph import gauss_newton, levenberg_marquardt


def assert_same_steps(graph):
    """Equal up to the rounding of two ways to solve H dx = -b: cond(H) is 1e13 at manhattan's start."""
    plain, robust = list(gauss_newton(graph)), list(levenberg_marquardt(graph))
    assert not any(each.damping for each in robust)
    assert plain[-1].converged and len(plain) == len(robust)
    for ours, theirs in zip(plain, robust, strict=True):
        assert ours.chi2 == pytest.approx(theirs.chi2, rel=1e-5, abs=1e-12)
        np.testing.assert_allclose(ours.dx, theirs.dx, atol=1e-6 * max(1.0, np.abs(theirs.dx).max()))
    assert plain[-1].chi2 == pytest.approx(robust[-1].chi2, rel=1e-9, abs=1e-12)


def test_three_poses_solved_by_hand():
    *_, last = gauss_newton(three_pose_graph())
    np.testing.assert_allclose(last.graph.poses, [[0, 0, 0], [14 / 15, 0, 0], [28 / 15, 0, 0]], atol=1e-12)


@pytest.mark.parametrize("seed", range(5))
def test_without_damping_both_solvers_take_the_same_steps(seed):
    assert_same_steps(random_graph(seed, start_noise=0.1))


def test_on_the_toy_scene_too():
    log, truth = simulate.toy_objects()
    solved = pose_graph.fit(log, truth.obs_object)
    moved = np.random.default_rng(0).normal(0, 0.1, solved.poses.shape) * (np.arange(len(solved.poses)) > 0)[:, None]
    assert_same_steps(replace(solved, poses=solved.poses + moved))


@pytest.mark.parametrize("name", ["intel", "manhattan", "victoria_park"])
def test_and_on_standard_graphs(data_folder, name):
    assert_same_steps(datasets.load_g2o(data_folder / f"{name}.g2o"))


def test_from_bad_starts_the_undamped_loop_climbs_and_ends_in_a_local_minimum():
    for graph in bad_starts()[0].values():
        plain, robust = list(gauss_newton(graph)), list(levenberg_marquardt(graph))
        values = np.array([each.chi2 for each in plain])
        assert np.sum(np.diff(values) > 1e-6 * values[:-1]) in (2, 3)
        assert values[-1] == pytest.approx(1214.8, abs=0.1)
        assert robust[-1].chi2 == pytest.approx(199.6, abs=0.1)
        assert max(each.damping for each in robust) > 0


def test_settings_that_make_no_sense_are_refused():
    with pytest.raises(ValueError, match="max_iterations: expected"):
        next(gauss_newton(three_pose_graph(), max_iterations=0))
    with pytest.raises(ValueError, match="tolerance: expected"):
        next(gauss_newton(three_pose_graph(), tolerance=1.0))


def test_a_loop_that_stops_early_says_so():
    *_, last = gauss_newton(random_graph(4), max_iterations=1)
    assert (last.converged, last.status) == (False, "iteration limit")


def test_a_landmark_without_factors_is_refused():
    graph = replace(random_graph(0, num_landmarks=0), landmarks=[[0.0, 0.0]])
    with pytest.raises(np.linalg.LinAlgError, match="landmark 0 is not tied"):
        list(gauss_newton(graph))
