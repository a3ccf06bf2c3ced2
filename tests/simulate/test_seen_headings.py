"""The simulator's headings: as good as the sensor says, as alike as the class is, and nothing else is drawn anew."""

from dataclasses import replace

import numpy as np
import pytest

from npslam_teach import se2, simulate
from npslam_teach.types import SensorModel, World

PATH = np.column_stack([np.linspace(0, 1, 400), np.zeros(400), np.linspace(0, 0.5, 400)])
WORLD = World([[3.0, 0.5], [2.0, 1.0], [3.0, 1.5]], [0, 1, 2], ("chair", "table", "cup"), [0.5, -3.0, 1.0])
SENSOR = SensorModel((0.01, 0.01, 0.01), (0.1, 0.1), 5.0, 3.0, clutter_rate=0.1)
SEES = replace(SENSOR, observation_theta_std=0.2, class_symmetry=[1, 2, 0])


def drive(sensor, seed=0, world=WORLD):
    return simulate.simulate_run(world, PATH, sensor, np.random.default_rng(seed))


def test_headings_err_as_the_sensor_says():
    log, truth = drive(SEES)
    off = log.obs_theta + truth.poses[log.obs_time, 2] - np.append(WORLD.object_theta, 0.0)[truth.obs_object]
    for obj, symmetry in ((0, 1), (1, 2)):
        own = truth.obs_object == obj
        wrapped = se2.wrap_symmetric(off[own], symmetry)
        assert wrapped.std() == pytest.approx(0.2, rel=0.15)
        assert abs(wrapped.mean()) < 4 * 0.2 / np.sqrt(own.sum())
    # Of the table either front is reported as often, of the round cup anything.
    table = se2.wrap(off[truth.obs_object == 1])
    assert np.mean(np.abs(table) > np.pi / 2) == pytest.approx(0.5, abs=0.12)
    for anything in (truth.obs_object == 2, truth.obs_object == -1):
        assert abs(np.exp(1j * off[anything]).mean()) < 4 / np.sqrt(anything.sum())


def test_nothing_else_is_drawn_anew():
    with_them, without = drive(SEES, 3)[0], drive(SENSOR, 3)[0]
    assert without.obs_theta is None
    for name in ("odometry", "obs_time", "obs_xy", "obs_class"):
        np.testing.assert_array_equal(getattr(with_them, name), getattr(without, name))


def test_a_world_must_say_which_way_things_face():
    with pytest.raises(ValueError, match="world.object_theta: expected headings"):
        drive(SEES, world=replace(WORLD, object_theta=None))
    with pytest.raises(ValueError, match="observation_theta_std: expected positive"):
        replace(SEES, observation_theta_std=0.0)
