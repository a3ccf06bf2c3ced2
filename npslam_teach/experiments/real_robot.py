"""Methods on recordings of a robot that errs as real ones do: the tables of lesson 12.

They are made by

    python -m npslam_teach.experiments.real_robot npslam_teach/course/a_real_robot

in about a quarter of an hour on one core: ``runs.csv`` has one row for each run of a method on ``simulate.recording``,
written as text files and imported from them; ``noise.csv`` one row for each estimate of the noise from a log itself;
``labels.csv`` the answers of one method on one recording.

A log's own standard deviations are root mean squares against motion capture. *Factor* is what both are multiplied by
before anybody sees them; *noise* is "paper" (the paper's constants), "own" (the log's, after the factor) or "estimated"
(by ``estimate_noise``, which begins with the log's own after the factor).
"""

import sys
import tempfile
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import NamedTuple

from npslam_teach import datasets, simulate
from npslam_teach.evaluation import evaluate
from npslam_teach.experiments import tables
from npslam_teach.experiments.oracles import true_identities
from npslam_teach.methods import METHODS, NoiseEstimate, estimate_noise, settings_for
from npslam_teach.methods.gating import twice_in_a_frame
from npslam_teach.methods.noise import with_noise
from npslam_teach.methods.snapshots import snapshot
from npslam_teach.pose_graph import fit
from npslam_teach.system.progress import progress_shown, track
from npslam_teach.types import GroundTruth, RobotLog, Snapshot

SEEDS = range(12)  # the first twelve recordings, whatever they are like
FACTORS = (0.25, 0.5, 1.0, 2.0, 4.0)
COMPARED = ("np-graph", "ekf", "posterior")  # those that are run with every factor
DATA_SHEET = 0.25  # of the true noise: what the estimates of the noise begin with
KNOWN = "true identities"
CASE_COLUMNS = ("method", "noise", "factor", "classes", "seed")
COLUMNS = (*CASE_COLUMNS, "objects", "seen", "ari", "pose_error", "used", "chi2_per_dof", "twice")
LABEL_COLUMNS = ("method", "factor", "labels")
NOISE_COLUMNS = ("seed", "odometry", "observation", "within", "outliers", "rounds", "converged")
TEXTS = ("method", "noise", "labels")


class Case(NamedTuple):
    """What is run on every recording."""

    method: str
    noise: str = "own"
    factor: float = 1.0
    classes: int = 5


def cases() -> list[Case]:
    """Every case of ``runs.csv``."""
    found = [Case(name) for name in (*METHODS, KNOWN)] + [Case("np-graph", "paper")]
    found += [Case(name, "own", factor) for factor in FACTORS if factor != 1 for name in COMPARED]
    found += [Case(name, "estimated", DATA_SHEET) for name in COMPARED]
    return found + [Case(name, "own", 1.0, 1) for name in COMPARED] + [Case("np-graph", "repeated", 1.0, 1)]


@cache
def imported(seed: int, classes: int = 5) -> tuple[RobotLog, GroundTruth]:
    """A recording written as MRCLAM's text files, and read from them."""
    with tempfile.TemporaryDirectory() as folder:
        simulate.write_mrclam(simulate.recording(seed), folder)
        return datasets.load_mrclam(folder, 1, classes)


def scaled(log: RobotLog, factor: float) -> RobotLog:
    """The same measurements, said to err so many times as much."""
    return with_noise(log, factor * log.odometry_std, factor * log.observation_std)


@cache
def estimated(seed: int) -> NoiseEstimate:
    """The noise of a recording from the log itself; the search begins with what the data sheet says."""
    return estimate_noise(scaled(imported(seed)[0], DATA_SHEET))


def log_of(case: Case, seed: int) -> RobotLog:
    """What the method of a case is given."""
    log = scaled(imported(seed, case.classes)[0], case.factor)
    return estimated(seed).applied_to(log) if case.noise == "estimated" else log


def run_case(case: Case, seed: int) -> Snapshot:
    """The answer of a method.

    Raises:
        ValueError: there is no such method.
    """
    if case.method not in (*METHODS, KNOWN):
        raise ValueError(f"method: expected one of {', '.join((*METHODS, KNOWN))}, got {case.method!r}")
    log, (_, truth) = log_of(case, seed), imported(seed, case.classes)
    if case.method == KNOWN:
        return true_identities(log, truth)
    settings = METHODS[case.method].scaled_by(settings_for(log))
    if case.noise == "repeated":
        settings["exclusive"] = False
    return answer_of(case.method, log, {} if case.noise == "paper" else settings)


def answer_of(method: str, log: RobotLog, settings: dict) -> Snapshot:
    """The last snapshot of a method; with the filter's labels, the pose graph's map.

    As the command line does: the filter says who is who, and the graph where, with all that came later.
    """
    *_, last = METHODS[method](log, **settings)
    return snapshot(log, 2, last.labels, fit(log, last.labels, last.graph.poses)) if method == "ekf" else last


def row_of(case: Case, seed: int, last: Snapshot) -> dict:
    """A row of ``runs.csv``, with the names of ``COLUMNS``."""
    log, truth = log_of(case, seed), imported(seed, case.classes)[1]
    found = evaluate(last, truth, log)
    measured = {
        "objects": found.num_objects,
        "seen": int(found.num_objects_true),
        "ari": round(found.ari, 4),
        "pose_error": round(found.mean_pose_error, 4),
        "used": found.num_observations_used,
        "chi2_per_dof": round(found.chi2_per_dof, 3),
        "twice": twice_in_a_frame(log, last.labels),
    }
    return case._asdict() | {"seed": seed} | measured


def noise_row(seed: int) -> dict:
    """A row of ``noise.csv``: standard deviations as multiples of the log's own against motion capture."""
    log, found = imported(seed)[0], estimated(seed)
    return {
        "seed": seed,
        "odometry": round(float(found.odometry_std[0] / log.odometry_std[0]), 4),
        "observation": round(float(found.observation_std[0] / log.observation_std[0]), 4),
        "within": round(float(found.within_pass_std[0] / log.observation_std[0]), 4),
        "outliers": round(found.outlier_share, 4),
        "rounds": found.rounds,
        "converged": int(found.converged),
    }


def labels_row(factor: float, seed: int = 0) -> dict:
    """A row of ``labels.csv``: what the slowest method says of every observation, for a lesson to draw at once."""
    labels = run_case(Case("posterior", "own", factor), seed).labels
    return {"method": "posterior", "factor": factor, "labels": " ".join(map(str, labels.tolist()))}


def read_table(path: Path, columns: tuple) -> Iterator[dict]:
    """The rows of one of the three tables, numbers as numbers; raises as ``tables.read_table``."""
    return tables.read_table(path, columns, {name: str for name in TEXTS if name in columns})


def main(folder: str) -> None:
    """Make all tables anew."""
    with progress_shown():
        runs = [(case, seed) for case in cases() for seed in SEEDS]
        rows = (row_of(case, seed, run_case(case, seed)) for case, seed in track(runs, len(runs), "runs", "runs"))
        tables.write_table(rows, COLUMNS, Path(folder) / "runs.csv")
        tables.write_table(map(noise_row, SEEDS), NOISE_COLUMNS, Path(folder) / "noise.csv")
        tables.write_table(map(labels_row, FACTORS), LABEL_COLUMNS, Path(folder) / "labels.csv")


if __name__ == "__main__":
    main(*sys.argv[1:])
