"""What the checks of this lesson try where that takes more than a few lines: random inputs, and edge cases."""

import numpy as np

from npslam_teach.course.trials import fresh


def add_object_inputs() -> tuple[list, dict]:
    """Arguments of ``check_add_object``: its trials, and its edges by the situation."""
    rng, trials = fresh(), []
    for size in (5, 3, 9, 7):
        mean = np.append(rng.uniform(-3, 3, 3), rng.uniform(-5, 5, size - 3))
        trials.append((mean, covariance(rng, size), rng.uniform(-3, 3, 2), rng.uniform(0.2, 1.2, 2)))
    mean, cov, xy, std = trials[0]
    edges = {
        "with the object at the robot": [(mean, cov, np.zeros(2), std)],
        "with a state that is known exactly": [(mean, np.zeros((5, 5)), xy, std)],
    }
    return trials, edges


def match_frame_inputs() -> tuple[list, dict]:
    """Arguments of ``check_match_frame``: its trials, and its edges by the situation."""
    rng, trials = fresh(), [(np.array([[1.0, 2.0], [1.5, 8.0]]), 9.0)]
    trials += [(np.array([[0.0, 9.1], [0.1, 30.0]]), 9.0), (np.array([[4.0]]), 3.0)]
    trials += [(np.array([[0.0, 8.0], [8.0, 30.0]]), 9.0)]  # one good pair is better than two bad ones
    while len(trials) < 60:
        trials.append((rng.uniform(0, 14, rng.integers(1, 4, 2)), float(rng.choice([4.0, 9.0, rng.uniform(2, 12)]))))
    edges = {
        "with no object yet": [(np.empty((2, 0)), 9.0)],
        "with no sighting": [(np.empty((0, 3)), 9.0)],
        "with objects of other classes, which are infinitely far away": [
            (np.where(rng.random(d.shape) < 0.4, np.inf, d), gate) for d, gate in trials[3:18]
        ],
        "with two pairs that are all but beyond the gate, or a perfect one": [
            (np.array([[0.0, 8.0], [8.0, np.inf]]), 9.0)
        ],
        "with infinite distances alone": [(np.full((2, 2), np.inf), 9.0)],
    }
    return trials, edges


def covariance(rng: np.random.Generator, size: int) -> np.ndarray:
    """A random covariance (size, size) without small eigenvalues."""
    root = rng.normal(size=(size, size))
    return root @ root.T + 0.1 * np.eye(size)
