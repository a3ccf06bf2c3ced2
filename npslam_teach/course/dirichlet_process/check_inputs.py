"""What the checks of this lesson try where that takes more than a few lines: the scenes of a sweep."""

import math

import numpy as np

from npslam_teach.course.trials import fresh


def sweep_inputs() -> tuple[list, dict]:
    """Arguments of ``check_sweep``: its trials, and its edges by the situation."""
    rng = fresh()
    trials = [_scene(rng, start) for start in ("alone", "grouped") * 6]
    labels, landmarks, xy, obs_class, alpha = trials[0]
    edges = _by_distance() | {
        "with a single sighting": [(np.zeros(1, dtype=int), xy[:1].copy(), xy[:1], obs_class[:1], alpha)],
        "with an object that has no vote, in the way": [
            (labels, np.vstack([landmarks, xy.mean(axis=0)]), xy, obs_class, alpha)
        ],
        "with no sighting": [(np.empty(0, dtype=int), landmarks[:0], np.empty((0, 2)), np.empty(0, dtype=int), 0.5)],
        "with two classes in one object": [
            (np.zeros(6, dtype=int), np.zeros((1, 2)), np.zeros((6, 2)), np.array([0, 1, 0, 1, 1, 0]), 0.5)
        ],
        "with hundreds of sightings of one object": [
            (np.arange(200), (near := rng.normal(0, 0.02, (200, 2))), near.copy(), np.zeros(200, dtype=int), 0.5)
        ],
    }
    return trials, edges


def _by_distance() -> dict:
    """Edges that one distance decides."""
    return {
        "with an object far from its sightings, which find each other in a new one": [
            (
                np.zeros(6, dtype=int),
                np.full((1, 2), 9.0),
                1 + fresh().normal(0, 0.05, (6, 2)),
                np.zeros(6, dtype=int),
                0.5,
            )
        ],
        "with objects that their only sightings leave: the new one stands at the sighting, not at the old place": [
            (np.arange(2), np.array([[5.0, 5.0], [9.0, 9.0]]), np.ones((2, 2)), np.zeros(2, dtype=int), 0.5)
        ],
        "with a weight of exactly alpha: a tie opens a new object": [
            (np.arange(2), np.ones((2, 2)), np.ones((2, 2)), np.zeros(2, dtype=int), 1.0)
        ],
        "with a weight just above alpha, and with one just below": [
            (np.arange(2), pair, pair.copy(), np.zeros(2, dtype=int), 0.5)
            for pair in (np.array([[0.0, 0.0], [math.sqrt(-math.log(weight) / 4), 0.0]]) for weight in (0.505, 0.495))
        ],
        "with a small and with a large concentration": [
            (np.arange(2), pair, pair.copy(), np.zeros(2, dtype=int), alpha)
            for pair, alpha in ((np.array([[0, 0], [0.5, 0]]), 0.1), (np.array([[0, 0], [0.25, 0]]), 0.95))
        ],
    }


def _scene(rng: np.random.Generator, start: str) -> tuple:
    """Observations around five places, as arguments of a sweep: each alone, or in groups that are partly wrong."""
    place = rng.integers(0, 5, 18)
    xy = rng.uniform(0.0, 2.0, (5, 2))[place] + rng.normal(size=(18, 2)) * 0.12
    obs_class = np.where(rng.random(18) < 0.8, place % 2, rng.integers(0, 2, 18))
    labels = np.arange(18) if start == "alone" else _numbered(np.where(rng.random(18) < 0.7, place, place % 3 + 5))
    landmarks = np.array([xy[labels == i].mean(axis=0) for i in range(labels.max() + 1)])
    return labels, landmarks, xy, obs_class, float(rng.uniform(0.3, 0.9))


def _numbered(labels: np.ndarray) -> np.ndarray:
    return np.unique(labels, return_inverse=True)[1]
