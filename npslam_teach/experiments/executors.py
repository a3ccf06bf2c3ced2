"""Who computes a sweep: the processors of this machine, or a Dask cluster. Both are ``concurrent.futures`` executors.

Each is a context. Left early, by Ctrl-C or an error, it takes its work back at once.
"""

import contextlib
import multiprocessing
import os
import signal
import threading
from collections.abc import Iterator
from concurrent.futures import Executor, ProcessPoolExecutor

from npslam_teach.system import interruption

# One thread for each worker: as many workers as processors are faster than threads, and give the same last digits.
_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")
_SECONDS_TO_ANSWER = 10


class _Pool(ProcessPoolExecutor):
    """Processes whose whole life is deaf to Ctrl-C, which a terminal sends to them too: their parent ends them."""

    def submit(self, *arguments, **more):
        if not hasattr(signal, "pthread_sigmask"):  # Windows
            return super().submit(*arguments, **more)
        before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})  # which a new process inherits
        try:
            return super().submit(*arguments, **more)
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextlib.contextmanager
def local_pool(workers: int | None = None) -> Iterator[Executor]:
    """Processes on this machine.

    Args:
        workers: how many; None: one for each processor that this process may use.
    """
    if workers is None:
        workers = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    others = set(multiprocessing.active_children())
    context = multiprocessing.get_context("spawn")  # the only way that works everywhere, and beside threads
    with _environment(dict.fromkeys(_THREADS, "1")):
        pool = _Pool(workers, mp_context=context, initializer=_live_with_the_parent)
        try:
            yield pool
        except BaseException:
            for process in set(multiprocessing.active_children()) - others:
                process.kill()
            raise
        finally:
            pool.shutdown(cancel_futures=True)


def _live_with_the_parent() -> None:
    """In a worker: hear no Ctrl-C, and end with the process that began the sweep, even if that is killed."""
    interruption.ignore()

    def end_with_it() -> None:
        multiprocessing.parent_process().join()
        os._exit(1)

    threading.Thread(target=end_with_it, daemon=True).start()


@contextlib.contextmanager
def dask_pool(address: str) -> Iterator[Executor]:
    """The workers of a Dask cluster; the scheduler gives the work of a worker that died to another one.

    Args:
        address: of the scheduler, tcp://HOST:8786.

    Raises:
        ValueError: Dask is not installed, or nobody answers.
    """
    try:
        from distributed import Client, KilledWorker
    except ImportError:
        raise ValueError("dask: expected the package distributed; pip install 'npslam_teach[cluster]'") from None
    try:
        client = Client(address, timeout=_SECONDS_TO_ANSWER, set_as_default=False)
    except (OSError, ValueError) as error:
        raise ValueError(f"dask: expected a scheduler at {address}, got {error or 'no answer'}") from None
    executor = client.get_executor()
    try:
        yield executor
    except KilledWorker as error:
        raise ValueError(f"workers: expected one that survives {error.task}, got several that died") from None
    finally:
        executor.shutdown(wait=False)
        client.close()


@contextlib.contextmanager
def _environment(changes: dict[str, str]) -> Iterator[None]:
    """Environment variables for the processes that are started within this block."""
    before = {name: os.environ.get(name) for name in changes}
    os.environ.update(changes)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value
