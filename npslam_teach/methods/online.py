"""Online: one frame after the other, each in bounded time, and associations that can still be revised.

A filter decides once and for all; ``posterior`` waits for the end of the drive. This stands between them. What is in
view is tied into tracklets (``tracklets``); a new tracklet goes to the object that is most probable with trajectory and
map integrated out, and may change it for the next hundred poses: every few frames all tracklets of that window are
asked again by Gibbs moves (``recent``). What is older moves as a whole object only. Trajectory and map are kept by
``pose_graph.SubmapTree``, in which a frame redoes what it touches. ``robot.Online`` has all of it; around the
robot at most ``MOST_NEAR`` old objects are at hand, so that the time of a frame does not depend on how many there are.

It is for buildings of a few rooms. Of a hundred, in rows of ten, it drove through thirteen with chi2 per observation as
at the start; by then passes of the second row had been merged with objects of the first, and in the fifteenth room a
variance of the pose came out negative. Mergers that are probable only together are not taken back.
"""

from collections.abc import Iterator

import numpy as np

from npslam_teach import se2
from npslam_teach.association import require_alpha, require_area, without_empty_objects
from npslam_teach.methods.gating import frames_of
from npslam_teach.methods.noise import observation_covariances, step_covariances, with_noise
from npslam_teach.methods.oriented import without_headings
from npslam_teach.methods.posterior import in_time
from npslam_teach.methods.repair import completed
from npslam_teach.methods.robot import WINDOW, Estimate, Online
from npslam_teach.methods.snapshots import initial_snapshot, snapshot
from npslam_teach.methods.tracklets import LONGEST_GAP
from npslam_teach.pose_graph import fit, observation_factors, odometry_factors, with_associations
from npslam_teach.system.progress import track
from npslam_teach.types import PoseGraph, RobotLog, Snapshot

TENTHS = 10  # snapshots of a drive


def online(
    log: RobotLog,
    alpha: float = 0.1,
    *,
    area: float | None = None,
    window: int = WINDOW,
    odometry_std=None,
    observation_std=None,
    seed: int = 0,
) -> Iterator[Snapshot]:
    """Take a log frame by frame, as a robot does that is under way.

    Args:
        log: what the robot measured.
        alpha: how many objects are expected where none was seen, per object where some were.
        area: m^2 over which objects are uniform; None: the box around all that was seen so far.
        window: poses out of sight after which a tracklet keeps its object.
        odometry_std: (3,) m, m, rad per step; None: what the log says.
        observation_std: (2,) m; None: what the log says.
        seed: of the random numbers.

    Yields:
        the frame-by-frame start; what is believed after each tenth of the drive, the rest of the path as odometry has
        it and what is not seen yet labelled -1; the result, in which what was left out is looked at again with the
        whole map at hand. What fits no object has label -1.
    """
    require_alpha(alpha)
    if window != int(window) or window < LONGEST_GAP:
        raise ValueError(f"window: expected a whole number of poses, {LONGEST_GAP} or more, got {window}")
    if area is not None:
        require_area(area)
    log = with_noise(without_headings(log), odometry_std, observation_std)
    yield initial_snapshot(log)
    ordered, back = in_time(log)
    settings = {"alpha": alpha, "area": area, "window": int(window), "seed": seed}
    for iteration, (labels, graph) in enumerate(_driven(ordered, settings), 1):
        graph = with_associations(log, graph, labels[back], graph.landmarks)
        yield snapshot(log, iteration, labels[back], graph)


def _driven(log: RobotLog, settings: dict) -> Iterator[tuple[np.ndarray, PoseGraph]]:
    """Labels (M,) and a graph with one landmark for each object, after each tenth and at the end."""
    robot = Online(log.num_classes, log.odometry_std, log.observation_std, **settings)
    stops = set(np.linspace(0, log.num_poses, TENTHS + 1)[1:-1].astype(int))
    for time, _ in enumerate(track(frames(robot, log), log.num_poses, "online", "frames")):
        if time + 1 in stops and len(robot.tracklet_of):
            yield so_far(robot, log)
    robot.settle_all()
    labels, graph = so_far(robot, log)
    labels = completed(log, graph, labels)
    yield labels, fit(log, labels, graph.poses)


def frames(robot: Online, log: RobotLog) -> Iterator[Estimate]:
    """Give a robot all frames of a log, observations in the order of the poses; its estimate after each."""
    steps, sights = step_covariances(log), observation_covariances(log)
    for time, seen in enumerate(frames_of(log)):
        step = (None, None) if time == 0 else (log.odometry[time - 1], steps[time - 1])
        probabilities = None if log.class_probabilities is None else log.class_probabilities[seen]
        yield robot.add_frame(step[0], log.obs_xy[seen], log.obs_class[seen], probabilities, step[1], sights[seen])


def so_far(robot: Online, log: RobotLog) -> tuple[np.ndarray, PoseGraph]:
    """What a robot believes now, as labels (M,) of a log and its graph; the rest of the path is dead reckoning."""
    graph, _ = robot.tree.graph()
    rest = se2.dead_reckoning(log.odometry[len(graph.poses) - 1 :], graph.poses[-1])
    believed = without_empty_objects(robot.labels, robot.tree.landmarks())
    labels = np.append(believed.labels, np.full(log.num_observations - len(believed.labels), -1))
    poses, factors = np.concatenate([graph.poses, rest[1:]]), (odometry_factors(log), observation_factors(log, labels))
    return labels, PoseGraph(poses, believed.landmarks, *factors)
