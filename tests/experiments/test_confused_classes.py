"""The table of lesson 13 is complete, and made by the code that says so."""

import itertools
from collections import Counter

import numpy as np
import pytest

from npslam_teach.course.soft_association import table
from npslam_teach.experiments import confused_classes
from npslam_teach.experiments.confused_classes import CASES, SEEDS, SHARES, room, run_case

# One run of every case, rooms and shares spread over the table.
SOME = [("np-graph", 0.1, 29), ("ekf hard", 0.5, 7), ("ekf", 0.3, 11), ("max-mixture", 0.3, 17)]
SOME += [("overconfident", 0.1, 22), ("true identities", 0.0, 13)]
SOME += [("soft-em", 0.5, 7)]


def test_every_run_is_in_the_table_once():
    assert len(SEEDS) >= 30
    expected = dict.fromkeys(itertools.product(CASES, SHARES, SEEDS), 1)
    assert Counter((row["case"], row["share"], row["seed"]) for row in table.load()) == expected


@pytest.mark.parametrize(("case", "share", "seed"), SOME)
def test_a_row_is_what_a_run_gives(case, share, seed):
    (row,) = [row for row in table.load() if (row["case"], row["share"], row["seed"]) == (case, share, seed)]
    assert run_case(case, share, seed) == row


def test_the_detector_errs_as_often_as_it_says():
    log, truth = room(3, 0.3)
    wrong = log.obs_class != truth.world.object_class[truth.obs_object]
    assert wrong.mean() == pytest.approx(0.3, abs=0.04)
    rows = np.arange(log.num_observations)
    np.testing.assert_allclose(log.class_probabilities[rows, log.obs_class], 0.7)
    vain, _ = room(3, 0.3, claimed=0.02)
    np.testing.assert_array_equal(vain.obs_class, log.obs_class)
    np.testing.assert_allclose(vain.class_probabilities[rows, log.obs_class], 0.98)


def test_there_and_back(tmp_path, monkeypatch):
    monkeypatch.setattr(confused_classes, "SEEDS", range(1))
    monkeypatch.setattr(confused_classes, "CASES", ("np-graph", "true identities"))
    confused_classes.main(str(tmp_path / "runs.csv"))
    rows = confused_classes.read_table(tmp_path / "runs.csv")
    assert [(row["case"], row["share"]) for row in rows] == list(itertools.product(confused_classes.CASES, SHARES))


def test_no_such_case():
    with pytest.raises(ValueError, match="case: expected one of np-graph, .*'magic'"):
        run_case("magic", 0.1, 0)
    with pytest.raises(ValueError, match="case: .*share 0.2.*'np-graph'"):
        table.column("objects", "np-graph", 0.2)
