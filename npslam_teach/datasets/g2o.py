"""Two-dimensional pose graphs in the text format of g2o, in and out.

One vertex or edge per line::

    VERTEX_SE2 id x y theta                 a pose                       m, m, rad
    VERTEX_XY id x y                        a landmark                   m
    EDGE_SE2 i j dx dy dtheta I11 I12 I13 I22 I23 I33      pose j in the frame of pose i
    EDGE_SE2_XY i l x y I11 I12 I22         landmark l in the frame of pose i
    FIX id ...                              poses or landmarks that an optimizer holds still

``I11 ...`` is the upper triangle of the information matrix, row by row. What follows a ``#`` is a comment.

g2o measures the error of an EDGE_SE2 in the frame of the *measured* pose j, we measure ``between(x_i, x_j) - o`` in the
frame of pose i. One is the other turned by dtheta, so the information is turned by it on the way in and back on the way
out, and chi2 is the same number here and there.
"""

import warnings
from dataclasses import replace

import numpy as np

from npslam_teach.datasets.graph_lines import FIELDS, parse
from npslam_teach.system.files import atomic_write, prefix_errors
from npslam_teach.types import BetweenFactors, ObservationFactors, PoseGraph

ROUNDING = 1e-5  # of the largest eigenvalue: what printing six digits can do to an information matrix


def load_g2o(path) -> PoseGraph:
    """Read a pose graph from a .g2o file (gzip or not), or from one of TORO.

    Poses are numbered in the order of their ids, and so are landmarks; the graph keeps the ids for messages and for
    ``save_g2o``. What ``FIX`` names is fixed, the pose of lowest id where there is none; of several, the file must say
    where they are. A file without vertices is read, its estimates are zero; ``pose_graph.given_start`` lays them out.
    Two things are read with a warning: that, and an information matrix that is indefinite only because it was printed
    with few digits. An unknown tag is an error, never skipped: without some of its factors a graph has another answer.

    Raises:
        FileNotFoundError: no such file.
        ValueError: names the file, the line and the field, what was expected and what came.
    """
    rows = parse(path)
    _require_no_offset(path, rows[b"PARAMS_SE2OFFSET"])
    _require_unique(path, rows[b"VERTEX_SE2"] + rows[b"VERTEX_XY"])
    poses, pose_index = _vertices(path, rows, b"VERTEX_SE2", [(b"EDGE_SE2", 0), (b"EDGE_SE2", 1), (b"EDGE_SE2_XY", 0)])
    landmarks, landmark_index = _vertices(path, rows, b"VERTEX_XY", [(b"EDGE_SE2_XY", 1)])
    if not pose_index:
        raise ValueError(f"{path}: expected at least one VERTEX_SE2 or EDGE_SE2, got none")
    _require_apart(path, rows[b"EDGE_SE2_XY"], pose_index, landmark_index)
    fixed_poses, fixed_landmarks = _fixed(path, rows[b"FIX"], pose_index, landmark_index)
    _require_places(path, rows, landmark_index)
    between = _edges(path, rows[b"EDGE_SE2"], pose_index, pose_index, 3, BetweenFactors)
    with prefix_errors(path):  # turning can make the largest numbers a little larger
        between = turned_information(between, +1)
    return PoseGraph(
        poses=poses,
        landmarks=landmarks,
        between=between,
        observations=_edges(path, rows[b"EDGE_SE2_XY"], pose_index, landmark_index, 2, ObservationFactors),
        fixed_poses=fixed_poses,
        fixed_landmarks=fixed_landmarks,
        **_ids_of(pose_index, landmark_index),
    )


def _ids_of(pose_index: dict, landmark_index: dict) -> dict:
    """What the graph keeps: nothing where the ids are those that ``save_g2o`` gives anyway."""
    ids = [*pose_index, *landmark_index]
    named = {"pose_ids": tuple(pose_index), "landmark_ids": tuple(landmark_index)}
    return {} if ids == list(range(len(ids))) else named


def save_g2o(path, graph: PoseGraph) -> None:
    """Write a pose graph to a .g2o file; `load_g2o` gives back the same numbers.

    Estimates and measurements come back bit for bit, the information of poses up to rounding. Vertices keep the ids of
    the file they came from; others get 0, 1, ..., landmarks the ids that follow. ``FIX`` is written unless it is just
    pose 0 that is fixed. Nothing is written when something goes wrong.

    Raises:
        FileNotFoundError: the folder does not exist.
        ValueError: the file cannot be written, or landmarks have headings (``pose_graph.positions_only`` drops them).
    """
    if graph.landmarks.shape[1] == 3:
        raise ValueError(f"{path}: expected landmarks without headings, for which .g2o has no vertex; got headings")
    pose_ids, landmark_ids = _ids(graph)
    seen, fixed = graph.observations, np.append(pose_ids[graph.fixed_poses], landmark_ids[graph.fixed_landmarks])
    with prefix_errors(path):
        between = turned_information(graph.between, -1)
    lines = [
        *_lines("VERTEX_SE2", [pose_ids], graph.poses),
        *_lines("VERTEX_XY", [landmark_ids], graph.landmarks),
        *([] if fixed.tolist() == pose_ids[:1].tolist() else [f"FIX {vertex}\n" for vertex in fixed.tolist()]),
        *_lines("EDGE_SE2", [pose_ids[between.i], pose_ids[between.j]], between.relative_pose, between.information),
        *_lines("EDGE_SE2_XY", [pose_ids[seen.pose], landmark_ids[seen.landmark]], seen.xy, seen.information),
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
    return replace(between, information=(information + information.swapaxes(1, 2)) / 2)  # symmetric to the last bit


def _lines(tag: str, ids: list, measurement: np.ndarray, information: np.ndarray | None = None):
    """One line per vertex or edge; ``repr`` of a float is the shortest text that reads back as the same."""
    numbers = measurement
    if information is not None:
        row, column = np.triu_indices(measurement.shape[1])
        numbers = np.column_stack([measurement, information[:, row, column]])
    for line_ids, line_numbers in zip(np.column_stack(ids).tolist(), numbers.tolist(), strict=True):
        yield " ".join([tag, *map(str, line_ids), *map(repr, line_numbers)]) + "\n"


def _ids(graph: PoseGraph) -> tuple[np.ndarray, np.ndarray]:
    """The ids of all poses and of all landmarks; those of the file they came from, where no two are equal."""
    num_poses, num_landmarks = len(graph.poses), len(graph.landmarks)
    if graph.pose_ids is not None and graph.landmark_ids is not None:
        if len({*graph.pose_ids, *graph.landmark_ids}) == num_poses + num_landmarks:
            return np.array(graph.pose_ids, dtype=object), np.array(graph.landmark_ids, dtype=object)
    return np.arange(num_poses), num_poses + np.arange(num_landmarks)


def _vertices(path, rows: dict, tag: bytes, ends: list[tuple[bytes, int]]) -> tuple[np.ndarray, dict]:
    """Estimates (N, size) in increasing order of id, and id -> position; zeros where a file has edges alone."""
    size = len(FIELDS[tag][1])
    if rows[tag]:
        in_order = sorted(rows[tag], key=lambda row: row[1])
        index = {ids[0]: k for k, (_, ids, _) in enumerate(in_order)}
        return np.array([numbers for _, _, numbers in in_order]), index
    named = sorted({ids[end] for edge, end in ends for _, ids, _ in rows[edge]})
    if named:
        kind = tag.decode()
        warnings.warn(f"{path}: no {kind} lines, so the estimates come from the edges alone", stacklevel=3)
    return np.zeros((len(named), size)), {vertex: k for k, vertex in enumerate(named)}


def _fixed(path, rows: list, pose_index: dict, landmark_index: dict) -> tuple[list, list]:
    """The positions of all poses and of all landmarks that are fixed."""
    for line_number, (vertex,), _ in rows:
        if vertex not in pose_index and vertex not in landmark_index:
            raise ValueError(f"{path}, line {line_number}: FIX id: expected the id of a vertex, got {vertex}")
    named = dict.fromkeys(vertex for _, (vertex,), _ in rows)
    poses = [pose_index[vertex] for vertex in named if vertex in pose_index]
    landmarks = [landmark_index[vertex] for vertex in named if vertex in landmark_index]
    return (poses, landmarks) if named else ([0], [])


def _require_places(path, rows: dict, landmark_index: dict) -> None:
    """One vertex may be held still wherever it is; of two, the file must say where."""
    for line_number, (vertex,), _ in rows[b"FIX"]:
        kind = b"VERTEX_XY" if vertex in landmark_index else b"VERTEX_SE2"
        if not rows[kind] and len({ids[0] for _, ids, _ in rows[b"FIX"]}) > 1:
            problem = f"expected a line {kind.decode()} for it, because another vertex is fixed, too; got none"
            raise ValueError(f"{path}, line {line_number}: FIX {vertex}: {problem}")


def _require_no_offset(path, rows: list) -> None:
    for line_number, _, numbers in rows:
        if any(numbers):
            problem = f"expected a sensor at the robot's origin, 0 0 0, got {numbers}"
            raise ValueError(f"{path}, line {line_number}: PARAMS_SE2OFFSET: {problem}")


def _require_unique(path, rows: list) -> None:
    lines = {}
    for line_number, (vertex,), _ in sorted(rows):
        if vertex in lines:
            problem = f"expected a new id, got {vertex}, which line {lines[vertex]} defines already"
            raise ValueError(f"{path}, line {line_number}: id: {problem}")
        lines[vertex] = line_number


def _require_apart(path, rows: list, pose_index: dict, landmark_index: dict) -> None:
    for line_number, (_, vertex), _ in rows:
        if vertex in pose_index and vertex in landmark_index:
            problem = f"expected the id of a landmark, got {vertex}, which is a pose"
            raise ValueError(f"{path}, line {line_number}: l: {problem}")


def _edges(path, rows: list, first_index: dict, second_index: dict, size: int, make):
    """The factors of all edges of a kind: ``make`` is their dataclass, ``size`` a measurement's length."""
    ends = [_ends(path, row, first_index, second_index) for row in rows]
    first, second = np.array(ends, int).reshape(-1, 2).T
    row, column = np.triu_indices(size)
    numbers = np.array([numbers for _, _, numbers in rows]).reshape(-1, size + len(row))
    information = np.zeros((len(rows), size, size))
    information[:, row, column] = information[:, column, row] = numbers[:, size:]
    information = _without_rounding(path, rows, information)
    columns = (first, second, numbers[:, :size], information)
    try:
        return make(*columns)
    except ValueError:  # everything but the information has been checked by now
        line_number, _, values = rows[_first_rejected(make, columns)]
        problem = f"expected a positive semidefinite matrix, got the upper triangle {values[size:]}"
        raise ValueError(f"{path}, line {line_number}: I11: {problem}") from None


def _without_rounding(path, rows: list, information: np.ndarray) -> np.ndarray:
    """Matrices whose negative eigenvalues can come from printing few digits, made positive definite by that much."""
    if len(information) == 0:
        return information
    values, vectors = np.linalg.eigh(information)
    allowed = ROUNDING * values[:, -1]
    rounded = (values[:, 0] < -1e-9 * values[:, -1]) & (values[:, 0] > -allowed)
    if not rounded.any():
        return information
    first = rows[int(np.argmax(rounded))][0]
    warnings.warn(
        f"{path}: {rounded.sum()} information matrices, the first in line {first}, are indefinite by the rounding of "
        "their printed digits; their smallest eigenvalues were raised by that much",
        stacklevel=4,
    )
    values = np.maximum(values, allowed[:, None])
    raised = np.einsum("eij,ej,ekj->eik", vectors, values, vectors)
    return np.where(rounded[:, None, None], (raised + raised.swapaxes(1, 2)) / 2, information)


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
