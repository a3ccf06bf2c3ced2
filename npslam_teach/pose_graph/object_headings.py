"""Which way objects face: from the headings of a log to the factors and the start of a pose graph.

Headings of something symmetric are equal up to a part of a turn. A round object has none; so that every landmark of a
graph has the same three numbers, it is *called* to face as pose 0 does, by a single factor that asks nothing of
anything else. So is an object whose headings are no better than a guess.
"""

from dataclasses import replace

import numpy as np

from npslam_teach import se2
from npslam_teach.types import NO_HEADINGS, HeadingFactors, PoseGraph, RobotLog
from npslam_teach.validation import checked_array, require_positive

GUESS = 1 / np.sqrt(12)  # the standard deviation of a uniform guess, as a share of its range


def symmetries(log: RobotLog) -> np.ndarray:
    """How many headings of each observation's object look alike, (M,): by its reported class; 0 where nothing is said.

    Nothing is said by a log without headings, of a round class, and by headings that err as much as a guess does.
    """
    if log.obs_theta is None:
        return np.zeros(log.num_observations, dtype=int)
    of_class = np.ones(log.num_classes, dtype=int) if log.class_symmetry is None else log.class_symmetry
    guess = GUESS * 2 * np.pi / np.maximum(of_class, 1)
    return np.where(log.observation_theta_std < guess, of_class, 0)[log.obs_class]


def symmetry_of_objects(labels: np.ndarray, symmetry: np.ndarray) -> np.ndarray:
    """(K,) of each object: the largest of its observations (M,), where a confused class says different things."""
    of_objects = np.zeros(labels.max(initial=-1) + 1, dtype=int)
    np.maximum.at(of_objects, labels[labels >= 0], symmetry[labels >= 0])
    return of_objects


def mean_headings(labels: np.ndarray, theta: np.ndarray, symmetry: np.ndarray) -> np.ndarray:
    """The circular mean of each object's headings, (K,) rad in W; 0 for one that has none.

    Turned n times as far, headings that look alike are the same angle, which has a mean on the circle.

    Args:
        labels: (M,) index of the object; -1 = of none.
        theta: (M,) rad, W.
        symmetry: (M,) see ``symmetries``.
    """
    of_objects = symmetry_of_objects(labels, symmetry)
    used = np.flatnonzero((labels >= 0) & (symmetry > 0))
    parts, sums = of_objects[labels[used]], np.zeros(len(of_objects), dtype=complex)
    np.add.at(sums, labels[used], np.exp(1j * parts * theta[used]))
    return np.angle(sums) / np.maximum(of_objects, 1)


def heading_factors(log: RobotLog, labels: np.ndarray, heading_std: float | None = None) -> HeadingFactors:
    """One factor for every heading of an object, and one for each object that has none.

    Args:
        log: what was measured.
        labels: (M,) index of the object, from 0 without gaps; -1 leaves an observation out.
        heading_std: rad, what the solver assumes; None: what the log says.
    """
    if log.obs_theta is None:
        return NO_HEADINGS
    std = log.observation_theta_std if heading_std is None else checked_array("heading_std", heading_std, ()).item()
    require_positive("heading_std", np.array(std))
    symmetry = symmetries(log)
    of_objects = symmetry_of_objects(labels, symmetry)
    used = np.flatnonzero((labels >= 0) & (symmetry > 0))
    none = np.flatnonzero(of_objects == 0)
    nothing, one = np.zeros(len(none), dtype=int), np.ones(len(none), dtype=int)
    return HeadingFactors(
        np.append(log.obs_time[used], nothing),
        np.append(labels[used], none),
        np.append(log.obs_theta[used], nothing),
        np.append(of_objects[labels[used]], one),
        np.full((len(used) + len(none), 1, 1), std**-2.0),
    )


def with_headings(log: RobotLog, graph: PoseGraph, labels, landmarks, heading_std: float | None = None) -> PoseGraph:
    """The graph with these landmarks and, where the log has headings, their own: (K, 3), and the factors of them.

    Args:
        log: what was measured.
        graph: its poses; its landmarks do not count.
        labels: (M,) index of the object of each observation; -1 leaves it out.
        landmarks: (K, 2) m, W; or (K, 3), whose headings are kept.
        heading_std: as in ``heading_factors``.
    """
    landmarks = np.asarray(landmarks)
    if log.obs_theta is None:
        return replace(graph, landmarks=landmarks, headings=NO_HEADINGS)
    if landmarks.shape[1] == 2:
        theta = se2.wrap(graph.poses[log.obs_time, 2] + log.obs_theta)
        landmarks = np.column_stack([landmarks, mean_headings(labels, theta, symmetries(log))])
    return replace(graph, landmarks=landmarks, headings=heading_factors(log, labels, heading_std))


def positions_only(graph: PoseGraph) -> PoseGraph:
    """The same graph without the headings of its landmarks."""
    return replace(graph, landmarks=graph.landmark_xy, headings=NO_HEADINGS)


def faced_from(graph: PoseGraph, poses: np.ndarray, landmark_xy: np.ndarray) -> np.ndarray:
    """Landmarks where they are said to be (K, 2) m, W, facing as they are seen from these poses (T, 3), if they do.

    Returns:
        (K, 2), or (K, 3) for a graph with headings; the estimate of a heading that is fixed, or has no factor.
    """
    if graph.landmarks.shape[1] == 2:
        return landmark_xy
    seen, theta = graph.headings, graph.landmarks[:, 2].copy()
    found = mean_headings(seen.landmark, poses[seen.pose, 2] + seen.theta, seen.symmetry)
    moves = np.setdiff1d(seen.landmark, graph.fixed_landmarks)
    theta[moves] = found[moves]
    return np.column_stack([landmark_xy, theta])
