"""One run: the same row from every process, and seconds that are the method's own."""

import json
import pickle
import subprocess
import sys
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import pytest

from npslam_teach import experiments, simulate
from npslam_teach.methods import METHODS

FIRST_IMPORTS = """
import json, sys, time
from npslam_teach import experiments, simulate
log, _ = simulate.toy_objects()
loaded = []
def perf_counter(clock=time.perf_counter):
    loaded.append(set(sys.modules))
    return clock()
time.perf_counter = perf_counter
experiments.run_method(sys.argv[1], log, {})
print(json.dumps(sorted(loaded[-1] - loaded[0])))
"""


def toy_scene(seed=0):
    return experiments.Scene("toy", seed, 1.0, *simulate.toy_objects())


def as_text(row):
    """Everything but the seconds; as text, because NaN is not equal to itself."""
    return json.dumps({name: value for name, value in row.items() if name != "seconds"})


@pytest.mark.parametrize("method", METHODS)
def test_a_row_is_plain_and_does_not_depend_on_what_ran_before(method):
    row = experiments.run_one(toy_scene(), method, {})
    assert as_text(json.loads(json.dumps(row))) == as_text(pickle.loads(pickle.dumps(row))) == as_text(row)
    assert as_text(experiments.run_one(toy_scene(), method, {})) == as_text(row)


def test_another_process_sends_back_the_same_row():
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        theirs = pool.submit(experiments.run_one, toy_scene(), "np-graph", {"alpha": 0.5}).result()
    ours = experiments.run_one(toy_scene(), "np-graph", {"alpha": 0.5})
    assert as_text(theirs) == as_text(ours)


@pytest.mark.parametrize("method", METHODS)
def test_nothing_is_imported_while_the_clock_runs(method):
    command = [sys.executable, "-c", FIRST_IMPORTS, method]
    output = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    assert json.loads(output) == []
