"""npslam_teach itself, with either of its linear solvers."""

from npslam_teach.pose_graph import minimize
from npslam_teach.types import BetweenFactors, ObservationFactors, PoseGraph

RESIDUAL = "translation and wrapped angle; point in the frame of the pose"


def solve_with(library):
    """The solver that uses one library for the linear systems."""

    def solve(problem, tolerance):
        between = BetweenFactors(*(problem[name] for name in ("i", "j", "relative_pose", "pose_information")))
        sightings = ObservationFactors(*(problem[name] for name in ("pose", "landmark", "xy", "point_information")))
        graph = PoseGraph(problem["poses"], problem["landmarks"], between, sightings)
        last = minimize(graph, tolerance, library=library)[-1]
        return last.graph.poses, last.graph.landmarks, last.iteration, lambda: last.chi2

    return solve
