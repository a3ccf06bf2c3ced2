"""npslam_teach itself, with either of its linear solvers."""

from npslam_teach.pose_graph import levenberg_marquardt
from npslam_teach.types import BetweenFactors, ObservationFactors, PoseGraph

RESIDUAL = "translation and wrapped angle; point in the frame of the pose"


def solve_with(library):
    """The solver that uses one library for the linear systems."""

    def solve(problem, tolerance):
        between = BetweenFactors(*(problem[name] for name in ("i", "j", "relative_pose", "pose_information")))
        sightings = ObservationFactors(*(problem[name] for name in ("pose", "landmark", "xy", "point_information")))
        graph = PoseGraph(problem["poses"], problem["landmarks"], between, sightings)
        *_, last = levenberg_marquardt(graph, tolerance, library=library)
        return last.graph.poses, last.graph.landmarks, last.iteration, lambda: last.chi2

    return solve
