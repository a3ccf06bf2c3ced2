"""The sampler's frequencies equal the exact posterior, and a sampler that errs would be noticed."""

import numpy as np
import pytest

from npslam_teach.association.gibbs import GibbsSampler
from npslam_teach.experiments import exact_posterior


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_every_partition_is_visited_as_often_as_it_is_probable(seed):
    assert exact_posterior.compared(seed)["distance"] <= 0.02


def test_a_sampler_with_a_wrong_prior_is_noticed(monkeypatch):
    """Joining weighs half as much as it should: far beyond what chance leaves."""
    right = GibbsSampler.seating
    monkeypatch.setattr(GibbsSampler, "seating", lambda *each: right(*each) - each[3] * np.log(2))
    seed = next(seed for seed in range(20) if exact_posterior.random_log(seed).num_observations == 4)
    assert exact_posterior.compared(seed)["distance"] > 0.03
