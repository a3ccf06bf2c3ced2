"""A sweep: against the objective, against the rule written plainly, and against itself under other names."""

import importlib
import math

import numpy as np
import pytest
from partitions import objective_of, same_groups

from npslam_teach import association, np_graph, se2, simulate
from npslam_teach.association import radius_search
from npslam_teach.association.sweep import visiting_order


def random_scene(seed, num_observations=40, num_objects=8, num_classes=3, spread=2.0):
    """Observations scattered about, each already labelled, and objects somewhere near them."""
    rng = np.random.default_rng(seed)
    obs_class = rng.integers(0, num_classes, num_observations)
    labels = rng.integers(0, num_objects, num_observations)
    labels = np.unique(labels * num_classes + obs_class, return_inverse=True)[1]  # one class per object
    xy = rng.uniform(0, spread, (num_observations, 2))
    landmarks = np.array([xy[labels == i].mean(axis=0) for i in range(labels.max() + 1)])
    return labels, landmarks, xy, obs_class


@pytest.mark.parametrize("seed", range(10))
def test_each_decision_of_a_sweep_minimises_the_objective(seed):
    """A sweep that visits one observation only moves it where the objective, tried for every choice, is least."""
    labels, landmarks, xy, obs_class = random_scene(seed)
    alpha, kernel_std = 0.9, 0.4
    for k in range(len(labels)):
        # Freeze the others by visiting k alone: a scene of its own order, cut after the first visit.
        tried = []
        radius_search = [i for i in range(len(landmarks)) if (obs_class[labels == i] == obs_class[k]).any()]
        for choice in [*radius_search, len(landmarks)]:
            changed = labels.copy()
            changed[k] = choice
            extended = np.vstack([landmarks, xy[k]])
            tried.append((objective_of(changed, extended, xy, obs_class, alpha, kernel_std), choice))
        best = min(tried)[1]
        others = np.delete(np.arange(len(labels)), k)
        votes = np.array([np.sum(labels[others] == i) * 1.0 for i in range(len(landmarks))])
        votes *= [(obs_class[labels == i][0] == obs_class[k]) for i in range(len(landmarks))]
        distance = np.linalg.norm(landmarks - xy[k], axis=1)
        chosen = association.decide(association.association_probabilities(votes, distance, alpha, kernel_std))
        assert chosen == best or objective_of_choice(tried, chosen) == pytest.approx(min(tried)[0], abs=1e-9)


def objective_of_choice(tried, choice):
    return dict((c, value) for value, c in tried).get(choice, math.inf)


@pytest.mark.parametrize("seed", range(10))
def test_moving_one_observation_changes_the_objective_by_the_log_weights(seed):
    labels, landmarks, xy, obs_class = random_scene(seed)
    alpha, kernel_std, k = 0.9, 0.4, seed
    others = np.arange(len(labels)) != k
    same = [i for i in range(len(landmarks)) if (obs_class[labels == i] == obs_class[k]).all() and i != labels[k]]
    for target in same:
        moved = labels.copy()
        moved[k] = target
        change = objective_of(moved, landmarks, xy, obs_class, alpha, kernel_std) - objective_of(
            labels, landmarks, xy, obs_class, alpha, kernel_std
        )

        def log_weight(i, k=k):
            votes = np.sum(labels[others] == i)
            if votes == 0:  # leaving an object of one's own closes it: the weight of that is alpha's
                return math.log(alpha) - np.sum((xy[k] - landmarks[i]) ** 2) / (2 * kernel_std**2)
            return math.log(votes) - np.sum((xy[k] - landmarks[i]) ** 2) / (2 * kernel_std**2)

        assert change == pytest.approx(log_weight(labels[k]) - log_weight(target), abs=1e-9)


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("order", ["last-to-first", "first-to-last"])
def test_a_sweep_never_raises_the_objective(seed, order):
    labels, landmarks, xy, obs_class = random_scene(seed)
    alpha, kernel_std = 0.9, 0.4
    # An object of a single observation sits on it, as after a solve; elsewhere a new object could beat the old one.
    before = objective_of(labels, landmarks, xy, obs_class, alpha, kernel_std)
    after = association.sweep(labels, landmarks, xy, obs_class, alpha, None, kernel_std, order)
    assert objective_of(after.labels, after.landmarks, xy, obs_class, alpha, kernel_std) <= before + 1e-9


def sweep_by_dictionaries(labels, landmarks, xy, obs_class, alpha, kernel_std, order):
    """The same rule once more, without arrays."""
    objects = {i: (landmarks[i], [k for k in range(len(labels)) if labels[k] == i]) for i in range(len(landmarks))}
    home = dict(enumerate(labels))
    for k in order:
        objects[home[k]][1].remove(k)
        best, best_weight = None, alpha
        for i, (place, members) in objects.items():
            votes = sum(obs_class[m] == obs_class[k] for m in members)
            weight = votes * math.exp(-((place[0] - xy[k][0]) ** 2 + (place[1] - xy[k][1]) ** 2) / (2 * kernel_std**2))
            if weight > best_weight:
                best, best_weight = i, weight
        if best is None:
            best = len(objects)
            objects[best] = (xy[k], [])
        objects[best][1].append(k)
        home[k] = best
    return [home[k] for k in range(len(labels))]


@pytest.mark.parametrize("seed", range(10))
def test_a_sweep_equals_the_rule_written_plainly(seed):
    labels, landmarks, xy, obs_class = random_scene(seed)
    order = np.random.default_rng(seed).permutation(len(labels))
    found = association.sweep(labels, landmarks, xy, obs_class, 0.9, None, 0.4, order)
    plain = sweep_by_dictionaries(labels, landmarks, xy, obs_class, 0.9, 0.4, order)
    np.testing.assert_array_equal(same_groups(found.labels), same_groups(plain))


def assert_same_sweep(*scene):
    fast, plain = association.sweep(*scene), association.plain_sweep(*scene)
    np.testing.assert_array_equal(fast.labels, plain.labels)
    np.testing.assert_array_equal(fast.landmarks, plain.landmarks)


@pytest.mark.parametrize("alpha", [1e-3, 0.9, 1.0, 30.0])
@pytest.mark.parametrize("threshold", [None, 0.0, 1e-12, 0.2, 0.5, 0.9, 1.0])
def test_the_fast_sweep_is_the_plain_one(alpha, threshold):
    """Rooms from crowded to empty, labels that are wrong, orders of all kinds, kernels from narrow to wide."""
    for seed in range(12):
        rng = np.random.default_rng(seed)
        scene = random_scene(seed, num_observations=int(rng.integers(1, 60)), spread=rng.choice([0.5, 3.0, 20.0]))
        order = [rng.permutation(len(scene[0])), "last-to-first", "first-to-last"][seed % 3]
        assert_same_sweep(*scene, alpha, threshold, rng.choice([0.05, 0.354, 3.0, 1e4]), order)


@pytest.mark.parametrize("threshold", [None, 0.3, 0.5, 2 / 3])
def test_the_fast_sweep_is_the_plain_one_where_answers_tie(threshold):
    """Places on a coarse grid: distances, weights and probabilities are equal again and again, to the last bit."""
    for seed in range(30):
        rng = np.random.default_rng(seed)
        labels, landmarks, xy, obs_class = random_scene(seed, num_observations=40)
        xy, landmarks = np.round(xy * 2) / 2, np.round(landmarks * 2) / 2
        assert_same_sweep(labels, landmarks, xy, obs_class, rng.choice([0.5, 1.0, 2.0]), threshold, 0.5)
        assert_same_sweep(labels, 0 * landmarks, 0 * xy, obs_class, 1.0, threshold, 0.5)


@pytest.mark.parametrize("noise", [0.0, 1.0, 4.0])
@pytest.mark.parametrize("threshold", [None, 0.5])
def test_the_fast_sweep_is_the_plain_one_all_through_the_fifteen_objects(noise, threshold):
    log, _ = simulate.fifteen_objects(3, noise)
    for snapshot in np_graph(log, iterations=4, threshold=threshold):
        if snapshot.labels.min() >= 0:
            xy = se2.apply(snapshot.graph.poses[log.obs_time], log.obs_xy)
            assert_same_sweep(snapshot.labels, snapshot.graph.landmarks, xy, log.obs_class, 0.9, threshold)


def test_candidates_in_many_portions_are_the_same(monkeypatch):
    log, _ = simulate.fifteen_objects(1)
    labels, poses = np.arange(log.num_observations), se2.dead_reckoning(log.odometry)
    xy = se2.apply(poses[log.obs_time], log.obs_xy)
    at_once = association.sweep(labels, xy, xy, log.obs_class)
    monkeypatch.setattr(radius_search, "PAIRS_AT_ONCE", 1000)
    np.testing.assert_array_equal(association.sweep(labels, xy, xy, log.obs_class).labels, at_once.labels)


@pytest.mark.parametrize("seed", range(10))
def test_crowds_are_counted_over_cells_and_their_neighbours(seed):
    cells = np.random.default_rng(seed).integers(-3, 4, (60, 3))
    near = (np.abs(cells[:, None, :2] - cells[None, :, :2]) <= 1).all(axis=2)
    assert radius_search.most_around(cells) == (near & (cells[:, None, 2] == cells[None, :, 2])).sum(axis=1).max()


def test_a_sweep_compares_only_what_is_near(monkeypatch):
    """Ten times the room with ten times the objects: not a hundred times the comparisons.

    A little more than ten times: there is less edge, and the reach grows with the logarithm of the votes there can be.
    """
    module = importlib.import_module("npslam_teach.association.sweep")  # its function hides its name
    compared, choose = [], module._choose

    def counting(votes, objects, *rest):
        compared.append(len(objects))
        return choose(votes, objects, *rest)

    monkeypatch.setattr(module, "_choose", counting)
    for factor in (1, 10):
        rng = np.random.default_rng(0)
        xy = rng.uniform(0, 1, (200 * factor, 2)) * [10.0 * factor, 10.0]
        association.sweep(np.arange(len(xy)), xy, xy, np.zeros(len(xy), int))
    assert sum(compared[200:]) < 20 * sum(compared[:200])


@pytest.mark.parametrize("seed", range(5))
def test_renaming_reordering_and_moving_the_world_change_nothing(seed):
    labels, landmarks, xy, obs_class = random_scene(seed)
    rng = np.random.default_rng(seed + 100)
    order, shuffle, names = rng.permutation(len(labels)), rng.permutation(len(labels)), rng.permutation(len(landmarks))
    first = association.sweep(labels, landmarks, xy, obs_class, 0.9, None, 0.4, order)

    renamed_landmarks = np.empty_like(landmarks)
    renamed_landmarks[names] = landmarks
    where = np.empty(len(labels), dtype=int)
    where[shuffle] = np.arange(len(labels))  # observation k is now number where[k]
    turn = np.array([[0.0, -1.0], [1.0, 0.0]])
    second = association.sweep(
        names[labels][shuffle],
        renamed_landmarks @ turn.T + [3.0, 4.0],
        xy[shuffle] @ turn.T + [3.0, 4.0],
        rng.permutation(3)[obs_class][shuffle],
        0.9,
        None,
        0.4,
        where[order],
    )
    np.testing.assert_array_equal(same_groups(second.labels[where]), same_groups(first.labels))


def test_the_inputs_of_a_sweep_are_left_alone():
    labels, landmarks, xy, obs_class = random_scene(0)
    copies = labels.copy(), landmarks.copy(), xy.copy()
    association.sweep(labels, landmarks, xy, obs_class)
    for array, copy in zip((labels, landmarks, xy), copies, strict=True):
        np.testing.assert_array_equal(array, copy)


def test_the_defaults_are_the_papers():
    """exp(-4 d^2), alpha 0.9, last to first, 0.1 for odometry, 0.5 m for sightings, five alternations."""
    import inspect

    from npslam_teach.methods import snapshots

    assert association.PAPER_ALPHA == 0.9
    assert pytest.approx(1 / 8) == association.PAPER_KERNEL_STD**2
    assert snapshots.PAPER_ODOMETRY_STD == (0.1, 0.1, 0.1)
    assert snapshots.PAPER_OBSERVATION_STD == (0.5, 0.5)
    parameters = inspect.signature(np_graph).parameters
    assert parameters["iterations"].default == 5
    assert parameters["order"].default == inspect.signature(association.sweep).parameters["order"].default
    assert parameters["order"].default == "last-to-first"


def test_the_order_of_visits_matters_and_last_to_first_is_the_default():
    labels, landmarks, xy, obs_class = random_scene(2)
    default, last, first = (
        association.sweep(labels, landmarks, xy, obs_class, **order).labels
        for order in ({}, {"order": "last-to-first"}, {"order": "first-to-last"})
    )
    np.testing.assert_array_equal(default, last)
    assert not np.array_equal(same_groups(last), same_groups(first))


@pytest.mark.parametrize("order", [[0.0, 1.0, 2.0], [True, False, True], "sideways", [0, 0, 1], [1, 2, 3]])
def test_a_bad_order_is_refused(order):
    with pytest.raises(ValueError, match="order: expected"):
        visiting_order(order, 3)
