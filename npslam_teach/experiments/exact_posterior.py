"""Does the sampler visit every partition as often as it is probable? All partitions of small logs, enumerated.

    python3 -m npslam_teach.experiments.exact_posterior --logs 100

Of up to eight observations there are at most 4,140 partitions, and the exact posterior is a list. What the sampler
would do from each of them with each tracklet is asked of ``GibbsSampler`` once and kept, so that millions of sweeps
cost seconds; split-merge moves are made by the sampler itself, for a few of many chains between sweeps.
"""

import argparse
import math
from typing import NamedTuple

import numpy as np

from npslam_teach import se2
from npslam_teach.association import all_partitions, in_order_of_sight
from npslam_teach.association.gibbs import GibbsSampler
from npslam_teach.association.partition_posterior import TrackletEvidence, log_posterior
from npslam_teach.association.split_merge import split_or_merge
from npslam_teach.methods.posterior import in_time, start_model
from npslam_teach.pose_graph.reduced_system import reduced_system
from npslam_teach.system.progress import progress_shown, track
from npslam_teach.types import RobotLog

CHAINS, WARM_UP = 2000, 100  # sweeps that are thrown away
PROPOSALS = 20  # to split or to merge, of so many chains, after every tenth sweep
CHANCE, MARGIN = 0.008, 4.0  # distance that independent samples would leave; so many times more are drawn


class Table(NamedTuple):
    """Every possible partition of N tracklets and what a sampler does from each."""

    labels: np.ndarray  # (P, N) numbered by first sight
    exact: np.ndarray  # (P,) probability
    following: np.ndarray  # (P, N, N+1) which partition, if a tracklet takes one of its places
    cumulated: np.ndarray  # (P, N, N+1) probability of this place or one before it


def random_log(seed: int, most: int = 8) -> RobotLog:
    """Two to eight observations, of one class or two, of up to three objects that are hard to tell apart."""
    rng = np.random.default_rng(seed)
    count, poses = int(rng.integers(2, most + 1)), 5
    objects, kinds = rng.uniform(1, 3, (3, 2)), int(rng.integers(1, 3))
    odometry = np.column_stack([np.full(poses - 1, 0.3), np.zeros(poses - 1), rng.normal(0, 0.1, poses - 1)])
    path, which = se2.dead_reckoning(odometry), rng.integers(0, 3, count)
    time = rng.integers(0, poses, count)
    seen = se2.apply_inverse(path[time], objects[which]) + rng.normal(0, 0.2, (count, 2))
    noisy = odometry + rng.normal(0, 0.05, odometry.shape)
    return RobotLog(noisy, time, seen, which % kinds, kinds, (0.05,) * 3, (0.2,) * 2)


def evidence_of(log: RobotLog) -> TrackletEvidence:
    """The sampler's own linear model of a log, every observation a tracklet."""
    model, graph = start_model(in_time(log)[0])
    return model.evidence(reduced_system(graph))


def table(evidence: TrackletEvidence) -> Table:
    """Enumerate all partitions, and ask the sampler once for every move of a single tracklet."""
    count = len(evidence.counts)
    listed = [np.array(each) for each in all_partitions([0] * count)]
    scored = [(each, log_posterior(evidence, each)) for each in listed]
    possible = [(each, log_p) for each, log_p in scored if log_p > -math.inf]
    labels, log_p = np.array([each for each, _ in possible]), np.array([log_p for _, log_p in possible])
    number = {each.tobytes(): k for k, each in enumerate(labels)}
    following = np.zeros((len(labels), count, count + 1), dtype=np.int32)
    cumulated = np.ones(following.shape)
    for k, each in enumerate(labels):
        sampler = GibbsSampler(evidence, each, np.random.default_rng(0))
        for tracklet in range(count):
            slots, change = sampler.weights(tracklet)
            share = np.exp(change - change.max())
            for place, slot in enumerate(slots):
                moved = sampler.slot.copy()
                moved[tracklet] = slot
                following[k, tracklet, place] = number[in_order_of_sight(moved).tobytes()]
            cumulated[k, tracklet, : len(slots) - 1] = np.cumsum(share / share.sum())[:-1]
    share = np.exp(log_p - log_p.max())
    return Table(labels, share / share.sum(), following, cumulated)


def enough(exact: np.ndarray) -> int:
    """How many samples: MARGIN times those of which independent ones would leave a distance of CHANCE."""
    return int(MARGIN * (np.sqrt(exact * (1 - exact) / (2 * np.pi)).sum() / CHANCE) ** 2) + CHAINS


def sampled(evidence: TrackletEvidence, moves: Table, number: int, rng: np.random.Generator) -> np.ndarray:
    """How often (P,) chains that begin with every tracklet alone come to each partition; shares."""
    states = np.full(CHAINS, int(moves.labels.max(axis=1).argmax()))
    index = {each.tobytes(): k for k, each in enumerate(moves.labels)}
    often, rounds = np.zeros(len(moves.exact)), -(-number // CHAINS)
    for k in range(WARM_UP + rounds):
        for tracklet in rng.permutation(moves.labels.shape[1]):
            bounds = moves.cumulated[states, tracklet]
            place = (rng.random(CHAINS)[:, None] >= bounds).sum(axis=1)
            states = moves.following[states, tracklet, place]
        for chain in rng.choice(CHAINS, PROPOSALS, replace=False) if k % 10 == 0 else ():
            sampler = GibbsSampler(evidence, moves.labels[states[chain]], rng)
            split_or_merge(sampler)
            states[chain] = index[sampler.labels.tobytes()]
        if k >= WARM_UP:
            often += np.bincount(states, minlength=len(often))
    return often / often.sum()


def compared(seed: int) -> dict:
    """One log: how many observations and partitions, how many samples, and the total variation distance."""
    log = random_log(seed)
    evidence = evidence_of(log)
    moves = table(evidence)
    number = enough(moves.exact)
    often = sampled(evidence, moves, number, np.random.default_rng([seed, number]))
    distance = float(np.abs(often - moves.exact).sum() / 2)
    return {
        "seed": seed,
        "observations": log.num_observations,
        "partitions": len(moves.exact),
        "samples": number,
        "distance": distance,
    }


def main() -> None:
    """Compare as many logs as are asked for; a line for each, and one for all."""
    parser = argparse.ArgumentParser(description="the sampler's frequencies beside the exact posterior of small logs")
    parser.add_argument("--logs", type=int, default=100)
    parser.add_argument("--first-seed", type=int, default=0)
    options = parser.parse_args()
    seeds = range(options.first_seed, options.first_seed + options.logs)
    print("seed,observations,partitions,samples,total_variation")
    with progress_shown():
        rows = []
        for seed in track(seeds, options.logs, "exact posterior", "logs"):
            rows.append(compared(seed))
            print(",".join(f"{value:.4f}" if name == "distance" else str(value) for name, value in rows[-1].items()))
    within = sum(row["distance"] <= 0.02 for row in rows)
    print(f"within 0.02: {within} of {len(rows)}; largest {max(row['distance'] for row in rows):.4f}")


if __name__ == "__main__":
    main()
