"""Arrays out of .npz archives that nobody vouches for: what a header claims is compared with what is there."""

import io
import math
import tokenize
import warnings
import zipfile
import zlib

import numpy as np

from npslam_teach.system.files import prefix_errors, read_bytes, shorten

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


def read_npz(path, names: tuple) -> dict:
    """Those of the arrays called ``names`` that a .npz archive holds.

    ``np.load`` trusts an array's header and allocates what it claims, a terabyte if it says so; here the
    header is first compared with the bytes that are there. Pickled objects are never unpickled: that would
    run the file's code.

    Raises:
        FileNotFoundError: no such file.
        ValueError: the archive or an array is damaged, or too large.
    """
    data = read_bytes(path)
    with prefix_errors(path):
        return _fields_in(data, names)


def _fields_in(data: bytes, names: tuple) -> dict:
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
