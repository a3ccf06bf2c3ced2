"""Thousands of damaged .g2o, .npz and .mat files, the same ones on every run.

A file is a pure function of its format and its number, so that a worker can make it anew, and a failure names it.
"Blind" damage knows nothing of the format. "Deep" damage takes a file apart, breaks something, and puts it together
with valid checksums, so that what lies behind the checksums is reached, too.
"""

import functools
import io
import os
import pickle
import struct
import warnings
import zipfile
import zlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import scipy.io
from graphs import random_graph
from layouts import fields_of, office_variables, simulation_variables
from numpy.lib.recfunctions import repack_fields

from npslam_teach import datasets, methods, simulate

SEED = 20161009
BOMB_EVERY = 151  # they are slow to make
SUFFIXES = ("g2o", "npz", "mat")
KEPT = "NPSLAM_TEACH_TEST_INTACT_FILES"  # names the file in which another process keeps them


@dataclass(frozen=True)
class Damaged:
    """A file to be, and how it was made."""

    name: str
    contents: bytes
    suffix: str
    number: int


def damaged(suffix: str, number: int, bases: dict | None = None) -> Damaged:
    """Damaged file ``number`` of a format; ``bases`` are the intact files (suffix -> list of bytes), ours if None."""
    bases = bases or intact_files()
    rng = np.random.default_rng([SEED, SUFFIXES.index(suffix), number])
    kind = kind_of(suffix, number)
    contents = kind(bases[suffix][rng.integers(len(bases[suffix]))], rng)
    return Damaged(f"{suffix}-{number}-{kind.__name__}", contents, suffix, number)


def kind_of(suffix: str, number: int):
    """What damages file ``number`` of a format: a third are damaged blindly, the others deep, some are bombs."""
    if number % BOMB_EVERY == 1 and suffix in BOMBS:
        return BOMBS[suffix]
    return DEEP[suffix][number // 3 % len(DEEP[suffix])] if number % 3 else blind


# ---- the intact files ----


@functools.cache
def intact_files() -> dict:
    """Small files of every layout: suffix -> list of bytes."""
    if KEPT in os.environ:
        return pickle.loads(Path(os.environ[KEPT]).read_bytes())
    files = {"g2o": [g2o_bytes(random_graph(seed, num_landmarks=seed % 5)) for seed in range(24)], "npz": [], "mat": []}
    for seed in range(12):
        log, truth = small_run(seed)
        *_, last = methods.np_graph(log)
        files["g2o"].append(g2o_bytes(last.graph))
        arrays = [fields_of(log, truth), fields_of(log, truth), fields_of(log)][seed % 3]
        files["npz"].append(npz_bytes(arrays, (zipfile.ZIP_DEFLATED, zipfile.ZIP_STORED)[seed % 2]))
        variables = (simulation_variables, office_variables)[seed % 2](log, truth)
        files["mat"] += [mat_bytes(variables, compressed) for compressed in (False, True)]
    return files


def small_run(seed: int):
    """Some ten poses on a circle, among four objects of two classes."""
    rng = np.random.default_rng([SEED, seed])
    world = simulate.scattered_world(2, ("chair", "cup"), rng, size=6.0)
    turn = np.linspace(0, 7, 300)
    path = simulate.follow(np.column_stack([3 + 2 * np.cos(turn), 3 + 2 * np.sin(turn)]), rng.uniform(0.7, 1.2))
    return simulate.simulate_run(world, path, simulate.paper_sensor(0.5), rng)


def g2o_bytes(graph) -> bytes:
    """The graph as a .g2o file."""
    from tempfile import TemporaryDirectory

    with TemporaryDirectory() as folder:
        datasets.save_g2o(f"{folder}/graph.g2o", graph)
        with open(f"{folder}/graph.g2o", "rb") as stream:
            return stream.read()


def npz_bytes(fields: dict, compression: int = zipfile.ZIP_DEFLATED) -> bytes:
    """Arrays, or the bytes that stand for them, as entries of a .npz archive."""
    return zip_bytes({f"{name}.npy": npy_bytes(value) for name, value in fields.items()}, compression)


def zip_bytes(entries: dict, compression: int = zipfile.ZIP_DEFLATED) -> bytes:
    """An archive of these entries (name -> bytes)."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", compression) as archive:
        for name, contents in entries.items():
            archive.writestr(zipfile.ZipInfo(name), contents, compression)
    return stream.getvalue()


def npy_bytes(array) -> bytes:
    """One entry of a .npz archive."""
    if isinstance(array, bytes):
        return array
    stream = io.BytesIO()
    np.lib.format.write_array(stream, np.asanyarray(array), allow_pickle=np.asanyarray(array).dtype.hasobject)
    return stream.getvalue()


def mat_bytes(variables: dict, compressed: bool = True) -> bytes:
    """Variables as a .mat file; the date and machine that SciPy writes into its header are taken out."""
    stream = io.BytesIO()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # names that MATLAB would not take
        scipy.io.savemat(stream, variables, do_compression=compressed, long_field_names=True)
    return b"MATLAB 5.0 MAT-file".ljust(116) + stream.getvalue()[116:]


# ---- blind damage ----


def blind(contents: bytes, rng) -> bytes:
    """Bytes flipped, changed, cut, repeated, moved, or something else altogether."""
    start = int(rng.integers(len(contents)))
    size = int(min(rng.choice([1, 2, 4, 8, 30, 200, 5000]), len(contents) - start))
    before, piece, after = contents[:start], contents[start : start + size], contents[start + size :]
    other = intact_files()[str(rng.choice(SUFFIXES))]
    choices = [
        lambda: _flipped(contents, rng),
        lambda: _flipped(contents, rng),
        lambda: before,
        lambda: contents[start:],
        lambda: before + after,
        lambda: before + piece + piece + after,
        lambda: before + rng.bytes(size) + after,
        lambda: before + rng.bytes(size) + piece + after,
        lambda: before + b"\0" * size + after,
        lambda: before + b"\xff" * size + after,
        lambda: after + piece + before,
        lambda: contents + rng.bytes(size),
        lambda: contents * 2,
        lambda: contents[: int(rng.integers(20))],
        lambda: other[int(rng.integers(len(other)))],
        lambda: rng.bytes(int(rng.integers(1, 3000))),
        lambda: zlib.compress(contents),
        lambda: contents.decode("latin-1").encode(str(rng.choice(["utf-8", "utf-16", "utf-32", "utf-8-sig"]))),
    ]
    return choices[int(rng.integers(len(choices)))]()


def _flipped(contents: bytes, rng) -> bytes:
    changed = bytearray(contents)
    for position in rng.integers(len(contents), size=rng.choice([1, 1, 2, 4, 16])):
        changed[position] ^= 1 << int(rng.integers(8))
    return bytes(changed)


# ---- .g2o ----

NASTY_WORDS = (
    "nan -nan inf -inf 1e308 -1e308 1e999 1e-320 1e15 1.0000001e15 1e8 -1e8 0 -0 -0.0 -1 1_0 0x10 1,5 1e 1d3 + --1 "
    "9223372036854775807 9223372036854775808 18446744073709551616 00000000000000000001 1.0 \xb2 \u0664 \xff \x00 "
    "NaN(7) \ufeff0 VERTEX_SE2 EDGE_SE2_XY FIX # ''"
).split() + ["9" * 400, "0." + "3" * 5000, "1" + "0" * 300]


def nasty_word(contents: bytes, rng) -> bytes:
    """One word, or one word in several lines, replaced by something that is hard to read."""
    lines = _words(contents)
    for row in rng.integers(len(lines), size=rng.choice([1, 1, 3])):
        lines[row][int(rng.integers(len(lines[row])))] = str(rng.choice(NASTY_WORDS)).encode(
            str(rng.choice(["utf-8", "utf-16"]))
        )
    return _text(lines)


def wrong_number_of_words(contents: bytes, rng) -> bytes:
    """A word too few or too many, two words swapped, two lines joined."""
    lines = _words(contents)
    row = int(rng.integers(len(lines) - 1))
    line, column = lines[row], int(rng.integers(len(lines[row])))
    choices = [
        lambda: line.pop(column),
        lambda: line.insert(column, b"7"),
        lambda: line.append(line[column]),
        lambda: line.extend(lines.pop(row + 1)),
        lambda: line.insert(column, b"#"),
        lambda: line.insert(0, line.pop(column)),
        lambda: line.extend([b"1"] * 20_000),
    ]
    choices[int(rng.integers(len(choices)))]()
    return _text(lines)


def lines_moved(contents: bytes, rng) -> bytes:
    """Lines lost, repeated or shuffled; every line of one kind lost; vertices after edges."""
    lines = _words(contents)
    row, tag = int(rng.integers(len(lines))), str(rng.choice(["VERTEX_SE2", "VERTEX_XY", "EDGE_SE2", "EDGE_SE2_XY"]))
    choices = [
        lambda: lines[:row] + lines[row + 1 :],
        lambda: lines[:row] + [lines[row]] * int(rng.choice([2, 3, 200])) + lines[row + 1 :],
        lambda: [lines[k] for k in rng.permutation(len(lines))],
        lambda: [line for line in lines if line[0] != tag.encode()],
        lambda: [line for line in lines if rng.random() < 0.9],
        lambda: [line for line in lines if not line[0].startswith(b"EDGE") or rng.random() < 0.5],
        lambda: lines[::-1],
        lambda: lines * 2,
        lambda: lines + [line for line in lines if line[0].startswith(b"EDGE")] * int(rng.choice([1, 20])),
    ]
    return _text(choices[int(rng.integers(len(choices)))]())


def ids_changed(contents: bytes, rng) -> bytes:
    """Ids that are twice there, that nobody has, that are huge; self loops; vertices of the wrong kind; FIX."""
    lines = _words(contents)
    row = int(rng.integers(len(lines)))
    ids = [line[1] for line in lines if line[0].startswith(b"VERTEX")]
    edge = [line for line in lines if line[0].startswith(b"EDGE")][int(rng.integers(1, 10))]
    choices = [
        lambda: lines[row].__setitem__(1, ids[int(rng.integers(len(ids)))]),
        lambda: edge.__setitem__(2, edge[1]),
        lambda: edge.__setitem__(1, edge[2]),
        lambda: edge.__setitem__(2, ids[int(rng.integers(len(ids)))]),
        lambda: edge.__setitem__(int(rng.integers(1, 3)), str(rng.choice([-1, 10**6, 2**63, 10**19])).encode()),
        lambda: lines[row].__setitem__(1, str(rng.choice([-1, 10**6, 2**63, 10**19])).encode()),
        lambda: lines.insert(row, [b"FIX", ids[int(rng.integers(len(ids)))]]),
        lambda: lines.extend([[b"FIX", ids[0]]] * int(rng.integers(1, 3))),
        lambda: lines[row].__setitem__(0, str(rng.choice(TAGS)).encode()),
    ]
    choices[int(rng.integers(len(choices)))]()
    return _text(lines)


TAGS = (
    "VERTEX_SE2",
    "VERTEX_XY",
    "EDGE_SE2",
    "EDGE_SE2_XY",
    "FIX",
    "VERTEX_SE3:QUAT",
    "EDGE_SE3:QUAT",
    "vertex_se2",
    "X",
)


def numbers_scaled(contents: bytes, rng) -> bytes:
    """Some or all estimates, measurements or information matrices multiplied: by nothing, by much, by -1."""
    lines = _words(contents)
    tag = str(rng.choice(["VERTEX", "EDGE_SE2", "EDGE_SE2_XY", "EDGE"])).encode()
    factor, share = 10.0 ** rng.choice([-320, -200, -20, -8, -3, 3, 6, 8, 12, 14, 18, 200]), rng.choice([0.05, 0.5, 1])
    factor = rng.choice([factor, factor, factor, 0.0, -1.0])
    part = [slice(3, 6), slice(6, None), slice(3, None), slice(6, 7), slice(-1, None)][int(rng.integers(5))]
    for line in lines:
        if line[0].startswith(tag) and rng.random() < share:
            columns = part if tag.startswith(b"EDGE") else slice(2, None)
            line[columns] = [repr(float(word) * float(factor)).encode() for word in line[columns]]
    return _text(lines)


def odd_text(contents: bytes, rng) -> bytes:
    """Comments, encodings, ends of lines, and very long lines."""
    choices = [
        lambda: contents.replace(
            b"\n", str(rng.choice(["\r\n", "\r", "\x0b", "\x0c", "\x1c", "\u2028", " "])).encode()
        ),
        lambda: contents.replace(b" ", str(rng.choice(["\t", "  ", "\x0b", "\xa0", "\x00", ","])).encode()),
        lambda: contents.replace(b"\n", b" # r\xe9sum\xe9\n"),
        lambda: b"#" * 100_000 + b"\n" + contents,
        lambda: contents + b"\n" * 50_000,
        lambda: contents + b" " * 500_000,
        lambda: contents + b"\0" * 500_000,
        lambda: b"VERTEX_SE2 " * 20_000 + contents,
        lambda: contents.lower(),
        lambda: contents.replace(b".", b","),
    ]
    return choices[int(rng.integers(len(choices)))]()


def too_many(contents: bytes, rng) -> bytes:
    """Far more of something than the rest of the file goes with: vertices nobody sees, factors of one pair, ids."""
    last = 10_000
    choices = [
        lambda: [f"VERTEX_SE2 {last + k} 0 0 0" for k in range(3000)],
        lambda: [f"VERTEX_XY {last + k} 0 0" for k in range(3000)],
        lambda: [f"VERTEX_XY {last} 0 0"] + [f"EDGE_SE2_XY 0 {last} {k % 7} 1 1 0 1" for k in range(2000)],
        lambda: [f"EDGE_SE2 0 1 1 0 {k % 7} 1 0 0 1 0 1" for k in range(2000)],
        lambda: [f"VERTEX_SE2 {last + k} 0 0 0\nEDGE_SE2 0 {last + k} 1 0 0 1 0 0 1 0 1" for k in range(1000)],
        lambda: ["VERTEX_SE2 0 0 0 0"] * 3000,
    ]
    return contents + "\n".join(choices[int(rng.integers(len(choices)))]()).encode()


def _words(contents: bytes) -> list:
    return [line.split() for line in contents.splitlines() if line.split()]


def _text(lines: list) -> bytes:
    return b"\n".join(b" ".join(line) for line in lines)


# ---- arrays, for .npz and .mat ----


def nasty_array(value: np.ndarray, rng) -> np.ndarray:
    """An array to take the place of ``value``: another type, another shape, other numbers."""
    value = np.asarray(value)
    if value.dtype.kind not in "biuf":
        value = np.ones(value.shape)  # of text and structures nothing is left but their shape
    flat = value.ravel()
    one = int(rng.integers(max(value.size, 1)))
    choices = [
        lambda: _with_entry(value, one, rng.choice([np.nan, np.inf, -np.inf, 1e308, -1e308, 1e15, 1e16, 1e-320, -0.0])),
        lambda: _with_entry(value, one, rng.choice([-1, 2**31, 2**53, 10**4, 1000, 0.5, -7])),
        lambda: _with_entry(value, one, rng.choice([-1, 0, 1, 2, 7, 30, 1e5, 1e6])),
        lambda: value.astype(
            rng.choice(["i1", "u1", "i4", ">i8", "u8", "f2", "f4", ">f8", "f16", "?", "c16", "S3", "U3"])
        ),
        lambda: value * 10.0 ** rng.choice([-320, -160, -20, -9, -3, 3, 7, 9, 14, 155, 305]),
        lambda: value * 0,
        lambda: -value,
        lambda: np.full(value.shape, rng.choice([np.nan, np.inf, -1, 2**62, 1e300])),
        lambda: value[: len(value) // 2] if value.ndim else value.reshape(1),
        lambda: np.concatenate([value, value]) if value.ndim else value.reshape(1, 1),
        lambda: value.T if value.ndim > 1 else value[None],
        lambda: value[..., None],
        lambda: flat,
        lambda: np.zeros(rng.choice([(0,), (0, 3), (3, 0), (1, 1), (0, 2, 0)][int(rng.integers(5))], 2)),
        lambda: np.array(rng.choice([0, 1, -1, 10**9, 2**63 - 1])),
        lambda: np.array("text"),
        lambda: flat[rng.permutation(len(flat))].reshape(value.shape),
        lambda: rng.normal(size=value.shape) * 10.0 ** rng.integers(-5, 12),
        lambda: np.zeros((20_000, 3)),
        lambda: np.zeros((1,) * 30),
    ]
    with np.errstate(all="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return np.asarray(choices[int(rng.integers(len(choices)))]())


def _with_entry(value: np.ndarray, position: int, entry) -> np.ndarray:
    """The same with one number changed; integers become floats where the number is none."""
    entry_fits = value.dtype.kind in "iu" and float(entry).is_integer() and abs(entry) < np.iinfo(value.dtype).max
    changed = np.array(value if entry_fits or value.dtype.kind not in "iub" else value.astype(float))
    if changed.size and changed.dtype.kind in "iuf":
        changed.ravel()[position] = entry
    return changed


# ---- .npz ----


def npz_wrong_field(contents: bytes, rng) -> bytes:
    """One or two fields with another type, shape or other numbers."""
    fields = _arrays(contents)
    for name in rng.choice(list(fields), size=rng.choice([1, 1, 2]), replace=False):
        fields[name] = nasty_array(fields[name], rng)
    return npz_bytes(fields)


def npz_fields_moved(contents: bytes, rng) -> bytes:
    """A field lost, renamed, swapped with another, twice there, or there as something else than an array."""
    entries = _entries(contents)
    one, two = rng.choice(list(entries), size=2, replace=False)
    choices = [
        lambda: entries.pop(one),
        lambda: [entries.pop(name) for name in list(entries) if rng.random() < 0.3],
        lambda: entries.update(
            {str(rng.choice(["x.npy", one[:-4], one.upper(), "../" + one, "", "\xff"])): entries.pop(one)}
        ),
        lambda: entries.update({one: entries[two], two: entries[one]}),
        lambda: entries.update({one[:-4]: entries[two]}),
        lambda: entries.update({one: bytes(rng.bytes(int(rng.integers(200))))}),
        lambda: entries.update({one: contents}),
        lambda: entries.update({one: b""}),
        lambda: entries.update({f"extra{k}.npy": entries[one] for k in range(500)}),
    ]
    choices[int(rng.integers(len(choices)))]()
    return zip_bytes(entries)


def npz_entry_damaged(contents: bytes, rng) -> bytes:
    """The bytes of an array damaged blindly, under a checksum that fits."""
    entries = _entries(contents)
    name = str(rng.choice(list(entries)))
    entries[name] = (
        _flipped(entries[name][:128], rng) + entries[name][128:] if rng.random() < 0.5 else blind(entries[name], rng)
    )
    return zip_bytes(entries)


def npz_header_claims(contents: bytes, rng) -> bytes:
    """A header that claims another shape, type, order, length or version of the format."""
    entries = _entries(contents)
    name = str(rng.choice(list(entries)))
    entries[name] = _claiming(entries[name], rng)
    return zip_bytes(entries)


def _claiming(entry: bytes, rng) -> bytes:
    length = int.from_bytes(entry[8:10], "little")
    header, data = entry[10 : 10 + length].decode(), entry[10 + length :]
    parsed = np.lib.format.read_array_header_1_0(io.BytesIO(entry[8:]))
    shapes = [
        "(10**12,)",
        "(1000000000000, 3)",
        "(-1,)",
        "(0,)",
        "()",
        "(4611686018427387904, 4)",
        "(True,)",
        "(3.0,)",
        "[3, 2]",
    ]
    shapes += [
        "(" * 300 + ")" * 300,
        "(1,) * 10**9",
        "None",
        "(" + "1, " * 70 + ")",
        "(" + "0, " * 33 + ")",
        str(parsed[0][::-1]),
    ]
    types = [
        "'|O'",
        "'<f4'",
        "'>f8'",
        "'<i8'",
        "'<U4000000000'",
        "'|V0'",
        "'<U0'",
        "'|S1'",
        "'<M8[s]'",
        "'<c16'",
        "'<f16'",
        "'x'",
    ]
    types += [
        "[('a', '<f8')]",
        "[('', '|O')]",
        "('<f8', (2,))",
        "('<f8', (0,))",
        "[('a', '<f8', (1000000000,))]",
        "{}",
        "7",
        "'" + "f" * 9000 + "'",
    ]
    choices = [
        lambda: header.replace(str(parsed[0]), str(rng.choice(shapes))),
        lambda: header.replace(repr(parsed[2].str), str(rng.choice(types))),
        lambda: header.replace("False", "True"),
        lambda: header.replace("False", str(rng.choice(["1", "None", "'no'", "[]"]))),
        lambda: str(
            rng.choice(
                [
                    "{}",
                    "",
                    "\n",
                    "import os",
                    "{'descr': }",
                    "[" * 5000,
                    "{" * 90,
                    "(" * 2000 + ")" * 2000,
                    "-" * 9000 + "1",
                ]
            )
        ),
        lambda: "".join(rng.permutation(list(header))),
        lambda: header.replace("'shape'", "'Shape'"),
        lambda: header + " " * int(rng.choice([1, 20_000, 60_000])),
        lambda: header.replace("}", "'x': 1, }"),
    ]
    header = choices[int(rng.integers(len(choices)))]().encode("latin-1")[:65_535]
    version = [(1, 0)] * 8 + [(2, 0), (3, 0), (9, 9), (0, 0)]
    major, minor = version[int(rng.integers(len(version)))]
    size = struct.pack("<H" if major < 2 else "<I", len(header))
    return b"\x93NUMPY" + bytes([major, minor]) + size + header + data


def npz_other_archive(contents: bytes, rng) -> bytes:
    """Another compression, encryption, wrong sizes and offsets in the directory, comments, archives in archives."""
    choices = [
        lambda: zip_bytes(_entries(contents), int(rng.choice([zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA]))),
        lambda: _flipped(zip_bytes(_entries(contents), int(rng.choice([zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA]))), rng),
        lambda: _poked(contents, b"PK\x01\x02", int(rng.choice([6, 8, 10, 16, 20, 24, 28, 30, 32, 34, 42])), rng),
        lambda: _poked(contents, b"PK\x03\x04", int(rng.choice([4, 6, 8, 14, 18, 22, 26, 28])), rng),
        lambda: _poked(contents, b"PK\x05\x06", int(rng.choice([4, 8, 10, 12, 16, 20])), rng),
        lambda: zip_bytes({"log.npz": contents}),
        lambda: contents + b"PK\x05\x06" + rng.bytes(18),
        lambda: rng.bytes(50) + contents,
    ]
    return choices[int(rng.integers(len(choices)))]()


def _poked(contents: bytes, mark: bytes, offset: int, rng) -> bytes:
    """Two or four bytes behind one of the archive's marks replaced."""
    places = [k for k in range(len(contents)) if contents.startswith(mark, k)]
    if not places:
        return contents[:-1]
    at = int(rng.choice(places)) + offset
    number = int(rng.choice([0, 1, 12, 14, 93, 99, 0xFFFF, 0x7FFFFFFF, 0xFFFFFFFF, 10**8, 2**28]))
    new = struct.pack("<I", number)[: int(rng.choice([2, 4]))]
    return contents[:at] + new + contents[at + len(new) :]


def npz_bomb(contents: bytes, rng) -> bytes:
    """A few kilobytes that unpack to hundreds of megabytes: in one field, or a little in every field."""
    entries = _entries(contents)
    names = list(entries) if rng.random() < 0.3 else [str(rng.choice(list(entries)))]
    bombs = {}
    for name in names:
        columns = rng.choice(["", "3,", "2,"])
        # Anything below 64 MB might be the log of a robot that stood still for long.
        size = 8 * int(rng.choice([100_000, 10_000_000, 20_000_000])) // (1 if rng.random() < 0.5 else len(names))
        count = size // 8 // (int(columns[0]) if columns else 1)
        kind = str(rng.choice(["<f8", "<i8"]))
        header = f"{{'descr': '{kind}', 'fortran_order': False, 'shape': ({count}, {columns}), }}".encode()
        bombs[name] = b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header, size
    packed = _bombs_in_zip(entries, bombs)
    if rng.random() < 0.5:  # the directory claims less, or more
        return packed
    return _poked(packed, b"PK\x01\x02", 24, rng)


def _bombs_in_zip(entries: dict, bombs: dict) -> bytes:
    """An archive in which some entries are a head and so many zeros: name -> (head, number of zeros)."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, contents in entries.items():
            entry = zipfile.ZipInfo(name)
            if name not in bombs:
                archive.writestr(entry, contents, zipfile.ZIP_DEFLATED)
                continue
            packed, crc, size = _deflated(*bombs[name])
            archive.writestr(entry, packed, zipfile.ZIP_STORED)
            # It is not stored but packed already: the directory, and the header before the entry, must say so.
            entry.compress_type, entry.CRC, entry.file_size = zipfile.ZIP_DEFLATED, crc, size
            stream.seek(entry.header_offset)
            stream.write(entry.FileHeader(zip64=False))
    return stream.getvalue()


def _deflated(head: bytes, zeros: int, unit: bytes = bytes(8), check=zlib.crc32) -> tuple[bytes, int, int]:
    """A head and so many bytes of a repeated unit: the raw deflated stream, checksum and unpacked size.

    A packer that forgets what went before packs a megabyte to the same bytes each time, so one is packed for all.
    """
    packer = zlib.compressobj(wbits=-15)
    megabyte = unit * (2**20 // len(unit))
    times, rest = divmod(zeros, len(megabyte))
    pieces = [packer.compress(head) + packer.flush(zlib.Z_FULL_FLUSH)]
    pieces += [packer.compress(megabyte) + packer.flush(zlib.Z_FULL_FLUSH)] * times
    pieces += [packer.compress(megabyte[:rest]) + packer.flush()]
    checksum = check(head)
    for _ in range(times):
        checksum = check(megabyte, checksum)
    return b"".join(pieces), check(megabyte[:rest], checksum), len(head) + zeros


def _entries(contents: bytes) -> dict:
    with zipfile.ZipFile(io.BytesIO(contents)) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def _arrays(contents: bytes) -> dict:
    with np.load(io.BytesIO(contents)) as archive:
        return {name: archive[name] for name in archive.files}


# ---- .mat ----


def mat_wrong_variable(contents: bytes, rng) -> bytes:
    """A variable, or a field of a structure, with another type, shape, kind or other numbers."""
    variables = _variables(contents)
    name = str(rng.choice(list(variables)))
    variables[name] = _broken(variables[name], rng)
    return mat_bytes(variables, bool(rng.integers(2)))


def _broken(value, rng):
    """The same value, broken somewhere inside; structures are descended into."""
    value = np.asarray(value)
    if value.dtype.names and value.size and rng.random() < 0.9:
        value = value.copy()
        row, field = int(rng.integers(value.size)), str(rng.choice(value.dtype.names))
        value.ravel()[row][field] = _broken(value.ravel()[row][field], rng)
        return value
    choices = [lambda: nasty_array(value, rng)] * 8 + [
        lambda: {"a": value},
        lambda: {},
        lambda: "text",
        lambda: np.array([value, "x"], object),
        lambda: np.zeros((0, 0)),
        lambda: scipy.sparse.csc_array(np.eye(3)),
        lambda: functools.reduce(lambda inner, _: {"a": inner}, range(12), 1.0),
    ]
    return nasty_array(np.zeros((2, 2)), rng) if value.dtype.names else choices[int(rng.integers(len(choices)))]()


def mat_variables_moved(contents: bytes, rng) -> bytes:
    """A variable or field lost, renamed or twice there; structures lost, repeated or very many."""
    variables = _variables(contents)
    name = str(rng.choice(list(variables)))
    value = variables[name]
    fields = value.dtype.names or ()
    kept = [field for field in fields if rng.random() < 0.6] or list(fields)
    choices = [
        lambda: variables.pop(name),
        lambda: variables.update(
            {str(rng.choice(["x", name.upper(), "stata_frames", "lm_edge"])): variables.pop(name)}
        ),
        lambda: variables.update({name: repack_fields(value[kept]) if fields else value.T}),
        lambda: variables.update({name: value[:, :0] if value.ndim > 1 else value}),
        lambda: variables.update({name: np.concatenate([value, value], axis=-1)}),
        lambda: variables.update({name: np.tile(value[:, :1], (1, 500)) if value.ndim > 1 else value}),
        lambda: variables.update({name: value.reshape(-1, 1)}),
        lambda: variables.update({"stata_frames": 1.0}),
    ]
    choices[int(rng.integers(len(choices)))]()
    return mat_bytes(variables, bool(rng.integers(2)))


def mat_element_damaged(contents: bytes, rng) -> bytes:
    """The bytes of a variable damaged blindly, and packed again with checksum and length that fit."""
    elements = _elements(contents)
    chosen = int(rng.integers(len(elements)))
    elements[chosen] = blind(elements[chosen], rng) if rng.random() < 0.3 else _flipped(elements[chosen], rng)
    return _packed(contents, elements, rng)


def mat_word_poked(contents: bytes, rng) -> bytes:
    """One of the words of a variable, a type, a length, a flag or a count, replaced by a nasty one."""
    elements = _elements(contents)
    chosen = int(rng.integers(len(elements)))
    # The first words are the ones that matter: most of the others are somebody's digits.
    element = elements[chosen]
    at = 4 * int(rng.integers(min(len(element) // 4, int(rng.choice([14, 60, 10**9])))))
    nasty = [
        0,
        1,
        2,
        5,
        6,
        7,
        8,
        9,
        14,
        15,
        16,
        17,
        255,
        0x806,
        0x40009,
        0x7FFFFFFF,
        0x80000000,
        0xFFFFFFFF,
        10**6,
        2**28,
    ]
    elements[chosen] = element[:at] + struct.pack("<I", int(rng.choice(nasty))) + element[at + 4 :]
    return _packed(contents, elements, rng)


def mat_bomb(contents: bytes, rng) -> bytes:
    """A few kilobytes that unpack to hundreds of megabytes, or to a great number of structures."""
    size = 24 * int(rng.choice([20_000, 300_000, 1_000_000, 10_000_000]))
    names = list(_variables(contents))
    name = str(rng.choice(names)).encode()
    kind, matlab_class = [(9, 6), (2, 9), (5, 12), (14, 2)][int(rng.integers(4))]
    head = struct.pack("<IIII", 6, 8, matlab_class, 0)
    shape = [(size // (8 if kind == 9 else 4 if kind == 5 else 1) // 3, 3), (1, size // 16)][matlab_class == 2]
    head += struct.pack("<IIii", 5, 8, *shape) + struct.pack("<II", 1, len(name)) + name + b"\0" * (-len(name) % 8)
    unit = bytes(8)
    if matlab_class == 2:
        head += struct.pack("<HHi", 5, 4, 8) + struct.pack("<II", 1, 16) + b"T".ljust(8, b"\0") + b"objects\0"
        unit = struct.pack("<II", 14, 0)
    else:
        head += struct.pack("<II", kind, size)
    head = struct.pack("<II", 14, len(head) + size) + head
    packed, checksum, _ = _deflated(head, size, unit, zlib.adler32)
    packed = b"\x78\x9c" + packed + struct.pack(">I", checksum)
    return contents[:128] + struct.pack("<II", 15, len(packed)) + packed


@functools.lru_cache(maxsize=8)
def _loaded(contents: bytes) -> dict:
    variables = scipy.io.loadmat(io.BytesIO(contents))
    return {name: value for name, value in variables.items() if not name.startswith("__")}


def _variables(contents: bytes) -> dict:
    return dict(_loaded(contents))


def _elements(contents: bytes) -> list:
    """The unpacked elements of an intact file, each with its tag."""
    elements, at = [], 128
    while at < len(contents):
        kind, size = struct.unpack_from("<II", contents, at)
        element = contents[at : at + 8 + size]
        elements.append(zlib.decompress(element[8:]) if kind == 15 else element)
        at += 8 + size
    return elements


def _packed(contents: bytes, elements: list, rng) -> bytes:
    packed = []
    for element in elements:
        if rng.random() < 0.5:
            data = zlib.compress(element)
            element = struct.pack("<II", 15, len(data)) + data
        packed.append(element)
    return contents[:128] + b"".join(packed)


DEEP = {
    "g2o": (
        nasty_word,
        wrong_number_of_words,
        lines_moved,
        ids_changed,
        numbers_scaled,
        numbers_scaled,
        odd_text,
        too_many,
    ),
    "npz": (
        npz_wrong_field,
        npz_wrong_field,
        npz_wrong_field,
        npz_fields_moved,
        npz_entry_damaged,
        npz_header_claims,
        npz_header_claims,
        npz_other_archive,
    ),
    "mat": (
        mat_wrong_variable,
        mat_wrong_variable,
        mat_variables_moved,
        mat_element_damaged,
        mat_word_poked,
        mat_word_poked,
    ),
}
BOMBS = {"npz": npz_bomb, "mat": mat_bomb}
