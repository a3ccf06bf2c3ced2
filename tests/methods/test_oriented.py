"""Headings in the methods: what they are worth, what they must not change, and oracles for each share of them."""

import functools
from dataclasses import replace

import numpy as np
import pytest
from beginnings import first_poses
from scipy.stats import chi2 as chi_squared
from scipy.stats import multivariate_normal

from npslam_teach import evaluation, se2, simulate
from npslam_teach.association import all_partitions, same_partition
from npslam_teach.association.headings import log_heading_evidence
from npslam_teach.association.partition_posterior import log_posterior
from npslam_teach.experiments.back_to_back import CENTRES, hall
from npslam_teach.methods import METHODS, np_graph, posterior, sample_posterior, settings_for, without_headings
from npslam_teach.methods.block_filter import Belief
from npslam_teach.methods.ekf_slam import run_filter
from npslam_teach.methods.gating import as_two_degrees
from npslam_teach.methods.np_graph import half_steps
from npslam_teach.methods.oriented import ChainHeadings, Headings, kernel_heading_std, sights
from npslam_teach.methods.posterior import start_model
from npslam_teach.methods.tracklets import tracklets
from npslam_teach.pose_graph import between_jacobians, fit
from npslam_teach.pose_graph.reduced_system import reduced_system
from npslam_teach.types import RobotLog

SEEING = [name for name, method in METHODS.items() if method.sees_headings]
BLIND = [name for name, method in METHODS.items() if not method.sees_headings]


@pytest.fixture(scope="module")
def sharp():
    return hall(0, 10.0)


def last_of(name, log):
    settings = settings_for(log) if name == "np-graph" else {}
    return list(METHODS[name](log, **settings))[-1]


@functools.cache
def beginning():
    """Eighty poses of ``sharp``, which see every object, and their truth."""
    log, truth = hall(0, 10.0)
    cut = first_poses(log, 80)
    return cut, replace(truth, poses=truth.poses[: cut.num_poses], obs_object=truth.obs_object[: cut.num_observations])


@functools.cache
def found_in_beginning(name, with_headings):
    """The answer of a method, which several tests look at."""
    log, _ = beginning()
    return last_of(name, log if with_headings else without_headings(log))


@pytest.mark.parametrize("name", SEEING)
def test_headings_decide_where_centroids_cannot(name):
    log, truth = beginning()
    with_them, without = (evaluation.evaluate(found_in_beginning(name, each), truth, log) for each in (True, False))
    assert with_them.num_objects == 2 * len(CENTRES)
    assert with_them.ari > 0.95 > 0.8 > without.ari


@pytest.mark.parametrize("name", SEEING)
def test_an_object_faces_where_it_faces(name):
    _, truth = beginning()
    last = found_in_beginning(name, True)
    motion = se2.align(last.graph.poses[:, :2], truth.poses[:, :2])
    of_object = truth.obs_object[[np.flatnonzero(last.labels == k)[0] for k in range(last.num_objects)]]
    off = se2.wrap(last.graph.landmarks[:, 2] + motion[2] - truth.world.object_theta[of_object])
    assert np.abs(off).max() < 0.3


@pytest.mark.parametrize("name", SEEING)
@pytest.mark.parametrize("nothing", [{"class_symmetry": [0]}, {"observation_theta_std": 1e4}])
def test_headings_that_say_nothing_change_nothing(name, nothing):
    """Of round things, and of any that are no better than a guess."""
    found, without = last_of(name, replace(beginning()[0], **nothing)), found_in_beginning(name, False)
    np.testing.assert_array_equal(found.labels, without.labels)
    np.testing.assert_allclose(found.graph.poses, without.graph.poses, atol=1e-7)
    np.testing.assert_allclose(found.graph.landmark_xy, without.graph.landmarks, atol=1e-7)


@pytest.mark.parametrize("name", BLIND)
def test_who_does_not_look_at_headings_gives_what_it_gave(name, sharp):
    found, without = last_of(name, sharp[0]), last_of(name, without_headings(sharp[0]))
    np.testing.assert_array_equal(found.labels, without.labels)
    np.testing.assert_array_equal(found.graph.poses, without.graph.poses)
    np.testing.assert_array_equal(found.graph.landmarks, without.graph.landmarks)


@pytest.mark.parametrize("name", SEEING)
def test_what_looks_alike_is_the_same(name):
    log = first_poses(hall(1, 10.0, symmetry=2)[0], 50)
    rng = np.random.default_rng(0)
    turned = replace(log, obs_theta=log.obs_theta + np.pi * rng.integers(-2, 3, log.num_observations))
    found = last_of(name, log)
    assert same_partition(last_of(name, turned).labels, found.labels)


def test_the_order_of_the_lines_says_nothing(sharp):
    log = first_poses(sharp[0], 80)
    order = np.lexsort((np.random.default_rng(3).random(log.num_observations), log.obs_time))
    rows = {name: getattr(log, name)[order] for name in ("obs_time", "obs_xy", "obs_class", "obs_theta")}
    *_, first = posterior(log, starts=2)
    *_, other = posterior(replace(log, **rows), starts=2)
    assert same_partition(first.labels[order], other.labels)


def test_half_turn_symmetry_takes_from_headings_what_they_decide():
    """Back to back is front to front for a chair with two fronts."""
    log, truth = hall(2, 10.0, symmetry=2)
    found = last_of("np-graph", log)
    one_front = last_of("np-graph", hall(2, 10.0)[0])
    assert evaluation.evaluate(found, truth, log).ari < 0.8 < evaluation.evaluate(one_front, truth, log).ari


# --- np_graph --------------------------------------------------------------------------------------------------------


def test_both_halves_lower_one_number(sharp):
    """With one width for kernel and solver, of headings as of positions."""
    values = [each.objective for each in half_steps(sharp[0], observation_std=(0.3536, 0.3536), rounds=4)]
    assert np.diff(values).max() <= 1e-6 * abs(values[0])
    assert values[-1] < values[0]


def test_the_width_of_the_kernel_is_the_papers_in_standard_deviations(sharp):
    log, _ = sharp
    assert kernel_heading_std(log, None) == pytest.approx(2.5 * np.deg2rad(10.0))
    assert kernel_heading_std(log, 0.3) == 0.3
    assert kernel_heading_std(without_headings(log), None) is None
    with pytest.raises(ValueError, match="heading_std: expected a positive number of radians, got 0"):
        next(np_graph(log, heading_std=0))


# --- the filter ------------------------------------------------------------------------------------------------------


def started(seed=0):
    """A belief over a pose and three objects that face somewhere."""
    rng = np.random.default_rng(seed)
    a = 0.1 * rng.normal(size=(12, 12))
    return Belief(rng.normal(size=12), a @ a.T + 0.01 * np.eye(12), 3)


def test_an_update_is_the_one_of_whole_matrices():
    belief, rng = started(), np.random.default_rng(1)
    objects, symmetry = np.array([2, 0]), np.array([1, 2])
    noise = np.tile(np.diag([0.1, 0.2, 0.05]) ** 2, (2, 1, 1))
    seen = (
        se2.between(belief.mean[:3], belief.objects[objects])
        + 0.1 * rng.normal(size=(2, 3))
        + [[0, 0, 0], [0, 0, np.pi]]
    )
    by_pose, by_object = between_jacobians(np.tile(belief.mean[:3], (2, 1)), belief.objects[objects])
    jacobian = np.zeros((6, 12))
    for k, i in enumerate(objects):
        jacobian[3 * k : 3 * k + 3, :3] = by_pose[k]
        jacobian[3 * k : 3 * k + 3, 3 + 3 * i : 6 + 3 * i] = by_object[k]
    innovation = seen - se2.between(belief.mean[:3], belief.objects[objects])
    innovation[:, 2] = se2.wrap_symmetric(innovation[:, 2], symmetry)
    s = jacobian @ belief.cov @ jacobian.T + np.kron(np.eye(2), noise[0])
    gain = belief.cov @ jacobian.T @ np.linalg.inv(s)
    after, nis = belief.updated(objects, seen, noise, symmetry)
    np.testing.assert_allclose(after.mean, belief.mean + gain @ innovation.ravel(), atol=1e-12)
    np.testing.assert_allclose(after.cov, (np.eye(12) - gain @ jacobian) @ belief.cov, atol=1e-12)
    assert nis == pytest.approx(innovation.ravel() @ np.linalg.solve(s, innovation.ravel()))
    distance = belief.squared_distances(seen, noise, symmetry)
    alone = innovation[0] @ np.linalg.solve(s[:3, :3], innovation[0])
    assert distance[0, 2] == pytest.approx(as_two_degrees(alone))


def test_a_new_object_has_the_moments_of_many_draws():
    belief = Belief(np.array([1.0, -2.0, 0.5]), np.diag([0.02, 0.03, 0.02]) ** 2, 3)
    seen, noise = np.array([2.0, 1.0, 0.7]), np.diag([0.03, 0.02, 0.05]) ** 2
    after = belief.with_new_object(seen, noise, 1)
    rng = np.random.default_rng(2)
    poses = rng.multivariate_normal(belief.mean, belief.cov, 200_000)
    draws = se2.compose(poses, rng.multivariate_normal(seen, noise, 200_000))
    np.testing.assert_allclose(after.mean[3:], draws.mean(axis=0), atol=2e-3)
    np.testing.assert_allclose(after.cov[3:, 3:], np.cov(draws.T), rtol=0.05, atol=5e-5)


def test_the_round_change_a_filter_no_more_than_points_do(sharp):
    log = replace(sharp[0], class_symmetry=[0])
    found, without = run_filter(log), run_filter(without_headings(log))
    np.testing.assert_allclose(found.pose_cov, without.pose_cov, atol=1e-12)
    np.testing.assert_allclose(found.landmark_cov[:, :2, :2], without.landmark_cov, atol=1e-12)
    np.testing.assert_array_equal(found.nis_dof, without.nis_dof)
    np.testing.assert_allclose(found.nis, without.nis)


def test_a_filter_counts_three_numbers_for_a_match_with_a_heading(sharp):
    log, truth = sharp
    record = run_filter(log, labels=truth.obs_object)
    matches = [np.count_nonzero(log.obs_time == time) for time in range(log.num_poses)]
    assert record.nis_dof.max() % 3 == 0 and (record.nis_dof <= 3 * np.array(matches)).all()
    used = record.nis_dof > 0
    mean = record.nis[used].sum() / record.nis_dof[used].sum()
    assert mean == pytest.approx(1.0, abs=4 * np.sqrt(2 / record.nis_dof.sum()))


def test_three_degrees_are_as_improbable_as_two():
    q = np.array([1e-3, 1.0, 5.0, 11.34, 40.0, 2000.0])
    np.testing.assert_allclose(chi_squared.logsf(as_two_degrees(q), 2), chi_squared.logsf(q, 3), rtol=1e-9)


def test_what_is_fed_is_as_uncertain_as_the_log_says(sharp):
    log = replace(sharp[0], class_symmetry=[0])
    seen, noise = sights(sharp[0])
    assert noise[0, 2, 2] == pytest.approx(np.deg2rad(10.0) ** 2)
    np.testing.assert_array_equal(seen[:, 2], log.obs_theta)
    assert not sights(log)[0][:, 2].any()


# --- the posterior ---------------------------------------------------------------------------------------------------


def tiny(seed, turn_std=0.05, theta_std=0.2) -> RobotLog:
    """Two chairs back to back, seen in two passes."""
    rng, count = np.random.default_rng(seed), 7
    obj, facing = np.array([0, 1, 0, 1, 0, 1]), np.array([0.3, 0.3 + np.pi])
    time, step = np.array([0, 1, 2, 4, 5, 6]), np.array([0.2, 0.0, 0.3])
    poses = se2.dead_reckoning(np.tile(step, (count - 1, 1)))
    xy = np.array([[2.0, 1.0], [2.1, 1.0]])
    return RobotLog(
        odometry=step + [0.02, 0.02, turn_std] * rng.normal(size=(count - 1, 3)),
        obs_time=time,
        obs_xy=se2.apply_inverse(poses[time], xy[obj]) + 0.1 * rng.normal(size=(6, 2)),
        obs_class=np.zeros(6, dtype=int),
        num_classes=1,
        odometry_std=(0.02, 0.02, turn_std),
        observation_std=(0.1, 0.1),
        obs_theta=facing[obj] - poses[time, 2] + theta_std * rng.normal(size=6),
        observation_theta_std=theta_std,
    )


def test_errors_of_chain_headings_are_those_of_many_drives():
    log, rng = tiny(0), np.random.default_rng(4)
    tracklet = np.array([0, 1, 0, 1, 2, 2])
    found = ChainHeadings.of_log(log).of_tracklets(tracklet)
    walk = np.cumsum(log.odometry_std[2] * rng.normal(size=(100_000, log.num_poses - 1)), axis=1)
    walk = np.column_stack([np.zeros(len(walk)), walk])
    off = walk[:, log.obs_time] + log.observation_theta_std * rng.normal(size=(len(walk), 6))
    means = np.column_stack([off[:, tracklet == k].mean(axis=1) for k in range(3)])
    np.testing.assert_allclose(found.cov, np.cov(means.T), atol=6e-4)


@pytest.mark.parametrize("seed", range(3))
def test_the_best_of_all_partitions_is_found(seed):
    """Brute force: every partition, by positions as without headings and by the integral over each object's angle."""
    log = tiny(seed)
    model, graph = start_model(log)
    plain, _ = start_model(without_headings(log))
    labels = [np.array(each) for each in all_partitions(log.obs_class)]
    reduced = reduced_system(graph)
    evidence, without, heads = model.evidence(reduced), plain.evidence(reduced), ChainHeadings.of_log(log)
    told = heads.of_tracklets(np.arange(6))
    for each in labels[::17]:
        members = [np.flatnonzero(each == i) for i in range(each.max() + 1)]
        agreement = sum(log_heading_evidence(told.theta[m], told.cov[np.ix_(m, m)], 1) for m in members)
        expected = log_posterior(without, each) + agreement
        assert log_posterior(evidence, each) == pytest.approx(expected, rel=1e-9)
    *_, last = posterior(log)
    # Judged around the answer's own solution, as the method does.
    answer = fit(without_headings(log), last.labels)
    around = replace(graph, poses=answer.poses, landmarks=answer.landmarks[last.labels])
    evidence = model.evidence(reduced_system(around))
    scores = [log_posterior(evidence, each) for each in labels]
    assert log_posterior(evidence, last.labels) == pytest.approx(max(scores), abs=1e-3)
    assert same_partition(last.labels, np.array([0, 1, 0, 1, 0, 1]))


def test_evidence_of_two_is_the_density_of_their_difference():
    cov = np.array([[0.04, 0.01], [0.01, 0.09]])
    difference = multivariate_normal(0.0, 0.04 + 0.09 - 0.02)
    expected = np.log(difference.pdf(0.25) * 2 * np.pi)
    assert log_heading_evidence(np.array([1.0, 1.25]), cov, 1) == pytest.approx(expected)


def test_a_tracklet_keeps_to_what_faces_as_it_did():
    """Two chairs change places in the picture while only one of them is seen at a time."""
    log = tiny(1)
    found = tracklets(log)
    assert same_partition(found, np.array([0, 1, 0, 1, 0, 1]))
    assert not same_partition(tracklets(without_headings(log)), found)


def test_headings_in_view_follow_a_kalman_filter():
    known = Headings(np.array([0.5]), np.array([0.04]), np.array([1])).after_turn(0.2, 0.01)
    seen = Headings(np.array([0.4]), np.array([0.05]), np.array([1]))
    after = known.updated(np.array([0]), seen)
    np.testing.assert_allclose([after.theta, after.var], [[0.35], [0.025]])
    squared = known.with_positions(np.array([[1.0]]), seen)
    np.testing.assert_allclose(squared, as_two_degrees(np.array([[1.0 + 0.01 / 0.1]])))
    alone = known._replace(symmetry=np.array([0])).with_positions(np.array([[1.0]]), seen)
    np.testing.assert_array_equal(alone, [[1.0]])


@pytest.mark.slow
def test_samples_know_of_headings():
    log = tiny(2)
    samples = sample_posterior(log, 100)
    without = sample_posterior(without_headings(log), 100)
    assert samples.num_objects_probability[2] > 0.9 > without.num_objects_probability.get(2, 0.0)


def test_noise_that_is_added_leaves_headings_alone(sharp):
    noisy = simulate.add_noise(sharp[0], 1.0, np.random.default_rng(0))
    np.testing.assert_array_equal(noisy.obs_theta, sharp[0].obs_theta)


@pytest.mark.parametrize("symmetry", [1, 2, 4])
def test_headings_within_a_tracklet_count_like_independent_ones(symmetry):
    """Small errors of one heading, whatever part of a turn each is off by what looks alike: the exact integral."""
    rng = np.random.default_rng(symmetry)
    tracklet = np.repeat([0, 1, 2, -1], [5, 1, 4, 2])
    theta = np.array([0.3, -2.0, 3.1, 0.0])[tracklet] + rng.normal(0, 0.02, len(tracklet))
    theta = se2.wrap(theta + 2 * np.pi / symmetry * rng.integers(0, symmetry, len(tracklet)))
    chain = ChainHeadings(theta, np.full(len(tracklet), symmetry), np.arange(12), 0.02**2, np.zeros(11))
    own = (np.flatnonzero(tracklet == k) for k in range(3))
    expected = sum(log_heading_evidence(theta[each], 0.02**2 * np.eye(len(each)), symmetry) for each in own)
    assert chain.agreement_within(tracklet) == pytest.approx(expected, abs=1e-9)


def test_what_the_robot_turns_unnoticed_while_an_object_is_in_view_is_its_own_error():
    """The integral over the object's heading, added up; headings of 1 degree, a walk of 2 degrees a step."""
    rng = np.random.default_rng(0)
    var, step_var, time = np.deg2rad(1.0) ** 2, np.full(30, np.deg2rad(2.0) ** 2), np.array([3, 4, 9, 15, 16, 28])
    walk = np.append(0.0, np.cumsum(rng.normal(0, np.sqrt(step_var))))[time]
    theta = 0.4 + walk - walk[0] + rng.normal(0, np.sqrt(var), len(time))
    chain = ChainHeadings(theta, np.ones(len(time), dtype=int), time, var, step_var)
    steps = np.arange(30)[:, None] < time  # which steps each has behind it
    cov = (steps.T * step_var) @ (steps & (np.arange(30)[:, None] >= time[0])) + var * np.eye(len(time))
    facing, width = np.linspace(-np.pi, np.pi, 20_001, retstep=True)
    density = multivariate_normal(np.zeros(len(time)), cov).pdf(theta - facing[:, None]).sum() * width / (2 * np.pi)
    found = chain.agreement_within(np.zeros(len(time), dtype=int))
    assert found == pytest.approx(np.log(density) + len(time) * np.log(2 * np.pi), abs=1e-6)
    still = ChainHeadings(theta, np.ones(len(time), dtype=int), time, var, np.zeros(30))
    assert still.agreement_within(np.zeros(len(time), dtype=int)) < found - 10


def test_good_headings_make_no_chair_of_a_part_of_a_pass():
    """In each of these halls a few observations of a pass once made a chair of their own."""
    for seed in (4, 16):
        log, truth = hall(seed, 2.0)
        *_, last = posterior(log)
        assert same_partition(last.labels, truth.obs_object)


def test_a_turned_observation_is_far_from_its_object_and_a_round_one_from_none():
    theta = np.array([0.0, 0.1, 3.0, 3.1, 1.0])
    chain = ChainHeadings(theta, np.array([1, 1, 1, 1, 0]), np.arange(5), 0.1**2, np.zeros(4))
    squared = chain.squared_turns(np.array([0, 0, 1, 1, 1]), np.zeros(5))
    np.testing.assert_allclose(squared[:, 0], [0.25, 0.25, 29.5**2, 30.5**2, 0.0], atol=1e-6)
    np.testing.assert_allclose(squared[4], 0.0)
    turned = chain.squared_turns(np.array([0, 0, 1, 1, 1]), np.full(5, 0.7))
    np.testing.assert_allclose(turned, squared, atol=1e-6)
