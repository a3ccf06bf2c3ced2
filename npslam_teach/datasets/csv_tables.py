"""Tables out of .csv files that any program may have written: rows that know where they stand and what they lack."""

import csv
import math
import warnings
from collections.abc import Iterator
from typing import NamedTuple

from npslam_teach.system.files import read_bytes, shorten


class Row(NamedTuple):
    """One line of a file, and where it stands."""

    where: str
    text: dict  # column -> what is written there

    def number(self, column: str) -> float:
        """A finite number."""
        text = self.text.get(column, "")
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            hint = " (decimals after a point)" if "," in text else ""
            raise ValueError(f"{self.where}: {column}: expected a number{hint}, got {shorten(text)}")
        return value

    def numbers(self, *columns: str) -> list[float]:
        """One for each column."""
        return [self.number(column) for column in columns]

    def split_numbers(self, column: str, count: int) -> list[float]:
        """So many numbers in one column, with spaces between."""
        text = self.text.get(column, "")
        parts = [Row(self.where, {column: part}).number(column) for part in text.split()]
        if len(parts) != count:
            problem = f"expected {count} numbers with spaces between, got {shorten(text)}"
            raise ValueError(f"{self.where}: {column}: {problem}")
        return parts

    def known(self, *columns: str) -> list[float]:
        """The same, NaN where nothing is written."""
        return [self.number(column) if self.text.get(column) else math.nan for column in columns]

    def index(self, column: str, length: int) -> int:
        """A whole number from 0, below the length."""
        value = self.number(column)
        if not 0 <= value < length or value != int(value):
            hint = " (poses are counted, this is no clock)" if column == "time" else ""
            problem = f"expected a whole number from 0 to {length - 1}, got {shorten(self.text[column])}{hint}"
            raise ValueError(f"{self.where}: {column}: {problem}")
        return int(value)


def read_rows(path, known: tuple) -> Iterator[Row]:
    """The rows of a file, without comments and empty lines.

    Args:
        path: a file whose first row names its columns, separated by commas, semicolons or tabs.
        known: the columns that are read; others are named in a warning.

    Raises:
        FileNotFoundError: no such file.
        ValueError: names the file and the line, what was expected and what came.
    """
    try:
        text = read_bytes(path).decode("utf-8-sig")
    except UnicodeDecodeError:
        raise ValueError(f"{path}: expected text in UTF-8, got something else") from None
    lines = [(n, line) for n, line in enumerate(text.splitlines(), 1) if line.strip() and line.lstrip()[0] != "#"]
    if not lines:
        raise ValueError(f"{path}: expected a line with the names of the columns, got none")
    head, *rest = lines
    separator = max(",;\t", key=head[1].count)
    columns = [name.strip().lower() for name in next(csv.reader([head[1]], delimiter=separator))]
    _require_columns(f"{path}, line {head[0]}", columns, known)
    for number, line in rest:
        where, values = f"{path}, line {number}", _values(path, number, line, separator)
        if len(values) > len(columns):
            raise ValueError(f"{where}: expected {len(columns)} columns, got {len(values)}")
        yield Row(where, {name: value.strip() for name, value in zip(columns, values, strict=False)})


def _values(path, number: int, line: str, separator: str) -> list[str]:
    try:
        return next(csv.reader([line], delimiter=separator, strict=True))
    except csv.Error as error:
        raise ValueError(f"{path}, line {number}: expected a line of CSV, got {error}") from None


def _require_columns(where: str, columns: list[str], known: tuple) -> None:
    unknown = [name for name in columns if name not in known]
    if len(unknown) == len(columns):
        raise ValueError(f"{where}: expected columns out of {', '.join(known)}, got {shorten(','.join(columns))}")
    twice = [name for name in columns if columns.count(name) > 1]
    if twice:
        raise ValueError(f"{where}: expected every column once, got {shorten(twice[0])} twice")
    if unknown:
        warnings.warn(f"{where}: columns that are not read: {shorten(', '.join(unknown))}", stacklevel=4)
