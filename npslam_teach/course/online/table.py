"""The runs of lesson 15, made in advance.

``runs.csv`` can be made again by ``experiments.online_rooms``, ``methods.csv`` by ``experiments.method_table``.
"""

from functools import cache
from pathlib import Path

import numpy as np

from npslam_teach.experiments.method_summary import read_summary
from npslam_teach.experiments.online_rooms import read_table
from npslam_teach.experiments.tables import chosen

FILE = Path(__file__).parent / "runs.csv"
METHODS_FILE = FILE.with_name("methods.csv")


@cache
def load() -> tuple[dict, ...]:
    """Every tenth of every run: a row with the columns of ``experiments.online_rooms``."""
    return tuple(read_table(FILE))


@cache
def all_methods() -> tuple[dict, ...]:
    """Every method at every noise: a row with the columns of ``experiments.method_summary``."""
    return tuple(read_summary(METHODS_FILE))


def column(name: str, case: str, rooms: int, seed: int = 0) -> np.ndarray:
    """One quantity, tenth by tenth.

    Args:
        name: of the column.
        case: "told" or "online".
        rooms: of the building.
        seed: of the building.

    Raises:
        ValueError: the table has no such run.
    """
    rows = chosen(load(), f"in {rooms} rooms of seed {seed}", case=case, rooms=rooms, seed=seed)
    return np.array([row[name] for row in rows])
