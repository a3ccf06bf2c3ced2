"""How often does ``posterior`` find the truth, and where it does not: did the search fail, or are the data ambiguous?

    python3 -m npslam_teach.experiments.posterior_trials --noise 1 2 3 4 6 --seeds 100 [--data FILE.mat]

The log posteriors of what was found and of the truth are compared in the same way, each around its own solution. Where
the truth has the higher one the search has failed; where it has the lower one nobody could know better by this model.

How much can be asked for at all? The same log is also given the map and the trajectory that the true identities make
most probable, and every observation goes where it fits best. What is wrong even then, no search need find.
"""

import argparse
import time

import numpy as np

from npslam_teach.association import in_order_of_sight
from npslam_teach.evaluation import compare_partitions, evaluate, singletons_for_unassigned, wilson_interval
from npslam_teach.experiments.paper_simulation import scenes
from npslam_teach.experiments.runs import LEAST_ARI, Scene
from npslam_teach.methods import METHODS
from npslam_teach.methods.partition_score import partition_score
from npslam_teach.methods.posterior import in_time, start_model
from npslam_teach.methods.repair import classes_of, reassigned
from npslam_teach.pose_graph import fit
from npslam_teach.system.progress import progress_shown, track


def trial(scene: Scene) -> dict:
    """One run: whether it is right, the log posteriors, and how long it took.

    Returns:
        seed, noise, objects, ari, right, seconds (of the processor), found and truth (log posteriors; an observation
        left out counts as an object of its own), told (the ARI of ``told_the_map``), and verdict: right, search (the
        truth was better) or data.
    """
    begin = time.process_time()
    *_, last = METHODS["posterior"](scene.log)
    seconds, metrics = time.process_time() - begin, evaluate(last, scene.truth, scene.log)
    ordered, back = in_time(scene.log)
    model, _ = start_model(ordered)
    scores = []
    for labels, poses in ((last.labels, last.graph.poses), (scene.truth.obs_object, scene.truth.poses)):
        in_order = labels[np.argsort(back)]
        in_order = in_order_of_sight(in_order, in_order >= 0)
        scores.append(partition_score(model, in_order, fit(ordered, in_order, poses)))
    right = metrics.num_objects == metrics.num_objects_true and metrics.ari >= LEAST_ARI
    verdict = "right" if right else "search" if scores[1] > scores[0] else "data"
    numbers = {"objects": metrics.num_objects, "ari": metrics.ari, "right": bool(right), "seconds": seconds}
    scored = {"found": scores[0], "truth": scores[1], "told": told_the_map(scene), "verdict": verdict}
    return {"seed": scene.seed, "noise": scene.noise} | numbers | scored


def told_the_map(scene: Scene) -> float:
    """The ARI over all observations when map and trajectory are those of the true identities, and only they are asked.

    Args:
        scene: with the object of every observation known.
    """
    log, labels = scene.log, np.unique(scene.truth.obs_object, return_inverse=True)[1]
    graph = fit(log, labels, scene.truth.poses)
    seen = reassigned(log, graph.poses, graph.landmarks, classes_of(log, labels))
    return compare_partitions(labels, singletons_for_unassigned(seen))[0]


def summary(rows: list[dict]) -> str:
    """One line for the rows of one noise."""
    right = sum(row["right"] for row in rows)
    low, high = wilson_interval(right, len(rows))
    verdicts = [f"{name} {sum(row['verdict'] == name for row in rows)}" for name in ("search", "data")]
    median = np.median([row["seconds"] for row in rows])
    share = f"right {right} of {len(rows)} (95%: {low:.3f} to {high:.3f})"
    told = f"told the map: {sum(row['told'] >= LEAST_ARI for row in rows)}"
    return f"noise {rows[0]['noise']:g}: {share}; failures: {', '.join(verdicts)}; {told}; median {median:.2f} s"


def main() -> None:
    """Run the trials that are asked for and print a line for each noise, and one for each failure."""
    parser = argparse.ArgumentParser(description="how often the posterior method finds the truth")
    parser.add_argument("--noise", type=float, nargs="+", default=[1.0, 2.0, 3.0, 4.0, 6.0])
    parser.add_argument("--seeds", type=int, default=100)
    parser.add_argument("--first-seed", type=int, default=5000)
    parser.add_argument("--data", help="the authors' simulation; default: the same scene built here")
    options = parser.parse_args()
    seeds = range(options.first_seed, options.first_seed + options.seeds)
    with progress_shown():
        for noise in options.noise:
            drawn = track(scenes(options.data, noise, seeds), options.seeds, f"noise {noise:g}", "runs")
            rows = [trial(scene) for scene in drawn]
            print(summary(rows), flush=True)
            for row in (row for row in rows if not row["right"]):
                scores = f"log posterior found {row['found']:.1f}, truth {row['truth']:.1f}"
                print(
                    f"  seed {row['seed']}: {row['objects']} objects, ARI {row['ari']:.4f}, {scores}: {row['verdict']}"
                )


if __name__ == "__main__":
    main()
