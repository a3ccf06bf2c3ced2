"""The paper's method with a part of the truth given: what breaks it, if not that part?

``poses_at_truth`` leaves the rule of association alone with its kernel; ``from_the_truth`` sets out from the right
answer, so that only the start of the descent is another; ``true_identities`` is the pose graph alone.
None of them is an estimator: all of them look at the truth.
"""

from dataclasses import replace

import numpy as np

from npslam_teach import se2
from npslam_teach.association import PAPER_ALPHA, same_partition, without_empty_objects
from npslam_teach.evaluation import true_association_fit
from npslam_teach.methods.np_graph import associate_anew
from npslam_teach.methods.snapshots import PAPER_OBSERVATION_STD, PAPER_ODOMETRY_STD, initial_snapshot, snapshot
from npslam_teach.pose_graph import observation_factors, odometry_factors, optimize
from npslam_teach.types import GroundTruth, RobotLog, Snapshot


def poses_at_truth(log: RobotLog, truth: GroundTruth, iterations: int = 5, **settings) -> Snapshot:
    """Sweep as ``np_graph`` does, every pose held where it truly was; only the objects move.

    Args:
        log: what the robot measured.
        truth: whose poses are given.
        iterations: at most so many alternations.
        settings: of ``np_graph``.
    """
    odometry_std, observation_std = _noise_in(settings)
    start = initial_snapshot(log, odometry_std, observation_std)
    landmarks = se2.apply(truth.poses[log.obs_time], log.obs_xy)
    held = {"fixed_poses": np.arange(log.num_poses)}
    start = replace(start, graph=replace(start.graph, poses=truth.poses, landmarks=landmarks))
    return _alternate(log, start, iterations, held, settings)


def from_the_truth(log: RobotLog, truth: GroundTruth, iterations: int = 5, **settings) -> Snapshot:
    """Alternate as ``np_graph`` does, but set out from the true associations and the best fit to them.

    Args: as in ``poses_at_truth``; every identity is given at the start, and none afterwards.
    """
    odometry_std, observation_std = _noise_in(settings)
    known = true_identities(log, truth)
    factors = odometry_factors(log, odometry_std), observation_factors(log, known.labels, observation_std)
    graph = replace(known.graph, between=factors[0], observations=factors[1])
    return _alternate(log, snapshot(log, 0, known.labels, graph), iterations, {}, settings)


def true_identities(log: RobotLog, truth: GroundTruth) -> Snapshot:
    """The pose graph alone, who is who being known: ``evaluation.true_association_fit`` as a method's result."""
    labels = without_empty_objects(truth.obs_object, truth.world.object_xy).labels
    return snapshot(log, 0, labels, true_association_fit(log, truth))


def _alternate(log: RobotLog, current: Snapshot, iterations: int, held: dict, settings: dict) -> Snapshot:
    rule = {name: value for name, value in settings.items() if name != "odometry_std"}
    for iteration in range(1, iterations + 1):
        labels, graph = associate_anew(log, current, **rule)
        same = same_partition(current.labels, labels)
        solved = optimize(replace(graph, **held))
        current = snapshot(log, iteration, labels, solved, settings.get("alpha", PAPER_ALPHA))
        if same:
            break
    return current


def _noise_in(settings: dict) -> tuple:
    """What the solver is to assume, the paper's where nothing else is said."""
    return (
        settings.get("odometry_std", PAPER_ODOMETRY_STD),
        settings.get("observation_std", PAPER_OBSERVATION_STD),
    )
