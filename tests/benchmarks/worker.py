"""One solver in a process of its own: it is told problems on standard input and answers with seconds.

``python worker.py SOLVER`` reads lines ``PROBLEM.npz TOLERANCE RESULT.npz``, solves from arrays to arrays, writes the
solution, and prints one JSON object for each: seconds, iterations, peak memory, and what the solver says afterwards.
"""

import gc
import importlib
import json
import os
import sys
import time
from pathlib import Path

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "TBB_NUM_THREADS", "VECLIB_MAXIMUM_THREADS"):
    os.environ[name] = "1"
if hasattr(os, "sched_setaffinity"):  # gtsam asks nobody how many threads it may use
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})

import numpy as np  # noqa: E402

HERE = Path(__file__).parent


def load_solver(name):
    """The function of a solver's name: ``ours-qdldl``, ``ours-superlu``, or the module of a peer."""
    sys.path[:0] = [str(HERE), str(HERE.parent.parent)]
    if name.startswith("ours-"):
        from solvers import ours

        return ours.solve_with(name.removeprefix("ours-")), ours.RESIDUAL
    module = importlib.import_module(f"solvers.{name}")
    return module.solve, module.RESIDUAL


def peak_memory():
    """The most memory this process has held so far, MB; None where the system does not say."""
    status = Path("/proc/self/status")
    if status.exists():  # Linux; there, getrusage counts what the parent held when it started this process
        (line,) = [line for line in status.read_text().splitlines() if line.startswith("VmHWM:")]
        return int(line.split()[1]) / 1024
    try:
        import resource
    except ImportError:
        return None
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / (1024 if sys.platform != "darwin" else 1024**2)


def main():
    """Answer one line after the other."""
    solve, residual = load_solver(sys.argv[1])
    print(json.dumps({"residual": residual, "memory_at_start": peak_memory()}), flush=True)
    for line in sys.stdin:
        problem_path, tolerance, result_path = line.rstrip("\n").split("\t")
        with np.load(problem_path) as arrays:
            problem = dict(arrays)
        gc.collect()
        begin = time.perf_counter()
        poses, landmarks, iterations, afterwards = solve(problem, float(tolerance))
        seconds = time.perf_counter() - begin
        np.savez(result_path, poses=poses, landmarks=landmarks)
        answer = {"seconds": seconds, "iterations": iterations, "memory": peak_memory()}
        print(json.dumps(answer | afterwards()), flush=True)


if __name__ == "__main__":
    main()
