"""All ways to group n observations into objects, as an oracle."""

from collections.abc import Iterator

import numpy as np

from npslam_teach import association
from npslam_teach.association import count_votes


def partitions(n: int) -> Iterator[list[int]]:
    """Every partition of n things once, as labels in order of first appearance (restricted growth strings)."""

    def grow(labels):
        if len(labels) == n:
            yield list(labels)
            return
        for label in range(max(labels, default=-1) + 2):
            yield from grow([*labels, label])

    yield from grow([])


def objective_of(labels, landmarks, xy, obs_class, alpha, kernel_std):
    """DESIGN section 4 with the landmarks where they are: every residual is a distance over the kernel width."""
    chi2 = sum(np.sum((xy[k] - landmarks[labels[k]]) ** 2) for k in range(len(labels))) / kernel_std**2
    used = np.unique(labels)
    votes = count_votes(labels, obs_class, len(landmarks), obs_class.max() + 1)[used]
    return association.objective(chi2, votes, alpha)


def same_groups(labels):
    labels = np.asarray(labels)
    return labels[:, None] == labels[None, :]
