"""The paper's method: alternate a Dirichlet-process association with a pose-graph solve (paper algorithm 1).

The defaults are those of the authors' published script, so that ``np_graph(log)`` is the paper.
"""

from collections.abc import Iterator

import numpy as np

from npslam_teach import se2
from npslam_teach.associate import PAPER_ALPHA, PAPER_KERNEL_STD, require_rule, sweep, without_empty_objects
from npslam_teach.data import RobotLog, Snapshot
from npslam_teach.dirichlet import false_positives
from npslam_teach.methods.common import (
    PAPER_OBSERVATION_STD,
    PAPER_ODOMETRY_STD,
    reassociated,
    snapshot,
    start,
)
from npslam_teach.pose_graph import optimize


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
) -> Iterator[Snapshot]:
    """Find associations, number of objects, map and trajectory together.

    Args:
        log: what the robot measured.
        alpha: concentration of the Dirichlet process, the weight of a new object.
        threshold: None: the most probable object wins (the authors' rule). A number: the deck's threshold.
        iterations: at most so many alternations; fewer when no label changes any more.
        kernel_std: m, the width of the association kernel.
        order: of the visits in a sweep, see ``associate.sweep``.
        odometry_std: (3,) m, m, rad: what the solver assumes per step.
        observation_std: (2,) m: what the solver assumes per observation.
        area: m^2, for the objective only.
        false_positive_threshold: epsilon; 0.5, the authors' simulation, keeps every object (see
            ``dirichlet.false_positives``).

    Yields:
        the frame-by-frame start, then one snapshot per alternation, and one more if false positives were removed (its
        chi2 and objective are of the observations that remain).
    """
    require_rule(alpha, threshold, kernel_std)
    _require_settings(iterations, area, false_positive_threshold)
    current = start(log, odometry_std, observation_std, alpha, area)
    yield current
    for iteration in range(1, int(iterations) + 1):
        # Half a step: who is who, the trajectory and the map held still.
        labels, landmarks = current.labels, current.graph.landmarks
        obs_xy_world = se2.transform_to(current.graph.poses[log.obs_time], log.obs_xy)
        association = sweep(labels, landmarks, obs_xy_world, log.obs_class, alpha, threshold, kernel_std, order)
        # The other half: where everything is, the associations held still.
        graph = optimize(reassociated(log, current.graph, association, observation_std))
        current = snapshot(log, iteration, association.labels, graph, alpha, area)
        yield current
        if _same_partition(labels, association.labels):
            break
    rejected = false_positives(current.votes, false_positive_threshold)
    if rejected.any():
        yield _without_objects(log, current, rejected, observation_std, alpha, area)


def _without_objects(log, current, rejected, observation_std, alpha, area) -> Snapshot:
    """Take away rejected objects (K,) bool with their observations, and solve once more."""
    labels = np.where(rejected[current.labels], -1, current.labels)
    kept = without_empty_objects(labels, current.graph.landmarks)
    graph = optimize(reassociated(log, current.graph, kept, observation_std))
    return snapshot(log, current.iteration + 1, kept.labels, graph, alpha, area)


def _same_partition(labels: np.ndarray, other_labels: np.ndarray) -> bool:
    """Whether two labelings group the observations alike, whatever the objects are called."""
    pairs = np.unique(labels * (other_labels.max(initial=0) + 1) + other_labels)
    return len(pairs) == len(np.unique(labels)) == len(np.unique(other_labels))


def _require_settings(iterations, area, false_positive_threshold) -> None:
    if iterations != int(iterations) or iterations < 0:
        raise ValueError(f"iterations: expected a non-negative integer, got {iterations}")
    if not 0 < area < float("inf"):
        raise ValueError(f"area: expected a positive number of square metres, got {area}")
    if not 0 <= false_positive_threshold <= 1:
        raise ValueError(f"false_positive_threshold: expected a probability in [0, 1], got {false_positive_threshold}")
