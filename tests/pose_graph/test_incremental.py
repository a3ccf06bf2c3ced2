"""The graph that grows: the same answer as all at once, frame after frame."""

import numpy as np
import pytest

from npslam_teach import evaluation, pose_graph, simulate
from npslam_teach.pose_graph import IncrementalSolver

STEP, SIGHT = np.diag([400.0, 400.0, 900.0]), np.diag([50.0, 50.0])


def drive(log, labels, num_poses, solver, after_frame=lambda t: None):
    """Feed the first poses of a log, each object known by its label, to the solver."""
    index = {}
    for t in range(num_poses):
        if t > 0:
            solver.add_pose(log.odometry[t - 1], STEP)
        for k in np.flatnonzero(log.obs_time == t):
            if labels[k] not in index:
                pose = solver.graph.poses[t]
                c, s = np.cos(pose[2]), np.sin(pose[2])
                index[labels[k]] = solver.add_landmark(pose[:2] + np.array([[c, -s], [s, c]]) @ log.obs_xy[k])
            solver.add_observation(t, index[labels[k]], log.obs_xy[k], SIGHT)
        after_frame(t)
    return index


@pytest.fixture(scope="module")
def driven():
    log, truth = simulate.fifteen_objects(0)
    solver = IncrementalSolver(truth.poses[0])
    drive(log, truth.obs_object, 300, solver, lambda t: solver.solve())
    return log, truth, solver


def test_at_the_end_it_equals_the_batch_solution(driven):
    log, truth, solver = driven
    graph = solver.graph
    start = evaluation.true_association_fit(log, truth)
    batch = IncrementalSolver(truth.poses[0])
    drive(log, truth.obs_object, 300, batch)
    assert len(graph.poses) == 300 and len(start.poses) > 300
    solved = pose_graph.optimize(batch.graph)
    assert pose_graph.chi2(graph) == pytest.approx(pose_graph.chi2(solved), rel=1e-6)
    np.testing.assert_allclose(graph.poses, solved.poses, atol=1e-6)
    np.testing.assert_allclose(graph.landmarks, solved.landmarks, atol=1e-6)


def test_every_frame_is_at_its_minimum():
    log, truth = simulate.fifteen_objects(1)
    solver, values = IncrementalSolver(truth.poses[0]), []

    def check(t):
        graph = solver.solve()
        if t % 20 == 10:
            values.append((pose_graph.chi2(graph), pose_graph.chi2(pose_graph.optimize(graph, 1e-13))))

    drive(log, truth.obs_object, 120, solver, check)
    found, least = np.transpose(values)
    assert least[-1] > 10
    np.testing.assert_allclose(found, least, rtol=1e-8, atol=1e-12)


def test_a_frame_without_news_is_not_solved_again(driven, monkeypatch):
    from npslam_teach.pose_graph import incremental

    solver = IncrementalSolver()
    monkeypatch.setattr(incremental, "optimize", lambda *_: pytest.fail("there was nothing to solve"))
    pose = solver.add_pose([1.0, 0.0, 0.5], STEP)
    cup = solver.add_landmark([2.0, 1.0])
    c, s = np.cos(0.5), np.sin(0.5)
    solver.add_observation(pose, cup, [c * 1.0 + s * 1.0, -s * 1.0 + c * 1.0], SIGHT)
    graph = solver.solve()
    np.testing.assert_allclose(graph.poses[1], [1.0, 0.0, 0.5])
    assert pose_graph.chi2(graph) < 1e-18


def test_joint_covariance_is_the_inverse_of_h(driven):
    _, _, solver = driven
    h, _, _ = pose_graph.linearize(solver.graph)
    inverse, num_poses = np.linalg.inv(h.toarray()), len(solver.graph.poses)
    joint = solver.joint_covariance([2, 0])
    pose = 3 * (num_poses - 2) + np.arange(3)
    for landmark, found in zip([2, 0], joint, strict=True):
        unknowns = np.append(pose, 3 * (num_poses - 1) + 2 * landmark + np.arange(2))
        np.testing.assert_allclose(found, inverse[np.ix_(unknowns, unknowns)], rtol=1e-6, atol=1e-10)
    pose_cov, landmark_cov = pose_graph.marginal_covariance(solver.graph, [num_poses - 1], [2, 0])
    np.testing.assert_allclose(joint[:, :3, :3], np.repeat(pose_cov, 2, axis=0), rtol=1e-9)
    np.testing.assert_allclose(joint[:, 3:, 3:], landmark_cov, rtol=1e-9)


def test_pose_zero_is_known_in_a_joint_covariance():
    solver = IncrementalSolver()
    solver.add_observation(0, solver.add_landmark([1.0, 0.0]), [1.0, 0.0], SIGHT)
    joint = solver.joint_covariance([0])
    np.testing.assert_array_equal(joint[0, :3], 0)
    np.testing.assert_allclose(joint[0, 3:, 3:], np.eye(2) / 50)


def test_a_loop_closure_moves_the_path():
    solver = IncrementalSolver()
    for _ in range(4):
        solver.add_pose([1.0, 0.0, np.pi / 2 + 0.05], STEP)
    before = solver.solve().poses
    solver.add_between(4, 0, [0.0, 0.0, 0.0], STEP)
    after = solver.solve().poses
    assert np.linalg.norm(after[4, :2]) < 0.5 * np.linalg.norm(before[4, :2])


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda s: s.add_pose([1.0, 0.0], STEP), "relative_pose: expected shape"),
        (lambda s: s.add_pose([1.0, 0.0, np.nan], STEP), "relative_pose: expected finite"),
        (lambda s: s.add_pose([1.0, 0.0, 0.0], -STEP), "information: expected symmetric positive"),
        (lambda s: s.add_landmark([1.0]), "xy: expected shape"),
        (lambda s: s.add_observation(7, 0, [1.0, 0.0], SIGHT), "pose: expected an index"),
        (lambda s: s.add_observation(0, 7, [1.0, 0.0], SIGHT), "landmark: expected an index"),
        (lambda s: s.add_between(0, 5, [1.0, 0.0, 0.0], STEP), "j: expected an index"),
        (lambda s: s.joint_covariance([9]), "landmarks: expected an index"),
    ],
)
def test_bad_input_is_named_and_changes_nothing(call, message):
    solver = IncrementalSolver()
    solver.add_pose([1.0, 0.0, 0.0], STEP)
    solver.add_observation(1, solver.add_landmark([2.0, 0.0]), [1.0, 0.0], SIGHT)
    with pytest.raises(ValueError, match=message):
        call(solver)
    graph = solver.solve()
    assert (len(graph.poses), len(graph.landmarks), len(graph.observations.pose)) == (2, 1, 1)


def test_a_landmark_that_nobody_saw_is_named():
    solver = IncrementalSolver()
    solver.add_pose([1.0, 0.0, 0.0], STEP)
    solver.add_landmark([2.0, 0.0])
    with pytest.raises(np.linalg.LinAlgError, match="landmark 0 is not tied to pose 0"):
        solver.solve()
