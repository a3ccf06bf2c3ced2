"""What the checks of this lesson try where that takes more than a few lines: random inputs, and edge cases."""

import numpy as np

from npslam_teach.course.trials import fresh


def position_variance_inputs() -> tuple[list, dict]:
    """Arguments of ``check_position_variance``: its trials, and its edges by the situation."""
    rng, trials = fresh(), []
    for num_objects in (3, 5, 4, 5, 3):
        labels = rng.permutation(np.concatenate([np.arange(num_objects), rng.integers(0, num_objects - 1, 20)]))
        trials.append((rng.normal(size=(len(labels), 2)) + 3.0 * labels[:, None], labels, num_objects))
    xy, labels, num_objects = trials[0]
    left_out = np.append(labels, [-1, -1, -1])
    edges = {
        "with labels of -1, which are of no object": [
            (np.vstack([xy, rng.normal(size=(3, 2))]), left_out, num_objects)
        ],
        "with one object, seen once": [(xy[:1], np.zeros(1, dtype=int), 1)],
        "with an object that has no sighting, for which 0 and NaN will do": [
            (xy, np.minimum(labels, num_objects - 2), num_objects),
            (np.vstack([xy, rng.normal(size=(3, 2))]), np.minimum(left_out, num_objects - 2), num_objects),
        ],
    }
    return trials, edges
