"""Residuals vanish where the measurement fits; Jacobians are the derivatives of the residuals."""

import numpy as np
import pytest

from npslam_teach import pose_graph, se2


def central_differences(function, at, step=1e-6):
    """Column k: how the outcome moves with entry k of ``at``. The outcome's angle is compared on the circle."""
    columns = []
    for k in range(at.shape[-1]):
        ahead, behind = at.copy(), at.copy()
        ahead[..., k] += step
        behind[..., k] -= step
        difference = function(ahead) - function(behind)
        if difference.shape[-1] == 3:
            difference[..., 2] = se2.wrap(difference[..., 2])
        columns.append(difference / (2 * step))
    return np.stack(columns, axis=-1)


@pytest.fixture
def poses():
    rng = np.random.default_rng(3)
    pose_i, pose_j = rng.normal(scale=3.0, size=(2, 200, 3))
    # A third of the headings sit where the angle wraps.
    pose_i[::3, 2] = np.pi - 1e-9
    pose_j[::3, 2] = -np.pi + 1e-9
    return pose_i, pose_j


def test_between_residual_is_zero_for_the_true_step(poses):
    pose_i, pose_j = poses
    np.testing.assert_allclose(pose_graph.between_residual(pose_i, pose_j, se2.between(pose_i, pose_j)), 0, atol=1e-12)


def test_observation_residual_is_zero_for_the_true_observation(poses):
    pose, other = poses
    landmark = other[:, :2]
    measured = se2.apply_inverse(pose, landmark)
    np.testing.assert_allclose(pose_graph.observation_residual(pose, landmark, measured), 0, atol=1e-12)


def test_the_angle_of_a_residual_is_wrapped():
    """Headings of 179 and -179 degrees are two degrees apart."""
    pose_i, pose_j = np.array([0, 0, np.deg2rad(179.0)]), np.array([0, 0, np.deg2rad(-179.0)])
    residual = pose_graph.between_residual(pose_i, pose_j, np.zeros(3))
    assert residual[2] == pytest.approx(np.deg2rad(2.0))
    # The measurement's own angle matters too: 179 degrees measured as -179 is two degrees off as well.
    residual = pose_graph.between_residual(np.zeros(3), pose_i, np.array([0, 0, np.deg2rad(-179.0)]))
    assert residual[2] == pytest.approx(np.deg2rad(-2.0))


@pytest.mark.parametrize(("kind", "size"), [("between", 3), ("observation", 2)])
def test_jacobians_are_the_derivatives_of_the_residual(kind, size, poses):
    residual, jacobians = getattr(pose_graph, f"{kind}_residual"), getattr(pose_graph, f"{kind}_jacobians")
    pose, other = poses[0], poses[1][:, :size]
    measured = np.random.default_rng(4).normal(size=other.shape)
    by_pose, by_other = jacobians(pose, other)
    numeric = central_differences(lambda p: residual(p, other, measured), pose)
    np.testing.assert_allclose(by_pose, numeric, atol=1e-7)
    np.testing.assert_allclose(by_other, central_differences(lambda p: residual(pose, p, measured), other), atol=1e-7)


def test_residuals_do_not_change_when_the_world_is_moved(poses):
    pose_i, pose_j = poses
    motion, landmark, zero = np.array([4.0, -2.0, 1.3]), pose_j[:, :2], np.zeros(3)
    np.testing.assert_allclose(
        pose_graph.between_residual(se2.compose(motion, pose_i), se2.compose(motion, pose_j), zero),
        pose_graph.between_residual(pose_i, pose_j, zero),
        atol=1e-12,
    )
    np.testing.assert_allclose(
        pose_graph.observation_residual(se2.compose(motion, pose_i), se2.apply(motion, landmark), zero[:2]),
        pose_graph.observation_residual(pose_i, landmark, zero[:2]),
        atol=1e-12,
    )
