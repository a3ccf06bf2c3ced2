"""The toy scene of the deck, ``Obj_1`` to ``Obj_8``: fixed by hand, small enough to be checked on paper.

A robot drives a loop of 9 m through a room and sees two chairs, a screen and a cup. Between pose 2 and pose 3 its
wheels spin: they report 2.0 m where it moved 1.7 m. That is the only error, so along the odometry path all observations
before the slip are in their true places, and all observations after it are 0.3 m too far in y.
"""

import numpy as np

from npslam_teach import se2
from npslam_teach.types import GroundTruth, RobotLog, World

TOY_CLASSES = ("chair", "screen", "cup")
SLIP = 0.3  # m, what the wheels report too much between pose 2 and pose 3

QUARTER = np.pi / 2
TRUE_STEPS = np.array([[2.0, 0, 0], [2.0, 0, QUARTER], [2.0 - SLIP, 0, QUARTER], [2.0, 0, QUARTER], [1.2, 0, -QUARTER]])
OBJECT_XY = np.array([[1.2, 1.1], [1.2, 0.4], [2.8, 0.6], [0.6, 0.2]])  # m: chair A, chair B, the screen, the cup
OBJECT_CLASS = np.array([0, 0, 1, 2])
SEEN = (  # Obj_1 to Obj_7: (pose, object); Obj_8 is false
    (0, 0),
    (0, 1),
    (1, 2),
    (3, 0),
    (4, 1),
    (4, 2),
    (5, 3),
)
GHOST_TIME, GHOST_XY, GHOST_CLASS = 5, (1.5, -1.2), 1  # Obj_8: a screen where none is


def toy_objects() -> tuple[RobotLog, GroundTruth]:
    """The deck's toy scene, without any randomness (deck figures 5 to 13).

    =====  ====================  ==========================================================
    Obj    what it really is     what makes it interesting
    =====  ====================  ==========================================================
    1, 4   chair A               seen before and after the slip, 0.3 m apart
    2, 5   chair B               the same; Obj_5 is also only 0.4 m from Obj_1, the other chair
    3, 6   the screen            the same
    7      the cup               seen only once
    8      nothing               a false detection of a screen
    =====  ====================  ==========================================================

    Along the odometry path Obj_5 is 0.3 m from Obj_2 (``exp(-4 d^2) = 0.698``), 0.4 m from Obj_1 (0.527) and 0.7 m from
    Obj_4 (0.141).
    """
    poses = se2.dead_reckoning(TRUE_STEPS)
    odometry = TRUE_STEPS.copy()
    odometry[2, 0] += SLIP
    time, obj = np.array(SEEN).T
    xy = se2.apply_inverse(poses[time], OBJECT_XY[obj])
    log = RobotLog(
        odometry=odometry,
        obs_time=np.append(time, GHOST_TIME),
        obs_xy=np.vstack([xy, GHOST_XY]).round(12),
        obs_class=np.append(OBJECT_CLASS[obj], GHOST_CLASS),
        num_classes=len(TOY_CLASSES),
        odometry_std=(0.2, 0.05, 0.02),
        observation_std=(0.05, 0.05),
    )
    return log, GroundTruth(World(OBJECT_XY, OBJECT_CLASS, TOY_CLASSES), poses, np.append(obj, -1))
