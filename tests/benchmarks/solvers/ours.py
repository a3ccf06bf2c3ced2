"""npslam_teach itself, with either of its linear solvers."""

import time

from npslam_teach.pose_graph import certify, minimize
from npslam_teach.types import BetweenFactors, ObservationFactors, PoseGraph

RESIDUAL = "translation and wrapped angle; point in the frame of the pose"


def solve_with(library):
    """The solver that uses one library for the linear systems."""

    def solve(problem, tolerance):
        between = BetweenFactors(*(problem[name] for name in ("i", "j", "relative_pose", "pose_information")))
        sightings = ObservationFactors(*(problem[name] for name in ("pose", "landmark", "xy", "point_information")))
        graph = PoseGraph(problem["poses"], problem["landmarks"], between, sightings)
        last = minimize(graph, tolerance, library=library)[-1]
        return last.graph.poses, last.graph.landmarks, last.iteration, lambda: _certified(last)

    return solve


def _certified(last):
    begin = time.perf_counter()
    certificate = certify(last.graph)
    seconds = time.perf_counter() - begin
    return {"own_chi2": last.chi2, "certificate_status": str(certificate), "certificate_seconds": seconds}
