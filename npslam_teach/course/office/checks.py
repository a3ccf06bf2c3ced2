"""Checks of lesson 08: pixels, centres, the measures of a result without truth, and a camera's pose on the floor."""

from collections.abc import Iterator

import numpy as np

from npslam_teach.association import false_positives
from npslam_teach.camera import Intrinsics, back_project, foreground, on_floor
from npslam_teach.course.checking import Verdict, array_from, judge, right

_CAMERA = Intrinsics(width=160, height=120, fx=140.0, fy=150.0, cx=81.0, cy=57.5)


def check_pixel_to_point(pixel_to_point) -> Verdict:
    """Exercise 1: ``pixel_to_point(u, v, depth, camera)`` -> (3,) m, right, down, ahead."""

    def trials():
        rng = np.random.default_rng(1)
        for _ in range(5):
            u, v, depth = rng.uniform(0, 159), rng.uniform(0, 119), rng.uniform(0.5, 4.0)
            truth = back_project(u, v, depth, _CAMERA)
            x, y = u - _CAMERA.cx, v - _CAMERA.cy
            mistakes = {
                "the pixel is counted from the corner of the picture; the optical axis goes through (cx, cy)": (
                    [u / _CAMERA.fx * depth, v / _CAMERA.fy * depth, depth]
                ),
                "depth is measured along the optical axis, you took it for the length of the ray": (
                    truth * depth / np.linalg.norm(truth)
                ),
                "the focal length divides: a pixel far from the middle looks further to the side": (
                    [x * _CAMERA.fx * depth, y * _CAMERA.fy * depth, depth]
                ),
                "the direction of the ray is right, now go along it until the depth is reached": (
                    [x / _CAMERA.fx, y / _CAMERA.fy, 1.0]
                ),
                "u counts columns and v counts rows; you have them the other way round": truth[[1, 0, 2]],
            }
            yield (u, v, depth, _CAMERA), truth, mistakes

    return _judge("the point", pixel_to_point, trials(), "a box full of pixels becomes a point cloud")


def check_foreground_centre(foreground_centre) -> Verdict:
    """Exercise 2: ``foreground_centre(points)`` of (N, 3) -> (2,) m, ahead, left."""

    def trials():
        rng = np.random.default_rng(2)
        for _ in range(5):
            front = rng.normal([rng.uniform(-1, 1), 0.3, 2.0], [0.1, 0.2, 0.04], (60, 3))
            # A wall behind, and a few stray readings in front: the nearest point is not the object.
            wall, stray = rng.normal([0.6, 0.0, 3.5], 0.1, (40, 3)), rng.normal([0.0, 0.0, 0.8], 0.02, (3, 3))
            points = rng.permutation(np.concatenate([front, wall, stray]))
            kept = points[foreground(points)].mean(axis=0)
            truth, near = on_floor(kept), points[points[:, 2] < points[:, 2].min() + 0.3]
            mistakes = {
                "this is the mean of the whole box, background and all": on_floor(points.mean(axis=0)),
                "left is the opposite of right: one sign is missing": truth * [1, -1],
                "the order is (ahead, left)": truth[::-1],
                "these are the first two columns, right and down; on the floor count ahead and left": kept[:2],
                "you start from the nearest point of all, and a single stray reading misleads you": (
                    on_floor(near.mean(axis=0))
                ),
            }
            yield (points,), truth, mistakes

    praise = "what stands behind the object no longer pulls its centre away"
    return _judge("the centre", foreground_centre, trials(), praise)


def check_position_variance(position_variance) -> Verdict:
    """Exercise 3: ``position_variance(xy, labels, num_objects)`` -> (K,) m^2."""

    def trials():
        rng = np.random.default_rng(3)
        for _ in range(5):
            num_objects = int(rng.integers(3, 6))
            labels = rng.permutation(np.concatenate([np.arange(num_objects), rng.integers(0, num_objects - 1, 20)]))
            xy = rng.normal(size=(len(labels), 2)) + 3.0 * labels[:, None]
            groups = [xy[labels == k] for k in range(num_objects)]
            truth = np.array([((each - each.mean(axis=0)) ** 2).sum(axis=1).mean() for each in groups])
            total = np.array([((each - each.mean(axis=0)) ** 2).sum() for each in groups])
            mistakes = {
                "this is a standard deviation, in metres: leave out the root": np.sqrt(truth),
                "x and y are averaged; the squared distance is their sum": truth / 2,
                "these are sums: an object seen twice as often must not scatter twice as much": total,
                "the scatter is measured from the origin, not from the object's own mean": (
                    np.array([(each**2).sum(axis=1).mean() for each in groups])
                ),
                "the scatter is measured from the mean of all sightings, not from the object's own": (
                    np.array([((each - xy.mean(axis=0)) ** 2).sum(axis=1).mean() for each in groups])
                ),
                "this is the mean distance; it is to be squared before the mean": (
                    np.array([np.linalg.norm(each - each.mean(axis=0), axis=1).mean() for each in groups])
                ),
            }
            yield (xy, labels, num_objects), truth, mistakes

    praise = "noise, drift that was not repaired and two objects taken for one all show in this number"
    return _judge("the variances", position_variance, trials(), praise)


def check_valid_and_inliers(valid_and_inliers) -> Verdict:
    """Exercise 4: ``valid_and_inliers(votes, epsilon)`` -> number of valid objects, number of their observations."""

    def trials():
        rng = np.random.default_rng(4)
        for _ in range(8):
            votes = np.column_stack([np.ones(12), rng.integers(1, 9, 12), rng.integers(0, 3, (12, 2))]).astype(float)
            # Exactly at the threshold in about half of the cases: such an object stays.
            epsilon = rng.choice([1 / votes[0].sum(), rng.uniform(0.1, 0.3)])
            bad = false_positives(votes, epsilon)
            strict = votes[:, 0] / votes.sum(axis=1) < epsilon
            real, unfair = votes[:, 1:].sum(axis=1), 1 / votes[:, 1:].sum(axis=1)
            truth = np.array([np.count_nonzero(~bad), real[~bad].sum()])
            mistakes = {
                "column 0, the false-positive vote, is nobody's sighting: don't count it": [
                    truth[0],
                    votes[~bad].sum(),
                ],
                "you counted the objects that are rejected": [np.count_nonzero(bad), real[bad].sum()],
                "all sightings are counted, also those of objects that are rejected": [truth[0], real.sum()],
                "an object exactly at epsilon stays: it is rejected when it exceeds epsilon": (
                    [np.count_nonzero(strict), real[strict].sum()]
                ),
                "the posterior is a share of all votes of the object, the false-positive vote included": (
                    [np.count_nonzero(unfair <= epsilon), real[unfair <= epsilon].sum()]
                ),
                "the order is (valid objects, inliers)": truth[::-1],
            }
            yield (votes, epsilon), truth, mistakes

    return _judge("the pair", valid_and_inliers, trials(), "these are two of the paper's three measures")


def check_floor_pose(floor_pose) -> Verdict:
    """Exercise 5: ``floor_pose(T)`` of a camera's (4, 4) -> (3,) x, y, theta."""

    def trials():
        rng = np.random.default_rng(5)
        for heading in (0.4, -0.9, 2.6, -2.8, 1.7):
            tilt = rng.uniform(0.05, 0.2)
            camera = _camera_pose(rng.uniform(-3, 3, 3), heading, tilt)
            x, y = camera[2, 3], -camera[0, 3]
            sideways, ahead = camera[0, 2], camera[2, 2]
            mistakes = {
                "the robot turns the wrong way: left is the opposite of the camera's x axis": [x, y, -heading],
                "arctan of a quotient cannot tell ahead from behind: use arctan2": [x, y, np.arctan(-sideways / ahead)],
                "y is to the left, and the camera's x axis points to the right": [x, -y, heading],
                "the floor is spanned by the camera's z and x axes; you used its first two coordinates": (
                    [camera[0, 3], camera[1, 3], heading]
                ),
                "this is where the camera's y axis points; it looks along its z axis": (
                    [x, y, np.arctan2(-camera[0, 1], camera[2, 1])]
                ),
                "this reads the last row of the rotation; the view direction in the world is its last column": (
                    [x, y, np.arctan2(-camera[2, 0], camera[2, 2])]
                ),
            }
            yield (camera,), np.array([x, y, heading]), mistakes

    praise = "this is how the authors' camera poses become the odometry of a robot on a floor"
    return _judge("the pose", floor_pose, trials(), praise, angle=2)


def _camera_pose(position: np.ndarray, heading: float, tilt: float) -> np.ndarray:
    """A camera (x right, y down, z forward) that looks along ``heading`` and ``tilt`` rad down; (4, 4)."""
    turn = np.array([[np.cos(-heading), 0, np.sin(-heading)], [0, 1, 0], [-np.sin(-heading), 0, np.cos(-heading)]])
    down = np.array([[1, 0, 0], [0, np.cos(tilt), np.sin(tilt)], [0, -np.sin(tilt), np.cos(tilt)]])
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = turn @ down, position
    return pose


def _judge(name: str, function, trials: Iterator[tuple], praise: str, angle: int | None = None) -> Verdict:
    """Run all trials up to the first wrong answer, and name its mistake, or the size of its error.

    Args:
        name: what an answer is called.
        function: the student's.
        trials: of each the arguments, the right answer, and by message what a mistake gives.
        praise: for a right one.
        angle: index of an entry that may differ by whole turns, rad.
    """
    for arguments, truth, mistakes in trials:
        answer, verdict = array_from(name, function, np.shape(truth), *arguments)
        if verdict is not None:
            return verdict
        if angle is not None:
            answer[angle] += 2 * np.pi * np.round((truth[angle] - answer[angle]) / (2 * np.pi))
        difference = f"the largest difference from what it should be is {np.abs(answer - truth).max():.3g}"
        verdict = judge(answer, truth, mistakes, difference, same=_close, like=_close)
        if verdict is not None:
            return verdict
    return right(praise)


def _close(answer: np.ndarray, other) -> bool:
    return np.allclose(answer, other, atol=1e-9)
