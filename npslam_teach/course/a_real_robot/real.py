"""The lesson in short, on a recording of MRCLAM that the reader has fetched."""

import numpy as np

from npslam_teach import datasets
from npslam_teach.course.a_real_robot import errors
from npslam_teach.evaluation import evaluate
from npslam_teach.experiments.real_robot import answer_of, scaled
from npslam_teach.types import GroundTruth, RobotLog

SKIPPED = "no folder of MRCLAM was given: skipped"


def report(folder, robot: int = 1, num_classes: int = 5) -> str:
    """What this lesson measures, of one robot in a folder of MRCLAM; one line where there is no folder.

    Args:
        folder: with the text files; None: skipped.
        robot: 1 to 5.
        num_classes: 1 for landmarks that all look alike.

    Raises:
        FileNotFoundError: a file is missing.
        ValueError: a file is not what it should be.
    """
    if folder is None:
        return SKIPPED
    log, truth = datasets.load_mrclam(folder, robot, num_classes)
    lines = [f"{log.num_poses} poses, {log.num_observations} sightings of {log.num_classes} classes"]
    return "\n".join(lines + _errors(log, truth) + _methods(log, truth))


def _errors(log: RobotLog, truth: GroundTruth) -> list[str]:
    off = errors.sighting_errors(log, truth)
    known = ~np.isnan(off[:, 0])
    order, passes = errors.in_passes(np.where(known, truth.obs_object, -1), log.obs_time)
    one, twenty = (errors.growth(log.odometry, truth.poses, n) for n in (1, 20))
    ahead, _, turn = twenty / one / np.sqrt(20)
    outside = 1 - known.mean() * (1 - errors.share_outside(off[known], log.observation_std))
    lines = [
        f"lag-1 correlation in a pass: {errors.lag_one(errors.along_the_ray(log, off)[order], passes):.2f}",
        f"20 steps err by {ahead:.1f} (ahead) and {turn:.1f} (turn) times what white noise would",
        f"beyond the 99 % gate: {100 * outside:.1f} %",
    ]
    if not np.isnan(truth.poses).any():
        nees, chi2_per_dof = errors.landmark_nees(log, truth)
        lines.append(f"true identities: chi2 per dof {chi2_per_dof:.2f}, NEES / 2 {nees.mean() / 2:.1f}")
    return lines


def _methods(log: RobotLog, truth: GroundTruth) -> list[str]:
    lines = []
    for name in ("ekf", "posterior"):
        for factor in (1.0, 2.0):
            found = evaluate(answer_of(name, scaled(log, factor), {}), truth, log)
            numbers = f"{found.num_objects} objects, ARI {found.ari:.2f}, path off by {found.mean_pose_error:.2f} m"
            lines.append(f"{name}, noise times {factor:g}: {numbers}")
    return lines
