"""Ours beside its peers: interleaved runs, one thread each, medians and ratios.

``python3 -m npslam_teach bench`` runs this file. It installs nothing: a peer that is not there is left out, and the
table says so. See README.md in this folder.
"""

import argparse
import contextlib
import json
import os
import subprocess
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE), str(HERE.parent.parent)]

import problems  # noqa: E402
import report  # noqa: E402
from tqdm import tqdm  # noqa: E402

from npslam_teach import pose_graph  # noqa: E402
from npslam_teach.pose_graph import factorization  # noqa: E402
from npslam_teach.system import files  # noqa: E402
from npslam_teach.types import PoseGraph  # noqa: E402

MOST_POSES = {"python_graphslam": 2000}  # beyond it, one run takes minutes


class Worker:
    """A solver in a process of its own."""

    def __init__(self, python, solver):
        environment = os.environ | {"PYTHONPATH": str(HERE.parent.parent)}
        command = [python, str(HERE / "worker.py"), solver]
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
        self._process = subprocess.Popen(command, text=True, env=environment, **pipes)
        self.about = self._answer()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._process.stdin.close()
        self._process.terminate()
        self._process.wait()

    def solve(self, problem, tolerance, result):
        """Seconds, iterations and memory of one run; the solution goes into the file ``result``."""
        self._process.stdin.write(f"{problem}\t{tolerance}\t{result}\n")
        self._process.stdin.flush()
        return self._answer()

    def _answer(self):
        line = self._process.stdout.readline()
        if not line:
            raise RuntimeError(f"{self._process.args[-1]} stopped with exit code {self._process.wait()}")
        return json.loads(line)


def installed_solvers(g2o_python):
    """The interpreter for each solver that is there."""
    solvers = {"ours-qdldl": sys.executable} if factorization.has_qdldl() else {}
    solvers["ours-superlu"] = sys.executable
    for name, module in (("gtsam_python", "gtsam"), ("python_graphslam", "graphslam")):
        if find_spec(module):
            solvers[name] = sys.executable
    if g2o_python:
        solvers["g2o_python"] = g2o_python
    return solvers


def run_problem(name, graph, solvers, options, folder):
    """All solvers in turn, again and again: one row of the table for each."""
    path = folder / f"{name}.npz"
    problems.save(graph, path)
    solvers = {s: python for s, python in solvers.items() if len(graph.poses) <= MOST_POSES.get(s, np.inf)}
    answers = {solver: [] for solver in solvers}
    rows = []
    with contextlib.ExitStack() as stack:
        workers = {s: stack.enter_context(Worker(python, s)) for s, python in solvers.items()}
        for _ in tqdm(range(options.repeat + 1), desc=name, unit="round", leave=False):
            for solver, worker in workers.items():
                answers[solver].append(worker.solve(path, options.tolerance, folder / f"{solver}.npz"))
        for solver, worker in workers.items():
            with np.load(folder / f"{solver}.npz") as solution:
                found = PoseGraph(solution["poses"], solution["landmarks"], graph.between, graph.observations)
            counted = answers[solver][1:]  # the first round warms up
            rows.append(
                {
                    "problem": name,
                    "poses": len(graph.poses),
                    "landmarks": len(graph.landmarks),
                    "factors": len(graph.between.i) + len(graph.observations.pose),
                    "solver": solver,
                    "seconds": [answer["seconds"] for answer in counted],
                    "iterations": counted[-1]["iterations"],
                    "chi2": pose_graph.chi2(found),
                    "own_chi2": counted[-1]["own_chi2"],
                    "certificate": counted[-1].get("certificate_status"),
                    "certificate_seconds": [answer.get("certificate_seconds") for answer in counted],
                    "memory": counted[-1]["memory"] and counted[-1]["memory"] - worker.about["memory_at_start"],
                    "residual": worker.about["residual"],
                }
            )
    return rows


def run_method(num_rooms, repeat, library):
    """The whole method, in a process of its own."""
    command = [sys.executable, str(HERE / "method.py"), str(num_rooms), str(repeat), library]
    environment = os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    answer = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True, env=environment).stdout
    return {"rooms": num_rooms, "library": library} | json.loads(answer)


def parse(arguments):
    """What was asked for."""
    parser = argparse.ArgumentParser(prog="npslam_teach bench", description=__doc__.splitlines()[0])
    parser.add_argument("--repeat", type=int, default=7, metavar="N", help="counted rounds (default 7)")
    parser.add_argument("--tolerance", type=float, default=1e-5, help="relative decrease at which all stop (1e-5)")
    parser.add_argument("--rooms", default="1,10,100", metavar="A,B", help="sizes of the house (default 1,10,100)")
    parser.add_argument("--data", type=Path, metavar="DIR", help="has intel.g2o, manhattan.g2o and victoria_park.g2o")
    parser.add_argument("--g2o-python", metavar="FILE", help="interpreter of an environment with g2o-python")
    parser.add_argument(
        "--out", type=Path, default=HERE / "results", metavar="DIR", help="for the table and the figure"
    )
    options = parser.parse_args(arguments)
    options.data = options.data or os.environ.get("NPSLAM_TEACH_DATA")
    options.rooms = [int(rooms) for rooms in options.rooms.split(",")]
    if options.repeat < 1:
        parser.error(f"--repeat: expected a positive number, got {options.repeat}")
    return options


def graphs(options):
    """Names and graphs, the small ones first."""
    for name in problems.STANDARD:
        if options.data and (Path(options.data) / f"{name}.g2o").is_file():
            yield name, problems.standard_graph(name, Path(options.data))
    for num_rooms in options.rooms:
        yield f"house of {num_rooms}", problems.house_graph(num_rooms)


def main(arguments=None):
    """Measure everything, print it and write it down."""
    options = parse(arguments)
    solvers = installed_solvers(options.g2o_python)
    missing = sorted({"ours-qdldl", "gtsam_python", "python_graphslam", "g2o_python"} - set(solvers))
    if missing:
        print(f"not installed, left out: {', '.join(missing)}; see tests/benchmarks/README.md", file=sys.stderr)
    rows, runs = [], []
    with tempfile.TemporaryDirectory() as folder:
        for name, graph in graphs(options):
            rows += run_problem(name, graph, solvers, options, Path(folder))
            print(report.problem_text([row for row in rows if row["problem"] == name]), flush=True)
    for num_rooms in options.rooms:
        for library in [name.removeprefix("ours-") for name in solvers if name.startswith("ours-")]:
            runs.append(run_method(num_rooms, min(options.repeat, 3) if num_rooms >= 100 else options.repeat, library))
            print(report.method_text(runs[-1]), flush=True)
    options.out.mkdir(parents=True, exist_ok=True)
    with files.atomic_write(options.out / "results.md") as stream:
        stream.write(report.markdown(rows, runs, options, missing))
    report.draw(rows, runs, options.out / "time_vs_size.png")
    print(f"bench: {options.out}")
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        print("npslam_teach bench: interrupted", file=sys.stderr)
        sys.exit(130)
