"""Files are read whole and replaced atomically, with errors of one sentence."""

import os
import secrets
import stat
from contextlib import contextmanager
from pathlib import Path

from npslam_teach.system.interruption import critical_section

MAX_BYTES = 1 << 27  # of a file to read, four times the size of the largest graph of 100,000 poses


@contextmanager
def prefix_errors(where):
    """Prefix the ``ValueError`` of a check with the file (and line) that it is about."""
    try:
        yield
    except ValueError as error:
        raise ValueError(f"{where}: {error}") from None


def shorten(value, length: int = 60) -> str:
    """``repr(value)`` on one line, cut to ``length`` characters, so that an error stays one sentence."""
    text = " ".join(repr(value).split())
    return text if len(text) <= length else text[: length - 3] + "..."


def _file_type(path: Path) -> int:
    """``st_mode`` of what ``path`` names, 0 if nothing is there."""
    try:
        return path.stat().st_mode
    except FileNotFoundError:
        return 0
    except (OSError, ValueError) as error:
        raise ValueError(f"{path}: expected the name of a file, got {_reason(error)}") from None


def _reason(error: Exception) -> str:
    return (getattr(error, "strerror", None) or str(error)).lower()


def read_bytes(path) -> bytes:
    """The contents of a regular file.

    Raises:
        FileNotFoundError: nothing is there.
        ValueError: it is a folder or a device, it cannot be read, it is empty or larger than ``MAX_BYTES``.
    """
    path = Path(path)
    mode = _file_type(path)
    if not mode:
        raise FileNotFoundError(f"{path}: expected a file, found nothing of that name")
    if not stat.S_ISREG(mode):
        kind = "a folder" if stat.S_ISDIR(mode) else "a device or pipe"
        raise ValueError(f"{path}: expected a file, got {kind}")
    try:
        size = path.stat().st_size
        data = b"" if size > MAX_BYTES else path.read_bytes()
    except OSError as error:
        raise ValueError(f"{path}: expected a readable file, got {_reason(error)}") from None
    if size > MAX_BYTES:
        raise ValueError(f"{path}: expected at most {MAX_BYTES} bytes, got {size}")
    if not data:
        raise ValueError(f"{path}: expected a file with contents, got an empty one")
    return data


@contextmanager
def atomic_write(path, mode: str = "w"):
    """Open a file for writing; it appears under its name only when all of it has been written.

    The bytes go to a temporary name in the same folder, which then replaces ``path`` in one step. When the
    body raises, the temporary file is removed and a file that was at ``path`` before is untouched. A symbolic
    link stays one: the file that it points to is replaced.

    Args:
        path: the file to make or to replace.
        mode: "w" for text (UTF-8, lines end in one newline character on every system) or "wb" for bytes.

    Raises:
        FileNotFoundError: its folder does not exist.
        ValueError: ``path`` names something other than a regular file, or the file cannot be written.
    """
    if mode not in ("w", "wb"):
        raise ValueError(f"mode: expected 'w' or 'wb', got {mode!r}")
    target = _checked_target(Path(path))
    temporary = target.with_name(f".tmp-{secrets.token_hex(8)}")
    text = {} if mode == "wb" else {"encoding": "utf-8", "newline": "\n"}
    try:
        with critical_section():
            try:
                with open(temporary, mode.replace("w", "x"), **text) as stream:
                    yield stream
                os.replace(temporary, target)
            finally:
                temporary.unlink(missing_ok=True)
    except OSError as error:
        # The error of a full disk names no file; one that names the temporary file comes from opening or replacing
        # it. Any other error was raised by the body about something else, and passes unchanged.
        if error.filename in (None, str(temporary), temporary):
            raise ValueError(f"{path}: expected a place to write, got {_reason(error)}") from None
        raise


def _checked_target(path: Path) -> Path:
    """The file that ``path`` names once links are followed, in a folder that exists."""
    mode = _file_type(path)
    # /dev/null, for example, must not be replaced by a file.
    if mode and not stat.S_ISREG(mode):
        kind = "a folder" if stat.S_ISDIR(mode) else "a device or pipe"
        raise ValueError(f"{path}: expected the name of a file to write, got {kind}")
    target = Path(os.path.realpath(path))
    if not target.parent.is_dir():
        raise FileNotFoundError(f"{path}: expected a folder to write into, found no folder {target.parent}")
    return target
