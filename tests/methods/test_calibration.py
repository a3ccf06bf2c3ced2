"""Are the probabilities true? Rooms drawn from the prior of the posterior method, and rooms that are not."""

import numpy as np
import pytest

from npslam_teach import simulate
from npslam_teach.association import all_partitions
from npslam_teach.association.partition_posterior import log_posterior
from npslam_teach.course.the_posterior.scenes import (
    DRAWN_AT,
    OBSERVATION_STD,
    ODOMETRY_STD,
    ROUND,
    evidence_of,
)
from npslam_teach.evaluation.reliability import reliability
from npslam_teach.methods import sample_posterior
from npslam_teach.simulate.from_prior import chairs_from_prior

PARTITIONS = [np.array(labels) for labels in all_partitions([0] * len(DRAWN_AT))]
PAIRS = np.triu_indices(len(DRAWN_AT), 1)
TENTHS = np.linspace(0, 1, 11)


def exact_posterior(log, area):
    """(203,) the probability of every partition of six observations."""
    evidence = evidence_of(log, 1.0, area)
    log_p = np.array([log_posterior(evidence, labels) for labels in PARTITIONS])
    share = np.exp(log_p - log_p.max())
    return share / share.sum()


def probability_of_inclusion(counts: np.ndarray, true: int, level: float = 0.9) -> float:
    """Whether the smallest set of numbers of objects that holds the level has the true one; the last by its share."""
    held = 0.0
    for number in np.argsort(-counts):
        share = min(1.0, (level - held) / counts[number])
        if number == true:
            return share
        held += counts[number]
        if held >= level:
            return 0.0
    return 0.0


@pytest.mark.slow
@pytest.mark.parametrize(("side", "drift"), [(4.0, 1.0), (8.0, 3.0)])
def test_in_rooms_from_the_prior_probabilities_are_true(side, drift):
    """200 rooms, large beside the errors, for the model knows no border: expected calibration error and 90% sets."""
    rng, said, happened, world, inside = np.random.default_rng(0), [], [], [], []
    together = np.array([(labels[:, None] == labels)[PAIRS] for labels in PARTITIONS])
    number = np.array([labels.max() + 1 for labels in PARTITIONS])
    for room in range(200):
        std = drift * np.array(ODOMETRY_STD)
        log, truth = chairs_from_prior(rng, ROUND, DRAWN_AT, std, OBSERVATION_STD, side=side)
        share = exact_posterior(log, side**2)
        said.extend(share @ together)
        happened.extend((truth.obs_object[:, None] == truth.obs_object)[PAIRS])
        world.extend([room] * len(PAIRS[0]))
        counts = np.bincount(number, weights=share, minlength=len(DRAWN_AT) + 1)
        inside.append(probability_of_inclusion(counts, len(np.unique(truth.obs_object))))
    assert np.mean((np.array(said) > 0.05) & (np.array(said) < 0.95)) > 0.2, "or there would be nothing to be unsure of"
    assert reliability(said, happened, world, TENTHS).expected_calibration_error <= 0.03
    assert 0.85 <= np.mean(inside) <= 0.95


@pytest.mark.slow
def test_in_a_room_of_ours_what_is_said_to_be_sure_is_true():
    """Fifteen objects are no draw from the prior; of the pairs of tracklets that are all but certain few are wrong."""
    log, truth = simulate.fifteen_objects(0, noise=3.0)
    samples = sample_posterior(log, 120)
    first = np.array([truth.obs_object[samples.tracklet == k] for k in range(len(samples.best))], dtype=object)
    of_tracklet = np.array([np.bincount(each.astype(int)).argmax() for each in first])
    rows, columns = np.triu_indices(len(of_tracklet), 1)
    said, true = samples.together[rows, columns], of_tracklet[rows] == of_tracklet[columns]
    assert true[said > 0.95].mean() > 0.97
    assert true[said < 0.05].mean() < 0.03
