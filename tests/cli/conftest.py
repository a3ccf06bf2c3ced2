"""Small files that commands are tried on."""

import pytest
from commands import small_log

from npslam_teach import datasets
from npslam_teach.methods import METHODS


@pytest.fixture
def log_file(tmp_path):
    log, truth = small_log()
    datasets.save_log(tmp_path / "run.npz", log, truth)
    return tmp_path / "run.npz"


@pytest.fixture
def g2o_file(tmp_path, log_file):
    log, truth = datasets.load_log(log_file)
    *_, last = METHODS["np-graph"](log)
    datasets.save_g2o(tmp_path / "graph.g2o", last.graph)
    return tmp_path / "graph.g2o"
