"""Headings in the association: the fast sweep is the plain one, and evidence is an integral."""

import math

import numpy as np
import pytest

from npslam_teach import se2
from npslam_teach.association import SeenHeadings, exclusive_sweep, heading_kernel, plain_sweep, same_partition, sweep
from npslam_teach.association.headings import log_heading_evidence


def scene(seed, count=60):
    """Observations of things that stand close together and face different ways, some of them round."""
    rng = np.random.default_rng(seed)
    place, facing = rng.uniform(0, 1.5, (6, 2)), rng.uniform(-np.pi, np.pi, 6)
    obj, symmetry = rng.integers(0, 6, count), np.array([1, 1, 2, 4, 0, 1])
    theta = facing[obj] + 0.2 * rng.normal(size=count) + rng.integers(0, 4, count) * np.pi * (symmetry[obj] == 2)
    xy = place[obj] + 0.15 * rng.normal(size=(count, 2))
    headings = SeenHeadings(theta, symmetry[obj], 0.4)
    return (np.arange(count), np.column_stack([xy, theta]), xy, rng.integers(0, 2, 6)[obj]), headings


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("threshold", [None, 0.3])
def test_the_fast_sweep_is_the_plain_one(seed, threshold):
    start, headings = scene(seed)
    found, plain = (each(*start, threshold=threshold, headings=headings) for each in (sweep, plain_sweep))
    np.testing.assert_array_equal(found.labels, plain.labels)
    np.testing.assert_array_equal(found.landmarks, plain.landmarks)
    frames = np.arange(len(start[0]))  # one observation each: exclusive or not makes no difference
    alone = exclusive_sweep(*start, frames, threshold=threshold, headings=headings)
    np.testing.assert_array_equal(alone.labels, plain.labels)


@pytest.mark.parametrize("method", [plain_sweep, sweep])
def test_what_says_nothing_changes_nothing(method):
    (labels, landmarks, *rest), headings = scene(7)
    without = method(labels, landmarks[:, :2], *rest)
    round_only = headings._replace(symmetry=np.zeros(len(labels), dtype=int))
    for nothing in (round_only, headings._replace(std=1e9)):
        found = method(labels, landmarks, *rest, headings=nothing)
        np.testing.assert_array_equal(found.labels, without.labels)
        np.testing.assert_array_equal(found.landmarks[:, :2], without.landmarks)
    assert not same_partition(method(labels, landmarks, *rest, headings=headings).labels, without.labels)


def test_what_looks_alike_is_the_same():
    (labels, landmarks, *rest), headings = scene(8)
    before = sweep(labels, landmarks, *rest, headings=headings).labels
    parts = np.where(headings.symmetry > 0, 2 * np.pi / np.maximum(headings.symmetry, 1), 1.0)
    turned = headings._replace(theta=headings.theta + parts)
    np.testing.assert_array_equal(sweep(labels, landmarks, *rest, headings=turned).labels, before)


def test_the_kernel_is_one_for_the_same_and_for_the_round():
    assert heading_kernel(0.0, 1, 0.1) == heading_kernel(np.pi, 2, 0.1) == heading_kernel(1.0, 0, 0.1) == 1.0
    assert heading_kernel(0.2, 1, 0.1) == pytest.approx(math.exp(-2))


@pytest.mark.parametrize("symmetry", [1, 2, 4])
@pytest.mark.parametrize("count", [2, 3, 5])
def test_evidence_is_the_integral_over_the_angle(symmetry, count):
    rng = np.random.default_rng([symmetry, count])
    a, span = rng.normal(size=(count, count)), 2 * np.pi / symmetry
    cov = 0.002 * (a @ a.T + np.eye(count))
    theta = 3.1 + 0.05 * rng.normal(size=count)
    grid = np.linspace(3.1 - span / 2, 3.1 + span / 2, 20000, endpoint=False)
    off = theta[:, None] - grid
    density = np.exp(-np.einsum("ig,ij,jg->g", off, np.linalg.inv(cov), off) / 2)
    density /= np.sqrt(np.linalg.det(2 * np.pi * cov))
    together = density.mean()  # phi is anywhere alike
    apart = (1 / span) ** count
    shifted = se2.wrap(theta + rng.integers(0, symmetry, count) * span)
    found = log_heading_evidence(shifted, cov, symmetry)
    assert found == pytest.approx(np.log(together / apart), rel=1e-6)


def test_one_alone_and_the_round_have_nothing_to_agree_on():
    assert log_heading_evidence(np.array([1.0]), np.eye(1), 1) == 0.0
    assert log_heading_evidence(np.array([1.0, 2.0]), np.eye(2), 0) == 0.0
