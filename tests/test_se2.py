"""SE(2) obeys the laws of a group, and its conventions are the ones we say."""

import numpy as np
import pytest

from npslam_teach import se2

SHAPES = [(), (1,), (7,), (2, 3)]


def random_poses(rng, shape, kind):
    """Ordinary poses, poses next to the identity, and poses whose heading is within rounding of +-pi."""
    poses = rng.normal(scale=5.0, size=(*shape, 3))
    if kind == "tiny":
        return poses * 1e-7
    if kind == "near pi":
        sign = rng.choice([-1.0, 1.0], size=shape)
        poses[..., 2] = sign * np.pi + rng.choice([-1e-7, -1e-15, 0.0, 1e-15, 1e-7], size=shape)
    return poses


def assert_same_pose(a, b, tolerance=1e-12):
    assert a.shape == b.shape
    np.testing.assert_allclose(a[..., :2], b[..., :2], atol=tolerance * (1 + np.abs(b[..., :2]).max(initial=0)), rtol=0)
    # Compare angles on the circle: -pi and pi - 1e-16 are the same heading.
    turn = a[..., 2] - b[..., 2]
    np.testing.assert_allclose(np.exp(1j * turn), np.ones_like(turn), atol=1e-12)


@pytest.fixture(params=["ordinary", "tiny", "near pi"])
def kind(request):
    return request.param


@pytest.fixture(params=SHAPES, ids=str)
def three(request, kind):
    rng = np.random.default_rng(7)
    return [random_poses(rng, request.param, kind) for _ in range(3)]


def test_identity(three):
    a = three[0]
    identity = np.zeros(3)
    assert_same_pose(se2.compose(a, identity), a)
    assert_same_pose(se2.compose(identity, a), a)


def test_inverse(three):
    a = three[0]
    zero = np.zeros_like(a)
    assert_same_pose(se2.compose(a, se2.inverse(a)), zero)
    assert_same_pose(se2.compose(se2.inverse(a), a), zero)
    assert_same_pose(se2.inverse(se2.inverse(a)), a)


def test_associativity(three):
    a, b, c = three
    assert_same_pose(se2.compose(se2.compose(a, b), c), se2.compose(a, se2.compose(b, c)))


def test_between_undoes_compose(three):
    a, b, _ = three
    assert_same_pose(se2.between(a, se2.compose(a, b)), b)


def test_composition_is_the_product_of_homogeneous_matrices(three):
    def matrix(pose):
        x, y, theta = np.moveaxis(np.asarray(pose), -1, 0)
        m = np.zeros((*x.shape, 3, 3))
        m[..., 0, 0] = m[..., 1, 1] = np.cos(theta)
        m[..., 0, 1], m[..., 1, 0] = -np.sin(theta), np.sin(theta)
        m[..., 0, 2], m[..., 1, 2], m[..., 2, 2] = x, y, 1.0
        return m

    a, b, _ = three
    np.testing.assert_allclose(matrix(se2.compose(a, b)), matrix(a) @ matrix(b), atol=1e-11)
    np.testing.assert_allclose(matrix(se2.inverse(a)), np.linalg.inv(matrix(a)), atol=1e-11)


def test_points_travel_there_and_back(three):
    a, b, c = three
    xy = c[..., :2]
    np.testing.assert_allclose(se2.apply_inverse(a, se2.apply(a, xy)), xy, atol=1e-12)
    np.testing.assert_allclose(se2.apply(se2.compose(a, b), xy), se2.apply(a, se2.apply(b, xy)), atol=1e-12)


def test_angles_are_in_the_half_open_interval(three):
    for pose in three:
        for result in (se2.inverse(pose), se2.compose(pose, pose), se2.between(pose, three[0])):
            assert (result[..., 2] >= -np.pi).all()
            assert (result[..., 2] < np.pi).all()


@pytest.mark.parametrize(
    ("angle", "expected"),
    [
        (0.0, 0.0),
        (np.pi, -np.pi),
        (-np.pi, -np.pi),
        (3 * np.pi, -np.pi),
        (np.pi + 0.5, 0.5 - np.pi),
        (-np.pi - 0.5, np.pi - 0.5),
        (7.0, 7.0 - 2 * np.pi),
        (-np.pi - 1e-17, -np.pi),
        (np.nextafter(-np.pi, -4), np.pi),
    ],
)
def test_wrap(angle, expected):
    wrapped = se2.wrap(angle)
    assert -np.pi <= wrapped < np.pi
    assert np.exp(1j * wrapped) == pytest.approx(np.exp(1j * expected), abs=1e-15)


def test_a_quarter_turn_to_the_left_by_hand():
    """Standing at (1, 2) and looking along y, what is 3 m ahead and 1 m to the left is at (0, 5)."""
    pose = np.array([1.0, 2.0, np.pi / 2])
    np.testing.assert_allclose(se2.apply(pose, [3.0, 1.0]), [0.0, 5.0], atol=1e-15)
    np.testing.assert_allclose(se2.apply_inverse(pose, [0.0, 5.0]), [3.0, 1.0], atol=1e-15)


def test_dead_reckoning_is_repeated_composition():
    rng = np.random.default_rng(1)
    odometry = rng.normal(size=(300, 3))
    start = np.array([1.0, -2.0, 3.0])
    poses = [start]
    for step in odometry:
        poses.append(se2.compose(poses[-1], step))
    assert_same_pose(se2.dead_reckoning(odometry, start), np.array(poses), tolerance=1e-10)


def test_dead_reckoning_of_a_square_comes_back():
    square = np.tile([1.0, 0.0, np.pi / 2], (4, 1))
    np.testing.assert_allclose(se2.dead_reckoning(square)[-1, :2], [0.0, 0.0], atol=1e-15)


def test_dead_reckoning_without_steps_stays():
    np.testing.assert_array_equal(se2.dead_reckoning(np.zeros((0, 3)), [1.0, 2.0, 0.5]), [[1.0, 2.0, 0.5]])


def test_align_recovers_a_motion_and_beats_every_other():
    rng = np.random.default_rng(2)
    motion = np.array([3.0, -1.0, 2.5])
    xy = rng.normal(size=(50, 2))
    assert_same_pose(se2.align(xy, se2.apply(motion, xy)), motion)

    noisy = se2.apply(motion, xy) + rng.normal(scale=0.3, size=xy.shape)
    best = se2.align(xy, noisy)

    def cost(pose):
        return ((se2.apply(pose, xy) - noisy) ** 2).sum()

    others = best + rng.normal(scale=0.05, size=(200, 3))
    assert all(cost(best) <= cost(other) for other in others)


def test_inputs_are_left_alone():
    a, b = np.ones(3), np.full(3, 2.0)
    se2.compose(a, b), se2.inverse(a), se2.between(a, b), se2.apply(a, b[:2])
    np.testing.assert_array_equal(a, np.ones(3))
    np.testing.assert_array_equal(b, np.full(3, 2.0))
