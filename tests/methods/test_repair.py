"""Repair: the share of outliers, and objects that are others in a wrong place."""

import sys

import numpy as np
import pytest

from npslam_teach.methods.annealing import Model, rivals_of
from npslam_teach.methods.partition_score import without_displaced
from npslam_teach.methods.repair import outlier_share
from npslam_teach.pose_graph import fit
from npslam_teach.types import BetweenFactors, ObservationFactors, PoseGraph, RobotLog

STD = np.array([0.1, 0.1])


def standing(xy):
    """A robot that stands still and sees one thing at every pose."""
    count = len(xy)
    return RobotLog(np.zeros((count - 1, 3)), np.arange(count), xy, np.zeros(count, int), 1, (0.001,) * 3, STD)


def around_means(log, labels):
    """A graph whose landmarks are the means of what was seen of them, poses at zero."""
    landmarks = np.array([log.obs_xy[labels == k].mean(axis=0) for k in range(labels.max() + 1)])
    none = BetweenFactors([], [], np.zeros((0, 3)), np.zeros((0, 3, 3)))
    information = np.tile(np.diag(1 / STD**2), (log.num_observations, 1, 1))
    seen = ObservationFactors(log.obs_time, labels, log.obs_xy, information)
    return PoseGraph(np.zeros((log.num_poses, 3)), landmarks, none, seen)


@pytest.mark.parametrize("seed", range(5))
def test_objects_that_are_seen_twice_do_not_make_outliers_of_the_others(seed):
    """Of two sights half of every square is taken up by their mean; normal errors have no outliers all the same."""
    rng = np.random.default_rng(seed)
    labels = np.concatenate([np.repeat(np.arange(600), 2), 600 + np.repeat(np.arange(20), 60)])
    log = standing(rng.uniform(-9, 9, (620, 2))[labels] + rng.normal(size=(len(labels), 2)) * STD)
    assert outlier_share(log, around_means(log, labels), labels) == 0.0


def test_outliers_are_counted():
    rng = np.random.default_rng(0)
    labels = np.repeat(np.arange(40), 50)
    bad = rng.random(len(labels)) < 0.05
    off = rng.normal(size=(len(labels), 2)) * np.where(bad, 10, 1)[:, None] * STD
    log = standing(rng.uniform(-9, 9, (40, 2))[labels] + off)
    assert outlier_share(log, around_means(log, labels), labels) == pytest.approx(bad.mean(), abs=0.015)


@pytest.mark.parametrize(("share", "objects"), [(0.0, 2), (0.05, 1), (0.2, 2)])
def test_a_displaced_pass_is_joined_where_outliers_are_few_and_known(monkeypatch, share, objects):
    """Where there are many, it is the noise that is described wrongly, and nothing may be joined for it."""
    rng = np.random.default_rng(0)
    labels = np.repeat([0, 1], [60, 3])
    log = standing(np.where(labels[:, None] == 0, [2.0, 0.0], [2.5, 0.0]) + rng.normal(size=(63, 2)) * STD / 10)
    model = Model(log, labels, rivals_of(log, labels), 1.0, 100.0)
    monkeypatch.setattr(sys.modules[without_displaced.__module__], "outlier_share", lambda *_: share)
    assert without_displaced(model, labels, fit(log, labels)).max() + 1 == objects
