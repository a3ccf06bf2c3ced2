"""EKF-SLAM: decide for every frame which observation is of which object, update, and never look back.

An observation fits an object when the distance between where it is and where it was expected is small for the
covariance of that difference (Mahalanobis distance, gates by chi-squared). Unlike the paper's method, the filter is
given the sensor's own noise, and it never revises a decision.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from npslam_teach.association import in_order_of_sight
from npslam_teach.association.semantics import class_distances, reports, updated_belief
from npslam_teach.methods.block_filter import Belief
from npslam_teach.methods.gating import GATE, NEW, NEW_GATE, UNASSIGNED, assign, frames_of, squared_gates
from npslam_teach.methods.noise import step_covariances, with_noise
from npslam_teach.methods.oriented import sights
from npslam_teach.methods.snapshots import initial_snapshot, snapshot
from npslam_teach.pose_graph import heading_factors, observation_factors, odometry_factors, symmetries
from npslam_teach.system.progress import track
from npslam_teach.types import PoseGraph, RobotLog, Snapshot
from npslam_teach.validation import checked_array


@dataclass(frozen=True, eq=False)
class FilterStep:
    """One frame: what the filter expected, what was decided, and its posterior. K objects were known."""

    time: int
    observations: np.ndarray  # (m,) indices into the log
    prior_mean: np.ndarray  # (3 + 2K,) before the observations; (3 + 3K,) with headings
    prior_cov: np.ndarray  # (3 + 2K, 3 + 2K)
    object_class: np.ndarray  # (K,) of the objects known before, the most probable
    squared_distance: np.ndarray  # (m, K) Mahalanobis, squared, and of the classes; infinite where these rule it out
    decision: np.ndarray  # (m,) the object, UNASSIGNED or NEW
    labels: np.ndarray  # (m,) the same with the new objects numbered
    nis: float  # y^T S^-1 y of all matches together; NaN without any
    mean: np.ndarray  # (n,) after the observations, new objects included
    cov: np.ndarray  # (n, n)


@dataclass(frozen=True, eq=False)
class FilterRecord:
    """A whole run of the filter."""

    poses: np.ndarray  # (T, 3) W, each as it was filtered at its own time, and never corrected after
    pose_cov: np.ndarray  # (T, 3, 3)
    labels: np.ndarray  # (M,) the object, -1 = left out
    landmarks: np.ndarray  # (K, 2) m, W, at the end; (K, 3) with headings
    landmark_cov: np.ndarray  # (K, 2, 2) m^2, at the end; (K, 3, 3) with headings
    squared_distance: np.ndarray  # (M,) Mahalanobis, to the matched object; NaN for new ones and those left out
    nis: np.ndarray  # (T,) y^T S^-1 y of all matches of a frame together; NaN without any
    nis_dof: np.ndarray  # (T,) how many numbers y holds: two for every match, three with a heading


def ekf_slam(
    log: RobotLog, gate: float = GATE, new_gate: float = NEW_GATE, *, odometry_std=None, observation_std=None
) -> Iterator[Snapshot]:
    """Filter the log once, from the first frame to the last.

    Every frame is matched with the objects known so far. A pair must be of one class and within the gate, and no two
    observations share an object; the sum of squared Mahalanobis distances is least, where an observation without an
    object costs as much as one at the gate. An observation outside the second gate of every object of its class becomes
    a new object. One in between is left out: either answer would be a guess, and a guess cannot be taken back. Where
    the log has class probabilities, classes that agree less well add to the distance (``association.semantics``). Where
    it has headings, an object has three numbers, and the gates are of position and heading together.

    Args:
        log: what the robot measured.
        gate: the share of right matches that passes the gate (chi-squared, 2 degrees of freedom).
        new_gate: the same for the second gate; not below ``gate``.
        odometry_std: (3,) m, m, rad: what the filter assumes per step; None: what the log says.
        observation_std: (2,) m: what it assumes per observation; None: what the log says.

    Yields:
        the frame-by-frame start, and the result: every pose as it was filtered at its own time, the objects as they are
        at the end. Observations that were left out have label -1. Its chi2 is large, because such a path jumps wherever
        the filter corrected itself; ``pose_graph.fit`` with its labels smooths it.
    """
    log = with_noise(log, odometry_std, observation_std)
    squared_gates(gate, new_gate)
    yield initial_snapshot(log)
    record = run_filter(log, gate, new_gate)
    factors = odometry_factors(log), observation_factors(log, record.labels)
    headings = heading_factors(log, record.labels)
    graph = PoseGraph(record.poses, record.landmarks, *factors, headings=headings)
    yield snapshot(log, 1, record.labels, graph)


def run_filter(log: RobotLog, gate: float = GATE, new_gate: float = NEW_GATE, **settings) -> FilterRecord:
    """Run the filter over a whole log, and keep its posterior of every pose.

    Args: as in ``filter_steps``.
    """
    labels, distance = np.full(log.num_observations, UNASSIGNED), np.full(log.num_observations, np.nan)
    poses, pose_cov = np.empty((log.num_poses, 3)), np.empty((log.num_poses, 3, 3))
    nis, nis_dof = np.full(log.num_poses, np.nan), np.zeros(log.num_poses, dtype=int)
    steps, told = filter_steps(log, gate, new_gate, **settings), symmetries(log) > 0
    for step in track(steps, log.num_poses, "ekf", "frames"):
        t, matched = step.time, np.flatnonzero(step.decision >= 0)
        labels[step.observations] = step.labels
        distance[step.observations[matched]] = step.squared_distance[matched, step.decision[matched]]
        poses[t], pose_cov[t] = step.mean[:3], step.cov[:3, :3]
        nis[t], nis_dof[t] = step.nis, 2 * len(matched) + np.count_nonzero(told[step.observations[matched]])
    of_object = 3 + np.arange(len(step.mean) - 3).reshape(-1, 2 if log.obs_theta is None else 3)
    landmark_cov = step.cov[of_object[:, :, None], of_object[:, None, :]]
    return FilterRecord(poses, pose_cov, labels, step.mean[of_object], landmark_cov, distance, nis, nis_dof)


def filter_steps(
    log: RobotLog,
    gate: float = GATE,
    new_gate: float = NEW_GATE,
    *,
    odometry_std=None,
    observation_std=None,
    labels: np.ndarray | None = None,
) -> Iterator[FilterStep]:
    """Run the filter frame by frame.

    Args:
        log: what the robot measured.
        gate: see ``ekf_slam``; so are ``new_gate`` and the standard deviations.
        new_gate: the second gate.
        odometry_std: (3,) m, m, rad.
        observation_std: (2,) m.
        labels: (M,) the object of each observation, given instead of decided by gates and classes; -1 leaves one
            out. No object may appear twice in one frame. The filter numbers objects in the order in which it first
            sees them.

    Yields:
        one step for every pose.
    """
    log = with_noise(log, odometry_std, observation_std)
    step_cov, (sight, sight_cov), symmetry = step_covariances(log), sights(log), symmetries(log)
    bounds, frames = squared_gates(gate, new_gate), frames_of(log)
    known_labels = None if labels is None else _in_order_of_sight(labels, frames)
    seen_all, belief, classes = reports(log), Belief.at_origin(sight.shape[1]), np.zeros((0, log.num_classes))
    for time, observations in enumerate(frames):
        if time > 0:
            belief = belief.predicted(log.odometry[time - 1], step_cov[time - 1])
        if len(observations) == 0:
            yield _nothing_seen(time, belief, classes)
            continue
        prior, seen = belief, seen_all[observations]
        fed = sight[observations], sight_cov[observations], symmetry[observations]
        distance = prior.squared_distances(*fed)
        if known_labels is None:
            distance = distance + class_distances(seen, classes)
            decision = assign(distance, *bounds)
        else:
            decision = np.where(known_labels[observations] < len(classes), known_labels[observations], NEW)
        is_new = decision == NEW
        numbered = np.where(is_new, len(classes) + np.cumsum(is_new) - 1, decision)
        belief, nis = _absorb(prior, decision, *fed)
        before, after = (prior.mean, prior.cov), (belief.mean, belief.cov)
        yield FilterStep(time, observations, *before, classes.argmax(axis=1), distance, decision, numbered, nis, *after)
        classes = _classes_after(classes, decision, seen, known_labels is not None)


def _nothing_seen(time: int, belief: Belief, classes: np.ndarray) -> FilterStep:
    """A frame without observations: long logs have many, and they need no matching."""
    none, state = np.zeros(0, dtype=int), (belief.mean, belief.cov)
    distance = np.zeros((0, len(classes)))
    return FilterStep(time, none, *state, classes.argmax(axis=1), distance, none, none, math.nan, *state)


def _classes_after(classes: np.ndarray, decision: np.ndarray, seen: np.ndarray, is_given: bool) -> np.ndarray:
    """What the objects are (logarithms) after the observations of a frame, new objects included."""
    matched, is_new = decision >= 0, decision == NEW
    if not is_given:  # given labels may contradict the classes
        classes = classes.copy()
        classes[decision[matched]] = updated_belief(classes[decision[matched]], seen[matched])
    return np.append(classes, updated_belief(np.zeros_like(seen[is_new]), seen[is_new]), axis=0)


def _absorb(belief: Belief, decision: np.ndarray, *fed: np.ndarray) -> tuple[Belief, float]:
    """The belief after the matches and then the new objects of a frame; NIS of the matches, NaN without any."""
    matched, nis = decision >= 0, math.nan
    if matched.any():
        belief, nis = belief.updated(decision[matched], *(rows[matched] for rows in fed))
    for k in np.flatnonzero(decision == NEW):
        belief = belief.with_new_object(*(rows[k] for rows in fed))
    return belief, nis


def _in_order_of_sight(labels: np.ndarray, frames: list[np.ndarray]) -> np.ndarray:
    """The same partition (M,), its objects numbered as a filter meets them; -1 stays."""
    in_time = np.concatenate(frames)
    labels = checked_array("labels", labels, (len(in_time),), int)
    for time, observations in enumerate(frames):
        used = labels[observations][labels[observations] >= 0]
        if len(np.unique(used)) < len(used):
            raise ValueError(f"labels: expected every object at most once in a frame, got one twice at pose {time}")
    numbers = np.empty_like(labels)
    numbers[in_time] = in_order_of_sight(labels[in_time], labels[in_time] >= 0)
    return numbers
