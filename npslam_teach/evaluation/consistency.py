"""Do the errors have the size that an estimate claims for them? chi2 per degree of freedom, NIS and ellipses.

A consistent estimate has chi2 near its degrees of freedom, and a share p of its errors inside its p-ellipses
(Bar-Shalom, Li and Kirubarajan, "Estimation with Applications to Tracking and Navigation", 2001, section 5.4).
"""

import numpy as np

from npslam_teach.association import without_empty_objects
from npslam_teach.pose_graph import chi2, fit, squared_radius
from npslam_teach.pose_graph.unknowns import unknowns_of
from npslam_teach.types import GroundTruth, PoseGraph, RobotLog


def true_association_fit(log: RobotLog, truth: GroundTruth) -> PoseGraph:
    """The pose graph that somebody who knows every identity would get: the best any method can do with this log.

    Its objects are those that were seen, in the order of the world; it starts at the true first pose.
    """
    labels = without_empty_objects(truth.obs_object, truth.world.object_xy).labels
    return fit(log, labels, truth.poses)


def chi2_per_dof(graph: PoseGraph) -> float:
    """chi2 over its degrees of freedom: near 1 when model and data agree.

    NaN where nothing is left over, as when every observation is an object of its own.
    """
    dof = degrees_of_freedom(graph)
    return chi2(graph) / dof if dof > 0 else float("nan")


def degrees_of_freedom(graph: PoseGraph) -> int:
    """Measured numbers minus unknowns."""
    measured = 3 * len(graph.between.i) + 2 * len(graph.observations.pose) + len(graph.headings.pose)
    return measured - unknowns_of(graph).count


def chi2_score(graph: PoseGraph) -> float:
    """By how many standard deviations chi2 differs from its degrees of freedom; negative where it is too small.

    Chi-squared with n degrees of freedom has mean n and variance 2n. Both tails tell of a wrong model: measurements
    that contradict each other raise chi2, groups that were chosen by looking at the noise lower it. NaN without degrees
    of freedom.
    """
    dof = degrees_of_freedom(graph)
    return float((chi2(graph) - dof) / np.sqrt(2 * dof)) if dof > 0 else float("nan")


def share_within(radius: float) -> float:
    """The share of right matches within a Mahalanobis distance: chi-squared, 2 degrees of freedom."""
    return float(-np.expm1(-(radius**2) / 2))


def chi2_bounds(dof, share: float) -> np.ndarray:
    """Between which numbers chi2 per degree of freedom lies with a probability, as much beyond at either end.

    The average NIS of N matches in the plane lies between twice the bounds of 2 N degrees of freedom.

    Args:
        dof: degrees of freedom, one number or (...).
        share: the probability.

    Returns:
        (2,) or (2, ...): low, high.
    """
    from scipy.stats import chi2 as chi_squared

    return np.stack([chi_squared.ppf(tail, dof) / dof for tail in ((1 - share) / 2, (1 + share) / 2)])


def nis_in_windows(nis: np.ndarray, nis_dof: np.ndarray, window: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Frames taken together in windows, those without any match dropped.

    Args:
        nis: (T,) NaN without any match.
        nis_dof: (T,).
        window: frames.

    Returns:
        (W,) the middle of each window; (W,) its sum of NIS over its degrees of freedom; (W,) these.
    """
    starts = np.arange(0, len(nis), window)
    total, dof = np.add.reduceat(np.nan_to_num(nis), starts), np.add.reduceat(nis_dof, starts)
    ends = np.minimum(starts + window, len(nis))
    used = dof > 0
    return (starts + ends - 1)[used] / 2, total[used] / dof[used], dof[used]


def share_inside(xy: np.ndarray, mean: np.ndarray, cov: np.ndarray, share: float = 0.95) -> float:
    """The share of points that really lie inside the ellipse of ``ellipse_points``.

    Args:
        xy: (N, 2) m.
        mean: (2,) m.
        cov: (2, 2) m^2, of full rank.
        share: p, the probability that the ellipse promises.
    """
    off = xy - np.asarray(mean)
    squared = np.sum(off * np.linalg.solve(cov, off.T).T, axis=1)
    return float(np.mean(squared < squared_radius(share)))
