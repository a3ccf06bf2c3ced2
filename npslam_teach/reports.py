"""The results of one run as plain dictionaries (for ``--json``) and as text (for people)."""

import math
import time
from dataclasses import dataclass

from npslam_teach.data import GroundTruth, RobotLog, Snapshot


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
        from npslam_teach.evaluate import evaluate

        summary["metrics"] = evaluate(last, truth, run.log).as_dict()
    return summary


def solve_result(run: Run, truth: GroundTruth | None) -> dict:
    """What ``solve --json`` prints: the summary, the association, the trajectory and the map."""
    last = run.snapshots[-1]
    counts = last.votes[:, 1:].sum(axis=1)
    objects = [
        {
            "xy": xy.tolist(),
            "class": int(votes[1:].argmax()),
            "votes": votes.tolist(),
            "num_observations": int(count),
        }
        for xy, votes, count in zip(last.graph.landmarks, last.votes, counts, strict=True)
    ]
    arrays = {"labels": last.labels.tolist(), "poses": last.graph.poses.tolist(), "objects": objects}
    return run_summary(run, truth) | arrays


def solve_text(result: dict) -> str:
    """The same for people."""
    lines = [
        f"method                {result['method']}",
        f"observations          {result['num_observations']}",
        f"objects               {' -> '.join(map(str, result['counts_per_iteration']))}",
        f"chi2                  {result['chi2']:.2f}",
        f"objective             {result['objective']:.2f}",
        f"seconds               {result['seconds']:.3f}",
    ]
    metrics = result.get("metrics")
    if metrics is None:
        return "\n".join([*lines, "the file holds no truth to compare with"])
    return "\n".join(
        [
            *lines,
            f"mean pose error       {metrics['mean_pose_error']:.3f} m",
            f"mean object error     {metrics['mean_object_error']:.3f} m",
            f"objects in truth      {metrics['num_objects_true']}",
            f"ARI, V-measure        {metrics['ari']:.3f}, {metrics['v_measure']:.3f}",
            f"observations used     {100 * metrics['observations_used']:.1f}%",
            f"chi2 per dof          {metrics['chi2_per_dof']:.3f}",
        ]
    )


def optimize_result(steps: list, chi2_initial: float, seconds) -> dict:
    """What ``optimize --json`` prints."""
    last = steps[-1]
    return {
        "chi2": last.chi2,
        "chi2_initial": chi2_initial,
        "start": "given" if math.isclose(steps[0].chi2, chi2_initial, rel_tol=1e-9) else "chordal",
        "iterations": last.iteration,
        "converged": last.converged,
        "status": last.status,
        "seconds": seconds,
        "poses": last.graph.poses.tolist(),
        "landmarks": last.graph.landmarks.tolist(),
    }


def optimize_text(result: dict) -> str:
    """The same for people."""
    seconds = result["seconds"] if isinstance(result["seconds"], list) else [result["seconds"]]
    return "\n".join(
        [
            f"poses, landmarks      {len(result['poses'])}, {len(result['landmarks'])}",
            f"chi2                  {result['chi2_initial']:.6g} -> {result['chi2']:.6f}",
            f"iterations            {result['iterations']} from the {result['start']} start ({result['status']})",
            f"seconds               {', '.join(f'{s:.4f}' for s in seconds)}",
        ]
    )


def plain(value):
    """The value as JSON can say it: NaN and infinity become null."""
    if isinstance(value, dict):
        return {key: plain(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [plain(entry) for entry in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def table(header: list[str], rows: list[list[str]]) -> str:
    """Columns side by side: the first to the left, the others to the right."""
    widths = [max(len(row[k]) for row in [header, *rows]) for k in range(len(header))]
    lines = [
        "  ".join([row[0].ljust(widths[0]), *(c.rjust(w) for c, w in zip(row[1:], widths[1:], strict=True))])
        for row in [header, *rows]
    ]
    return "\n".join(line.rstrip() for line in lines)
