"""``reproduce``: the paper's simulation from the command line."""

import json

import numpy as np
import pytest
from commands import ONLY_SOLVE, SOLVE_FIELDS, call

from npslam_teach import simulate
from npslam_teach.methods import METHODS


def test_reproduce_prints_one_json_object(capsys):
    code, out, err = call(capsys, "reproduce", "--seeds", "2", "--methods", "open-loop,np-graph", "--json")
    assert (code, err) == (0, "")
    result = json.loads(out)
    assert [(row["seed"], row["method"]) for row in result["runs"]] == [
        (0, "open-loop"),
        (0, "np-graph"),
        (1, "open-loop"),
        (1, "np-graph"),
    ]
    assert set(result["runs"][0]) == SOLVE_FIELDS - ONLY_SOLVE | {"seed", "noise"}
    assert set(result["summary"]) == {"open-loop", "np-graph"}
    counts = [row["counts_per_iteration"][-1] for row in result["runs"] if row["method"] == "np-graph"]
    assert result["summary"]["np-graph"]["num_exact"] == counts.count(15)
    errors = [row["metrics"]["mean_pose_error"] for row in result["runs"] if row["method"] == "np-graph"]
    assert result["summary"]["np-graph"]["median_mean_pose_error"] == pytest.approx(np.median(errors))


def test_reproduce_for_people_shows_the_papers_story(capsys):
    code, out, _ = call(capsys, "reproduce")
    assert code == 0
    log, _ = simulate.fifteen_objects()
    assert f"{log.num_observations} observations, 15 objects of 5 classes" in out
    for column in ("iteration", "objects", "chi2", "objective", "mean pose error (m)", "cumulative (m)"):
        assert column in out
    for method in METHODS:
        assert f"\n{method}" in out


def test_reproduce_runs_on_a_log_with_truth(capsys, log_file):
    code, out, _ = call(capsys, "reproduce", "--data", log_file, "--noise", "0", "--json")
    assert code == 0
    assert json.loads(out)["scene"]["name"] == "run.npz"


def test_reproduce_is_the_same_for_a_seed_whatever_came_before(capsys, log_file):
    many = json.loads(call(capsys, "reproduce", "--data", log_file, "--seeds", "3", "--json")[1])["runs"]
    one = json.loads(call(capsys, "reproduce", "--data", log_file, "--first-seed", "2", "--json")[1])["runs"]
    for a, b in zip(many[-len(one) :], one, strict=True):
        assert {k: v for k, v in a.items() if k != "seconds"} == {k: v for k, v in b.items() if k != "seconds"}
