r"""Every method beside every other: what it needs, what it finds, what it costs. The table that closes the course.

The runs come from two sweeps (the recordings are fetched as the README says), the table from the last command, which
also runs every method once in a process of its own to see its memory; RESULTS is ``tests/benchmarks/results``, METHODS
all of them with commas between:

    python3 -m npslam_teach sweep --methods METHODS --settings sensor --noise 1,2,3,4,6 --seeds 20 \
        --out RESULTS/methods.csv
    python3 -m npslam_teach sweep --methods METHODS --settings sensor --noise 0 --seeds 1 --scenes RECORDINGS \
        --out RESULTS/recordings.csv
    python3 -m npslam_teach.experiments.method_table RESULTS npslam_teach/course/online/methods.csv

A run is *exact* when it finds exactly the true number of objects with an
adjusted Rand index of at least 0.99 over all observations, those that it leaves out included.
"""

import sys
from pathlib import Path

import numpy as np

from npslam_teach import simulate
from npslam_teach.experiments import method_summary, tables
from npslam_teach.experiments.executors import local_pool
from npslam_teach.experiments.runs import run_method
from npslam_teach.experiments.sweep import is_right
from npslam_teach.experiments.sweep_files import read_rows
from npslam_teach.methods import METHODS
from npslam_teach.system.files import atomic_write

NEEDS = {  # what somebody must know or choose
    "np-graph": "noise, alpha, kernel width",
    "robust-slam": "noise; one object a class",
    "open-loop": "kernel width, alpha",
    "frame-by-frame": "nothing",
    "ekf": "noise, two gates",
    "soft-em": "noise, gates for its start",
    "online": "noise, alpha, area, a window",
    "posterior": "noise, alpha, area",
}
HEAD = ("method", "needs", "right number", "exact, by noise", "recordings", "pose error, m", "s", "MB")


def markdown(rows: list[dict], recordings: list[dict], megabytes: dict[str, float | None]) -> str:
    """The table, a line for each method.

    Args:
        rows: of a sweep over noise and seeds.
        recordings: of a sweep over recordings of robots; it may be empty.
        megabytes: by method; None where the system does not say.
    """
    methods = [name for name in METHODS if any(row["method"] == name for row in rows)]
    head = [f"| {' | '.join(HEAD)} |", "|---|---|--:|---|---|--:|--:|--:|"]
    lines = []
    for name in methods:
        own, real = ([row for row in each if row["method"] == name] for each in (rows, recordings))
        memory = "" if megabytes.get(name) is None else f"{megabytes[name]:.0f}"
        right, exact, error, seconds = _simulated(own)
        cells = [name, NEEDS[name], right, exact, _recorded(real), error, seconds, memory]
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join([*head, *lines, "", _words(rows, recordings), ""])


def _simulated(rows: list[dict]) -> tuple[str, str, str, str]:
    """Right numbers at the least noise, exact runs at each, pose error at the least and at three times, seconds."""
    by_noise = {noise: [row for row in rows if row["noise"] == noise] for noise in sorted({r["noise"] for r in rows})}
    least = min(by_noise)
    right = sum(row["objects"] == row["objects_true"] for row in by_noise[least])
    exact = ", ".join(f"{noise:g}: {sum(map(is_right, runs))}" for noise, runs in by_noise.items())
    error = ", ".join(f"{_median(by_noise[noise], 'pose_error'):.2f}" for noise in (least, 3.0) if noise in by_noise)
    return f"{right} of {len(by_noise[least])}", exact, error, f"{_median(by_noise[least], 'seconds'):.2f}"


def _recorded(rows: list[dict]) -> str:
    """How many objects in recordings, and the lowest agreement with who is who."""
    if not rows:
        return ""
    right = sum(row["objects"] == row["objects_true"] for row in rows)
    return f"{right} of {len(rows)}, ARI from {min(row['ari'] or 0.0 for row in rows):.2f}"


def _median(rows: list[dict], name: str) -> float:
    values = [row[name] for row in rows if row[name] is not None]
    return float(np.median(values)) if values else float("nan")


def _words(rows: list[dict], recordings: list[dict]) -> str:
    """What the numbers are of."""
    least, seeds = min(row["noise"] for row in rows), len({row["seed"] for row in rows})
    text = [
        f"`fifteen_objects` with {seeds} seeds at each noise, constants scaled to the log's own noise. Right number",
        f"at noise {least:g}. Exact, by noise: how many of {seeds} runs have exactly the fifteen objects and an",
        f"adjusted Rand index of at least 0.99. Pose error: medians at noise {least:g} and at 3. Seconds: the median",
        f"at noise {least:g} on one core. MB: how much a process grows on one run.",
    ]
    if recordings:
        names = len({row["scene"] for row in recordings})
        text.append(f"Recordings: {names} of real robots (UTIAS MRCLAM, five classes of three landmarks): in how many")
        text.append("the number is right, and the lowest adjusted Rand index.")
    return "\n".join(text)


def megabytes_of(method: str) -> float | None:
    """By how much a new process grows while a method runs on ``fifteen_objects``; None where nobody knows."""
    with local_pool(1) as pool:
        return pool.submit(_growth, method).result()


def _growth(method: str) -> float | None:
    status = Path("/proc/self/status")
    if not status.exists():
        return None
    run_method(method, simulate.toy_objects()[0], {})
    log, _ = simulate.fifteen_objects(0)
    before = _line(status, "VmRSS")
    run_method(method, log, {})
    return max(_line(status, "VmHWM") - before, 0) / 1024


def _line(status: Path, name: str) -> int:
    return next(int(line.split()[1]) for line in status.read_text().splitlines() if line.startswith(name))


def main(results: str, summary: str) -> None:
    """Write ``methods.md`` beside the rows of the sweeps, and the summary that lesson 15 draws.

    Lesson 15, README and guide show the same table.

    Args:
        results: the folder of the rows.
        summary: the file of the summary.
    """
    folder = Path(results)
    rows, recordings = read_rows(folder / "methods.csv"), read_rows(folder / "recordings.csv", may_be_missing=True)
    text = markdown(rows, recordings, {name: megabytes_of(name) for name in dict.fromkeys(r["method"] for r in rows)})
    with atomic_write(folder / "methods.md") as stream:
        stream.write(text)
    tables.write_table(method_summary.summary(rows), method_summary.COLUMNS, Path(summary))


if __name__ == "__main__":
    main(*sys.argv[1:])
