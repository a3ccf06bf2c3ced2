"""The runs of lesson 12, made in advance: the tables beside this file, which ``experiments.real_robot`` makes anew."""

from functools import cache
from pathlib import Path

import numpy as np

from npslam_teach.experiments.real_robot import COLUMNS, LABEL_COLUMNS, NOISE_COLUMNS, Case, read_table

FOLDER = Path(__file__).parent
HEADINGS = {
    "objects": "objects",
    "ari": "ARI",
    "pose_error": "path off by (m)",
    "twice": "twice in a frame",
    "chi2_per_dof": "chi2 per dof",
}


@cache
def _runs() -> tuple[dict, ...]:
    return tuple(read_table(FOLDER / "runs.csv", COLUMNS))


@cache
def _noise() -> tuple[dict, ...]:
    return tuple(read_table(FOLDER / "noise.csv", NOISE_COLUMNS))


def runs_of(method: str, noise: str = "own", factor: float = 1.0, classes: int = 5) -> list[dict]:
    """The rows of a case in the order of their seeds; see ``experiments.real_robot`` for what the words mean.

    Raises:
        ValueError: the table has none.
    """
    case = Case(method, noise, factor, classes)
    rows = [row for row in _runs() if Case(*(row[name] for name in Case._fields)) == case]
    if not rows:
        raise ValueError(f"case: expected one that was run, got {case}")
    return rows


def column(name: str, method: str, noise: str = "own", factor: float = 1.0, classes: int = 5) -> np.ndarray:
    """One column of ``runs_of``, (12,)."""
    return np.array([row[name] for row in runs_of(method, noise, factor, classes)])


def noise_of(name: str) -> np.ndarray:
    """A column (12,) of the estimates of the noise."""
    return np.array([row[name] for row in _noise()])


def labels_of(method: str, factor: float) -> np.ndarray:
    """(M,) what a method says of recording 0.

    Raises:
        ValueError: it is not stored.
    """
    for row in read_table(FOLDER / "labels.csv", LABEL_COLUMNS):
        if (row["method"], row["factor"]) == (method, factor):
            return np.array(row["labels"].split(), dtype=int)
    raise ValueError(f"labels: expected a method and factor of labels.csv, got {method} and {factor:g}")


def median_and_range(values, decimals: int) -> str:
    """Median and the whole spread in words: ``17 (15 to 22)``."""
    shown = (f"{value:.{decimals}f}" for value in (np.median(values), np.min(values), np.max(values)))
    return "{} ({} to {})".format(*shown)


def compared(cases: dict, columns: dict) -> str:
    """A table as text: median and whole spread over all recordings.

    Args:
        cases: name of the row to the case, the arguments of ``runs_of``.
        columns: name of the column to how many decimals.
    """
    first = 2 + max(map(len, cases))
    lines = [" " * first + "".join(f"{HEADINGS[name]:>25}" for name in columns)]
    for row, case in cases.items():
        values = (median_and_range(column(name, *case), decimals) for name, decimals in columns.items())
        lines.append(f"{row:{first}}" + "".join(f"{value:>25}" for value in values))
    return "\n".join(lines)


def winners(methods: tuple[str, ...]) -> str:
    """Who is best, by number of objects, partition and path: in the median, and in how many recordings.

    Where several are best in a recording, none of them has won it.
    """
    losses = {
        "number": lambda name: np.abs(column("objects", name) - column("seen", name)),
        "partition (ARI)": lambda name: -column("ari", name),
        "path": lambda name: column("pose_error", name),
    }
    lines = []
    for what, loss_of in losses.items():
        loss = np.array([loss_of(name) for name in methods])
        best = methods[np.median(loss, axis=1).argmin()]
        wins = ((loss == loss.min(axis=0)) & ((loss == loss.min(axis=0)).sum(axis=0) == 1)).sum(axis=1)
        shares = ", ".join(f"{name} {count}" for name, count in zip(methods, wins, strict=True))
        lines.append(f"{what}: {best} in the median; alone the best in {loss.shape[1]} recordings: {shares}")
    return "\n".join(lines)
