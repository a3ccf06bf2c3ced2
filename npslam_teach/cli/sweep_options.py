"""How ``sweep`` is asked: one option for each axis of the grid, who computes it, and where the rows go."""

import argparse
import contextlib
import functools
import warnings

from npslam_teach.cli.option_types import count, index, methods, number
from npslam_teach.cli.output_files import Once

_AXES = {"alpha": "A", "threshold": "P", "kernel_std": "M"}


def add_sweep_options(sweep: argparse.ArgumentParser) -> None:
    """Every axis takes values with commas between them."""
    text = "the table of rows, .csv or .parquet; where it exists the sweep goes on with what is missing"
    sweep.add_argument("--out", action=Once, metavar="FILE", required=True, help=text)
    sweep.add_argument("--methods", type=methods, default=["np-graph"], metavar="A,B", help="default np-graph")
    text = "fifteen_objects (default), a world of the gallery (such as twins), or files of logs with truth"
    sweep.add_argument("--scenes", type=_words, default=["fifteen_objects"], metavar="A,B", help=text)
    text = "1 is the paper's (default); 0 leaves a file as it is"
    sweep.add_argument("--noise", type=_values, default=[1.0], metavar="S,T", help=text)
    meaning = {
        "alpha": "concentration of the Dirichlet process",
        "threshold": "to accept the best match, a probability",
    }
    meaning["kernel_std"] = "width of the association kernel, m"
    for name, unit in _AXES.items():
        text = f"{meaning[name]}; 'own' is the method's own value (default)"
        sweep.add_argument(f"--{name.replace('_', '-')}", type=_values_or_own, metavar=f"{unit},..", help=text)
    text = "constants of the paper (default), or scaled to the log's own noise, or paper,sensor"
    sweep.add_argument("--settings", type=_words, default=["paper"], metavar="A,B", help=text)
    sweep.add_argument("--seeds", type=count, default=30, metavar="N", help="how many runs of each (default 30)")
    sweep.add_argument("--first-seed", type=index, default=0, metavar="K", help="default 0")
    text = "processes on this machine (default: one for each processor)"
    sweep.add_argument("--workers", type=count, metavar="N", help=text)
    sweep.add_argument("--dask", metavar="ADDRESS", help="of a Dask scheduler, tcp://HOST:8786, instead of processes")


def grid_of(options) -> list:
    """The points that were asked for, with a word on settings that some of the methods do not have."""
    from npslam_teach.experiments import sweep
    from npslam_teach.methods import METHODS

    settings = {name: getattr(options, name) for name in _AXES if getattr(options, name) is not None}
    seeds = range(options.first_seed, options.first_seed + options.seeds)
    points = sweep.grid(options.methods, seeds, options.noise, options.scenes, options.settings, **settings)
    for name in settings:
        without = [method for method in options.methods if name not in METHODS[method].settings]
        if without:
            option = f"--{name.replace('_', '-')}"
            warnings.warn(f"{option} has no effect on {', '.join(without)}, run once for all its values", stacklevel=2)
    for scene in options.scenes:
        sweep.scene_of(scene, options.noise[0], options.first_seed)  # what cannot be read is said at once
    return points


def pool_of(options):
    """What makes the executor that was asked for."""
    from npslam_teach.experiments import executors

    if options.dask is None:
        return functools.partial(executors.local_pool, options.workers)
    if options.workers is not None:
        raise ValueError("--workers: expected without --dask, because the cluster has its own")
    return functools.partial(executors.dask_pool, options.dask)


def run_sweep(options) -> tuple[int, int, int]:
    """Compute what is missing; returns how many points there are, how many were computed now, how many failed."""
    from npslam_teach.experiments import sweep, sweep_files
    from npslam_teach.system.interruption import critical_section
    from npslam_teach.system.progress import track

    points, pool, failed = grid_of(options), pool_of(options), 0
    with critical_section(), sweep_files.collect(options.out, points) as (missing, keep):
        with contextlib.closing(sweep.sweep(missing, pool)) as rows:
            for row in track(rows, len(missing), "sweep", "runs"):
                keep(row)
                failed += row["error"] is not None
    return len(points), len(missing), failed


def _words(text: str) -> list[str]:
    words = text.split(",")
    if "" in words or len(set(words)) < len(words):
        raise argparse.ArgumentTypeError(f"expected words with commas between them, each once, got {text!r}")
    return words


def _values(text: str) -> list[float]:
    return [number(word) for word in _words(text)]


def _values_or_own(text: str) -> list[float | None]:
    return [None if word == "own" else number(word) for word in _words(text)]
