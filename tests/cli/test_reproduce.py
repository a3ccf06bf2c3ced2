"""``reproduce``: the paper's simulation from the command line."""

import json

import numpy as np
import pytest
from commands import ONLY_SOLVE, SOLVE_FIELDS, call

from npslam_teach import simulate
from npslam_teach.course.fifteen_objects import authors
from npslam_teach.experiments.paper_simulation import read_runs
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


@pytest.mark.slow
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


@pytest.mark.slow
def test_reproduce_is_the_same_for_a_seed_whatever_came_before(capsys, log_file):
    many = json.loads(call(capsys, "reproduce", "--data", log_file, "--seeds", "2", "--json")[1])["runs"]
    one = json.loads(call(capsys, "reproduce", "--data", log_file, "--first-seed", "1", "--json")[1])["runs"]
    for a, b in zip(many[-len(one) :], one, strict=True):
        assert {k: v for k, v in a.items() if k != "seconds"} == {k: v for k, v in b.items() if k != "seconds"}


def test_the_table_of_runs_says_what_the_json_says(capsys, tmp_path, log_file):
    table = tmp_path / "runs.csv"
    words = ("--data", log_file, "--seeds", "2", "--methods", "np-graph,frame-by-frame", "--table", str(table))
    result = json.loads(call(capsys, "reproduce", *words, "--json")[1])
    rows = read_runs(table)
    assert [(row["seed"], row["method"]) for row in rows] == [(row["seed"], row["method"]) for row in result["runs"]]
    for row, run in zip(rows, result["runs"], strict=True):
        assert row["rounds"] == run["counts_per_iteration"]
        assert row["objects"] == run["num_objects"]
        assert row["pose_error"] == pytest.approx(run["metrics"]["mean_pose_error"], abs=5e-5)


def test_the_committed_table_on_the_authors_data(capsys, tmp_path, mu2016_path):
    """Its first and its last seed, made again by the command that made it."""
    methods = ("np-graph", "robust-slam", "open-loop", "frame-by-frame")
    for seed in (0, 29):
        table = tmp_path / f"{seed}.csv"
        words = ("--data", str(mu2016_path), "--first-seed", str(seed), "--methods", ",".join(methods))
        assert call(capsys, "reproduce", *words, "--table", str(table))[0] == 0
        for new in read_runs(table):
            stored = authors.runs_of(new["method"])[seed]
            for name, value in new.items():
                close = pytest.approx(value, abs=2e-4, nan_ok=True) if isinstance(value, float) else value
                assert stored[name] == close, (seed, name)
    assert all(len(authors.runs_of(method)) == 30 for method in methods)


def test_the_median_rounds_of_the_authors_table_end_with_what_was_found():
    assert authors.median_rounds(0) == [1098]
    found = [run["objects"] for run in authors.runs_of("np-graph")]
    assert authors.median_rounds(20)[-1] == round(np.median(found))
    with pytest.raises(ValueError, match="ekf"):
        authors.runs_of("ekf")
