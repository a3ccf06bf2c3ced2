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
from npslam_teach.types import GroundTruth, RobotLog, Snapshot


@dataclass(frozen=True)
class Metrics:
    """Everything that the tables report. A quantity that does not exist is NaN."""

    mean_pose_error: float  # m
    rmse_pose_error: float  # m
    cumulative_pose_error: float  # m, summed over the poses (paper table I)
    mean_object_error: float  # m, averaged over the observations of real objects
    num_objects: int
    num_objects_true: int  # of those that were seen
    ari: float
    v_measure: float
    observations_used: float  # share of all observations
    num_observations_used: int
    chi2_per_dof: float  # of the best fit that these associations allow, at the sensor's own noise

    def as_dict(self) -> dict:
        """Plain Python numbers by name."""
        return asdict(self)


def evaluate(snapshot: Snapshot, truth: GroundTruth, log: RobotLog) -> Metrics:
    """Compare a snapshot with the truth.

    Args:
        snapshot: the estimate.
        truth: what really happened.
        log: what was measured, for the sensor's noise in ``chi2_per_dof``.

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
    ari, v_measure = compare_partitions(
        singletons_for_unassigned(truth.obs_object), singletons_for_unassigned(snapshot.labels)
    )
    return Metrics(
        mean_pose_error=float(pose_errors.mean()),
        rmse_pose_error=float(np.sqrt((pose_errors**2).mean())),
        cumulative_pose_error=float(pose_errors.sum()),
        mean_object_error=float(object_errors.mean()) if object_errors.size else float("nan"),
        num_objects=snapshot.num_objects,
        num_objects_true=len(np.unique(truth.obs_object[truth.obs_object >= 0])),
        ari=ari,
        v_measure=v_measure,
        observations_used=num_used / max(log.num_observations, 1),
        num_observations_used=num_used,
        chi2_per_dof=chi2_per_dof(fit(log, snapshot.labels, snapshot.graph.poses)),
    )


def distances_to_truth(snapshot: Snapshot, truth: GroundTruth) -> tuple[np.ndarray, np.ndarray]:
    """Distances after the best rigid alignment of the trajectories.

    Returns:
        (T,) m for the poses; (U,) m for the observations in use that are of real objects: how far the object that each
        was given to lies from the object it was of.
    """
    motion = se2.align(snapshot.graph.poses[:, :2], truth.poses[:, :2])
    pose_errors = np.linalg.norm(se2.apply(motion, snapshot.graph.poses[:, :2]) - truth.poses[:, :2], axis=1)
    used = (snapshot.labels >= 0) & (truth.obs_object >= 0)
    landmarks = se2.apply(motion, snapshot.graph.landmarks)
    true_xy = truth.world.object_xy[truth.obs_object[used]]
    return pose_errors, np.linalg.norm(landmarks[snapshot.labels[used]] - true_xy, axis=1)
