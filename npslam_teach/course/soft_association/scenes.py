"""The scene of lesson 13 in which two look-alikes stand side by side."""

import numpy as np

from npslam_teach.simulate import simulate_run
from npslam_teach.types import GroundTruth, RobotLog, SensorModel, World


def two_chairs(seed: int, apart: float = 0.3) -> tuple[RobotLog, GroundTruth]:
    """Two chairs and a screen, seen together from an arc around them by a camera that errs by 0.15 m.

    Args:
        seed: of the noise.
        apart: m, between the two chairs.
    """
    world = World([[0.0, 2.0], [apart, 2.0], [1.0, 2.6]], [0, 0, 1], ("chair", "screen"))
    angle = np.linspace(-0.5, 0.5, 40)
    path = np.column_stack([2.5 * np.sin(angle), 0.3 - 0.2 * np.cos(angle), np.pi / 2 + angle])
    sensor = SensorModel((0.02, 0.02, 0.01), (0.15, 0.15), 4.0, 2.0)
    return simulate_run(world, path, sensor, np.random.default_rng(seed))
