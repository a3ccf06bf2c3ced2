"""The runs of lesson 10, made in advance: ``success.csv``, which ``experiments.what_breaks`` can make again."""

from functools import cache
from pathlib import Path

import numpy as np

from npslam_teach.association import PAPER_KERNEL_STD
from npslam_teach.evaluation import wilson_interval
from npslam_teach.experiments.tables import chosen
from npslam_teach.experiments.what_breaks import SWEPT, is_right, read_table

FILE = Path(__file__).parent / "success.csv"
PAPERS_VALUE = {"alpha": 0.9, "threshold": None, "kernel_std": round(PAPER_KERNEL_STD, 3)}


@cache
def load() -> tuple[dict, ...]:
    """Every run: a row with case, noise, seed, objects, ari, ari_used, pose_error and objective."""
    return tuple(read_table(FILE))


def runs_of(case: str, noise: float) -> list[dict]:
    """The runs of one case at one noise, in the order of their seeds.

    Raises:
        ValueError: the table has none.
    """
    return chosen(load(), f"at noise {noise:g}", case=case, noise=noise)


def right_of(case: str, noise: float, of_used: bool = False) -> np.ndarray:
    """(30,) bool, in the order of the seeds: fifteen objects, and ARI at least 0.99.

    Args:
        case: of the table.
        noise: at which it was run.
        of_used: take the ARI over only those observations that the method did not leave out.
    """
    rows = runs_of(case, noise)
    return np.array([is_right(row | {"ari": row["ari_used"]} if of_used else row) for row in rows])


def noises_of(case: str) -> list[float]:
    """The noises at which a case was run."""
    return sorted({row["noise"] for row in load() if row["case"] == case})


def share_of(case: str, noise: float, of_used: bool = False) -> tuple[int, int, float, float]:
    """How many runs were right, of how many, and the ends of the 95 % interval of the share; see ``right_of``."""
    right = right_of(case, noise, of_used)
    low, high = wilson_interval(right.sum(), len(right))
    return int(right.sum()), len(right), float(low), float(high)


def swept(setting: str) -> dict:
    """The values of a setting that were run, the paper's own among them, and the case of each; nothing else is changed.

    Args:
        setting: "alpha", "threshold" or "kernel_std".
    """
    papers = PAPERS_VALUE[setting]
    cases = {value: f"{setting} {value:g}" for value in SWEPT[setting]} | {papers: "np-graph"}
    return dict(sorted(cases.items(), key=lambda entry: -1.0 if entry[0] is None else entry[0]))
