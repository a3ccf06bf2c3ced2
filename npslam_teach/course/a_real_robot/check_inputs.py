"""What the checks of this lesson try where that takes more than a few lines: random inputs, and edge cases."""

import numpy as np

from npslam_teach import se2
from npslam_teach.course.trials import fresh


def growth_inputs() -> tuple[list, dict]:
    """Arguments of ``check_growth``: its trials, and its edges by the situation."""
    rng, trials = fresh(), []
    # In the last the robot turns by 3.0 rad within a stretch, and its wheels report more than half a turn.
    for n, turn, turn_std, noise_std in (*((n, 0.2, 0.3, 0.3) for n in (2, 5, 10)), (3, 1.0, 0.01, 0.05)):
        steps = np.column_stack([rng.uniform(0.05, 0.15, 40), rng.normal(0, 0.01, 40), rng.normal(turn, turn_std, 40)])
        poses = se2.dead_reckoning(steps, (1.0, 2.0, 3.0))
        bias = np.array([0.01, 0.0, 0.08])  # the heading of the wheels comes to leave the true one by half a turn
        trials.append((steps + bias + rng.normal(size=(40, 3)) * (0.01, 0.005, noise_std), poses, n))
    odometry, poses, _ = trials[0]
    edges = {
        "with single steps": [(odometry, poses, 1)],
        "with a single stretch, the whole path": [(odometry, poses, len(odometry))],
        "with wheels that do not err": [(odometry, se2.dead_reckoning(odometry), 4)],
    }
    return trials, edges


def first_of_each_pass_inputs() -> tuple[list, dict]:
    """Arguments of ``check_first_of_each_pass``: its trials, and its edges by the situation."""
    rng, trials = fresh(), []
    for gap in (3, 10, 5, 2):
        count = 40
        times = np.cumsum(rng.choice([1, gap, gap, gap + 1], count))  # no two sightings of an object in one frame
        labels = rng.choice([-1, 0, 1, 1, 1], count)
        order = rng.permutation(count)
        trials.append((labels[order], times[order], gap))
    nobody = np.empty(0, dtype=int)
    edges = {
        "with no sighting": [(nobody, nobody, 5)],
        "with labels of -1 alone": [(np.full(4, -1), np.array([3, 1, 50, 9]), 5)],
        "with a single sighting": [(np.zeros(1, dtype=int), np.array([7]), 5)],
        "with large numbers for objects": [(np.array([900, 5, 900, 900]), np.array([1, 2, 3, 40]), 5)],
    }
    return trials, edges
