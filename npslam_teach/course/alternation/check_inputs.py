"""What the checks of this lesson try where that takes more than a few lines: rounds of the alternation."""

import math
from dataclasses import replace

import numpy as np

from npslam_teach import se2, simulate
from npslam_teach.course.trials import fresh
from npslam_teach.methods.snapshots import PAPER_ODOMETRY_STD, initial_snapshot
from npslam_teach.pose_graph import with_associations
from npslam_teach.types import RobotLog


def one_alternation_inputs() -> tuple[list, dict]:
    """Arguments of ``check_one_alternation``: its trials, and its edges by the situation."""
    pair = np.array([[1.0, 0.0], [1.0 + math.sqrt(-math.log(0.35) / 4), 0.0]])
    three = np.array([[1.0, 0.0], [1.6, 0.0], [1.3, 0.5]])  # too far from each other, near enough to their middle
    edges = {
        "with an object that is not at the mean of its sightings, within reach of another's": [
            _frame(np.array([[1.0, 0.0], [1.6, 0.0]]), np.arange(2), 0.5, np.array([[1.3, 0.0], [1.6, 0.0]]))
        ],
        "with two sightings whose weight, 0.35, lies between two values of alpha": [
            _frame(pair, np.arange(2), alpha) for alpha in (0.25, 0.45)
        ],
        "with three sightings of which a second sweep would move one: ask each once": [
            _frame(np.array([[1.5, 0.0], [1.7, 0.0], [1.0, 0.0]]), np.arange(3), 0.5)
        ],
        "with three sightings that stay together because they are": [_frame(three, np.zeros(3, dtype=int), 0.5)],
    }
    return [each for _ in range(2) for each in _rounds()], edges


def _rounds() -> list[tuple]:
    """Arguments of a round: at the beginning, along a better path, and with labels that are partly right."""
    rng = fresh()
    log, truth = simulate.toy_objects()
    noisy = np.tile(log.obs_xy, (3, 1)) + rng.normal(0, 0.15, (24, 2))
    odometry = log.odometry.copy()
    odometry[2, 0] += 1.0
    times, classes = np.tile(log.obs_time, 3), np.tile(log.obs_class, 3)
    shaken = RobotLog(odometry, times, noisy, classes, log.num_classes, log.odometry_std, log.observation_std)
    alpha, std = float(rng.uniform(0.3, 0.9)), tuple(rng.uniform(0.1, 0.5, 2).tolist())
    first = initial_snapshot(shaken, PAPER_ODOMETRY_STD, std, alpha)
    # Later the path is no longer that of the odometry: wrong answers may differ from right ones only there.
    seen_at = se2.apply(truth.poses[times], noisy)
    later = replace(first.graph, poses=truth.poses, landmarks=seen_at)
    grouped = np.unique(np.where(rng.random(24) < 0.6, np.arange(24) % 8, 8 + np.arange(24) % 3), return_inverse=True)[
        1
    ]
    places = np.array([seen_at[grouped == i].mean(axis=0) for i in range(grouped.max() + 1)])
    places += rng.normal(0, 0.1, places.shape)  # after a solve no object is at the mean of its sightings
    tied = with_associations(shaken, later, grouped, places, std)
    return [
        (shaken, graph, labels, alpha, std)
        for graph, labels in ((first.graph, first.labels), (later, first.labels), (tied, grouped))
    ]


def _frame(xy: np.ndarray, labels: np.ndarray, alpha: float, places: np.ndarray | None = None) -> tuple:
    """Arguments of a round for sightings (M, 2) of one class, all in the first frame, with labels that they have.

    The objects are at places (K, 2), by default the means of their sightings.
    """
    none = np.zeros(len(xy), dtype=int)
    log = RobotLog(np.array([[0.5, 0.0, 0.1]]), none, xy, none, 1, np.full(3, 0.1), np.full(2, 0.1))
    first = initial_snapshot(log, PAPER_ODOMETRY_STD, (0.2, 0.3), alpha)
    if places is None:
        places = np.array([xy[labels == i].mean(axis=0) for i in range(labels.max() + 1)])
    graph = with_associations(log, first.graph, labels, places, (0.2, 0.3))
    return log, graph, labels, alpha, (0.2, 0.3)
