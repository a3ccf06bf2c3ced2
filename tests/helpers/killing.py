"""Work that kills the process that does it, as a machine without memory does; it must be a module, to be pickled."""

import os
import signal
from pathlib import Path

from npslam_teach.experiments import sweep

FILE = "NPSLAM_TEACH_TEST_HAS_DIED"  # names the file that the first to die leaves


def die(point):
    """End this process without a word."""
    os.kill(os.getpid(), getattr(signal, "SIGKILL", signal.SIGTERM))


def die_once(point):
    """The row of a point, except in the first process that asks: it dies."""
    try:
        Path(os.environ[FILE]).touch(exist_ok=False)
    except FileExistsError:
        return sweep.run_point(point)
    return die(point)
