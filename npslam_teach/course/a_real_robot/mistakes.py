"""Usual mistakes of lesson 12 that take more than a line."""

import numpy as np

from npslam_teach import se2


def steps_added(odometry, poses, n) -> np.ndarray:
    """The numbers of n steps added up, as if none of them turned."""
    added = np.vstack([np.zeros(3), np.cumsum(odometry, axis=0)])
    off = added[n:] - added[:-n] - se2.between(poses[:-n], poses[n:])
    off[:, 2] = se2.wrap(off[:, 2])
    return np.sqrt(np.mean(off**2, axis=0))


def from_the_beginning(labels, times, gap) -> np.ndarray:
    """A pass that ends so many poses after it began, however often the object was seen meanwhile."""
    chosen, began = np.zeros(len(labels), dtype=bool), {}
    for m in np.argsort(times, kind="stable"):
        k = int(labels[m])
        if k >= 0 and times[m] - began.get(k, -(10**9)) > gap:
            chosen[m], began[k] = True, times[m]
    return chosen
