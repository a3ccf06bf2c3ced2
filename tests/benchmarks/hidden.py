"""Victoria Park with its identities hidden: how long each method takes, how much memory, and how good it is.

    python3 tests/benchmarks/hidden.py --data FOLDER [--methods known,ekf,posterior] [--poses N]

``FOLDER`` holds ``victoria_park.g2o`` (or set ``NPSLAM_TEACH_DATA``). Each method runs once, in a process of its own on
one thread; seconds are those of the processor. The truth is the map of the file; the noise is the log's own.
The table goes into ``results/victoria_park.md``.
"""

import argparse
import json
import os
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

HERE = Path(__file__).parent
ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
HEAD = (
    "| method | poses | observations | seconds | peak memory, MB | objects | ARI | mean pose error, m |\n"
    "|---|---|---|---|---|---|---|---|\n"
)


def shortened(log, truth, poses):
    """The first poses of a log, and what was seen from them."""
    if poses >= log.num_poses:
        return log, truth
    kept = log.obs_time < poses
    fields = {name: getattr(log, name)[kept] for name in ("obs_time", "obs_xy", "obs_class")}
    seen = truth.obs_object[kept]
    return replace(log, odometry=log.odometry[: poses - 1], **fields), replace(
        truth, poses=truth.poses[:poses], obs_object=seen
    )


def measure(method, path, poses):
    """One method, here and now: a row of the table."""
    sys.path[:0] = [str(HERE), str(HERE.parent.parent)]
    from worker import peak_memory

    from npslam_teach import datasets, evaluation
    from npslam_teach.experiments.oracles import true_identities
    from npslam_teach.methods import METHODS

    log, truth = shortened(*datasets.load_hidden(path), poses)
    begin = time.process_time()
    if method == "known":
        last = true_identities(log, truth)
    else:
        *_, last = METHODS[method](log)
    seconds, memory = time.process_time() - begin, peak_memory()
    found = evaluation.evaluate(last, truth, log)
    row = {"method": method, "poses": log.num_poses, "observations": log.num_observations, "seconds": seconds}
    return row | {"memory": memory, "objects": found.num_objects, "ari": found.ari, "error": found.mean_pose_error}


def line(row):
    """A row as the table has it."""
    name = {"known": "known association"}.get(row["method"], row["method"])
    numbers = f"{row['seconds']:.1f} | {row['memory']:.0f} | {row['objects']} | {row['ari']:.3f} | {row['error']:.2f}"
    return f"| {name} | {row['poses']} | {row['observations']} | {numbers} |"


def main():
    """Run the methods that are asked for, print a line for each and write the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--data", type=Path, default=os.environ.get("NPSLAM_TEACH_DATA"))
    parser.add_argument("--methods", default="known,ekf,posterior")
    parser.add_argument("--poses", type=int, default=10**9, help="only so many from the beginning")
    parser.add_argument("--out", type=Path, default=HERE / "results" / "victoria_park.md")
    parser.add_argument("--measure", help=argparse.SUPPRESS)
    options = parser.parse_args()
    path = options.data and Path(options.data) / "victoria_park.g2o"
    if not path or not path.is_file():
        parser.error("--data: expected a folder with victoria_park.g2o")
    if options.measure:
        print(json.dumps(measure(options.measure, path, options.poses)))
        return
    rows = []
    for method in options.methods.split(","):
        command = [sys.executable, __file__, "--data", path.parent, "--poses", options.poses, "--measure", method]
        command = [str(word) for word in command]
        said = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True, env=os.environ | ONE_THREAD)
        rows.append(line(json.loads(said.stdout.splitlines()[-1])))
        print(rows[-1], flush=True)
    title = (
        "# Victoria Park, its identities hidden\n\nMade by `tests/benchmarks/hidden.py`; seconds of one processor.\n\n"
    )
    options.out.write_text(title + HEAD + "\n".join(rows) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
