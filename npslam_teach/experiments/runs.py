"""One method on one scene: the run itself, and the row of a table that it becomes."""

import time
from dataclasses import dataclass
from functools import cache

from npslam_teach import simulate
from npslam_teach.methods import METHODS
from npslam_teach.types import GroundTruth, RobotLog, Snapshot


@dataclass(frozen=True, eq=False)
class Scene:
    """One noisy run through a world, and how to tell it from the others."""

    name: str
    seed: int
    noise: float
    log: RobotLog
    truth: GroundTruth


@dataclass(frozen=True, eq=False)
class Run:
    """One method on one log, from the frame-by-frame start to the end."""

    method: str
    log: RobotLog
    snapshots: list[Snapshot]
    seconds: float  # of the method alone


def run_one(scene: Scene, method: str, settings: dict) -> dict:
    """Run a method on a scene: the row of a table, plain numbers that another process can send back.

    Args:
        scene: with truth to compare with.
        method: a key of ``methods.METHODS``.
        settings: keyword arguments of the method.
    """
    return row_of(scene, run_method(method, scene.log, settings, progress=False))


def row_of(scene: Scene, run: Run) -> dict:
    """The row that a run on a scene becomes."""
    return {"seed": scene.seed, "noise": scene.noise} | run_summary(run, scene.truth)


def run_method(method: str, log: RobotLog, settings: dict, progress: bool = True) -> Run:
    """Run a method by its name on the command line and keep every snapshot.

    Args:
        method: a key of ``methods.METHODS``.
        log: what the robot measured.
        settings: keyword arguments of the method.
        progress: whether a bar shows itself when the work takes longer than two seconds.
    """
    from tqdm import tqdm

    _warm_up(method)
    snapshots, steps = [], METHODS[method](log, **settings)
    with tqdm(steps, desc=method, unit=" iterations", delay=2, leave=False, disable=not progress) as bar:
        begin = time.perf_counter()
        for snapshot in bar:
            snapshots.append(snapshot)
            # A refresh now would show the bar at once, and leave it there.
            bar.set_postfix(objects=snapshot.num_objects, refresh=False)
        seconds = time.perf_counter() - begin
    return Run(method, log, snapshots, seconds)


@cache
def _warm_up(method: str) -> None:
    """Solve the toy scene once: whatever a method imports on its way, SciPy above all, is not its own time."""
    log, _ = simulate.toy_objects()
    for _ in METHODS[method](log):
        pass


def run_summary(run: Run, truth: GroundTruth | None) -> dict:
    """Everything about a run that is not an array."""
    last = run.snapshots[-1]
    summary = {
        "method": run.method,
        "num_objects": last.num_objects,
        "num_observations": run.log.num_observations,
        "counts_per_iteration": [snapshot.num_objects for snapshot in run.snapshots],
        "chi2": last.chi2,
        "objective": last.objective,
        "seconds": run.seconds,
    }
    if truth is not None:
        from npslam_teach.evaluation import evaluate

        summary["metrics"] = evaluate(last, truth, run.log).as_dict()
    return summary
