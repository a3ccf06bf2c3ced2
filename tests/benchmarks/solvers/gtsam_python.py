"""gtsam from Python, Gauss-Newton with its defaults (multifrontal Cholesky, COLAMD)."""

import gtsam
import numpy as np

RESIDUAL = "SE(2) logarithm; bearing and range"
POINT = 1 << 40  # keys of landmarks begin here


def solve(problem, tolerance):
    """Build the factor graph, optimise it, read the values."""
    graph, values = gtsam.NonlinearFactorGraph(), gtsam.Values()
    _add_poses(graph, values, problem)
    _add_landmarks(graph, values, problem)
    parameters = gtsam.GaussNewtonParams()
    parameters.setRelativeErrorTol(tolerance)
    parameters.setAbsoluteErrorTol(0.0)
    optimizer = gtsam.GaussNewtonOptimizer(graph, values, parameters)
    result = optimizer.optimize()
    poses = np.array([[p.x(), p.y(), p.theta()] for p in map(result.atPose2, range(len(problem["poses"])))])
    landmarks = [result.atPoint2(POINT + k) for k in range(len(problem["landmarks"]))]
    # gtsam's error is half of the sum.
    answer = poses, np.array(landmarks).reshape(-1, 2), optimizer.iterations()
    return *answer, lambda: {"own_chi2": 2 * graph.error(result)}


def _add_poses(graph, values, problem):
    for key, pose in enumerate(problem["poses"].tolist()):
        values.insert(key, gtsam.Pose2(*pose))
    held_still = gtsam.noiseModel.Diagonal.Sigmas(np.full(3, 1e-8))
    graph.add(gtsam.PriorFactorPose2(0, gtsam.Pose2(*problem["poses"][0]), held_still))
    noises = _noises(problem["pose_information_at_j"])
    measured = (gtsam.Pose2(*pose) for pose in problem["relative_pose"].tolist())
    for i, j, pose, noise in zip(problem["i"].tolist(), problem["j"].tolist(), measured, noises, strict=True):
        graph.add(gtsam.BetweenFactorPose2(i, j, pose, noise))


def _add_landmarks(graph, values, problem):
    for key, xy in enumerate(problem["landmarks"]):
        values.insert(POINT + key, xy)
    distance = np.hypot(*problem["xy"].T)
    bearing = np.arctan2(problem["xy"][:, 1], problem["xy"][:, 0])
    std = 1 / np.sqrt(problem["point_information"][:, 0, 0])
    rows = zip(*(a.tolist() for a in (problem["pose"], problem["landmark"], bearing, distance, std)), strict=True)
    for pose, landmark, angle, metres, sigma in rows:
        noise = gtsam.noiseModel.Diagonal.Sigmas(np.array([sigma / max(metres, 1e-3), sigma]))
        graph.add(gtsam.BearingRangeFactor2D(pose, POINT + landmark, gtsam.Rot2(angle), metres, noise))


def _noises(information):
    """One noise model for all factors where they share it, as a user would write it."""
    if len(information) and (information == information[0]).all():
        return [gtsam.noiseModel.Gaussian.Information(information[0])] * len(information)
    return [gtsam.noiseModel.Gaussian.Information(each) for each in information]
