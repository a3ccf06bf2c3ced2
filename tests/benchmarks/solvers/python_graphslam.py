"""python-graphslam: pure Python, one object for each vertex and edge."""

import numpy as np
from graphslam.edge.edge_landmark import EdgeLandmark
from graphslam.edge.edge_odometry import EdgeOdometry
from graphslam.graph import Graph
from graphslam.pose.r2 import PoseR2
from graphslam.pose.se2 import PoseSE2
from graphslam.vertex import Vertex

RESIDUAL = "translation and wrapped angle; point in the frame of the pose"


def solve(problem, tolerance):
    """Build the graph, optimise it, read the estimates."""
    num_poses = len(problem["poses"])
    vertices = [Vertex(key, PoseSE2(pose[:2], pose[2])) for key, pose in enumerate(problem["poses"])]
    vertices += [Vertex(num_poses + key, PoseR2(xy)) for key, xy in enumerate(problem["landmarks"])]
    columns = (problem[name] for name in ("i", "j", "relative_pose", "pose_information_at_j"))
    edges = [
        EdgeOdometry([i, j], omega, PoseSE2(pose[:2], pose[2])) for i, j, pose, omega in zip(*columns, strict=True)
    ]
    columns = (problem[name] for name in ("pose", "landmark", "xy", "point_information"))
    centre = PoseSE2([0.0, 0.0], 0.0)
    edges += [
        EdgeLandmark([pose, num_poses + landmark], omega, PoseR2(xy), offset=centre)
        for pose, landmark, xy, omega in zip(*columns, strict=True)
    ]
    graph = Graph(edges, vertices)
    result = graph.optimize(tol=tolerance, max_iter=100, verbose=False)
    estimates = [np.asarray(vertex.pose.to_array()) for vertex in graph._vertices]
    poses, landmarks = np.array(estimates[:num_poses]), np.array(estimates[num_poses:])
    return poses, landmarks.reshape(-1, 2), result.num_iterations, lambda: {"own_chi2": graph.calc_chi2()}
