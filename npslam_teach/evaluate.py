"""How good is an estimate? The only place, with ``plotting``, that looks at the truth.

The estimate lives in the frame of its own first pose, so it is first laid over the truth by the rigid motion that
fits the trajectory best; only then are distances measured.
"""

from dataclasses import asdict, dataclass

import numpy as np

from npslam_teach import se2
from npslam_teach.associate import without_empty_objects
from npslam_teach.data import GroundTruth, PoseGraph, RobotLog, Snapshot
from npslam_teach.methods.common import mean_landmarks, observation_factors, odometry_factors
from npslam_teach.pose_graph import chi2, optimize


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
        chi2_per_dof=chi2_per_dof(sensor_fit(log, snapshot.labels, snapshot.graph.poses)),
    )


def distances_to_truth(snapshot: Snapshot, truth: GroundTruth) -> tuple[np.ndarray, np.ndarray]:
    """Distances after the best rigid alignment of the trajectories.

    Returns:
        (T,) m for the poses; (U,) m for the observations in use that are of real objects: how far the object that each
        was given to lies from the object it was of.
    """
    motion = se2.align(snapshot.graph.poses[:, :2], truth.poses[:, :2])
    pose_errors = np.linalg.norm(se2.transform_to(motion, snapshot.graph.poses[:, :2]) - truth.poses[:, :2], axis=1)
    used = (snapshot.labels >= 0) & (truth.obs_object >= 0)
    landmarks = se2.transform_to(motion, snapshot.graph.landmarks)
    true_xy = truth.world.object_xy[truth.obs_object[used]]
    return pose_errors, np.linalg.norm(landmarks[snapshot.labels[used]] - true_xy, axis=1)


def sensor_fit(log: RobotLog, labels: np.ndarray, poses: np.ndarray) -> PoseGraph:
    """The best fit to the log, at the noise of its own sensors, that given associations allow.

    Args:
        log: what was measured.
        labels: (M,) index of the object, from 0 without gaps; -1 leaves the observation out.
        poses: (T, 3) W, from which the solver sets out.
    """
    obs_xy_world = se2.transform_to(poses[log.obs_time], log.obs_xy)
    return optimize(
        PoseGraph(
            poses,
            mean_landmarks(labels, obs_xy_world),
            odometry_factors(log, log.odometry_std),
            observation_factors(log, labels, log.observation_std),
        )
    )


def true_association_fit(log: RobotLog, truth: GroundTruth) -> PoseGraph:
    """The pose graph that somebody who knows every identity would get: the best any method can do with this log.

    Its objects are those that were seen, in the order of the world; it starts at the true first pose.
    """
    labels = without_empty_objects(truth.obs_object, truth.world.object_xy).labels
    return sensor_fit(log, labels, truth.poses)


def chi2_per_dof(graph: PoseGraph) -> float:
    """chi2 over its degrees of freedom, measured numbers minus unknowns: near 1 when model and data agree.

    NaN where nothing is left over, as when every observation is an object of its own.
    """
    measured = 3 * len(graph.between.i) + 2 * len(graph.observations.pose)
    unknown = 3 * (len(graph.poses) - 1) + 2 * len(graph.landmarks)
    return chi2(graph) / (measured - unknown) if measured > unknown else float("nan")


def singletons_for_unassigned(labels: np.ndarray) -> np.ndarray:
    """Give every -1 (clutter, or left out) a cluster of its own: it belongs with nothing else."""
    alone = labels < 0
    fresh = labels.max(initial=-1) + 1 + np.arange(np.count_nonzero(alone))
    labels = np.array(labels)
    labels[alone] = fresh
    return labels


def compare_partitions(true_labels: np.ndarray, labels: np.ndarray) -> tuple[float, float]:
    """Adjusted Rand index (Hubert and Arabie 1985) and V-measure (Rosenberg and Hirschberg 2007).

    Both are 1 for the same partition, whatever the clusters are called. ARI is 0 on average for a random one.

    Args:
        true_labels: (M,) non-negative integers.
        labels: (M,) non-negative integers.
    """
    _, row = np.unique(true_labels, return_inverse=True)
    _, col = np.unique(labels, return_inverse=True)
    num_rows, num_cols = row.max(initial=-1) + 1, col.max(initial=-1) + 1
    # Only the cells of the contingency table that are not empty: 1098 singletons must not make a 1098 x 1098 table.
    cells = np.unique(row * max(num_cols, 1) + col, return_counts=True)[1]
    rows, cols = np.bincount(row, minlength=num_rows), np.bincount(col, minlength=num_cols)
    return _adjusted_rand(cells, rows, cols), _v_measure(cells, rows, cols)


def _adjusted_rand(cells: np.ndarray, rows: np.ndarray, cols: np.ndarray) -> float:
    together, in_true, in_found, pairs = (_num_pairs(counts) for counts in (cells, rows, cols, rows.sum()))
    expected = in_true * in_found / pairs if pairs else 0.0
    most = (in_true + in_found) / 2
    return 1.0 if most == expected else float((together - expected) / (most - expected))


def _num_pairs(counts: np.ndarray) -> float:
    return float((counts * (counts - 1.0) / 2).sum())


def _v_measure(cells: np.ndarray, rows: np.ndarray, cols: np.ndarray) -> float:
    """Harmonic mean of homogeneity ``I / H(true)`` and completeness ``I / H(found)``: ``2 I / (H + H)``."""
    h_true, h_found, h_joint = (_entropy(counts) for counts in (rows, cols, cells))
    total = h_true + h_found
    return 1.0 if total == 0 else float(2 * (total - h_joint) / total)


def _entropy(counts: np.ndarray) -> float:
    share = counts[counts > 0] / max(counts.sum(), 1)
    return float(-(share * np.log(share)).sum())
