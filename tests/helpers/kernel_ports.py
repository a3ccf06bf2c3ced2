"""Ports for the kernels of one worker alone.

Jupyter asks the system for a free port and gives it back before the kernel takes it. Meanwhile another worker, or a
browser, may be given the same one, and the kernel is waited for in vain.
"""

import itertools
import os
import socket

from jupyter_client.connect import LocalPortCache

FIRST, PER_WORKER = 20_000, 1_000  # below those that systems give out: 32768 and up on Linux, 49152 elsewhere


class OwnPorts(LocalPortCache):
    """Hands out the ports of this worker in turn."""

    def __init__(self, **settings):
        super().__init__(**settings)
        first = FIRST + PER_WORKER * int(os.environ.get("PYTEST_XDIST_WORKER", "gw0").removeprefix("gw"))
        self._ports = itertools.cycle(range(first, first + PER_WORKER))

    def find_available_port(self, ip: str) -> int:
        """The next port that nobody listens on."""
        for port in itertools.islice(self._ports, PER_WORKER):
            with socket.socket() as listener:
                try:
                    listener.bind((ip, port))
                except OSError:
                    continue
                return port
        raise OSError(f"no port is free from {FIRST} on")


def use_own_ports() -> None:
    """Let all kernels that this process starts have them; a singleton is that of its base class, too."""
    OwnPorts.instance()
