"""The tables of lesson 12 are complete, and made by the code that says so."""

from collections import Counter

import numpy as np
import pytest

from npslam_teach.course.a_real_robot import table
from npslam_teach.experiments import real_robot
from npslam_teach.experiments.real_robot import (
    COLUMNS,
    COMPARED,
    FACTORS,
    KNOWN,
    NOISE_COLUMNS,
    SEEDS,
    Case,
    cases,
    imported,
    row_of,
    run_case,
)

# One run of every kind of case, recordings spread over the table.
SOME = [
    *((Case("np-graph"), 3), (Case("robust-slam"), 7), (Case("open-loop"), 1), (Case("frame-by-frame"), 5)),
    *((Case("ekf"), 9), (Case("posterior"), 4), (Case(KNOWN), 6), (Case("np-graph", "paper"), 2)),
    *((Case("ekf", "own", 4.0), 8), (Case("posterior", "own", 2.0), 11), (Case("np-graph", "own", 0.25), 10)),
    *((Case("np-graph", "repeated", 1.0, 1), 3), (Case("ekf", "own", 1.0, 1), 0)),
]


def assert_alike(stored, found):
    assert set(stored) == set(found)
    for name, value in found.items():
        # The last digits of what was solved may differ from one machine to another.
        loose = {"pose_error": 2e-3, "chi2_per_dof": 5e-3, "ari": 1e-4}.get(name, 0)
        assert stored[name] == (value if isinstance(value, str) else pytest.approx(value, abs=loose, nan_ok=True)), name


def test_every_run_is_in_the_table_once():
    assert len(SEEDS) >= 12
    rows = list(real_robot.read_table(table.FOLDER / "runs.csv", COLUMNS))
    found = Counter((Case(*(row[name] for name in Case._fields)), row["seed"]) for row in rows)
    assert found == {(case, seed): 1 for case in cases() for seed in SEEDS}
    noise = list(real_robot.read_table(table.FOLDER / "noise.csv", NOISE_COLUMNS))
    assert [row["seed"] for row in noise] == list(SEEDS)


@pytest.mark.slow
@pytest.mark.parametrize(("case", "seed"), SOME, ids=str)
def test_a_row_is_what_a_run_gives(case, seed):
    (stored,) = [row for row in table.runs_of(*case) if row["seed"] == seed]
    assert_alike(stored, row_of(case, seed, run_case(case, seed)))


@pytest.mark.slow
def test_estimates_are_what_the_library_estimates():
    noise = list(real_robot.read_table(table.FOLDER / "noise.csv", NOISE_COLUMNS))
    # A round takes seconds, more of them the longer the recording is, and is the same code.
    seed = min(SEEDS, key=lambda each: (noise[each]["rounds"], imported(each)[0].num_observations))
    found = real_robot.noise_row(seed)
    assert {name: found[name] for name in ("rounds", "converged")}.items() <= noise[seed].items()
    for name in ("odometry", "observation", "within", "outliers"):
        assert noise[seed][name] == pytest.approx(found[name], rel=0.01, abs=1e-3)
    case = Case("ekf", "estimated", real_robot.DATA_SHEET)
    (row,) = [row for row in table.runs_of(*case) if row["seed"] == seed]
    assert row["objects"] == run_case(case, seed).num_objects


@pytest.mark.slow
@pytest.mark.parametrize("factor", [1.0, 4.0])
def test_stored_labels_are_those_of_a_run(factor):
    np.testing.assert_array_equal(
        table.labels_of("posterior", factor), run_case(Case("posterior", "own", factor), 0).labels
    )


def test_what_a_case_changes():
    log = imported(0)[0]
    half = real_robot.log_of(Case("ekf", "own", 0.5), 0)
    np.testing.assert_allclose(half.odometry_std, log.odometry_std / 2)
    np.testing.assert_allclose(half.observation_std, log.observation_std / 2)
    np.testing.assert_array_equal(half.obs_xy, log.obs_xy)
    assert real_robot.log_of(Case("ekf", "own", 1.0, 1), 0).num_classes == 1
    told, not_told = (run_case(Case("np-graph", noise, 1.0, 1), 1) for noise in ("own", "repeated"))
    assert real_robot.twice_in_a_frame(imported(1, 1)[0], told.labels) == 0
    assert real_robot.twice_in_a_frame(imported(1, 1)[0], not_told.labels) > 10
    assert run_case(Case("ekf", "own", 4.0), 0).num_objects < run_case(Case("ekf", "own", 0.25), 0).num_objects


def test_twice_in_a_frame_counts_by_hand():
    log = imported(0)[0]
    labels = np.full(log.num_observations, -1)
    frame = np.flatnonzero(log.obs_time == np.bincount(log.obs_time).argmax())
    labels[frame] = 0
    assert len(frame) >= 3
    assert real_robot.twice_in_a_frame(log, labels) == len(frame) - 1


def test_the_command_writes_all_tables(tmp_path, monkeypatch):
    few = [Case("robust-slam"), Case(KNOWN)]
    monkeypatch.setattr(real_robot, "SEEDS", range(2))
    monkeypatch.setattr(real_robot, "cases", lambda: few)
    monkeypatch.setattr(real_robot, "noise_row", lambda seed: dict.fromkeys(NOISE_COLUMNS, seed))
    monkeypatch.setattr(real_robot, "labels_row", lambda factor: {"method": "x", "factor": factor, "labels": "0 1"})
    real_robot.main(str(tmp_path))
    rows = list(real_robot.read_table(tmp_path / "runs.csv", COLUMNS))
    assert [(row["method"], row["seed"]) for row in rows] == [(case.method, seed) for case in few for seed in (0, 1)]
    for row in rows:
        assert row["objects"] == table.runs_of(row["method"])[int(row["seed"])]["objects"]
    assert len((tmp_path / "labels.csv").read_text().splitlines()) == 1 + len(FACTORS)


def test_unknown_methods_and_other_files_are_refused(tmp_path):
    with pytest.raises(ValueError, match="method: expected one of np-graph, .*, got 'magic'"):
        run_case(Case("magic"), 0)
    with pytest.raises(ValueError, match="case: expected one that was run, got Case"):
        table.runs_of("ekf", "own", 3.0)
    with pytest.raises(ValueError, match="labels: expected a method and factor"):
        table.labels_of("ekf", 1.0)
    (tmp_path / "other.csv").write_text("a,b\n1,2\n")
    with pytest.raises(ValueError, match="other.csv: expected the columns method, noise"):
        next(real_robot.read_table(tmp_path / "other.csv", COLUMNS))


def test_words_of_the_table():
    assert table.median_and_range([3.0, 1.0, 2.0], 1) == "2.0 (1.0 to 3.0)"
    text = table.compared({"a": Case("ekf"), "bb": Case(KNOWN)}, {"objects": 0, "ari": 2}).splitlines()
    objects = table.column("objects", "ekf")
    assert f"{np.median(objects):.0f} ({objects.min():.0f} to {objects.max():.0f})" in text[1]
    assert text[2].split()[0] == "bb" and "1.00 (1.00 to 1.00)" in text[2]


def test_winners_are_counted_row_by_row():
    path = table.winners(COMPARED).splitlines()[2]
    errors = np.array([table.column("pose_error", name) for name in COMPARED])
    best = COMPARED[np.median(errors, axis=1).argmin()]
    assert path.startswith(f"path: {best} in the median")
    for name, own in zip(COMPARED, errors, strict=True):
        others = errors[[other != name for other in COMPARED]]
        assert f"{name} {np.sum(own < others.min(axis=0))}" in path
