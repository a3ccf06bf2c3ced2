"""Runs whose chairs are drawn from the prior of the posterior method, so that its probabilities can be checked.

Probabilities are calibrated when, of all pairs that were given probability p, a share of p are really one object. This
can be expected only of worlds that are drawn from the model itself: associations from a Chinese restaurant process,
chairs uniform over a square, white Gaussian noise.
"""

import numpy as np

from npslam_teach import se2
from npslam_teach.types import GroundTruth, RobotLog, World
from npslam_teach.validation import checked_array

CORNER = (0.0, -2.5)  # m, the lower left of the square in which chairs stand


def chairs_from_prior(
    rng: np.random.Generator,
    steps: np.ndarray,
    obs_time,
    odometry_std,
    observation_std,
    alpha: float = 1.0,
    side: float = 2.0,
    noise: float = 1.0,
) -> tuple[RobotLog, GroundTruth]:
    """One observation at each of the given poses, of a chair that a Chinese restaurant process chooses.

    Args:
        rng: draws the associations, the chairs, the observation noise and the odometry noise.
        steps: (T-1, 3) the true motion, R_{t+1} in R_t.
        obs_time: (M,) index of the pose of each observation.
        odometry_std: (3,) m, m, rad per step, as the log will say.
        observation_std: (2,) m, as the log will say.
        alpha: concentration of the restaurant.
        side: m, of the square.
        noise: how many times larger the errors really are than the log says.

    Returns:
        the log and the truth, in the frame of the first pose.
    """
    steps, obs_time = checked_array("steps", steps, (None, 3)), np.asarray(obs_time, dtype=int)
    chair: list[int] = []
    for _ in obs_time:
        weights = np.append(np.bincount(chair), alpha) if chair else np.ones(1)
        chair.append(int(rng.choice(len(weights), p=weights / weights.sum())))
    num_chairs = max(chair, default=-1) + 1
    world = World(CORNER + rng.uniform(0.0, side, (num_chairs, 2)), np.zeros(num_chairs, dtype=int), ("chair",))
    poses = se2.dead_reckoning(steps)
    xy = se2.apply_inverse(poses[obs_time], world.object_xy[chair])
    xy = xy + noise * rng.normal(size=xy.shape) * observation_std
    odometry = steps + noise * rng.normal(size=steps.shape) * odometry_std
    log = RobotLog(odometry, obs_time, xy, np.zeros(len(chair), dtype=int), 1, odometry_std, observation_std)
    return log, GroundTruth(world, poses, np.array(chair))
