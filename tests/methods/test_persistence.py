"""Persistence: passes and comings against loops over the observations, two objects against every labelling of them."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

from npslam_teach.association import in_order_of_sight, same_partition
from npslam_teach.association.partition_posterior import log_posterior, log_prior, log_priors
from npslam_teach.methods.exchanges import _squared_distances, with_exchanges
from npslam_teach.methods.partition_score import in_pieces, partition_prior, partition_score, scored
from npslam_teach.methods.persistence import (
    between_two,
    num_comings,
    passes_of,
    persistence,
    singled_out,
)
from npslam_teach.methods.tracklets import LONGEST_GAP


def random_labels(rng, count=30):
    """Observations in time, at most one of an object at a pose, some of none."""
    time = np.sort(rng.integers(0, 60, count))
    labels = np.full(count, -1)
    for pose in np.unique(time):
        own = np.flatnonzero(time == pose)
        labels[own] = rng.permutation(np.append(np.arange(3), np.full(len(own), -1)))[: len(own)]
    return labels, time


@pytest.mark.parametrize("seed", range(20))
def test_a_pass_ends_when_its_object_is_out_of_sight_for_long(seed):
    rng = np.random.default_rng(seed)
    labels, time = random_labels(rng)
    number, of_pass = passes_of(labels, time)
    last, expected, count = {}, [], 0
    for label, pose in zip(singled_out(labels).tolist(), time.tolist(), strict=True):
        if label not in last or pose - last[label][0] > LONGEST_GAP:
            last[label], count = (pose, count), count + 1
        last[label] = (pose, last[label][1])
        expected.append(last[label][1])
    assert number.tolist() == expected
    assert same_partition(of_pass[number], singled_out(labels))


@pytest.mark.parametrize("seed", range(20))
def test_comings_are_observations_that_the_frame_before_has_not_seen(seed):
    rng = np.random.default_rng(seed)
    labels, time = random_labels(rng)
    look = np.unique(time, return_inverse=True)[1]
    seen = {(frame, label) for frame, label in zip(look.tolist(), labels.tolist(), strict=True) if label >= 0}
    assert num_comings(labels, look) == sum((frame - 1, label) not in seen for frame, label in seen)


def test_where_nothing_is_missed_a_coming_is_rare_and_where_much_is_missed_it_is_not():
    time = np.arange(100)
    steady = persistence(np.zeros(100, int), time, 1.0)
    assert steady.log_coming == pytest.approx(2 * math.log(1 / 100)) and steady.comings == 1
    every_other = persistence(time % 2, time, 1.0)  # two objects, seen by turns
    assert every_other.log_coming == 0.0 and every_other.comings == 100
    assert steady.log_pass == pytest.approx(-math.log(101))
    assert steady.log_prior(steady.comings + 2, steady.passes) == pytest.approx(2 * steady.log_coming)


def cost_of(which, squared, look, log_coming, log_alone):
    """The cost of a labelling of observations by two objects, written out; infinite where one is seen twice."""
    cost, frames = 0.0, {frame: [] for frame in look.tolist()}
    for k, each in enumerate(which):
        if each < 0:
            continue
        cost += squared[k, each] / 2 + log_alone
        if each in frames[look[k]]:
            return math.inf
        frames[look[k]].append(each)
    return cost - log_coming * sum(
        each not in frames.get(frame - 1, []) for frame, own in frames.items() for each in own
    )


@pytest.mark.parametrize("seed", range(40))
def test_two_objects_are_told_apart_by_all_frames_together(seed):
    """Against every labelling of up to seven observations. A coming into the first frame is the same for all."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(1, 8))
    look = np.sort(rng.integers(0, 5, count))
    squared = rng.gamma(1.0, 8.0, (count, 2))
    log_coming, log_alone = -rng.gamma(1.0, 3.0), -rng.gamma(2.0, 5.0)

    def cost(which):
        first = {each for each, frame in zip(which, look.tolist(), strict=True) if each >= 0 and frame == look[0]}
        return cost_of(which, squared, look, log_coming, log_alone) + log_coming * len(first)

    found = between_two(squared, look, log_coming, log_alone)
    least = min(map(cost, itertools.product((-1, 0, 1), repeat=count)))
    assert cost(found.tolist()) == pytest.approx(least, abs=1e-9)


def test_the_score_of_whole_tracklets_is_their_log_posterior(room):
    model, graph, truth = room
    tracklet, _ = passes_of(truth, model.log.obs_time)  # nothing left out, every pass a tracklet
    model = model._replace(tracklet=tracklet)
    found = scored(model, truth, graph.poses)
    finer, reduced = in_pieces(model, truth, found.graph, tracklet)
    of_tracklet = truth[np.unique(tracklet, return_index=True)[1]]
    model = model._replace(rivals=finer.rivals)
    assert partition_score(model, truth, found.graph) == pytest.approx(
        log_posterior(finer.evidence(reduced), of_tracklet)
    )


def test_prior_and_places_make_the_score(room):
    """Labels of the same passes differ by the prior alone."""
    model, graph, truth = room
    price = persistence(model.tracklet, model.log.obs_time, model.alpha)
    found = scored(model, truth, graph.poses)
    cheaper = model._replace(alpha=2.0 * model.alpha)
    change = partition_score(cheaper, truth, found.graph) - found.score
    at_two = persistence(model.tracklet, model.log.obs_time, 2.0)
    assert change == pytest.approx(partition_prior(cheaper, truth, at_two) - partition_prior(model, truth, price))


@pytest.mark.parametrize("seed", range(10))
def test_the_priors_of_all_objects_are_summed_in_one_piece(room, seed):
    rng = np.random.default_rng(seed)
    evidence = room[0].prior()
    labels = in_order_of_sight(rng.integers(0, 9, len(evidence.counts)))
    members = [np.flatnonzero(labels == i).tolist() for i in range(labels.max() + 1)]
    expected = sum(log_prior(each, evidence) for each in members)
    assert log_priors(labels, evidence) == pytest.approx(expected)
    certain = evidence._replace(classes=np.log(rng.dirichlet(np.ones(3), len(labels))))
    expected = sum(log_prior(each, certain) for each in members)
    assert log_priors(labels, certain) == pytest.approx(expected)


def test_two_observations_of_a_frame_that_were_exchanged_are_put_right(room):
    model, graph, truth = room
    time = model.log.obs_time
    place = np.array([truth[time == pose][:2] for pose in range(400) if np.count_nonzero(time == pose) > 1])
    classes = model.log.obs_class[np.unique(truth, return_index=True)[1]]
    pairs = place[classes[place[:, 0]] == classes[place[:, 1]]]
    first, second = pairs[len(pairs) // 2]
    frames = np.intersect1d(time[truth == first], time[truth == second])
    wrong = truth.copy()
    for pose, (one, other) in zip(frames[5:8], itertools.repeat((first, second)), strict=False):
        own = (time == pose) & np.isin(truth, (one, other))
        wrong[own] = np.where(truth[own] == one, other, one)
    left_out = np.flatnonzero((time == frames[9]) & (truth == first))
    wrong[left_out] = -1
    before = scored(model, wrong, graph.poses)
    after = with_exchanges(model, before)
    assert same_partition(after.labels, truth) and after.score > before.score + 10
    assert after.score == pytest.approx(partition_score(model, after.labels, after.graph))


def test_what_is_reported_of_classes_counts_in_exchanges(room):
    """In an exchange an observation is as far from an object as its report disagrees with all that is said of that."""
    model, graph, truth = room
    rng, log = np.random.default_rng(0), model.log
    told = 0.8 * np.eye(log.num_classes)[log.obs_class] + 0.2 * rng.dirichlet(np.ones(log.num_classes), len(truth))
    nothing = np.full(told.shape, 1 / log.num_classes)
    model, blind = (model._replace(log=replace(log, class_probabilities=each)) for each in (told, nothing))
    found = scored(model, truth, graph.poses)
    agreement = np.ones((len(truth), truth.max() + 1))
    for j in range(truth.max() + 1):
        logs = np.log(told[truth == j]).sum(axis=0)
        belief = np.exp(logs - logs.max()) / np.exp(logs - logs.max()).sum()
        agreement[:, j] = log.num_classes * told @ belief
    change = _squared_distances(model, found) - _squared_distances(blind, found)
    np.testing.assert_allclose(change, -2 * np.log(agreement), atol=1e-9)
