"""Robot logs in and out: our own .npz files, and the authors' two kinds of .mat files by their variables."""

import io
import math
import tokenize
import warnings
import zipfile
import zlib
from pathlib import Path

import numpy as np

from npslam_teach.datasets.mat_files import read_mat
from npslam_teach.datasets.mu2016 import (
    MAX_CLASSES,
    SIMULATION_VARIABLES,
    STATA_VARIABLES,
    simulation_from,
    stata_office_from,
)
from npslam_teach.system.files import atomic_write, prefix_errors, read_bytes, shorten
from npslam_teach.types import GroundTruth, RobotLog, World
from npslam_teach.validation import checked_array

__all__ = ["load_log", "save_log"]

LOG_FIELDS = ("odometry", "obs_time", "obs_xy", "obs_class", "num_classes", "odometry_std", "observation_std")
TRUTH_FIELDS = ("true_poses", "true_object", "object_xy", "object_class")
_NAMES_FIELD = "class_names"
_MAX_FIELD_BYTES = 1 << 26  # 2.8 million poses, unpacked; how small they were packed says nothing: a robot may rest
# What NumPy writes. The others fail in ways of their own and would only serve to hide a larger bomb.
_COMPRESSIONS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)

# What zipfile raises on damaged or encrypted archives, and NumPy on damaged headers of arrays, which it parses as
# Python source.
_ARCHIVE_ERRORS = (
    zipfile.BadZipFile,
    zlib.error,
    ValueError,
    OSError,
    EOFError,
    RuntimeError,
    MemoryError,
    OverflowError,
    TypeError,
    SyntaxError,
    tokenize.TokenError,
)


def load_log(path) -> tuple[RobotLog, GroundTruth | None]:
    """Read what a robot recorded, and what really happened if the file knows.

    A ``.npz`` log holds the fields of `RobotLog` under their names and optionally, all together, the truth:
    ``true_poses`` (T, 3), ``true_object`` (M,) with -1 for clutter, ``object_xy`` (K, 2), ``object_class``
    (K,); with them may come ``class_names``, text (num_classes,). Other entries are ignored. A ``.mat`` file
    is one of the authors' two (see `load_mu2016_simulation` and `load_stata_office`); its variables tell
    which.

    Args:
        path: a .npz or .mat file.

    Raises:
        FileNotFoundError: no such file.
        ValueError: anything else; names the file and the field, what was expected and what came.
    """
    suffix = Path(path).suffix.lower()
    if suffix == ".npz":
        return _load_npz(path)
    if suffix == ".mat":
        return _load_mat(path)
    raise ValueError(f"{path}: expected a file name that ends in .npz or .mat, got {shorten(suffix)}")


def _load_mat(path) -> tuple[RobotLog, GroundTruth | None]:
    variables = read_mat(path, SIMULATION_VARIABLES + STATA_VARIABLES)
    with prefix_errors(path):
        if not variables:
            wanted = f"{', '.join(SIMULATION_VARIABLES)} (simulation) or {STATA_VARIABLES[0]} (office)"
            raise ValueError(f"expected the variables {wanted}, got none of them")
        if STATA_VARIABLES[0] in variables:
            return stata_office_from(variables), None
        return simulation_from(variables)


def _load_npz(path) -> tuple[RobotLog, GroundTruth | None]:
    data = read_bytes(path)
    with prefix_errors(path):
        fields = _read_fields(data, (*LOG_FIELDS, *TRUTH_FIELDS, _NAMES_FIELD))
        missing = [name for name in LOG_FIELDS if name not in fields]
        if missing:
            raise ValueError(f"expected the fields {', '.join(LOG_FIELDS)}, missing {', '.join(missing)}")
        num_classes = checked_array("num_classes", fields["num_classes"], ()).item()
        if num_classes > MAX_CLASSES:
            raise ValueError(f"num_classes: expected at most {MAX_CLASSES}, got {num_classes:g}")
        log = RobotLog(**{name: fields[name] for name in LOG_FIELDS} | {"num_classes": num_classes})
        return log, _truth_from(fields, log)


def _truth_from(fields: dict, log: RobotLog) -> GroundTruth | None:
    """The truth that belongs to ``log``, or None if there is none in ``fields``."""
    missing = [name for name in TRUTH_FIELDS if name not in fields]
    if len(missing) == len(TRUTH_FIELDS):
        return None
    if missing:
        wanted = f"all or none of the fields {', '.join(TRUTH_FIELDS)}"
        raise ValueError(f"expected {wanted}, missing {', '.join(missing)}")
    names = fields.get(_NAMES_FIELD, np.array([f"class {c}" for c in range(log.num_classes)]))
    if names.dtype.kind != "U" or names.shape != (log.num_classes,):
        got = f"{names.dtype} of shape {names.shape}"
        raise ValueError(f"{_NAMES_FIELD}: expected text of shape ({log.num_classes},), got {got}")
    poses = checked_array("true_poses", fields["true_poses"], (log.num_poses, 3))
    obs_object = checked_array("true_object", fields["true_object"], (log.num_observations,), int)
    world = World(fields["object_xy"], fields["object_class"], names.tolist())
    with prefix_errors("true_object"):
        return GroundTruth(world, poses, obs_object)


def save_log(path, log: RobotLog, truth: GroundTruth | None = None) -> None:
    """Write a log, and the truth if there is one, to a ``.npz`` file that `load_log` reads back exactly.

    Args:
        path: the file to make or replace; its name must end in .npz. Untouched when something goes wrong.
        log: what the robot recorded.
        truth: what really happened, for the same poses and observations.

    Raises:
        FileNotFoundError: the folder does not exist.
        ValueError: the file cannot be written, or the truth does not belong to the log.
    """
    if Path(path).suffix.lower() != ".npz":
        raise ValueError(f"{path}: expected a file name that ends in .npz, got {shorten(Path(path).suffix)}")
    if log.num_classes > MAX_CLASSES:
        raise ValueError(f"{path}: num_classes: expected at most {MAX_CLASSES}, got {log.num_classes}")
    fields = {name: np.asarray(getattr(log, name)) for name in LOG_FIELDS}
    if truth is not None:
        world = truth.world
        fields |= {"true_poses": truth.poses, "true_object": truth.obs_object}
        fields |= {"object_xy": world.object_xy, "object_class": world.object_class}
        fields[_NAMES_FIELD] = np.array(world.class_names, dtype=str)
    with prefix_errors(path):
        _truth_from(fields, log)
    with atomic_write(path, "wb") as stream:
        np.savez(stream, **fields)


def _read_fields(data: bytes, names: tuple) -> dict:
    """Those of the arrays called ``names`` that a .npz archive holds.

    ``np.load`` believes an array's header and allocates what it claims, a terabyte if it says so; here the
    header is first compared with the bytes that are there. Pickled objects are never unpickled: that would
    run the file's code.
    """
    try:
        archive = zipfile.ZipFile(io.BytesIO(data))
    except _ARCHIVE_ERRORS as error:
        raise ValueError(f"expected a .npz archive (zip), got {_describe(error)}") from None
    with archive:
        members = {info.filename.removesuffix(".npy"): info for info in archive.infolist()}
        return {name: _read_field(archive, members[name], name) for name in names if name in members}


def _describe(error: Exception) -> str:
    return shorten(f"{type(error).__name__}: {error}", 120)


def _read_field(archive: zipfile.ZipFile, member: zipfile.ZipInfo, name: str) -> np.ndarray:
    size = member.file_size
    if size > _MAX_FIELD_BYTES:
        raise ValueError(f"{name}: expected at most {_MAX_FIELD_BYTES} bytes, got {size}")
    if member.compress_type not in _COMPRESSIONS:
        raise ValueError(f"{name}: expected an entry stored or deflated, got method {member.compress_type} of zip")
    try:
        raw = archive.read(member)
    except _ARCHIVE_ERRORS as error:
        raise ValueError(f"{name}: expected an intact entry, got {_describe(error)}") from None
    return _parse_npy(raw, name)


def _parse_npy(raw: bytes, name: str) -> np.ndarray:
    stream = io.BytesIO(raw)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # headers by Python 2, odd escapes: taken or refused, not discussed
        try:
            shape, dtype = _npy_header(stream)
        except _ARCHIVE_ERRORS as error:
            raise ValueError(f"{name}: expected an array in NumPy's format, got {_describe(error)}") from None
        _require_plain(name, shape, dtype, len(raw) - stream.tell())
        try:
            stream.seek(0)
            return np.lib.format.read_array(stream, allow_pickle=False)
        except ValueError as error:
            raise ValueError(f"{name}: expected an array in NumPy's format, got {_describe(error)}") from None


def _require_plain(name: str, shape: tuple, dtype: np.dtype, left: int) -> None:
    """Raise ``ValueError`` unless the header claims plain data of just as many bytes as are ``left``."""
    if dtype.hasobject:
        raise ValueError(f"{name}: expected plain numbers or text, got pickled Python objects")
    size = math.prod(shape) * dtype.itemsize
    if size != left or not dtype.itemsize or min(shape, default=0) < 0:
        claim = shorten(f"a header that claims {shape} of {dtype}")
        raise ValueError(f"{name}: expected an array of the {left} bytes in the file, got {claim}")


def _npy_header(stream) -> tuple[tuple, np.dtype]:
    """Shape and dtype as the header claims them."""
    version = np.lib.format.read_magic(stream)
    readers = {(1, 0): np.lib.format.read_array_header_1_0, (2, 0): np.lib.format.read_array_header_2_0}
    if version not in readers:
        raise ValueError(f"version {version} of the format")
    shape, _, dtype = readers[version](stream)
    return shape, dtype
