"""The graph in a tree of submaps: what the batch solver says, whatever was cut, merged or looked at; little work."""

import math

import numpy as np
import pytest

from npslam_teach import pose_graph, se2, simulate
from npslam_teach.methods.gating import frames_of
from npslam_teach.pose_graph import SubmapTree, stretches
from npslam_teach.pose_graph.submaps import eliminate, seen_from_seam
from npslam_teach.types import RobotLog

STEP, SIGHT = np.diag([400.0, 400.0, 900.0]), np.array([[50.0, 10.0], [10.0, 40.0]])


def drive(tree, log, labels, num_poses, after_frame=lambda t: None):
    """Feed the first poses of a log to the tree, each object known by its label; the landmark of each label."""
    index = {}
    for t, frame in enumerate(frames_of(log)[:num_poses]):
        if t > 0:
            tree.add_pose(log.odometry[t - 1], STEP)
        for k in frame:
            if labels[k] not in index:
                index[labels[k]] = tree.add_landmark(se2.apply(tree.pose, log.obs_xy[k]))
            tree.add_observation(index[labels[k]], log.obs_xy[k], SIGHT)
        after_frame(t)
    return index


@pytest.fixture(scope="module")
def scene():
    return simulate.fifteen_objects(0)


@pytest.mark.parametrize(("stretch", "num_poses"), [(1, 40), (5, 220), (32, 702), (1000, 150)])
def test_it_finishes_at_the_minimum_of_the_batch_solver(scene, stretch, num_poses):
    log, truth = scene
    tree = SubmapTree(stretch)
    drive(tree, log, truth.obs_object, num_poses, lambda t: tree.solve())
    start, number = tree.graph()
    assert len(start.poses) == num_poses and (number >= 0).all()
    *_, own = (tree.linearized_anew() for _ in range(6))
    found, least = tree.finish(), pose_graph.optimize(start, 1e-13)
    assert pose_graph.chi2(least) > 10
    assert pose_graph.chi2(own) == pytest.approx(pose_graph.chi2(least), rel=1e-4)
    assert pose_graph.chi2(found) == pytest.approx(pose_graph.chi2(least), rel=1e-9)
    np.testing.assert_allclose(found.poses, least.poses, atol=1e-6)
    np.testing.assert_allclose(found.landmarks, least.landmarks, atol=1e-6)


def test_before_it_is_finished_it_is_within_a_small_part_of_a_standard_deviation(scene):
    """Frame after frame, with what it redoes in bounded time alone."""
    log, truth = scene
    tree, off = SubmapTree(), []

    def compare(t):
        tree.solve()
        if t % 100 == 99:
            graph, _ = tree.graph()
            best = pose_graph.optimize(graph)
            cov, _ = pose_graph.marginal_covariance(best, [t], [])
            d = tree.pose - best.poses[t]
            off.append(math.sqrt(d @ np.linalg.solve(cov[0], d)))

    drive(tree, log, truth.obs_object, 702, compare)
    assert len(off) == 7 and max(off) < 0.5
    assert np.median(off) < 0.1


def test_all_poses_are_told_where_a_look_finds_a_bent_stretch(scene, monkeypatch):
    """What the look before has found bent is linearized anew with the next frame, and not before that is told."""
    monkeypatch.setattr(stretches, "LARGEST_TURN", 0.0)
    monkeypatch.setattr(stretches, "NONLINEAR", math.inf)
    log, truth = scene
    tree, lengths = SubmapTree(5), []

    def look(t):
        if t % 12 == 0:  # in between stretches come to their end, and nobody solves
            lengths.append(len(tree.graph()[0].poses) - t - 1)

    drive(tree, log, truth.obs_object, 120, look)
    assert lengths == [0] * 10


def circuit(seed):
    """Around a ring of posts and a little farther, with steps whose heading is poor: (T, 3) poses, odometry, posts."""
    rng, std, num_poses = np.random.default_rng(seed), np.array([0.02, 0.02, 0.12]), 400
    steps = np.tile([24 * np.pi / (num_poses - 40), 0.0, 2 * np.pi / (num_poses - 40)], (num_poses - 1, 1))
    poses = se2.dead_reckoning(steps)
    posts = np.array([se2.apply(pose, [1.5, side]) for pose, side in zip(poses[:360:6], 30 * [1.0, -1.0], strict=True)])
    return poses, steps + rng.normal(size=steps.shape) * std, np.diag(std**-2.0), posts, rng


@pytest.mark.parametrize("seed", range(3))
def test_what_was_linearized_at_different_times_holds_no_information_that_nobody_measured(seed):
    """A closed loop: the pose's covariance is that of the batch, and with nothing new it rests at the minimum."""
    poses, odometry, step, posts, rng = circuit(seed)
    tree, index = SubmapTree(8), {}
    for t, pose in enumerate(poses):
        if t > 0:
            tree.add_pose(odometry[t - 1], step)
        seen = se2.apply_inverse(pose, posts)
        distance = np.linalg.norm(seen, axis=1)
        for k in np.flatnonzero((distance < 2.5) & (seen[:, 0] > 0)):
            xy = seen[k] + rng.normal(scale=0.1, size=2)
            if k not in index:
                index[k] = tree.add_landmark(se2.apply(tree.pose, xy))
            tree.add_observation(index[k], xy, 100.0 * np.eye(2))
        tree.activate([landmark for k, landmark in index.items() if distance[k] > 3.0], False)
        tree.solve()
    rest = np.array([tree.solve().copy() for _ in range(20)])
    best = pose_graph.optimize(tree.graph()[0])
    (cov,), _ = pose_graph.marginal_covariance(best, [len(poses) - 1], [])
    std, part = np.sqrt(np.diag(cov)), tree.front()
    np.testing.assert_allclose(np.sqrt(np.diag(np.linalg.inv(part.information))[:3]), std, rtol=0.1)
    assert (np.abs(rest - best.poses[-1]) < 0.5 * std).all()
    assert (np.ptp(rest[10:], axis=0) < 0.02 * std).all()


def consistent_log():
    """Measurements without any error: every linear model is exact in value and slope, and no force bends anything."""
    log, truth = simulate.fifteen_objects(3)
    odometry = se2.between(truth.poses[:-1], truth.poses[1:])
    seen = np.flatnonzero(truth.obs_object >= 0)
    xy = se2.apply_inverse(truth.poses[log.obs_time[seen]], truth.world.object_xy[truth.obs_object[seen]])
    times, labels = log.obs_time[seen], truth.obs_object[seen]
    noise = log.odometry_std, log.observation_std
    return RobotLog(odometry, times, xy, log.obs_class[seen], log.num_classes, *noise), labels


@pytest.mark.parametrize("stretch", [3, 16])
def test_the_front_is_the_marginal_of_the_whole_graph(stretch):
    log, labels = consistent_log()
    tree, compared = SubmapTree(stretch), []

    def compare(t):
        tree.solve()
        if t % 40 == 39:
            tree.activate(np.flatnonzero(tree.is_active())[::2], False)
            tree.activate(np.flatnonzero(~tree.is_active())[:2])
            part = tree.front()
            graph, number = tree.graph()
            assert pose_graph.chi2(graph) < 1e-12
            inverse = np.linalg.inv(pose_graph.linearize(graph)[0].toarray())
            landmarks = 3 * t + 2 * number[part.ids][:, None] + np.array([0, 1])
            which = np.append(3 * t - 3 + np.arange(3), landmarks.ravel())
            compared.append((np.linalg.inv(part.information), inverse[np.ix_(which, which)]))

    drive(tree, log, labels, 200, compare)
    assert max(len(found) for found, _ in compared) > 9
    for found, expected in compared:
        np.testing.assert_allclose(found, expected, rtol=1e-6, atol=1e-9 * np.abs(expected).max())


def test_landmarks_that_are_merged_later_are_as_if_they_had_been_one_from_the_start(scene):
    log, truth = scene
    halves = 2 * truth.obs_object + (np.arange(log.num_observations) % 2)
    tree, whole = SubmapTree(8), SubmapTree(8)
    index = drive(tree, log, halves, 300, lambda t: tree.solve())
    for obj in np.unique(truth.obs_object):
        if {2 * obj, 2 * obj + 1} <= set(index):
            stays, gone = sorted((index[2 * obj], index[2 * obj + 1]))
            tree.merge(gone, stays)
            tree.solve()
    drive(whole, log, truth.obs_object, 300, lambda t: whole.solve())
    found, expected = tree.finish(), whole.finish()
    assert len(found.landmarks) == len(expected.landmarks)
    assert pose_graph.chi2(found) == pytest.approx(pose_graph.chi2(expected), rel=1e-9)
    np.testing.assert_allclose(found.poses, expected.poses, atol=1e-6)


def test_what_was_active_on_the_way_changes_nothing():
    log, labels = consistent_log()
    always, never = SubmapTree(16), SubmapTree(16)
    drive(always, log, labels, 250)
    drive(never, log, labels, 250, lambda t: never.activate(np.flatnonzero(never.is_active()), False))
    assert never.is_active().sum() == 0 < always.is_active().sum()
    never.activate(np.flatnonzero(always.is_active()))
    found, expected = never.front(), always.front()
    np.testing.assert_array_equal(found.ids, expected.ids)
    np.testing.assert_allclose(found.at, expected.at, atol=1e-9)
    np.testing.assert_allclose(found.information, expected.information, rtol=1e-7, atol=1e-4)


def test_the_work_of_a_frame_does_not_grow_with_the_drive():
    """A corridor: whatever is behind is behind. Counted in condensed submaps, so that no clock is asked."""
    tree, work = SubmapTree(8), []
    for t in range(800):
        tree.add_pose([0.1, 0.0, 0.0], STEP)
        if t % 5 == 0:
            post = tree.add_landmark(tree.pose[:2] + [0.5, 1.0])
            tree.activate(np.arange(post - 3, post)[:1], False) if post > 3 else None
        tree.add_observation(post, se2.apply_inverse(tree.pose, tree.landmarks()[post]), SIGHT)
        before = tree.redone
        tree.solve()
        work.append(tree.redone - before)
    depth = math.ceil(math.log2(800 / 8))
    assert max(work) <= 6 * (2 * depth + 2)
    assert np.mean(work[600:]) < 1.5 * np.mean(work[200:400])
    assert tree.redone < 0.1 * 1600 * 800 / 8  # what solving everything anew would redo, fivefold and more


def test_an_old_landmark_costs_its_way_up():
    tree = SubmapTree(4)
    first = tree.add_landmark([1.0, 0.5])
    tree.add_observation(first, [1.0, 0.5], SIGHT)
    for _ in range(256):
        tree.add_pose([0.1, 0.0, 2 * np.pi / 256], STEP)
        tree.activate([first], False)
        tree.solve()
    before = tree.redone
    tree.add_observation(first, se2.apply_inverse(tree.pose, [1.0, 0.5]), SIGHT)
    tree.solve()
    assert tree.redone - before <= 6 * (2 * math.log2(256 / 4) + 2) < 256 / 4 * 2
    found, least = tree.finish(), pose_graph.optimize(tree.graph()[0])
    np.testing.assert_allclose(found.poses, least.poses, atol=1e-6)


def test_a_drive_of_one_pose_and_one_without_observations():
    tree = SubmapTree()
    chair = tree.add_landmark([0.0, 0.0])
    tree.add_observation(chair, [2.0, 1.0], SIGHT)
    np.testing.assert_array_equal(tree.solve(), np.zeros(3))
    np.testing.assert_allclose(tree.finish().landmarks, [[2.0, 1.0]], atol=1e-12)
    tree = SubmapTree(2)
    for _ in range(5):
        tree.add_pose([1.0, 0.0, np.pi / 2], STEP)
        tree.solve()
    np.testing.assert_allclose(
        tree.finish().poses, se2.dead_reckoning(np.tile([1.0, 0.0, np.pi / 2], (5, 1))), atol=1e-9
    )


@pytest.mark.parametrize("seed", range(20))
def test_elimination_is_minimisation(seed):
    """What is left is the least that the others allow, and they are where it is least."""
    rng = np.random.default_rng(seed)
    root, gradient = rng.normal(size=(9, 9)), rng.normal(size=9)
    information, inside = root @ root.T + 0.1 * np.eye(9), rng.permutation(9)[: rng.integers(0, 9)]
    outside = np.setdiff1d(np.arange(9), inside)
    left = eliminate(information, gradient, 2.0, inside, outside)
    d = np.zeros(9)
    d[outside] = rng.normal(size=len(outside))
    d[inside] = left.inside(d[outside])
    assert 2.0 + 2 * gradient @ d + d @ information @ d == pytest.approx(
        left.constant + 2 * left.gradient @ d[outside] + d[outside] @ left.information @ d[outside]
    )
    np.testing.assert_allclose((gradient + information @ d)[inside], 0.0, atol=1e-8)


@pytest.mark.parametrize("seed", range(10))
def test_derivatives_at_a_seam_are_differences(seed):
    rng = np.random.default_rng(seed)
    values = rng.normal(size=12)
    _, jacobian = seen_from_seam(values)
    for i, step in enumerate(1e-6 * np.eye(12)):
        slope = (seen_from_seam(values + step)[0] - seen_from_seam(values - step)[0]) / 2e-6
        np.testing.assert_allclose(jacobian[:, i], slope, atol=1e-8)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda tree: tree.add_pose([1.0, 0.0], STEP), "relative_pose: expected shape"),
        (lambda tree: tree.add_pose([1.0, 0.0, np.nan], STEP), "relative_pose: expected finite"),
        (lambda tree: tree.add_pose([1.0, 0.0, 0.0], -STEP), "information: expected"),
        (lambda tree: tree.add_landmark([1.0]), "xy: expected shape"),
        (lambda tree: tree.add_observation(7, [1.0, 0.0], SIGHT), "landmark: expected an index"),
        (lambda tree: tree.add_observation(0, [1.0, 0.0], -SIGHT), "information: expected"),
    ],
)
def test_bad_input_is_named_and_changes_nothing(call, message):
    tree = SubmapTree()
    tree.add_observation(tree.add_landmark([2.0, 0.0]), [2.0, 0.0], SIGHT)
    tree.add_pose([1.0, 0.0, 0.0], STEP)
    with pytest.raises(ValueError, match=message):
        call(tree)
    graph = tree.finish()
    assert (len(graph.poses), len(graph.landmarks), len(graph.observations.pose)) == (2, 1, 1)
