"""What long work shows while it goes on: one bar on a terminal, and nothing anywhere else."""

import contextlib
from collections.abc import Iterable, Iterator
from contextvars import ContextVar

DELAY = 2  # s; shorter work shows nothing
_wanted = ContextVar("wanted", default=False)


@contextlib.contextmanager
def progress_shown() -> Iterator[None]:
    """Whatever is tracked inside shows a bar; a library that is called from elsewhere stays silent."""
    token = _wanted.set(True)
    try:
        yield
    finally:
        _wanted.reset(token)


def track(steps: Iterable, total: int | None, what: str, unit: str) -> Iterator:
    """The steps one by one, counted by a bar where one is wanted and standard error is a terminal.

    Of loops inside each other the outermost has the bar, unless it has a single step, which would tell nothing.

    Args:
        steps: what takes the time.
        total: how many there are; None: nobody knows.
        what: is done.
        unit: a step, in one word.
    """
    if total == 1 or not _wanted.get():
        yield from steps
        return
    from tqdm import tqdm

    token = _wanted.set(False)
    try:
        yield from tqdm(steps, desc=what, total=total, unit=f" {unit}", delay=DELAY, leave=False, disable=None)
    finally:
        _wanted.reset(token)
