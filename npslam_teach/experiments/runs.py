"""One method on one scene: the run itself, and the row of a table that it becomes."""

import time
from dataclasses import dataclass
from functools import cache

from npslam_teach import simulate
from npslam_teach.methods import METHODS
from npslam_teach.system.progress import track
from npslam_teach.types import GroundTruth, PoseGraph, RobotLog, Snapshot

LEAST_ARI = 0.99  # over all observations, of a run that is right


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
    return row_of(scene, run_method(method, scene.log, settings))


def row_of(scene: Scene, run: Run) -> dict:
    """The row that a run on a scene becomes."""
    return {"seed": scene.seed, "noise": scene.noise} | run_summary(run, scene.truth)


def run_method(method: str, log: RobotLog, settings: dict) -> Run:
    """Run a method by its name on the command line and keep every snapshot.

    Args:
        method: a key of ``methods.METHODS``.
        log: what the robot measured.
        settings: keyword arguments of the method.
    """
    _warm_up(method)
    steps, most = METHODS[method](log, **settings), METHODS[method].settings.get("iterations")
    if most is not None:  # an alternation; other methods count what they loop over themselves
        steps = track(steps, 1 + settings.get("iterations", most), method, "iterations")
    begin = time.perf_counter()
    snapshots = list(steps)
    return Run(method, log, snapshots, time.perf_counter() - begin)


@cache
def _warm_up(method: str) -> None:
    """Solve the toy scene once: whatever a method imports on its way, SciPy above all, is not its own time."""
    log, _ = simulate.toy_objects()
    for _ in METHODS[method](log):
        pass


def run_summary(run: Run, truth: GroundTruth | None, refitted: PoseGraph | None = None) -> dict:
    """Everything about a run that is not an array.

    Args:
        run: that is over.
        truth: what really happened, as far as it is known.
        refitted: ``evaluation.refit`` of the run's end, where it is at hand.
    """
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

        summary["metrics"] = evaluate(last, truth, run.log, refitted).as_dict()
    return summary
