"""Trials of the posterior method: what is counted, and whose fault a failure is."""

import sys
from dataclasses import replace

import numpy as np
import pytest

from npslam_teach import simulate
from npslam_teach.experiments import Scene, posterior_trials
from npslam_teach.experiments.posterior_trials import summary, told_the_map, trial
from npslam_teach.methods.snapshots import snapshot
from npslam_teach.pose_graph import fit
from npslam_teach.types import GroundTruth, World


@pytest.mark.slow
def test_a_trial_that_is_right_scores_as_the_truth_does():
    row = trial(Scene("room", 3, 2.0, *simulate.fifteen_objects(3, 2.0)))
    assert row["right"] and row["verdict"] == "right" and row["objects"] == 15 and row["seconds"] > 0
    assert row["found"] == pytest.approx(row["truth"], abs=60)  # a few observations are left out, or elsewhere


def test_whose_fault_it_is(monkeypatch):
    """Of two chairs in one place nobody can tell; a method that puts two chairs 3 m apart into one has not looked."""
    rng = np.random.default_rng(0)
    for apart, verdict in ((0.0, "data"), (3.0, "search")):
        log, _ = simulate.toy_objects()
        places = np.where(np.arange(8)[:, None] < 4, [2.0, -apart / 2], [2.0, apart / 2])
        log = of_two_chairs(log, places + rng.normal(0, 0.02, (8, 2)))
        truth = two_chairs(np.repeat([0, 1], 4), apart)
        one = taken_for_one(log)
        monkeypatch.setitem(posterior_trials.METHODS, "posterior", lambda _, one=one: iter([one]))
        row = trial(Scene("room", 0, 1.0, log, truth))
        assert row["verdict"] == verdict and not row["right"], (apart, row)


def of_two_chairs(log, xy):
    fields = {"obs_time": np.arange(8), "obs_xy": xy, "obs_class": np.zeros(8, int)}
    return replace(log, odometry=np.zeros((7, 3)), num_classes=1, class_names=None, **fields)


def two_chairs(obs_object, apart):
    world = World(np.array([[2.0, -apart / 2], [2.0, apart / 2]]), np.zeros(2, int), ("chair",))
    return GroundTruth(world, np.zeros((8, 3)), obs_object)


def taken_for_one(log):
    labels = np.zeros(8, int)
    return snapshot(log, 1, labels, fit(log, labels))


def test_the_summary_counts():
    rows = [
        {"noise": 2.0, "right": True, "verdict": "right", "told": 1.0, "seconds": 1.0},
        {"noise": 2.0, "right": False, "verdict": "data", "told": 0.98, "seconds": 2.0},
    ]
    assert summary(rows).startswith("noise 2: right 1 of 2 (95%: 0.095 to 0.905)")
    assert "search 0, data 1; told the map: 1; median 1.50 s" in summary(rows)


@pytest.mark.slow
def test_the_command_prints_a_line_for_each_noise(monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["trials", "--noise", "1", "--seeds", "1"])
    posterior_trials.main()
    assert capsys.readouterr().out.startswith("noise 1: right ")


def test_told_the_map_asks_for_what_the_map_can_say():
    """Chairs 3 m apart are told apart by any map; of two in one place none says which was seen."""
    rng = np.random.default_rng(0)
    for apart, attainable in ((3.0, True), (0.0, False)):
        log, _ = simulate.toy_objects()
        places = np.where(np.arange(8)[:, None] < 4, [2.0, -apart / 2], [2.0, apart / 2])
        log = of_two_chairs(log, places + rng.normal(0, 0.02, (8, 2)))
        log = replace(log, odometry_std=np.full(3, 1e-6))  # or every pose would lean towards the answer
        told = told_the_map(Scene("room", 0, 1.0, log, two_chairs(np.repeat([1, 0], 4), apart)))
        assert (told == 1.0) == attainable, (apart, told)
