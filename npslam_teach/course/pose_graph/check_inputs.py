"""What the checks of this lesson try where that takes more than a few lines: random inputs, and edge cases."""

import numpy as np

from npslam_teach import se2
from npslam_teach.course.trials import fresh


def between_residual_inputs() -> tuple[list, dict]:
    """Arguments of ``check_between_residual``: its trials, and its edges by the situation."""
    rng, trials = fresh(), []
    # The last three cross 180 degrees: between the two headings, or between the turn and its measurement.
    for theta_i, theta_j in [
        (0.3, 0.9),
        (1.2, -0.4),
        (3.0, -3.0),
        (-3.1, 3.1),
        (-0.1, 3.0),
        *rng.uniform(-3, 3, (9, 2)),
    ]:
        pose_i, pose_j = np.append(rng.uniform(-3, 3, 2), theta_i), np.append(rng.uniform(-3, 3, 2), theta_j)
        trials.append((pose_i, pose_j, np.append(rng.uniform(-1, 1, 2), se2.wrap(theta_j - theta_i + 0.1))))
    still = np.array([1.0, -2.0, 3.0])
    edges = {"with a robot that stands still": [(still, still.copy(), np.zeros(3))]}
    return trials, edges
