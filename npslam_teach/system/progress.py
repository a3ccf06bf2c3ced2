"""Progress of long work: one bar on a terminal, and nothing anywhere else."""

import contextlib
from collections.abc import Iterable, Iterator
from contextvars import ContextVar

DELAY = 2  # s; shorter work shows nothing
_wanted = ContextVar("wanted", default=False)


@contextlib.contextmanager
def progress_shown() -> Iterator[None]:
    """Within this block tracked work shows a bar; outside of it the library stays silent."""
    token = _wanted.set(True)
    try:
        yield
    finally:
        _wanted.reset(token)


def track(steps: Iterable, total: int | None, what: str, unit: str) -> Iterator:
    """The steps one by one, counted by a bar where one is wanted and standard error is a terminal.

    Of nested loops the outermost has the bar, unless it has a single step.

    Args:
        steps: what takes the time.
        total: how many there are; None if that is not known.
        what: the name of the work, before the bar.
        unit: one word for a step.
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
