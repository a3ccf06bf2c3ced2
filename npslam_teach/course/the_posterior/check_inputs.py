"""What the checks of this lesson try where that takes more than a few lines: random inputs, and edge cases."""

import numpy as np

from npslam_teach.course.trials import fresh


def eliminate_inputs() -> tuple[list, dict]:
    """Arguments of ``check_eliminate``: its trials, and its edges by the situation."""
    rng, trials = fresh(), []
    for n, m in ((1, 2), (3, 4), (6, 2), (2, 5), (4, 3)):
        root = rng.normal(size=(n + m, n + m))
        trials.append((root @ root.T + 0.3 * np.eye(n + m), rng.normal(size=n + m), n))
    H, b, n = trials[1]
    apart = np.diag(np.diag(H))
    edges = {
        "with poses and landmarks that share nothing": [(apart, b, n)],
        "without poses": [(H, b, 0)],
        "at the minimum, where b is zero": [(H, np.zeros(len(b)), n)],
    }
    return trials, edges


def merge_acceptance_inputs() -> tuple[list, dict]:
    """Arguments of ``check_merge_acceptance``: its trials, and its edges by the situation."""
    rng, trials = fresh(), []
    for n in (1, 2, 3, 5, 2, 4):
        apart, weights, sits = rng.normal(-20, 3), rng.normal(0, 1.5, (n, 2)), rng.integers(0, 2, n)
        trials += [(apart, apart + gain, weights, sits) for gain in (-1.0, 0.7, 9.0)]
    apart, merged, weights, sits = trials[6]
    edges = {
        "with two sightings alone in their objects": [(-20.0, -20.5, np.empty((0, 2)), np.empty(0, dtype=int))],
        "with log weights of -900, which have no exponential": [(apart, merged, weights - 900.0, sits)],
        "with a merger that is far better": [(-2000.0, -900.0, weights, sits)],
        "with a merger that is far worse": [(-900.0, -2900.0, weights, sits)],
    }
    return trials, edges
