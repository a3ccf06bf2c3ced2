"""The lines of a text file that holds a pose graph: their tags, ids and numbers, before it is known what they mean.

Files of g2o and of TORO are read alike: TORO's tags have other names, and its information matrices another order.
"""

import gzip
import io
import math
import zlib

from npslam_teach.system.files import MAX_BYTES, read_bytes, shorten
from npslam_teach.validation import LARGEST

MAX_LINE_BYTES = 1 << 20  # whatever has longer lines is no text; splitting it would take many times its size

FIELDS = {  # tag -> names of its ids, names of its numbers
    b"VERTEX_SE2": (("id",), ("x", "y", "theta")),
    b"VERTEX_XY": (("id",), ("x", "y")),
    b"EDGE_SE2": (("i", "j"), ("dx", "dy", "dtheta", "I11", "I12", "I13", "I22", "I23", "I33")),
    b"EDGE_SE2_XY": (("i", "l"), ("x", "y", "I11", "I12", "I22")),
    b"FIX": (("id",), ()),
    b"PARAMS_SE2OFFSET": (("id",), ("x", "y", "theta")),
}
TORO = {b"VERTEX2": b"VERTEX_SE2", b"EDGE2": b"EDGE_SE2"}
TORO_INFORMATION = (0, 1, 2, 3, 4, 7, 5, 8, 6)  # TORO writes I11 I12 I22 I33 I13 I23
FOREIGN = {  # tags of other programs
    b"ODOMETRY": "iSAM",
    b"LANDMARK": "iSAM",
    b"POINT2": "iSAM",
    b"EDGE_SE2_SWITCHABLE": "Vertigo",
    b"VERTEX_SWITCH": "Vertigo",
    b"EQUIV": "TORO, a command to join two poses",
}


def parse(path) -> dict:
    """Tag -> list of (line number, ids, numbers), in the order of the file.

    Raises:
        FileNotFoundError: no such file.
        ValueError: names the file, the line and the field, what was expected and what came.
    """
    rows = {tag: [] for tag in FIELDS}
    # Bytes, not text: a number has no other digits than ASCII's, and a comment may be in any encoding.
    for line_number, line in enumerate(_text(path).splitlines(), 1):
        if len(line) > MAX_LINE_BYTES:
            problem = f"expected at most {MAX_LINE_BYTES} bytes, got {len(line)}"
            raise ValueError(f"{path}, line {line_number}: {problem}")
        fields = line.split(b"#", 1)[0].split()
        if fields:
            tag = TORO.get(fields[0], fields[0])
            for ids, numbers in _convert(path, line_number, tag, fields):
                rows[tag].append((line_number, ids, numbers))
    return rows


def _text(path) -> bytes:
    """What the file says, unpacked, without a byte-order mark."""
    data = read_bytes(path)
    if data.startswith(b"\x1f\x8b"):
        try:
            with gzip.open(io.BytesIO(data)) as stream:
                data = stream.read(MAX_BYTES + 1)
        except (OSError, EOFError, zlib.error) as error:
            raise ValueError(f"{path}: expected a whole gzip file, got {error}") from None
        if len(data) > MAX_BYTES:
            raise ValueError(f"{path}: expected at most {MAX_BYTES} bytes when unpacked, got more")
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        raise ValueError(f"{path}: expected ASCII or UTF-8, got UTF-16")
    return data.removeprefix(b"\xef\xbb\xbf")


def _convert(path, line_number: int, tag: bytes, fields: list) -> list[tuple[list, list]]:
    """The ids and the numbers of one line; a line that fixes several vertices counts once for each."""
    if tag not in FIELDS:
        raise ValueError(f"{path}, line {line_number}: {_unknown(tag)}")
    if tag == b"FIX" and len(fields) > 2:
        return [_converted(path, line_number, tag, [fields[0], each]) for each in fields[1:]]
    id_names, number_names = FIELDS[tag]
    if len(fields) - 1 != len(id_names) + len(number_names):
        wanted = " ".join(id_names + number_names)
        problem = f"expected {len(id_names + number_names)} values ({wanted}), got {len(fields) - 1}"
        raise ValueError(f"{path}, line {line_number}: {fields[0].decode()}: {problem}")
    ids, numbers = _converted(path, line_number, tag, fields)
    if fields[0] == b"EDGE2":
        numbers = [numbers[k] for k in TORO_INFORMATION]
    return [(ids, numbers)]


def _converted(path, line_number: int, tag: bytes, fields: list) -> tuple[list, list]:
    first = 1 + len(FIELDS[tag][0])
    try:
        return [_integer(field) for field in fields[1:first]], [_number(field) for field in fields[first:]]
    except ValueError:
        # A file has a hundred thousand right lines; which word it is, only the wrong one needs to know.
        raise ValueError(f"{path}, line {line_number}: {_first_wrong(tag, fields)}") from None


def _first_wrong(tag: bytes, fields: list) -> str:
    """What is wrong with the first word of a line that does not say what it should."""
    id_names, number_names = FIELDS[tag]
    for name, field in zip(id_names + number_names, fields[1:], strict=True):
        try:
            _ = _integer(field) if name in id_names else _number(field)
        except ValueError as error:
            return f"{fields[0].decode()} {name}: {error}, got {_quote(field)}"
    raise AssertionError("no word is wrong")


def _unknown(tag: bytes) -> str:
    if tag in FOREIGN:
        return f"expected a file of g2o or TORO, got the tag {_quote(tag)} of {FOREIGN[tag]}"
    if b"SE3" in tag or b"XYZ" in tag or b"QUAT" in tag or tag in (b"VERTEX3", b"EDGE3"):
        return f"expected a two-dimensional graph, got the tag {_quote(tag)} of a three-dimensional one"
    if b"BEARING" in tag or b"RANGE" in tag:
        return f"expected landmarks measured as x y, in EDGE_SE2_XY, got {_quote(tag)}, which is of bearings or ranges"
    if tag.upper() in FIELDS:
        return f"expected the tag {tag.upper().decode()} in capitals, got {_quote(tag)}"
    known = ", ".join(known.decode() for known in FIELDS)
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
    if -LARGEST <= value <= LARGEST and b"_" not in field:
        return value
    if not math.isfinite(value) or b"_" in field:
        raise ValueError("expected a finite number")
    raise ValueError(f"expected a number up to {LARGEST:g}")
