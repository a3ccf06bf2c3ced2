"""g2o from Python, Gauss-Newton with Eigen's sparse Cholesky, the one that its wheel has for blocks of mixed size."""

import g2o
import numpy as np

RESIDUAL = "translation and wrapped angle (in the frame of the measured pose); point in the frame of the pose"


def solve(problem, tolerance):
    """Build the graph, optimise it, read the estimates."""
    optimizer = g2o.SparseOptimizer()
    optimizer.set_algorithm(g2o.OptimizationAlgorithmGaussNewton(g2o.BlockSolverX(g2o.LinearSolverEigenX())))
    stop = g2o.SparseOptimizerTerminateAction()
    stop.set_gain_threshold(tolerance)
    optimizer.add_post_iteration_action(stop)
    num_poses, num_landmarks = len(problem["poses"]), len(problem["landmarks"])
    _add_vertices(optimizer, problem)
    _add_poses(optimizer, problem)
    _add_landmarks(optimizer, problem)
    optimizer.initialize_optimization()
    iterations = optimizer.optimize(100)
    poses = np.array([optimizer.vertex(k).estimate().to_vector() for k in range(num_poses)])
    landmarks = [optimizer.vertex(num_poses + k).estimate() for k in range(num_landmarks)]
    return poses, np.array(landmarks).reshape(-1, 2), iterations, lambda: _chi2(optimizer)


def _chi2(optimizer):
    optimizer.compute_active_errors()
    return optimizer.active_chi2()


def _add_vertices(optimizer, problem):
    for key, pose in enumerate(problem["poses"]):
        vertex = g2o.VertexSE2()
        vertex.set_id(key)
        vertex.set_estimate(g2o.SE2(pose))
        vertex.set_fixed(key == 0)
        optimizer.add_vertex(vertex)
    for key, xy in enumerate(problem["landmarks"], start=len(problem["poses"])):
        vertex = g2o.VertexPointXY()
        vertex.set_id(key)
        vertex.set_estimate(xy)
        optimizer.add_vertex(vertex)


def _add_poses(optimizer, problem):
    columns = (problem[name] for name in ("i", "j", "relative_pose", "pose_information_at_j"))
    for i, j, pose, information in zip(*columns, strict=True):
        edge = g2o.EdgeSE2()
        edge.set_vertex(0, optimizer.vertex(int(i)))
        edge.set_vertex(1, optimizer.vertex(int(j)))
        edge.set_measurement(g2o.SE2(pose))
        edge.set_information(information)
        optimizer.add_edge(edge)


def _add_landmarks(optimizer, problem):
    columns = (problem[name] for name in ("pose", "landmark", "xy", "point_information"))
    for pose, landmark, xy, information in zip(*columns, strict=True):
        edge = g2o.EdgeSE2PointXY()
        edge.set_vertex(0, optimizer.vertex(int(pose)))
        edge.set_vertex(1, optimizer.vertex(len(problem["poses"]) + int(landmark)))
        edge.set_measurement(xy)
        edge.set_information(information)
        optimizer.add_edge(edge)
