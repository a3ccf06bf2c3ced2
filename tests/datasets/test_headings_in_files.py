"""Headings come back from both kinds of file, and what is wrong with them is named."""

from dataclasses import replace

import numpy as np
import pytest

from npslam_teach import datasets
from npslam_teach.experiments.back_to_back import hall
from npslam_teach.methods import without_headings

FIELDS = ("obs_theta", "observation_theta_std", "class_symmetry")


@pytest.fixture
def run():
    log, truth = hall(0, 10.0, symmetry=2)
    rows = log.obs_time < 12
    cut = {name: getattr(log, name)[rows] for name in ("obs_time", "obs_xy", "obs_class", "obs_theta")}
    log = replace(log, odometry=log.odometry[:11], **cut)
    return log, replace(truth, poses=truth.poses[:12], obs_object=truth.obs_object[rows])


@pytest.mark.parametrize("suffix", [".npz", ".csv"])
def test_headings_come_back_exactly(tmp_path, suffix, run):
    log, truth = run
    datasets.save_log(tmp_path / f"log{suffix}", log, truth)
    again, its_truth = datasets.load_log(tmp_path / f"log{suffix}")
    for name in FIELDS:
        np.testing.assert_array_equal(getattr(again, name), getattr(log, name))
    np.testing.assert_array_equal(its_truth.world.object_theta, truth.world.object_theta)
    np.testing.assert_array_equal(again.obs_xy, log.obs_xy)


@pytest.mark.parametrize("suffix", [".npz", ".csv"])
def test_a_log_without_headings_stays_without(tmp_path, suffix, run):
    log = replace(without_headings(run[0]), class_symmetry=None)
    datasets.save_log(tmp_path / f"log{suffix}", log)
    again, truth = datasets.load_log(tmp_path / f"log{suffix}")
    assert truth is None
    assert all(getattr(again, name) is None for name in FIELDS)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("observation_std,,0.1,0.1,0.2,,,", "observation_std,,0.1,0.1,,,,", "line 3: theta: expected a number"),
        ("observation,1,1.9,-0.4,0.3,chair,,", "observation,1,1.9,-0.4,,chair,,", "line 7: theta: expected a number"),
        ("class,,,,,chair,,2", "class,,,,,chair,,1.5", "line 4: symmetry: expected a whole number from 0 to 1000"),
    ],
)
def test_what_is_wrong_is_named(tmp_path, old, new, words):
    text = """kind,time,x,y,theta,class,object,symmetry
odometry_std,,0.02,0.02,0.01,,,
observation_std,,0.1,0.1,0.2,,,
class,,,,,chair,,2
odometry,0,0.25,0.0,0.02,,,
observation,0,2.1,-0.4,0.3,chair,,
observation,1,1.9,-0.4,0.3,chair,,
"""
    path = tmp_path / "log.csv"
    path.write_text(text)
    log, _ = datasets.load_log(path)
    assert (log.observation_theta_std, log.class_symmetry.tolist()) == (0.2, [2])
    assert old in text
    path.write_text(text.replace(old, new))
    with pytest.raises(ValueError, match=words):
        datasets.load_log(path)


def test_degrees_are_doubted(tmp_path, run):
    log = replace(run[0], obs_theta=np.rad2deg(run[0].obs_theta))
    datasets.save_log(tmp_path / "log.npz", log)
    with pytest.warns(UserWarning, match="obs_theta goes up to .*are these degrees"):
        datasets.load_log(tmp_path / "log.npz")
