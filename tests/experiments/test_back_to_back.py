"""The table of lesson 14 is complete, and made by the code that says so."""

import itertools
from collections import Counter

import numpy as np
import pytest

from npslam_teach import se2
from npslam_teach.course.orientation import table
from npslam_teach.experiments import back_to_back
from npslam_teach.experiments.back_to_back import CASES, DEGREES, GAP, SEEDS, hall, run_case

# One run of every case, halls and degrees spread over the table.
SOME = [
    ("np-graph", 45.0, 29),
    ("ekf", 30.0, 11),
    ("posterior", 20.0, 2),
    ("true identities", 2.0, 17),
    ("ekf", 0.0, 5),
]


def test_every_run_is_in_the_table_once():
    assert len(SEEDS) >= 30
    expected = dict.fromkeys(itertools.product(CASES, DEGREES, SEEDS), 1)
    assert Counter((row["case"], row["degrees"], row["seed"]) for row in table.load()) == expected


@pytest.mark.parametrize(("case", "degrees", "seed"), SOME)
def test_a_row_is_what_a_run_gives(case, degrees, seed):
    (row,) = [row for row in table.load() if (row["case"], row["degrees"], row["seed"]) == (case, degrees, seed)]
    assert run_case(case, degrees, seed) == row


def test_a_hall_is_as_described():
    log, truth = hall(3, 20.0)
    world = truth.world
    apart = np.linalg.norm(world.object_xy[::2] - world.object_xy[1::2], axis=1)
    np.testing.assert_allclose(apart, GAP)
    np.testing.assert_allclose(np.abs(se2.wrap(world.object_theta[::2] - world.object_theta[1::2])), np.pi)
    off = se2.wrap(log.obs_theta + truth.poses[log.obs_time, 2] - world.object_theta[truth.obs_object])
    assert np.rad2deg(off.std()) == pytest.approx(20.0, rel=0.15)


def test_only_headings_change_with_the_degrees():
    (without, _), (sharp, _), (blunt, _) = (hall(4, degrees) for degrees in (0.0, 2.0, 60.0))
    assert without.obs_theta is None
    for name in ("odometry", "obs_time", "obs_xy"):
        np.testing.assert_array_equal(getattr(without, name), getattr(sharp, name))
        np.testing.assert_array_equal(getattr(blunt, name), getattr(sharp, name))


def test_there_and_back(tmp_path, monkeypatch):
    monkeypatch.setattr(back_to_back, "SEEDS", range(1))
    monkeypatch.setattr(back_to_back, "CASES", ("ekf", "true identities"))
    back_to_back.main(str(tmp_path / "runs.csv"))
    rows = back_to_back.read_table(tmp_path / "runs.csv")
    assert [(row["case"], row["degrees"]) for row in rows] == list(itertools.product(back_to_back.CASES, DEGREES))


def test_no_such_case():
    with pytest.raises(ValueError, match="case: expected one of np-graph, .*'magic'"):
        run_case("magic", 10.0, 0)
    with pytest.raises(ValueError, match="case: .*with 7 degrees.*'np-graph'"):
        table.column("objects", "np-graph", 7.0)
