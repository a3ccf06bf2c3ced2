"""The table of all methods says what its rows say."""

import json
import re
from pathlib import Path

import numpy as np
import pytest

from npslam_teach.course.online import table
from npslam_teach.experiments import method_summary, method_table, tables
from npslam_teach.experiments.sweep import COLUMNS
from npslam_teach.experiments.sweep_files import read_rows
from npslam_teach.methods import METHODS

ROOT = Path(__file__).parents[2]
RESULTS = ROOT / "tests" / "benchmarks" / "results"


def row(method, noise, seed, objects, ari, **more):
    values = {"scene": "fifteen_objects", "scale": "sensor", "objects_true": 15, "pose_error": 0.5, "seconds": 0.25}
    values |= {"method": method, "noise": noise, "seed": seed, "objects": objects, "ari": ari}
    return dict.fromkeys(COLUMNS) | values | more


def cells(text):
    lines = [line for line in text.splitlines() if line.startswith("|")][2:]
    return {each[0]: each for each in ([cell.strip() for cell in line.strip("|").split("|")] for line in lines)}


def test_a_line_is_what_its_runs_say():
    rows = [row("ekf", 1.0, 0, 15, 0.999), row("ekf", 1.0, 1, 15, 0.9, pose_error=0.7), row("ekf", 3.0, 0, 14, 1.0)]
    rows += [row("posterior", noise, seed, 15, 1.0) for noise in (1.0, 3.0) for seed in (0, 1)]
    real = [row("ekf", 0.0, 0, 15, 0.95, scene="a.npz"), row("ekf", 0.0, 0, 16, 0.97, scene="b.npz")]
    found = cells(method_table.markdown(rows, real, {"ekf": 12.3, "posterior": None}))
    assert list(found) == ["ekf", "posterior"], "in the order of the methods"
    assert found["ekf"][2:] == ["2 of 2", "1: 1, 3: 0", "1 of 2, ARI from 0.95", "0.60, 0.50", "0.25", "12"]
    assert found["posterior"][2:] == ["2 of 2", "1: 2, 3: 2", "", "0.50, 0.50", "0.25", ""]


def test_every_method_says_what_it_needs():
    assert method_table.NEEDS.keys() == METHODS.keys()


def test_a_run_takes_memory():
    megabytes = method_table.megabytes_of("np-graph")
    assert megabytes is None or 0 < megabytes < 500


def test_the_committed_table_is_that_of_the_committed_rows():
    """All but the memory, which is measured anew each time."""
    rows, real = read_rows(RESULTS / "methods.csv"), read_rows(RESULTS / "recordings.csv")
    assert {each["method"] for each in rows} == {each["method"] for each in real} == METHODS.keys()
    assert {each["noise"] for each in rows} == {1.0, 2.0, 3.0, 4.0, 6.0}
    assert all(each["error"] is None for each in [*rows, *real])
    committed = (RESULTS / "methods.md").read_text(encoding="utf-8")
    megabytes = {name: float(line[-1] or "nan") for name, line in cells(committed).items()}
    assert committed == method_table.markdown(rows, real, megabytes)


def test_the_summary_counts_exact_runs_in_the_order_of_the_methods():
    rows = [row("posterior", 1.0, seed, 15, ari, seconds=0.1 + seed) for seed, ari in enumerate((1.0, 0.9, 1.0))]
    rows += [row("ekf", 3.0, 0, 14, 1.0), row("ekf", 1.0, 0, 15, 1.0, seconds=None)]
    first, second, third = method_summary.summary(rows)
    assert {key: first[key] for key in ("method", "noise", "runs", "exact")} == dict(
        method="ekf", noise=1.0, runs=1, exact=1
    )
    assert np.isnan(first["seconds"]), "nobody has measured it"
    assert second == {"method": "ekf", "noise": 3.0, "runs": 1, "exact": 0, "seconds": 0.25}
    assert third == {"method": "posterior", "noise": 1.0, "runs": 3, "exact": 2, "seconds": 1.1}


def test_the_lesson_draws_the_committed_rows():
    committed = table.METHODS_FILE.read_text(encoding="utf-8")
    assert list(table.all_methods()) == method_summary.summary(read_rows(RESULTS / "methods.csv"))
    assert committed.splitlines()[0] == ",".join(method_summary.COLUMNS)


def test_the_table_and_the_summary_are_written(tmp_path, monkeypatch):
    monkeypatch.setattr(method_table, "megabytes_of", lambda name: 1.0)
    rows = [row("ekf", 1.0, 0, 15, 1.0)]
    tables.write_table(rows, COLUMNS, tmp_path / "methods.csv")
    method_table.main(tmp_path, tmp_path / "summary.csv")
    assert cells((tmp_path / "methods.md").read_text(encoding="utf-8"))["ekf"][2] == "1 of 1"
    assert method_summary.read_summary(tmp_path / "summary.csv") == method_summary.summary(rows)


def words_of(page):
    """The text of a page; of a lesson, that of its cells."""
    if page.suffix == ".ipynb":
        cells_of_lesson = json.loads(page.read_text(encoding="utf-8"))["cells"]
        return "\n".join("".join(cell["source"]) + "\n" for cell in cells_of_lesson)
    return page.read_text(encoding="utf-8")


@pytest.mark.parametrize("page", ["README.md", "notebooks/teaching_guide.md", "notebooks/15_online.ipynb"])
def test_pages_show_the_committed_table(page):
    shown = re.search(r"(^\|.*\n)+", (RESULTS / "methods.md").read_text(encoding="utf-8"), re.MULTILINE).group(0)
    assert shown in words_of(ROOT / page)
