"""Checks of lesson 10: Wilson's interval, the reach of the kernel, a scaled kernel, and the distance of two passes."""

from collections.abc import Callable
from functools import partial

import numpy as np

from npslam_teach.course import drawings
from npslam_teach.course.checking import Verdict
from npslam_teach.course.trials import Part, check_function, fresh
from npslam_teach.course.verdict_page import exercise


@exercise("10", 1, of=4)
def check_wilson(wilson: Callable) -> Verdict:
    """Exercise 1: ``wilson(successes, trials, z)``, the low and the high end, (2,)."""

    def truth(successes, trials, z):
        return variant(successes, trials, z)

    def variant(k, n, z, shrink=True, floor=True, over=True, squared=True, trials=None, power=0.5):
        share, n = k / n, n if trials is None else trials
        rest = (z**2 if squared else z) / n
        middle = share + (rest / 2 if shrink else 0)
        half = z * (share * (1 - share) / n + (rest / (4 * n) if floor else 0)) ** power
        return np.array([middle - half, middle + half]) / ((1 + rest) if over else 1)

    mistakes = {
        "this is the share plus and minus z standard deviations: at 30 of 30 it has no width": partial(
            variant, shrink=False, floor=False, over=False
        ),
        "the middle is the share itself: z^2 / 2n is missing from it": partial(variant, shrink=False),
        "z^2 / 4n^2 is missing under the root": partial(variant, floor=False),
        "the division by 1 + z^2 / n is missing": partial(variant, over=False),
        "z stands where z^2 should": partial(variant, squared=False),
        "the root is missing": partial(variant, power=1),
        "the high end comes first: low, then high": lambda k, n, z: variant(k, n, z)[::-1],
        "these are counts: divide by the number of trials": lambda k, n, z: n * variant(k, n, z),
    }
    rng = fresh()
    sizes = [(4, 10), (27, 30), (120, 200), *((int(rng.integers(1, n)), int(n)) for n in rng.integers(5, 90, 4))]
    trials = [(k, n, z) for k, n in sizes for z in (1.96, float(rng.uniform(0.8, 3.0)))]
    edges = {
        "without a success": [(0, 10, 1.96), (0, 1, 1.0)],
        "without a failure": [(30, 30, 1.96), (1, 1, 2.0)],
        "with a hundred thousand trials": [(70000, 100000, 1.96)],
    }
    praise = "the interval stays within 0 and 1, and has a width at 0 and at n"
    return check_function(
        wilson, truth, Part("your interval", mistakes, _ends), trials, edges, praise, drawings.wilson()
    )


def _ends(answer: np.ndarray, truth, tolerance: float) -> bool:
    """Shares are good to the precision of 1: at 0 of n the low end is a difference that vanishes."""
    return answer.shape == np.shape(truth) and np.allclose(answer, truth, rtol=tolerance, atol=1e-3 * tolerance)


@exercise("10", 2, of=4)
def check_reach(reach: Callable) -> Verdict:
    """Exercise 2: ``reach(votes, alpha, kernel_std)``, m."""

    def truth(votes, alpha, kernel_std):
        return variant(votes, alpha, kernel_std)

    def variant(votes, alpha, s, two=2.0, ratio=True, power=0.5, log=np.log):
        inside = log(votes / alpha if ratio else votes * alpha)
        return s * np.sign(inside) * np.abs(two * inside) ** power

    mistakes = {
        "the root is missing": partial(variant, power=1),
        "the 2 of the kernel's exponent is missing": partial(variant, two=1.0),
        "this is the square of the distance in kernel widths, and not yet in metres": lambda n, a, s: 2 * np.log(n / a),
        "the kernel's width is missing": lambda n, a, s: np.sqrt(2 * np.log(n / a)),
        "this is the square: take the root": lambda n, a, s: 2 * s**2 * np.log(n / a),
        "alpha makes the reach shorter, not longer: divide by it": partial(variant, ratio=False),
        "this is log to the base 10: the kernel is an exponential of e": partial(variant, log=np.log10),
        "the votes are left out": lambda n, a, s: variant(1.0, a, s),
        "alpha is left out": lambda n, a, s: variant(n, 1.0, s),
        "s must be outside the root, or squared under it": lambda n, a, s: np.sqrt(2 * s * np.log(n / a)),
    }
    rng = fresh()
    trials = [
        (float(rng.integers(2, 90)), float(rng.uniform(0.01, 0.99)), float(rng.uniform(0.1, 1.3))) for _ in range(12)
    ]
    edges = {
        "with a single vote": [(1.0, 0.5, 0.354)],
        "with thousands of votes": [(5e4, 0.9, 0.354)],
        "with an alpha above 1": [(7.0, 3.0, 0.2)],
    }
    praise = "votes and alpha count by the root of a logarithm only; the width counts in full"
    return check_function(reach, truth, Part("your distance", mistakes), trials, edges, praise)


@exercise("10", 3, of=4)
def check_scaled_kernel(scaled_kernel: Callable) -> Verdict:
    """Exercise 3: ``scaled_kernel(observation_std, paper_observation_std, paper_kernel_std)``, m."""

    def truth(observation_std, paper_observation_std, paper_kernel_std):
        return paper_kernel_std * observation_std / paper_observation_std

    mistakes = {
        "upside down: a sensor that errs more needs a wider kernel": lambda own, paper, kernel: kernel * paper / own,
        "standard deviations scale in proportion, variances with the square": lambda own, paper, kernel: (
            kernel * (own / paper) ** 2
        ),
        "this is the kernel as it was": lambda own, paper, kernel: kernel,
        "a kernel is as many times the sensor's error as the paper's kernel is of the paper's: multiply": (
            lambda own, paper, kernel: kernel + own - paper
        ),
        "that is the ratio alone: the paper's kernel is missing": lambda own, paper, kernel: own / paper,
        "divide by the paper's noise: its kernel was made for that": lambda own, paper, kernel: kernel * own,
        "only the root of the ratio counts here, and it should be the ratio": lambda own, paper, kernel: (
            kernel * np.sqrt(own / paper)
        ),
    }
    rng = fresh()
    trials = [tuple(rng.uniform(0.05, 2.0, 3).tolist()) for _ in range(12)]
    edges = {"with the paper's own sensor": [(0.1, 0.1, 0.354)], "with a sensor that does not err": [(0.0, 0.1, 0.354)]}
    praise = "measured in the sensor's own errors the kernel is now the same for every log"
    return check_function(scaled_kernel, truth, Part("your kernel", mistakes), trials, edges, praise)


@exercise("10", 4, of=4)
def check_pass_distance(pass_distance: Callable) -> Verdict:
    """Exercise 4: ``pass_distance(xy, cov, i, j)``, a Mahalanobis distance."""

    def truth(xy, cov, i, j):
        return variant(xy, cov, i, j)

    def variant(xy, cov, i, j, shared=1.0, metric="solve", power=0.5):
        a, b = slice(2 * i, 2 * i + 2), slice(2 * j, 2 * j + 2)
        between = xy[i] - xy[j]
        spread = cov[a, a] + cov[b, b] - shared * (cov[a, b] + cov[b, a])
        if metric == "diagonal":
            spread = np.diag(np.diag(spread))
        by = spread @ between if metric == "times" else np.linalg.solve(spread, between)
        return (between @ by) ** power

    mistakes = {
        "what the two passes share is left out: two chairs seen from one place share all of the drift": partial(
            variant, shared=0.0
        ),
        "the shared blocks are added: an error that moves both the same way does not move them apart": partial(
            variant, shared=-1.0
        ),
        "the shared block counts twice, once as (i, j) and once as (j, i)": partial(variant, shared=0.5),
        "this is the squared distance: take the root": partial(variant, power=1.0),
        "this is the distance in metres: the covariance is not used": lambda xy, cov, i, j: np.linalg.norm(
            xy[i] - xy[j]
        ),
        "the covariance is multiplied, not divided by": partial(variant, metric="times"),
        "only the diagonal of the difference's covariance is used": partial(variant, metric="diagonal"),
        "landmark i has the rows 2i and 2i + 1 of the covariance": _by_single_rows,
    }
    praise = "drift that both passes share has cancelled, and the rest is the yardstick"
    return check_function(pass_distance, truth, Part("your distance", mistakes), *_pass_distance_inputs(), praise)


def _pass_distance_inputs() -> tuple[list, dict]:
    """Arguments of ``check_pass_distance``: its trials, and its edges by the situation."""
    rng, trials = fresh(), []
    for count in (2, 3, 4, 5, 4, 3):
        root = rng.normal(size=(2 * count, 2 * count))
        drift = np.tile(np.eye(2), (count, 1))
        cov = 0.2 * root @ root.T + 0.3 * np.eye(2 * count) + 4 * drift @ drift.T
        i, j = rng.permutation(count)[:2].tolist()
        trials.append((rng.uniform(-3, 3, (count, 2)), cov, i, j))
    xy, cov, i, j = trials[2]
    edges = {
        "with the two passes exchanged": [(xy, cov, j, i)],
        "with passes at one place": [(np.zeros_like(xy), cov, i, j)],
        "for the first and the last pass": [(xy, cov, 0, len(xy) - 1)],
    }
    return trials, edges


def _by_single_rows(xy, cov, i, j) -> float:
    """The distance if the covariance is indexed as if landmark i had rows i and i + 1."""
    a, b = slice(i, i + 2), slice(j, j + 2)
    spread = cov[a, a] + cov[b, b] - cov[a, b] - cov[b, a]
    squared = (xy[i] - xy[j]) @ np.linalg.pinv(spread) @ (xy[i] - xy[j])
    return np.sqrt(max(squared, 0.0))
