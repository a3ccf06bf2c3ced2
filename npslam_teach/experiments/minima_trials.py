"""Does ``optimize`` find the lowest minimum, and is what its certificate says true?

    python3 -m npslam_teach.experiments.minima_trials --graphs 2000

Random drives of four kinds, whose headings err so much that wrong minima are common, are solved as ``optimize`` solves
them, and then again from twenty starts of which it knows nothing. A lower end among these is a miss. A miss that was
certified, or that lies below what the certificate allows, is a false claim: there must be none.
"""

import argparse
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from npslam_teach import se2
from npslam_teach.pose_graph import certified_minimum, levenberg_marquardt, odometry_start
from npslam_teach.system.progress import progress_shown, track
from npslam_teach.types import BetweenFactors, ObservationFactors, PoseGraph

NUM_STARTS = 20  # of the search that is compared with
TOLERANCE = 1e-6  # the share of chi2 by which one minimum has to lie below another
QUARTER = np.pi / 2
STARTS = ("zeros", "odometry", "given")


def walk(rng: np.random.Generator, num_poses: int) -> np.ndarray:
    """Headings that wander: the odometry (T-1, 3)."""
    return np.column_stack([np.ones(num_poses - 1), np.zeros(num_poses - 1), rng.normal(0, 0.6, num_poses - 1)])


def grid(rng: np.random.Generator, num_poses: int) -> np.ndarray:
    """Streets that meet at right angles, as in Manhattan: the odometry (T-1, 3)."""
    turns = QUARTER * rng.choice([-1, 0, 0, 0, 1], num_poses - 1)
    return np.column_stack([np.ones(num_poses - 1), np.zeros(num_poses - 1), turns])


def corridor(rng: np.random.Generator, num_poses: int) -> np.ndarray:
    """Up and down one corridor: the odometry (T-1, 3)."""
    length, steps = rng.integers(5, 15), np.arange(1, num_poses)
    return np.column_stack([np.ones(num_poses - 1), np.zeros(num_poses - 1), np.pi * (steps % length == 0)])


def ring(rng: np.random.Generator, num_poses: int) -> np.ndarray:
    """Round after round of a circle: the odometry (T-1, 3)."""
    turns = np.full(num_poses - 1, 2 * np.pi / rng.integers(8, 30))
    return np.column_stack([np.ones(num_poses - 1), np.zeros(num_poses - 1), turns])


DRIVES: dict[str, Callable[[np.random.Generator, int], np.ndarray]] = {
    "walk": walk,
    "grid": grid,
    "corridor": corridor,
    "ring": ring,
}


def random_problem(seed: int) -> tuple[str, str, PoseGraph, PoseGraph]:
    """A kind of drive, a kind of start, the graph there, and the graph at the truth.

    Noise is 0.02 to 0.3 rad a step in headings and a fifth to twice as many metres ahead and sideways. Loops are closed
    where the drive comes by an earlier place, in every fifth drive some of them falsely; every third sees landmarks.
    """
    rng = np.random.default_rng(seed)
    kind, start = list(DRIVES)[seed % 4], STARTS[seed // 4 % 3]
    path = se2.dead_reckoning(DRIVES[kind](rng, rng.integers(15, 101)))
    turn_std = rng.uniform(0.02, 0.3)
    std = turn_std * np.append(rng.uniform(0.2, 2.0, 2), 1.0)
    between = _measured_steps(path, std, rng, num_false=rng.integers(1, 4) if seed % 5 == 0 else 0)
    landmarks, seen = _measured_landmarks(path, std, rng, rng.integers(1, 6) if seed % 3 == 0 else 0)
    truth = PoseGraph(path, landmarks, between, seen)
    if start == "given":
        moved = rng.normal(size=path.shape) * [0.5, 0.5, 0.3] * (np.arange(len(path)) > 0)[:, None]
        return kind, start, replace(truth, poses=path + moved), truth
    graph = replace(truth, poses=np.zeros_like(path), landmarks=np.zeros_like(landmarks))
    return kind, start, graph if start == "zeros" else odometry_start(graph), truth


def _measured_steps(path: np.ndarray, std: np.ndarray, rng: np.random.Generator, num_false: int) -> BetweenFactors:
    """Odometry, and closures of some of the loops that the path has, the last few of them wrong by a metre."""
    near = np.triu(np.linalg.norm(path[:, None, :2] - path[:, :2], axis=-1) < 1.5, 5)
    loops = np.argwhere(near)
    loops = rng.permutation(loops)[: rng.integers(1, len(path) // 3)]
    i, j = np.concatenate([np.column_stack([np.arange(len(path) - 1), np.arange(1, len(path))]), loops]).T
    measured = se2.between(path[i], path[j]) + rng.normal(size=(len(i), 3)) * std
    measured[len(measured) - num_false :] += rng.normal(size=(min(num_false, len(measured)), 3)) * [1.0, 1.0, 0.5]
    measured[:, 2] = se2.wrap(measured[:, 2])
    return BetweenFactors(i, j, measured, np.tile(np.diag(1 / std**2), (len(i), 1, 1)))


def _measured_landmarks(
    path: np.ndarray, std: np.ndarray, rng: np.random.Generator, how_many: int
) -> tuple[np.ndarray, ObservationFactors]:
    """Landmarks beside the path, each seen from all poses within 3 m of it."""
    landmarks = path[rng.integers(len(path), size=how_many), :2] + rng.uniform(-1, 1, (how_many, 2))
    pose, landmark = np.nonzero(np.linalg.norm(path[:, None, :2] - landmarks, axis=-1) < 3)
    xy = se2.apply_inverse(path[pose], landmarks[landmark]) + rng.normal(size=(len(pose), 2)) * std[:2]
    return landmarks, ObservationFactors(pose, landmark, xy, np.tile(np.diag(1 / std[:2] ** 2), (len(pose), 1, 1)))


def other_starts(graph: PoseGraph, truth: PoseGraph, rng: np.random.Generator) -> Iterator[PoseGraph]:
    """Starts without end: the truth, the given one, places near the truth, odometry drawn anew, headings at random."""
    yield truth
    yield graph
    free = (np.arange(len(truth.poses)) > 0)[:, None]
    while True:
        near = truth.poses + free * rng.normal(size=truth.poses.shape) * rng.uniform(0, 2) * [1.0, 1.0, 0.5]
        yield replace(truth, poses=near)
        drawn = truth.between.relative_pose + rng.normal(size=truth.between.relative_pose.shape) * [0.0, 0.0, 0.3]
        between = replace(truth.between, relative_pose=np.column_stack([drawn[:, :2], se2.wrap(drawn[:, 2])]))
        yield replace(odometry_start(replace(truth, between=between)), between=truth.between)
        turned = truth.poses + free * rng.uniform(-np.pi, np.pi, truth.poses.shape) * [0.0, 0.0, 1.0]
        yield replace(truth, poses=turned)


def trial(seed: int, num_starts: int = NUM_STARTS) -> dict:
    """One graph: how far the lowest of many other minima lies below what ``optimize`` finds.

    Returns:
        seed, kind, start, poses, chi2, lowest (of the other starts), certificate (its status), gap, missed (lowest is
        lower) and false_claim (it is lower than the certificate allows).
    """
    kind, start, graph, truth = random_problem(seed)
    found = certified_minimum(graph).certificate
    starts = other_starts(graph, truth, np.random.default_rng([seed, 1]))
    ends = [_end(next(starts)) for _ in range(num_starts)]
    lowest, margin = min(ends), TOLERANCE * found.chi2 + 1e-9
    numbers = {"poses": len(graph.poses), "chi2": found.chi2, "lowest": lowest, "gap": found.gap}
    missed, status = lowest < found.chi2 - margin, found.status
    false = lowest < found.chi2 - margin - (0.0 if status == "certified" else found.gap)
    named = {"seed": seed, "kind": kind, "start": start, "certificate": status}
    return named | numbers | {"missed": bool(missed), "false_claim": bool(false)}


def _end(start: PoseGraph) -> float:
    """chi2 where the robust solver ends; infinite where it fails."""
    return list(levenberg_marquardt(start, 1e-10, 300))[-1].chi2


def summary(rows: list[dict]) -> str:
    """One line for each kind of drive, and one for all of them."""
    lines = []
    for kind in [*DRIVES, "all"]:
        of_kind = [row for row in rows if kind in (row["kind"], "all")]
        if of_kind:
            status = {name: sum(row["certificate"] == name for row in of_kind) for name in ("certified", "gap", "none")}
            certificates = ", ".join(f"{name} {count}" for name, count in status.items())
            missed, false = (sum(row[name] for row in of_kind) for name in ("missed", "false_claim"))
            lines.append(f"{kind}: {len(of_kind)} graphs: {certificates}; missed {missed}, false claims {false}")
    return "\n".join(lines)


def main() -> None:
    """Run the trials that are asked for; print the misses and a line for each kind of drive."""
    parser = argparse.ArgumentParser(description="how often the lowest minimum is found and certified")
    parser.add_argument("--graphs", type=int, default=2000)
    parser.add_argument("--first-seed", type=int, default=0)
    options = parser.parse_args()
    seeds, rows = range(options.first_seed, options.first_seed + options.graphs), []
    with progress_shown():
        for seed in track(seeds, options.graphs, "minima", "graphs"):
            rows.append(trial(seed))
            if rows[-1]["missed"]:
                print(
                    "seed {seed}, {kind} of {poses} from {start}: chi2 {chi2:.6g}, another start ends at {lowest:.6g}; "
                    "{certificate}, gap {gap:.3g}".format(**rows[-1]),
                    flush=True,
                )
    print(summary(rows))


if __name__ == "__main__":
    main()
