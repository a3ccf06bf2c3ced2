"""Repair of tracklets with the whole map at hand: what was tied together too early, or left out, is looked at again."""

import numpy as np

from npslam_teach import se2
from npslam_teach.association import in_order_of_sight, one_to_one
from npslam_teach.association.semantics import beliefs, class_distances, reports
from npslam_teach.methods.gating import GATE, frames_with_observations, squared_residuals
from npslam_teach.pose_graph import squared_radius
from npslam_teach.types import PoseGraph, RobotLog

REPAIR_GATE = 0.9999  # the share of right matches that is let through: of ten thousand one is asked again


def reassigned(log: RobotLog, poses: np.ndarray, landmarks: np.ndarray, classes: np.ndarray) -> np.ndarray:
    """The object that suits each observation best, frame by frame and one to one, trajectory and map held still.

    Args:
        log: what was measured.
        poses: (T, 3) W.
        landmarks: (K, 2) m, W, of the objects.
        classes: (K, C) what they may be, logarithms of probabilities.

    Returns:
        (M,) index of the object; -1 = beyond the gate of all that are free.
    """
    labels, gate = np.full(log.num_observations, -1), squared_radius(REPAIR_GATE)
    squared = squared_residuals(log, np.arange(log.num_observations)[:, None], poses, landmarks)
    squared = squared + class_distances(reports(log), classes)
    for observations in frames_with_observations(log):
        labels[observations] = one_to_one(squared[observations], gate)
    return np.where(labels < len(classes), labels, -1)


def attached(log: RobotLog, labels: np.ndarray, poses: np.ndarray, landmarks: np.ndarray) -> np.ndarray:
    """Labels (M,) in which those that are of none go where they fit best, if their frame has not taken it.

    Args:
        log: what was measured.
        labels: (M,) index of the object, -1 = of none.
        poses: (T, 3) W.
        landmarks: (K, 2) m, W, of the objects.
    """
    seen, count = reassigned(log, poses, landmarks, classes_of(log, labels)), len(landmarks)
    taken = (log.obs_time * count + labels)[labels >= 0]
    free = (seen >= 0) & ~np.isin(log.obs_time * count + seen, taken)
    return np.where(labels >= 0, labels, np.where(free, seen, -1))


def classes_of(log: RobotLog, labels: np.ndarray) -> np.ndarray:
    """What the objects may be, by all that is reported of them: logarithms of probabilities (K, C).

    Args:
        log: what was measured.
        labels: (M,) index of the object, -1 = of none.
    """
    used = np.flatnonzero(labels >= 0)
    return beliefs(reports(log)[used], labels[used], labels.max(initial=-1) + 1)


def outlier_share(log: RobotLog, graph: PoseGraph, labels: np.ndarray) -> float:
    """The share of the observations that lie far out, beyond what a normal distribution and chance explain; 0 if none.

    Residuals are compared with their own median, so that a log that is better than it says has no outliers for that.
    An object that is seen n times takes up the share 1/n of their squares; one that is seen once says nothing.

    Args:
        log: what was measured.
        graph: one landmark for each object, solved.
        labels: (M,) index of the object; -1 = of none.
    """
    count = np.bincount(labels[labels >= 0], minlength=1)[labels]
    used = np.flatnonzero((labels >= 0) & (count > 1))
    if len(used) == 0:
        return 0.0
    squared = squared_residuals(log, used, graph.poses, graph.landmarks[labels[used]])
    squared *= count[used] / (count[used] - 1)
    typical = np.median(squared) / squared_radius(0.5)
    chance = 1 - GATE
    share = np.mean(squared > squared_radius(GATE) * typical)
    return float(share - chance) if share > chance + 3 * np.sqrt(chance * GATE / len(used)) else 0.0


def confirmed(log: RobotLog, graph: PoseGraph, labels: np.ndarray, tracklet: np.ndarray) -> np.ndarray:
    """Without objects of which fewer than two observations were ever tied or clearly new.

    An observation that was left out of the tracklets is too near to something in view to be new, and too far from it to
    be tied. It does not make an object: it goes to the nearest that is free in its frame and within the gate, or is
    clutter. So does what was seen a single time.

    Args:
        log: what was measured.
        graph: one landmark for every object of a partition that these labels coarsen or keep.
        labels: (M,) the object of each observation, -1 = of none.
        tracklet: (M,) the tracklet of each observation, -1 = left out.

    Returns:
        (M,) labels from 0 without gaps.
    """
    tied = np.bincount(labels[(tracklet >= 0) & (labels >= 0)], minlength=labels.max(initial=-1) + 1)
    kept = np.flatnonzero(tied >= 2)
    found = np.where(np.isin(labels, kept), labels, -1)
    places = se2.apply(graph.poses[log.obs_time], log.obs_xy)
    seen = reports(log)
    for k in np.flatnonzero(found < 0):
        free = kept[~np.isin(kept, found[log.obs_time == log.obs_time[k]])]
        if len(free):
            means = np.array([places[found == i].mean(axis=0) for i in free])
            off = class_distances(seen[[k]], classes_of(log, found)[free])[0]
            squared = squared_residuals(log, k, graph.poses, means) + off
            found[k] = free[squared.argmin()] if squared.min() < squared_radius(REPAIR_GATE) else -1
    return without_gaps(found)


def completed(log: RobotLog, graph: PoseGraph, labels: np.ndarray) -> np.ndarray:
    """What was left out goes to the object of the map that suits it best; what was seen a single time makes none.

    Args:
        log: what was measured.
        graph: one landmark for every object.
        labels: (M,) the object of each observation, from 0 without gaps; -1 = left out.

    Returns:
        (M,) labels from 0 without gaps; -1 = beyond the gate of all that are free in its frame.
    """
    count = labels.max(initial=-1) + 1
    kept = np.bincount(labels[labels >= 0], minlength=count) >= 2
    before, labels = labels, np.where(np.append(kept, False)[labels], labels, -1)
    left = np.flatnonzero(labels < 0)
    if not kept.any() or len(left) == 0:
        return without_gaps(labels)
    squared = squared_residuals(log, left[:, None], graph.poses, graph.landmarks)
    squared = squared + class_distances(reports(log)[left], classes_of(log, before))
    squared[:, ~kept] = np.inf
    order = np.argsort(log.obs_time, kind="stable")
    found = labels.copy()
    for time in np.unique(log.obs_time[left]):
        rows = np.flatnonzero(log.obs_time[left] == time)
        frame = order[slice(*np.searchsorted(log.obs_time[order], (time, time + 1)))]
        squared[np.ix_(rows, labels[frame][labels[frame] >= 0])] = np.inf
        chosen = one_to_one(squared[rows], squared_radius(REPAIR_GATE))
        found[left[rows]] = np.where(chosen < count, chosen, -1)
    return without_gaps(found)


def without_gaps(labels: np.ndarray) -> np.ndarray:
    """The same objects (M,), numbered from 0 without gaps; -1 stays."""
    return in_order_of_sight(labels, labels >= 0)
