"""Passes over objects, and how far apart two of them are, in metres and in the pose graph's standard deviations."""

from typing import NamedTuple

import numpy as np

from npslam_teach.methods.gating import squared_mahalanobis
from npslam_teach.methods.tracklets import tied_both_ways
from npslam_teach.pose_graph import fit
from npslam_teach.pose_graph.reduced_system import reduced_system
from npslam_teach.types import GroundTruth, RobotLog


class Pairs(NamedTuple):
    """Pairs of passes over objects of one class, no two of them seen in one frame."""

    metres: np.ndarray  # (N,) distance, each pass a landmark of its own
    deviations: np.ndarray  # (N,) the same as a Mahalanobis distance, by the joint covariance of the pose graph
    same: np.ndarray  # (N,) bool, whether both passes were really over one object


def pairs_of_passes(log: RobotLog, truth: GroundTruth) -> Pairs:
    """All pairs of passes that might be one object.

    Passes are the tracklets of ``methods.tracklets``, found without any map; each becomes a landmark of its own.

    Args:
        log: what the robot measured, whose noise counts.
        truth: for ``same`` alone: a pass is over the object of most of its observations.
    """
    labels = tied_both_ways(log)
    graph = fit(log, labels)
    count = len(graph.landmarks)
    cov = np.linalg.inv(reduced_system(graph).information).reshape(count, 2, count, 2).swapaxes(1, 2)
    objects = np.array([np.bincount(truth.obs_object[labels == k]).argmax() for k in range(count)])
    classes = np.array([log.obs_class[labels == k][0] for k in range(count)])
    frames = [set(log.obs_time[labels == k].tolist()) for k in range(count)]
    i, j = np.triu_indices(count, 1)
    possible = (classes[i] == classes[j]) & [frames[a].isdisjoint(frames[b]) for a, b in zip(i, j, strict=True)]
    i, j = i[possible], j[possible]
    between = graph.landmarks[i] - graph.landmarks[j]
    squared = squared_mahalanobis(between, cov[i, i] + cov[j, j] - cov[i, j] - cov[j, i])
    return Pairs(np.linalg.norm(between, axis=1), np.sqrt(squared), objects[i] == objects[j])


def reach(votes: float, alpha: float, kernel_std: float) -> float:
    """The distance in m from an object with so many votes beyond which an observation opens a new object."""
    return kernel_std * np.sqrt(2 * np.log(max(votes / alpha, 1.0)))
