"""``optimize``: what it prints and writes."""

import json

import numpy as np
import pytest
from commands import call

from npslam_teach import datasets
from npslam_teach.cli import parser


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
    assert "certificate           certified: no other minimum is lower by more than a millionth of it" in out


@pytest.mark.filterwarnings("ignore:.*the estimates come from the edges alone")
def test_without_vertices_it_sets_out_from_the_odometry(capsys, tmp_path):
    """A square whose odometry closes it: nothing is left to be found."""
    sides = "".join(f"EDGE_SE2 {i} {i + 1} 1 0 {np.pi / 2!r} 1 0 0 1 0 1\n" for i in range(4))
    (tmp_path / "square.g2o").write_text(sides + "EDGE_SE2 4 0 0 0 0 1 0 0 1 0 1\n", encoding="utf-8")
    code, out, _ = call(capsys, "optimize", tmp_path / "square.g2o", "--json")
    assert code == 0 and json.loads(out)["chi2_initial"] < 1e-20


def test_optimize_for_people(capsys, g2o_file):
    code, out, _ = call(capsys, "optimize", g2o_file)
    assert code == 0
    assert "chi2" in out and "converged" in out


@pytest.mark.parametrize("command", ["optimize", "import csv", "book", "site", "figures"])
def test_out_is_given_once_or_refused(capsys, tmp_path, command):
    """The first name would be forgotten without a word."""
    first, second = tmp_path / "first.g2o", tmp_path / "second.g2o"
    words = [*command.split(), *(["graph.g2o"] if command in ("optimize", "import csv") else [])]
    with pytest.raises(SystemExit) as stopped:
        parser.main([*words, "--out", str(first), "--out", str(second)])
    assert stopped.value.code == 2
    err = capsys.readouterr().err
    assert err == f"npslam_teach {words[0]}: --out: expected once, got {first} and {second}\n"


def test_a_solution_replaces_a_file_only_with_a_word(capsys, g2o_file, tmp_path):
    out = tmp_path / "solved.g2o"
    assert call(capsys, "optimize", g2o_file, "--out", out)[::2] == (0, "")
    code, _, err = call(capsys, "optimize", g2o_file, "--out", out)
    assert code == 0 and "replaces the file that is there" in err
