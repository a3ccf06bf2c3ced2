"""Results for other programs: evo must find the error that we find."""

import csv
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from npslam_teach import datasets, evaluation, simulate
from npslam_teach.methods import METHODS


@pytest.fixture(scope="module")
def solved():
    log, truth = simulate.fifteen_objects(2)
    *_, last = METHODS["np-graph"](log)
    return log, truth, last


def evo_ape(folder, *files):
    """The root of the mean squared error that ``evo_ape tum --align`` prints."""
    program = shutil.which("evo_ape", path=str(Path(sys.executable).parent))
    if program is None:
        pytest.skip("evo is not installed: pip install -r tests/requirements.txt")
    home = os.environ | {"HOME": str(folder), "USERPROFILE": str(folder), "MPLBACKEND": "agg"}
    command = [program, "tum", *map(str, files), "--align"]
    done = subprocess.run(command, env=home, capture_output=True, text=True, cwd=folder)
    assert done.returncode == 0, done.stderr
    return float(re.search(r"rmse\s+(\S+)", done.stdout).group(1))


@pytest.mark.slow
def test_evo_finds_the_same_error(tmp_path, solved):
    log, truth, last = solved
    datasets.save_tum(tmp_path / "path.tum", last.graph.poses)
    datasets.save_tum(tmp_path / "truth.tum", truth.poses)
    ours = evaluation.evaluate(last, truth, log).rmse_pose_error
    assert evo_ape(tmp_path, tmp_path / "truth.tum", tmp_path / "path.tum") == pytest.approx(ours, abs=1e-6)


def test_a_path_comes_back_from_its_quaternions(tmp_path):
    poses = np.random.default_rng(0).uniform(-3, 3, (50, 3))
    datasets.save_tum(tmp_path / "path.tum", poses)
    rows = np.loadtxt(tmp_path / "path.tum")
    np.testing.assert_array_equal(rows[:, 0], np.arange(50))
    np.testing.assert_array_equal(rows[:, 1:3], poses[:, :2])
    assert not rows[:, 3:6].any()
    np.testing.assert_allclose(2 * np.arctan2(rows[:, 6], rows[:, 7]), poses[:, 2], atol=1e-15)


def test_unknown_poses_are_left_out(tmp_path):
    poses = np.zeros((4, 3))
    poses[1], poses[2, 2] = np.nan, np.nan
    datasets.save_tum(tmp_path / "path.tum", poses)
    rows = np.loadtxt(tmp_path / "path.tum")
    assert rows[:, 0].tolist() == [0, 2, 3] and rows[:, 7].tolist() == [1, 1, 1]


def test_the_table_of_objects(tmp_path, solved):
    log, _, last = solved
    datasets.save_objects(tmp_path / "objects.csv", last, log)
    with open(tmp_path / "objects.csv", encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [json.loads(row["x"]) for row in rows] == last.graph.landmarks[:, 0].tolist()
    assert [int(row["class"]) for row in rows] == last.votes[:, 1:].argmax(axis=1).tolist()
    assert [int(row["num_observations"]) for row in rows] == np.bincount(last.labels).tolist()
