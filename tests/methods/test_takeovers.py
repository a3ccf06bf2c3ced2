"""Tracklets that run on from one object to another: found again by a map that was made without them."""

import math
from dataclasses import replace

import numpy as np
import pytest

from npslam_teach import simulate
from npslam_teach.association import in_order_of_sight, same_partition
from npslam_teach.methods.annealing import Model, rivals_of
from npslam_teach.methods.gating import GATE
from npslam_teach.methods.partition_score import Found, partition_score, ways_to_cut
from npslam_teach.methods.posterior import in_time, start_model
from npslam_teach.methods.takeovers import one_or_two, with_takeovers
from npslam_teach.pose_graph import fit


def cost_of(squared, labels):
    cut = np.count_nonzero(np.diff(labels))
    extra = 2 * (math.log(2 * (len(labels) - 1)) - math.log(1 - GATE)) if cut else 0.0
    return squared[np.arange(len(labels)), labels].sum() + extra


@pytest.mark.parametrize("seed", range(20))
def test_one_object_or_one_and_then_another(seed):
    """Against every cut and every pair of objects."""
    rng = np.random.default_rng(seed)
    count, objects = int(rng.integers(1, 9)), int(rng.integers(1, 5))
    squared = rng.gamma(1.0, 20.0, (count, objects))
    squared[rng.random(squared.shape) < 0.1] = np.inf
    every = [
        np.where(np.arange(count) < cut, first, then)
        for cut in range(count)
        for first in range(objects)
        for then in range(objects)
    ]
    found, least = one_or_two(squared), min(cost_of(squared, each) for each in every)
    if np.isfinite(least):
        assert cost_of(squared, found) == pytest.approx(least, rel=1e-12)
    else:
        assert (found == -1).all()


def test_a_run_is_one_of_few_choices_and_scattered_observations_are_of_many():
    """Ten observations, four of another object: nine places for a run of four at an end, 210 choices of any four."""
    assert ways_to_cut(np.repeat([3, 5], [6, 4])) == 2 * 9
    assert ways_to_cut(np.array([3, 5, 3, 3, 5, 3, 5, 3, 5, 3])) == 2 * math.comb(9, 8)
    assert ways_to_cut(np.array([3, 5, 3, 3, 5, 3, 3, 5, 3, 3, 5, 3])) == 2 * math.comb(11, 8)
    assert ways_to_cut(np.array([3, 3, 5, 3, 3, 3, 3, 3])) == 2 * 8


def with_one_tracklet_of_two_objects(model: Model, truth: np.ndarray, last: int, then: int):
    """The model and labels (M,) when a tracklet runs on into another one, and both are taken for the first's object."""
    joined = np.where(model.tracklet == then, last, model.tracklet)
    tracklet = in_order_of_sight(joined, joined >= 0)
    labels = np.where(model.tracklet == then, truth[model.tracklet == last][0], truth)
    return model._replace(tracklet=tracklet, rivals=rivals_of(model.log, tracklet)), labels


def test_a_tracklet_that_runs_on_into_another_object_is_cut_where_the_other_begins():
    log, truth = simulate.fifteen_objects(3, 1.0)
    kept = log.obs_time < 400
    fields = {name: getattr(log, name)[kept] for name in ("obs_time", "obs_xy", "obs_class")}
    log, back = in_time(replace(log, odometry=log.odometry[:399], **fields))
    truth = np.unique(truth.obs_object[kept][np.argsort(back)], return_inverse=True)[1]
    model, graph = start_model(log)
    last, then = soonest_after_another(model, truth)
    wrong, labels = with_one_tracklet_of_two_objects(model, truth, last, then)
    labels = labels_once_in_a_frame(log, labels, model.tracklet == then)
    graph = fit(log, labels, graph.poses)
    before = Found(labels, graph, partition_score(wrong, labels, graph))
    after = with_takeovers(wrong, before)
    tied = model.tracklet >= 0
    assert not same_partition(labels[tied], truth[tied])
    assert same_partition(after.labels[tied], truth[tied])
    assert after.score > before.score + 10
    assert after.score == pytest.approx(partition_score(wrong, after.labels, after.graph))
    frames = np.column_stack([log.obs_time, after.labels])[after.labels >= 0]
    assert len(np.unique(frames, axis=0)) == len(frames)


def soonest_after_another(model: Model, truth: np.ndarray) -> tuple[int, int]:
    """Two tracklets of a class, the second begins soonest after the first has ended; its object has others as well."""
    log, own = model.log, [np.flatnonzero(model.tracklet == k) for k in range(len(model.rivals))]
    begin, end = (np.array([log.obs_time[each][i] for each in own]) for i in (0, -1))
    objects, classes = (np.array([values[each[0]] for each in own]) for values in (truth, log.obs_class))
    follows = (classes[:, None] == classes) & (objects[:, None] != objects) & (end[:, None] < begin)
    follows &= np.bincount(objects)[objects] > 1
    gap = np.where(follows, begin - end[:, None], np.inf)
    return np.unravel_index(gap.argmin(), gap.shape)


def labels_once_in_a_frame(log, labels, moved):
    """Labels (M,) in which what the moved observations displace in their own frame is of none."""
    taken = labels[moved] + 1000 * log.obs_time[moved]
    displaced = ~moved & np.isin(labels + 1000 * log.obs_time, taken)
    labels = np.where(displaced, -1, labels)
    return in_order_of_sight(labels, labels >= 0)
