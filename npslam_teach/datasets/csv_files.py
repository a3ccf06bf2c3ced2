"""Robot logs as tables that any spreadsheet writes: one .csv file, or a folder of them.

One file has the columns ``kind, time, x, y, theta, class, object``, in any order; what a row does not use stays empty::

    kind              uses                          is
    odometry_std      x y theta                     standard deviation of a step: m, m, rad
    observation_std   x y [theta]                   and of an observation: m, m, and of the heading it sees: rad
    class             class [symmetry]              a class in the order of its number; how many headings look alike
    odometry          time x y theta                pose time + 1 in the frame of pose time: m, m, rad
    observation       time x y [theta] class [object]  an object seen from pose time, in its frame: m, m, rad
    true_pose         time x y [theta]              the truth, as far as it is known: m, m, rad
    true_object       object class [x y theta]      a real object: m, m, rad

``time`` counts poses from 0. A class is a number from 0 or a name; an object has any name, ``clutter`` is none, and an
empty one is unknown. Where every step, or every observation, has a covariance of its own, rows of that kind carry it in
the columns ``cov_xx, cov_xy, cov_yy`` (m^2) and, of a step, ``cov_xt, cov_yt, cov_tt`` (m rad, rad^2); and what every
observation says of each class, in their order with spaces between, stands in ``class_probabilities``. A folder holds
the same without the column ``kind``: ``odometry.csv``, ``observations.csv`` and ``sensor.csv`` (with ``kind``: the
standard deviations and the classes), and ``true_poses.csv`` and ``true_objects.csv`` where there is a truth. Columns
are separated by commas, semicolons or tabs; a line that begins with # is a comment.
"""

import csv
import io
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np

from npslam_teach.datasets.csv_details import (
    BELIEFS,
    COVARIANCES,
    SYMMETRY,
    covariances_of,
    headings_of,
    written_details,
)
from npslam_teach.datasets.csv_tables import Row, read_rows
from npslam_teach.datasets.mu2016 import MAX_CLASSES
from npslam_teach.system.files import atomic_write, shorten
from npslam_teach.types import CLUTTER, UNKNOWN

COLUMNS = ("kind", "time", "x", "y", "theta", "class", "object")
KNOWN_COLUMNS = (*COLUMNS, *COVARIANCES["odometry"], BELIEFS, SYMMETRY)
USES = {
    "odometry_std": ("x", "y", "theta"),
    "observation_std": ("x", "y"),
    "class": ("class",),
    "odometry": ("time", "x", "y", "theta"),
    "observation": ("time", "x", "y", "class"),
    "true_pose": ("time", "x", "y"),
    "true_object": ("object", "class"),
}
FILES = {  # of a folder: the kind of its rows, None where they say it
    "odometry.csv": "odometry",
    "observations.csv": "observation",
    "sensor.csv": None,
    "true_poses.csv": "true_pose",
    "true_objects.csv": "true_object",
}
NEEDED = tuple(FILES)[:3]
NO_OBJECT = "clutter"


def read_csv_log(path) -> dict:
    """The fields of a log, by their names in a .npz file.

    Args:
        path: a file, or a folder of them.

    Raises:
        FileNotFoundError: no such file.
        ValueError: names the file, the line and the column, what was expected and what came.
    """
    rows = {kind: [] for kind in USES}
    if Path(path).is_dir():
        for name in NEEDED:
            if not (Path(path) / name).is_file():
                raise FileNotFoundError(f"{path}: expected the files {', '.join(NEEDED)}, found no {name}")
        for name, kind in FILES.items():
            if (Path(path) / name).is_file():
                _sort(read_rows(Path(path) / name, KNOWN_COLUMNS), kind, rows)
    else:
        _sort(read_rows(path, KNOWN_COLUMNS), None, rows)
    return _log_fields(path, rows) | _true_fields(rows)


def _sort(found: Iterable[Row], kind: str | None, rows: dict) -> None:
    """Add rows to those of their kind."""
    for row in found:
        own = kind or row.text.get("kind", "")
        if own not in USES:
            raise ValueError(f"{row.where}: kind: expected one of {', '.join(USES)}, got {shorten(own)}")
        missing = [name for name in USES[own] if not row.text.get(name)]
        if missing:
            raise ValueError(f"{row.where}: {missing[0]}: expected a value in a row of {own}, got none")
        rows[own].append(row)


def _log_fields(path, rows: dict) -> dict:
    """Everything that is not truth."""
    for kind in ("odometry_std", "observation_std"):
        if len(rows[kind]) != 1:
            raise ValueError(f"{path}: expected one row of {kind}, got {len(rows[kind])}")
    steps, seen = rows["odometry"], rows["observation"]
    in_time = _by_name(steps, [row.index("time", len(steps)) for row in steps], "time")
    classes, names = _classes(rows)
    fields = {
        "odometry": np.reshape([in_time[k].numbers("x", "y", "theta") for k in range(len(steps))], (-1, 3)),
        "obs_time": np.array([row.index("time", len(steps) + 1) for row in seen], dtype=int),
        "obs_xy": np.reshape([row.numbers("x", "y") for row in seen], (-1, 2)),
        "obs_class": np.array(classes[: len(seen)], dtype=int),
        "num_classes": np.array(max(len(names), 1)),
        "odometry_std": np.array(rows["odometry_std"][0].numbers("x", "y", "theta")),
        "observation_std": np.array(rows["observation_std"][0].numbers("x", "y")),
    }
    in_order = {"odometry": [in_time[k] for k in range(len(steps))], "observation": seen}
    fields |= {f"{kind}_cov": cov for kind, own in in_order.items() if (cov := covariances_of(own, kind)) is not None}
    if any(row.text.get(BELIEFS) for row in seen):
        fields[BELIEFS] = np.array([row.split_numbers(BELIEFS, len(names)) for row in seen])
    fields |= headings_of(rows)
    if names != [str(c) for c in range(len(names))]:
        fields["class_names"] = np.array(names)
    if rows["true_object"]:
        fields["object_class"] = np.array(classes[len(seen) :], dtype=int)
    return fields


def _by_name(rows: list[Row], names: list, column: str) -> dict:
    """Name -> row, where every name may stand once."""
    found = {}
    for row, name in zip(rows, names, strict=True):
        if name in found:
            problem = f"expected another one than in {found[name].where}, got {shorten(name)}"
            raise ValueError(f"{row.where}: {column}: {problem}")
        found[name] = row
    return found


def _classes(rows: dict) -> tuple[list[int], list[str]]:
    """The class of every observation and true object, and a name of every class.

    Names stand in the order of the rows that list them; else numbers are what they say, and names are sorted.
    """
    used, listed = [*rows["observation"], *rows["true_object"]], [row.text["class"] for row in rows["class"]]
    written = [row.text["class"] for row in used]
    if not listed and all(text.isdecimal() for text in written):
        numbers = [row.index("class", MAX_CLASSES) for row in used]
        return numbers, [str(c) for c in range(max(numbers, default=-1) + 1)]
    names = list(_by_name(rows["class"], listed, "class")) or sorted(set(written))
    number = {name: c for c, name in enumerate(names)}
    for row, name in zip(used, written, strict=True):
        if name not in number:
            raise ValueError(f"{row.where}: class: expected one of those in rows of class, got {shorten(name)}")
    return [number[name] for name in written], names


def _true_fields(rows: dict) -> dict:
    """What is known of the truth; nothing where no row says anything."""
    fields, num_poses, objects = {}, len(rows["odometry"]) + 1, rows["true_object"]
    if rows["true_pose"]:
        times = [row.index("time", num_poses) for row in rows["true_pose"]]
        fields["true_poses"] = np.full((num_poses, 3), np.nan)
        for time, row in _by_name(rows["true_pose"], times, "time").items():
            fields["true_poses"][time] = *row.numbers("x", "y"), *row.known("theta")
    if objects:
        fields["object_xy"] = np.array([row.known("x", "y") for row in objects])
    of_rows = [row.text.get("object", "") for row in rows["observation"]]
    if not any(of_rows):
        return fields
    names = list(_by_name(objects, [row.text["object"] for row in objects], "object"))
    names = names or sorted(set(of_rows) - {"", NO_OBJECT})
    number = {name: k for k, name in enumerate(names)} | {"": UNKNOWN, NO_OBJECT: CLUTTER}
    for row, name in zip(rows["observation"], of_rows, strict=True):
        if name not in number:
            raise ValueError(f"{row.where}: object: expected one of those in rows of true_object, got {shorten(name)}")
    return fields | {"true_object": np.array([number[name] for name in of_rows], dtype=int)}


def write_csv_log(path, fields: dict) -> None:
    """Write the fields of a log, see ``log_fields.fields_of``, as one file that ``read_csv_log`` reads back exactly."""
    stream = io.StringIO()
    kinds = [kind for kind in COVARIANCES if f"{kind}_cov" in fields]
    more = max((COVARIANCES[kind] for kind in kinds), key=len, default=())
    beliefs = ((BELIEFS,) if BELIEFS in fields else ()) + ((SYMMETRY,) if "class_symmetry" in fields else ())
    writer = csv.DictWriter(stream, (*COLUMNS, *more, *beliefs), lineterminator="\n")
    writer.writeheader()
    writer.writerows(_written(fields))
    with atomic_write(path) as file:
        file.write(stream.getvalue())


def _written(fields: dict) -> Iterator[dict]:
    names = fields.get("class_names", np.arange(int(fields["num_classes"]))).tolist()
    objects = {UNKNOWN: "", CLUTTER: NO_OBJECT}
    thetas = fields.get("obs_theta", np.full(len(fields["obs_time"]), np.nan))
    yield _row("odometry_std", fields["odometry_std"])
    yield _row("observation_std", [*fields["observation_std"], fields.get("observation_theta_std", np.nan)])
    symmetry = ({SYMMETRY: n} for n in fields["class_symmetry"]) if "class_symmetry" in fields else [{}] * len(names)
    yield from ({"kind": "class", "class": name} | own for name, own in zip(names, symmetry, strict=True))
    for time, (step, cov) in enumerate(zip(fields["odometry"], written_details(fields, "odometry"), strict=True)):
        yield _row("odometry", step, time=time) | cov
    true_object = fields.get("true_object", np.full(len(fields["obs_time"]), UNKNOWN)).tolist()
    seen = zip(
        fields["obs_time"], np.column_stack([fields["obs_xy"], thetas]), fields["obs_class"], true_object, strict=True
    )
    for (time, xy, c, k), cov in zip(seen, written_details(fields, "observation"), strict=True):
        yield _row("observation", xy, time=time) | {"class": names[c], "object": objects.get(k, k)} | cov
    for time, pose in enumerate(fields.get("true_poses", ())):
        if not np.isnan(pose[:2]).any():
            yield _row("true_pose", pose, time=time)
    for k, xy in enumerate(fields.get("object_xy", ())):
        yield _row("true_object", [*xy, *fields.get("object_theta", [])[k : k + 1]]) | {
            "class": names[fields["object_class"][k]],
            "object": k,
        }


def _row(kind: str, numbers, **more) -> dict:
    """A row; ``repr`` of a float is the shortest text that reads back as the same."""
    written = {name: repr(float(value)) for name, value in zip(("x", "y", "theta"), numbers, strict=False)}
    return {"kind": kind} | {name: "" if text == "nan" else text for name, text in written.items()} | more
