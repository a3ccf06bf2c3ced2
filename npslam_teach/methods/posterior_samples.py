"""Not the best partition but all of them: samples from the posterior, around the trajectory of the best.

At temperature 1 the sampler of ``association.gibbs`` visits every partition as often as it is probable. How often are
there fifteen objects? How often are these two tracklets one chair? No threshold can say it.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from npslam_teach.association import first_observations, in_order_of_sight, require_alpha
from npslam_teach.association.gibbs import GibbsSampler
from npslam_teach.association.split_merge import split_or_merge
from npslam_teach.methods.annealing import PROPOSALS, Model, State, solved, tied_anew
from npslam_teach.methods.polish import MARGIN
from npslam_teach.methods.posterior import in_time, posterior, start_model
from npslam_teach.pose_graph.reduced_system import reduced_system
from npslam_teach.system.progress import track
from npslam_teach.types import PoseGraph, RobotLog, Snapshot

CHAINS, WARM_UP = 4, 0.25  # of each chain this share is thrown away before it is kept
HOT = (8.0, 4.0, 2.0)  # where the chains come from, so that they begin apart


@dataclass(frozen=True, eq=False)
class PosteriorSamples:
    """Partitions of N tracklets, each as often as it is probable."""

    tracklet: np.ndarray  # (M,) of each observation; -1 = of none
    partitions: np.ndarray  # (chains, samples, N) the object of each tracklet
    log_posterior: np.ndarray  # (chains, samples)
    best: np.ndarray  # (N,) the partition around which the model is linear
    object_xy: np.ndarray  # (K, 2) m, W, of the best
    object_cov: np.ndarray  # (K, 2, 2) m^2, trajectory integrated out

    @property
    def num_objects(self) -> np.ndarray:
        """(chains, samples)."""
        return self.partitions.max(axis=2, initial=-1) + 1

    @property
    def num_objects_probability(self) -> dict[int, float]:
        """How probable each number of objects is."""
        counts, often = np.unique(self.num_objects, return_counts=True)
        return {int(count): float(share) for count, share in zip(counts, often / often.sum(), strict=True)}

    @property
    def together(self) -> np.ndarray:
        """(N, N) how probable it is that two tracklets are of one object."""
        flat = self.partitions.reshape(-1, self.partitions.shape[2])
        return sum((each[:, None] == each).astype(float) for each in flat) / len(flat)


def sample_posterior(
    log: RobotLog,
    num_samples: int = 1000,
    alpha: float = 1.0,
    *,
    area: float | None = None,
    starts: int = 6,
    chains: int = CHAINS,
    seed: int = 0,
    found: Snapshot | None = None,
) -> PosteriorSamples:
    """Sample partitions by Gibbs and split-merge moves, trajectory and map integrated out in the linear model.

    The sampler believes that all noise is white and that every tracklet is a thing. What the search has left out, and
    passes that it joined although white noise would not have carried them so far, are therefore left out here.

    Args:
        log: what the robot measured; at least one observation.
        num_samples: of all chains together.
        alpha: concentration of the Dirichlet process.
        area: m^2, over which objects are uniform; None: of ``posterior.box_area``.
        starts: searches for the best partition, around which the model is linear.
        chains: independent ones; each begins hot.
        seed: of the random numbers.
        found: the last snapshot of ``posterior`` for this log and these settings; None: it is searched for.
    """
    require_alpha(alpha)
    for name, number in (("num_samples", num_samples), ("chains", chains)):
        if number != int(number) or number < 1:
            raise ValueError(f"{name}: expected a positive integer, got {number}")
    if log.num_observations == 0:
        raise ValueError("log: expected at least one observation, got none")
    if found is None:
        *_, found = posterior(log, alpha, area=area, starts=starts, seed=seed)
    ordered, back = in_time(log)
    model, state = whole_tracklets(ordered, found.labels[np.argsort(back)], found, alpha, area)
    samples = sample_around(model, state, num_samples, chains, seed)
    return replace(samples, tracklet=samples.tracklet[back])


def whole_tracklets(
    log: RobotLog, labels: np.ndarray, found: Snapshot, alpha: float, area: float | None
) -> tuple[Model, State]:
    """What is sampled: the tracklets, in the pieces of which the best partition is made, without misfits.

    Args:
        log: in time.
        labels: (M,) of its observations, -1 = of none.
        found: whose trajectory is taken.
        alpha: concentration of the Dirichlet process.
        area: m^2, as in ``start_model``.
    """
    start, graph = start_model(log, alpha, area)
    used, graph = (start.tracklet >= 0) & (labels >= 0), replace(graph, poses=found.graph.poses)
    model, state = _in_pieces(start, graph, labels, used)
    misfits = np.isin(model.tracklet, _misfits(model, state))
    return _in_pieces(start, graph, labels, used & ~misfits) if misfits.any() else (model, state)


def _in_pieces(model: Model, graph: PoseGraph, labels: np.ndarray, used: np.ndarray) -> tuple[Model, State]:
    """Tracklets cut by labels (M,), of the observations in use (M,) alone, and their partition with its solution."""
    piece = in_order_of_sight(np.column_stack([model.tracklet, labels]), used)
    model, graph = tied_anew(model, graph, piece)
    of_piece = in_order_of_sight(labels[first_observations(piece)])
    graph, chi2 = solved(model, graph, of_piece, steps=20)
    return model, State(1.0, of_piece, graph, math.nan, chi2, chi2)


def _misfits(model: Model, state: State) -> np.ndarray:
    """Tracklets that the linear model would not leave in the object where they are."""
    sampler = GibbsSampler(model.evidence(reduced_system(state.graph)), state.labels, np.random.default_rng(0))
    gain = []
    for tracklet in range(len(state.labels)):
        before = sampler.saved()
        sampler.split_off(tracklet)
        gain.append(sampler.log_posterior - before[-1])
        sampler.restore(before)
    return np.flatnonzero(np.array(gain) > MARGIN)


def sample_around(model: Model, state: State, num_samples: int, chains: int, seed: int) -> PosteriorSamples:
    """Sample partitions of the tracklets of a model, linear around a state.

    Args:
        model: with N tracklets.
        state: its best partition.
        num_samples: of all chains together.
        chains: how many.
        seed: of the random numbers.
    """
    evidence, length = model.evidence(reduced_system(state.graph)), -(-num_samples // chains)
    kept = np.empty((chains, length, len(state.labels)), dtype=int)
    log_posterior = np.empty((chains, length))
    for chain in track(range(chains), chains, "posterior", "chains"):
        sampler = GibbsSampler(evidence, state.labels, np.random.default_rng([seed, chain, length]))
        for temperature in (*HOT, *np.ones(int(WARM_UP * length) + 1)):
            _move(sampler, temperature)
        for k in range(length):
            _move(sampler, 1.0)
            kept[chain, k], log_posterior[chain, k] = sampler.labels, sampler.log_posterior
    at_best = GibbsSampler(evidence, state.labels, np.random.default_rng(seed))
    at_best = at_best.joint
    return PosteriorSamples(model.tracklet, kept, log_posterior, state.labels, at_best.mean.reshape(-1, 2), at_best.own)


def _move(sampler: GibbsSampler, temperature: float) -> None:
    sampler.sweep(temperature)
    for _ in range(min(PROPOSALS, len(sampler.slot))):
        split_or_merge(sampler, temperature)
