"""Partitions of the observations into objects: numbering them anew, and listing them all."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class Association:
    """The outcome of a sweep: objects without observations are gone, the others are numbered from 0."""

    labels: np.ndarray  # (M,) index of the object, or -1
    landmarks: np.ndarray  # (K, 2) m, W: old objects stay where they were, a new one is where it was seen


def without_empty_objects(labels: np.ndarray, landmarks: np.ndarray) -> Association:
    """Drop objects that no observation belongs to, and number the others in their old order."""
    kept = np.unique(labels[labels >= 0])
    renumbered = np.full(len(landmarks), -1)
    renumbered[kept] = np.arange(len(kept))
    return Association(np.where(labels >= 0, renumbered[labels], -1), landmarks[kept])


def in_order_of_sight(keys: np.ndarray, used: np.ndarray | None = None) -> np.ndarray:
    """One number for all observations of equal keys, from 0 in the order in which they first appear.

    Args:
        keys: (M,) or (M, d), whatever tells the objects apart.
        used: (M,) bool; the others get -1. None: all are used.
    """
    used = np.full(len(keys), True) if used is None else used
    numbers = np.full(len(keys), -1)
    if used.any():
        _, first, inverse = np.unique(keys[used], axis=0, return_index=True, return_inverse=True)
        numbers[used] = np.argsort(np.argsort(first))[inverse.ravel()]
    return numbers


def first_observations(labels: np.ndarray) -> np.ndarray:
    """(K,) which observation (M,) of each object comes first in the log; the label -1 is none."""
    numbers, first = np.unique(labels, return_index=True)
    return first[numbers >= 0]


def same_partition(labels: np.ndarray, other: np.ndarray) -> bool:
    """Whether two labelings (M,) group the observations alike, whatever the objects are called; -1 is a group too."""
    pairs = np.unique((labels + 1) * (other.max(initial=-1) + 2) + other)
    return len(pairs) == len(np.unique(labels)) == len(np.unique(other))


def all_partitions(obs_class) -> Iterator[list[int]]:
    """Every way to group observations into objects of one class each, once, as labels in order of appearance.

    Args:
        obs_class: (M,); their number grows like the Bell numbers, 4140 for eight of one class.
    """
    obs_class = list(obs_class)
    if not obs_class:
        yield []
        return
    for labels in all_partitions(obs_class[:-1]):
        alike = {i for i, c in zip(labels, obs_class[:-1], strict=True) if c == obs_class[-1]}
        for label in (*sorted(alike), max(labels, default=-1) + 1):
            yield [*labels, label]
