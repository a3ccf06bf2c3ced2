"""A reader for MATLAB's .mat files (Level 5: versions 5 to 7), as far as the authors' data needs it.

Why not ``scipy.io.loadmat``: a damaged file can make it crash the whole Python process (a segmentation fault,
which no ``except`` catches), or raise a dozen kinds of exceptions. Here every length is compared with the
bytes that are there before it is used. The tests hold this reader against SciPy's on intact files.

Why not SciPy for the authors' two files alone, known by their sha256: `solve` and `reproduce --data` would refuse a run
that somebody else saved with the authors' variables, and a file of theirs that was saved anew; its error could not name
the variable that is wrong; and without the originals, which are not shipped, no test could read a .mat file.

Source: MathWorks, "MAT-File Format", chapter 1. A file is a header of 128 bytes and then elements: a tag
(type, size) and data. A variable is an element that holds further elements, and is usually compressed.
"""

import math
import struct
import zlib

import numpy as np

from npslam_teach.system.files import prefix_errors, read_bytes

_COMPRESSED, _MATRIX = 15, 14
_NUMBER_TYPES = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}
_STRUCT_CLASS, _OPAQUE_CLASS, _NUMBER_CLASSES = 2, 17, range(6, 16)
_CLASS_NAMES = {1: "cells", 2: "too deep a nesting", 3: "an object", 4: "text", 5: "a sparse matrix"}
_COMPLEX_FLAG = 0x800
_MAX_BYTES = 1 << 23  # after decompression, and of a variable's numbers; the authors' larger file has 0.9 million
_MAX_DEPTH = 8  # structures within structures
_MAX_STRUCTURES = 100_000  # in one array; an empty one takes 8 bytes of the file and a thousand of memory


def read_mat(path, names) -> dict:
    """Read the variables called ``names`` from a .mat file; those that the file lacks are left out.

    Args:
        path: a .mat file, Level 5 (MATLAB's ``save -v6`` and ``-v7``, Octave, SciPy).
        names: the variables wanted; others are skipped and may be of any kind.

    Returns:
        name -> float64 array of the shape it has in MATLAB (at least two axes), or, for a structure array, a
        list of one dict (field -> value) per structure, in MATLAB's order.

    Raises:
        FileNotFoundError: no such file.
        ValueError: not a Level 5 file, damaged, or a wanted variable is neither real numbers nor structures.
    """
    data = read_bytes(path)
    variables = {}
    with prefix_errors(path):
        order = _byte_order(data)
        for matrix in _top_level_matrices(data, order):
            flags, shape, name, elements = _header(matrix, order)
            if name in names:
                with prefix_errors(name):
                    variables[name] = _value(flags, shape, elements, order)
    return variables


def _byte_order(data: bytes) -> str:
    """The byte order in `struct`'s notation, from the file's header."""
    if data.startswith(b"MATLAB 7.3") or b"\x89HDF\r\n\x1a\n" in (data[:8], data[512:520]):
        raise ValueError("expected a Level 5 .mat file, got version 7.3 (HDF5), to be saved again with -v7")
    mark, version = data[126:128], data[124:126]
    if (mark, version) not in ((b"IM", b"\x00\x01"), (b"MI", b"\x01\x00")):
        raise ValueError("expected a MATLAB Level 5 .mat file, got something else (no such header)")
    return "<" if mark == b"IM" else ">"


def _damaged(got: str) -> ValueError:
    return ValueError(f"expected an intact .mat file, got {got}")


def _top_level_matrices(data: bytes, order: str):
    """Yield the contents of each variable's element, decompressed."""
    at, budget = 128, _MAX_BYTES
    while at < len(data):
        kind, contents, at = _element(memoryview(data), at, order)
        if kind == _COMPRESSED:
            contents = memoryview(_decompress(contents, budget))
            budget -= len(contents)
            kind, contents, _ = _element(contents, 0, order)
        if kind != _MATRIX:
            raise _damaged(f"type {kind} where a variable begins")
        yield contents


def _decompress(contents: memoryview, budget: int) -> bytes:
    decompressor = zlib.decompressobj()
    try:
        data = decompressor.decompress(contents, max(budget, 1))
        # One more byte: the checksum is only looked at when the end of the stream is reached.
        data += decompressor.decompress(decompressor.unconsumed_tail, 1)
    except zlib.error as error:
        raise _damaged(f"damaged compressed data ({error})") from None
    if not decompressor.eof:
        raise _damaged("too much data" if len(data) > budget else "compressed data that ends too early")
    return data


def _element(data: memoryview, at: int, order: str) -> tuple[int, memoryview, int]:
    """Type and contents of the element that begins at byte ``at``, and where the next one begins."""
    if at + 8 > len(data):
        raise _damaged("one that ends too early")
    kind, size = struct.unpack_from(order + "II", data, at)
    if kind >> 16:  # the short form: size and type share the first word, the contents are the second
        kind, size = kind & 0xFFFF, kind >> 16
        start, end = at + 4, at + 8
    else:
        start = at + 8
        end = start + size + (0 if kind == _COMPRESSED else -size % 8)
    if start + size > min(end, len(data)):
        raise _damaged(f"an element of {size} bytes where fewer are left")
    return kind, data[start : start + size], end


def _header(matrix: memoryview, order: str) -> tuple[int, list, str, memoryview]:
    """Flags, shape and name of a variable, and the elements that hold its value."""
    kind, contents, at = _element(matrix, 0, order)
    flags = _numbers(kind, contents, order, "u4").tolist()
    if flags and flags[0] & 0xFF == _OPAQUE_CLASS:
        return flags[0], [], "", matrix[:0]  # MATLAB's newer objects have another form; nobody asks for one
    kind, contents, at = _element(matrix, at, order)
    shape = _numbers(kind, contents, order, "i4").tolist()
    if len(flags) != 2 or len(shape) < 2 or min(shape) < 0:
        raise _damaged(f"a variable with {len(flags)} flags and shape {shape[:4]}")
    _, contents, at = _element(matrix, at, order)
    return flags[0], shape, bytes(contents).decode("latin-1"), matrix[at:]


def _numbers(kind: int, contents: memoryview, order: str, expected: str = "") -> np.ndarray:
    dtype = _NUMBER_TYPES.get(kind)
    if dtype is None or (expected and dtype != expected) or len(contents) % int(dtype[1]):
        raise _damaged(f"{len(contents)} bytes of type {kind} for numbers")
    return np.frombuffer(contents, order + dtype)


def _value(flags: int, shape: list, elements: memoryview, order: str, depth: int = 0):
    matlab_class = flags & 0xFF
    if matlab_class == _STRUCT_CLASS and depth < _MAX_DEPTH:
        return _structures(math.prod(shape), elements, order, depth)
    if matlab_class not in _NUMBER_CLASSES or flags & _COMPLEX_FLAG:
        is_complex = matlab_class in _NUMBER_CLASSES
        got = "complex numbers" if is_complex else _CLASS_NAMES.get(matlab_class, f"class {matlab_class}")
        raise ValueError(f"expected real numbers or a structure, got {got}")
    kind, contents, _ = _element(elements, 0, order)
    numbers = _numbers(kind, contents, order)
    if 8 * numbers.size > _MAX_BYTES:
        raise _damaged("too much data")
    if numbers.size != math.prod(shape):
        raise _damaged(f"{numbers.size} numbers for the shape {shape[:4]}")
    # MATLAB stores doubles that are whole numbers as unsigned bytes: minus one of those would be 255.
    return numbers.astype(float).reshape(shape, order="F")


def _structures(count: int, elements: memoryview, order: str, depth: int) -> list:
    """``count`` structures with the same fields; the fields of the first come first."""
    kind, contents, at = _element(elements, 0, order)
    width = int(_numbers(kind, contents, order, "i4")[:1].sum())
    _, names, at = _element(elements, at, order)
    if width <= 0 or len(names) % width:
        raise _damaged(f"{len(names)} bytes for names that are {width} bytes wide")
    padded = [bytes(names[k : k + width]) for k in range(0, len(names), width)]
    fields = [name.split(b"\0")[0].decode("latin-1") for name in padded]
    if count > _MAX_STRUCTURES:
        raise ValueError(f"expected at most {_MAX_STRUCTURES} structures, got {count}")
    structures = []
    for _ in range(count if fields else 0):  # a count that is too large runs out of elements at once
        structure = {}
        for field in fields:
            kind, contents, at = _element(elements, at, order)
            structure[field] = _field(kind, contents, order, depth)
        structures.append(structure)
    return structures


def _field(kind: int, contents: memoryview, order: str, depth: int):
    if kind != _MATRIX:
        raise _damaged(f"an element of type {kind} as a field")
    if not len(contents):
        return np.zeros((0, 0))  # how MATLAB writes a field that was never set
    flags, shape, _, elements = _header(contents, order)
    return _value(flags, shape, elements, order, depth + 1)
