"""Where does the paper's method stop working? Many runs over noise and settings, and the table of lesson 10.

The table is made by

    python -m npslam_teach.experiments.what_breaks npslam_teach/course/what_breaks/success.csv

in about thirteen minutes on one core. A row is one run on ``fifteen_objects``; a *case* says what was run:

=====================  ================================================================================================
``np-graph``           the paper's method with the paper's settings, as all cases where nothing else is said
``np-graph sensor``    with ``settings_for(log)``: kernel and solver scaled with the noise, one object once a frame
``np-graph repeated``  the same, but one object may be seen twice in a frame: kernel and solver are scaled, nothing else
``ekf``, ...           another method with its defaults
``kernel_std 0.5``     one setting changed; the same for alpha and threshold
``order 3``            the observations visited in the third random order; also ``order first-to-last``
``30 rounds``          until no label changes any more, 30 alternations at most; and with ``sensor``
``true poses``         every pose held at the truth (``oracles.poses_at_truth``); also with ``sensor``, ``repeated``
``true start``         from the right answer (``oracles.from_the_truth``); also with ``sensor``, ``repeated``
``true identities``    the pose graph alone, with known data association
=====================  ================================================================================================
"""

import sys
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np

from npslam_teach import simulate
from npslam_teach.evaluation import compare_partitions
from npslam_teach.experiments import tables
from npslam_teach.experiments.oracles import from_the_truth, poses_at_truth, true_identities
from npslam_teach.experiments.runs import LEAST_ARI, Run, Scene, row_of, run_method
from npslam_teach.methods import METHODS, settings_for
from npslam_teach.system.progress import progress_shown, track

SEEDS = range(30)  # the first thirty rooms, whatever they are like
NOISES = (0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0)  # of the paper's own
SWEPT = {
    "alpha": (0.01, 0.1, 0.5, 0.99),
    "threshold": (0.01, 0.03, 0.1, 0.3),
    "kernel_std": (0.15, 0.25, 0.5, 0.7, 1.0),
}
RANDOM_ORDERS = 4
COLUMNS = ("case", "noise", "seed", "objects", "ari", "ari_used", "pose_error", "objective")
KINDS = {"case": str, "seed": int, "objects": int, "objective": lambda text: float(text) if text else None}
NUM_TRUE = 15


def noises_by_case() -> dict[str, tuple]:
    """Every case of the table, and at which noises it is run."""
    compared = ("np-graph", "np-graph sensor", "np-graph repeated", "ekf", "robust-slam", "frame-by-frame")
    cases = dict.fromkeys(compared, NOISES)
    for name, values in SWEPT.items():
        noises = (1.0, 2.0, 3.0, 4.0) if name == "kernel_std" else (1.0, 2.0, 3.0)
        cases |= dict.fromkeys((f"{name} {value:g}" for value in values), noises)
    orders = ["order first-to-last"] + [f"order {k}" for k in range(1, RANDOM_ORDERS + 1)]
    cases |= dict.fromkeys(orders, (1.0, 2.0, 3.0))
    oracles = [f"{oracle}{kind}" for oracle in ("true poses", "true start") for kind in ("", " sensor", " repeated")]
    others = ("30 rounds", "30 rounds sensor", *oracles, "true identities", "posterior")
    return cases | dict.fromkeys(others, (1.0, 2.0, 3.0, 4.0))


def run_case(case: str, scene: Scene) -> dict:
    """One run: a row of the table, with the names of ``COLUMNS``.

    Args:
        case: a key of ``noises_by_case``.
        scene: with truth.

    Raises:
        ValueError: there is no such case.
    """
    log, truth = scene.log, scene.truth
    if case not in noises_by_case():
        raise ValueError(f"case: expected one of {', '.join(noises_by_case())}, got {case!r}")
    sensor = settings_for(log) if case.endswith((" sensor", " repeated")) else {}
    if case.endswith(" repeated"):
        sensor["exclusive"] = False
    if case.startswith("true poses"):
        run = Run("np-graph", log, [poses_at_truth(log, truth, **sensor)], 0.0)
    elif case.startswith("true start"):
        run = Run("np-graph", log, [from_the_truth(log, truth, **sensor)], 0.0)
    elif case == "true identities":
        run = Run("np-graph", log, [true_identities(log, truth)], 0.0)
    elif case in METHODS:
        run = run_method(case, log, {})
    else:
        changed = _changed(case.removesuffix(" sensor").removesuffix(" repeated"), log.num_observations)
        run = run_method("np-graph", log, sensor | changed)
    return _row(case, scene, run)


def _changed(case: str, num_observations: int) -> dict:
    """What a case changes of the paper's settings."""
    if case == "np-graph":
        return {}
    if case == "30 rounds":
        return {"iterations": 30}
    name, value = case.split(" ")
    if name != "order":
        return {name: float(value)}
    is_random = value.isdigit()
    return {name: np.random.default_rng(int(value)).permutation(num_observations) if is_random else value}


def _row(case: str, scene: Scene, run: Run) -> dict:
    row, last = row_of(scene, run), run.snapshots[-1]
    metrics, used = row["metrics"], last.labels >= 0
    return {
        "case": case,
        "noise": scene.noise,
        "seed": scene.seed,
        "objects": row["num_objects"],
        "ari": round(metrics["ari"], 4),
        "ari_used": round(compare_partitions(scene.truth.obs_object[used], last.labels[used])[0], 4),
        "pose_error": round(metrics["mean_pose_error"], 4),
        "objective": None if row["objective"] is None else round(row["objective"], 2),
    }


def is_right(row: dict) -> bool:
    """Whether a run found exactly the fifteen objects, and next to every observation's own: ARI at least 0.99."""
    return row["objects"] == NUM_TRUE and row["ari"] >= LEAST_ARI


def scene_of(seed: int, noise: float) -> Scene:
    """The room of a seed, with so much noise."""
    return Scene("fifteen_objects", seed, noise, *simulate.fifteen_objects(seed, noise))


def all_rows(seeds: Iterable[int] = SEEDS) -> Iterator[dict]:
    """Every run of the table on these rooms, room by room."""
    for seed in seeds:
        for noise in NOISES:
            scene = scene_of(seed, noise)
            for case, noises in noises_by_case().items():
                if noise in noises:
                    yield run_case(case, scene)


def write_table(rows: Iterable[dict], path: Path) -> None:
    """Rows as a file of comma-separated values, sorted by case, noise and seed."""
    place = {case: k for k, case in enumerate(noises_by_case())}
    in_order = sorted(rows, key=lambda row: (place[row["case"]], row["noise"], row["seed"]))
    tables.write_table(in_order, COLUMNS, path)


def read_table(path: Path) -> list[dict]:
    """The rows of ``write_table``; raises as ``tables.read_table``."""
    return list(tables.read_table(path, COLUMNS, KINDS))


def main(path: str) -> None:
    """Make the table anew."""
    count = len(SEEDS) * sum(len(noises) for noises in noises_by_case().values())
    with progress_shown():
        write_table(track(all_rows(SEEDS), count, "what breaks", "runs"), Path(path))


if __name__ == "__main__":
    main(*sys.argv[1:])
