"""Frame by frame: trust the odometry and take every observation for a new object (deck step 1, figure 5).

It is the start of every other method, and their yardstick: as many objects as observations.
"""

from collections.abc import Iterator

from npslam_teach.methods.oriented import without_headings
from npslam_teach.methods.snapshots import PAPER_OBSERVATION_STD, PAPER_ODOMETRY_STD, initial_snapshot
from npslam_teach.types import RobotLog, Snapshot


def frame_by_frame(
    log: RobotLog, odometry_std=PAPER_ODOMETRY_STD, observation_std=PAPER_OBSERVATION_STD
) -> Iterator[Snapshot]:
    """Yield the one snapshot there is.

    Args:
        log: what the robot measured.
        odometry_std: (3,) m, m, rad: standard deviations that chi2 is measured with.
        observation_std: (2,) m.
    """
    yield initial_snapshot(without_headings(log), odometry_std, observation_std)
