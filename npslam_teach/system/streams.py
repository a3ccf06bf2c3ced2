"""Standard input, output and error, all three there whatever the caller has closed (Stevens, APUE, section 13.3).

A closed one is None in Python, and its descriptor would go to the first file that is opened: a print would land in it.
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
