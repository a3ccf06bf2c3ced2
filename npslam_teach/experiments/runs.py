"""One method on one log."""

import time
from dataclasses import dataclass

from npslam_teach.types import GroundTruth, RobotLog, Snapshot


@dataclass(frozen=True, eq=False)
class Run:
    """One method on one log, from the frame-by-frame start to the end."""

    method: str
    log: RobotLog
    snapshots: list[Snapshot]
    seconds: float


def run_method(method: str, log: RobotLog, settings: dict) -> Run:
    """Run a method by its name on the command line and keep every snapshot.

    Args:
        method: a key of ``methods.METHODS``.
        log: what the robot measured.
        settings: keyword arguments of the method.
    """
    from tqdm import tqdm

    from npslam_teach.methods import METHODS

    begin = time.perf_counter()
    snapshots = []
    # The bar shows itself only when the work takes longer than two seconds.
    with tqdm(METHODS[method](log, **settings), desc=method, unit=" iterations", delay=2, leave=False) as progress:
        for snapshot in progress:
            snapshots.append(snapshot)
            # A refresh now would show the bar at once, and leave it there.
            progress.set_postfix(objects=snapshot.num_objects, refresh=False)
    return Run(method, log, snapshots, time.perf_counter() - begin)


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
