"""How good must a heading be to tell two chairs apart that stand back to back? The table of lesson 14.

It is made by

    python -m npslam_teach.experiments.back_to_back npslam_teach/course/orientation/runs.csv

in about an hour on one core. A hall holds four pairs of equal chairs, back to back and 0.25 m apart; the camera
errs by 0.15 m, so that centroids cannot decide, and the robot drives around them twice. A row is one run on one hall. A
*case* is a method, or ``true identities``, the pose graph alone, told who is who. ``degrees`` says how much a heading
errs, the log's ``observation_theta_std``; 0 stands for a log without headings. Whatever the degrees, a seed has the
same path, places and noise of them.
"""

import sys
from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from npslam_teach import simulate
from npslam_teach.evaluation import evaluate
from npslam_teach.experiments import tables
from npslam_teach.experiments.oracles import true_identities
from npslam_teach.methods import METHODS, settings_for, without_headings
from npslam_teach.system.progress import progress_shown, track
from npslam_teach.types import GroundTruth, RobotLog, SensorModel, Snapshot, World

SEEDS = range(30)  # the first thirty halls, whatever they are like
DEGREES = (0.0, 2.0, 10.0, 20.0, 30.0, 45.0, 60.0, 90.0)
CASES = ("np-graph", "ekf", "posterior", "true identities")
COLUMNS = ("case", "degrees", "seed", "objects", "ari", "pose_error")
KINDS = {"case": str, "seed": int, "objects": int}
GAP = 0.25  # m, between the two chairs of a pair
CENTRES = ((1.4, 1.4), (-1.4, 1.4), (-1.4, -1.4), (1.4, -1.4))  # m, W, of the pairs
TURN = 1.1  # rad, by which each pair is turned against the one before


def hall(seed: int, degrees: float, gap: float = GAP, symmetry: int = 1) -> tuple[RobotLog, GroundTruth]:
    """Four pairs of equal chairs, back to back, and two rounds about them.

    Args:
        seed: of all noise.
        degrees: the standard deviation of a heading; 0: the log has none.
        gap: m, between the two chairs of a pair.
        symmetry: how many headings of a chair look alike; 2: it has two fronts.
    """
    turn = TURN * np.repeat(np.arange(len(CENTRES)), 2) + np.tile([0.0, np.pi], len(CENTRES))
    places = np.repeat(CENTRES, 2, axis=0) + gap / 2 * np.column_stack([np.cos(turn), np.sin(turn)])
    world = World(places, np.zeros(len(places), dtype=int), ("chair",), turn)
    around = np.linspace(0.0, 4 * np.pi, 200)
    # A little to the inside, so that the chairs are in view.
    path = np.column_stack([3.4 * np.cos(around), 3.4 * np.sin(around), around + np.pi / 2 + 0.9])
    sensor = SensorModel(
        (0.02, 0.02, 0.01),
        (0.15, 0.15),
        max_range=4.0,
        field_of_view=2.2,
        detection_probability=0.6,
        observation_theta_std=np.deg2rad(degrees or 1.0),
        class_symmetry=[symmetry],
    )
    log, truth = simulate.simulate_run(world, path, sensor, np.random.default_rng(seed))
    return (log if degrees else replace(without_headings(log), class_symmetry=None)), truth


def run_case(case: str, degrees: float, seed: int) -> dict:
    """One run: a row of the table, with the names of ``COLUMNS``.

    Raises:
        ValueError: there is no such case.
    """
    if case not in CASES:
        raise ValueError(f"case: expected one of {', '.join(CASES)}, got {case!r}")
    log, truth = hall(seed, degrees)
    last = answer(case, log, truth)
    found = evaluate(last, truth, log)
    return {
        "case": case,
        "degrees": degrees,
        "seed": seed,
        "objects": last.num_objects,
        "ari": round(found.ari, 4),
        "pose_error": round(found.mean_pose_error, 4),
    }


def answer(case: str, log: RobotLog, truth: GroundTruth) -> Snapshot:
    """The last snapshot of a case; the paper's method with its constants scaled to the sensor."""
    if case == "true identities":
        return true_identities(log, truth)
    settings = settings_for(log) if case == "np-graph" else {}
    return list(METHODS[case](log, **settings))[-1]


def all_rows(seeds: Iterable[int] = SEEDS) -> Iterator[dict]:
    """Every run of the table on these halls, hall by hall."""
    for seed in seeds:
        for degrees in DEGREES:
            for case in CASES:
                yield run_case(case, degrees, seed)


def write_table(rows: Iterable[dict], path: Path) -> None:
    """Rows as a file of comma-separated values, sorted by case, degrees and seed."""
    in_order = sorted(rows, key=lambda row: (CASES.index(row["case"]), row["degrees"], row["seed"]))
    tables.write_table(in_order, COLUMNS, path)


def read_table(path: Path) -> list[dict]:
    """The rows of ``write_table``; raises as ``tables.read_table``."""
    return list(tables.read_table(path, COLUMNS, KINDS))


def main(path: str) -> None:
    """Make the table anew."""
    count = len(SEEDS) * len(DEGREES) * len(CASES)
    with progress_shown():
        write_table(track(all_rows(SEEDS), count, "back to back", "runs"), Path(path))


if __name__ == "__main__":
    main(*sys.argv[1:])
