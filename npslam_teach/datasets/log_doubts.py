"""What is possible in a log, and more often a mistake of whoever wrote it: degrees, and rows too many or too few."""

import numpy as np

from npslam_teach import se2
from npslam_teach.types import RobotLog

FRAMES = 400  # so many are looked at, which is enough, and quick for the longest log
PAIRS = 20  # fewer sightings with one of their class in the frame before say nothing
FEW_ROWS = 3  # a longer end without a sighting is that of a robot that has left
CLEARLY = 2.0  # by this factor another reading must fit better


def doubts_about(log: RobotLog) -> list[str]:
    """Sentences about what is possible in a log, and more often a mistake of whoever wrote it."""
    gaps = _gaps(log, log.odometry)
    doubts = _about_turns(log, gaps), _about_turn_std(log), _about_headings(log), _about_rows(log, gaps)
    return [doubt for doubt in doubts if doubt]


def _about_turns(log: RobotLog, gaps: np.ndarray) -> str | None:
    turns = np.abs(log.odometry[:, 2])
    degrees = log.odometry * [1, 1, np.pi / 180]
    whole = np.where(turns > np.pi, np.abs(se2.wrap(turns)), 0.0)
    # A step across half a turn, whose difference of headings was not wrapped, is nearly a whole turn among small ones.
    not_wrapped = whole.max(initial=0.0) <= turns[turns <= np.pi].max(initial=0.0) < np.pi / 2
    if turns.max(initial=0.0) > np.pi and not not_wrapped and not _fits_better(gaps, _gaps(log, degrees)):
        turn = f"step {turns.argmax()} of odometry turns by {turns.max():.4g}"
        return f"{turn}, more than half a turn: expected radians, are these degrees?"
    if _fits_better(_gaps(log, degrees), gaps):
        return "observations fit together better if turns are degrees: expected radians, are these degrees?"
    return None


def _about_turn_std(log: RobotLog) -> str | None:
    std, turns = float(np.max(log.odometry_std[..., 2], initial=0.0)), np.abs(log.odometry[:, 2])
    if len(turns) < PAIRS or std < 0.3 or not 0 < turns.max() < std / 3:
        return None
    known = f"odometry_std: {std:.3g} for a turn, and no step turns by more than {turns.max():.3g}"
    return f"{known}: expected radians, are these degrees?"


def _about_headings(log: RobotLog) -> str | None:
    if log.obs_theta is None or np.abs(log.obs_theta).max(initial=0.0) <= 2 * np.pi:
        return None
    most = f"obs_theta goes up to {np.abs(log.obs_theta).max():.4g}"
    return f"{most}, more than a whole turn: expected radians, are these degrees?"


def _about_rows(log: RobotLog, gaps: np.ndarray) -> str | None:
    one_fewer = "expected one step fewer than there are poses, from each to the next"
    rests, last = (log.odometry == 0).all(axis=1), log.num_poses - 1
    unseen = last - log.obs_time.max(initial=0)
    if rests.sum() == 1 and (rests[0] or rests[-1]) and last > 1 and unseen > 0:
        end = "first" if rests[0] else "last"
        return (
            f"the {end} step of odometry is zero, and nothing is seen from the last pose: {one_fewer}; "
            "is it one row too many?"
        )
    if _fits_better(_gaps(log, np.vstack([log.odometry[1:], np.zeros((1, 3))])), gaps):
        return (
            f"observations fit together better without the first step of odometry: {one_fewer}; is it one row too many?"
        )
    if _fits_better(_gaps(log, np.vstack([np.zeros((1, 3)), log.odometry[:-1]])), gaps):
        return (
            f"observations fit together better if odometry begins one pose later: {one_fewer}; is it one row too few?"
        )
    times = np.unique(log.obs_time)
    if 0 < unseen <= FEW_ROWS and len(times) >= PAIRS and np.diff(times).max() == 1:
        poses = "pose" if unseen == 1 else f"{unseen} poses"
        return (
            f"something is seen from every pose between the first sighting and the last, and nothing from the last "
            f"{poses}: {one_fewer}; is it one row too many?"
        )
    return None


def _fits_better(gaps: np.ndarray, others: np.ndarray) -> bool:
    """Whether sightings of consecutive frames lie clearly nearer to each other, see ``_gaps``, than the others do."""
    return len(gaps) >= PAIRS and bool(np.median(others) > CLEARLY * np.median(gaps))


def _gaps(log: RobotLog, odometry: np.ndarray) -> np.ndarray:
    """How far sightings are, in metres, from the nearest one of their class in the frame before, along odometry."""
    path, in_time = se2.dead_reckoning(odometry), np.argsort(log.obs_time, kind="stable")
    frames = np.split(in_time, np.flatnonzero(np.diff(log.obs_time[in_time])) + 1)[: FRAMES + 1]
    if len(frames) < 2:
        return np.empty(0)
    poses, gaps = path[log.obs_time[[frame[0] for frame in frames]]], []
    for before, now, step in zip(frames, frames[1:], se2.between(poses[:-1], poses[1:]), strict=False):
        gap = np.linalg.norm(se2.apply(step, log.obs_xy[now])[:, None] - log.obs_xy[before], axis=2)
        alike = log.obs_class[now][:, None] == log.obs_class[before]
        gaps.append(np.where(alike, gap, np.inf).min(axis=1))
    gaps = np.concatenate(gaps)
    return gaps[np.isfinite(gaps)]
