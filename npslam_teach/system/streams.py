"""Standard input, output and error, opened again if the caller has closed them (Stevens, APUE, section 13.3).

A closed stream is None in Python, and the next file that is opened gets its descriptor: a print could end up in it.
This file parses on Python 3.6, as ``environment`` does.
"""

import os
import sys


def open_standard_streams() -> None:
    """Give every standard stream that is closed the null device."""
    for descriptor, name, mode in ((0, "stdin", "r"), (1, "stdout", "w"), (2, "stderr", "w")):
        try:
            os.fstat(descriptor)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the lowest descriptor that is free: this one
        if getattr(sys, name) is None:
            setattr(sys, name, open(descriptor, mode, closefd=False))
