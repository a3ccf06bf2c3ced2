"""A JupyterLab as our command starts it, for the tests of the command and those in a browser."""

import contextlib
import os
import re
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

START_SECONDS, STOP_SECONDS = 120, 60


class RunningLab(NamedTuple):
    """The process, the address up to the port, the token that opens it, and the whole address that Jupyter prints."""

    process: subprocess.Popen
    site: str
    token: str
    address: str


@contextlib.contextmanager
def running_lab(folder: Path, log: Path, environment: dict[str, str]) -> Iterator[RunningLab]:
    """Start ``python -m npslam_teach lab`` on a free port; at the end it must stop when it is asked to.

    Args:
        folder: the course, or a copy of it.
        log: a file for everything that the process prints.
        environment: variables that differ from those of this process.
    """
    command = [sys.executable, "-m", "npslam_teach", "lab", "--no-browser", "--port", str(free_port())]
    variables = os.environ | {"PYTHONPATH": str(folder)} | environment
    # In a session of its own, so that Ctrl-C reaches only the tests, which then stop it.
    how = {"cwd": folder, "env": variables, "stdin": subprocess.DEVNULL, "start_new_session": True}
    with log.open("wb") as stream:
        process = subprocess.Popen(command, stdout=stream, stderr=stream, **how)
    try:
        yield RunningLab(process, *_address(process, log))
    finally:
        _stop(process, log)


def free_port() -> int:
    """A port of this machine that nobody listens on."""
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return listener.getsockname()[1]


def _address(process: subprocess.Popen, log: Path) -> tuple[str, str, str]:
    """Wait for the line in which Jupyter prints its address: up to the port, the token, and all of it."""
    end = time.monotonic() + START_SECONDS
    while time.monotonic() < end:
        found = re.search(r"(http://127\.0\.0\.1:(\d+))/lab\S*\?token=(\w+)", _text(log))
        if found and _listens(int(found[2])):  # Jupyter prints its address a moment before it does
            return found[1], found[3], found[0]
        assert process.poll() is None, f"lab ended: {_text(log)[-2000:]}"
        time.sleep(0.1)
    raise AssertionError(f"lab did not start within {START_SECONDS} s: {_text(log)[-2000:]}")


def _listens(port: int) -> bool:
    with socket.socket() as caller:
        return caller.connect_ex(("127.0.0.1", port)) == 0


def _stop(process: subprocess.Popen, log: Path) -> None:
    """Ask the server to end, which ends its kernels too; one that does not end is killed, and a failure."""
    process.terminate()
    try:
        process.wait(STOP_SECONDS)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait(10)
        raise AssertionError(f"lab did not shut down: {_text(log)[-2000:]}") from None


def _text(log: Path) -> str:
    return log.read_text(encoding="utf-8", errors="replace")
