"""The runs of lesson 13, made in advance: ``runs.csv``, which ``experiments.confused_classes`` can make again."""

from functools import cache
from pathlib import Path

import numpy as np

from npslam_teach.experiments.confused_classes import read_table

FILE = Path(__file__).parent / "runs.csv"


@cache
def load() -> tuple[dict, ...]:
    """Every run: a row with case, share, seed, objects, ari, ari_used and pose_error."""
    return tuple(read_table(FILE))


def column(name: str, case: str, share: float) -> np.ndarray:
    """One quantity of all rooms, in the order of their seeds.

    Args:
        name: of the column.
        case: of the table.
        share: of wrong reports.

    Raises:
        ValueError: the table has no such runs.
    """
    rows = [row for row in load() if row["case"] == case and row["share"] == share]
    if not rows:
        raise ValueError(f"case: expected one that was run at share {share:g}, got {case!r}")
    return np.array([row[name] for row in rows])
