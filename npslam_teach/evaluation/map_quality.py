"""What can be said of a result when nobody knows the truth: the three measures of the paper's experiment (section V.B).

None of them is an error. Each can be had cheaply at the price of another: one object per observation has variance zero
and no valid object, one object for everything has every inlier. They must be read together.
"""

from dataclasses import dataclass, fields, replace

import numpy as np

from npslam_teach import se2
from npslam_teach.association import false_positives, without_empty_objects
from npslam_teach.types import RobotLog, Snapshot


@dataclass(frozen=True)
class MapQuality:
    """The paper's three measures of a result."""

    num_valid: int  # objects that are not false positives
    num_inliers: int  # observations that belong to one of them
    position_variance: float  # m^2, mean over the valid objects; NaN without any


def map_quality(snapshot: Snapshot, log: RobotLog, false_positive_threshold: float) -> MapQuality:
    """Measure a result without its truth (paper section V.B).

    Args:
        snapshot: of any method.
        log: what it was made from.
        false_positive_threshold: epsilon; an object is valid when its ``class_posterior[0]`` does not exceed it.
    """
    valid = ~false_positives(snapshot.votes, false_positive_threshold)
    variance = position_variance(snapshot, log)[valid]
    return MapQuality(
        num_valid=int(np.count_nonzero(valid)),
        num_inliers=int(snapshot.votes[valid, 1:].sum()),
        position_variance=float(variance.mean()) if variance.size else float("nan"),
    )


def position_variance(snapshot: Snapshot, log: RobotLog) -> np.ndarray:
    """How far the observations of each object scatter: their mean squared distance from their own mean, (K,) m^2.

    The observations are carried into the world along the estimated path, so noise, drift that was not repaired, and two
    objects taken for one all show in it. An object of one observation has variance zero.
    """
    used = snapshot.labels >= 0
    labels = snapshot.labels[used]
    xy = se2.apply(snapshot.graph.poses[log.obs_time[used]], log.obs_xy[used])
    counts = np.bincount(labels, minlength=snapshot.num_objects)
    means = np.column_stack([np.bincount(labels, xy[:, a], snapshot.num_objects) for a in (0, 1)]) / counts[:, None]
    squared = ((xy - means[labels]) ** 2).sum(axis=1)
    return np.bincount(labels, squared, snapshot.num_objects) / counts


def valid_only(snapshot: Snapshot, false_positive_threshold: float) -> Snapshot:
    """The same result without its false positives, whose observations get the label -1; nothing is solved again."""
    rejected = false_positives(snapshot.votes, false_positive_threshold)
    used = snapshot.labels >= 0
    drop = np.zeros(len(snapshot.labels), dtype=bool)
    drop[used] = rejected[snapshot.labels[used]]
    kept = without_empty_objects(np.where(drop, -1, snapshot.labels), snapshot.graph.landmarks)
    factors = {name: _of_kept(getattr(snapshot.graph, name), rejected) for name in ("observations", "headings")}
    graph = replace(snapshot.graph, landmarks=kept.landmarks, **factors)
    return replace(snapshot, labels=kept.labels, votes=snapshot.votes[~rejected], graph=graph)


def _of_kept(factors, rejected: np.ndarray):
    """Factors without those of rejected landmarks (K,), the others numbered anew."""
    stays, number = ~rejected[factors.landmark], np.cumsum(~rejected) - 1
    rows = {field.name: getattr(factors, field.name)[stays] for field in fields(factors)}
    return replace(factors, **rows | {"landmark": number[rows["landmark"]]})
