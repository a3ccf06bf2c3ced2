"""The commands as a user types them: what they print, and one sentence for everything that can be wrong."""

import json
import os
import re
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from npslam_teach import datasets, pose_graph, simulate
from npslam_teach.cli import checkout, commands, parser
from npslam_teach.methods import METHODS, paper_settings, settings_for

ROOT = Path(__file__).parents[2]


def run(*arguments, cwd=None):
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-c", "import sys; from npslam_teach.cli import main; sys.exit(main())"]
    return subprocess.run(
        [*command, *map(str, arguments)], capture_output=True, text=True, cwd=cwd, env=environment, timeout=120
    )


def call(capsys, *arguments):
    """The same in this process: exit code, standard output, standard error."""
    try:
        code = parser.main([str(argument) for argument in arguments])
    except SystemExit as stop:
        code = stop.code
    out, err = capsys.readouterr()
    return code, out, err


def small_log(seed=0):
    rng = np.random.default_rng(seed)
    world = simulate.scattered_world(2, ("chair", "cup"), rng, size=6.0)
    line = np.column_stack([3 + 2 * np.cos(np.linspace(0, 13, 500)), 3 + 2 * np.sin(np.linspace(0, 13, 500))])
    return simulate.simulate_run(world, simulate.follow(line, 0.25), simulate.paper_sensor(0.0), rng)


@pytest.fixture
def log_file(tmp_path):
    log, truth = small_log()
    datasets.save_log(tmp_path / "run.npz", log, truth)
    return tmp_path / "run.npz"


@pytest.fixture
def g2o_file(tmp_path, log_file):
    log, truth = datasets.load_log(log_file)
    *_, last = METHODS["np-graph"](log)
    datasets.save_g2o(tmp_path / "graph.g2o", last.graph)
    return tmp_path / "graph.g2o"


def test_help_is_printed_without_numpy():
    code = "import sys; from npslam_teach.cli import main\ntry: main(['--help'])\nexcept SystemExit: pass\n"
    code += "sys.exit(not {'numpy', 'scipy'}.isdisjoint(sys.modules))"
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, env=environment, timeout=60)
    assert done.returncode == 0, done.stderr


def test_every_command_has_its_function():
    actions = parser.build_parser()._subparsers._group_actions[0].choices
    assert set(actions) == {
        "lab",
        "fetch",
        "test",
        "bench",
        "reproduce",
        "solve",
        "optimize",
        "figures",
        "site",
        "book",
        "badges",
        "assignment",
    }
    assert all(callable(parser._function_of(name)) for name in actions)


# solve


SOLVE_FIELDS = {
    "method",
    "num_objects",
    "num_observations",
    "labels",
    "poses",
    "objects",
    "counts_per_iteration",
    "chi2",
    "objective",
    "seconds",
    "metrics",
    "quality",
    "restarts",
    "settings",
    "settled",
}
ONLY_SOLVE = {"labels", "poses", "objects", "quality", "restarts", "settings", "settled"}
METRICS = {
    "mean_pose_error",
    "rmse_pose_error",
    "cumulative_pose_error",
    "mean_object_error",
    "num_objects",
    "num_objects_true",
    "ari",
    "v_measure",
    "observations_used",
    "num_observations_used",
    "chi2_per_dof",
}


@pytest.mark.parametrize("method", METHODS)
def test_solve_prints_one_json_object(capsys, log_file, method):
    code, out, err = call(capsys, "solve", log_file, "--method", method, "--json")
    assert (code, err) == (0, "")
    result = json.loads(out)
    log, truth = datasets.load_log(log_file)
    assert set(result) == SOLVE_FIELDS
    assert set(result["metrics"]) == METRICS
    assert result["method"] == method
    assert len(result["labels"]) == log.num_observations
    assert np.shape(result["poses"]) == (log.num_poses, 3)
    assert len(result["objects"]) == result["num_objects"] == result["counts_per_iteration"][-1]
    assert set(result["objects"][0]) == {"xy", "class", "votes", "num_observations"}
    used = [label for label in result["labels"] if label >= 0]
    assert sum(entry["num_observations"] for entry in result["objects"]) == len(used)
    for k, label in enumerate(result["labels"]):
        if label >= 0:
            assert result["objects"][label]["class"] == log.obs_class[k]


def test_solve_agrees_with_the_library(capsys, log_file):
    _, out, _ = call(capsys, "solve", log_file, "--alpha", "0.5", "--threshold", "0.3", "--json")
    log, _ = datasets.load_log(log_file)
    *_, last = METHODS["np-graph"](log, alpha=0.5, threshold=0.3, **settings_for(log))
    result = json.loads(out)
    assert result["labels"] == last.labels.tolist()
    assert result["chi2"] == last.chi2


def test_solve_without_truth_has_no_metrics(capsys, tmp_path):
    log, _ = small_log()
    datasets.save_log(tmp_path / "blind.npz", log)
    code, out, _ = call(capsys, "solve", tmp_path / "blind.npz", "--json")
    assert code == 0
    assert set(json.loads(out)) == SOLVE_FIELDS - {"metrics"}
    code, out, _ = call(capsys, "solve", tmp_path / "blind.npz")
    assert code == 0
    assert "no truth" in out and "valid objects" in out and "nan" not in out


@pytest.mark.parametrize("settings", ["paper", "sensor"])
def test_what_was_used_stands_in_the_answer(capsys, log_file, settings):
    _, out, _ = call(capsys, "solve", log_file, "--settings", settings, "--kernel-std", "0.25", "--json")
    log, _ = datasets.load_log(log_file)
    used = {"paper": paper_settings(), "sensor": settings_for(log)}[settings] | {"kernel_std": 0.25}
    assert json.loads(out)["settings"] == {"name": settings} | json.loads(json.dumps(used))
    _, out, _ = call(capsys, "solve", log_file, "--settings", settings, "--no-exclusive")
    assert f"settings              {settings}, kernel-std " in out and "observations one by one" in out


@pytest.mark.parametrize("method", METHODS)
def test_a_log_in_other_units_has_the_same_answer(capsys, tmp_path, method):
    """Everything that is a length, standard deviations too, times ten: the same labels, a path ten times as long."""
    log, truth = small_log()
    scale = np.array([10.0, 10.0, 1.0])
    stds = {"odometry_std": log.odometry_std * scale, "observation_std": log.observation_std * 10}
    larger = replace(log, odometry=log.odometry * scale, obs_xy=log.obs_xy * 10, **stds)
    world = replace(truth.world, object_xy=truth.world.object_xy * 10)
    datasets.save_log(tmp_path / "small.npz", log, truth)
    datasets.save_log(tmp_path / "large.npz", larger, replace(truth, world=world, poses=truth.poses * scale))
    small, large = (
        json.loads(call(capsys, "solve", tmp_path / name, "--method", method, "--json")[1])
        for name in ("small.npz", "large.npz")
    )
    assert small["labels"] == large["labels"]
    np.testing.assert_allclose(np.array(small["poses"]) * scale, large["poses"], atol=1e-8)
    assert small["chi2"] == pytest.approx(large["chi2"], rel=1e-6, abs=1e-12)
    assert 10 * small["metrics"]["mean_pose_error"] == pytest.approx(large["metrics"]["mean_pose_error"], rel=1e-6)


def test_an_alternation_that_was_cut_short_says_so(capsys, log_file):
    _, out, err = call(capsys, "solve", log_file, "--iterations", "1", "--json")
    assert json.loads(out)["settled"] is False and "stopped after 1 iterations while labels were still" in err
    _, out, err = call(capsys, "solve", log_file, "--iterations", "20", "--json")
    assert json.loads(out)["settled"] is True and err == ""
    _, out, _ = call(capsys, "solve", log_file, "--method", "open-loop", "--json")
    assert json.loads(out)["settled"] is None


def test_a_threshold_that_can_merge_nothing_says_so(capsys, log_file):
    _, out, err = call(capsys, "solve", log_file, "--threshold", "0.6", "--json")
    assert "--threshold 0.6: expected less than 0.526" in err
    assert "nothing was merged: every observation is an object of its own" in err
    assert json.loads(out)["num_objects"] == json.loads(out)["num_observations"]


def test_restarts_keep_the_lowest_objective(capsys, log_file):
    result, again = (
        json.loads(call(capsys, "solve", log_file, "--restarts", "5", "--json")[1]) | {"seconds": 0} for _ in range(2)
    )
    assert result == again
    assert len(result["restarts"]) == 5
    assert result["objective"] == min(each["objective"] for each in result["restarts"])
    _, out, _ = call(capsys, "solve", log_file, "--restarts", "5")
    assert "restarts              5 orders: " in out
    assert_one_sentence(*call(capsys, "solve", log_file, "--restarts", "5", "--method", "ekf"), "--order", "ekf")


def test_the_filter_ends_with_the_smoothed_graph(capsys, log_file):
    smoothed, raw = (
        json.loads(call(capsys, "solve", log_file, "--method", "ekf", "--json", *more)[1])
        for more in ((), ("--filter-only",))
    )
    assert smoothed["labels"] == raw["labels"] and smoothed["chi2"] <= raw["chi2"]
    log, _ = datasets.load_log(log_file)
    best = pose_graph.fit(log, np.array(raw["labels"]), np.array(raw["poses"]))
    assert smoothed["chi2"] == pytest.approx(pose_graph.chi2(best), rel=1e-9)


def test_nan_becomes_null(capsys, log_file):
    code, out, _ = call(capsys, "solve", log_file, "--method", "frame-by-frame", "--json")
    assert json.loads(out)["metrics"]["chi2_per_dof"] is None


def test_solve_adds_the_same_noise_for_the_same_seed(capsys, log_file):
    arguments = ["solve", log_file, "--noise", "1", "--json", "--seed"]
    first, again, other = (json.loads(call(capsys, *arguments, seed)[1]) for seed in (3, 3, 4))
    assert first["poses"] == again["poses"]
    assert first["poses"] != other["poses"]


def test_solve_for_people(capsys, log_file):
    code, out, err = call(capsys, "solve", log_file)
    assert (code, err) == (0, "")
    assert "mean pose error" in out and " m\n" in out
    assert "->" in out


def test_solve_writes_its_result(capsys, log_file, tmp_path):
    code, out, _ = call(capsys, "solve", log_file, "--json", "--out", tmp_path / "result.json")
    assert code == 0
    assert json.loads((tmp_path / "result.json").read_text()) == json.loads(out)
    code, out, _ = call(capsys, "solve", log_file, "--json", "--out", tmp_path / "result.g2o")
    graph = datasets.load_g2o(tmp_path / "result.g2o")
    assert pose_graph.chi2(graph) == pytest.approx(json.loads(out)["chi2"], rel=1e-9)


# optimize


def test_optimize_prints_one_json_object(capsys, g2o_file):
    code, out, err = call(capsys, "optimize", g2o_file, "--json", "--repeat", "3")
    assert (code, err) == (0, "")
    result = json.loads(out)
    assert set(result) == {
        "chi2",
        "chi2_initial",
        "certificate",
        "gap",
        "smallest_eigenvalue",
        "certificate_seconds",
        "start",
        "chi2_by_start",
        "iterations",
        "converged",
        "status",
        "seconds",
        "poses",
        "landmarks",
    }
    assert result["converged"] is True
    assert len(result["seconds"]) == 3
    assert result["chi2"] <= result["chi2_initial"]
    graph = datasets.load_g2o(g2o_file)
    assert np.shape(result["poses"]) == graph.poses.shape
    assert np.shape(result["landmarks"]) == graph.landmarks.shape


def test_optimize_writes_a_graph_that_is_already_solved(capsys, g2o_file, tmp_path):
    _, out, _ = call(capsys, "optimize", g2o_file, "--out", tmp_path / "solved.g2o", "--json")
    _, again, _ = call(capsys, "optimize", tmp_path / "solved.g2o", "--json")
    assert json.loads(again)["chi2_initial"] == pytest.approx(json.loads(out)["chi2"], rel=1e-9)


def test_optimize_says_whether_its_minimum_is_the_lowest(capsys, cases_folder):
    """From the file's own start the solver converges at chi2 175.7; another start ends at 15.9, which is certified."""
    code, out, _ = call(capsys, "optimize", cases_folder / "wrong_minimum.g2o", "--json")
    result = json.loads(out)
    assert code == 0 and result["chi2"] == pytest.approx(15.889198, abs=1e-5)
    assert (result["certificate"], result["start"]) == ("certified", "chordal")
    assert result["gap"] <= 1e-6 * result["chi2"]
    _, out, _ = call(capsys, "optimize", cases_folder / "wrong_minimum.g2o")
    assert "certificate           certified: no other minimum is lower" in out


def test_optimize_for_people(capsys, g2o_file):
    code, out, _ = call(capsys, "optimize", g2o_file)
    assert code == 0
    assert "chi2" in out and "converged" in out


# reproduce


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


# everything that can be wrong


def truncated(path):
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def with_field(path, **fields):
    with np.load(path) as old:
        entries = dict(old) | fields
    np.savez(path, **entries)


def damaged_logs():
    def nan(path):
        with np.load(path) as old:
            odometry = old["odometry"].copy()
        odometry[3, 1] = np.nan
        with_field(path, odometry=odometry)

    def class_out_of_range(path):
        with np.load(path) as old:
            obs_class = old["obs_class"].copy()
        obs_class[0] = 99
        with_field(path, obs_class=obs_class)

    def time_out_of_range(path):
        with np.load(path) as old:
            obs_time = old["obs_time"].copy()
        obs_time[-1] = 100_000
        with_field(path, obs_time=obs_time)

    def pickled(path):
        with_field(path, odometry=np.array([{"a": 1}], dtype=object))

    def not_a_zip(path):
        path.write_text("hello")

    def missing_field(path):
        with zipfile.ZipFile(path) as old:
            kept = {name: old.read(name) for name in old.namelist() if name != "obs_xy.npy"}
        with zipfile.ZipFile(path, "w") as new:
            for name, data in kept.items():
                new.writestr(name, data)

    return [
        (nan, "odometry"),
        (class_out_of_range, "obs_class"),
        (time_out_of_range, "obs_time"),
        (pickled, "odometry"),
        (not_a_zip, ""),
        (truncated, ""),
        (missing_field, "obs_xy"),
    ]


def assert_one_sentence(code, out, err, *words):
    assert code == 2
    assert out == ""
    assert err.count("\n") == 1 and err.endswith("\n")
    assert "Traceback" not in err
    for word in words:
        assert str(word) in err


@pytest.mark.parametrize(("damage", "field"), damaged_logs(), ids=lambda v: getattr(v, "__name__", None))
def test_damaged_logs(capsys, log_file, tmp_path, damage, field):
    damage(log_file)
    before = sorted(tmp_path.iterdir())
    result = call(capsys, "solve", log_file, "--json", "--out", tmp_path / "result.json")
    assert_one_sentence(*result, "run.npz", field)
    assert sorted(tmp_path.iterdir()) == before


def test_a_truncated_mat_file(capsys, data_folder, tmp_path):
    path = tmp_path / "simulation.mat"
    path.write_bytes((data_folder / "mu2016_simulation.mat").read_bytes()[:20_000])
    assert_one_sentence(*call(capsys, "solve", path), "simulation.mat")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--alpha", "-1"], ["alpha", "positive", "-1"]),
        (["--alpha", "0"], ["alpha", "positive"]),
        (["--alpha", "nan"], ["alpha", "positive"]),
        (["--alpha", "much"], ["alpha", "number", "much"]),
        (["--threshold", "2"], ["threshold", "2"]),
        (["--noise", "-1"], ["noise", "non-negative"]),
        (["--seed", "-1"], ["seed", "whole number"]),
        (["--method", "magic"], ["method", "magic"]),
        (["--method", "open-loop", "--alpha", "0.5"], ["alpha", "open-loop"]),
        (["--method", "frame-by-frame", "--threshold", "0.5"], ["threshold", "frame-by-frame"]),
        (["--out", "result.txt"], ["--out", ".json"]),
        (["--out", "no/such/folder/result.json"], ["--out", "folder"]),
        (["--colour", "red"], ["--colour"]),
        (["--noise", "1e308"], ["noise", "1e6"]),
        (["--out", ""], ["--out"]),
    ],
)
def test_bad_options_of_solve(capsys, log_file, tmp_path, monkeypatch, arguments, words):
    monkeypatch.chdir(tmp_path)
    before = sorted(tmp_path.iterdir())
    assert_one_sentence(*call(capsys, "solve", log_file, *arguments), *words)
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.parametrize(
    "arguments",
    [
        ["solve", "missing.npz"],
        ["solve", "missing.mat"],
        ["optimize", "missing.g2o"],
        ["reproduce", "--data", "missing.mat"],
    ],
)
def test_missing_files(capsys, tmp_path, monkeypatch, arguments):
    monkeypatch.chdir(tmp_path)
    assert_one_sentence(*call(capsys, *arguments), "missing")
    assert not list(tmp_path.iterdir())


def test_a_line_of_a_graph_with_a_missing_number(capsys, g2o_file, tmp_path):
    lines = g2o_file.read_text().splitlines()
    number = next(k for k, line in enumerate(lines) if line.startswith("EDGE_SE2 "))
    lines[number] = lines[number].rsplit(" ", 1)[0]
    g2o_file.write_text("\n".join(lines))
    result = call(capsys, "optimize", g2o_file, "--out", tmp_path / "solved.g2o")
    assert_one_sentence(*result, "graph.g2o", number + 1)
    assert not (tmp_path / "solved.g2o").exists()


def test_a_graph_that_cannot_be_solved(capsys, g2o_file):
    g2o_file.write_text("VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\n")
    assert_one_sentence(*call(capsys, "optimize", g2o_file), "graph.g2o", "pose 1")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--seeds", "0"], ["seeds", "whole number"]),
        (["--methods", "np-graph,magic"], ["methods", "magic"]),
        (["--noise", "-2"], ["noise", "non-negative"]),
        (["--noise", "inf"], ["noise", "non-negative"]),
        (["--seeds", "99999999999999999999"], ["seeds", "whole number"]),
        (["--methods", "open-loop,open-loop"], ["methods", "once"]),
        (["--methods", ""], ["methods"]),
        (["--figures", ""], ["folder"]),
    ],
)
def test_bad_options_of_reproduce(capsys, arguments, words):
    assert_one_sentence(*call(capsys, "reproduce", *arguments), *words)


def test_reproduce_leaves_no_folder_behind_when_it_fails(capsys, tmp_path):
    arguments = ["reproduce", "--data", tmp_path / "missing.npz", "--figures", tmp_path / "new"]
    assert_one_sentence(*call(capsys, *arguments), "missing.npz")
    assert not list(tmp_path.iterdir())


def test_huge_numbers_in_a_log(capsys, log_file):
    with np.load(log_file) as old:
        obs_xy = old["obs_xy"] * 1e200
    with_field(log_file, obs_xy=obs_xy)
    assert_one_sentence(*call(capsys, "solve", log_file), "run.npz", "obs_xy", "1e+15")


@pytest.mark.parametrize("arguments", [["solve"], ["reproduce", "--noise", "0", "--data"]])
def test_a_log_that_only_the_metrics_cannot_use_is_named(capsys, log_file, arguments):
    with_field(log_file, odometry_std=np.full(3, 1e-10))
    assert_one_sentence(*call(capsys, *arguments, log_file), "run.npz", "odometry_std", "1e-07")


def test_too_little_memory_is_one_sentence(capsys, log_file, monkeypatch):
    def too_much(*_):
        raise MemoryError

    monkeypatch.setattr("npslam_teach.experiments.run_method", too_much)
    assert_one_sentence(*call(capsys, "solve", log_file), "memory")


def test_a_graph_without_information(capsys, g2o_file):
    g2o_file.write_text("VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\nEDGE_SE2 0 1 1 0 0 0 0 0 0 0 0\n")
    assert_one_sentence(*call(capsys, "optimize", g2o_file), "graph.g2o", "singular")


def test_a_closed_pipe_is_no_error(log_file):
    """Whoever pipes into `head` is not told off."""
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-c", "from npslam_teach.cli import main; import sys; sys.exit(main())"]
    reading, writing = os.pipe()
    os.close(reading)
    done = subprocess.run(
        [*command, "solve", str(log_file), "--json"],
        stdout=writing,
        stderr=subprocess.PIPE,
        env=environment,
        timeout=120,
    )
    os.close(writing)
    assert (done.returncode, done.stderr) == (141, b"")


def test_warnings_are_one_line_each(capsys, log_file, monkeypatch):
    import warnings

    def warned(*arguments):
        warnings.warn("the solver\nstopped", stacklevel=2)
        raise ValueError("enough")

    monkeypatch.setattr("npslam_teach.experiments.run_method", warned)
    with warnings.catch_warnings():
        warnings.simplefilter("default")
        code, out, err = call(capsys, "solve", log_file)
    assert err.splitlines()[0] == "npslam_teach solve: warning: the solver stopped"


def test_fetch_prints_where_the_file_is(capsys, data_folder, monkeypatch):
    monkeypatch.setenv("NPSLAM_TEACH_DATA", str(data_folder))
    code, out, err = call(capsys, "fetch", "simulation")
    assert (code, err) == (0, "")
    assert Path(out.strip()).is_file()
    assert_one_sentence(*call(capsys, "fetch", "everything"), "everything")


def test_lab_refuses_a_port_that_cannot_be(capsys):
    assert_one_sentence(*call(capsys, "lab", "--port", "99999"), "port", "65535")


def test_reproduce_needs_the_truth(capsys, tmp_path):
    log, _ = small_log()
    datasets.save_log(tmp_path / "blind.npz", log)
    assert_one_sentence(*call(capsys, "reproduce", "--data", tmp_path / "blind.npz"), "blind.npz", "true")


def test_no_command_and_a_wrong_command(capsys):
    assert_one_sentence(*call(capsys), "COMMAND")
    assert_one_sentence(*call(capsys, "dance"), "dance")


def test_ctrl_c_ends_with_130_and_writes_nothing(capsys, log_file, tmp_path, monkeypatch):
    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr("npslam_teach.experiments.run_method", interrupted)
    code, out, err = call(capsys, "solve", log_file, "--out", tmp_path / "result.json")
    assert (code, out) == (130, "")
    assert err.strip().endswith("interrupted")
    assert not (tmp_path / "result.json").exists()


def test_solve_as_a_process_of_its_own(tmp_path):
    log, truth = simulate.fifteen_objects()
    datasets.save_log(tmp_path / "run.npz", log, truth)
    done = run("solve", tmp_path / "run.npz", "--json")
    assert (done.returncode, done.stderr) == (0, "")
    assert json.loads(done.stdout)["num_objects"] == 15
    failed = run("solve", tmp_path / "run.npz", "--alpha", "-1")
    assert_one_sentence(failed.returncode, failed.stdout, failed.stderr, "alpha")


def test_lab_listens_on_the_loopback_address_and_keeps_the_token(monkeypatch):
    started = []
    monkeypatch.setattr(checkout, "_run_module", lambda arguments: started.append(arguments) or 0)
    assert parser.main(["lab", "--port", "9999", "--no-browser"]) == 0
    (arguments,) = started
    assert arguments[0] == "jupyterlab"
    assert "--LabApp.default_url=/lab/tree/notebooks/00_start_here.ipynb" in arguments
    assert f"--ServerApp.root_dir={ROOT}" in arguments
    assert "--ServerApp.ip=127.0.0.1" in arguments
    assert not any("token" in argument.lower() or "password" in argument.lower() for argument in arguments)


@pytest.fixture
def running_lab(tmp_path):
    """JupyterLab as our command starts it, on a free port; yields its address with the token."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    command = [
        sys.executable,
        "-c",
        "from npslam_teach.cli import main; main()",
        "lab",
        "--no-browser",
        "--port",
        str(port),
    ]
    environment = os.environ | {"PYTHONPATH": str(ROOT), "JUPYTER_RUNTIME_DIR": str(tmp_path)}
    with (tmp_path / "lab.log").open("w") as log:
        lab = subprocess.Popen(command, stdout=log, stderr=log, stdin=subprocess.DEVNULL, env=environment)
    try:
        yield port, _address(lab, tmp_path / "lab.log", port)
    finally:
        lab.terminate()
        assert lab.wait(timeout=120) is not None


def _address(lab, log, port):
    deadline = time.monotonic() + 120
    while time.monotonic() < deadline and lab.poll() is None:
        if found := re.search(rf"http://127\.0\.0\.1:{port}/\S*token=[0-9a-f]+", log.read_text()):
            return found.group()
        time.sleep(0.2)
    pytest.fail(f"JupyterLab did not start: {log.read_text()}")


def status(address):
    try:
        with urllib.request.urlopen(address, timeout=20) as answer:
            return answer.status
    except urllib.error.HTTPError as error:
        return error.code


def test_lab_serves_the_course_to_whoever_has_the_token(running_lab):
    port, address = running_lab
    assert "/lab/tree/notebooks/00_start_here.ipynb?token=" in address
    token = address.split("token=")[1]
    site = f"http://127.0.0.1:{port}"
    assert status(address) == 200
    assert status(f"{site}/api/contents/notebooks/00_start_here.ipynb?content=0&token={token}") == 200
    assert status(f"{site}/files/figures/fig16_simulation_iterations.png?token={token}") == 200
    assert status(f"{site}/api/contents/notebooks?content=0") == 403


def test_test_hands_its_arguments_to_pytest(monkeypatch):
    started = []
    monkeypatch.setattr(checkout, "_run_module", lambda arguments: started.append(arguments) or 5)
    assert parser.main(["test", "tests/test_se2.py", "-k", "wrap"]) == 5
    assert started[0][0] == "pytest"
    assert started[0][-3:] == ["tests/test_se2.py", "-k", "wrap"]
    assert "--nbval" in started[0] and "tests" not in started[0]
    assert parser.main(["test", "-k", "wrap"]) == 5
    assert started[1][-4:] == ["notebooks", "tests", "-k", "wrap"]


@pytest.mark.slow
def test_a_quick_test_is_of_the_mathematics_the_files_and_the_command_line(monkeypatch):
    started = []
    monkeypatch.setattr(checkout, "_run_module", lambda arguments: started.append(arguments) or 0)
    assert parser.main(["test", "--quick"]) == 0
    command = [sys.executable, "-m", *started[0], "--collect-only", "-q", "-p", "no:xdist"]
    command = [
        word
        for word in command
        if word not in ("-n", "--dist", "loadscope", "--no-loadscope-reorder") and not word.isdigit()
    ]
    collected = subprocess.run(command, cwd=commands.ROOT, capture_output=True, text=True, check=True).stdout
    files = {line.split("::")[0] for line in collected.splitlines() if "::" in line}
    expected = {
        "pose_graph/test_gauss_newton",
        "association/test_dirichlet_process",
        "methods/test_methods",
        "test_se2",
    }
    expected |= {"test_se2", "datasets/test_g2o", "cli/test_cli", "experiments/test_runs"}
    assert {f"tests/{name}.py" for name in expected} <= files
    assert not any(folder in name for name in files for folder in ("browser", "course", "notebooks", "benchmarks"))
    assert "test_the_papers_run_over_thirty_seeds" not in collected  # it is slow


def test_no_progress_bar_where_nobody_waits(log_file, monkeypatch):
    """The fastest method, as a process that may show its bar: there is nothing to see in the first two seconds."""
    monkeypatch.delenv("TQDM_DISABLE", raising=False)
    done = run("solve", log_file, "--method", "frame-by-frame")
    assert (done.returncode, done.stderr) == (0, "")
