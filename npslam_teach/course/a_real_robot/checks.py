"""Checks of lesson 12: hidden identities, lag-1 correlation, growth of errors, a gate's share, one of every pass."""

from collections.abc import Callable
from functools import partial

import numpy as np

from npslam_teach import se2
from npslam_teach.course import drawings
from npslam_teach.course.a_real_robot.check_inputs import first_of_each_pass_inputs, growth_inputs
from npslam_teach.course.checking import Verdict
from npslam_teach.course.comparing import exactly
from npslam_teach.course.trials import Part, check_function, fresh
from npslam_teach.course.verdict_page import exercise
from npslam_teach.datasets.recordings import FIRST_LANDMARK


@exercise("12", 1, of=5)
def check_hidden(hidden: Callable) -> Verdict:
    """Exercise 1: ``hidden(codes, barcodes, num_classes)``, the class of every sighting (m,), -1 for a robot."""

    def variant(codes, barcodes, num_classes, first=FIRST_LANDMARK, robots=True, wrapped=True, looked_up=True):
        subject = {int(code): int(number) for number, code in barcodes}
        number = np.array([subject[int(code)] if looked_up else int(code) for code in codes]) - first
        classes = number % num_classes if wrapped else number
        return np.where(number < FIRST_LANDMARK - first, -1, classes) if robots else classes

    mistakes = {
        "that is which landmark it is, and tells the robot everything: take the remainder by num_classes": partial(
            variant, wrapped=False
        ),
        "landmarks are counted from subject 6, so that subject 6 is landmark 0": partial(variant, first=0),
        "landmarks are counted from 0: subject 6 is the first": partial(variant, first=5),
        "subjects 1 to 5 are robots, whatever the remainder says: -1": partial(variant, robots=False),
        "the barcode is not the number of the subject: the table barcodes says which is whose": partial(
            variant, looked_up=False
        ),
        "that is the quotient: take the remainder": lambda codes, barcodes, n: np.where(
            variant(codes, barcodes, n) < 0, -1, variant(codes, barcodes, n, wrapped=False) // n
        ),
    }
    rng, trials = fresh(), []
    for num_classes in (5, 1, 2, 3, 7, 5):
        barcodes = np.column_stack([np.arange(1, 21), rng.permutation(np.arange(5, 99))[:20]])
        trials.append((np.append(rng.choice(barcodes[:, 1], 14), barcodes[[0, 4, 6, 19], 1]), barcodes, num_classes))
    codes, barcodes, num_classes = trials[0]
    edges = {
        "with nothing read": [(codes[:0], barcodes, num_classes)],
        "with robots alone": [(barcodes[:5, 1].copy(), barcodes, num_classes)],
        "with a table in another order": [(codes, rng.permutation(barcodes), num_classes)],
        "with more classes than landmarks": [(codes, barcodes, 40)],
    }
    praise = "what a thing is stays in the log, and which one it is leaves it"
    return check_function(hidden, variant, Part("your classes", mistakes, exactly), trials, edges, praise)


@exercise("12", 2, of=5)
def check_lag_one(lag_one: Callable) -> Verdict:
    """Exercise 2: ``lag_one(errors, passes)``, a correlation."""

    def variant(off, passes, only_same=True, root=False, over_all=True, mean=True, centred=False, lag=1):
        off = off - off.mean() if centred else off
        same = passes[lag:] == passes[:-lag] if only_same else np.ones(len(off) - lag, dtype=bool)
        products = (off[lag:] * off[:-lag])[same]
        below = np.mean(off**2) if mean else np.sum(off**2)
        top = products.mean() if mean else products.sum()
        return (top / (below if over_all else 1.0)) ** (0.5 if root else 1.0)

    mistakes = {
        "the last of a pass and the first of the next are no neighbours: only pairs of one pass count": partial(
            variant, only_same=False
        ),
        "this is a covariance in m^2: divide by the mean square": partial(variant, over_all=False),
        "sums over different numbers of terms: take the mean of the products, and the mean of the squares": partial(
            variant, mean=False
        ),
        "errors have a mean of zero by definition: do not take the mean off, for it may be an error itself": partial(
            variant, centred=True
        ),
        "these are neighbours but one": partial(variant, lag=2),
        "divide by the mean square, not by its root": lambda off, passes: (
            variant(off, passes, over_all=False) / np.sqrt(np.mean(off**2))
        ),
    }
    rng, trials = fresh(), []
    for count in (12, 20, 30, 25):
        passes = np.sort(rng.integers(0, count // 4, count))
        trials.append((rng.normal(0.1, 0.2, count) + rng.normal(0.0, 0.3, count)[passes], passes))
    errors, passes = trials[0]
    edges = {
        "with a single pass": [(errors, np.zeros(len(errors), dtype=int))],
        "with errors that are all the same": [(np.full(6, -0.3), np.array([0, 0, 0, 1, 1, 1]))],
        "with passes that are numbered otherwise": [(errors, 100 - 7 * passes)],
    }
    praise = "0 for errors that know nothing of each other, near 1 for errors that last"
    return check_function(lag_one, variant, Part("your correlation", mistakes), trials, edges, praise)


@exercise("12", 3, of=5)
def check_growth(growth: Callable) -> Verdict:
    """Exercise 3: ``growth(odometry, poses, n)``, (3,) m, m, rad."""

    def variant(odometry, poses, n, wrapped=True, frames=True, power=0.5, centred=False, every=1):
        wheels = se2.dead_reckoning(odometry)
        motion = se2.between if frames else (lambda begin, end: end - begin)
        off = motion(wheels[:-n], wheels[n:]) - motion(poses[:-n], poses[n:])
        if wrapped:
            off[:, 2] = se2.wrap(off[:, 2])
        off = off[::every] - (off[::every].mean(axis=0) if centred else 0.0)
        return np.mean(off**2, axis=0) ** power

    mistakes = {
        "the difference of two headings is not wrapped": partial(variant, wrapped=False),
        "compare motions, each seen from its own first pose: se2.between, not a difference in the world": partial(
            variant, frames=False
        ),
        "this is the mean square: take the root": partial(variant, power=1),
        "the mean is an error too: do not take it off": partial(variant, centred=True),
        "every stretch of n steps counts, wherever it begins": lambda odometry, poses, n: variant(
            odometry, poses, n, every=n
        ),
        "steps do not add up number by number: each is seen from the pose before it (se2.dead_reckoning)": _steps_added,
        "this is the error of single steps, times the root of n; look at what n steps together really err by": (
            lambda odometry, poses, n: np.sqrt(n) * variant(odometry, poses, 1)
        ),
        "this is the error at the end of n steps that begin at the first pose alone": lambda odometry, poses, n: np.abs(
            se2.dead_reckoning(odometry, poses[0])[n] - poses[n]
        ),
    }
    part = Part("your error", mistakes, _rms)
    return check_function(
        growth, variant, part, *growth_inputs(), "in a random walk this grows with the root of n", drawings.growth()
    )


def _rms(answer: np.ndarray, truth, tolerance: float) -> bool:
    """Errors of motions of metres and radians: what is far below a micrometre is rounding."""
    return answer.shape == np.shape(truth) and np.allclose(answer, truth, rtol=tolerance, atol=0.1 * tolerance)


@exercise("12", 4, of=5)
def check_share_outside(share_outside: Callable) -> Verdict:
    """Exercise 4: ``share_outside(off, std, gate)``, a share."""

    def variant(off, std, gate, squared=True, std_power=1, both=True, inside=False, chi=None):
        scaled = off / std**std_power
        distance = (scaled**2).sum(axis=1) if both else np.max(scaled**2, axis=1)
        bound = -2 * np.log(1 - gate) if chi is None else chi(gate)
        beyond = (distance if squared else np.sqrt(distance)) > bound
        return np.mean(~beyond if inside else beyond)

    mistakes = {
        "that is the share inside": partial(variant, inside=True),
        "the bound is for the squared distance": partial(variant, squared=False),
        "divide by the standard deviation, not by its square": partial(variant, std_power=2),
        "this is how many, not which share": lambda off, std, gate: variant(off, std, gate) * len(off),
        "both numbers count together: the squares are added, then compared": partial(variant, both=False),
        "the bound is for two numbers: chi-squared of two degrees of freedom": partial(variant, chi=_one_number),
        "the 2 is missing: half the squared distance is exponential": partial(
            variant, chi=lambda gate: -np.log(1 - gate)
        ),
    }
    rng, trials = fresh(), []
    for gate in (0.5, 0.9, 0.99, *rng.uniform(0.4, 0.95, 2).tolist()):
        std = rng.uniform(0.05, 0.4, 2)
        trials.append((rng.normal(size=(600, 2)) * std * rng.uniform(0.8, 1.6), std, gate))
    std = trials[0][1]
    edges = {
        "with errors of zero": [(np.zeros((5, 2)), std, 0.9)],
        "with a single error": [(np.array([[9.0, 9.0]]), std, 0.9)],
        "with errors far beyond": [(np.full((4, 2), 50.0), std, 0.99)],
    }
    praise = "where it is far above one minus the gate, something else than the sensor's noise is at work"
    return check_function(share_outside, variant, Part("your share", mistakes), trials, edges, praise)


def _one_number(gate: float) -> float:
    from scipy.stats import chi2

    return chi2.ppf(gate, 1)


@exercise("12", 5, of=5)
def check_first_of_each_pass(first_of_each_pass: Callable) -> Verdict:
    """Exercise 5: ``first_of_each_pass(labels, times, gap)``, (M,) bool."""

    def variant(labels, times, gap, beyond=0, by_object=True, left_out=False, begin=True):
        chosen = np.zeros(len(labels), dtype=bool)
        for k in np.unique(labels) if by_object else [None]:
            own = np.arange(len(labels)) if k is None else np.flatnonzero(labels == k)
            if k is not None and k < 0 and not left_out:
                continue
            own = own[np.argsort(times[own], kind="stable")]
            parted = np.diff(times[own]) > gap + beyond
            ends = np.append(True, parted) if begin else np.append(parted, True)
            chosen[own[ends]] = True
        return chosen

    mistakes = {
        "-1 is no object: what was left out is of no pass": partial(variant, left_out=True),
        "a pass is of one object: another object that comes into view ends nothing": partial(variant, by_object=False),
        "a gap of exactly so many poses is still the same pass": partial(variant, beyond=-1),
        "these are the last of every pass": partial(variant, begin=False),
        "only the first sighting of every object: an object that comes back begins another pass": (
            lambda labels, times, gap: variant(labels, times, 10**6)
        ),
        "these are the others: True for those that are the first": lambda labels, times, gap: (
            ~variant(labels, times, gap)
        ),
        "count the gap from the sighting before, not from where the pass began": _from_the_beginning,
    }
    praise = "what is the same for a whole pass is now counted once"
    return check_function(
        first_of_each_pass, variant, Part("your choice", mistakes, exactly), *first_of_each_pass_inputs(), praise
    )


def _steps_added(odometry, poses, n) -> np.ndarray:
    """The numbers of n steps added up, as if none of them turned."""
    added = np.vstack([np.zeros(3), np.cumsum(odometry, axis=0)])
    off = added[n:] - added[:-n] - se2.between(poses[:-n], poses[n:])
    off[:, 2] = se2.wrap(off[:, 2])
    return np.sqrt(np.mean(off**2, axis=0))


def _from_the_beginning(labels, times, gap) -> np.ndarray:
    """A pass that ends so many poses after it began, however often the object was seen meanwhile."""
    chosen, began = np.zeros(len(labels), dtype=bool), {}
    for m in np.argsort(times, kind="stable"):
        k = int(labels[m])
        if k >= 0 and times[m] - began.get(k, -(10**9)) > gap:
            chosen[m], began[k] = True, times[m]
    return chosen
