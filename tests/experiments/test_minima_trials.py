"""Trials of `optimize`: what counts as a miss and as a false claim, and a sample of them."""

import sys

import numpy as np
import pytest

from npslam_teach.experiments import minima_trials
from npslam_teach.experiments.minima_trials import DRIVES, random_problem, summary, trial
from npslam_teach.pose_graph import Certificate, chi2


@pytest.mark.parametrize("seed", range(8))
def test_problems_are_drawn_from_their_seed_and_are_near_the_truth(seed):
    kind, start, graph, truth = random_problem(seed)
    again = random_problem(seed)
    np.testing.assert_array_equal(graph.poses, again[2].poses)
    assert (kind, start) == again[:2] and kind == list(DRIVES)[seed % 4]
    measured = 3 * len(truth.between.i) + 2 * len(truth.observations.pose)
    if seed % 5:  # nothing is measured falsely
        assert 0.3 < chi2(truth) / measured < 1.7
    assert start != "zeros" or not graph.poses.any()


def test_in_a_sample_nothing_that_is_claimed_is_false():
    rows = [trial(seed, num_starts=6) for seed in range(16)]
    assert not any(row["false_claim"] for row in rows)
    assert sum(row["certificate"] == "certified" for row in rows) > 8


@pytest.mark.parametrize(("gap", "missed", "false"), [(0.0, True, True), (10.0, True, True), (1e9, True, False)])
def test_a_lower_end_than_the_certificate_allows_is_a_false_claim(monkeypatch, gap, missed, false):
    """A solver that always stops 50 too high, and what it says about that."""

    def too_high(graph):
        optimum = certified_minimum(graph)
        at = optimum.certificate.chi2 + 50.0
        optimum.__dict__["certificate"] = Certificate(at, min(gap, at), 0.0)
        return optimum

    certified_minimum = minima_trials.certified_minimum
    monkeypatch.setattr(minima_trials, "certified_minimum", too_high)
    row = trial(1, num_starts=2)
    assert (row["missed"], row["false_claim"]) == (missed, false)


def test_the_summary_counts():
    row = {"kind": "ring", "certificate": "certified", "missed": False, "false_claim": False}
    rows = [row, row | {"certificate": "none", "missed": True}, row | {"kind": "walk", "false_claim": True}]
    lines = summary(rows).splitlines()
    assert lines[0] == "walk: 1 graphs: certified 1, gap 0, none 0; missed 0, false claims 1"
    assert lines[1] == "ring: 2 graphs: certified 1, gap 0, none 1; missed 1, false claims 0"
    assert lines[2] == "all: 3 graphs: certified 2, gap 0, none 1; missed 1, false claims 1"


def test_the_command_prints_a_line_for_each_kind(monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["trials", "--graphs", "1"])
    minima_trials.main()
    assert capsys.readouterr().out.splitlines()[-1].startswith("all: 1 graphs: ")
