"""What a lesson costs a student's seat: memory and processor time of its kernel, and memory of JupyterLab itself.

``python tests/measure_lessons.py`` prints the table of ``notebooks/teaching_guide.md`` for the machine it runs on;
with the names of notebooks it measures these alone.
"""

import contextlib
import json
import math
import os
import platform
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import nbformat
import psutil
from nbclient import NotebookClient

ROOT = Path(__file__).parent.parent
MB = 1e6
NEIGHBOUR = (
    "import ipywidgets, scipy.stats, npslam_teach as nt; from npslam_teach import plotting; nt.fifteen_objects(0)"
)


def proportional(process: psutil.Process) -> float:
    """MB of its own and its part of those that it shares with others (PSS); NaN where the system does not say."""
    return getattr(process.memory_full_info(), "pss", math.nan) / MB


@contextlib.contextmanager
def neighbour():
    """Another kernel of the course, as other students have one: what both map from the same files is there once."""
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(NEIGHBOUR)])
    client = NotebookClient(notebook, timeout=600)
    with client.setup_kernel(cwd=str(ROOT / "notebooks")):
        client.execute_cell(notebook.cells[0], 0)
        yield


class Peak(threading.Thread):
    """The largest resident memory of a process, looked at every 20 ms."""

    def __init__(self, pid: int) -> None:
        super().__init__(daemon=True)
        self.process, self.bytes, self.done = psutil.Process(pid), 0, threading.Event()
        self.start()

    def run(self) -> None:
        while not self.done.wait(0.02) and self.process.is_running():
            self.bytes = max(self.bytes, self.process.memory_info().rss)


def measure_lesson(path: Path) -> dict:
    """Processor seconds of the kernel that runs a lesson, and its MB at the end, at most, and at the end in part."""
    client = NotebookClient(nbformat.read(path, as_version=4), timeout=600)
    with client.setup_kernel(cwd=str(path.parent)):
        kernel = psutil.Process(client.km.provisioner.pid)
        peak = Peak(kernel.pid)
        for index, cell in enumerate(client.nb.cells):
            client.execute_cell(cell, index)
        used = kernel.cpu_times()
        peak.done.set()
        at_the_end, in_part = kernel.memory_info().rss, proportional(kernel)
    return {
        "lesson": path.stem,
        "cpu": used.user + used.system,
        "end": at_the_end / MB,
        "peak": max(peak.bytes, at_the_end) / MB,
        "pss": in_part,
    }


def measure_lab() -> tuple[float, float]:
    """MB of a JupyterLab that has just started, without a kernel: all, and in part."""
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "jupyterlab", "--no-browser", "--ServerApp.port=0", "--allow-root"]
        environment = os.environ | {"JUPYTER_RUNTIME_DIR": folder}
        server = subprocess.Popen(command, cwd=ROOT, env=environment, stderr=subprocess.DEVNULL)
        try:
            while not any(json.loads(file.read_text()) for file in Path(folder).glob("jpserver-*.json")):
                if server.poll() is not None:
                    raise SystemExit(f"JupyterLab ended with exit code {server.returncode} before it had started")
                time.sleep(0.1)
            time.sleep(5)  # its extensions load after the file has been written
            process = psutil.Process(server.pid)
            return process.memory_info().rss / MB, proportional(process)
        finally:
            server.terminate()
            server.wait()


def sizing(rows: list[dict], lab: tuple[float, float], students: int = 200, cores: int = 32) -> str:
    """What a class needs at once, from what one student needs: with nothing shared, and with files shared."""
    alone = (lab[0] + max(row["peak"] for row in rows)) * students / 1000
    shared = (lab[1] + max(row["pss"] for row in rows)) * students / 1000
    longest = max(row["cpu"] for row in rows)
    together = longest * students / cores
    return (
        f"{students} students, one lesson open each: at most {alone:.0f} GB where nothing is shared, about "
        f"{shared:.0f} GB where all run on one machine from one image. All run the longest lesson at the same moment: "
        f"{longest * students:.0f} CPU seconds, {together:.0f} s on {cores} cores like these."
    )


def describe_machine() -> str:
    """Processor count, memory, system and Python, as they stand above the table."""
    memory = psutil.virtual_memory().total / 1e9
    threads = os.environ.get("OMP_NUM_THREADS", "not set")
    return (
        f"{os.cpu_count()} cores, {memory:.0f} GB, {platform.system()} {platform.machine()}, "
        f"Python {platform.python_version()}, OMP_NUM_THREADS {threads}"
    )


def main(names: list[str]) -> None:
    os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, [str(ROOT), os.environ.get("PYTHONPATH")]))
    rows = []
    with neighbour():
        lab = measure_lab()
        print(f"{describe_machine()}; JupyterLab without a kernel: {lab[0]:.0f} MB, PSS {lab[1]:.0f} MB\n")
        print("| lesson | CPU seconds | MB at the end | MB at most | PSS at the end, MB |\n|---|---|---|---|---|")
        for path in map(Path, names or sorted((ROOT / "notebooks").glob("*.ipynb"))):
            rows.append(measure_lesson(path.absolute()))
            print("| {lesson} | {cpu:.0f} | {end:.0f} | {peak:.0f} | {pss:.0f} |".format(**rows[-1]), flush=True)
    print(f"\n{sizing(rows, lab)}")


if __name__ == "__main__":
    main(sys.argv[1:])
