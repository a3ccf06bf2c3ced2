"""What a set-up needs first: a lock that ends with the last process that holds it, and messages to the user.

This file parses on Python 3.6, as ``environment`` does.
"""

import contextlib
import os
import sys
import time
from collections.abc import Iterator
from pathlib import Path

PACKAGE = "npslam_teach"


@contextlib.contextmanager
def hold_lock(path: Path) -> "Iterator[int]":
    """Hold a lock that ends with the last process that holds it; yield the descriptor of its file."""
    with path.open("a") as file:
        if not _try_lock(file.fileno()):
            say("another set-up is running in this folder; waiting for it.")
            while not _try_lock(file.fileno()):
                time.sleep(0.2)
        yield file.fileno()


@contextlib.contextmanager
def lock_or_raise(path: Path, sentence: str) -> "Iterator[None]":
    """Hold a lock as `hold_lock` does, or raise `ValueError` with this sentence; its file goes with it."""
    with path.open("a") as file:
        if not _try_lock(file.fileno()):
            raise ValueError(sentence)
        try:
            yield
        finally:
            with contextlib.suppress(OSError):  # Windows keeps a file that is open
                path.unlink()


def _try_lock(descriptor: int) -> bool:
    try:
        if os.name == "nt":
            import msvcrt

            msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
        else:
            import fcntl

            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except (BlockingIOError, PermissionError):  # how POSIX and Windows report that it is held
        return False
    return True


def say(sentence: str) -> None:
    """One sentence on standard error."""
    sys.stderr.write(f"{PACKAGE}: {sentence}\n")
    sys.stderr.flush()
