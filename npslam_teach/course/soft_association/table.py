"""The runs of lesson 13, made in advance: ``runs.csv``, which ``experiments.confused_classes`` can make again."""

from functools import cache
from pathlib import Path

import numpy as np

from npslam_teach.experiments.confused_classes import read_table
from npslam_teach.experiments.tables import chosen

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
    return np.array([row[name] for row in chosen(load(), f"at share {share:g}", case=case, share=share)])
