"""Sweeps that are wrong on purpose: the typical mistakes that a check knows by name."""

import numpy as np

from npslam_teach.association import association_weights


def sweep_with(mistake: str, labels, landmarks, xy, obs_class, alpha) -> np.ndarray:
    """A sweep with one typical mistake in it."""
    labels, room = labels.copy(), len(labels)
    alpha = 0.5 if mistake == "alpha" else alpha
    places, num_objects = np.vstack([landmarks, np.zeros((room, 2))]), len(landmarks)
    obs_class = np.zeros_like(obs_class) if mistake == "class" else obs_class
    votes = np.zeros((len(places), 2))
    np.add.at(votes, (labels, obs_class), 1.0)
    for k in range(room) if mistake == "order" else reversed(range(room)):
        c, own = obs_class[k], labels[k]
        votes[own, c] -= mistake != "own vote"
        weights = association_weights(votes[:num_objects, c], np.linalg.norm(places[:num_objects] - xy[k], axis=1))
        best = int(np.argmax(weights))
        chosen = best if mistake == "never new" or weights[best] > alpha else num_objects
        labels[k] = chosen
        if chosen == num_objects:
            places[chosen], num_objects = xy[k], num_objects + 1
        votes[own if mistake == "old votes" else chosen, c] += mistake != "own vote" or chosen != own
        votes[own, c] -= mistake == "own vote" and chosen != own
    return labels
