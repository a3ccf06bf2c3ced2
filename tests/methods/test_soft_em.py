"""Soft association: weights against brute force, EM as an ascent, and what a confused detector no longer does."""

import itertools
import math
import sys
from dataclasses import replace

import numpy as np
import pytest

from npslam_teach import evaluation, se2, simulate
from npslam_teach.association.semantics import evenly_confused, reported
from npslam_teach.methods import METHODS, soft_em
from npslam_teach.methods.gating import frames_of, squared_gates
from npslam_teach.methods.soft_em import Pairs, em_round, expected, same_objects, weighted
from npslam_teach.pose_graph import chi2, fit
from npslam_teach.types import RobotLog, World

BOUND, _ = squared_gates(0.99, 0.999999)


def confused_room(seed, share, noise=1.0):
    """The fifteen objects, seen by a detector that is wrong in a share of its reports and knows it."""
    confusion = evenly_confused(5, share)
    log, truth = simulate.fifteen_objects(seed, noise, confusion)
    return replace(log, class_probabilities=reported(log.obs_class, confusion)), truth


def small_log(seed, num_classes=3):
    """Two or three objects seen from four poses, each observation with a row of probabilities."""
    rng = np.random.default_rng(seed)
    object_xy = rng.uniform(0.5, 2.5, (rng.integers(2, 4), 2))
    poses = se2.dead_reckoning(np.tile([0.3, 0.0, 0.4], (3, 1)))
    time, obj = np.nonzero(rng.random((4, len(object_xy))) < 0.8)
    xy = se2.apply_inverse(poses[time], object_xy[obj]) + rng.normal(scale=0.2, size=(len(time), 2))
    probabilities = rng.dirichlet(np.ones(num_classes), len(time))
    odometry = np.tile([0.3, 0.0, 0.4], (3, 1)) + rng.normal(scale=0.02, size=(3, 3))
    fields = (odometry, time, xy, probabilities.argmax(axis=1), num_classes, (0.02,) * 3, (0.2, 0.2))
    return RobotLog(*fields, class_probabilities=probabilities), obj


def density_ratio(log, k, pose, landmark, belief):
    """How much better "of this object" explains an observation than "of none", from densities written out."""
    off = log.obs_xy[k] - se2.apply_inverse(pose, landmark)
    density = math.exp(-0.5 * sum((off / log.observation_std) ** 2))
    at_the_gate = math.exp(-0.5 * BOUND)
    likelihood = log.class_probabilities[k]
    return density / at_the_gate * (belief @ likelihood) / likelihood.mean()


@pytest.mark.parametrize("seed", range(30))
def test_weights_are_brute_force_marginals(seed):
    log, obj = small_log(seed)
    labels = np.unique(obj, return_inverse=True)[1]
    graph, pairs = fit(log, labels), Pairs(np.arange(len(obj)), labels, np.ones(len(obj)))
    beliefs = np.array([log.class_probabilities[labels == j].prod(axis=0) for j in range(labels.max() + 1)])
    beliefs /= beliefs.sum(axis=1, keepdims=True)
    found = np.zeros((log.num_observations, len(beliefs)))
    result = expected(log, graph, pairs, BOUND)
    found[result.observation, result.object] = result.weight
    for time, frame in enumerate(frames_of(log)):
        total, of_pair = 0.0, np.zeros((len(frame), len(beliefs)))
        for chosen in itertools.product([-1, *range(len(beliefs))], repeat=len(frame)):
            used = [j for j in chosen if j >= 0]
            if len(set(used)) < len(used):
                continue
            product = 1.0
            for k, j in zip(frame, chosen, strict=True):
                product *= density_ratio(log, k, graph.poses[time], graph.landmarks[j], beliefs[j]) if j >= 0 else 1.0
            total += product
            for row, j in enumerate(chosen):
                of_pair[row, j] += product if j >= 0 else 0.0
        np.testing.assert_allclose(found[frame], of_pair / total, atol=2e-3)  # below 1e-3 a pair is left out


def negative_log_likelihood(log, graph, labels):
    """What EM descends on, classes certain: the odometry, and the mixture over all matchings of every frame."""
    distance = np.full((log.num_observations, len(graph.landmarks)), np.inf)
    classes = [log.obs_class[labels == j][0] for j in range(len(graph.landmarks))]
    for k in range(log.num_observations):
        for j, landmark in enumerate(graph.landmarks):
            if classes[j] == log.obs_class[k]:
                off = log.obs_xy[k] - se2.apply_inverse(graph.poses[log.obs_time[k]], landmark)
                distance[k, j] = sum((off / log.observation_std) ** 2)
    total = chi2(weighted(log, graph, Pairs(*(np.zeros(0, int),) * 2, np.zeros(0)))) / 2
    for frame in frames_of(log):
        ratio = np.where(distance[frame] < 30.0, np.exp((BOUND - distance[frame]) / 2), 0.0)
        total -= math.log(sum_over_matchings(ratio))
    return total


def sum_over_matchings(weights):
    if len(weights) == 0:
        return 1.0
    rest = sum_over_matchings(weights[1:])
    for j in np.flatnonzero(weights[0]):
        without = weights[1:].copy()
        without[:, j] = 0.0
        rest += weights[0, j] * sum_over_matchings(without)
    return rest


@pytest.mark.parametrize("seed", range(12))
def test_a_round_of_em_never_raises_what_it_descends_on(seed, monkeypatch):
    monkeypatch.setattr(sys.modules["npslam_teach.methods.soft_em"], "LEAST_WEIGHT", 0.0)
    log, obj = small_log(seed)
    labels = np.unique(obj, return_inverse=True)[1]
    log = replace(log, class_probabilities=None, obs_class=labels % 2)
    graph, pairs = fit(log, labels), Pairs(np.arange(len(obj)), labels, np.ones(len(obj)))
    values = [negative_log_likelihood(log, graph, labels)]
    for _ in range(6):
        graph, pairs = em_round(log, graph, pairs, BOUND)
        if len(graph.landmarks) <= labels.max():
            return  # an object has gone: from then on it is another mixture
        values.append(negative_log_likelihood(log, graph, labels))
    assert np.diff(values).max() <= 1e-6 * abs(values[0])
    assert values[-1] <= values[0]


@pytest.mark.parametrize("mixture", ["sum", "max"])
def test_certain_classes_and_clear_positions_are_hard_association(mixture):
    log, truth = simulate.fifteen_objects(1, 0.2)
    *_, last = soft_em(log, mixture=mixture)
    assert evaluation.compare_partitions(truth.obs_object[last.labels >= 0], last.labels[last.labels >= 0])[0] == 1.0
    best = fit(log, truth.obs_object)
    error = evaluation.distances_to_truth(last, truth)[0].mean()
    known = evaluation.distances_to_truth(replace(last, graph=replace(best, landmarks=last.graph.landmarks)), truth)[0]
    assert error == pytest.approx(known.mean(), rel=0.05)


@pytest.mark.parametrize("seed", [0, 2, 3])
def test_a_chair_called_cup_is_no_new_object(seed):
    log, truth = confused_room(seed, 0.3)
    *_, paper = METHODS["np-graph"](log)
    *_, soft = soft_em(log)
    assert paper.num_objects > 60
    assert 13 <= soft.num_objects <= 22
    assert evaluation.evaluate(soft, truth, log).ari > evaluation.evaluate(paper, truth, log).ari


def test_probabilities_that_are_certain_change_nothing_but_the_price_of_none():
    log, _ = simulate.fifteen_objects(3, 0.5)
    certain = replace(log, class_probabilities=np.eye(5)[log.obs_class])
    *_, plain = soft_em(log)
    *_, same = soft_em(certain)
    assert plain.num_objects == same.num_objects
    both = (plain.labels >= 0) & (same.labels >= 0)
    assert evaluation.compare_partitions(plain.labels[both], same.labels[both])[0] == 1.0


def test_names_and_order_of_lines_do_not_matter():
    log, _ = confused_room(2, 0.1)
    rng, renamed = np.random.default_rng(0), np.array([3, 0, 4, 1, 2])
    order = rng.permutation(log.num_observations)
    other = replace(
        log,
        obs_time=log.obs_time[order],
        obs_xy=log.obs_xy[order],
        obs_class=renamed[log.obs_class[order]],
        class_probabilities=log.class_probabilities[order][:, np.argsort(renamed)],
    )
    *_, first = soft_em(log)
    *_, second = soft_em(other)
    together = first.labels[order][:, None] == first.labels[order]
    np.testing.assert_array_equal(together, second.labels[:, None] == second.labels)


def twins(seed, apart=0.4):
    """Two chairs side by side, seen together from an arc around them, and a screen beside them."""
    world = World([[0.0, 2.0], [apart, 2.0], [1.0, 2.6]], [0, 0, 1], ("chair", "screen"))
    angle = np.linspace(-0.5, 0.5, 40)
    path = np.column_stack([2.5 * np.sin(angle), 0.3 - 0.2 * np.cos(angle), np.pi / 2 + angle])
    sensor = replace(simulate.paper_sensor(1.0), observation_std=(0.15, 0.15))
    return simulate.simulate_run(world, path, sensor, np.random.default_rng(seed))


@pytest.mark.parametrize("seed", range(5))
def test_two_look_alikes_stay_two(seed):
    log, truth = twins(seed)
    *_, last = soft_em(log)
    chairs = [j for j in range(last.num_objects) if last.votes[j, 1] > 5]
    assert len(chairs) == 2
    gap = np.linalg.norm(np.diff(last.graph.landmarks[chairs], axis=0))
    assert gap == pytest.approx(0.4, abs=0.1)


def test_one_object_twice_is_joined_and_neighbours_are_not():
    log, truth = simulate.fifteen_objects(1, 1.0)
    labels = truth.obs_object.copy()
    late = (labels == 4) & (log.obs_time > np.median(log.obs_time[labels == 4]))
    labels[late] = 15
    graph, pairs = fit(log, labels), Pairs(np.arange(len(labels)), labels, np.ones(len(labels)))
    copies = same_objects(log, weighted(log, graph, pairs), pairs, labels, BOUND)
    np.testing.assert_array_equal(copies, [*range(15), 4])


@pytest.mark.parametrize(
    ("setting", "message"),
    [
        ({"mixture": "mean"}, "mixture: expected one of sum, max, got 'mean'"),
        ({"iterations": 0}, "iterations: expected a positive integer, got 0"),
        ({"gate": 1.0}, "gate: expected a probability"),
        ({"observation_std": (0.1, 0.0)}, "observation_std"),
    ],
)
def test_bad_settings_are_named(setting, message):
    log, _ = small_log(0)
    with pytest.raises(ValueError, match=message):
        list(soft_em(log, **setting))
