"""What the checks of this lesson try where that takes more than a few lines: random inputs, and edge cases."""

import numpy as np

from npslam_teach.course.trials import fresh


def count_votes_inputs() -> tuple[list, dict]:
    """Arguments of ``check_count_votes``: its trials, and its edges by the situation."""
    rng, trials = fresh(), []
    for num_objects, num_classes in ((4, 2), (3, 5), (2, 2), (5, 3)):
        labels = np.append(rng.integers(-1, num_objects, 14), [-1, 0, 0])
        obs_class = np.append(rng.integers(0, num_classes, 14), [0, 1, 1])
        trials.append((labels, obs_class, num_objects, num_classes))
    labels, obs_class, num_objects, num_classes = trials[0]
    none = np.empty(0, dtype=int)
    edges = {
        "with objects and classes that nobody has seen": [(labels, obs_class, num_objects + 2, num_classes + 3)],
        "with labels of -1 alone": [(np.full(5, -1), rng.integers(0, 2, 5), 3, 2)],
        "with no sighting at all": [(none, none, 2, 3)],
        "with no object": [(np.full(4, -1), np.zeros(4, dtype=int), 0, 2)],
        "with thousands of sightings": [(rng.integers(-1, 2, 5000), rng.integers(0, 2, 5000), 2, 2)],
    }
    return trials, edges
