"""What several tests of methods look at."""

from dataclasses import replace

import numpy as np
import pytest

from npslam_teach import simulate
from npslam_teach.association import in_order_of_sight
from npslam_teach.methods.posterior import in_time, start_model


@pytest.fixture(scope="package")
def room():
    """A part of a run: the model of its tracklets, its graph, and the true object of every observation, in time."""
    log, truth = simulate.fifteen_objects(3, 1.0)
    kept = log.obs_time < 400
    fields = {name: getattr(log, name)[kept] for name in ("obs_time", "obs_xy", "obs_class")}
    log, back = in_time(replace(log, odometry=log.odometry[:399], **fields))
    return *start_model(log), in_order_of_sight(truth.obs_object[kept][np.argsort(back)])
