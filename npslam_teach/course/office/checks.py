"""Checks of lesson 08: pixels, centres, the measures of a result without truth, and a camera's pose on the floor."""

from collections.abc import Callable

import numpy as np

from npslam_teach.association import false_positives
from npslam_teach.camera import Intrinsics, back_project, foreground, on_floor
from npslam_teach.course import drawings
from npslam_teach.course.checking import Verdict, as_array
from npslam_teach.course.comparing import close, exactly
from npslam_teach.course.office.check_inputs import at_the_reach, box_before_a_wall, position_variance_inputs, slope
from npslam_teach.course.trials import Part, check_function, fresh
from npslam_teach.course.verdict_page import exercise


@exercise("08", 1, of=5)
def check_pixel_to_point(pixel_to_point: Callable) -> Verdict:
    """Exercise 1: ``pixel_to_point(u, v, depth, camera)`` -> (3,) m, right, down, ahead."""

    def truth(u, v, depth, camera):
        return back_project(u, v, depth, camera)

    mistakes = {
        "the pixel is counted from the corner of the picture; the optical axis goes through (cx, cy)": (
            lambda u, v, z, c: [u / c.fx * z, v / c.fy * z, z]
        ),
        "depth is measured along the optical axis, you took it for the length of the ray": lambda *t: (
            truth(*t) * t[2] / np.linalg.norm(truth(*t))
        ),
        "the focal length divides: a pixel far from the middle looks further to the side": lambda u, v, z, c: (
            [(u - c.cx) * c.fx * z, (v - c.cy) * c.fy * z, z]
        ),
        "the direction of the ray is right, now go along it until the depth is reached": lambda u, v, z, c: (
            [(u - c.cx) / c.fx, (v - c.cy) / c.fy, 1.0]
        ),
        "u counts columns and v counts rows; you have them the other way round": lambda *t: truth(*t)[[1, 0, 2]],
    }
    rng, trials = fresh(), []
    for _ in range(8):
        fx, fy, cx, cy = rng.uniform([120, 120, 70, 50], [180, 180, 90, 70]).tolist()
        camera = Intrinsics(width=160, height=120, fx=fx, fy=fy, cx=cx, cy=cy)
        trials.append((*rng.uniform([0, 0, 0.5], [159, 119, 4.0]).tolist(), camera))
    camera = trials[0][-1]
    edges = {"with the pixel on the optical axis": [(camera.cx, camera.cy, 2.0, camera)]}
    praise = "a box full of pixels becomes a point cloud"
    return check_function(pixel_to_point, truth, Part("the point", mistakes), trials, edges, praise)


@exercise("08", 2, of=5)
def check_foreground_centre(foreground_centre: Callable) -> Verdict:
    """Exercise 2: ``foreground_centre(points)`` of (N, 3) -> (2,) m, ahead, left."""

    def truth(points):
        return on_floor(_kept_mean(points))

    mistakes = {
        "this is the mean of the whole box, background and all": lambda p: on_floor(p.mean(axis=0)),
        "left is the opposite of right: one sign is missing": lambda p: truth(p) * [1, -1],
        "the order is (ahead, left)": lambda p: truth(p)[::-1],
        "these are the first two columns, right and down; on the floor count ahead and left": lambda p: _kept_mean(p)[
            :2
        ],
        "you start from the nearest point of all, and a single stray reading misleads you": lambda p: on_floor(
            p[p[:, 2] < p[:, 2].min() + 0.3].mean(axis=0)
        ),
        "this is the median of what is kept; the mean is asked for": lambda p: on_floor(
            np.median(p[foreground(p)], axis=0)
        ),
        "you start from the median depth; the 0.4-quantile is asked for": lambda p: on_floor(
            p[np.abs(p[:, 2] - np.median(p[:, 2])) < 0.3].mean(axis=0)
        ),
    }
    trials = [(points,) for _ in range(4) for points in (box_before_a_wall(), slope())]
    edges = {
        "with points 2 mm within 0.3 m and 2 mm beyond it": [(at_the_reach(),)],
        "with a single point": [(np.array([[0.4, 0.1, 2.0]]),)],
        "with all points at one depth": [(np.array([[0.4, 0.1, 2.0], [0.8, 0.0, 2.0], [-0.3, 0.2, 2.0]]),)],
    }
    praise = "what stands behind the object no longer pulls its centre away"
    return check_function(foreground_centre, truth, Part("the centre", mistakes), trials, edges, praise)


def _kept_mean(points: np.ndarray) -> np.ndarray:
    return points[foreground(points)].mean(axis=0)


@exercise("08", 4, of=5)
def check_position_variance(position_variance: Callable) -> Verdict:
    """Exercise 4: ``position_variance(xy, labels, num_objects)`` -> (K,) m^2."""

    def truth(xy, labels, num_objects):
        return _each(xy, labels, num_objects, lambda off: (off**2).sum(axis=1).mean())

    mistakes = {
        "this is a standard deviation, in metres: leave out the root": lambda *t: np.sqrt(truth(*t)),
        "x and y are averaged; the squared distance is their sum": lambda *t: truth(*t) / 2,
        "these are sums: an object seen twice as often must not scatter twice as much": lambda *t: _each(
            *t, lambda off: (off**2).sum()
        ),
        "the sum is divided by one less than the number of sightings; the mean is asked for": lambda *t: _each(
            *t, lambda off: (off**2).sum() / max(len(off) - 1, 1)
        ),
        "the scatter is measured from the origin, not from the object's own mean": lambda xy, labels, n: _each(
            xy, labels, n, lambda off: (off**2).sum(axis=1).mean(), around=np.zeros(2)
        ),
        "the scatter is measured from the mean of all sightings, not from the object's own": lambda xy, labels, n: (
            _each(xy, labels, n, lambda off: (off**2).sum(axis=1).mean(), around=xy.mean(axis=0))
        ),
        "this is the mean distance; it is to be squared before the mean": lambda *t: _each(
            *t, lambda off: np.linalg.norm(off, axis=1).mean()
        ),
    }
    part = Part("the variances", mistakes, _none_is_zero, read=_read_variances)
    praise = "noise, drift that was not repaired and two objects taken for one all show in this number"
    return check_function(position_variance, truth, part, *position_variance_inputs(), praise)


def _each(xy: np.ndarray, labels: np.ndarray, num_objects: int, size: Callable, around=None) -> np.ndarray:
    """Of every object the size of its scatter; NaN where there is none."""
    groups = [xy[labels == k] for k in range(num_objects)]
    return np.array([size(x - (x.mean(axis=0) if around is None else around)) if len(x) else np.nan for x in groups])


def _none_is_zero(answer: np.ndarray, truth, tolerance: float) -> bool:
    return close(answer, np.nan_to_num(truth), tolerance)


def _read_variances(name: str, answer, shape: tuple):
    """NaN for the last object, which may have no sighting, is read as zero."""
    try:
        gap = np.isnan(np.asarray(answer, dtype=float))
        answer = np.where(gap, 0.0, answer) if gap.ndim == 1 and not gap[:-1].any() and len(gap) > 1 else answer
    except (TypeError, ValueError, OverflowError):
        pass  # as_array says what it is
    return as_array(name, answer, shape)


@exercise("08", 3, of=5)
def check_valid_and_inliers(valid_and_inliers: Callable) -> Verdict:
    """Exercise 3: ``valid_and_inliers(votes, epsilon)`` -> number of valid objects, number of their observations."""

    def truth(votes, epsilon):
        return counted(votes, ~false_positives(votes, epsilon))

    def counted(votes, valid):
        return [np.count_nonzero(valid), votes[valid, 1:].sum()]

    mistakes = {
        "the false-positive vote in column 0 is nobody's sighting: count the other columns": lambda v, e: (
            [truth(v, e)[0], v[~false_positives(v, e)].sum()]
        ),
        "these are the objects that are rejected": lambda v, e: counted(v, false_positives(v, e)),
        "all sightings are counted, also those of objects that are rejected": lambda v, e: (
            [truth(v, e)[0], v[:, 1:].sum()]
        ),
        "an object exactly at epsilon stays: it is rejected when it exceeds epsilon": lambda v, e: counted(
            v, v[:, 0] / v.sum(axis=1) < e
        ),
        "the posterior is a share of all votes of the object, the false-positive vote included": lambda v, e: counted(
            v, v[:, 0] / v[:, 1:].sum(axis=1) <= e
        ),
        "the order is (valid objects, inliers)": lambda v, e: truth(v, e)[::-1],
    }
    rng, trials = fresh(), []
    # At powers of two an object can be exactly at the threshold, whatever the rounding: such an object stays.
    for epsilon in (0.25, 0.125, 0.5, 0.25, *rng.uniform(0.1, 0.3, 6)):
        votes = np.column_stack([np.ones(12), rng.integers(1, 9, 12), rng.integers(0, 3, (12, 2))]).astype(float)
        votes[:3, 1:] = [[1, 0, 0], [2, 1, 0], [5, 0, 2]]
        trials.append((votes, float(epsilon)))
    edges = {
        "with objects that nobody has seen": [(np.array([[1.0, 0.0, 0.0], [1.0, 7.0, 0.0]]), 0.4)],
        "with no valid object": [(np.array([[1.0, 1.0, 0.0], [1.0, 0.0, 1.0]]), 0.3)],
        "with no object": [(np.empty((0, 4)), 0.3)],
        "with thousands of sightings": [(np.array([[1.0, 7000.0, 40.0], [1.0, 1.0, 0.0]]), 0.1)],
    }
    praise = "these are two of the paper's three measures"
    return check_function(valid_and_inliers, truth, Part("the pair", mistakes, exactly), trials, edges, praise)


@exercise("08", 5, of=5)
def check_floor_pose(floor_pose: Callable) -> Verdict:
    """Exercise 5: ``floor_pose(T)`` of a camera's (4, 4) -> (3,) x, y, theta."""

    def truth(T):
        return np.array([T[2, 3], -T[0, 3], np.arctan2(-T[0, 2], T[2, 2])])

    mistakes = {
        "the robot turns the wrong way: left is the opposite of the camera's x axis": lambda T: truth(T) * [1, 1, -1],
        "arctan of a quotient cannot tell ahead from behind: use arctan2": lambda T: (
            [*truth(T)[:2], np.arctan(-T[0, 2] / T[2, 2])]
        ),
        "y is to the left, and the camera's x axis points to the right": lambda T: truth(T) * [1, -1, 1],
        "the floor is spanned by the camera's z and x axes; you used its first two coordinates": lambda T: (
            [T[0, 3], T[1, 3], truth(T)[2]]
        ),
        "this is where the camera's y axis points; it looks along its z axis": lambda T: (
            [*truth(T)[:2], np.arctan2(-T[0, 1], T[2, 1])]
        ),
        "this reads the last row of the rotation; the view direction in the world is its last column": lambda T: (
            [*truth(T)[:2], np.arctan2(-T[2, 0], T[2, 2])]
        ),
    }
    rng = fresh()
    headings = (0.4, -0.9, 2.6, -2.8, 1.7, *rng.uniform(-np.pi, np.pi, 5))
    trials = [(_camera_pose(rng.uniform(-3, 3, 3), each, rng.uniform(0.05, 0.2)),) for each in headings]
    edges = {"for the first camera": [(np.eye(4),)], "looking back": [(_camera_pose(np.zeros(3), 3.0, 0.0),)]}
    praise = "this is how the authors' camera poses become the odometry of a robot on a floor"
    return check_function(
        floor_pose, truth, Part("the pose", mistakes, _same_pose), trials, edges, praise, drawings.floor_pose()
    )


def _same_pose(answer: np.ndarray, truth, tolerance: float) -> bool:
    """The heading, a direction, may be any of its numbers."""
    if answer.shape != np.shape(truth):
        return False
    difference = answer - truth
    difference[2] -= 2 * np.pi * np.round(difference[2] / (2 * np.pi))
    return bool(np.abs(difference).max() < 5 * tolerance)


def _camera_pose(position: np.ndarray, heading: float, tilt: float) -> np.ndarray:
    """A camera (x right, y down, z forward) that looks along ``heading`` and ``tilt`` rad down; (4, 4)."""
    turn = np.array([[np.cos(-heading), 0, np.sin(-heading)], [0, 1, 0], [-np.sin(-heading), 0, np.cos(-heading)]])
    down = np.array([[1, 0, 0], [0, np.cos(tilt), np.sin(tilt)], [0, -np.sin(tilt), np.cos(tilt)]])
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = turn @ down, position
    return pose
