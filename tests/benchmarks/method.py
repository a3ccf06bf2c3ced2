"""The whole method on logs of 1, 10 and 100 rooms, in a process of its own for each: how long, of that what, how much.

``python method.py ROOMS REPEAT LIBRARY`` prints one JSON object. The seconds of the association are those spent in
``sweep``, those of the solver in ``optimize``.
"""

import json
import sys
import time
from pathlib import Path

from worker import peak_memory

sys.path.insert(0, str(Path(__file__).parent.parent.parent))

from npslam_teach import simulate
from npslam_teach.methods import np_graph  # noqa: E402
from npslam_teach.pose_graph import factorization  # noqa: E402

PARTS = {"association": "sweep", "solver": "optimize"}


def timed(function, spent):
    """The same function, which also notes the seconds it takes."""

    def measured(*arguments, **settings):
        begin = time.perf_counter()
        result = function(*arguments, **settings)
        spent.append(time.perf_counter() - begin)
        return result

    return measured


def main():
    """Run, and tell the medians."""
    num_rooms, repeat, library = int(sys.argv[1]), int(sys.argv[2]), sys.argv[3]
    if library == "superlu":
        factorization.has_qdldl = lambda: False
    log, truth = simulate.grid_of_rooms(num_rooms)
    module = sys.modules[np_graph.__module__]
    spent = {part: [] for part in PARTS}
    for part, name in PARTS.items():
        setattr(module, name, timed(getattr(module, name), spent[part]))
    runs = []
    for _ in range(repeat + 1):  # the first pays for imports and for memory that the process does not have yet
        before = {part: sum(seconds) for part, seconds in spent.items()}
        begin = time.perf_counter()
        snapshots = list(np_graph(log))
        run = {"seconds": time.perf_counter() - begin}
        runs.append(run | {part: sum(seconds) - before[part] for part, seconds in spent.items()})
    runs = sorted(runs[-repeat:], key=lambda run: run["seconds"])
    facts = {
        "poses": log.num_poses,
        "observations": log.num_observations,
        "objects": len(truth.world.object_xy),
        "counts": [snapshot.num_objects for snapshot in snapshots],
        "memory": peak_memory(),
    }
    print(json.dumps(runs[len(runs) // 2] | facts))


if __name__ == "__main__":
    main()
