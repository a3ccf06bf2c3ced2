"""The file of a sweep: .csv, or .parquet by pyarrow. Whatever happens, every row that was computed is kept, once.

While a sweep runs, each row is appended to a table of comma-separated values, the .csv itself or ``NAME.parquet.rows``
beside a .parquet, which is made anew of all rows from time to time. At the end the rows stand in the order of the
grid, so that the file is the same whoever computed it.
"""

import contextlib
import csv
import io
import time
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

from npslam_teach.experiments import tables
from npslam_teach.experiments.sweep import COLUMNS, Point, point_of
from npslam_teach.system.files import atomic_write
from npslam_teach.system.locking import lock_or_raise

SUFFIXES = (".csv", ".parquet")
_TEXTS, _COUNTS = ("scene", "method", "scale", "error"), ("seed", "objects", "objects_true")
_SECONDS_BETWEEN = 30.0  # two versions of a .parquet, while the sweep runs


@contextlib.contextmanager
def collect(path: str | Path, points: Iterable[Point]) -> Iterator[tuple[list[Point], Callable[[dict], None]]]:
    """Open the file of a sweep, go on where it ended, and put it in order in the end.

    Rows of points that are not in this grid are kept; rows with an error are computed again.

    Args:
        path: ends in one of SUFFIXES; it may exist.
        points: of the grid.

    Raises:
        ValueError: it is another file, pyarrow is missing, or another sweep is writing it.
        FileNotFoundError: there is no such folder.

    Yields:
        the points without a row, and what takes a row.
    """
    path, points = Path(path), list(points)
    journal = path if path.suffix == ".csv" else path.with_name(path.name + ".rows")
    if path.suffix == ".parquet":
        _pyarrow()  # that it is missing is said before hours of work
    with lock_or_raise(path.with_name(f".{path.name}.lock"), f"{path}: expected a file that no other sweep is writing"):
        rows = {point_of(row): row for row in [*read_rows(path, True), *read_rows(journal, True)] if not row["error"]}
        tables.write_table(rows.values(), COLUMNS, journal)  # without a line that was cut off
        try:
            with open(journal, "a", encoding="utf-8", newline="") as stream:
                yield [point for point in points if point not in rows], _keeper(path, stream, rows)
        finally:
            place = {point: k for k, point in enumerate(points)}
            _write(path, sorted(rows.values(), key=lambda row: place.get(point_of(row), -1)))
            if journal != path:
                journal.unlink()


def _keeper(path: Path, stream, rows: dict) -> Callable[[dict], None]:
    writer, written = csv.DictWriter(stream, COLUMNS, lineterminator="\n"), time.monotonic()

    def keep(row: dict) -> None:
        nonlocal written
        rows[point_of(row)] = row
        writer.writerow(row)
        stream.flush()
        if path.suffix == ".parquet" and time.monotonic() - written > _SECONDS_BETWEEN:
            _write(path, rows.values())
            written = time.monotonic()

    return keep


def read_rows(path: str | Path, may_be_missing: bool = False) -> list[dict]:
    """The rows of a sweep, with the names of ``sweep.COLUMNS``; a last line that was cut off is left out.

    Args:
        path: .csv, .parquet, or the rows beside one that is being made.
        may_be_missing: then there are none.

    Raises:
        FileNotFoundError: there is no such file.
        ValueError: it is another file, or pyarrow is missing.
    """
    path = Path(path)
    if path.suffix not in (*SUFFIXES, ".rows"):
        raise ValueError(f"{path}: expected a name that ends in {' or '.join(SUFFIXES)}, got {path.suffix!r}")
    if may_be_missing and not path.exists():
        return []
    return _read_parquet(path) if path.suffix == ".parquet" else _read_csv(path)


def _read_csv(path: Path) -> list[dict]:
    text = path.read_text(encoding="utf-8")
    reader = csv.DictReader(io.StringIO(text[: text.rfind("\n") + 1]))
    _require_columns(path, reader.fieldnames or ())
    try:
        return [{name: _value(name, cell) for name, cell in row.items()} for row in reader]
    except (ValueError, TypeError, AttributeError):
        raise ValueError(f"{path}: expected the table of a sweep, got another in line {reader.line_num}") from None


def _value(name: str, cell: str):
    if cell == "":
        return None
    return cell if name in _TEXTS else int(cell) if name in _COUNTS else float(cell)


def _require_columns(path: Path, names) -> None:
    if tuple(names) != COLUMNS:
        raise ValueError(
            f"{path}: expected the columns {', '.join(COLUMNS)}, got {', '.join(map(str, names)) or 'none'}"
        )


def _write(path: Path, rows: Iterable[dict]) -> None:
    if path.suffix == ".csv":
        tables.write_table(rows, COLUMNS, path)
        return
    arrow, parquet = _pyarrow()
    kinds = {name: arrow.string() if name in _TEXTS else arrow.int64() for name in (*_TEXTS, *_COUNTS)}
    schema = arrow.schema([(name, kinds.get(name, arrow.float64())) for name in COLUMNS])
    with atomic_write(path, "wb") as stream:
        parquet.write_table(arrow.Table.from_pylist(list(rows), schema), stream)


def _read_parquet(path: Path) -> list[dict]:
    arrow, parquet = _pyarrow()
    try:
        table = parquet.read_table(path)
    except arrow.ArrowInvalid:
        raise ValueError(f"{path}: expected a Parquet file, got another") from None
    _require_columns(path, table.column_names)
    return table.to_pylist()


def _pyarrow():
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        sentence = "expected the package pyarrow for .parquet; pip install 'npslam_teach[cluster]', or write .csv"
        raise ValueError(sentence) from None
    return pyarrow, pyarrow.parquet
