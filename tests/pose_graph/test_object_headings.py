"""Landmarks that face somewhere: derivatives, another solver, symmetry, and what is round."""

from dataclasses import replace

import numpy as np
import pytest
from graphs import random_graph, random_information

from npslam_teach import pose_graph, se2
from npslam_teach.datasets import save_g2o
from npslam_teach.pose_graph.factor_kinds import FACTOR_KINDS
from npslam_teach.pose_graph.gauss_newton import gauss_newton
from npslam_teach.pose_graph.object_headings import symmetry_of_objects
from npslam_teach.pose_graph.unknowns import unknowns_of
from npslam_teach.types import HeadingFactors, PoseGraph, RobotLog

SYMMETRY = np.array([1, 2, 4, 1])  # of the four landmarks of a random graph


def oriented_graph(seed=0, noise=0.1) -> PoseGraph:
    """A random graph whose landmarks face somewhere; what looks alike is reported at random."""
    graph, rng = random_graph(seed, start_noise=0.1), np.random.default_rng([seed, 1])
    pose, landmark = graph.observations.pose, graph.observations.landmark
    facing = rng.uniform(-np.pi, np.pi, len(graph.landmarks))
    alike = rng.integers(0, 4, len(pose)) * 2 * np.pi / SYMMETRY[landmark]
    theta = facing[landmark] - graph.poses[pose, 2] + alike + noise * rng.normal(size=len(pose))
    heads = HeadingFactors(pose, landmark, theta, SYMMETRY[landmark], random_information(rng, len(pose), 1))
    start = facing + 0.2 * rng.normal(size=len(facing))
    return replace(graph, landmarks=np.column_stack([graph.landmarks, start]), headings=heads)


def residual_vector(graph):
    """All residuals, whitened, written out from the definition."""
    found = []
    for kind in FACTOR_KINDS:
        root = np.linalg.cholesky(kind.information(graph)).swapaxes(1, 2)
        found.append(np.einsum("eij,ej->ei", root, kind.residuals(graph)).ravel())
    return np.concatenate(found)


@pytest.mark.parametrize("symmetry", [1, 2, 4, 7])
def test_jacobians_are_the_derivatives_of_the_residual(symmetry):
    rng, step = np.random.default_rng(symmetry), 1e-6
    pose, landmark = rng.normal(scale=3.0, size=(2, 200, 3))
    theta = rng.uniform(-9, 9, 200)
    jacobians = pose_graph.heading_jacobians(pose, landmark)
    for which, jacobian in enumerate(jacobians):
        for k in range(3):
            moved = [[pose.copy(), landmark.copy()] for _ in range(2)]
            moved[0][which][:, k] += step
            moved[1][which][:, k] -= step
            ahead, behind = (pose_graph.heading_residual(*each, theta, np.array(symmetry)) for each in moved)
            slope = se2.wrap_symmetric(ahead - behind, symmetry)[:, 0] / (2 * step)
            np.testing.assert_allclose(jacobian[:, 0, k], slope, atol=1e-8)


def test_what_looks_alike_has_the_same_residual_and_the_smallest():
    rng = np.random.default_rng(0)
    pose, landmark = rng.normal(scale=3.0, size=(2, 100, 3))
    theta = rng.normal(size=100)
    for symmetry in (1, 2, 4):
        plain = pose_graph.heading_residual(pose, landmark, theta, np.array(symmetry))
        turned = pose_graph.heading_residual(pose, landmark, theta + 2 * np.pi / symmetry, np.array(symmetry))
        np.testing.assert_allclose(turned, plain, atol=1e-12)
        assert np.abs(plain).max() <= np.pi / symmetry + 1e-12
        assert np.abs(plain).max() > 0.9 * np.pi / symmetry
    assert not pose_graph.heading_residual(pose, landmark, theta, np.array(0)).any()


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_the_solver_agrees_with_least_squares(seed):
    from scipy.optimize import least_squares

    graph = oriented_graph(seed)

    def at(x):
        return residual_vector(pose_graph.retract(graph, x))

    count = unknowns_of(graph).count
    assert count == 3 * (len(graph.poses) - 1) + 3 * len(graph.landmarks)
    reference = least_squares(at, np.zeros(count), xtol=1e-14, ftol=1e-14, gtol=1e-14)
    for solved in (pose_graph.optimize(graph), list(gauss_newton(graph))[-1].graph):
        assert pose_graph.chi2(solved) == pytest.approx(2 * reference.cost, rel=1e-9)
        expected = pose_graph.retract(graph, reference.x)
        np.testing.assert_allclose(solved.landmarks, expected.landmarks, atol=1e-6)
        np.testing.assert_allclose(solved.poses, expected.poses, atol=1e-6)


def test_normal_equations_and_covariances_are_those_of_the_dense_jacobian():
    graph = pose_graph.optimize(oriented_graph(3))
    count, step = unknowns_of(graph).count, 1e-6
    columns = [
        (residual_vector(pose_graph.retract(graph, dx)) - residual_vector(pose_graph.retract(graph, -dx))) / (2 * step)
        for dx in step * np.eye(count)
    ]
    dense = np.array(columns)  # (n, all residuals)
    h, b, chi2 = pose_graph.linearize(graph)
    np.testing.assert_allclose(h.toarray(), dense @ dense.T, rtol=1e-5, atol=1e-4)
    np.testing.assert_allclose(b, dense @ residual_vector(graph), atol=1e-4)
    assert chi2 == pytest.approx(residual_vector(graph) @ residual_vector(graph))
    of_poses, of_landmarks = pose_graph.marginal_covariance(graph, [2], [0, 3])
    cov = np.linalg.inv(h.toarray())
    np.testing.assert_allclose(of_poses[0], cov[3:6, 3:6], rtol=1e-6, atol=1e-12)
    first = 3 * (len(graph.poses) - 1)
    np.testing.assert_allclose(
        of_landmarks[1], cov[first + 9 : first + 12, first + 9 : first + 12], rtol=1e-6, atol=1e-12
    )


def test_a_fit_takes_up_as_many_numbers_as_it_has_unknowns():
    graph = oriented_graph(3)
    factors = {kind.name: getattr(graph, kind.name) for kind in FACTOR_KINDS}
    plain = {
        name: replace(each, information=np.tile(np.eye(each.information.shape[1]), (len(each.information), 1, 1)))
        for name, each in factors.items()
    }
    graph = pose_graph.optimize(replace(graph, **plain))
    kinds = zip(FACTOR_KINDS, pose_graph.mean_leverages(graph, most=10**6), strict=True)
    taken = sum(len(kind.information(graph)) * each.sum() for kind, each in kinds)
    assert taken == pytest.approx(unknowns_of(graph).count)


def test_a_moved_world_has_the_same_chi2():
    graph, motion = oriented_graph(4), np.array([3.0, -2.0, 2.5])
    moved = replace(
        graph, poses=se2.compose(motion, graph.poses), landmarks=se2.compose(motion, graph.landmarks), fixed_poses=[0]
    )
    assert pose_graph.chi2(moved) == pytest.approx(pose_graph.chi2(graph), rel=1e-12)
    solved, other = pose_graph.optimize(graph), pose_graph.optimize(moved)
    np.testing.assert_allclose(se2.compose(motion, solved.poses)[:, :2], other.poses[:, :2], atol=1e-6)


@pytest.mark.parametrize("start", ["chordal_start", "odometry_start", "relaxed_start"])
def test_every_start_leads_to_the_same_minimum(start):
    graph = oriented_graph(5, noise=0.02)
    end = pose_graph.optimize(getattr(pose_graph, start)(graph))
    assert end.landmarks.shape == graph.landmarks.shape
    assert pose_graph.chi2(end) == pytest.approx(pose_graph.chi2(pose_graph.optimize(graph)), rel=1e-6)


def test_nothing_is_certified_and_nothing_is_written_that_would_lose_headings(tmp_path):
    graph = pose_graph.optimize(oriented_graph(6))
    found = pose_graph.certified_minimum(graph)
    assert (found.certificate.status, found.certificate.gap) == ("none", found.certificate.chi2)
    assert found.iterations[-1].chi2 == pytest.approx(pose_graph.chi2(graph))
    with pytest.raises(ValueError, match="without headings.*got headings"):
        save_g2o(tmp_path / "a.g2o", graph)
    save_g2o(tmp_path / "a.g2o", pose_graph.positions_only(graph))


def test_headings_need_landmarks_that_have_them():
    graph = oriented_graph(0)
    with pytest.raises(ValueError, match=r"landmarks: expected shape \(any, 3\) with headings, got \(4, 2\)"):
        replace(graph, landmarks=graph.landmark_xy)
    with pytest.raises(np.linalg.LinAlgError, match="landmark . is not"):
        pose_graph.optimize(replace(graph, headings=pose_graph.positions_only(graph).headings))


# --- from a log ------------------------------------------------------------------------------------------------------


def small_log(**fields) -> RobotLog:
    """Three things, each seen from all of five poses: one with a front, one half-turn symmetric, one round."""
    rng, poses = np.random.default_rng(8), se2.dead_reckoning([[0.5, 0.1, 0.4]] * 4)
    xy, facing = np.array([[2.0, 1.0], [1.0, 2.0], [0.0, 3.0]]), np.array([3.1, -1.0, 0.0])
    time, obj = np.divmod(np.arange(15), 3)
    given = {
        "odometry": np.array([[0.5, 0.1, 0.4]] * 4) + 0.01 * rng.normal(size=(4, 3)),
        "obs_time": time,
        "obs_xy": se2.apply_inverse(poses[time], xy[obj]) + 0.05 * rng.normal(size=(15, 2)),
        "obs_class": obj,
        "num_classes": 3,
        "odometry_std": (0.02, 0.02, 0.02),
        "observation_std": (0.1, 0.1),
        "obs_theta": facing[obj] - poses[time, 2] + 0.05 * rng.normal(size=15) + np.pi * (obj == 1) * (time % 2),
        "observation_theta_std": 0.1,
        "class_symmetry": (1, 2, 0),
    }
    return RobotLog(**given | fields)


def test_a_fit_finds_which_way_things_face():
    log = small_log()
    graph = pose_graph.fit(log, log.obs_class)
    assert graph.landmarks.shape == (3, 3)
    off = se2.wrap_symmetric(graph.landmarks[:, 2] - [3.1, -1.0, 0.0], np.array([1, 2, 1]))
    assert np.abs(off).max() < 0.1
    assert len(graph.headings.pose) == 11  # ten, and one by which the round thing is said to face nowhere
    plain = pose_graph.fit(replace(log, obs_theta=None, observation_theta_std=None), log.obs_class)
    assert plain.landmarks.shape == (3, 2)
    assert pose_graph.chi2(graph) >= pose_graph.chi2(plain)


@pytest.mark.parametrize("nothing", [{"class_symmetry": (0, 0, 0)}, {"observation_theta_std": 2.0}])
def test_headings_that_say_nothing_change_nothing(nothing):
    """Of round things, and as uncertain as a guess."""
    log = small_log(**nothing)
    graph = pose_graph.fit(log, log.obs_class)
    plain = pose_graph.fit(replace(log, obs_theta=None, observation_theta_std=None), log.obs_class)
    np.testing.assert_allclose(graph.poses, plain.poses, atol=1e-9)
    np.testing.assert_allclose(graph.landmark_xy, plain.landmarks, atol=1e-9)
    assert pose_graph.chi2(graph) == pytest.approx(pose_graph.chi2(plain), rel=1e-9)


def test_a_guess_is_worth_less_where_more_looks_alike():
    log = small_log(observation_theta_std=1.0)  # a guess among half a turn errs by 0.91 rad, among a whole by 1.81
    np.testing.assert_array_equal(pose_graph.symmetries(log), np.array([1, 0, 0])[log.obs_class])
    assert not pose_graph.symmetries(replace(log, obs_theta=None, observation_theta_std=None)).any()


def test_means_of_headings_lie_on_the_circle():
    labels, symmetry = np.array([0, 0, 1, 1, 2, -1]), np.array([1, 1, 2, 2, 0, 1])
    theta = np.array([3.1, -3.1, 0.2, 0.3 + np.pi, 5.0, 1.0])
    np.testing.assert_array_equal(symmetry_of_objects(labels, symmetry), [1, 2, 0])
    off = se2.wrap_symmetric(
        pose_graph.mean_headings(labels, theta, symmetry) - [np.pi, 0.25, 0.0], np.array([1, 2, 1])
    )
    np.testing.assert_allclose(off, 0, atol=1e-12)


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"obs_theta": None}, "obs_theta: expected obs_theta and observation_theta_std together"),
        ({"observation_theta_std": None}, "observation_theta_std: expected obs_theta and"),
        ({"observation_theta_std": 0.0}, "observation_theta_std: expected positive"),
        ({"obs_theta": np.zeros(3)}, r"obs_theta: expected shape \(15\), got \(3,\)"),
        ({"obs_theta": np.full(15, np.nan)}, "obs_theta: expected finite"),
        ({"class_symmetry": (1, 2)}, r"class_symmetry: expected shape \(3\), got \(2,\)"),
        ({"class_symmetry": (1, -1, 0)}, "class_symmetry: expected how many headings look alike"),
    ],
)
def test_wrong_headings_are_named(wrong, words):
    with pytest.raises(ValueError, match=words):
        small_log(**wrong)
