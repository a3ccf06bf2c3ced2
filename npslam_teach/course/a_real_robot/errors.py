"""What a recording errs by, and what can be told of it: errors of passes, growth over steps, outliers, ellipses."""

import numpy as np

from npslam_teach import se2
from npslam_teach.association import in_order_of_sight
from npslam_teach.evaluation import chi2_per_dof, true_association_fit
from npslam_teach.methods import noise_estimate
from npslam_teach.methods.gating import GATE, squared_mahalanobis
from npslam_teach.methods.noise import with_noise
from npslam_teach.methods.tracklets import LONGEST_GAP, in_passes
from npslam_teach.pose_graph import fit, marginal_covariance, squared_radius
from npslam_teach.types import GroundTruth, RobotLog

MOST_ROUNDS, SETTLED = 30, 0.01


def sighting_errors(log: RobotLog, truth: GroundTruth) -> np.ndarray:
    """(M, 2) m, in the frame of the robot: measured minus true position; NaN where the landmark was misread."""
    known = truth.obs_object >= 0
    true_xy = truth.world.object_xy[np.where(known, truth.obs_object, 0)]
    off = log.obs_xy - se2.apply_inverse(truth.poses[log.obs_time], true_xy)
    return np.where(known[:, None], off, np.nan)


def along_the_ray(log: RobotLog, off: np.ndarray) -> np.ndarray:
    """(M,) m: how much too far the landmark seems; ``off`` (M, 2) m from ``sighting_errors``."""
    return (off * log.obs_xy).sum(axis=1) / np.linalg.norm(log.obs_xy, axis=1)


def lag_one(errors: np.ndarray, passes: np.ndarray) -> float:
    """The correlation of errors next to each other in a pass: 0 where they are independent.

    Args:
        errors: (n,) with a mean of zero, in the order of ``in_passes``.
        passes: (n,) the pass of each.
    """
    same = passes[1:] == passes[:-1]
    return float((errors[1:] * errors[:-1])[same].mean() / (errors**2).mean())


def growth(odometry: np.ndarray, poses: np.ndarray, num_steps: int) -> np.ndarray:
    """Root mean square error (3,) m, m, rad of so many steps of odometry together.

    Args:
        odometry: (T-1, 3).
        poses: (T, 3) the true ones.
        num_steps: n; every stretch of n steps counts, wherever it begins.
    """
    wheels = se2.dead_reckoning(odometry)
    said, true = (se2.between(path[:-num_steps], path[num_steps:]) for path in (wheels, poses))
    off = said - true
    off[:, 2] = se2.wrap(off[:, 2])
    return np.sqrt(np.nanmean(off**2, axis=0))


def share_outside(off: np.ndarray, std: np.ndarray, gate: float = GATE) -> float:
    """The share of errors (n, 2) beyond the ellipse that should hold a share ``gate``; std (2,)."""
    return float(np.mean(((off / std) ** 2).sum(axis=1) > squared_radius(gate)))


def first_of_each_pass(labels: np.ndarray, times: np.ndarray, gap: int = LONGEST_GAP) -> np.ndarray:
    """Which sightings (M,) bool are the first of a pass; see ``in_passes``."""
    order, passes = in_passes(labels, times, gap)
    chosen = np.zeros(len(labels), dtype=bool)
    chosen[order[np.diff(passes, prepend=-1) != 0]] = True
    return chosen


def without_outliers(log: RobotLog, labels: np.ndarray, poses: np.ndarray) -> np.ndarray:
    """Labels (M,) with -1 for what lies beyond the gate of its own object; ``poses`` (T, 3) to set out from."""
    return noise_estimate.without_outliers(log, labels, poses)[0]


def noise_factors(log: RobotLog, labels: np.ndarray, poses: np.ndarray) -> np.ndarray:
    """By which two factors the log's noise must be multiplied to be that of the residuals, were errors white.

    Residuals are smaller than errors, for the graph was bent to fit them: of n numbers the unknowns use up as many as
    the leverages add up to. Residuals depend on the noise, so both are found in turn.

    Args:
        log: whose noise is where the search begins.
        labels: (M,) the object of each sighting; -1 leaves it out.
        poses: (T, 3) to set out from.

    Returns:
        (2,) of odometry, of observations.
    """
    labels, factors = in_order_of_sight(labels, labels >= 0), np.ones(2)
    for _ in range(MOST_ROUNDS):
        graph = fit(with_noise(log, factors[0] * log.odometry_std, factors[1] * log.observation_std), labels, poses)
        squares, free = noise_estimate.residual_squares(graph)
        wrong = np.sqrt(squares / free)
        factors = factors * wrong
        if np.abs(wrong - 1).max() <= SETTLED:
            break
    return factors


def landmark_nees(log: RobotLog, truth: GroundTruth) -> tuple[np.ndarray, float]:
    """Are landmarks as far off as their ellipses say, when every identity is known?

    The path sets out from the true first pose, which is held there, so that errors are those of the map alone.

    Returns:
        (K,) squared Mahalanobis distances from true landmark to estimate, 2 on average in an honest graph; chi2 of the
        graph per degree of freedom.
    """
    graph = true_association_fit(log, truth)
    seen = np.unique(truth.obs_object[truth.obs_object >= 0])
    off = graph.landmarks - truth.world.object_xy[seen]
    covariances = marginal_covariance(graph, landmarks=range(len(seen)))[1]
    return squared_mahalanobis(off, covariances), chi2_per_dof(graph)
