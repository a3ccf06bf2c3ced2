"""Ctrl-C: the process ends at once with one line and exit code 130, and no half-written file stays behind.

Python answers Ctrl-C with an exception wherever it happens to be. In the middle of an import that becomes a traceback
of forty lines or an ImportError, and in a destructor it is swallowed. So our process ends inside the signal handler,
except where something has to be cleaned up: those places are marked by `critical_section` and get the exception.

Like everything that runs before the environment is found, this file must parse on Python 3.6.
"""

import contextlib
import os
import signal
import sys

EXIT_CODE = 130
_open_sections = 0


def end_at_once() -> None:
    """From now on Ctrl-C ends this process. For the command line; a notebook's kernel must survive Ctrl-C."""
    signal.signal(signal.SIGINT, _answer)


def ignore() -> None:
    """Ignore Ctrl-C from now on: the work is done, and the interpreter closes down with the exit code of the work."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


@contextlib.contextmanager
def critical_section():
    """Within this block Ctrl-C raises KeyboardInterrupt, so that what was begun can be cleaned up."""
    global _open_sections
    _open_sections += 1
    try:
        yield
    finally:
        _open_sections -= 1


def print_interrupted() -> None:
    """Write the one line directly to the descriptor: the interrupted code may be in the middle of a print."""
    # A terminal shows ^C and perhaps a progress bar on the present line.
    line = ("\n" if sys.stderr.isatty() else "") + "npslam_teach: interrupted\n"
    with contextlib.suppress(OSError):
        os.write(2, line.encode())


def _answer(signal_number, frame):
    ignore()  # a second Ctrl-C must not interrupt the cleaning up
    if _open_sections:
        raise KeyboardInterrupt
    print_interrupted()
    os._exit(EXIT_CODE)
