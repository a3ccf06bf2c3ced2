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
    measured = [g2o.SE2(pose) for pose in problem["relative_pose"]]
    _add_edges(optimizer, g2o.EdgeSE2, problem["i"], problem["j"], measured, problem["pose_information_at_j"])
    keys = num_poses + problem["landmark"]
    _add_edges(optimizer, g2o.EdgeSE2PointXY, problem["pose"], keys, problem["xy"], problem["point_information"])
    optimizer.initialize_optimization()
    iterations = optimizer.optimize(100)
    poses = np.array([optimizer.vertex(k).estimate().to_vector() for k in range(num_poses)])
    landmarks = [optimizer.vertex(num_poses + k).estimate() for k in range(num_landmarks)]
    return poses, np.array(landmarks).reshape(-1, 2), iterations, lambda: {"own_chi2": _chi2(optimizer)}


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


def _add_edges(optimizer, kind, ends, other_ends, measurements, information):
    for end, other_end, measurement, omega in zip(ends, other_ends, measurements, information, strict=True):
        edge = kind()
        edge.set_vertex(0, optimizer.vertex(int(end)))
        edge.set_vertex(1, optimizer.vertex(int(other_end)))
        edge.set_measurement(measurement)
        edge.set_information(omega)
        optimizer.add_edge(edge)
