"""Rigid motions of the plane, as arrays.

A pose ``[x, y, theta]`` of frame B in frame A is written ``pose_ab`` and takes points of B to points of A:
``xy_a = R(theta) xy_b + [x, y]``. Every function works on a single pose (3,) or a batch (..., 3); leading axes
broadcast. Metres and radians; angles are returned in [-pi, pi).
"""

import numpy as np


def wrap(angle: np.ndarray) -> np.ndarray:
    """Bring angles into [-pi, pi).

    Args:
        angle: (...) rad.
    """
    wrapped = np.mod(np.asarray(angle, dtype=float) + np.pi, 2 * np.pi) - np.pi
    # np.mod of a tiny negative number rounds up to 2 pi itself.
    return np.where(wrapped >= np.pi, -np.pi, wrapped)


def wrap_symmetric(angle: np.ndarray, symmetry: np.ndarray) -> np.ndarray:
    """The smallest turn that looks like this one, of something that looks alike after each n-th part of a full turn.

    Args:
        angle: (...) rad.
        symmetry: (...) n: 1 brings angles into [-pi, pi), 2 into [-pi/2, pi/2); 0, of what is round, makes them 0.
    """
    parts = np.maximum(symmetry, 1)
    return np.where(np.equal(symmetry, 0), 0.0, wrap(parts * np.asarray(angle, dtype=float)) / parts)


def rotate(theta: np.ndarray, xy: np.ndarray) -> np.ndarray:
    """Rotate vectors counter-clockwise: ``R(theta) xy``.

    Args:
        theta: (...) rad.
        xy: (..., 2) m.
    """
    xy = np.asarray(xy, dtype=float)
    cos, sin = np.cos(theta), np.sin(theta)
    x, y = xy[..., 0], xy[..., 1]
    turned_x = np.asarray(cos * x - sin * y)
    turned = np.empty((*turned_x.shape, 2))
    turned[..., 0], turned[..., 1] = turned_x, sin * x + cos * y
    return turned


def compose(pose_ab: np.ndarray, pose_bc: np.ndarray) -> np.ndarray:
    """Chain two motions: ``pose_ac``, first into B, then on into C.

    Args:
        pose_ab: (..., 3) B in A.
        pose_bc: (..., 3) C in B.
    """
    pose_ab, pose_bc = np.asarray(pose_ab, dtype=float), np.asarray(pose_bc, dtype=float)
    xy = pose_ab[..., :2] + rotate(pose_ab[..., 2], pose_bc[..., :2])
    theta = wrap(pose_ab[..., 2] + pose_bc[..., 2])
    return np.concatenate([xy, np.broadcast_to(theta, xy.shape[:-1])[..., None]], axis=-1)


def inverse(pose_ab: np.ndarray) -> np.ndarray:
    """The way back: ``pose_ba``.

    Args:
        pose_ab: (..., 3) B in A.
    """
    pose_ab = np.asarray(pose_ab, dtype=float)
    xy = rotate(-pose_ab[..., 2], -pose_ab[..., :2])
    return np.concatenate([xy, wrap(-pose_ab[..., 2])[..., None]], axis=-1)


def between(pose_ab: np.ndarray, pose_ac: np.ndarray) -> np.ndarray:
    """C as seen from B: ``compose(inverse(pose_ab), pose_ac)``. This is what odometry measures.

    Args:
        pose_ab: (..., 3) B in A.
        pose_ac: (..., 3) C in A.
    """
    return compose(inverse(pose_ab), pose_ac)


def apply(pose_ab: np.ndarray, xy_b: np.ndarray) -> np.ndarray:
    """Carry points from B into A: ``R(theta) xy_b + [x, y]``.

    Args:
        pose_ab: (..., 3) B in A.
        xy_b: (..., 2) m.
    """
    pose_ab = np.asarray(pose_ab, dtype=float)
    return pose_ab[..., :2] + rotate(pose_ab[..., 2], xy_b)


def apply_inverse(pose_ab: np.ndarray, xy_a: np.ndarray) -> np.ndarray:
    """Carry points from A into B: ``R(theta)^T (xy_a - [x, y])``. This is what a camera in B measures.

    Args:
        pose_ab: (..., 3) B in A.
        xy_a: (..., 2) m.
    """
    pose_ab = np.asarray(pose_ab, dtype=float)
    return rotate(-pose_ab[..., 2], np.asarray(xy_a, dtype=float) - pose_ab[..., :2])


def dead_reckoning(odometry: np.ndarray, start: np.ndarray = (0.0, 0.0, 0.0)) -> np.ndarray:
    """Chain odometry steps into a trajectory, believing every one of them (paper section IV: open loop).

    Args:
        odometry: (T-1, 3) each step, R_{t+1} in R_t.
        start: (3,) R_0 in W.

    Returns:
        (T, 3) poses in W.
    """
    odometry = np.asarray(odometry, dtype=float)
    start = np.asarray(start, dtype=float)
    # Headings add up first; then every step can be rotated into W and the positions add up too.
    theta = np.concatenate([start[2:], start[2] + np.cumsum(odometry[:, 2])])
    steps_world = rotate(theta[:-1], odometry[:, :2])
    xy = np.concatenate([start[None, :2], start[:2] + np.cumsum(steps_world, axis=0)])
    return np.column_stack([xy, wrap(theta)])


def interpolate(times: np.ndarray, known: np.ndarray, poses: np.ndarray) -> np.ndarray:
    """Poses at times between those that are known, on straight lines, headings turned the short way.

    Args:
        times: (n,) s.
        known: (m,) s, increasing.
        poses: (m, 3) at these.

    Returns:
        (n, 3); before the first known pose that one, after the last the last.
    """
    columns = [poses[:, 0], poses[:, 1], np.unwrap(poses[:, 2])]
    found = np.column_stack([np.interp(times, known, column) for column in columns])
    found[:, 2] = wrap(found[:, 2])
    return found


def align(xy: np.ndarray, reference_xy: np.ndarray) -> np.ndarray:
    """The rigid motion that carries ``xy`` closest to ``reference_xy`` in the least-squares sense.

    Closed form (Horn 1987; Umeyama 1991 without scale): the rotation follows from the summed products of the centred
    points, the translation from their means.

    Args:
        xy: (N, 2) m.
        reference_xy: (N, 2) m, row for row the same points.

    Returns:
        (3,) pose p such that ``apply(p, xy)`` is nearest to ``reference_xy``.
    """
    xy, reference_xy = np.asarray(xy, dtype=float), np.asarray(reference_xy, dtype=float)
    mean, reference_mean = xy.mean(axis=0), reference_xy.mean(axis=0)
    a, b = xy - mean, reference_xy - reference_mean
    theta = np.arctan2((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum(), (a * b).sum())
    return np.append(reference_mean - rotate(theta, mean), theta)
