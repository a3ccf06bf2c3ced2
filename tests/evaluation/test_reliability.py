"""Reliability of probabilities: groups, margins that mind what hangs together, and input that makes no sense."""

import numpy as np
import pytest

from npslam_teach.evaluation.reliability import reliability


def test_groups_by_hand():
    said = [0.0, 0.2, 0.2, 0.6, 1.0]
    table = reliability(said, [False, True, False, True, True], range(5), edges=(0.0, 0.1, 0.5, 1.0))
    np.testing.assert_allclose(table.said, [0.0, 0.2, 0.8])
    np.testing.assert_allclose(table.happened, [0.0, 0.5, 1.0])
    np.testing.assert_array_equal(table.counts, [1, 2, 2])
    # Surprises of -0.2 and 0.8, in worlds of their own.
    assert table.margin[1] == pytest.approx(2 * np.hypot(0.2, 0.8) / 2)
    assert table.expected_calibration_error == pytest.approx((0 * 1 + 0.3 * 2 + 0.2 * 2) / 5)
    np.testing.assert_array_equal(table.within, [True, True, True])


def test_empty_groups_are_left_out():
    table = reliability([0.9, 0.95], [True, True], [0, 1])
    np.testing.assert_allclose(table.said, [0.925])


def test_events_of_one_world_count_as_one_for_the_margin():
    said, true = np.full(100, 0.3), np.random.default_rng(0).random(100) < 0.3
    alone = reliability(said, true, np.arange(100)).margin[0]
    copied = reliability(np.repeat(said, 4), np.repeat(true, 4), np.repeat(np.arange(100), 4)).margin[0]
    assert copied == pytest.approx(alone, rel=0.1)
    assert alone == pytest.approx(2 * np.sqrt(0.3 * 0.7 / 100), rel=0.15)


def test_margins_hold_what_they_promise():
    rng, within = np.random.default_rng(1), []
    for _ in range(300):
        said = rng.random(200)
        within += reliability(said, rng.random(200) < said, np.arange(200)).within.tolist()
    assert 0.93 < np.mean(within) < 0.99


def test_too_sure_is_seen():
    rng = np.random.default_rng(2)
    said = rng.random(2000)
    table = reliability(said, rng.random(2000) < 0.5 + 0.3 * (said - 0.5), np.arange(2000))
    assert table.expected_calibration_error > 0.1
    assert not table.within[0]


@pytest.mark.parametrize("arguments", [([], [], []), ([0.5], [True, False], [0]), ([[0.5]], [[True]], [[0]])])
def test_shapes_are_named(arguments):
    with pytest.raises(ValueError, match="three arrays of one length"):
        reliability(*arguments)
