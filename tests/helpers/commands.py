"""Commands as a user types them, in this process or in one of their own."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np

from npslam_teach import datasets, simulate
from npslam_teach.cli import parser

ROOT = Path(__file__).parents[2]

SOLVE_FIELDS = {
    "method",
    "num_objects",
    "num_observations",
    "labels",
    "poses",
    "objects",
    "counts_per_iteration",
    "chi2",
    "objective",
    "seconds",
    "metrics",
    "quality",
    "restarts",
    "score",
    "chi2_per_dof",
    "dof",
    "settings",
    "settled",
}
ONLY_SOLVE = {
    "labels",
    "poses",
    "objects",
    "quality",
    "restarts",
    "score",
    "chi2_per_dof",
    "dof",
    "settings",
    "settled",
}


def run(*arguments, cwd=None):
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-c", "import sys; from npslam_teach.cli import main; sys.exit(main())"]
    return subprocess.run(
        [*command, *map(str, arguments)], capture_output=True, text=True, cwd=cwd, env=environment, timeout=120
    )


def call(capsys, *arguments):
    """The same in this process: exit code, standard output, standard error."""
    try:
        code = parser.main([str(argument) for argument in arguments])
    except SystemExit as stop:
        code = stop.code
    out, err = capsys.readouterr()
    return code, out, err


def small_log(seed=0):
    rng = np.random.default_rng(seed)
    world = simulate.scattered_world(2, ("chair", "cup"), rng, size=6.0)
    line = np.column_stack([3 + 2 * np.cos(np.linspace(0, 13, 500)), 3 + 2 * np.sin(np.linspace(0, 13, 500))])
    return simulate.simulate_run(world, simulate.follow(line, 0.25), simulate.paper_sensor(0.0), rng)


def saved(folder, log, truth=None, name="whole.npz"):
    datasets.save_log(folder / name, log, truth)
    return folder / name


def assert_one_sentence(code, out, err, *words):
    assert code == 2
    assert out == ""
    assert err.count("\n") == 1 and err.endswith("\n")
    assert "Traceback" not in err
    for word in words:
        assert str(word) in err
