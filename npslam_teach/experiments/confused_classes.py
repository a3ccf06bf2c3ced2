"""What does a detector cost that confuses classes, and who minds? The table of lesson 13.

It is made by

    python -m npslam_teach.experiments.confused_classes npslam_teach/course/soft_association/runs.csv

in about fifteen minutes on one core. A row is one run on ``fifteen_objects`` at the paper's noise, seen by a detector
that is wrong in a *share* of its reports, every wrong class alike. A *case* says what was run:

==================  ====================================================================================================
``np-graph``        the paper's method: a report is certain, and an object has one class
``ekf hard``        the filter of lesson 09 with the same rule
``ekf``             the filter with ``class_probabilities``, from the detector's own confusion matrix
``soft-em``         all matchings of a frame, each as probable as it is
``max-mixture``     the best matching of each frame alone
``posterior``       the posterior over partitions, which uses ``class_probabilities`` as well
``overconfident``   ``soft-em`` with the probabilities of a detector that claims to be wrong in two reports of a hundred
``true identities`` the pose graph alone, with known data association
==================  ====================================================================================================
"""

import sys
from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path

from npslam_teach import simulate
from npslam_teach.association.semantics import evenly_confused, reported
from npslam_teach.evaluation import compare_partitions, evaluate
from npslam_teach.experiments import tables
from npslam_teach.experiments.oracles import true_identities
from npslam_teach.methods import METHODS, soft_em
from npslam_teach.system.progress import progress_shown, track
from npslam_teach.types import GroundTruth, RobotLog, Snapshot

SEEDS = range(30)  # the first thirty rooms, whatever they are like
SHARES = (0.0, 0.1, 0.3, 0.5)
CLAIMED = 0.02  # by the detector that is too sure of itself
CASES = ("np-graph", "ekf hard", "ekf", "soft-em", "max-mixture", "posterior", "overconfident", "true identities")
COLUMNS = ("case", "share", "seed", "objects", "ari", "ari_used", "pose_error")
KINDS = {"case": str, "seed": int, "objects": int}


def room(seed: int, share: float, claimed: float | None = None) -> tuple[RobotLog, GroundTruth]:
    """The fifteen objects, seen by a detector that is wrong in a share of its reports.

    Args:
        seed: of the room.
        share: from 0 to 1.
        claimed: the share that the log's ``class_probabilities`` speak of; None: the true one.
    """
    num_classes = len(simulate.FIFTEEN_CLASSES)
    log, truth = simulate.fifteen_objects(seed, 1.0, evenly_confused(num_classes, share))
    claimed = share if claimed is None else claimed
    return replace(log, class_probabilities=reported(log.obs_class, evenly_confused(num_classes, claimed))), truth


def run_case(case: str, share: float, seed: int) -> dict:
    """One run: a row of the table, with the names of ``COLUMNS``.

    Raises:
        ValueError: there is no such case.
    """
    if case not in CASES:
        raise ValueError(f"case: expected one of {', '.join(CASES)}, got {case!r}")
    # Without any confusion the detector that claims some is too modest; a certain one has nothing to say.
    log, truth = room(seed, share, CLAIMED if case == "overconfident" else None)
    last = _answer(case, log, truth)
    found, used = evaluate(last, truth, log), last.labels >= 0
    return {
        "case": case,
        "share": share,
        "seed": seed,
        "objects": last.num_objects,
        "ari": round(found.ari, 4),
        "ari_used": round(compare_partitions(truth.obs_object[used], last.labels[used])[0], 4),
        "pose_error": round(found.mean_pose_error, 4),
    }


def _answer(case: str, log: RobotLog, truth: GroundTruth) -> Snapshot:
    if case == "true identities":
        return true_identities(log, truth)
    if case == "max-mixture":
        return list(soft_em(log, mixture="max"))[-1]
    if case == "ekf hard":
        log = replace(log, class_probabilities=None)
    method = {"ekf hard": "ekf", "overconfident": "soft-em"}.get(case, case)
    return list(METHODS[method](log))[-1]


def all_rows(seeds: Iterable[int] = SEEDS) -> Iterator[dict]:
    """Every run of the table on these rooms, room by room."""
    for seed in seeds:
        for share in SHARES:
            for case in CASES:
                yield run_case(case, share, seed)


def write_table(rows: Iterable[dict], path: Path) -> None:
    """Rows as a file of comma-separated values, sorted by case, share and seed."""
    in_order = sorted(rows, key=lambda row: (CASES.index(row["case"]), row["share"], row["seed"]))
    tables.write_table(in_order, COLUMNS, path)


def read_table(path: Path) -> list[dict]:
    """The rows of ``write_table``; raises as ``tables.read_table``."""
    return list(tables.read_table(path, COLUMNS, KINDS))


def main(path: str) -> None:
    """Make the table anew."""
    count = len(SEEDS) * len(SHARES) * len(CASES)
    with progress_shown():
        write_table(track(all_rows(SEEDS), count, "confused classes", "runs"), Path(path))


if __name__ == "__main__":
    main(*sys.argv[1:])
