"""Kernels that are copies of a process which has imported what lessons import from others, but nothing of ours.

These imports take as long as many a lesson. A kernel with an environment of its own, or of another interpreter, starts
as ever, and so does every one where processes cannot be copied.
"""

import atexit
import contextlib
import gc
import importlib
import json
import os
import runpy
import select
import signal
import subprocess
import sys
from pathlib import Path

from jupyter_client.provisioning import local_provisioner

# pyplot is not among them: it asks at its import whether it is in a kernel.
IMPORTED = (
    "ipykernel.kernelapp ipykernel.ipkernel ipywidgets anywidget numpy scipy.sparse.linalg scipy.spatial scipy.special "
    "matplotlib.figure matplotlib.backends.backend_agg matplotlib.tri PIL.PngImagePlugin"
).split()
OF_ONE_KERNEL = ("JPY_", "PYTEST_CURRENT_TEST")
LAUNCHER = [sys.executable, "-m", "ipykernel_launcher"]


def fork_kernels() -> None:
    """Let all kernels that this process starts from now on be copies of a single process."""
    if hasattr(os, "pidfd_open"):
        local_provisioner.launch_kernel = _Original(local_provisioner.launch_kernel)


class _Original:
    """Starts a kernel as Jupyter's ``launch_kernel`` does, by the process to copy where that is possible."""

    def __init__(self, launch):
        self._launch, self._process, self._environment = launch, None, None

    def __call__(self, cmd: list[str], env: dict | None = None, cwd: str | None = None, **how):
        env = dict(os.environ) if env is None else env
        if self._process is None:
            self._start(env)
        if list(cmd[:3]) != LAUNCHER or _shared(env) != self._environment:
            return self._launch(cmd, env=env, cwd=cwd, **how)
        asked = {"argv": cmd[2:], "cwd": cwd or os.getcwd(), "env": env}
        self._process.stdin.write(json.dumps(asked).encode() + b"\n")
        self._process.stdin.flush()
        return Copy(int(self._process.stdout.readline()))

    def _start(self, env: dict) -> None:
        self._environment = _shared(env)
        how = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "start_new_session": True}
        code = f"import runpy; runpy.run_path({str(Path(__file__))!r}, run_name='__main__')"
        self._process = subprocess.Popen([sys.executable, "-c", code], env=env, **how)
        atexit.register(self._stop)

    def _stop(self) -> None:
        self._process.stdin.close()
        self._process.wait()
        self._process.stdout.close()


def _shared(env: dict) -> dict:
    return {name: value for name, value in env.items() if not name.startswith(OF_ONE_KERNEL)}


class Copy:
    """What a ``subprocess.Popen`` is to Jupyter, of a process that is somebody else's child."""

    stdin = stdout = stderr = None

    def __init__(self, pid: int):
        self.pid, self._end = pid, os.pidfd_open(pid)

    def poll(self) -> int | None:
        """None while it runs; how it ended, only its parent knows."""
        return 0 if select.select([self._end], [], [], 0)[0] else None

    def wait(self) -> int:
        """Until it has ended."""
        select.select([self._end], [], [])
        return 0

    def send_signal(self, number: int) -> None:
        """To a process that may have ended already."""
        with contextlib.suppress(ProcessLookupError):
            signal.pidfd_send_signal(self._end, number)

    def terminate(self) -> None:
        self.send_signal(signal.SIGTERM)

    def kill(self) -> None:
        self.send_signal(signal.SIGKILL)

    def __del__(self):
        os.close(self._end)


def serve() -> None:
    """Import, then become a kernel in a copy for every line of standard input; the number of the copy is the answer."""
    os.environ["JPY_PARENT_PID"] = str(os.getpid())  # read at the import: a copy ends when this process has ended
    os.environ.setdefault("MPLBACKEND", "module://matplotlib_inline.backend_inline")  # as a kernel does, before
    for name in IMPORTED:
        importlib.import_module(name)
    gc.freeze()  # what is imported stays
    gc.set_threshold(50_000)  # as that of the tests themselves
    signal.signal(signal.SIGCHLD, lambda *_: _bury())
    for line in sys.stdin:
        if os.fork() == 0:
            signal.signal(signal.SIGCHLD, signal.SIG_DFL)
            become_a_kernel(**json.loads(line))


def _bury() -> None:
    """Let copies that have ended go."""
    with contextlib.suppress(ChildProcessError):
        while os.waitpid(-1, os.WNOHANG)[0]:
            pass


def become_a_kernel(argv: list[str], cwd: str, env: dict) -> None:
    """All that an interpreter of its own would do."""
    os.setsid()  # before anybody asks for its group
    print(os.getpid(), flush=True)
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    os.dup2(2, 1)
    os.chdir(cwd)
    os.environ.clear()
    os.environ.update(env)
    sys.argv = argv
    sys.path.insert(0, "")
    runpy.run_module("ipykernel_launcher", run_name="__main__", alter_sys=True)
    os._exit(0)


if __name__ == "__main__":
    serve()
