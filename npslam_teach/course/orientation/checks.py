"""Checks of lesson 14: the smallest turn that looks alike, two kernels, a mean on the circle, one joint distance."""

from collections.abc import Callable
from functools import partial

import numpy as np

from npslam_teach.course import drawings
from npslam_teach.course.checking import Verdict
from npslam_teach.course.trials import Part, check_function, fresh
from npslam_teach.course.verdict_page import exercise


def _wrapped(turn, parts=1):
    """The smallest turn, by a formula of its own: the angle of the point on the circle, turned ``parts`` times."""
    return np.angle(np.exp(1j * parts * np.asarray(turn, dtype=float))) / parts


@exercise("14", 1, of=4)
def check_smallest_turn(smallest_turn: Callable) -> Verdict:
    """Exercise 1: ``smallest_turn(turn, symmetry)``, (N,) rad and n to (N,) rad."""

    def variant(turn, symmetry, change=lambda turn, n: _wrapped(turn, n)):
        return change(turn, symmetry) if symmetry else np.zeros_like(turn)

    mistakes = {
        "nothing is wrapped: a turn of more than half of what looks alike is not the smallest": partial(
            variant, change=lambda t, n: t
        ),
        "the symmetry is not used: this is right for a chair alone": partial(variant, change=lambda t, n: _wrapped(t)),
        "these lie between 0 and 2 pi / n: a small turn to the right must stay small": partial(
            variant, change=lambda t, n: np.mod(t, 2 * np.pi / n)
        ),
        "divide by n again: these are turns of the circle on which all that looks alike is one point": partial(
            variant, change=lambda t, n: n * _wrapped(t, n)
        ),
        "what looks alike comes back after 2 pi / n, not after pi / n": partial(
            variant, change=lambda t, n: _wrapped(t, 2 * n)
        ),
        "the sign is lost: a turn to the right is negative": partial(variant, change=lambda t, n: abs(_wrapped(t, n))),
        "wrap after the multiplication by n, not before: what looks alike is a whole turn then": partial(
            variant, change=lambda t, n: _wrapped(t) / n
        ),
    }
    rng = fresh()
    trials = [(rng.uniform(-7, 7, 9), n) for n in (1, 2, 4, 3)]
    edges = {
        "of something round": [(np.array([0.3, -2.0]), 0)],
        "with no turn at all": [(np.zeros(2), 2)],
        "after many whole turns": [(np.array([20.3, -31.0]), 2)],
    }
    praise = "half a turn of a table is no turn"
    return check_function(
        smallest_turn, variant, Part("your turns", mistakes), trials, edges, praise, drawings.smallest_turn()
    )


@exercise("14", 2, of=4)
def check_oriented_weights(oriented_weights: Callable) -> Verdict:
    """Exercise 2: ``oriented_weights(votes, distance, turn, kernel_std, heading_std)``, all (K,) but the widths."""

    def variant(votes, distance, turn, kernel_std, heading_std, half=0.5, of_turn=1.0, of_place=1.0, heading_power=2):
        place = of_place * (distance / kernel_std) ** 2
        return votes * np.exp(-half * (place + of_turn * turn**2 / heading_std**heading_power))

    mistakes = {
        "the heading is not used": partial(variant, of_turn=0.0),
        "the position is not used": partial(variant, of_place=0.0),
        "the votes are missing": lambda v, d, t, s, h: variant(1.0, d, t, s, h),
        "the 2 under both squares is missing": partial(variant, half=1.0),
        "kernels of independent errors multiply, they do not add": lambda v, d, t, s, h: (
            v * (np.exp(-(d**2) / (2 * s**2)) + np.exp(-(t**2) / (2 * h**2)))
        ),
        "divide the squared turn by the square of its width": partial(variant, heading_power=1),
        "the turn is not squared": lambda v, d, t, s, h: v * np.exp(-(d**2) / (2 * s**2) - np.abs(t) / (2 * h**2)),
        "each width belongs to the other: metres by metres, radians by radians": lambda v, d, t, s, h: variant(
            v, d, t, h, s
        ),
    }
    rng, trials = fresh(), []
    for k in (1, 2, 3, 6):
        votes = rng.integers(1, 30, k).astype(float)
        trials.append(
            (votes, rng.uniform(0, 1, k), rng.uniform(-1, 1, k), rng.uniform(0.2, 0.6), rng.uniform(0.7, 1.5))
        )
    edges = {
        "with no object": [(np.zeros(0), np.zeros(0), np.zeros(0), 0.4, 0.3)],
        "with an object without votes": [(np.array([0.0, 2.0]), np.ones(2), np.ones(2), 0.5, 0.5)],
    }
    praise = "position and heading err independently, so their kernels multiply"
    return check_function(oriented_weights, variant, Part("your weights", mistakes), trials, edges, praise)


@exercise("14", 3, of=4)
def check_mean_heading(mean_heading: Callable) -> Verdict:
    """Exercise 3: ``mean_heading(theta, symmetry)``, (N,) rad and n to rad in [-pi/n, pi/n)."""

    def variant(theta, symmetry, circle=1.0, divided=True):
        parts = symmetry if circle else 1
        angle = np.angle(np.exp(1j * parts * theta).sum())
        return angle / parts if divided else angle

    mistakes = {
        "this is the mean of the numbers: 179 and -179 degrees have the mean 180, not 0": lambda t, n: t.mean(),
        "this is the median of the numbers, which does not know the circle": lambda t, n: np.median(t),
        "the symmetry is not used: headings that look alike must be one angle before they are averaged": partial(
            variant, circle=0.0
        ),
        "divide the angle by n again": partial(variant, divided=False),
        "sine and cosine are exchanged": lambda t, n: np.arctan2(np.cos(n * t).sum(), np.sin(n * t).sum()) / n,
        "each heading is wrapped here, and then the numbers are averaged: that fails at the seam": lambda t, n: (
            _wrapped(t, n).mean()
        ),
        "this is the first heading": lambda t, n: _wrapped(t[:1], n)[0],
    }
    rng, trials = fresh(), []
    for n, count in ((1, 5), (2, 7), (4, 9), (2, 4), (3, 6)):
        # Around the seam, so that no mean of numbers is right; never on it, where two answers are the same angle.
        middle = (np.pi - rng.choice([-1, 1]) * rng.uniform(0.06, 0.1)) / n
        trials.append((middle + 0.2 / n * rng.normal(size=count) + 2 * np.pi / n * rng.integers(-3, 3, count), n))
    trials = [each for each in trials if abs(abs(variant(*each)) - np.pi / each[1]) > 1e-6]
    edges = {
        "with one heading": [(np.array([0.4]), 2)],
        "with headings that are all the same": [(np.full(4, -1.2), 1)],
    }
    praise = "turned n times as far, all that looks alike is one point, and points on a circle have a mean"
    return check_function(mean_heading, variant, Part("your mean", mistakes), trials, edges, praise)


@exercise("14", 4, of=4)
def check_joint_distance(joint_distance: Callable) -> Verdict:
    """Exercise 4: ``joint_distance(seen, expected, cov, symmetry)``, the squared distance of place and heading."""

    def innovation(seen, expected, symmetry, wrapped=True):
        off = seen - expected
        off[2] = _wrapped(off[2], symmetry) if wrapped else off[2]
        return off

    def variant(seen, expected, cov, symmetry, metric=np.linalg.inv, wrapped=True, parts=None, size=3):
        off = innovation(seen, expected, symmetry if parts is None else parts, wrapped)[:size]
        return off @ metric(cov[:size, :size]) @ off

    mistakes = {
        "the difference of headings is not wrapped": partial(variant, wrapped=False),
        "the difference of headings is wrapped as if nothing looked alike": partial(variant, parts=1),
        "the covariance is to be inverted": partial(variant, metric=lambda cov: cov),
        "only the diagonal of the covariance is used: place and heading err together": partial(
            variant, metric=lambda cov: np.diag(1 / np.diag(cov))
        ),
        "only the place is used": partial(variant, size=2),
        "this is the distance: it is to be squared": lambda *given: np.sqrt(variant(*given)),
        "place and heading are judged apart here: their errors are correlated": lambda s, e, c, n: (
            variant(s, e, c, n, size=2) + innovation(s, e, n)[2] ** 2 / c[2, 2]
        ),
        "distances are of what was seen less what was expected, not of the sum": lambda s, e, c, n: variant(
            s, -e, c, n
        ),
    }
    rng, trials = fresh(), []
    for n in (1, 2, 4, 2, 1):
        root, expected = rng.normal(size=(3, 3)), rng.normal(size=3)
        # A difference that has to be wrapped, and is not at the seam.
        turn = rng.uniform(-0.6, 0.6) / n + rng.choice([-2, 2]) * np.pi + 2 * np.pi / n
        trials.append((expected + np.append(rng.normal(size=2), turn), expected, root @ root.T + np.eye(3), n))
    edges = {
        "at the expected place": [(np.array([1.0, 2.0, 0.5]), np.array([1.0, 2.0, 0.5]), np.eye(3), 1)],
        "with half a turn of a table": [(np.array([1.0, 0.0, np.pi + 0.1]), np.array([0.5, 0.0, 0.0]), np.eye(3), 2)],
    }
    praise = "one innovation of three numbers, whose errors hang together through the robot's own heading"
    return check_function(joint_distance, variant, Part("your distance", mistakes), trials, edges, praise)
