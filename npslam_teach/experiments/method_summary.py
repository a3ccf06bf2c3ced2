"""The rows of the sweep behind ``method_table`` in short: one for each method and noise, which lesson 15 draws."""

from collections.abc import Iterable
from pathlib import Path

import numpy as np

from npslam_teach.experiments import tables
from npslam_teach.experiments.sweep import is_right
from npslam_teach.methods import METHODS

COLUMNS = ("method", "noise", "runs", "exact", "seconds")
KINDS = {"method": str, "runs": int, "exact": int}


def summary(rows: Iterable[dict]) -> list[dict]:
    """How many runs of each method are exact at each noise, and the median of their seconds.

    Args:
        rows: of a sweep over noise and seeds.

    Returns:
        rows with the names of ``COLUMNS``, in the order of the methods, and of the noise.
    """
    runs = {}
    for row in rows:
        runs.setdefault((row["method"], row["noise"]), []).append(row)
    order = sorted(runs, key=lambda key: (list(METHODS).index(key[0]), key[1]))
    lines = []
    for key in order:
        seconds = [row["seconds"] for row in runs[key] if row["seconds"] is not None]
        spent = float(f"{np.median(seconds):.3g}") if seconds else float("nan")
        values = *key, len(runs[key]), sum(map(is_right, runs[key])), spent
        lines.append(dict(zip(COLUMNS, values, strict=True)))
    return lines


def read_summary(path: Path) -> list[dict]:
    """The rows of ``summary`` in a file; raises as ``tables.read_table``."""
    return list(tables.read_table(path, COLUMNS, KINDS))
