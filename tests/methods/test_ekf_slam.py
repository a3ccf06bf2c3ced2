"""The filter against other roads to the same numbers: differences, the pose graph, trying every match, chi-squared."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chi2

from npslam_teach import dead_reckoning, evaluation, marginal_covariance, pose_graph, se2, simulate
from npslam_teach.course.checking import numerical_jacobian
from npslam_teach.methods.ekf import (
    expected_observations,
    motion_jacobians,
    new_filter,
    observation_state_jacobians,
    predict,
    squared_distances,
    squared_mahalanobis,
    update,
    with_new_object,
)
from npslam_teach.methods.ekf_slam import (
    NEW,
    UNASSIGNED,
    assign,
    ekf_slam,
    filter_steps,
    run_filter,
    squared_gates,
)
from npslam_teach.pose_graph import fit
from npslam_teach.types import RobotLog

TOLD = [0, 1, 2, 0, 1, 2, 3, 4]  # who is who in the toy scene


@pytest.fixture(scope="module")
def toy():
    return simulate.toy_objects()


@pytest.fixture(scope="module")
def scene():
    return simulate.fifteen_objects(seed=0)


def started(size=7, seed=0):
    """A filter somewhere in the middle of its work."""
    rng = np.random.default_rng(seed)
    ekf, root = new_filter(), rng.normal(size=(size, size))
    for _ in range((size - 3) // 2):
        ekf = with_new_object(ekf, rng.normal(size=2), np.ones(2))
    ekf.x, ekf.P = rng.uniform(-3, 3, size), root @ root.T / 10 + 0.1 * np.eye(size)
    return ekf


def same_groups(labels):
    return labels[:, None] == labels[None, :]


# --- the models ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(5))
def test_the_jacobians_are_those_of_differences(seed):
    rng = np.random.default_rng(seed)
    pose, step, mean = rng.uniform(-1.5, 1.5, 3), rng.uniform(-1, 1, 3), rng.uniform(-2, 2, 9)
    by_pose, by_step = motion_jacobians(pose, step)
    np.testing.assert_allclose(by_pose, numerical_jacobian(lambda p: se2.compose(p, step), pose), atol=1e-8)
    np.testing.assert_allclose(by_step, numerical_jacobian(lambda o: se2.compose(pose, o), step), atol=1e-8)
    objects = np.array([2, 0, 2])

    def seen(state):
        return expected_observations(state, np.eye(9), objects, np.ones(2))[0].ravel()

    jacobian = np.concatenate(observation_state_jacobians(mean, objects))
    np.testing.assert_allclose(jacobian, numerical_jacobian(seen, mean), atol=1e-8)


def test_prediction_is_what_the_odometry_alone_says(toy):
    """Mean and covariance against dead reckoning and the pose graph, on a log in which nothing is ever seen again."""
    log, _ = toy
    record = run_filter(log, labels=np.arange(log.num_observations))
    np.testing.assert_allclose(record.poses, dead_reckoning(log.odometry), atol=1e-12)
    solved = fit(log, record.labels, record.poses)
    poses, objects = marginal_covariance(solved, range(log.num_poses), range(log.num_observations))
    np.testing.assert_allclose(record.pose_cov, poses, atol=1e-12)
    np.testing.assert_allclose(record.landmark_cov, objects, atol=1e-12)
    assert np.isnan(record.nis).all() and not record.nis_dof.any()


def test_prediction_leaves_the_map_alone():
    ekf = started()
    before_x, before_p = ekf.x.copy(), ekf.P.copy()
    predict(ekf, np.array([1.0, -0.2, 3.0]), np.array([0.1, 0.2, 0.3]))
    np.testing.assert_array_equal(ekf.x[3:], before_x[3:])
    np.testing.assert_allclose(ekf.P[3:, 3:], before_p[3:, 3:])
    np.testing.assert_allclose(ekf.x[:3], se2.compose(before_x[:3], [1.0, -0.2, 3.0]))
    assert -np.pi <= ekf.x[2] < np.pi


def test_update_by_the_information_form():
    """The posterior information is the prior's plus H^T R^-1 H: no gain, no innovation covariance."""
    ekf, objects, std = started(), np.array([1, 0]), np.array([0.3, 0.7])
    x, P = ekf.x.copy(), ekf.P.copy()
    H = np.concatenate(observation_state_jacobians(x, objects))
    expected, _ = expected_observations(x, P, objects, std)
    xy = expected + [[0.2, -0.1], [0.3, 0.05]]
    update(ekf, objects, xy, std)
    weight = np.diag(np.tile(std**-2.0, 2))
    cov = np.linalg.inv(np.linalg.inv(P) + H.T @ weight @ H)
    moved = x + cov @ H.T @ weight @ (xy - expected).ravel()
    moved[2] = se2.wrap(moved[2])
    np.testing.assert_allclose(ekf.P, cov, atol=1e-10)
    np.testing.assert_allclose(ekf.x, moved, atol=1e-10)
    np.testing.assert_array_equal(ekf.P, ekf.P.T)


def test_the_heading_is_wrapped_after_an_update():
    """A robot that believes to look along -x and sees a known object a little to the side turns past 180 degrees."""
    for heading in (np.pi - 0.02, -np.pi + 0.02):
        ekf = started(5)
        ekf.x, ekf.P = np.array([0, 0, heading, 5.0, 0.0]), np.diag([1e-6, 1e-6, 0.2, 1e-6, 1e-6])
        beyond = heading + np.sign(heading) * 0.1
        update(ekf, np.array([0]), se2.apply_inverse([0, 0, beyond], [[5.0, 0.0]]), np.full(2, 1e-3))
        assert abs(se2.wrap(ekf.x[2] - beyond)) < 0.01
        assert -np.pi <= ekf.x[2] < np.pi


def test_mahalanobis_counts_standard_deviations():
    rng = np.random.default_rng(0)
    root = rng.normal(size=(2, 2))
    white = rng.normal(size=(50, 2))
    squared = squared_mahalanobis(white @ root.T, root @ root.T)
    np.testing.assert_allclose(squared, (white**2).sum(axis=1))


def test_a_new_object_shares_the_errors_of_everything():
    """Draw states and sightings: the covariance of the grown state is that of the draws."""
    ekf, std = started(), np.array([0.02, 0.05])
    ekf.P *= 1e-4
    xy, rng = np.array([1.5, -0.5]), np.random.default_rng(1)
    grown = with_new_object(ekf, xy, std)
    states = rng.multivariate_normal(ekf.x, ekf.P, 200_000)
    seen = se2.apply(states[:, :3], xy + std * rng.normal(size=(len(states), 2)))
    drawn = np.cov(np.hstack([states, seen]).T)
    scale = np.sqrt(np.diag(grown.P))
    np.testing.assert_allclose(drawn / np.outer(scale, scale), grown.P / np.outer(scale, scale), atol=0.02)
    np.testing.assert_allclose(grown.x[-2:], se2.apply(ekf.x[:3], xy))
    assert len(ekf.x) == 7 and len(grown.x) == 9


# --- the filter and the graph ----------------------------------------------------------------------------------------


def test_without_errors_of_heading_the_filter_is_the_pose_graph(toy):
    """Then everything is linear, and the belief about the end must be the same on both roads."""
    log = replace(toy[0], odometry_std=[0.2, 0.05, 1e-7])
    record = run_filter(log, labels=TOLD)
    solved = fit(log, TOLD, record.poses)
    pose_cov, landmark_cov = marginal_covariance(solved, [log.num_poses - 1], range(5))
    np.testing.assert_allclose(record.poses[-1], solved.poses[-1], atol=1e-6)
    np.testing.assert_allclose(record.landmarks, solved.landmarks, atol=1e-6)
    np.testing.assert_allclose(record.pose_cov[-1], pose_cov[0], atol=1e-7)
    np.testing.assert_allclose(record.landmark_cov, landmark_cov, atol=1e-7)
    # The NIS of all frames add up to what the graph cannot satisfy.
    assert np.nansum(record.nis) == pytest.approx(pose_graph.chi2(solved), rel=1e-5)


def test_with_them_it_is_close(toy):
    log, _ = toy
    record = run_filter(log, labels=TOLD)
    solved = fit(log, TOLD, record.poses)
    np.testing.assert_allclose(record.poses[-1], solved.poses[-1], atol=0.01)
    assert np.nansum(record.nis) == pytest.approx(pose_graph.chi2(solved), rel=0.02)


# --- who is who ------------------------------------------------------------------------------------------------------


def test_gates_are_quantiles():
    np.testing.assert_allclose(squared_gates(0.9, 0.9999), chi2.ppf([0.9, 0.9999], 2))


@pytest.mark.parametrize(
    ("gates", "message"),
    [
        ((0.0, 0.9), "gate: expected a probability between 0 and 1, got 0.0"),
        ((1.0, 1.0), "gate: expected"),
        ((float("nan"), 0.9), "gate: expected"),
        ((0.9, 0.8), "new_gate: expected a probability from gate = 0.9 to below 1, got 0.8"),
        ((0.9, 1.0), "new_gate: expected"),
        ((0.9, float("nan")), "new_gate: expected"),
    ],
)
def test_bad_gates_are_named(gates, message, toy):
    with pytest.raises(ValueError, match=message):
        next(ekf_slam(toy[0], *gates))


@pytest.mark.parametrize("seed", range(40))
def test_matches_are_the_cheapest_of_all(seed):
    rng = np.random.default_rng(seed)
    num_sightings, num_objects = rng.integers(1, 5, 2)
    squared = rng.uniform(0, 20, (num_sightings, num_objects))
    squared[rng.random(squared.shape) < 0.2] = np.inf
    decision = assign(squared, 9.0, 15.0)

    def cost(choice):
        return sum(squared[k, j] if j < num_objects else 9.0 for k, j in enumerate(choice))

    places = range(num_objects + num_sightings)
    best = min(itertools.permutations(places, int(num_sightings)), key=cost)
    assert cost(np.where(decision >= 0, decision, num_objects)) == pytest.approx(cost(best))
    used = decision[decision >= 0]
    assert len(np.unique(used)) == len(used)
    for k, chosen in enumerate(decision):
        assert (chosen == NEW) == (chosen < 0 and (squared[k] > 15.0).all())
        assert chosen < 0 or squared[k, chosen] < 9.0


def test_matching_nothing():
    assert assign(np.zeros((0, 3)), 9.0, 9.0).shape == (0,)
    np.testing.assert_array_equal(assign(np.zeros((2, 0)), 9.0, 9.0), [NEW, NEW])
    np.testing.assert_array_equal(assign(np.array([[np.inf], [1.0], [2.0]]), 9.0, 15.0), [NEW, 0, UNASSIGNED])


def seen_from_origin(xy, obs_class, num_frames):
    """A robot that stands still and sees the same points in every frame."""
    count = len(xy)
    time = np.repeat(np.arange(num_frames), count)
    steps = np.zeros((num_frames - 1, 3))
    return RobotLog(
        steps, time, np.tile(xy, (num_frames, 1)), np.tile(obs_class, num_frames), 3, (0.01,) * 3, (0.1,) * 2
    )


def test_two_classes_at_one_place_are_two_objects():
    log = seen_from_origin([[1.0, 0.0], [1.0, 0.0]], [0, 1], 4)
    np.testing.assert_array_equal(run_filter(log).labels, [0, 1] * 4)


def test_two_sightings_of_one_frame_are_two_objects():
    """Five centimetres apart, half a standard deviation: only the frame says that they are two."""
    log = seen_from_origin([[1.0, 0.0], [1.05, 0.0]], [2, 2], 4)
    np.testing.assert_array_equal(run_filter(log).labels, [0, 1] * 4)


def test_between_the_gates_a_sighting_is_left_out():
    """Seen 0, 4.2 and 6.4 standard deviations away: both sightings err, so the innovation has sqrt(2) times 0.1 m."""
    for away, expected in ((0.0, 0), (0.6, UNASSIGNED), (0.9, 1)):
        log = RobotLog([[0, 0, 0]], [0, 1], [[1.0, 0], [1.0 + away, 0]], [0, 0], 1, (1e-6,) * 3, (0.1,) * 2)
        assert run_filter(log).labels.tolist() == [0, expected]


def test_fifteen_objects_in_many_rooms():
    for seed in range(6):
        log, truth = simulate.fifteen_objects(seed)
        *_, last = ekf_slam(log)
        assert last.num_objects == 15
        for k in range(15):
            assert len(np.unique(truth.obs_object[last.labels == k])) == 1
        assert 0.97 < (last.labels >= 0).mean() < 1.0


def test_the_order_within_a_frame_does_not_matter(scene):
    log, _ = scene
    rng = np.random.default_rng(0)
    shuffled = np.lexsort((rng.random(log.num_observations), log.obs_time))
    other = replace(log, **{name: getattr(log, name)[shuffled] for name in ("obs_time", "obs_xy", "obs_class")})
    first, second = run_filter(log), run_filter(other)
    np.testing.assert_array_equal(same_groups(first.labels)[np.ix_(shuffled, shuffled)], same_groups(second.labels))
    np.testing.assert_allclose(first.poses, second.poses, atol=1e-9)


def test_the_order_of_the_log_does_not_matter(scene):
    """The filter goes by the time of a sighting, not by its place in the log."""
    log, _ = scene
    shuffled = np.random.default_rng(0).permutation(log.num_observations)
    other = replace(log, **{name: getattr(log, name)[shuffled] for name in ("obs_time", "obs_xy", "obs_class")})
    np.testing.assert_allclose(run_filter(log).poses, run_filter(other).poses, atol=1e-9)


def test_a_filter_never_looks_ahead(scene):
    """What it believed half-way is the same when the log ends there."""
    log, _ = scene
    half, kept = 300, log.obs_time <= 300
    short = replace(
        log, odometry=log.odometry[:half], **{n: getattr(log, n)[kept] for n in ("obs_time", "obs_xy", "obs_class")}
    )
    whole, part = run_filter(log), run_filter(short)
    np.testing.assert_array_equal(whole.poses[: half + 1], part.poses)
    np.testing.assert_array_equal(whole.labels[kept], part.labels)


# --- its own yardstick -----------------------------------------------------------------------------------------------


def test_the_true_matches_have_the_nis_of_a_consistent_filter():
    total = dof = 0
    for seed in range(6):
        log, truth = simulate.fifteen_objects(seed)
        record = run_filter(log, labels=truth.obs_object)
        total, dof = total + np.nansum(record.nis), dof + record.nis_dof.sum()
        assert record.nis_dof.sum() == 2 * np.isfinite(record.squared_distance).sum()
    assert dof > 10_000
    assert chi2.ppf(1e-4, dof) < total < chi2.ppf(1 - 1e-4, dof)


def test_a_frame_with_one_match_has_its_distance_as_nis(scene):
    log, _ = scene
    record = run_filter(log)
    alone = np.bincount(log.obs_time, minlength=log.num_poses) == 1
    matched = alone[log.obs_time] & np.isfinite(record.squared_distance)
    assert matched.sum() > 50
    np.testing.assert_allclose(record.nis[log.obs_time[matched]], record.squared_distance[matched])


def test_covariances_stay_covariances(scene):
    for step in list(filter_steps(scene[0]))[::20]:
        np.testing.assert_allclose(step.cov, step.cov.T, rtol=0, atol=1e-15)
        assert (np.linalg.eigvalsh(step.cov) > -1e-12).all()


def test_steps_keep_what_was_believed_then(toy):
    """Every step holds its own arrays: what comes after must not write into them."""
    steps = list(filter_steps(toy[0]))
    for step in steps:
        assert len(step.prior_mean) == 3 + 2 * len(step.object_class)
        assert step.squared_distance.shape == (len(step.observations), len(step.object_class))
    np.testing.assert_allclose(steps[4].prior_mean[:3], se2.compose(steps[3].mean[:3], toy[0].odometry[3]))
    np.testing.assert_array_equal(steps[4].prior_mean[3:], steps[3].mean[3:])


# --- being told ------------------------------------------------------------------------------------------------------


def test_names_of_told_objects_do_not_matter(toy):
    log, _ = toy
    first, second = run_filter(log, labels=TOLD), run_filter(log, labels=[7, 3, 20, 7, 3, 20, 0, 100])
    np.testing.assert_array_equal(first.labels, TOLD)
    np.testing.assert_array_equal(second.labels, TOLD)
    assert first.poses.tobytes() == second.poses.tobytes()


def test_told_to_leave_out(toy):
    log, _ = toy
    record = run_filter(log, labels=[-1, 4, -3, -1, 4, -1, -1, 1])
    np.testing.assert_array_equal(record.labels, [-1, 0, -1, -1, 0, -1, -1, 1])
    nothing = run_filter(log, labels=[-1] * 8)
    np.testing.assert_allclose(nothing.poses, dead_reckoning(log.odometry))
    assert nothing.landmarks.shape == (0, 2) and nothing.landmark_cov.shape == (0, 2, 2)


@pytest.mark.parametrize(
    ("labels", "message"),
    [
        ([0, 0, 2, 0, 1, 2, 3, 4], "labels: expected every object at most once in a frame, got one twice at pose 0"),
        ([0, 1, 2], r"labels: expected shape \(8\), got \(3,\)"),
        ([0.5] * 8, "labels: expected integers"),
    ],
)
def test_bad_labels_are_named(labels, message, toy):
    with pytest.raises(ValueError, match=message):
        run_filter(toy[0], labels=labels)


@pytest.mark.parametrize(
    ("setting", "message"),
    [
        ({"odometry_std": (0.1, 0.1)}, r"odometry_std: expected shape \(3\)"),
        ({"odometry_std": (0.1, 0.1, 0.0)}, "odometry_std: expected positive numbers"),
        ({"observation_std": (0.1, -0.1)}, "observation_std: expected positive numbers"),
        ({"observation_std": (0.1, float("nan"))}, "observation_std: expected finite numbers"),
    ],
)
def test_bad_noise_is_named(setting, message, toy):
    for use in (run_filter, lambda log, **keys: next(ekf_slam(log, **keys))):
        with pytest.raises(ValueError, match=message):
            use(toy[0], **setting)


# --- the method ------------------------------------------------------------------------------------------------------


def test_the_snapshots_are_the_record(scene):
    log, _ = scene
    first, last = ekf_slam(log)
    record = run_filter(log)
    assert (first.iteration, last.iteration) == (0, 1)
    np.testing.assert_array_equal(last.labels, record.labels)
    np.testing.assert_array_equal(last.graph.poses, record.poses)
    np.testing.assert_array_equal(last.graph.landmarks, record.landmarks)
    np.testing.assert_allclose(last.graph.between.information[0], np.diag(log.odometry_std**-2.0))
    np.testing.assert_allclose(last.graph.observations.information[0], np.diag(log.observation_std**-2.0))
    *_, coarse = ekf_slam(log, odometry_std=(0.3, 0.2, 0.1), observation_std=(0.5, 0.4))
    np.testing.assert_allclose(coarse.graph.between.information[0], np.diag([0.3**-2, 0.2**-2, 0.1**-2]))
    np.testing.assert_allclose(coarse.graph.observations.information[0], np.diag([0.5**-2, 0.4**-2]))


def test_one_pose_and_no_sighting():
    alone = RobotLog(np.zeros((0, 3)), [], np.zeros((0, 2)), [], 1, (1,) * 3, (1,) * 2)
    *_, last = ekf_slam(alone)
    assert last.num_objects == 0 and last.graph.poses.tolist() == [[0, 0, 0]]
    seen = RobotLog(np.zeros((0, 3)), [0, 0], [[1, 2], [3, 4]], [0, 0], 1, (1,) * 3, (1,) * 2)
    *_, last = ekf_slam(seen)
    np.testing.assert_array_equal(last.graph.landmarks, seen.obs_xy)


def test_the_past_is_worse_than_the_graph_makes_it():
    """A filtered pose never hears of what came after it; the graph on the same matches does."""
    ratios = []
    for seed in range(6):
        log, truth = simulate.fifteen_objects(seed)
        *_, last = ekf_slam(log)
        solved = replace(last, graph=fit(log, last.labels, last.graph.poses))
        filtered, smoothed = (evaluation.distances_to_truth(s, truth)[0].mean() for s in (last, solved))
        ratios.append(smoothed / filtered)
    assert max(ratios) < 1.0 and np.median(ratios) < 0.8


@pytest.mark.parametrize("seed", range(5))
def test_the_filter_on_blocks_does_what_whole_matrices_do(seed):
    """A whole run of both, the same decisions forced on them, to rounding."""
    log, _ = simulate.fifteen_objects(seed)
    std = np.asarray(log.odometry_std), np.asarray(log.observation_std)
    plain, record = new_filter(), list(filter_steps(log))[:150]
    for step in record:
        if step.time > 0:
            predict(plain, log.odometry[step.time - 1], std[0])
        np.testing.assert_allclose(step.prior_mean, plain.x, atol=1e-9)
        np.testing.assert_allclose(step.prior_cov, plain.P, atol=1e-9)
        distance = squared_distances(plain.x, plain.P, log.obs_xy[step.observations], std[1])
        alike = np.isfinite(step.squared_distance)
        np.testing.assert_allclose(step.squared_distance[alike], distance[alike], rtol=1e-6)
        matched = step.decision >= 0
        if matched.any():
            update(plain, step.decision[matched], log.obs_xy[step.observations[matched]], std[1])
            assert step.nis == pytest.approx(float(plain.y @ plain.SI @ plain.y), rel=1e-6)
        for k in step.observations[step.decision == NEW]:
            plain = with_new_object(plain, log.obs_xy[k], std[1])
        np.testing.assert_allclose(step.mean, plain.x, atol=1e-8)
