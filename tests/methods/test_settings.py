"""Settings in the units of a log: what the paper's own sensors get, and what other sensors and units get."""

from dataclasses import replace

import numpy as np
import pytest

from npslam_teach import simulate
from npslam_teach.methods import paper_settings, settings_for
from npslam_teach.methods.settings import PAPER_OBSERVATION_NOISE, PAPER_ODOMETRY_NOISE


@pytest.fixture(scope="module")
def log():
    return simulate.fifteen_objects(0)[0]


def test_the_paper_s_noise_is_that_of_the_simulated_sensors():
    sensor = simulate.paper_sensor(1.0)
    np.testing.assert_allclose(PAPER_ODOMETRY_NOISE, sensor.odometry_std, rtol=1e-15)
    np.testing.assert_allclose(PAPER_OBSERVATION_NOISE, sensor.observation_std, rtol=1e-15)


def test_the_paper_s_sensors_get_the_paper_s_constants(log):
    paper = replace(log, odometry_std=PAPER_ODOMETRY_NOISE, observation_std=PAPER_OBSERVATION_NOISE)
    expected = paper_settings() | {"exclusive": True}
    assert settings_for(paper).keys() == expected.keys()
    for name, value in settings_for(paper).items():
        np.testing.assert_allclose(value, expected[name], rtol=1e-14, err_msg=name)


@pytest.mark.parametrize("scale", [1e-3, 0.1, 7.0, 1e4])
def test_lengths_scale_with_the_unit_of_length_and_angles_do_not(log, scale):
    scaled = replace(
        log,
        odometry=log.odometry * [scale, scale, 1],
        obs_xy=log.obs_xy * scale,
        odometry_std=log.odometry_std * np.array([scale, scale, 1]),
        observation_std=log.observation_std * scale,
    )
    here, there = settings_for(log), settings_for(scaled)
    np.testing.assert_allclose(there["kernel_std"], scale * here["kernel_std"])
    np.testing.assert_allclose(there["odometry_std"], here["odometry_std"] * np.array([scale, scale, 1]))
    np.testing.assert_allclose(there["observation_std"], scale * np.array(here["observation_std"]))


def test_a_coarser_camera_widens_the_kernel_and_leaves_the_odometry_alone(log):
    coarse = replace(log, observation_std=np.array(log.observation_std) * [4, 1])
    assert settings_for(coarse)["kernel_std"] == pytest.approx(2 * settings_for(log)["kernel_std"])
    assert settings_for(coarse)["odometry_std"] == settings_for(log)["odometry_std"]
