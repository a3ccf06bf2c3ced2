"""The runs of lesson 14, made in advance: ``runs.csv``, which ``experiments.back_to_back`` can make again."""

from functools import cache
from pathlib import Path

import numpy as np

from npslam_teach.experiments.back_to_back import read_table
from npslam_teach.experiments.tables import chosen

FILE = Path(__file__).parent / "runs.csv"


@cache
def load() -> tuple[dict, ...]:
    """Every run: a row with case, degrees, seed, objects, ari and pose_error."""
    return tuple(read_table(FILE))


def column(name: str, case: str, degrees: float) -> np.ndarray:
    """One quantity of all halls, in the order of their seeds.

    Args:
        name: of the column.
        case: of the table.
        degrees: by which a heading errs; 0: without headings.

    Raises:
        ValueError: the table has no such runs.
    """
    rows = chosen(load(), f"with {degrees:g} degrees", case=case, degrees=degrees)
    return np.array([row[name] for row in rows])
