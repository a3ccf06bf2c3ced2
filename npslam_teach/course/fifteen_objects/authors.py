"""The paper's four methods on the authors' own simulation, run in advance: ``authors.csv``.

The table is made by

    python -m npslam_teach fetch simulation
    python -m npslam_teach reproduce --data FILE --noise 1 --seeds 30 \
        --methods np-graph,robust-slam,open-loop,frame-by-frame --table npslam_teach/course/fifteen_objects/authors.csv

It holds results alone, nothing of the data.
"""

from pathlib import Path

import numpy as np

from npslam_teach.experiments.paper_simulation import read_runs

FILE = Path(__file__).parent / "authors.csv"
PAPERS_ROUNDS = (1098, 33, 20, 15)  # paper section V.A; deck figures 15 and 16


def runs_of(method: str) -> list[dict]:
    """The runs of one method, in the order of their seeds.

    Raises:
        ValueError: the table has none.
    """
    runs = [run for run in read_runs(FILE) if run["method"] == method]
    if not runs:
        raise ValueError(f"method: expected one of the paper's four, got {method!r}")
    return runs


def median_rounds(num_rounds: int) -> list[int]:
    """Objects before any round and after each of ``num_rounds`` of the NP-graph, the median run.

    A run that came to rest keeps its last number.
    """
    rounds = [run["rounds"] + run["rounds"][-1:] * num_rounds for run in runs_of("np-graph")]
    return [round(float(np.median([each[k] for each in rounds]))) for k in range(num_rounds + 1)]


def compared() -> str:
    """A line for each method: runs with exactly fifteen objects, and medians."""
    lines = [f"{'method':15} exactly 15  objects  used  pose error  object error"]
    for method in ("np-graph", "robust-slam", "open-loop", "frame-by-frame"):
        runs = runs_of(method)
        exact = f"{sum(run['objects'] == 15 for run in runs)} of {len(runs)}"
        objects, used, pose, xy = (
            float(np.median([run[name] for run in runs])) for name in ("objects", "used", "pose_error", "object_error")
        )
        lines.append(f"{method:15} {exact:>10} {objects:8.0f} {used:5.0f} {pose:9.2f} m {xy:11.2f} m")
    return "\n".join(lines)
