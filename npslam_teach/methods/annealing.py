"""Which tracklets are of one object: the search for the best partition, hot first and then ever colder.

At a high temperature tracklets change their object freely; as it falls the moves that lower the posterior die out.
After every sweep the pose graph is solved for the partition found and linearized anew, because a linear model is good
only near the trajectory around which it was made.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from npslam_teach import se2
from npslam_teach.association import first_observations
from npslam_teach.association.gibbs import GibbsSampler
from npslam_teach.association.partition_posterior import TrackletEvidence
from npslam_teach.association.semantics import combined, floored, reports
from npslam_teach.association.split_merge import merge_objects, split_or_merge
from npslam_teach.methods.gating import seen_together
from npslam_teach.methods.oriented import ChainHeadings
from npslam_teach.pose_graph import levenberg_marquardt, mean_landmarks, observation_factors
from npslam_teach.pose_graph.reduced_system import ReducedSystem, reduced_system
from npslam_teach.types import PoseGraph, RobotLog

TEMPERATURES = tuple(np.geomspace(8.0, 0.05, 13))
PROPOSALS = 20  # to split or to merge, after every sweep
COLD, SETTLING_ROUNDS = 0.01, 10
# In how many stretches of the path, one after the other, a search begins; 1: with the whole, and hotter. What one way
# does not find another may.
WAYS = (8, 1, 16)
HOT = tuple(np.geomspace(20.0, 0.05, 20))


class Model(NamedTuple):
    """What does not change while partitions do: the tracklets and the prior."""

    log: RobotLog
    tracklet: np.ndarray  # (M,) of each observation, -1 = of none
    rivals: np.ndarray  # (N, N) bool, pairs that cannot be one object
    alpha: float
    area: float  # m^2
    headings: ChainHeadings | None = None  # of the observations, where they have any; the log is without

    def evidence(self, reduced: ReducedSystem) -> TrackletEvidence:
        """The linear model, with the prior."""
        parts = {"constant": reduced.constant, "vector": reduced.vector, "information": reduced.information}
        return self.prior()._replace(**parts)

    def prior(self) -> TrackletEvidence:
        """What is known beside the places."""
        counts = np.bincount(self.tracklet[self.tracklet >= 0], minlength=len(self.rivals))
        seen = None if self.log.class_probabilities is None else floored(reports_of(self.log, self.tracklet))
        facing = None if self.headings is None else self.headings.of_tracklets(self.tracklet)
        nothing = 0.0, np.zeros(0), np.zeros((0, 0))
        return TrackletEvidence(*nothing, counts, self.rivals, self.alpha, self.area, seen, facing)

    def of_observations(self, labels: np.ndarray) -> np.ndarray:
        """The object of each observation (M,), -1 = none, from that of each tracklet (N,)."""
        return np.append(labels, -1)[self.tracklet]


class State(NamedTuple):
    """A partition, and the trajectory and the map that it makes most probable."""

    temperature: float
    labels: np.ndarray  # (N,) the object of each tracklet
    graph: PoseGraph  # one landmark for every tracklet; those of one object coincide
    log_posterior: float
    linear_chi2: float  # of the model that the sampler saw
    chi2: float  # of the graph


def anneal(
    model: Model, graph: PoseGraph, labels: np.ndarray, temperatures, rng: np.random.Generator
) -> Iterator[State]:
    """One state for every temperature.

    Args:
        model: with N tracklets.
        graph: around which to linearize first; one landmark for every tracklet.
        labels: (N,) the partition to begin with.
        temperatures: one sweep for each.
        rng: the generator.
    """
    for temperature in temperatures:
        reduced = reduced_system(graph)
        sampler = GibbsSampler(model.evidence(reduced), labels, rng)
        sampler.sweep(temperature)
        for _ in range(PROPOSALS):
            split_or_merge(sampler, temperature)
        if temperature <= COLD:
            merge_objects(sampler)
        labels, linear_chi2 = sampler.labels, reduced.chi2(sampler.positions)
        graph, chi2 = solved(model, reduced.graph_at(sampler.positions), labels)
        yield State(temperature, labels, graph, sampler.log_posterior, linear_chi2, chi2)


def searched(model: Model, graph: PoseGraph, stretches: int, rng: np.random.Generator) -> State:
    """What a search from the beginning comes to, in which no two tracklets are one object.

    Args:
        model: with N tracklets, in the order of first sight.
        graph: around which to linearize first; one landmark for every tracklet.
        stretches: one of ``WAYS``.
        rng: the generator.
    """
    if stretches == 1:
        *_, state = anneal(model, graph, np.arange(len(model.rivals)), HOT, rng)
    else:
        begun = grown(model, graph, stretches, rng)
        *_, state = anneal(model, begun.graph, begun.labels, TEMPERATURES[1:], rng)
    return settled(model, state, rng)


def grown(model: Model, graph: PoseGraph, stretches: int, rng: np.random.Generator) -> State:
    """A partition that is found stretch by stretch of the path, hot, each around the trajectory mended so far.

    Open-loop the trajectory may be far off where a loop closes, and a linear model around it wrong. What a stretch has
    closed corrects all that follows.

    Args:
        model: with N tracklets, in the order of first sight.
        graph: around which to linearize first.
        stretches: of the path, one after the other.
        rng: the generator.
    """
    begins, labels = model.log.obs_time[first_observations(model.tracklet)], np.zeros(0, dtype=int)
    ends = np.linspace(begins[0], begins[-1], stretches + 1)[1:]
    for count in np.unique(np.searchsorted(begins, ends, side="right")).tolist():
        part, graph = tied_anew(model, graph, np.where(model.tracklet < count, model.tracklet, -1))
        new = np.arange(count - len(labels)) + labels.max(initial=-1) + 1
        *_, state = anneal(part, graph, np.append(labels, new), TEMPERATURES[1:2], rng)
        labels, graph = state.labels, state.graph
    return state


def settled(model: Model, state: State, rng: np.random.Generator) -> State:
    """Cold sweeps until no label changes and the linear model says of chi2 what the solver says."""
    for _ in range(SETTLING_ROUNDS):
        before = state
        (state,) = anneal(model, before.graph, before.labels, (COLD,), rng)
        same = np.array_equal(before.labels, state.labels)
        if same and abs(state.linear_chi2 - state.chi2) <= 1e-3 * (1.0 + state.chi2):
            break
    return state


def tied_anew(model: Model, graph: PoseGraph, tracklet: np.ndarray) -> tuple[Model, PoseGraph]:
    """The model with other tracklets, and the graph with a landmark for each where it was seen.

    Args:
        model: the log and the prior.
        graph: the trajectory, and the factors of the odometry.
        tracklet: (M,) of each observation, from 0 without gaps; -1 = of none.
    """
    log, places = model.log, se2.apply(graph.poses[model.log.obs_time], model.log.obs_xy)
    factors = observation_factors(log, tracklet)
    graph = replace(graph, landmarks=mean_landmarks(tracklet, places), observations=factors)
    return model._replace(tracklet=tracklet, rivals=rivals_of(log, tracklet)), graph


def solved(model: Model, graph: PoseGraph, labels: np.ndarray, steps: int = 2) -> tuple[PoseGraph, float]:
    """A few steps of the solver for a partition; the graph keeps one landmark for every tracklet. And its chi2."""
    first = first_observations(labels)
    factors = observation_factors(model.log, model.of_observations(labels))
    joined = replace(graph, landmarks=graph.landmarks[first], observations=factors)
    *_, last = levenberg_marquardt(joined, max_iterations=steps)
    return replace(graph, poses=last.graph.poses, landmarks=last.graph.landmarks[labels]), last.chi2


def reports_of(log: RobotLog, tracklet: np.ndarray) -> np.ndarray:
    """What the observations of each tracklet say of its class together: logarithms (N, C), -inf where none may be.

    Args:
        log: what was measured.
        tracklet: (M,) of each observation, -1 = of none.
    """
    used = np.flatnonzero(tracklet >= 0)
    return combined(reports(log)[used], tracklet[used], tracklet.max(initial=-1) + 1)


def rivals_of(log: RobotLog, tracklet: np.ndarray) -> np.ndarray:
    """Pairs of tracklets that cannot be one object, (N, N) bool: no class allows both, or seen in one frame."""
    allowed = np.isfinite(reports_of(log, tracklet)).astype(float)
    rivals = allowed @ allowed.T == 0
    np.fill_diagonal(rivals, False)
    return rivals | seen_together(log, tracklet, len(rivals))
