"""The table of lesson 15 is complete, and its rows are what the code gives, times apart."""

from itertools import islice

import pytest

from npslam_teach.course.online import table
from npslam_teach.experiments import online_rooms
from npslam_teach.experiments.online_rooms import RUNS, TIMES, run


def test_every_run_is_in_the_table_as_far_as_it_says():
    found = [(row["case"], row["rooms"], row["seed"], row["tenth"]) for row in table.load()]
    expected = [(case, rooms, seed, tenth) for case, rooms, seed, tenths in RUNS for tenth in range(1, tenths + 1)]
    assert found == expected


@pytest.mark.parametrize("case", ["told", "online"])
def test_a_row_is_what_a_run_gives(case):
    (row,) = islice(run(case, 9, 0), 1)
    which = {"case": case, "rooms": 9, "seed": 0, "tenth": 1}
    (kept,) = [each for each in table.load() if which.items() <= each.items()]
    assert {name: row[name] for name in ("poses", "objects", "objects_true", "ari")} == {
        name: kept[name] for name in ("poses", "objects", "objects_true", "ari")
    }
    for name in ("error", "error_batch", "error_told"):
        assert row[name] == pytest.approx(kept[name], abs=2e-4)
    assert all(row[name] > 0 for name in TIMES)


def test_the_tree_keeps_its_promises():
    """From the second tenth on, in the runs of the table: no slower by a fifth; 99 frames of 100 far below 50 ms."""
    for case, rooms, seed, tenths in RUNS:
        if tenths >= 2:
            assert table.column("p99_ms", case, rooms, seed).max() < 50
        if case == "told" and tenths >= 2:
            median = table.column("median_ms", case, rooms, seed)[1:]
            assert median.max() <= 1.2 * median[0]


def test_there_and_back(tmp_path, monkeypatch):
    monkeypatch.setattr(online_rooms, "RUNS", (("told", 1, 0, 3),))
    online_rooms.main(str(tmp_path / "runs.csv"))
    rows = online_rooms.read_table(tmp_path / "runs.csv")
    assert [row["tenth"] for row in rows] == [1, 2, 3]
    assert all(row["ari"] == 1.0 for row in rows)


def test_no_such_case():
    with pytest.raises(ValueError, match="case: expected told or online, got 'magic'"):
        next(run("magic", 1, 0))
    with pytest.raises(ValueError, match="case: .*3 rooms.*'told'"):
        table.column("error", "told", 3)
