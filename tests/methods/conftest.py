"""What several tests of methods look at."""

import numpy as np
import pytest
from beginnings import first_poses

from npslam_teach import simulate
from npslam_teach.association import in_order_of_sight
from npslam_teach.methods.posterior import in_time, start_model


@pytest.fixture(scope="package")
def room():
    """A part of a run: the model of its tracklets, its graph, and the true object of every observation, in time."""
    log, truth = simulate.fifteen_objects(3, 1.0)
    kept = truth.obs_object[log.obs_time < 400]
    log, back = in_time(first_poses(log, 400))
    return *start_model(log), in_order_of_sight(kept[np.argsort(back)])
