"""The Dirichlet process done in full: the most probable partition, the trajectory and the map integrated out.

The paper holds trajectory and map still while it asks who is who, so that its kernel must be as wide as the drift
is long. Here every question is asked with all that the measurements say at once: how far two passes over an object lie
apart, and how far drift may have carried them apart. It has no kernel and no threshold.

1. ``tracklets``: the observations of one pass over one object.
2. ``pose_graph.reduced_system``: chi2 as a quadratic form in the positions of the tracklets, all poses eliminated.
3. ``annealing``: Gibbs moves and split-merge moves (``association.gibbs``), from hot to cold, along the path while it
   is hot or all at once; until two searches have found the same.
   Headings count object by object: how well those of its tracklets agree, the error of the robot's own heading being
   the random walk of the odometry (``oriented.ChainHeadings``); trajectory and map are of positions until the end,
   and so is what ``refinement`` looks at.
4. ``refinement``: tracklets and observations looked at again with the whole map at hand, and those that were left out;
   what is in view stays in view (``persistence``), but in its place may come another (``change_points``).
   For logs of few observations ``polish`` instead: every near rival judged around its own solution.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from npslam_teach.association import require_alpha, require_area
from npslam_teach.methods.annealing import WAYS, Model, State, rivals_of, searched
from npslam_teach.methods.noise import with_noise
from npslam_teach.methods.oriented import ChainHeadings, without_headings
from npslam_teach.methods.partition_score import without_displaced
from npslam_teach.methods.polish import polished
from npslam_teach.methods.refinement import refined
from npslam_teach.methods.repair import confirmed
from npslam_teach.methods.snapshots import initial_snapshot, snapshot
from npslam_teach.methods.tracklets import tied_both_ways
from npslam_teach.pose_graph import fit, with_associations
from npslam_teach.system.progress import track
from npslam_teach.types import PoseGraph, RobotLog, Snapshot

FEW = 64  # observations, up to which each is its own tracklet
SAME = 1e-3  # of the log posterior: two starts have found the same


def posterior(
    log: RobotLog,
    alpha: float = 1.0,
    *,
    area: float | None = None,
    starts: int = 6,
    odometry_std=None,
    observation_std=None,
    seed: int = 0,
) -> Iterator[Snapshot]:
    """Find the most probable partition of the observations, and with it map and trajectory.

    Args:
        log: what the robot measured.
        alpha: concentration of the Dirichlet process.
        area: m^2 over which objects are uniform; None: the box around all that was seen.
        starts: at most so many searches from the beginning; fewer when the best has been found twice.
        odometry_std: (3,) m, m, rad per step; None: what the log says.
        observation_std: (2,) m; None: what the log says.
        seed: of the random numbers.

    Yields:
        the frame-by-frame start; the tracklets; the best after every search; the result. An observation that fits no
        object and makes none (no other is near it) has label -1, but for logs of few observations.
    """
    require_alpha(alpha)
    if starts != int(starts) or starts < 1:
        raise ValueError(f"starts: expected a positive integer, got {starts}")
    if area is not None:
        require_area(area)
    log = with_noise(log, odometry_std, observation_std)
    yield initial_snapshot(log)
    if log.num_observations == 0:
        return
    # The order of the lines in a file says nothing; the same log gives the same answer in any order.
    ordered, back = in_time(log)
    for iteration, (labels, graph) in enumerate(_search(ordered, alpha, area, int(starts), seed), 1):
        graph = with_associations(log, graph, labels[back], graph.landmarks)
        yield snapshot(log, iteration, labels[back], graph)


def start_model(log: RobotLog, alpha: float = 1.0, area: float | None = None) -> tuple[Model, PoseGraph]:
    """The tracklets of a log and how they tie its trajectory together, before any two of them are one object.

    Args:
        log: at least one observation.
        alpha: concentration of the Dirichlet process.
        area: m^2 over which objects are uniform; None: of ``box_area``.

    Returns:
        the model; the graph with one landmark for every tracklet, solved.
    """
    few = log.num_observations <= FEW
    tracklet = np.arange(log.num_observations) if few else tied_both_ways(log)
    headings, log = ChainHeadings.of_log(log), without_headings(log)
    graph = fit(log, tracklet)
    area = box_area(graph) if area is None else area
    return Model(log, tracklet, rivals_of(log, tracklet), alpha, area, headings), graph


def box_area(graph: PoseGraph) -> float:
    """The area in m^2 of the box around path and landmarks; of a line, that of the square above it."""
    return area_around(np.concatenate([graph.poses[:, :2], graph.landmark_xy]))


def area_around(places: np.ndarray) -> float:
    """The area in m^2 of the box around places (N, 2) m; of a line, that of the square above it; of a point 1."""
    width, height = np.sort(np.ptp(places, axis=0))[::-1]
    return float(width * (height if height > 1e-3 * width else width)) or 1.0


def best_of_starts(model: Model, graph: PoseGraph, starts: int, seed) -> Iterator[State]:
    """The best partition after each of several searches; they end when the best has been found twice."""
    best, found = None, 0
    for start in range(starts):
        rng = np.random.default_rng([*seed, start])
        last = searched(model, graph, WAYS[start % len(WAYS)], rng)
        if best is None or last.log_posterior > best.log_posterior + SAME:
            best, found = last, 1
        elif last.log_posterior > best.log_posterior - SAME:
            found += 1
        yield best
        if found == 2:
            return


def _search(log: RobotLog, alpha: float, area: float | None, starts: int, seed: int):
    """Labels (M,) and the graph with one landmark for each object: of the tracklets, after every search, at the end."""
    model, graph = start_model(log, alpha, area)
    yield model.tracklet, graph
    for state in track(best_of_starts(model, graph, starts, (seed,)), starts, "posterior", "searches"):
        labels = model.of_observations(state.labels)
        yield labels, fit(log, labels, state.graph.poses)
    if log.num_observations <= FEW:
        best = polished(model, state)
        labels, graph = model.of_observations(best.labels), best.graph
    else:
        labels, graph, _ = refined(model, state, np.random.default_rng([seed, starts]))
        labels = confirmed(log, graph, without_displaced(model, labels, graph), model.tracklet)
    yield labels, fit(log, labels, graph.poses)


def in_time(log: RobotLog) -> tuple[RobotLog, np.ndarray]:
    """The log with its observations in the order of the poses, in a frame by place; (M,) the way back."""
    order = np.lexsort((log.obs_xy[:, 1], log.obs_xy[:, 0], log.obs_time))
    fields = {name: getattr(log, name)[order] for name in ("obs_time", "obs_xy", "obs_class")}
    optional = {name: getattr(log, name) for name in ("observation_cov", "class_probabilities", "obs_theta")}
    fields |= {name: values[order] for name, values in optional.items() if values is not None}
    return replace(log, **fields), np.argsort(order)
