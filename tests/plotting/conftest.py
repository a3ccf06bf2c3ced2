"""One scene and the runs of all methods on it, for every figure."""

import pytest
from pictures import METHODS

from npslam_teach import plotting
from npslam_teach.simulate import fifteen_objects


@pytest.fixture(scope="session")
def scene():
    """The fifteen objects: log and truth."""
    return fifteen_objects()


@pytest.fixture(scope="session")
def runs(scene):
    """Every snapshot of each of the paper's methods."""
    return {name: list(METHODS[name](scene[0])) for name in METHODS}


@pytest.fixture(scope="session")
def last(runs):
    return {name: snapshots[-1] for name, snapshots in runs.items()}


@pytest.fixture
def ax():
    return plotting.new_figure()[1]
