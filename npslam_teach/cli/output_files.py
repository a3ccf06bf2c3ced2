"""Where results go: bad names are refused before any work is done, and nothing is replaced without a word."""

import argparse
import json
import warnings
from collections.abc import Callable
from pathlib import Path


class Once(argparse.Action):
    """An option that is refused when it is given a second time; the first one would silently be forgotten."""

    def __call__(self, parser, namespace, values, option_string=None):
        """Keep the value, or end with one sentence."""
        given = vars(namespace).setdefault("given_once", set())
        if self.dest in given:
            parser.error(f"{option_string}: expected once, got {getattr(namespace, self.dest)} and {values}")
        given.add(self.dest)
        setattr(namespace, self.dest, values)


def announce(name: str | None, option: str = "--out") -> None:
    """Warn where a file will be replaced."""
    if name is not None and name.strip() and Path(name).is_file():
        warnings.warn(f"{option} {name}: replaces the file that is there", stacklevel=2)


def folder_named(name: str | None, is_new: bool = False) -> Path | None:
    """The folder to write into; it is made only when there is something to write.

    Args:
        name: as it was given, if it was.
        is_new: whether whoever writes into it replaces nothing; else it is said that pictures may be replaced.
    """
    if name is None:
        return None
    if not name.strip() or (Path(name).exists() and not Path(name).is_dir()):
        raise ValueError(f"expected the name of a folder to draw into, got {name!r}")
    if not is_new and Path(name).is_dir() and any(Path(name).iterdir()):
        warnings.warn(f"{name}: the folder is not empty; pictures of the same names are replaced", stacklevel=2)
    return Path(name)


def require_names(names: list[str], suffixes: tuple) -> None:
    """Raise a sentence about the first name that nothing can be written to."""
    for out in names:
        suffix = Path(out).suffix.lower()
        if suffix not in suffixes:
            raise ValueError(f"--out {out}: expected a name that ends in {' or '.join(suffixes)}, got {suffix!r}")
        if not Path(out).absolute().parent.is_dir():
            raise FileNotFoundError(f"--out {out}: expected a folder to write into, found none")
        if sum(Path(out).resolve() == Path(other).resolve() for other in names) > 1:
            raise ValueError(f"--out {out}: expected every file once, got it twice")


def writer(names: list[str], suffixes: tuple) -> Callable:
    """A function that writes the result where ``--out`` says; a bad name is refused before any work is done."""
    require_names(names, suffixes)
    for out in names:
        announce(out)

    def write(result: dict, graph, run=None) -> None:
        for out in names:
            _write(out, result, graph, run)

    return write


def _write(out: str, result: dict, graph, run) -> None:
    from npslam_teach import datasets
    from npslam_teach.cli import reports
    from npslam_teach.system import files

    suffix = Path(out).suffix.lower()
    if suffix == ".g2o":
        datasets.save_g2o(out, graph)
    elif suffix == ".tum":
        datasets.save_tum(out, graph.poses)
    elif suffix == ".csv":
        datasets.save_objects(out, run.snapshots[-1], run.log)
    else:
        with files.atomic_write(out) as stream:
            stream.write(json.dumps(reports.plain(result), allow_nan=False))
