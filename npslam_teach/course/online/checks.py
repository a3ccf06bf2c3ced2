"""Checks of lesson 15: elimination, the sizes of the trees, and whether it pays to join."""

from collections.abc import Callable
from functools import partial

import numpy as np

from npslam_teach.course import drawings
from npslam_teach.course.checking import Verdict
from npslam_teach.course.trials import Part, check_function, fresh
from npslam_teach.course.verdict_page import exercise


@exercise("15", 1, of=3)
def check_without(without: Callable) -> Verdict:
    """Exercise 1: ``without(information, gone)``, the information of the variables that are left."""

    def variant(information, gone, sign=-1.0, keep=False, inverse=True):
        left = np.setdiff1d(np.arange(len(information)), gone)
        if keep:
            left, gone = gone, left
        tie, own = information[np.ix_(left, gone)], information[np.ix_(gone, gone)]
        middle = np.linalg.inv(own) if inverse else own
        return information[np.ix_(left, left)] + sign * tie @ middle @ tie.T

    def struck_out(information, gone):
        left = np.setdiff1d(np.arange(len(information)), gone)
        return information[np.ix_(left, left)]

    mistakes = {
        "rows and columns are struck out: that holds the others still. What they tie together must be kept": struck_out,
        "the sign is wrong: who is free to move takes information away": partial(variant, sign=1.0),
        "this is the information of those that were to go": partial(variant, keep=True),
        "the block of those that go must be inverted": partial(variant, inverse=False),
        "this is a covariance: invert it once more": lambda h, g: np.linalg.inv(variant(h, g)),
        "this is the block of the inverse, a covariance: invert it once more": lambda h, g: np.delete(
            np.delete(np.linalg.inv(h), g, axis=0), g, axis=1
        ),
    }
    rng, trials = fresh(), []
    for size, gone in ((2, [0]), (3, [1]), (4, [0, 2]), (5, [4]), (6, [1, 2, 5])):
        root = rng.normal(size=(size, size))
        trials.append((root @ root.T + np.eye(size), np.array(gone)))
    edges = {
        "when nothing goes": [(np.diag([1.0, 2.0]), np.zeros(0, dtype=int))],
        "when they are tied to nothing": [(np.diag([3.0, 4.0, 5.0]), np.array([1]))],
        "when their order is another": [(trials[-1][0], np.array([5, 1, 2]))],
    }
    praise = "what went still speaks: through the ties that it leaves between the others"
    return check_function(without, variant, Part("your information", mistakes), trials, edges, praise)


@exercise("15", 2, of=3)
def check_tree_sizes(tree_sizes: Callable) -> Verdict:
    """Exercise 2: ``tree_sizes(count)``, the sizes of the complete trees over so many leaves, largest first."""

    def variant(count, reverse=False):
        sizes = [2**k for k in range(int(count).bit_length()) if int(count) >> k & 1]
        return np.array(sizes if reverse else sizes[::-1])

    mistakes = {
        "the largest tree is the oldest: it comes first": partial(variant, reverse=True),
        "these are the binary digits: give the sizes of the trees": lambda n: np.array([int(d) for d in f"{n:b}"]),
        "these are the levels: a tree of level k has 2^k leaves": lambda n: np.log2(variant(n)),
        "every leaf stands alone here: two trees of one size become one": lambda n: np.ones(n),
        "this is the largest tree alone: what is left over has trees, too": lambda n: variant(n)[:1],
        "these count the nodes of the trees: count the leaves": lambda n: 2 * variant(n) - 1,
    }
    trials = [(count,) for count in (3, 5, 6, 7, 11, 13, 22, 100)]
    edges = {"with a single leaf": [(1,)], "with a power of two": [(8,), (64,)]}
    praise = "a binary counter: a carry joins two trees of one size"
    return check_function(tree_sizes, variant, Part("your sizes", mistakes), trials, edges, praise)


@exercise("15", 3, of=3)
def check_join_gain(join_gain: Callable) -> Verdict:
    """Exercise 3: ``join_gain(off, cov, density)``, in nats."""

    def variant(off, cov, density, half=0.5, log_det=0.5, pi=True, prior=-1.0, inverse=True):
        squared = off @ (np.linalg.inv(cov) if inverse else cov) @ off
        normal = -half * squared - log_det * np.log(np.linalg.det(cov)) - (np.log(2 * np.pi) if pi else 0.0)
        return normal + prior * np.log(density)

    mistakes = {
        "the factor 1/2 of the squared distance is missing": partial(variant, half=1.0),
        "the determinant is missing: a wide normal distribution is low": partial(variant, log_det=0.0),
        "of the determinant take the root: half of its logarithm": partial(variant, log_det=1.0),
        "the 2 pi of a normal distribution in the plane is missing": partial(variant, pi=False),
        "the density of unseen objects is missing": partial(variant, prior=0.0),
        "the more unseen objects there may be, the less it gains to join: the sign of their density": partial(
            variant, prior=1.0
        ),
        "the covariance must be inverted": partial(variant, inverse=False),
        "this is the ratio of the two: take its logarithm": lambda *a: np.exp(variant(*a)),
    }
    rng, trials = fresh(), []
    for scale in (0.1, 0.3, 1.0, 3.0):
        root = scale * (rng.normal(size=(2, 2)) + 2 * np.eye(2))
        trials.append((scale * rng.normal(size=2), root @ root.T, float(rng.uniform(0.01, 2))))
    edges = {
        "at no distance": [(np.zeros(2), np.diag([0.01, 0.04]), 0.1)],
        "far away": [(np.array([30.0, -40.0]), np.eye(2), 0.1)],
    }
    praise = "near and surely so gains much; where drift is wide, a neighbour proves little"
    return check_function(join_gain, variant, Part("your gain", mistakes), trials, edges, praise, drawings.join_gain())
