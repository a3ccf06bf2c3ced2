"""Drives of lesson 15: who is who is told, or found on the way."""

import numpy as np

from npslam_teach.experiments.online_rooms import Told
from npslam_teach.methods import Online
from npslam_teach.methods.gating import frames_of
from npslam_teach.methods.online import frames
from npslam_teach.pose_graph import SubmapTree
from npslam_teach.types import GroundTruth, RobotLog


def told_drive(log: RobotLog, truth: GroundTruth) -> tuple[SubmapTree, np.ndarray]:
    """The tree after a drive in which the true identities are given; (T,) submaps condensed in each frame."""
    robot, work = Told(log, truth.obs_object), []
    for time, seen in enumerate(frames_of(log)):
        before = robot.tree.redone
        robot.add_frame(time, seen)
        work.append(robot.tree.redone - before)
    return robot.tree, np.array(work)


def beliefs_under_way(log: RobotLog, **settings) -> tuple[Online, np.ndarray, np.ndarray]:
    """A robot after its drive, and what it believed on the way.

    Args:
        log: what was measured, in the order of the poses.
        settings: of ``Online``.

    Returns:
        the robot; (T,) how many objects there were after each frame; (M,) the object of each observation when it was
        first seen, -1 = left out.
    """
    robot = Online(log.num_classes, log.odometry_std, log.observation_std, **settings)
    counts, first = [], []
    for estimate in frames(robot, log):
        first += estimate.objects.tolist()
        counts.append(len(np.unique(robot.labels[robot.labels >= 0])))
    return robot, np.array(counts), np.array(first, dtype=int)
