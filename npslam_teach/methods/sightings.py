"""What is known of the tracklets of a drive under way, besides where they are: seen how often, when last, as what.

A tracklet is a landmark of ``pose_graph.SubmapTree``. It belongs to an object, which is called by its oldest tracklet.
"""

import numpy as np

from npslam_teach.association.semantics import floored


class Sightings:
    """Rows that grow by one for every new tracklet."""

    def __init__(self, num_classes: int):
        """Of none."""
        self._rows = {
            "count": np.zeros(16, dtype=int),  # observations
            "passes": np.zeros(16, dtype=int),  # tracklets that have become this one
            "last_seen": np.zeros(16, dtype=int),  # pose
            "alive": np.zeros(16, dtype=bool),  # has not become another
            "object": np.zeros(16, dtype=int),  # its oldest tracklet
            "seen": np.zeros((16, num_classes)),  # what they say of its class, logarithms, floored
            "allowed": np.ones((16, num_classes), dtype=bool),  # by all of them
        }
        self._size, self._beside, self.uncertain = 0, [], False  # whether any report was no certainty

    def __len__(self) -> int:
        return self._size

    def __getattr__(self, name: str) -> np.ndarray:
        """The rows of a column, a view."""
        if name.startswith("_") or name not in self._rows:
            raise AttributeError(name)
        return self._rows[name][: self._size]

    def begin(self) -> int:
        """A new tracklet, an object of its own."""
        if self._size == len(self._rows["count"]):
            self._rows = {name: np.concatenate([rows, np.zeros_like(rows)]) for name, rows in self._rows.items()}
        self._size += 1
        self.object[-1], self.passes[-1] = self._size - 1, 1
        self.allowed[-1], self.alive[-1] = True, True
        self._beside.append(set())
        return self._size - 1

    def see(self, time: int, tracklets: list[int], reports: np.ndarray) -> None:
        """Tracklets (m,) are seen in one frame, with reports (m, C) of their classes."""
        for tracklet, report in zip(tracklets, reports, strict=True):
            self.count[tracklet] += 1
            self.last_seen[tracklet] = time
            self.seen[tracklet] += floored(report)
            self.allowed[tracklet] &= np.isfinite(report)
            self._beside[tracklet].update(other for other in tracklets if other != tracklet)

    def rivals(self, tracklets: np.ndarray) -> np.ndarray:
        """Pairs (N, N) bool that cannot be one object: no class allows both, or seen in one frame."""
        allowed = self.allowed[tracklets].astype(float)
        rivals = allowed @ allowed.T == 0
        place = {each: i for i, each in enumerate(tracklets.tolist())}
        for i, each in enumerate(tracklets.tolist()):
            rivals[i, [place[other] for other in self._beside[each] if other in place]] = True
        return rivals | rivals.T

    def merge(self, gone: int, stays: int) -> None:
        """What were two tracklets is one, for good."""
        self.count[stays] += self.count[gone]
        self.passes[stays] += self.passes[gone]
        self.last_seen[stays] = max(self.last_seen[stays], self.last_seen[gone])
        self.seen[stays] += self.seen[gone]
        self.allowed[stays] &= self.allowed[gone]
        for other in self._beside[gone]:
            self._beside[other].add(stays)
        self._beside[stays] |= self._beside[gone]
        self.object[self.object == gone], self.alive[gone] = stays, False
