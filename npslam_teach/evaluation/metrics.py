"""How good is an estimate? The only place, with ``plotting``, that looks at the truth.

The estimate lives in the frame of its own first pose, so it is first laid over the truth by the rigid motion that
fits the trajectory best; only then are distances measured.
"""

from dataclasses import asdict, dataclass

import numpy as np

from npslam_teach import se2
from npslam_teach.evaluation.clustering import compare_partitions, singletons_for_unassigned
from npslam_teach.evaluation.consistency import chi2_per_dof
from npslam_teach.pose_graph import fit
from npslam_teach.types import UNKNOWN, GroundTruth, PoseGraph, RobotLog, Snapshot


@dataclass(frozen=True)
class Metrics:
    """Everything that the tables report. A quantity that does not exist, or that the truth does not tell, is NaN."""

    mean_pose_error: float  # m
    rmse_pose_error: float  # m
    cumulative_pose_error: float  # m, summed over the poses (paper table I)
    mean_object_error: float  # m, averaged over the observations of real objects
    num_objects: int
    num_objects_true: float  # of those that were seen, a whole number
    ari: float
    v_measure: float
    observations_used: float  # share of all observations
    num_observations_used: int
    chi2_per_dof: float  # of the best fit that these associations allow, at the sensor's own noise

    def as_dict(self) -> dict:
        """Plain Python numbers by name."""
        return asdict(self)


def evaluate(snapshot: Snapshot, truth: GroundTruth, log: RobotLog, refitted: PoseGraph | None = None) -> Metrics:
    """Compare a snapshot with the truth: with all that is known of it.

    Args:
        snapshot: the estimate.
        truth: what really happened; what is unknown is left out of every measure.
        log: what was measured, for the sensor's noise in ``chi2_per_dof``.
        refitted: ``score.refit`` of the snapshot, where it is at hand.

    Raises:
        ValueError: when the truth is of another log.
    """
    if len(truth.poses) != log.num_poses or len(truth.obs_object) != log.num_observations:
        raise ValueError(
            f"truth: expected {log.num_poses} poses and {log.num_observations} observations, "
            f"got {len(truth.poses)} and {len(truth.obs_object)}"
        )
    pose_errors, object_errors = distances_to_truth(snapshot, truth)
    num_used = int(np.count_nonzero(snapshot.labels >= 0))
    ari, v_measure, num_objects_true = compared_labels(snapshot.labels, truth.obs_object)
    return Metrics(
        mean_pose_error=_mean(pose_errors),
        rmse_pose_error=float(np.sqrt(_mean(pose_errors**2))),
        cumulative_pose_error=float(pose_errors.sum()) if pose_errors.size else float("nan"),
        mean_object_error=_mean(object_errors),
        num_objects=snapshot.num_objects,
        num_objects_true=num_objects_true,
        ari=ari,
        v_measure=v_measure,
        observations_used=num_used / max(log.num_observations, 1),
        num_observations_used=num_used,
        chi2_per_dof=chi2_per_dof(refitted or fit(log, snapshot.labels, snapshot.graph.poses)),
    )


def distances_to_truth(snapshot: Snapshot, truth: GroundTruth) -> tuple[np.ndarray, np.ndarray]:
    """Distances after the best rigid alignment of the trajectories, wherever the truth is known.

    Two true positions at least are needed for it; with fewer there are no distances.

    Returns:
        (T,) m for the poses of known position; (U,) m for the observations in use that are of real objects of known
        position: how far the object that each was given to lies from the object it was of.
    """
    motion = align_to_truth(snapshot.graph.poses, truth)
    if motion is None:
        return np.zeros(0), np.zeros(0)
    pose_errors = np.linalg.norm(se2.apply(motion, snapshot.graph.poses[:, :2]) - truth.poses[:, :2], axis=1)
    used = (snapshot.labels >= 0) & (truth.obs_object >= 0)
    landmarks = se2.apply(motion, snapshot.graph.landmark_xy)
    true_xy = truth.world.object_xy[truth.obs_object[used]]
    object_errors = np.linalg.norm(landmarks[snapshot.labels[used]] - true_xy, axis=1)
    return pose_errors[~np.isnan(pose_errors)], object_errors[~np.isnan(object_errors)]


def align_to_truth(poses: np.ndarray, truth: GroundTruth) -> np.ndarray | None:
    """The rigid motion (3,) that lays a path (T, 3) over the known positions of the true one.

    None where fewer than two are known, unless that is all there are.
    """
    known = ~np.isnan(truth.poses[:, :2]).any(axis=1)
    if np.count_nonzero(known) < min(2, len(known)):
        return None
    return se2.align(poses[known, :2], truth.poses[known, :2])


def compared_labels(labels: np.ndarray, true_object: np.ndarray) -> tuple[float, float, float]:
    """ARI, V-measure and the true number of objects, of the observations whose object is known; else NaN.

    Args:
        labels: (N,) of an estimate, -1 for what it leaves out.
        true_object: (N,) as in ``GroundTruth.obs_object``.
    """
    known = true_object != UNKNOWN
    if not known.any() and known.size:
        return float("nan"), float("nan"), float("nan")
    pair = singletons_for_unassigned(true_object[known]), singletons_for_unassigned(labels[known])
    return *compare_partitions(*pair), len(np.unique(true_object[true_object >= 0]))


def _mean(errors: np.ndarray) -> float:
    return float(errors.mean()) if errors.size else float("nan")
