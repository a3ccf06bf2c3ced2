"""The score that compares methods: it depends on who is who alone, and on nothing that a method assumed."""

from dataclasses import replace

import numpy as np
import pytest

from npslam_teach import evaluation, pose_graph, simulate
from npslam_teach.association import objective
from npslam_teach.methods import METHODS


@pytest.fixture(scope="module")
def scene():
    return simulate.toy_objects()


@pytest.mark.parametrize("name", METHODS)
def test_it_is_the_objective_of_the_best_fit(scene, name):
    log, _ = scene
    *_, last = METHODS[name](log)
    labels = evaluation.singletons_for_unassigned(last.labels)
    votes = np.zeros((labels.max() + 1, log.num_classes + 1))
    votes[:, 0] = 1
    np.add.at(votes, (labels, log.obs_class + 1), 1)
    expected = objective(pose_graph.chi2(pose_graph.fit(log, labels)), votes, 0.5, 30.0)
    assert evaluation.refitted_objective(last, log, 0.5, 30.0) == pytest.approx(expected, rel=1e-7)


def test_what_a_method_assumed_does_not_count(scene):
    log, _ = scene
    *_, last = METHODS["np-graph"](log)
    shaken = replace(last.graph, poses=last.graph.poses + [[0.1, 0, 0]], landmarks=last.graph.landmarks + 1)
    other = replace(last, graph=shaken, chi2=1e9, objective=None)
    score = evaluation.refitted_objective(last, log)
    assert evaluation.refitted_objective(other, log) == pytest.approx(score, rel=1e-7)


def test_to_leave_out_what_fits_does_not_pay():
    log, truth = simulate.fifteen_objects(1)
    labels = truth.obs_object
    graph = pose_graph.fit(log, labels)
    *_, start = METHODS["frame-by-frame"](log)
    right = replace(start, labels=labels, votes=np.ones((labels.max() + 1, 2)), graph=graph)
    fewer = replace(right, labels=np.where(np.arange(len(labels)) % 2, -1, labels))
    assert evaluation.refitted_objective(right, log) < evaluation.refitted_objective(fewer, log)
