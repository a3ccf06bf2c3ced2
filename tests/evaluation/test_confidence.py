"""Wilson's interval: the published values, another implementation, and the equation that it solves."""

import numpy as np
import pytest
from scipy.stats import binomtest, norm

from npslam_teach.evaluation import wilson_interval

# Newcombe 1998, table I, method 3.
PUBLISHED = [(81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 20, 0.0, 0.1611), (1, 29, 0.0061, 0.1718)]


@pytest.mark.parametrize(("successes", "trials", "low", "high"), PUBLISHED)
def test_published_values(successes, trials, low, high):
    np.testing.assert_allclose(wilson_interval(successes, trials), (low, high), atol=5e-5)


@pytest.mark.parametrize("confidence", [0.5, 0.9, 0.95, 0.999])
@pytest.mark.parametrize("trials", [1, 2, 30, 1000])
def test_another_implementation(trials, confidence):
    successes = np.unique(np.linspace(0, trials, 7).round())
    low, high = wilson_interval(successes, trials, confidence)
    for k, *ends in zip(successes, low, high, strict=True):
        theirs = binomtest(int(k), trials).proportion_ci(confidence, method="wilson")
        np.testing.assert_allclose(ends, theirs, atol=1e-12)


def test_at_each_end_the_count_is_just_no_surprise():
    successes = np.arange(1, 30)
    z = norm.ppf(0.975)
    for end in wilson_interval(successes, 30):
        surprise = np.abs(successes - 30 * end) / np.sqrt(30 * end * (1 - end))
        np.testing.assert_allclose(surprise, z)


def test_it_stays_within_0_and_1_and_never_has_no_width():
    low, high = wilson_interval(np.arange(31), 30)
    assert low[0] == 0.0 and high[-1] == 1.0
    assert ((low >= 0) & (high <= 1) & (high - low > 0.1)).all()
    assert (np.diff(low) > 0).all() and (np.diff(high) > 0).all()
    np.testing.assert_allclose(low, 1 - high[::-1], atol=1e-15)


@pytest.mark.parametrize("p", [0.05, 0.5, 0.9])
def test_it_holds_the_truth_about_as_often_as_it_says(p):
    """Averaged over counts the coverage is near 95 %, not exactly: counts are whole numbers."""
    from scipy.stats import binom

    counts = np.arange(31)
    low, high = wilson_interval(counts, 30)
    assert binom.pmf(counts[(low <= p) & (p <= high)], 30, p).sum() == pytest.approx(0.95, abs=0.035)


def test_shapes_follow_numpy():
    low, high = wilson_interval([[1, 2, 3], [4, 5, 6]], [10, 20, 30])
    assert low.shape == high.shape == (2, 3)
    assert wilson_interval(3, 10)[0].shape == ()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((3, 2), "successes: expected from 0"),
        ((-1, 2), "successes: expected from 0"),
        ((float("nan"), 2), "successes: expected from 0"),
        ((0, 0), "trials: expected at least one"),
        ((1, float("inf")), "trials: expected at least one"),
        ((1, 2, 1.0), "confidence: expected a share"),
        ((1, 2, float("nan")), "confidence: expected a share"),
    ],
)
def test_what_makes_no_sense_is_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        wilson_interval(*arguments)
