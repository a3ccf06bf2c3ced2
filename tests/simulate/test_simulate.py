"""The simulator measures what it should, errs as much as it says, and tells the estimator nothing it must not know."""

from dataclasses import fields, replace

import numpy as np
import pytest
import scipy.stats

from npslam_teach import se2, simulate
from npslam_teach.types import SensorModel, World

EXACT = SensorModel((0, 0, 0), (0, 0), 4.0, np.deg2rad(120))
TINY = replace(EXACT, odometry_std=(1e-9,) * 3, observation_std=(1e-9,) * 2)


@pytest.fixture
def world():
    return simulate.scattered_world(3, simulate.FIFTEEN_CLASSES, np.random.default_rng(5))


def run(world, sensor, seed=0):
    return simulate.simulate_run(world, simulate.designed_path(), sensor, np.random.default_rng(seed))


def test_without_noise_the_log_is_the_truth(world):
    log, truth = run(world, TINY)
    np.testing.assert_allclose(log.odometry, se2.between(truth.poses[:-1], truth.poses[1:]), atol=1e-7)
    seen = se2.apply(truth.poses[log.obs_time], log.obs_xy)
    np.testing.assert_allclose(seen, world.object_xy[truth.obs_object], atol=1e-7)
    np.testing.assert_array_equal(log.obs_class, world.object_class[truth.obs_object])


def test_exactly_what_is_in_view_is_seen(world):
    log, truth = run(world, TINY)
    seen = set(zip(log.obs_time.tolist(), truth.obs_object.tolist(), strict=True))
    for t in range(0, len(truth.poses), 50):
        for k in range(len(world.object_xy)):
            d = world.object_xy[k] - truth.poses[t, :2]
            bearing = (np.arctan2(d[1], d[0]) - truth.poses[t, 2] + np.pi) % (2 * np.pi) - np.pi
            assert ((t, k) in seen) == (np.hypot(*d) < 4.0 and abs(bearing) < np.pi / 3)


def test_noise_has_the_standard_deviation_it_claims(world):
    sensor = replace(TINY, odometry_std=(0.03, 0.01, 0.02), observation_std=(0.2, 0.1))
    log, truth = run(world, sensor)
    odometry_error = log.odometry - se2.between(truth.poses[:-1], truth.poses[1:])
    exact = se2.apply_inverse(truth.poses[log.obs_time], world.object_xy[truth.obs_object])
    for error, std in ((odometry_error, sensor.odometry_std), (log.obs_xy - exact, sensor.observation_std)):
        low, high = scipy.stats.chi2.interval(0.9999, len(error))
        for column, s in zip(error.T, std, strict=True):
            assert low < (column**2).sum() / s**2 < high


def test_classes_are_confused_as_often_as_the_matrix_says(world):
    confusion = 0.7 * np.eye(5) + 0.3 * np.roll(np.eye(5), 1, axis=1)
    log, truth = run(world, replace(TINY, class_confusion=confusion))
    true_class = world.object_class[truth.obs_object]
    right = np.mean(log.obs_class == true_class)
    assert abs(right - 0.7) < 4 * np.sqrt(0.7 * 0.3 / len(true_class))
    np.testing.assert_array_equal(np.unique((log.obs_class - true_class) % 5), [0, 1])


def test_missed_and_false_detections(world):
    everything, _ = run(world, TINY)
    log, truth = run(world, replace(TINY, detection_probability=0.6, clutter_rate=0.5))
    real = np.count_nonzero(truth.obs_object >= 0)
    clutter = log.num_observations - real
    n = everything.num_observations
    assert abs(real - 0.6 * n) < 4 * np.sqrt(0.24 * n)
    assert abs(clutter - 0.5 * log.num_poses) < 4 * np.sqrt(0.5 * log.num_poses)
    xy = log.obs_xy[truth.obs_object < 0]
    assert (np.linalg.norm(xy, axis=1) <= 4.0).all()
    assert (np.abs(np.arctan2(xy[:, 1], xy[:, 0])) <= np.pi / 3).all()
    assert (np.diff(log.obs_time) >= 0).all()


def test_the_same_seed_gives_the_same_run_and_another_does_not():
    (a, at), (b, bt), (c, _) = (simulate.fifteen_objects(seed) for seed in (4, 4, 5))
    for field in fields(a):
        np.testing.assert_array_equal(getattr(a, field.name), getattr(b, field.name))
    np.testing.assert_array_equal(at.world.object_xy, bt.world.object_xy)
    assert a.odometry.tobytes() != c.odometry.tobytes()


def test_the_log_holds_no_identity():
    """The true object of an observation must not travel inside it, nor in the order of a frame's observations."""
    log, truth = simulate.fifteen_objects()
    assert {field.name for field in fields(log)} == {
        "odometry",
        "obs_time",
        "obs_xy",
        "obs_class",
        "num_classes",
        "odometry_std",
        "observation_std",
        "class_names",
        "odometry_cov",
        "observation_cov",
        "class_probabilities",
        "obs_theta",
        "observation_theta_std",
        "class_symmetry",
    }
    same_frame = np.diff(log.obs_time) == 0
    falls = np.diff(truth.obs_object)[same_frame] < 0
    assert 0.4 < falls.mean() < 0.6


@pytest.mark.parametrize("seed", range(10))
def test_fifteen_objects_is_the_scene_it_says(seed):
    log, truth = simulate.fifteen_objects(seed)
    world = truth.world
    np.testing.assert_array_equal(np.bincount(world.object_class), [3] * 5)
    assert world.object_xy.min() >= 0 and world.object_xy.max() <= 10
    assert 950 <= log.num_observations <= 1350
    apart = np.linalg.norm(world.object_xy[:, None] - world.object_xy[None], axis=-1) + 99 * np.eye(15)
    assert apart.min() >= 0.5
    assert apart[world.object_class[:, None] == world.object_class].min() >= 2.0
    np.testing.assert_allclose(log.odometry_std, [np.hypot(0.01, 0.02)] * 2 + [np.hypot(0.01, 0.01)])
    np.testing.assert_allclose(log.observation_std, [np.hypot(0.1, 0.1)] * 2)


def test_the_path_is_closed_and_in_even_steps_and_70_m_long():
    path = simulate.designed_path()
    steps = np.linalg.norm(np.diff(path[:, :2], axis=0), axis=1)
    np.testing.assert_allclose(steps, 0.1, atol=2e-3)
    assert 70 <= steps.sum() <= 77
    assert np.linalg.norm(path[-1, :2] - path[0, :2]) < 0.11
    ahead = se2.apply_inverse(path[:-1], path[1:, :2])
    np.testing.assert_allclose(ahead[:, 1], 0, atol=1e-12)
    assert (ahead[:, 0] > 0).all()


def test_every_object_is_seen_again_after_a_while():
    for seed in range(8):
        log, truth = simulate.fifteen_objects(seed)
        times = [log.obs_time[truth.obs_object == k] for k in range(15)]
        visits = [1 + np.count_nonzero(np.diff(t) > 20) for t in times]
        assert min(visits) >= 2
        assert np.mean(visits) > 2.5


def test_added_noise_is_the_papers_and_remembered():
    log, _ = simulate.fifteen_objects(0, noise=0.0)
    noisy = simulate.add_noise(log, 2.0, np.random.default_rng(0))
    low, high = scipy.stats.chi2.interval(0.9999, len(log.odometry))
    for column, std in zip((noisy.odometry - log.odometry).T, (0.04, 0.04, 0.02), strict=True):
        assert low < (column**2).sum() / std**2 < high
    low, high = scipy.stats.chi2.interval(0.9999, 2 * log.num_observations)
    assert low < ((noisy.obs_xy - log.obs_xy) ** 2).sum() / 0.2**2 < high
    np.testing.assert_allclose(noisy.odometry_std, np.hypot([0.01] * 3, [0.04, 0.04, 0.02]))
    np.testing.assert_allclose(noisy.observation_std, np.hypot(0.1, 0.2))


def test_noise_is_drawn_in_the_order_of_the_authors_script():
    """Positions of objects, then steps, then turns: a seed must draw the same noise for ever."""
    log, _ = simulate.fifteen_objects(0)
    noisy, rng = simulate.add_noise(log, 1.0, np.random.default_rng(11)), np.random.default_rng(11)
    np.testing.assert_allclose(noisy.obs_xy - log.obs_xy, 0.1 * rng.normal(size=log.obs_xy.shape), atol=1e-12)
    steps = noisy.odometry - log.odometry
    np.testing.assert_allclose(steps[:, :2], 0.02 * rng.normal(size=(len(steps), 2)), atol=1e-12)
    np.testing.assert_allclose(steps[:, 2], 0.01 * rng.normal(size=len(steps)), atol=1e-12)


def test_no_noise_added_changes_nothing():
    log, _ = simulate.fifteen_objects(0)
    same = simulate.add_noise(log, 0.0, np.random.default_rng(0))
    np.testing.assert_array_equal(same.odometry, log.odometry)
    np.testing.assert_array_equal(same.obs_xy, log.obs_xy)


@pytest.mark.parametrize("noise", [-1.0, float("nan"), float("inf")])
def test_bad_noise_is_named(noise):
    log, _ = simulate.fifteen_objects(0)
    with pytest.raises(ValueError, match="noise: expected a non-negative number"):
        simulate.add_noise(log, noise, np.random.default_rng(0))
    with pytest.raises(ValueError, match="noise: expected a non-negative number"):
        simulate.paper_sensor(noise)


def test_a_world_without_room_is_refused():
    with pytest.raises(ValueError, match="size: expected room for 50 separate objects"):
        simulate.scattered_world(50, ("chair",), np.random.default_rng(0), size=2.0)


def test_a_sensor_that_never_errs_cannot_make_a_log(world):
    """A standard deviation of zero has no information matrix."""
    with pytest.raises(ValueError, match="odometry_std: expected positive"):
        run(world, EXACT)


def test_a_confusion_matrix_of_the_wrong_size_is_refused(world):
    with pytest.raises(ValueError, match="class_confusion: expected 5 rows, got 3"):
        run(world, replace(TINY, class_confusion=np.eye(3)))


def test_an_empty_path_is_refused(world):
    with pytest.raises(ValueError, match="path: expected at least one pose"):
        simulate.simulate_run(world, np.zeros((0, 3)), TINY, np.random.default_rng(0))


def test_world_types():
    with pytest.raises(ValueError, match="object_class: expected a class index"):
        World([[0.0, 0.0]], [2], ("chair", "cup"))


@pytest.mark.parametrize("num_rooms", [1, 4, 7])
def test_a_house_has_the_papers_density(num_rooms):
    log, truth = simulate.grid_of_rooms(num_rooms, seed=num_rooms)
    assert log.num_poses == 766 * num_rooms
    assert len(truth.world.object_xy) == 15 * num_rooms
    assert 900 * num_rooms < log.num_observations < 1400 * num_rooms
    steps = np.linalg.norm(np.diff(truth.poses[:, :2], axis=0), axis=1)
    assert 0.05 < steps.min() and steps.max() < 0.15
    assert np.isin(np.arange(15 * num_rooms), truth.obs_object).mean() > 0.95


@pytest.mark.parametrize("num_rooms", [0, -1, 1.5])
def test_a_house_without_rooms_is_refused(num_rooms):
    with pytest.raises(ValueError, match="num_rooms: expected a positive integer"):
        simulate.grid_of_rooms(num_rooms)


def test_sightings_are_the_same_when_a_path_is_taken_in_stretches(monkeypatch):
    from npslam_teach.simulate import robot_run

    whole, _ = simulate.fifteen_objects(5)
    monkeypatch.setattr(robot_run, "STRETCH", 50)
    parts, _ = simulate.fifteen_objects(5)
    np.testing.assert_array_equal(parts.obs_xy, whole.obs_xy)
    np.testing.assert_array_equal(parts.obs_time, whole.obs_time)
