"""One sentence for everything that can be wrong with files and options."""

import zipfile

import numpy as np
import pytest
from commands import assert_one_sentence, call


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
