"""Two-dimensional pose graphs in the text format of g2o, in and out.

One vertex or edge per line::

    VERTEX_SE2 id x y theta                 a pose                       m, m, rad
    VERTEX_XY id x y                        a landmark                   m
    EDGE_SE2 i j dx dy dtheta I11 I12 I13 I22 I23 I33      pose j in the frame of pose i
    EDGE_SE2_XY i l x y I11 I12 I22         landmark l in the frame of pose i
    FIX id                                  a pose that an optimizer holds still

``I11 ...`` is the upper triangle of the information matrix, row by row. What follows a ``#`` is a comment.

g2o measures the error of an EDGE_SE2 in the frame of the *measured* pose j, we measure ``between(x_i, x_j) - o`` in the
frame of pose i. One is the other turned by dtheta, so the information is turned by it on the way in and back on the way
out, and chi2 is the same number here and there.
"""

import math
from dataclasses import replace

import numpy as np

from npslam_teach.system.files import atomic_write, prefix_errors, read_bytes, shorten
from npslam_teach.types import BetweenFactors, ObservationFactors, PoseGraph
from npslam_teach.validation import LARGEST

_MAX_LINE_BYTES = 1 << 20  # whatever has longer lines is no text; splitting it would take many times its size

_FIELDS = {  # tag -> names of its ids, names of its numbers
    b"VERTEX_SE2": (("id",), ("x", "y", "theta")),
    b"VERTEX_XY": (("id",), ("x", "y")),
    b"EDGE_SE2": (("i", "j"), ("dx", "dy", "dtheta", "I11", "I12", "I13", "I22", "I23", "I33")),
    b"EDGE_SE2_XY": (("i", "l"), ("x", "y", "I11", "I12", "I22")),
    b"FIX": (("id",), ()),
}


def load_g2o(path) -> PoseGraph:
    """Read a pose graph from a .g2o file.

    Poses are numbered in the order of their ids, and so are landmarks. ``FIX`` is accepted for one pose and otherwise
    ignored: this package holds pose 0, and since factors compare poses only with each other, the minimum of chi2 is
    the same. An unknown tag is an error, never skipped: without some of its factors a graph has another answer.

    Raises:
        FileNotFoundError: no such file.
        ValueError: names the file, the line and the field, what was expected and what came.
    """
    rows = _parse(path)
    pose_index = _index(rows[b"VERTEX_SE2"])
    landmark_index = _index(rows[b"VERTEX_XY"])
    if not pose_index:
        raise ValueError(f"{path}: expected at least one VERTEX_SE2, got none")
    _require_unique(path, rows[b"VERTEX_SE2"] + rows[b"VERTEX_XY"])
    _require_one_fixed_pose(path, rows[b"FIX"], pose_index)
    between = _edges(path, rows[b"EDGE_SE2"], pose_index, pose_index, 3, BetweenFactors)
    with prefix_errors(path):  # turning can make the largest numbers a little larger
        between = turned_information(between, +1)
    return PoseGraph(
        poses=_vertices(rows[b"VERTEX_SE2"], 3),
        landmarks=_vertices(rows[b"VERTEX_XY"], 2),
        between=between,
        observations=_edges(path, rows[b"EDGE_SE2_XY"], pose_index, landmark_index, 2, ObservationFactors),
    )


def save_g2o(path, graph: PoseGraph) -> None:
    """Write a pose graph to a .g2o file; `load_g2o` gives back the same numbers.

    Estimates and measurements come back bit for bit, the information of poses up to rounding. Poses get the ids
    0, 1, ..., landmarks the ids that follow. Nothing is written when something goes wrong.

    Raises:
        FileNotFoundError: the folder does not exist.
        ValueError: the file cannot be written.
    """
    first_landmark, seen = len(graph.poses), graph.observations
    with prefix_errors(path):
        between = turned_information(graph.between, -1)
    lines = [
        *_lines("VERTEX_SE2", [np.arange(first_landmark)], graph.poses),
        *_lines("VERTEX_XY", [first_landmark + np.arange(len(graph.landmarks))], graph.landmarks),
        *_lines("EDGE_SE2", [between.i, between.j], between.relative_pose, between.information),
        *_lines("EDGE_SE2_XY", [seen.pose, first_landmark + seen.landmark], seen.xy, seen.information),
    ]
    with atomic_write(path, "w") as stream:
        stream.writelines(lines)


def turned_information(between: BetweenFactors, sign: int) -> BetweenFactors:
    """The same factors with information from the frame of pose j to that of pose i (+1) or back (-1)."""
    theta = sign * between.relative_pose[:, 2]
    turn = np.tile(np.eye(3), (len(theta), 1, 1))
    turn[:, 0, 0] = turn[:, 1, 1] = np.cos(theta)
    turn[:, 1, 0] = np.sin(theta)
    turn[:, 0, 1] = -turn[:, 1, 0]
    information = turn @ between.information @ turn.swapaxes(1, 2)
    # The product is symmetric only up to rounding.
    return replace(between, information=(information + information.swapaxes(1, 2)) / 2)


def _lines(tag: str, ids: list, measurement: np.ndarray, information: np.ndarray | None = None):
    """One line per vertex or edge; ``repr`` of a float is the shortest text that reads back as the same."""
    numbers = measurement
    if information is not None:
        row, column = np.triu_indices(measurement.shape[1])
        numbers = np.column_stack([measurement, information[:, row, column]])
    for line_ids, line_numbers in zip(np.column_stack(ids).tolist(), numbers.tolist(), strict=True):
        yield " ".join([tag, *map(str, line_ids), *map(repr, line_numbers)]) + "\n"


def _parse(path) -> dict:
    """Tag -> list of (line number, ids, numbers), in the order of the file."""
    rows = {tag: [] for tag in _FIELDS}
    # Bytes, not text: a number has no other digits than ASCII's, and a comment may be in any encoding.
    for line_number, line in enumerate(read_bytes(path).splitlines(), 1):
        if len(line) > _MAX_LINE_BYTES:
            problem = f"expected at most {_MAX_LINE_BYTES} bytes, got {len(line)}"
            raise ValueError(f"{path}, line {line_number}: {problem}")
        fields = line.split(b"#", 1)[0].split()
        if fields:
            ids, numbers = _convert(path, line_number, fields)
            rows[fields[0]].append((line_number, ids, numbers))
    return rows


def _convert(path, line_number: int, fields: list) -> tuple[list, list]:
    """The ids and the numbers of one line."""
    tag = fields[0]
    if tag not in _FIELDS:
        raise ValueError(f"{path}, line {line_number}: {_unknown(tag)}")
    id_names, number_names = _FIELDS[tag]
    names = id_names + number_names
    if len(fields) - 1 != len(names):
        problem = f"expected {len(names)} values ({' '.join(names)}), got {len(fields) - 1}"
        raise ValueError(f"{path}, line {line_number}: {tag.decode()}: {problem}")
    values = []
    try:
        for name, field in zip(names, fields[1:], strict=True):
            values.append(_integer(field) if name in id_names else _number(field))
    except ValueError as error:
        problem = f"{error}, got {_quote(field)}"
        raise ValueError(f"{path}, line {line_number}: {tag.decode()} {name}: {problem}") from None
    return values[: len(id_names)], values[len(id_names) :]


def _unknown(tag: bytes) -> str:
    if b"SE3" in tag or b"XYZ" in tag or b"QUAT" in tag or tag in (b"VERTEX3", b"EDGE3"):
        return f"expected a two-dimensional graph, got the tag {_quote(tag)} of a three-dimensional one"
    known = ", ".join(known.decode() for known in _FIELDS)
    return f"expected one of the tags {known}, got {_quote(tag)}"


def _quote(field: bytes) -> str:
    return shorten(field[:100].decode("latin-1"))


def _integer(field: bytes) -> int:
    # Digits only: int() would also take signs and "1_0".
    if not field.isdigit() or len(field) > 20:
        raise ValueError("expected a non-negative integer")
    return int(field)


def _number(field: bytes) -> float:
    try:
        value = float(field)
    except ValueError:
        value = math.nan
    if not math.isfinite(value) or b"_" in field:
        raise ValueError("expected a finite number")
    if abs(value) > LARGEST:
        raise ValueError(f"expected a number up to {LARGEST:g}")
    return value


def _index(rows: list) -> dict:
    """Id -> position when the vertices are sorted by id."""
    return {vertex: k for k, vertex in enumerate(sorted(ids[0] for _, ids, _ in rows))}


def _vertices(rows: list, size: int) -> np.ndarray:
    """(N, size) in increasing order of id."""
    return np.array([numbers for _, _, numbers in sorted(rows, key=lambda row: row[1])]).reshape(-1, size)


def _require_unique(path, rows: list) -> None:
    lines = {}
    for line_number, (vertex,), _ in sorted(rows):
        if vertex in lines:
            problem = f"expected a new id, got {vertex}, which line {lines[vertex]} defines already"
            raise ValueError(f"{path}, line {line_number}: id: {problem}")
        lines[vertex] = line_number


def _require_one_fixed_pose(path, rows: list, pose_index: dict) -> None:
    for count, (line_number, (vertex,), _) in enumerate(rows):
        if count or vertex not in pose_index:
            problem = "one FIX in the file, got another" if count else f"the id of a VERTEX_SE2, got {vertex}"
            raise ValueError(f"{path}, line {line_number}: FIX id: expected {problem}")


def _edges(path, rows: list, first_index: dict, second_index: dict, size: int, make):
    """The factors of all edges of a kind: ``make`` is their dataclass, ``size`` a measurement's length."""
    ends = [_ends(path, row, first_index, second_index) for row in rows]
    first, second = np.array(ends, int).reshape(-1, 2).T
    row, column = np.triu_indices(size)
    numbers = np.array([numbers for _, _, numbers in rows]).reshape(-1, size + len(row))
    information = np.zeros((len(rows), size, size))
    information[:, row, column] = information[:, column, row] = numbers[:, size:]
    columns = (first, second, numbers[:, :size], information)
    try:
        return make(*columns)
    except ValueError:  # everything but the information has been checked by now
        line_number, _, values = rows[_first_rejected(make, columns)]
        problem = f"expected a positive semidefinite matrix, got the upper triangle {values[size:]}"
        raise ValueError(f"{path}, line {line_number}: I11: {problem}") from None


def _ends(path, row: tuple, first_index: dict, second_index: dict) -> tuple[int, int]:
    """The positions of the two vertices of an edge."""
    line_number, (first, second), _ = row
    kinds = ("VERTEX_SE2", "VERTEX_SE2" if first_index is second_index else "VERTEX_XY")
    names = ("i", "j" if first_index is second_index else "l")
    for name, kind, vertex, index in zip(names, kinds, row[1], (first_index, second_index), strict=True):
        if vertex not in index:
            raise ValueError(f"{path}, line {line_number}: {name}: expected the id of a {kind}, got {vertex}")
    if kinds[0] == kinds[1] and first == second:
        raise ValueError(f"{path}, line {line_number}: j: expected a pose other than i, got {second} twice")
    return first_index[first], second_index[second]


def _first_rejected(make, columns: tuple) -> int:
    """The first factor that ``make`` raises at, found by halving (knowing that there is one)."""
    low, high = 0, len(columns[0])
    while high - low > 1:
        middle = (low + high) // 2
        try:
            make(*(column[low:middle] for column in columns))
            low = middle
        except ValueError:
            high = middle
    return low
