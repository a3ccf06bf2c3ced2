"""The checks that the dataclasses make when they are built."""

import dataclasses

import numpy as np
import pytest

from npslam_teach import types

EYE2, EYE3 = np.eye(2), np.eye(3)
SADDLE2, SADDLE3 = np.diag([1.0, -1.0]), np.diag([1.0, 1.0, -1.0])


def world(**changes):
    return types.World(**{"object_xy": [[0, 1], [2, 3]], "object_class": [0, 1], "class_names": ["a", "b"]} | changes)


def sensor(**changes):
    fields = {"odometry_std": [0.1] * 3, "observation_std": [0.1] * 2, "max_range": 4.0, "field_of_view": 2.0}
    return types.SensorModel(**fields | changes)


def robot_log(**changes):
    fields = {
        "odometry": [[1, 0, 0], [1, 0, 0.5]],
        "obs_time": [0, 2, 2],
        "obs_xy": [[1, 0], [2, 0], [3, 0]],
        "obs_class": [0, 1, 1],
        "num_classes": 2,
        "odometry_std": [0.1, 0.1, 0.1],
        "observation_std": [0.2, 0.2],
    }
    return types.RobotLog(**fields | changes)


def ground_truth(**changes):
    return types.GroundTruth(**{"world": world(), "poses": np.zeros((3, 3)), "obs_object": [0, 1, -1]} | changes)


def between(**changes):
    fields = {"i": [0, 1], "j": [1, 2], "relative_pose": np.zeros((2, 3)), "information": [EYE3, EYE3]}
    return types.BetweenFactors(**fields | changes)


def seen(**changes):
    fields = {"pose": [0, 2], "landmark": [0, 1], "xy": np.zeros((2, 2)), "information": [EYE2, EYE2]}
    return types.ObservationFactors(**fields | changes)


def graph(**changes):
    fields = {
        "poses": np.zeros((3, 3)),
        "landmarks": np.zeros((2, 2)),
        "between": between(),
        "observations": seen(),
    }
    return types.PoseGraph(**fields | changes)


def snapshot(**changes):
    fields = {"iteration": 0, "labels": [0, 1, -1], "votes": np.ones((2, 3)), "graph": graph()}
    return types.Snapshot(**fields | {"chi2": 1.0, "objective": 2.0} | changes)


BUILDERS = [world, sensor, robot_log, ground_truth, between, seen, graph, snapshot]


@pytest.mark.parametrize("build", BUILDERS, ids=lambda build: build.__name__)
def test_good_values_pass_and_cannot_be_changed(build):
    instance = build()
    for field in dataclasses.fields(instance):
        value = getattr(instance, field.name)
        with pytest.raises(dataclasses.FrozenInstanceError):
            setattr(instance, field.name, value)
        if isinstance(value, np.ndarray):
            with pytest.raises(ValueError, match="read-only"):
                value[...] = 0


def test_arrays_are_copied_so_that_the_caller_may_reuse_them():
    odometry = np.ones((2, 3))
    log = robot_log(odometry=odometry)
    odometry[:] = 7
    assert (log.odometry == 1).all()


def test_numbers_become_float64_and_indices_int64():
    log = robot_log(odometry=np.ones((2, 3), np.float32), obs_time=np.array([0, 2, 2], np.uint8))
    assert log.odometry.dtype == np.float64
    assert log.obs_time.dtype == np.int64


def test_counts_follow_from_the_arrays():
    assert robot_log().num_poses == 3
    assert robot_log().num_observations == 3
    assert snapshot().num_objects == 2


def test_a_log_may_have_one_pose_and_no_observations():
    empty = robot_log(odometry=np.zeros((0, 3)), obs_time=[], obs_xy=np.zeros((0, 2)), obs_class=[])
    assert (empty.num_poses, empty.num_observations) == (1, 0)


def test_information_may_be_singular():
    # A factor that says nothing about one direction is fine; only a negative direction is not.
    assert (between(information=np.zeros((2, 3, 3))).information == 0).all()


WRONG = [
    (world, "object_xy", [[0, 1, 2], [0, 1, 2]], "shape (any, 2), got (2, 3)"),
    (world, "object_xy", [[0, 1], [np.inf, 0]], "finite numbers, got 1 NaN"),
    (world, "object_xy", [["a", "b"], ["c", "d"]], "real numbers, got dtype <U1"),
    (world, "object_xy", [[0, 1], [2]], "regular array"),
    (world, "object_class", [0], "shape (2), got (1,)"),
    (world, "object_class", [0, 2], "a class index from 0 to 1, got 2 at entry 1"),
    (world, "object_class", [0, -1], "got -1 at entry 1"),
    (world, "object_class", [0.0, 1.0], "integers, got dtype float64"),
    (world, "class_names", ["a"], "object_class: expected a class index from 0 to 0"),
    (sensor, "odometry_std", [0.1, 0.1], "shape (3), got (2,)"),
    (sensor, "observation_std", [0.1, -0.1], "non-negative numbers, got [0.1, -0.1]"),
    (sensor, "max_range", -1.0, "non-negative number, got -1.0"),
    (sensor, "field_of_view", np.inf, "non-negative number, got inf"),
    (sensor, "clutter_rate", np.nan, "non-negative number, got nan"),
    (sensor, "detection_probability", 1.5, "number in [0, 1], got 1.5"),
    (sensor, "class_confusion", [[0.5, 0.4], [0, 1]], "sum to one"),
    (sensor, "class_confusion", [[1.5, -0.5], [0, 1]], "sum to one"),
    (sensor, "class_confusion", [[1.0, 0.0]], "shape (1, 1), got (1, 2)"),
    (robot_log, "odometry", np.zeros((2, 2)), "shape (any, 3), got (2, 2)"),
    (robot_log, "odometry", [[0, 0, np.inf]] * 2, "finite numbers, got 2 NaN or infinite"),
    (robot_log, "odometry", np.zeros((2, 3), complex), "real numbers, got dtype complex128"),
    (robot_log, "odometry", np.zeros((0, 3)), "obs_time: expected the index of a pose from 0 to 0, got 2"),
    (robot_log, "obs_time", [0, 1, 3], "the index of a pose from 0 to 2, got 3 at entry 2"),
    (robot_log, "obs_time", [0, -1, 2], "got -1 at entry 1"),
    (robot_log, "obs_time", [0.0, 1.0, 2.0], "integers, got dtype float64"),
    (robot_log, "obs_xy", [[1, 0]], "shape (3, 2), got (1, 2)"),
    (robot_log, "obs_class", [0, 1, 2], "a class index from 0 to 1, got 2 at entry 2"),
    (robot_log, "obs_class", [True, False, True], "integers, got dtype bool"),
    (robot_log, "num_classes", 0, "a positive integer, got 0"),
    (robot_log, "num_classes", 2.5, "a positive integer, got 2.5"),
    (robot_log, "odometry_std", [0.1, 0.0, 0.1], "positive numbers, got [0.1, 0.0, 0.1]"),
    (robot_log, "observation_std", [0.1, -1], "positive numbers, got [0.1, -1.0]"),
    (ground_truth, "poses", np.zeros(3), "shape (any, 3), got (3,)"),
    (ground_truth, "obs_object", [0, 2, 0], "(-1 = clutter, -2 = unknown) from -2 to 1, got 2 at entry 1"),
    (ground_truth, "obs_object", [0, -3, 0], "got -3 at entry 1"),
    (ground_truth, "poses", np.full((3, 3), np.inf), "finite numbers, got 9 NaN or infinite"),
    (robot_log, "class_names", ("one",), "class_names: expected 2 names, got 1"),
    (between, "i", [0], "j: expected shape (1), got (2,)"),
    (between, "j", [1, 1], "a pose other than i, got i = j = 1"),
    (between, "relative_pose", np.zeros((2, 2)), "shape (2, 3), got (2, 2)"),
    (between, "information", [EYE2, EYE2], "shape (2, 3, 3), got (2, 2, 2)"),
    (between, "information", [EYE3, SADDLE3], "positive semidefinite matrices, entry 1 is not"),
    (
        between,
        "information",
        [EYE3 + np.eye(3, k=1), EYE3],
        "symmetric positive semidefinite matrices",
    ),
    (seen, "landmark", [0], "shape (2), got (1,)"),
    (seen, "xy", [[0, np.nan], [0, 0]], "finite numbers, got 1 NaN"),
    (seen, "information", [SADDLE2, EYE2], "positive semidefinite matrices, entry 0 is not"),
    (graph, "poses", np.zeros((0, 3)), "at least one pose"),
    (
        graph,
        "poses",
        np.zeros((2, 3)),
        "between.j: expected the index of a pose from 0 to 1, got 2 at entry 1",
    ),
    (
        graph,
        "landmarks",
        np.zeros((1, 2)),
        "observations.landmark: expected the index of a landmark from 0 to 0",
    ),
    (snapshot, "labels", [0, 2], "an object index (-1 = none) from -1 to 1, got 2 at entry 1"),
    (snapshot, "votes", np.ones((1, 3)), "shape (2, any), got (1, 3)"),
]


@pytest.mark.parametrize(("build", "field", "value", "words"), WRONG, ids=lambda value: getattr(value, "__name__", ""))
def test_a_wrong_value_is_one_sentence_that_names_the_field(build, field, value, words):
    with pytest.raises(ValueError) as caught:
        build(**{field: value})
    message = str(caught.value)
    assert words in message
    assert "\n" not in message
    # A contradiction between two fields may be reported under the other's name; the words spell that out.
    assert message.startswith(f"{field}: expected") or message.startswith(words.split(":")[0])
