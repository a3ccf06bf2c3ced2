"""The paper's method: alternate a Dirichlet-process association with a pose-graph solve (paper algorithm 1).

The defaults are those of the authors' published script, so that ``np_graph(log)`` is the paper.
"""

from collections.abc import Iterator

import numpy as np

from npslam_teach import se2
from npslam_teach.association import (
    PAPER_ALPHA,
    PAPER_KERNEL_STD,
    exclusive_sweep,
    false_positives,
    require_area,
    require_rule,
    same_partition,
    sweep,
    without_empty_objects,
)
from npslam_teach.methods.oriented import kernel_heading_std, seen_headings
from npslam_teach.methods.snapshots import PAPER_OBSERVATION_STD, PAPER_ODOMETRY_STD, initial_snapshot, snapshot
from npslam_teach.pose_graph import optimize, with_associations
from npslam_teach.types import PoseGraph, RobotLog, Snapshot

CONSISTENT_STD = (PAPER_KERNEL_STD, PAPER_KERNEL_STD)  # m, of the solver, with which both halves lower one number


def np_graph(
    log: RobotLog,
    alpha: float = PAPER_ALPHA,
    threshold: float | None = None,
    iterations: int = 5,
    *,
    kernel_std: float = PAPER_KERNEL_STD,
    order: str | np.ndarray = "last-to-first",
    odometry_std=PAPER_ODOMETRY_STD,
    observation_std=PAPER_OBSERVATION_STD,
    area: float = 1.0,
    false_positive_threshold: float = 0.5,
    exclusive: bool = False,
    heading_std: float | None = None,
) -> Iterator[Snapshot]:
    """Find associations, number of objects, map and trajectory together.

    Args:
        log: what the robot measured.
        alpha: concentration of the Dirichlet process, the weight of a new object.
        threshold: None: the most probable object wins (the authors' rule). A number: the deck's threshold.
        iterations: at most so many alternations; fewer when no label changes any more.
        kernel_std: m, the width of the association kernel.
        order: of the visits in a sweep, see ``association.sweep``.
        odometry_std: (3,) m, m, rad: what the solver assumes per step.
        observation_std: (2,) m: what the solver assumes per observation.
        area: m^2, for the objective only.
        false_positive_threshold: epsilon; 0.5, the authors' simulation, keeps every object (see
            ``association.false_positives``).
        exclusive: whether two observations of one frame are always of two objects; the paper's rule is without.
        heading_std: rad, of a log with headings: the width of their kernel, and what the solver assumes of one. None:
            as many standard deviations of the sensor as the paper's kernel has (``oriented.KERNEL_WIDTHS``).

    Yields:
        the frame-by-frame start, then one snapshot per alternation, and one more if false positives were removed (its
        chi2 and objective are of the observations that remain).
    """
    require_rule(alpha, threshold, kernel_std)
    _require_settings(iterations, area, false_positive_threshold)
    heading_std = kernel_heading_std(log, heading_std)
    rule = alpha, threshold, kernel_std, order, observation_std, exclusive, heading_std
    current = initial_snapshot(log, odometry_std, observation_std, alpha, area, heading_std)
    yield current
    for iteration in range(1, int(iterations) + 1):
        # Half a step: who is who, the trajectory and the map held still.
        labels, graph = associate_anew(log, current, *rule)
        # The other half: where everything is, the associations held still.
        same = same_partition(current.labels, labels)
        current = snapshot(log, iteration, labels, optimize(graph), alpha, area)
        yield current
        if same:
            break
    rejected = false_positives(current.votes, false_positive_threshold)
    if rejected.any():
        yield _without_objects(log, current, rejected, (observation_std, heading_std), alpha, area)


def associate_anew(
    log: RobotLog,
    current: Snapshot,
    alpha: float = PAPER_ALPHA,
    threshold: float | None = None,
    kernel_std: float = PAPER_KERNEL_STD,
    order: str | np.ndarray = "last-to-first",
    observation_std=PAPER_OBSERVATION_STD,
    exclusive: bool = False,
    heading_std: float | None = None,
) -> tuple[np.ndarray, PoseGraph]:
    """The first half of an alternation: one sweep, the trajectory and the map held still.

    Args: as in ``np_graph``, and the snapshot to start from.

    Returns:
        (M,) labels, and the graph tied to them that the second half is to solve.
    """
    obs_xy_world = se2.apply(current.graph.poses[log.obs_time], log.obs_xy)
    heading_std = kernel_heading_std(log, heading_std)
    present = current.labels, current.graph.landmarks, obs_xy_world, log.obs_class
    rule = alpha, threshold, kernel_std, order, seen_headings(log, current.graph.poses, heading_std)
    found = exclusive_sweep(*present, log.obs_time, *rule) if exclusive else sweep(*present, *rule)
    tied = found.labels, found.landmarks, observation_std, heading_std
    return found.labels, with_associations(log, current.graph, *tied)


def half_steps(
    log: RobotLog,
    alpha: float = PAPER_ALPHA,
    observation_std=CONSISTENT_STD,
    rounds: int = 10,
    odometry_std=PAPER_ODOMETRY_STD,
) -> list[Snapshot]:
    """The alternation as a descent (lesson 06): the start, then two snapshots a round, after sweep and after solver.

    Both halves lower one number, ``association.objective``, as long as the solver assumes of an observation what the
    kernel of the sweep assumes; ``observation_std`` is by default that.

    Args:
        log: what the robot measured.
        alpha: concentration.
        observation_std: (2,) m, what the solver assumes per observation.
        rounds: at most so many; fewer when no label changes any more.
        odometry_std: (3,) m, m, rad, and per step.

    Returns:
        1 + 2 * rounds snapshots or fewer; their iterations count half-steps.
    """
    heading_std = kernel_heading_std(log, None)
    snapshots = [initial_snapshot(log, odometry_std, observation_std, alpha, heading_std=heading_std)]
    for half_step in range(1, 2 * rounds + 1, 2):
        before = snapshots[-1]
        labels, graph = associate_anew(log, before, alpha, observation_std=observation_std)
        snapshots.append(snapshot(log, half_step, labels, graph, alpha))
        snapshots.append(snapshot(log, half_step + 1, labels, optimize(graph), alpha))
        if np.array_equal(before.labels, labels):
            break
    return snapshots


def _without_objects(log, current, rejected, stds, alpha, area) -> Snapshot:
    """Take away rejected objects (K,) bool with their observations, and solve once more."""
    labels = np.where(rejected[current.labels], -1, current.labels)
    kept = without_empty_objects(labels, current.graph.landmarks)
    graph = optimize(with_associations(log, current.graph, kept.labels, kept.landmarks, *stds))
    return snapshot(log, current.iteration + 1, kept.labels, graph, alpha, area)


def _require_settings(iterations, area, false_positive_threshold) -> None:
    if iterations != int(iterations) or iterations < 0:
        raise ValueError(f"iterations: expected a non-negative integer, got {iterations}")
    require_area(area)
    if not 0 <= false_positive_threshold <= 1:
        raise ValueError(f"false_positive_threshold: expected a probability in [0, 1], got {false_positive_threshold}")
