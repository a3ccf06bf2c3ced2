"""One file per method, all with the same signature: a ``RobotLog`` in, an iterator of ``Snapshot`` out.

``*_, last = method(log)`` gets the answer; ``list(method(log))`` feeds a slider; one loop compares them all. Every
method begins with the same snapshot 0: odometry believed, every observation an object of its own.
"""

from npslam_teach.methods.ekf_slam import ekf_slam
from npslam_teach.methods.frame_by_frame import frame_by_frame
from npslam_teach.methods.np_graph import np_graph
from npslam_teach.methods.open_loop import open_loop
from npslam_teach.methods.robust_slam import robust_slam

PAPER_METHODS = {
    "np-graph": np_graph,
    "robust-slam": robust_slam,
    "open-loop": open_loop,
    "frame-by-frame": frame_by_frame,
}
METHODS = PAPER_METHODS | {"ekf": ekf_slam}

__all__ = ["METHODS", "PAPER_METHODS", "ekf_slam", "frame_by_frame", "np_graph", "open_loop", "robust_slam"]
