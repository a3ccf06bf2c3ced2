"""Two scenes of eight observations of chairs, fixed by hand: all 4140 partitions of each can be listed.

A robot drives around a square of 2 m and comes back to where it was. Nothing is random in them: even the slip of the
wheels is fixed. ``drawn_world`` has six observations on the same round, of chairs that are drawn from the prior.
"""

import numpy as np

from npslam_teach import se2
from npslam_teach.association.partition_posterior import TrackletEvidence
from npslam_teach.methods.posterior import start_model
from npslam_teach.pose_graph.reduced_system import reduced_system
from npslam_teach.simulate.from_prior import chairs_from_prior
from npslam_teach.types import GroundTruth, RobotLog, World

CLASS_NAMES = ("chair",)
QUARTER = np.pi / 2
ROOM_AREA = 16.0  # m^2, of both scenes
SLIP = 0.4  # m, what the wheels report too much between pose 3 and pose 4
ODOMETRY_STD, OBSERVATION_STD = (0.2, 0.05, 0.02), (0.1, 0.1)  # m, m, rad per step; m

ROUND = np.array([[1.0, 0, 0], [1.0, 0, QUARTER], [2.0, 0, QUARTER], [2.0, 0, QUARTER], [2.0, 0, QUARTER], [1.0, 0, 0]])
THREE_CHAIRS = np.array([[1.0, -1.0], [1.6, -1.0], [1.2, 3.0]])  # m: A, B, C
SEEN = ((0, 0), (0, 1), (1, 0), (1, 1), (2, 2), (3, 2), (5, 1), (6, 1))  # observation 1 ..: (pose, chair)

SLOW = np.array([[0.3, 0, 0]] * 3)
SLOW_ROUND = np.concatenate([SLOW, [[1.1, 0, QUARTER]], [[2.0, 0, QUARTER]] * 3, SLOW])
TWO_CHAIRS = np.array([[1.0, -1.0], [2.3, -1.0]])  # m
SEEN_SLOWLY = tuple((pose, int(pose > 3)) for pose in (0, 1, 2, 3, 7, 8, 9, 10))

DRAWN_AT, DRAWN_SIDE = (0, 1, 2, 4, 5, 6), 2.0  # poses, three before most of the drift and three after; m


def eight_sightings() -> tuple[RobotLog, GroundTruth]:
    """Chairs A and B stand 0.6 m apart, C across the room; after the round chair B is observed twice more.

    The wheels slip by 0.4 m on the way, so that along the odometry path B is seen 0.2 m from A and 0.4 m from B.
    """
    steps = ROUND.copy()
    steps[3, 0] += SLIP
    return _run(ROUND, steps, THREE_CHAIRS, SEEN)


def four_and_four() -> tuple[RobotLog, GroundTruth]:
    """Four observations of a chair, a round, and four of a chair that stands 1.3 m further on; the wheels do not slip.

    Drift could explain that distance, so there may be one chair or two.
    """
    return _run(SLOW_ROUND, SLOW_ROUND, TWO_CHAIRS, SEEN_SLOWLY)


def drawn_world(rng: np.random.Generator, noise: float = 1.0) -> tuple[RobotLog, GroundTruth]:
    """Six observations of chairs from a Chinese restaurant process with alpha 1, uniform over a square of 2 m.

    Args:
        rng: draws everything.
        noise: how many times larger the errors really are than the log says.
    """
    stds = ODOMETRY_STD, OBSERVATION_STD
    return chairs_from_prior(rng, ROUND, DRAWN_AT, *stds, side=DRAWN_SIDE, noise=noise)


def evidence_of(log: RobotLog, alpha: float = 1.0, area: float = ROOM_AREA) -> TrackletEvidence:
    """What a short log says of its observations, each a tracklet of its own: linearised along the odometry path.

    Args:
        log: of at most 64 observations.
        alpha: concentration.
        area: m^2, over which chairs are uniform.
    """
    model, graph = start_model(log, alpha, area)
    return model.evidence(reduced_system(graph))


def _run(true_steps: np.ndarray, steps: np.ndarray, chairs: np.ndarray, seen: tuple) -> tuple[RobotLog, GroundTruth]:
    poses = se2.dead_reckoning(true_steps)
    time, chair = np.array(seen).T
    log = RobotLog(
        odometry=steps,
        obs_time=time,
        obs_xy=se2.apply_inverse(poses[time], chairs[chair]).round(12),
        obs_class=np.zeros(len(time), dtype=int),
        num_classes=1,
        odometry_std=ODOMETRY_STD,
        observation_std=OBSERVATION_STD,
    )
    return log, GroundTruth(World(chairs, np.zeros(len(chairs), dtype=int), CLASS_NAMES), poses, chair)
