"""Settings in the units of a log: the paper's constants, and the same constants scaled to another sensor.

The paper's kernel, 0.354 m wide, and the standard deviations that its solver assumes suit the sensors of its own room.
For another log every constant keeps its ratio to the noise: a log in other units, or of a better sensor, then gets the
same answer.
"""

import numpy as np

from npslam_teach.association import PAPER_KERNEL_STD
from npslam_teach.methods.snapshots import PAPER_OBSERVATION_STD, PAPER_ODOMETRY_STD
from npslam_teach.types import RobotLog

LARGEST_STD = 1e4  # m or rad, of a log; several times as much is beyond what a solver can use

# What the paper's simulated sensors err by: the file's own noise and that of the script, section V.A.
PAPER_ODOMETRY_NOISE = np.hypot((0.01, 0.01, 0.01), (0.02, 0.02, 0.01))  # m, m, rad per step
PAPER_OBSERVATION_NOISE = np.hypot((0.1, 0.1), (0.1, 0.1))  # m


def paper_settings() -> dict:
    """What the authors' script uses, whatever the sensor."""
    return {
        "kernel_std": PAPER_KERNEL_STD,
        "odometry_std": PAPER_ODOMETRY_STD,
        "observation_std": PAPER_OBSERVATION_STD,
        "exclusive": False,
    }


def settings_for(log: RobotLog) -> dict:
    """The paper's constants, scaled from its noise to the log's own; and two observations of a frame are two things.

    Args:
        log: whose ``odometry_std`` and ``observation_std`` count.

    Returns:
        kernel_std (m), odometry_std (3,), observation_std (2,) and exclusive, as methods take them.
    """
    odometry = np.asarray(log.odometry_std) / PAPER_ODOMETRY_NOISE
    observation = np.asarray(log.observation_std) / PAPER_OBSERVATION_NOISE
    for name in ("odometry_std", "observation_std"):
        if not (getattr(log, name) <= LARGEST_STD).all():
            raise ValueError(f"{name}: expected at most {LARGEST_STD:g}, got {getattr(log, name).tolist()}")
    return {
        "kernel_std": float(PAPER_KERNEL_STD * np.sqrt(observation.prod())),
        "odometry_std": tuple((PAPER_ODOMETRY_STD * odometry).tolist()),
        "observation_std": tuple((PAPER_OBSERVATION_STD * observation).tolist()),
        "exclusive": True,
    }
