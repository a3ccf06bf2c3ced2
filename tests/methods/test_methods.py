"""The methods as a whole: what they share, what the paper says of each, and the descent of the objective."""

import functools
import inspect
import sys
from dataclasses import replace

import numpy as np
import pytest
from beginnings import first_poses

from npslam_teach import association, evaluation, pose_graph, se2, simulate
from npslam_teach.association import PAPER_KERNEL_STD
from npslam_teach.methods import METHODS, frame_by_frame, np_graph, open_loop, robust_slam
from npslam_teach.methods.open_loop import join_earlier_observations
from npslam_teach.types import RobotLog, World

CONSISTENT = {"observation_std": (PAPER_KERNEL_STD, PAPER_KERNEL_STD)}


@pytest.fixture(scope="module")
def scene():
    return simulate.fifteen_objects(seed=0)


@functools.cache
def beginning():
    """Three hundred of the seven hundred poses of ``scene``: there are methods that take seconds for the whole."""
    log, _ = simulate.fifteen_objects(seed=0)
    return first_poses(log, 300)


@functools.cache
def answer(name):
    """Every snapshot of a method on ``beginning``, which several tests look at."""
    return list(METHODS[name](beginning()))


def same_groups(labels):
    return labels[:, None] == labels[None, :]


@pytest.mark.parametrize("name", METHODS)
def test_every_method_keeps_its_books(name):
    log = beginning()
    snapshots = answer(name)
    assert [s.iteration for s in snapshots] == list(range(len(snapshots)))
    for s in snapshots:
        assert s.labels.shape == (log.num_observations,)
        used = s.labels[s.labels >= 0]
        assert len(np.unique(used)) == s.num_objects == len(s.graph.landmarks)
        np.testing.assert_array_equal(
            s.votes, association.count_votes(s.labels, log.obs_class, s.num_objects, log.num_classes)
        )
        assert ((s.votes[:, 1:] > 0).sum(axis=1) == 1).all()  # an object has one class
        assert s.chi2 == pytest.approx(pose_graph.chi2(s.graph))
        np.testing.assert_array_equal(s.graph.observations.landmark, used)


@pytest.mark.parametrize("name", METHODS)
def test_every_method_starts_frame_by_frame(name, scene):
    log, _ = scene
    first = next(METHODS[name](log))
    assert first.num_objects == log.num_observations
    np.testing.assert_array_equal(first.graph.poses, se2.dead_reckoning(log.odometry))
    assert first.chi2 == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize("name", METHODS)
def test_every_method_is_deterministic(name):
    log = beginning()
    *_, first = answer(name)
    *_, second = METHODS[name](log)
    assert first.graph.poses.tobytes() == second.graph.poses.tobytes()
    assert first.labels.tobytes() == second.labels.tobytes()


@pytest.mark.parametrize("name", METHODS)
def test_no_method_is_handed_the_truth(name):
    parameters = inspect.signature(METHODS[name].function).parameters
    assert next(iter(parameters)) == "log"
    assert not any("truth" in parameter or "true" in parameter for parameter in parameters)


@pytest.mark.parametrize("name", METHODS)
def test_a_log_without_observations(name):
    empty = RobotLog([[1.0, 0, 0], [1.0, 0, 0]], [], np.zeros((0, 2)), [], 2, (0.1,) * 3, (0.1,) * 2)
    *_, last = METHODS[name](empty)
    assert last.num_objects == 0
    np.testing.assert_allclose(last.graph.poses[-1], [2, 0, 0])


@pytest.mark.parametrize("name", METHODS)
def test_class_names_do_not_matter(name):
    log = beginning()
    renamed = replace(log, obs_class=np.array([3, 0, 4, 1, 2])[log.obs_class])
    *_, first = answer(name)
    *_, second = METHODS[name](renamed)
    np.testing.assert_array_equal(same_groups(first.labels), same_groups(second.labels))
    assert first.chi2 == pytest.approx(second.chi2)


@pytest.mark.parametrize("seed", range(6))
def test_the_objective_never_rises_under_consistent_settings(seed):
    """Solver and kernel believe the same standard deviation: each half-step lowers one and the same number."""
    log, _ = simulate.fifteen_objects(seed)
    values = [s.objective for s in np_graph(log, iterations=10, **CONSISTENT)]
    assert len(values) > 2
    assert all(after <= before + 1e-6 for before, after in zip(values, values[1:], strict=False))


@pytest.mark.parametrize("seed", range(20))
def test_the_objective_never_rises_on_small_dense_scenes(seed):
    """Where everything is near everything, many moves compete."""
    rng = np.random.default_rng(seed)
    world = World(rng.uniform(0, 2.5, (6, 2)), rng.integers(0, 2, 6), ("chair", "cup"))
    path = simulate.follow(1.2 + np.column_stack([np.cos(np.linspace(0, 9, 999)), np.sin(np.linspace(0, 9, 999))]), 0.2)
    log, _ = simulate.simulate_run(world, path, simulate.paper_sensor(2.0), rng)
    values = [s.objective for s in np_graph(log, iterations=10, **CONSISTENT)]
    assert all(after <= before + 1e-6 for before, after in zip(values, values[1:], strict=False))


def test_np_graph_stops_when_nothing_changes(scene):
    log, _ = simulate.fifteen_objects()
    snapshots = list(np_graph(log, iterations=50))
    assert len(snapshots) < 20
    np.testing.assert_array_equal(same_groups(snapshots[-1].labels), same_groups(snapshots[-2].labels))
    assert not np.array_equal(snapshots[-2].labels, snapshots[-3].labels)


def test_at_alpha_one_nothing_ever_merges(scene):
    log, _ = scene
    *_, last = np_graph(log, alpha=1.0)
    assert last.num_objects == log.num_observations
    *_, below = np_graph(log, alpha=0.99)
    assert below.num_objects < log.num_observations / 10


def test_a_threshold_above_every_probability_keeps_everything_apart(scene):
    log, _ = scene
    *_, last = np_graph(log, threshold=1.0)
    assert last.num_objects == log.num_observations


def test_false_positives_are_removed_at_the_end():
    """Clutter is seen once; objects with a single vote go when epsilon is below one half."""
    rng = np.random.default_rng(3)
    world = simulate.scattered_world(3, simulate.FIFTEEN_CLASSES, rng)
    sensor = replace(simulate.paper_sensor(0.0), clutter_rate=0.03)
    log, truth = simulate.simulate_run(world, simulate.designed_path(), sensor, rng)
    clutter = truth.obs_object < 0
    assert clutter.sum() > 10
    *_, kept = np_graph(log, iterations=10)
    *_, before, last = np_graph(log, iterations=10, false_positive_threshold=0.3)
    assert last.iteration == before.iteration + 1
    assert before.num_objects == kept.num_objects > last.num_objects
    assert (last.labels[clutter] == -1).mean() > 0.8
    assert (last.labels[~clutter] == -1).mean() < 0.02
    assert not association.false_positives(last.votes, 0.3).any()


def test_the_default_threshold_of_false_positives_removes_nothing(scene):
    log, _ = scene
    *_, last = np_graph(log)
    assert (last.labels >= 0).all()


def test_np_graph_improves_on_dead_reckoning():
    ratios = []
    for seed in range(7):
        log, truth = simulate.fifteen_objects(seed)
        first, *_, last = np_graph(log)
        before, after = (evaluation.distances_to_truth(s, truth)[0].mean() for s in (first, last))
        ratios.append(after / before)
    assert np.median(ratios) < 0.3


def test_open_loop_keeps_the_dead_reckoned_trajectory(scene):
    log, _ = scene
    *_, last = open_loop(log)
    np.testing.assert_array_equal(last.graph.poses, se2.dead_reckoning(log.odometry))


def test_open_loop_joins_the_nearest_earlier_observation_of_the_class():
    """0, 0.1, 0.2 chain together although the ends are 0.2 apart; the cup in between belongs to nobody."""
    xy = [[1.0, 0.0], [1.1, 0.0], [1.05, 0.0], [1.2, 0.0], [3.0, 0.0]]
    log = RobotLog(np.zeros((0, 3)), [0] * 5, xy, [0, 0, 1, 0, 0], 2, (1,) * 3, (1,) * 2)
    *_, last = open_loop(log)
    np.testing.assert_array_equal(last.labels, [0, 0, 1, 0, 2])
    np.testing.assert_allclose(last.graph.landmarks, [[1.1, 0], [1.05, 0], [3.0, 0]])


@pytest.mark.parametrize("pairs", [1, 50, 100_000])
def test_open_loop_compares_blocks_of_any_size_alike(pairs, monkeypatch):
    """With one observation after the other as the docstring says it."""
    monkeypatch.setitem(join_earlier_observations.__globals__, "PAIRS", pairs)
    rng, labels = np.random.default_rng(0), []
    xy, classes = rng.uniform(0, 2, (60, 2)), rng.integers(0, 2, 60)
    for k in range(60):
        weights = (classes[:k] == classes[k]) * np.exp(-4 * np.linalg.norm(xy[:k] - xy[k], axis=1) ** 2)
        joins = weights.max(initial=0.0) > 0.8
        labels.append(labels[np.argmax(weights)] if joins else max(labels, default=-1) + 1)
    assert 10 < max(labels) < 50
    assert join_earlier_observations(xy, classes, 0.8, 8**-0.5).tolist() == labels


def test_robust_slam_has_one_object_per_class_and_leaves_out_the_rest():
    xy = [[1.0, 0.0], [1.1, 0.0], [1.05, 0.0], [1.2, 0.0], [3.0, 0.0]]
    log = RobotLog(np.zeros((0, 3)), [0] * 5, xy, [0, 0, 2, 0, 0], 3, (1,) * 3, (1,) * 2)
    *_, last = robust_slam(log)
    np.testing.assert_array_equal(last.labels, [0, 0, 1, 0, -1])
    np.testing.assert_allclose(last.graph.landmarks, [[1.1, 0], [1.05, 0]])


def test_robust_slam_finds_as_many_objects_as_classes(scene):
    log, _ = scene
    *_, last = robust_slam(log)
    assert last.num_objects == log.num_classes
    assert 0 < (last.labels >= 0).sum() < log.num_observations


def test_frame_by_frame_is_one_snapshot(scene):
    log, _ = scene
    assert len(list(frame_by_frame(log))) == 1


@pytest.mark.parametrize(
    ("setting", "message"),
    [
        ({"alpha": -1.0}, "alpha: expected a positive number, got -1.0"),
        ({"alpha": float("nan")}, "alpha: expected a positive number, got nan"),
        ({"threshold": 2.0}, r"threshold: expected a probability in \[0, 1\], got 2.0"),
        ({"threshold": -0.1}, "threshold: expected"),
        ({"threshold": float("nan")}, "threshold: expected"),
        ({"iterations": -1}, "iterations: expected"),
        ({"kernel_std": 0.0}, "kernel_std: expected"),
        ({"kernel_std": float("inf")}, "kernel_std: expected"),
        ({"false_positive_threshold": 1.5}, "false_positive_threshold: expected"),
        ({"order": "sideways"}, "order: expected"),
        ({"observation_std": (0.0, 1.0)}, "observation_std: expected positive numbers"),
        ({"odometry_std": (0.1, 0.1)}, r"odometry_std: expected shape \(3\)"),
        ({"area": 0.0}, "area: expected"),
        ({"area": float("inf")}, "area: expected"),
        ({"iterations": 2.5}, "iterations: expected"),
        ({"kernel_std": 1e-200}, "kernel_std: expected"),
    ],
)
def test_bad_settings_are_named(setting, message, scene):
    with pytest.raises(ValueError, match=message):
        list(np_graph(scene[0], **setting))


@pytest.mark.parametrize("method", [open_loop, robust_slam])
def test_bad_thresholds_of_the_rivals_are_named(method, scene):
    with pytest.raises(ValueError, match="threshold: expected"):
        list(method(scene[0], threshold=2.0))


@pytest.mark.parametrize("name", METHODS)
def test_a_standard_deviation_beyond_floating_point_is_named(name, scene):
    if "odometry_std" in METHODS[name].settings:
        with pytest.raises(ValueError, match="odometry_std: expected at least 1e-07, got"):
            list(METHODS[name](scene[0], odometry_std=(0.1, 0.1, 1e-200)))


def test_the_method_finds_the_same_without_qdldl(monkeypatch):
    """Where qdldl has no wheel, SciPy solves: the same objects, the same map up to rounding."""
    from npslam_teach.pose_graph import factorization

    log, _ = simulate.fifteen_objects(0)
    *_, with_it = np_graph(log)
    monkeypatch.setattr(factorization, "has_qdldl", lambda: False)
    monkeypatch.setitem(sys.modules, "qdldl", None)  # importing it would fail
    *_, without_it = np_graph(log)
    np.testing.assert_array_equal(without_it.labels, with_it.labels)
    np.testing.assert_allclose(without_it.graph.poses, with_it.graph.poses, atol=1e-7)
    assert without_it.chi2 == pytest.approx(with_it.chi2, rel=1e-9)
