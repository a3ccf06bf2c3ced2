"""Checks of lesson 09: the Kalman gain, Mahalanobis distance, matching a frame, a new object, and NIS bounds."""

from collections.abc import Callable
from functools import partial
from itertools import permutations

import numpy as np

from npslam_teach import se2
from npslam_teach.course import drawings
from npslam_teach.course.checking import Verdict
from npslam_teach.course.comparing import exactly
from npslam_teach.course.filtering.check_inputs import add_object_inputs, covariance, match_frame_inputs
from npslam_teach.course.trials import Part, check_function, fresh
from npslam_teach.course.verdict_page import exercise

NOT_SQUARED = "a standard deviation must be squared before it is added to a variance"


@exercise("09", 1, of=5)
def check_kalman_gain(kalman_gain: Callable) -> Verdict:
    """Exercise 1: ``kalman_gain(variance, slope, noise_std)``, a number."""

    def truth(variance, slope, noise_std):
        return variant(variance, slope, noise_std)

    def variant(p, h, std, power=2, sign=True, square_slope=True, noise=True):
        return p * (h if sign else abs(h)) / (p * (h**2 if square_slope else abs(h)) + noise * std**power)

    mistakes = {
        NOT_SQUARED: partial(variant, power=1),
        "the sign of the slope is lost: a robot too far ahead sees the wall too near": partial(variant, sign=False),
        "the variance of what is expected is slope * variance * slope: the slope counts twice": partial(
            variant, square_slope=False
        ),
        "the noise of the sensor is missing: such a filter believes every measurement": partial(variant, noise=False),
        "this is the share of the old belief that stays; the gain is how far the innovation moves it": (
            lambda p, h, std: std**2 / (h**2 * p + std**2)
        ),
        "this is the share of the innovation's variance that the belief explains; divide by the slope once more": (
            lambda p, h, std: h**2 * p / (h**2 * p + std**2)
        ),
        "the slope is missing above the line": lambda p, h, std: p / (h**2 * p + std**2),
    }
    rng = fresh()
    slopes = rng.uniform(0.3, 3, 8) * [1, -1, 1, -1, 1, -1, 1, -1]
    trials = [(float(rng.uniform(0.05, 2)), float(slope), float(rng.uniform(0.1, 2))) for slope in slopes]
    edges = {
        "with a belief that is next to nothing": [(1e6, 2.0, 0.3)],
        "with a belief that is next to certain": [(1e-6, -1.5, 0.3)],
    }
    praise = "the gain weighs the belief against the sensor"
    return check_function(kalman_gain, truth, Part("your gain", mistakes), trials, edges, praise)


@exercise("09", 2, of=5)
def check_squared_mahalanobis(squared_mahalanobis: Callable) -> Verdict:
    """Exercise 2: ``squared_mahalanobis(innovation, innovation_cov)``, a number."""

    def truth(innovation, innovation_cov):
        return innovation @ np.linalg.solve(innovation_cov, innovation)

    mistakes = {
        "that is the distance itself; the square is asked for": lambda y, cov: np.sqrt(truth(y, cov)),
        "the covariance is multiplied, not divided by: a wide gate must make a distance small": lambda y, cov: (
            y @ cov @ y
        ),
        "this is the plain distance, squared: the covariance is not used": lambda y, cov: y @ y,
        "only the diagonal of the covariance is used: the two errors are correlated": lambda y, cov: (
            y @ (y / np.diag(cov))
        ),
        "the inverse is taken number by number: a matrix has an inverse as a whole": lambda y, cov: y @ (1 / cov) @ y,
        "the covariance is inverted twice": lambda y, cov: np.sum(np.linalg.solve(cov, y) ** 2),
    }
    rng = fresh()
    trials = [(rng.normal(size=2), covariance(rng, 2)) for _ in range(8)]
    edges = {
        "with an innovation of zero": [(np.zeros(2), covariance(rng, 2))],
        "with errors that are not correlated": [(rng.normal(size=2), np.diag(rng.uniform(0.1, 2, 2)))],
    }
    praise = "distances are now counted in standard deviations, whatever the direction"
    return check_function(squared_mahalanobis, truth, Part("your number", mistakes), trials, edges, praise)


@exercise("09", 3, of=5)
def check_match_frame(match_frame: Callable) -> Verdict:
    """Exercise 3: ``match_frame(squared_distance, gate)``, (m,) objects or -1."""

    def truth(squared_distance, gate):
        return _best(squared_distance, gate)

    mistakes = {
        "two sightings of one frame share an object: both took the nearest": _nearest,
        "sightings take turns, and the first takes the nearest: together they could do better": _greedy,
        "a pair beyond the gate is matched: what fits nothing must be left out": lambda d, gate: _best(d, np.inf),
        "the gate is asked too late: a bad pair that is thrown away afterwards has already pushed others aside": (
            lambda d, gate: _thrown_away(d, gate)
        ),
        "as many are matched as can be, and the gate only forbids: leaving one out costs the gate and may be cheaper": (
            lambda d, gate: _thrown_away(np.where(d < gate, d, 1e6), gate)
        ),
        "the total is made as large as can be, not as small": lambda d, gate: _best(-np.minimum(d, 1e6), np.inf),
    }
    praise = "no two sightings share an object, and nothing beyond the gate is matched"
    return check_function(match_frame, truth, Part("your matches", mistakes, exactly), *match_frame_inputs(), praise)


@exercise("09", 4, of=5)
def check_add_object(add_object: Callable) -> Verdict:
    """Exercise 4: ``add_object(mean, cov, xy, observation_std)``: mean (n+2,) and covariance (n+2, n+2)."""

    def variant(mean, cov, xy, std, lever=1.0, turned=True, power=2, noise=True, cross="all", moved=True, swap=False):
        rotation = se2.rotate(mean[2], np.eye(2)).T
        dx, dy = rotation @ xy
        by_state = np.zeros((2, len(mean)))
        by_state[:, :3] = [[1.0, 0.0, -lever * dy], [0.0, 1.0, lever * dx]]
        camera = noise * np.diag(std**power)
        own = by_state @ cov @ by_state.T + (rotation @ camera @ rotation.T if turned else camera)
        shared = by_state @ cov
        shared = {"all": shared, "none": 0 * shared, "pose": np.where(np.arange(len(mean)) < 3, shared, 0)}[cross]
        place = mean[:2] + (np.array([dx, dy]) if moved else xy)
        grown = np.block([[cov, shared.T], [shared, own]])
        return np.append(mean, place[::-1] if swap else place), grown

    of_mean = {
        "the sighting is not turned into the world before it is added to the position": {"moved": False},
        "x and y of the new object are swapped": {"swap": True},
    }
    of_cov = {
        "the new object shares no error with the pose: then the filter would take it for an independent witness": {
            "cross": "none"
        },
        "the new object shares its error with the pose only: objects found before are correlated with that pose": {
            "cross": "pose"
        },
        "the error of the sighting is not turned into the world": {"turned": False},
        "the error of the heading is left out: a turned robot swings what it sees": {"lever": 0.0},
        "the swing by the heading has the wrong sign": {"lever": -1.0},
        NOT_SQUARED: {"power": 1},
        "the error of the sighting itself is missing": {"noise": False},
    }
    parts = (
        Part("your mean", _part(variant, of_mean, 0), hint=_mean_difference),
        Part("your covariance", _part(variant, of_cov, 1), hint=_cov_difference),
    )
    praise = "the state has grown by two, and the new object is correlated with all that the pose is correlated with"
    return check_function(add_object, variant, parts, *add_object_inputs(), praise)


def _part(variant: Callable, wrongly: dict, k: int) -> dict:
    """By message, the part of the answer that a mistake gives."""
    return {text: lambda *trial, keys=keys: variant(*trial, **keys)[k] for text, keys in wrongly.items()}


@exercise("09", 5, of=5)
def check_nis_bounds(nis_bounds: Callable) -> Verdict:
    """Exercise 5: ``nis_bounds(num_matches, probability)``, the low and the high end, (2,)."""
    from scipy.stats import chi2, norm

    def variant(num_matches, probability, numbers=2, average=True, tails=2):
        dof, tail = numbers * num_matches, (1 - probability) / 2
        levels = (tail, 1 - tail) if tails == 2 else (1 - probability, probability)
        return chi2.ppf(levels, dof) / (num_matches if average else 1)

    mistakes = {
        "each match measures two numbers, so each adds two degrees of freedom": partial(variant, numbers=1),
        "these are bounds of the sum; the average over the matches is asked for": partial(variant, average=False),
        "the rest of the probability is split between two tails: half of it at either end": partial(variant, tails=1),
        "divided by the degrees of freedom: the average is over matches, and a match has two": (
            lambda n, p: variant(n, p) / 2
        ),
        "that is the Gaussian approximation: take quantiles of chi-squared itself": (
            lambda n, p: 2 + norm.ppf([(1 - p) / 2, (1 + p) / 2]) * 2 / np.sqrt(n)
        ),
        "the average of N matches scatters less than one of them: the bounds must depend on N": (
            lambda n, p: chi2.ppf([(1 - p) / 2, (1 + p) / 2], 2)
        ),
        "the high end comes first: low, then high": lambda n, p: variant(n, p)[::-1],
    }
    rng = fresh()
    trials = [(int(n), float(rng.uniform(0.6, 0.98))) for n in (2, 7, 50, 400, *rng.integers(3, 900, 6))]
    edges = {"with a single match": [(1, 0.95)], "with thousands of matches": [(5000, 0.99)]}
    praise = "a filter whose average leaves these bounds is too sure of itself, or not sure enough"
    return check_function(
        nis_bounds, variant, Part("your bounds", mistakes), trials, edges, praise, drawings.nis_bounds()
    )


def _mean_difference(answers: list, expected: list) -> str:
    n, off = _first_off(answers, expected)
    return "the old numbers of your mean have changed" if off[:n].any() else "the new object is at the wrong place"


def _cov_difference(answers: list, expected: list) -> str:
    n, off = _first_off(answers, expected)
    if off[:n, :n].any():
        return "the old part of your covariance has changed: a new object says nothing about the old numbers"
    if not all(np.allclose(each, each.T) for each in answers):
        return "your covariance is not symmetric"
    where = "what it shares with the old numbers" if off[:n].any() else "its own two by two"
    return f"the new object's covariance is off: look at {where}"


def _first_off(answers: list, expected: list) -> tuple[int, np.ndarray]:
    """The old size of the state, and which numbers differ, in the first wrong answer."""
    pairs = ((e, ~np.isclose(a, e)) for a, e in zip(answers, expected, strict=True))
    wanted, off = next(each for each in pairs if each[1].any())
    return len(wanted) - 2, off


def _best(squared_distance: np.ndarray, gate: float) -> np.ndarray:
    """The cheapest one-to-one matching, where leaving one out costs the gate, by trying all of them."""
    num_observations, num_objects = squared_distance.shape
    choices = list(range(num_objects)) + [-1] * num_observations
    leave_out = 1e9 if np.isinf(gate) else gate
    cost = np.column_stack([squared_distance, np.full(num_observations, leave_out)])
    rows = np.arange(num_observations)
    return np.array(min(set(permutations(choices, num_observations)), key=lambda each: cost[rows, list(each)].sum()))


def _nearest(squared_distance: np.ndarray, gate: float) -> np.ndarray:
    return np.where(squared_distance.min(axis=1) < gate, squared_distance.argmin(axis=1), -1)


def _greedy(squared_distance: np.ndarray, gate: float) -> np.ndarray:
    left, chosen = squared_distance.copy(), []
    for k in range(len(left)):
        j = int(left[k].argmin())
        chosen.append(j if left[k, j] < gate else -1)
        if chosen[-1] >= 0:
            left[:, j] = np.inf
    return np.array(chosen)


def _thrown_away(squared_distance: np.ndarray, gate: float) -> np.ndarray:
    chosen = _best(squared_distance, np.inf)
    cost = np.column_stack([squared_distance, np.zeros(len(chosen))])[np.arange(len(chosen)), chosen]
    return np.where(cost < gate, chosen, -1)
