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


def box_before_a_wall() -> np.ndarray:
    """A wall behind, and a few stray readings in front: the nearest point is not the object.

    101 points: the 0.4-quantile is one of them then, whichever definition of a quantile is used.
    """
    rng = fresh()
    front = rng.normal([rng.uniform(-1, 1), 0.3, 2.0], [0.1, 0.2, 0.04], (58, 3))
    wall, stray = rng.normal([0.6, 0.0, 3.5], 0.1, (40, 3)), rng.normal([0.0, 0.0, 0.8], 0.02, (3, 3))
    return rng.permutation(np.concatenate([front, wall, stray]))


def at_the_reach() -> np.ndarray:
    """Points (11, 3) whose 0.4-quantile of depth is 2 m by any definition, others at 0.3 m from it, nearly."""
    rng = fresh()
    depth = np.array([1.5, 1.698, 1.698, 1.702, 2.0, 2.1, 2.298, 2.298, 2.302, 2.302, 2.9])
    return rng.permutation(np.column_stack([rng.uniform(-1, 1, 11), rng.normal(0, 0.2, 11), depth]))


def slope() -> np.ndarray:
    """Depths without a gap, where another quantile or another reach keeps other points."""
    rng = fresh()
    depth = rng.uniform(1.0, 3.0, 101)
    return np.column_stack([depth * rng.uniform(0.2, 0.6) + rng.normal(0, 0.05, 101), rng.normal(0, 0.2, 101), depth])
