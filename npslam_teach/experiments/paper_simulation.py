"""The paper's simulation, run with every method over one or many seeds (paper section V.A; deck figures 14 to 17)."""

from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np

from npslam_teach import simulate
from npslam_teach.evaluation import chi2_per_dof, distances_to_truth, true_association_fit
from npslam_teach.experiments import tables
from npslam_teach.experiments.runs import Run, Scene, row_of, run_method
from npslam_teach.system.progress import track
from npslam_teach.types import GroundTruth, RobotLog, Snapshot

ERRORS = ("pose_error", "object_error", "ari", "chi2_per_dof")
TABLE_COLUMNS = ("seed", "noise", "method", "rounds", "objects", "used", *ERRORS)


def scenes(data: str | None, noise: float, seeds: Iterable[int]) -> Iterator[Scene]:
    """The runs to compare: our own scene drawn anew for every seed, or a log from a file with noise added.

    Args:
        data: a log with truth, or None for ``simulate.fifteen_objects``.
        noise: 1 is the paper's; see ``simulate.add_noise``.
        seeds: one run each.

    Raises:
        ValueError: when the file holds no truth, or the noise is negative.
    """
    simulate.paper_sensor(noise)  # refuses a noise that makes no sense before any file is read
    if data is None:
        return (Scene("fifteen_objects", s, noise, *simulate.fifteen_objects(s, noise)) for s in seeds)
    log, truth = recorded(data)
    return (with_noise_added(data, log, truth, noise, s) for s in seeds)


def recorded(path: str, is_complete: bool = True) -> tuple[RobotLog, GroundTruth]:
    """A log with its truth, from a file.

    Args:
        path: of the file.
        is_complete: whether all of the truth must be there; if not, some of it.

    Raises:
        ValueError: the truth is missing, or a part of it that is needed.
    """
    from npslam_teach import datasets

    log, truth = datasets.load_log(path)
    if truth is None or (is_complete and not truth.is_complete):
        got = "one without" if truth is None else "one that knows a part of them"
        raise ValueError(f"{path}: expected a log with the true poses and objects, got {got}")
    return log, truth


def with_noise_added(path: str, log: RobotLog, truth: GroundTruth, noise: float, seed: int) -> Scene:
    """A recorded log with noise of this seed, see ``simulate.add_noise``; named as its file."""
    return Scene(Path(path).name, seed, noise, simulate.add_noise(log, noise, np.random.default_rng(seed)), truth)


def run_all(
    scenes: Iterable[Scene], methods: list[str], iterations: int, num_scenes: int
) -> tuple[dict, Scene, dict[str, Run]]:
    """Run every method on every scene.

    Args:
        scenes: the runs.
        methods: names from ``methods.METHODS``.
        iterations: alternations of the NP-graph at most.
        num_scenes: how many there are, for the progress bar.

    Returns:
        the result as ``--json`` prints it; the first scene and its runs by method, for the figures.
    """
    rows, first = [], None
    for scene in track(scenes, num_scenes, "reproduce", "runs"):
        runs = {}
        for method in methods:
            settings = {"iterations": iterations} if method == "np-graph" else {}
            runs[method] = run_method(method, scene.log, settings)
            rows.append(row_of(scene, runs[method]))
        first = first or (scene, runs)
    scene, runs = first
    result = {
        "scene": describe(scene),
        "iterations_at_most": iterations,
        "iterations": [],
        "runs": rows,
        "summary": summarize(rows, methods),
    }
    if "np-graph" in runs:
        result["iterations"] = [iteration_row(snapshot, scene.truth) for snapshot in runs["np-graph"].snapshots]
    return result, scene, runs


def describe(scene: Scene) -> dict:
    """The numbers that a reader wants before anything else."""
    path = scene.truth.poses[:, :2]
    return {
        "name": scene.name,
        "seed": scene.seed,
        "noise": scene.noise,
        "num_poses": scene.log.num_poses,
        "num_observations": scene.log.num_observations,
        "num_objects": len(np.unique(scene.truth.obs_object[scene.truth.obs_object >= 0])),
        "num_classes": scene.log.num_classes,
        "path_length": float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum()),
        "chi2_per_dof_true_association": chi2_per_dof(true_association_fit(scene.log, scene.truth)),
    }


def iteration_row(snapshot: Snapshot, truth: GroundTruth) -> dict:
    """One line of the iteration table."""
    return {
        "iteration": snapshot.iteration,
        "num_objects": snapshot.num_objects,
        "chi2": snapshot.chi2,
        "objective": snapshot.objective,
        "mean_pose_error": float(distances_to_truth(snapshot, truth)[0].mean()),
    }


def summarize(rows: list[dict], methods: list[str]) -> dict:
    """Medians over the seeds, and the share of runs that found exactly the true number of objects."""
    summary = {}
    for method in methods:
        own = [row for row in rows if row["method"] == method]
        metrics = [row["metrics"] for row in own]
        counts = np.array([[_count_after(row, k) for k in range(4)] for row in own])
        found = np.array([m["num_objects"] == m["num_objects_true"] for m in metrics])
        after_five = [_count_after(row, 5) == row["metrics"]["num_objects_true"] for row in own]
        medians = {f"median_{name}": float(np.median([m[name] for m in metrics])) for name in metrics[0]}
        summary[method] = medians | {
            "num_runs": len(own),
            "num_exact": int(found.sum()),
            "share_exact": float(found.mean()),
            "share_exact_after_five": float(np.mean(after_five)),
            "median_counts_per_iteration": np.median(counts, axis=0).tolist(),
        }
    return summary


def _count_after(row: dict, iteration: int) -> int:
    """The number of objects after an iteration; a method that stopped earlier keeps its last."""
    counts = row["counts_per_iteration"]
    return counts[min(iteration, len(counts) - 1)]


def write_runs(rows: Iterable[dict], path: Path) -> None:
    """Write one line for each run: its end, and how many objects every round had.

    Args:
        rows: ``runs`` of the result of ``run_all``.
        path: of the table, which ``read_runs`` reads.
    """
    tables.write_table(map(table_row, rows), TABLE_COLUMNS, path)


def table_row(row: dict) -> dict:
    """A run as a line of the table, metres rounded to a tenth of a millimetre."""
    metrics = row["metrics"]
    names = ("mean_pose_error", "mean_object_error", "ari", "chi2_per_dof")
    values = (float("nan") if metrics[name] is None else metrics[name] for name in names)
    return {
        "seed": row["seed"],
        "noise": row["noise"],
        "method": row["method"],
        "rounds": " ".join(map(str, row["counts_per_iteration"])),
        "objects": row["num_objects"],
        "used": metrics["num_observations_used"],
    } | {column: round(value, 4) for column, value in zip(ERRORS, values, strict=True)}


def read_runs(path: Path) -> list[dict]:
    """The lines of ``write_runs``, ``rounds`` as a list of numbers.

    Raises:
        FileNotFoundError: there is no such file.
        ValueError: it is another file.
    """
    kinds = {"seed": int, "method": str, "objects": int, "used": int, "rounds": _numbers}
    return list(tables.read_table(path, TABLE_COLUMNS, kinds))


def _numbers(text: str) -> list[int]:
    return [int(word) for word in text.split()]
