"""Tables of runs as files of comma-separated values: written by experiments, read by lessons."""

import csv
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

from npslam_teach.system.files import atomic_write


def write_table(rows: Iterable[dict], columns: tuple, path: Path) -> None:
    """Write rows, each with the names of the columns."""
    with atomic_write(path) as stream:
        writer = csv.DictWriter(stream, columns, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def chosen(rows: Iterable[dict], how: str, **which) -> list[dict]:
    """The rows that have these values.

    Args:
        rows: of a table with a column ``case``.
        how: the runs are meant, for the message.
        which: by column; ``case`` is one of them.

    Raises:
        ValueError: there are none.
    """
    found = [row for row in rows if which.items() <= row.items()]
    if not found:
        raise ValueError(f"case: expected one that was run {how}, got {which['case']!r}")
    return found


def read_table(path: Path, columns: tuple, kinds: dict[str, Callable] | None = None) -> Iterator[dict]:
    """The rows of ``write_table``.

    Args:
        path: of the file.
        columns: the names that it must have.
        kinds: by column, what makes a value of its text; real numbers where nothing is said.

    Raises:
        FileNotFoundError: there is no such file.
        ValueError: it is another file.
    """
    kinds = dict.fromkeys(columns, float) | (kinds or {})
    with open(path, encoding="utf-8", newline="") as stream:
        reader = csv.DictReader(stream)
        if tuple(reader.fieldnames or ()) != columns:
            raise ValueError(f"{path}: expected the columns {', '.join(columns)}, got {reader.fieldnames}")
        for row in reader:
            yield {name: kinds[name](text) for name, text in row.items()}
