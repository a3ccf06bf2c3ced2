"""Degrees, and rows of odometry too many or too few, get a hint; right logs, of every scene that we have, get none."""

from dataclasses import replace

import numpy as np
import pytest

from npslam_teach import se2, simulate
from npslam_teach.datasets.log_doubts import doubts_about
from npslam_teach.datasets.log_fields import fields_of, run_from
from npslam_teach.types import RobotLog

DEGREES, TOO_MANY, TOO_FEW = "are these degrees?", "is it one row too many?", "is it one row too few?"


def winding_log(seed: int, largest_turn: float = 1.0, num_poses: int = 60, noise: float = 0.02) -> RobotLog:
    """A robot that turns left and right by up to so many radians in a step, and sees all of nine things each time."""
    rng = np.random.default_rng(seed)
    steps = np.column_stack([np.full(num_poses - 1, 0.4), np.zeros(num_poses - 1), rng.uniform(-1, 1, num_poses - 1)])
    steps[:, 2] *= largest_turn
    things, poses = rng.uniform(-8, 8, (9, 2)), se2.dead_reckoning(steps)
    seen = np.concatenate([se2.apply_inverse(pose, things) for pose in poses]) + rng.normal(
        0, noise, (9 * num_poses, 2)
    )
    times, classes = np.repeat(np.arange(num_poses), 9), np.tile(np.arange(9) % 3, num_poses)
    return RobotLog(steps, times, seen, classes, 3, np.full(3, 0.02), np.full(2, noise))


def with_odometry(log: RobotLog, odometry: np.ndarray) -> RobotLog:
    return replace(log, odometry=odometry)


def with_degrees(log: RobotLog) -> RobotLog:
    return with_odometry(log, log.odometry * [1, 1, 180 / np.pi])


@pytest.mark.parametrize("largest_turn", [0.0, 0.04, 0.3, 1.0, 3.0])
@pytest.mark.parametrize("seed", range(3))
def test_a_right_log_gets_no_hint(seed, largest_turn):
    assert doubts_about(winding_log(seed, largest_turn)) == []


def scenes():
    yield simulate.toy_objects()[0]
    for seed in range(3):
        yield from (simulate.fifteen_objects(seed=seed, noise=noise)[0] for noise in (0.5, 1.0, 4.0))
        yield simulate.office(seed=seed)[0]


@pytest.mark.slow
def test_no_scene_gets_a_hint_and_each_does_in_degrees():
    logs = list(scenes())
    assert [doubts_about(log) for log in logs] == [[]] * len(logs)
    assert all(DEGREES in doubts_about(with_degrees(log))[0] for log in logs)


@pytest.mark.parametrize("name", simulate.GALLERY)
def test_no_drawn_world_gets_a_hint(name):
    assert doubts_about(simulate.drawn_run(simulate.GALLERY[name].drawing)[0]) == []


@pytest.mark.parametrize("largest_turn", [0.02, 0.04, 0.05])  # up to 2.9 degrees, less than pi
@pytest.mark.parametrize("seed", range(3))
def test_small_turns_in_degrees_get_a_hint_by_what_is_seen(seed, largest_turn):
    log = with_degrees(winding_log(seed, largest_turn))
    assert np.abs(log.odometry[:, 2]).max() < np.pi
    (doubt,) = doubts_about(log)
    assert "observations fit together better" in doubt and DEGREES in doubt


def test_a_turn_that_was_not_wrapped_gets_no_hint():
    log = winding_log(0, 0.1, noise=0.4)
    odometry = log.odometry.copy()
    odometry[30, 2] -= np.copysign(2 * np.pi, odometry[30, 2])
    assert doubts_about(with_odometry(log, odometry)) == []


def test_a_robot_that_leaves_gets_no_hint():
    log = winding_log(1, 0.1)
    assert doubts_about(with_odometry(log, np.vstack([log.odometry, log.odometry[:10]]))) == []


def test_a_standard_deviation_in_degrees_gets_a_hint():
    log = winding_log(0, 0.1)
    (doubt,) = doubts_about(replace(log, odometry_std=np.array([0.02, 0.02, np.degrees(0.02)])))
    assert "odometry_std" in doubt and DEGREES in doubt


@pytest.mark.parametrize("rows", [1, 3])
@pytest.mark.parametrize("zero", [True, False])
def test_rows_appended_get_a_hint(rows, zero):
    log = winding_log(1, 0.1)
    more = np.zeros((rows, 3)) if zero else log.odometry[:rows] + 0.01
    (doubt,) = doubts_about(with_odometry(log, np.vstack([log.odometry, more])))
    assert TOO_MANY in doubt


@pytest.mark.parametrize("row", [[0.0, 0.0, 0.0], [0.3, 0.1, -0.8]])
def test_a_row_in_front_gets_a_hint(row):
    (doubt,) = doubts_about(with_odometry(log := winding_log(2), np.vstack([[row], log.odometry])))
    assert TOO_MANY in doubt


def test_a_row_in_front_gets_a_hint_where_the_last_poses_see_something():
    log = winding_log(3)
    (doubt,) = doubts_about(with_odometry(log, np.vstack([[[0.3, 0.1, -0.8]], log.odometry[:-1]])))
    assert "without the first step" in doubt and TOO_MANY in doubt


def test_a_first_row_that_is_missing_gets_a_hint():
    log = winding_log(4)
    (doubt,) = doubts_about(with_odometry(log, np.vstack([log.odometry[1:], [[0.4, 0.0, 0.2]]])))
    assert TOO_FEW in doubt


@pytest.mark.parametrize(("first", "also"), [(0, "row too few?"), (1, "or are poses counted from 1?")])
def test_rows_too_few_are_named(first, also):
    log = winding_log(5)
    kept = log.obs_time >= first
    fields = fields_of(log, None) | {"odometry": log.odometry[:-2]}
    fields |= {name: getattr(log, name)[kept] for name in ("obs_time", "obs_xy", "obs_class")}
    with pytest.raises(
        ValueError, match="from 0 to 57, got 58 at entry .*: 57 steps of odometry lead no further"
    ) as error:
        run_from(fields)
    assert str(error.value).endswith(also)
