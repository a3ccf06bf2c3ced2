"""The alternation as a descent: its half-steps, and the lowest objective of every grouping (lesson 06).

Both halves of a round lower one number, ``associate.objective``, as long as the solver believes of a sighting what the
kernel of the sweep believes; ``observation_std`` is by default that.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from npslam_teach import se2
from npslam_teach.associate import PAPER_ALPHA, PAPER_KERNEL_STD, Association, sweep
from npslam_teach.data import RobotLog, Snapshot
from npslam_teach.methods.common import PAPER_ODOMETRY_STD, mean_landmarks, reassociated, snapshot, start
from npslam_teach.pose_graph import optimize

CONSISTENT_STD = (PAPER_KERNEL_STD, PAPER_KERNEL_STD)


def half_steps(
    log: RobotLog,
    alpha: float = PAPER_ALPHA,
    observation_std=CONSISTENT_STD,
    rounds: int = 10,
    odometry_std=PAPER_ODOMETRY_STD,
) -> list[Snapshot]:
    """The start, and then two snapshots of every round: after the sweep, and after the solver.

    Args:
        log: what the robot measured.
        alpha: concentration.
        observation_std: (2,) m, what the solver believes of an observation.
        rounds: at most so many; fewer when no label changes any more.
        odometry_std: (3,) m, m, rad, and of a step.

    Returns:
        1 + 2 * rounds snapshots or fewer; their iterations count half-steps.
    """
    snapshots = [start(log, odometry_std, observation_std, alpha)]
    for half_step in range(1, 2 * rounds + 1, 2):
        now = snapshots[-1]
        obs_xy_world = se2.transform_to(now.graph.poses[log.obs_time], log.obs_xy)
        association = sweep(now.labels, now.graph.landmarks, obs_xy_world, log.obs_class, alpha)
        graph = reassociated(log, now.graph, association, observation_std)
        snapshots.append(snapshot(log, half_step, association.labels, graph, alpha))
        snapshots.append(snapshot(log, half_step + 1, association.labels, optimize(graph), alpha))
        if np.array_equal(now.labels, association.labels):
            break
    return snapshots


def fitted(
    log: RobotLog,
    labels,
    alpha: float = PAPER_ALPHA,
    observation_std=CONSISTENT_STD,
    odometry_std=PAPER_ODOMETRY_STD,
    poses: np.ndarray | None = None,
) -> Snapshot:
    """The best map that a grouping allows, with its objective.

    Args:
        log: what the robot measured.
        labels: (M,) index of the object of each observation, from 0 without gaps.
        alpha: concentration.
        observation_std: (2,) m, what the solver believes of an observation.
        odometry_std: (3,) m, m, rad, and of a step.
        poses: (T, 3) W, from which the solver sets out; dead reckoning when None.
    """
    labels = np.asarray(labels, dtype=int)
    first = start(log, odometry_std, observation_std, alpha).graph
    poses = first.poses if poses is None else poses
    obs_xy_world = se2.transform_to(poses[log.obs_time], log.obs_xy)
    association = Association(labels, mean_landmarks(labels, obs_xy_world))
    graph = reassociated(log, replace(first, poses=poses), association, observation_std)
    return snapshot(log, 0, labels, optimize(graph), alpha)


def groupings(obs_class) -> Iterator[list[int]]:
    """Every way to group observations into objects of one class each, once, as labels in order of appearance.

    Args:
        obs_class: (M,); their number grows like the Bell numbers, 4140 for eight of one class.
    """
    obs_class = list(obs_class)
    if not obs_class:
        yield []
        return
    for labels in groupings(obs_class[:-1]):
        alike = {i for i, c in zip(labels, obs_class[:-1], strict=True) if c == obs_class[-1]}
        for label in (*sorted(alike), max(labels, default=-1) + 1):
            yield [*labels, label]
