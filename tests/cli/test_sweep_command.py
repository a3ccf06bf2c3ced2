"""``sweep`` and ``figures --sweep``: a table from the command line, its pictures, and the guide to both."""

import re
import shlex

import pytest
from commands import ROOT, assert_one_sentence, call

from npslam_teach import simulate
from npslam_teach.cli import parser
from npslam_teach.experiments import sweep, sweep_files

NOTEBOOKS = ROOT / "notebooks"
GUIDE = (NOTEBOOKS / "sweeps.md").read_text(encoding="utf-8")
SMALL = "--seeds 2 --methods np-graph,open-loop --noise 1,2 --alpha own,0.5 --workers 1".split()


@pytest.fixture(scope="module")
def table(tmp_path_factory):
    """A small sweep, written by the command."""
    path = tmp_path_factory.mktemp("sweep") / "sweep.csv"
    with pytest.warns(UserWarning, match="--alpha has no effect on open-loop"):
        options = parser.build_parser().parse_args(["sweep", "--out", str(path), *SMALL])
        from npslam_teach.cli.sweep_options import run_sweep

        assert run_sweep(options) == (12, 12, 0)
    return path


def test_the_command_says_what_it_did_and_what_has_no_effect(capsys, table):
    before = table.read_text()
    code, out, err = call(capsys, "sweep", "--out", table, *SMALL)
    assert (code, out) == (0, f"{table}: 12 runs, 0 of them computed now\n")
    assert "--alpha has no effect on open-loop" in err
    assert table.read_text() == before
    assert len(sweep_files.read_rows(table)) == 12


def test_the_row_of_a_run_is_what_the_method_finds(table):
    rows = {sweep.point_of(row): row for row in sweep_files.read_rows(table)}
    point = sweep.Point("fifteen_objects", "open-loop", "paper", 2.0, None, None, None, 1)
    log, _ = simulate.fifteen_objects(1, 2.0)
    *_, last = sweep.METHODS["open-loop"](log)
    assert rows[point]["objects"] == last.num_objects and rows[point]["chi2"] == last.chi2


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--methods", "magic"], ["methods", "magic"]),
        (["--scenes", "missing.npz"], ["missing.npz"]),
        (["--scenes", "twins,twins"], ["scenes", "once"]),
        (["--noise", "-1"], ["noise", "non-negative"]),
        (["--noise", "1,,2"], ["noise", "commas"]),
        (["--noise", "1,x"], ["noise", "number"]),
        (["--settings", "mine"], ["scales", "mine"]),
        (["--methods", "ekf", "--alpha", "0.1"], ["alpha", "ekf"]),
        (["--alpha", "-1", "--seeds", "1"], ["alpha", "-1"]),
        (["--dask", "tcp://127.0.0.1:9", "--workers", "2"], ["--workers", "--dask"]),
        (["--out", "sweep.txt"], ["--out", ".csv", ".parquet"]),
        (["--out", "nowhere/sweep.csv"], ["--out", "folder"]),
    ],
)
def test_bad_options_of_sweep(capsys, tmp_path, monkeypatch, arguments, words):
    monkeypatch.chdir(tmp_path)
    out = [] if "--out" in arguments else ["--out", "sweep.csv"]
    assert_one_sentence(*call(capsys, "sweep", *out, *arguments), *words)
    assert not [path for path in tmp_path.iterdir() if len(path.read_text().splitlines()) > 1]


def test_figures_of_a_sweep(capsys, table):
    code, out, _ = call(capsys, "figures", "--sweep", table)
    folder = table.with_suffix("")
    assert (code, out) == (0, f"figures: {folder}\n")
    names = {path.name for path in folder.glob("*.png")}
    assert names == {f"success_fifteen-objects_paper{end}.png" for end in ("", "_np-graph_alpha")}


@pytest.mark.parametrize("contents", [None, "a,b\n1,2\n", "HEADER"])
def test_figures_of_no_sweep(capsys, tmp_path, contents):
    path = tmp_path / "sweep.csv"
    if contents is not None:
        path.write_text(contents.replace("HEADER", ",".join(sweep.COLUMNS) + "\n"))
    assert_one_sentence(*call(capsys, "figures", "--sweep", path), "sweep.csv")
    assert not (tmp_path / "sweep").is_dir()


def blocks(language):
    return re.findall(rf"^```{language}\n(.*?)^```$", GUIDE, re.M | re.S)


def test_the_python_of_the_guide_runs(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    local, *clusters = blocks("python")
    exec(compile(local, "guide", "exec"), {"__name__": "__main__"})
    rows = sweep_files.read_rows("sweep.csv")
    assert capsys.readouterr().out == f"{sum(map(sweep.is_right, rows))} of {len(rows)} runs were right\n"
    assert len(rows) == 4 * 2 * 2 * 2  # both methods have a kernel
    for text in clusters:
        compile(text, "guide", "exec")
    assert len(clusters) == 2


def test_the_commands_of_the_guide_are_understood():
    program = "python3 -m npslam_teach "
    commands = [line for line in GUIDE.splitlines() if line.startswith(program)]
    assert len(commands) == 3
    for line in commands:
        options = parser.build_parser().parse_args(shlex.split(line.removeprefix(program)))
        if options.command == "sweep":
            from npslam_teach.cli.sweep_options import grid_of

            assert len(grid_of(options)) >= 180


def test_links_of_the_guide_exist():
    for target in re.findall(r"\]\(([^)]+)\)", GUIDE):
        assert target.startswith("https:") or (NOTEBOOKS / target).is_file(), target
    for other in (ROOT / "README.md", NOTEBOOKS / "teaching_guide.md"):
        assert "sweeps.md)" in other.read_text(encoding="utf-8")
