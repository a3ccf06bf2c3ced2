"""What is known of the tracklets of a drive under way, besides where they are: seen how often, when last, as what.

A tracklet is a landmark of ``pose_graph.SubmapTree``. It belongs to an object, which is called by its oldest tracklet.
"""

import numpy as np

from npslam_teach.association.semantics import floored
from npslam_teach.pose_graph.rows import Rows


class Sightings:
    """Rows that grow by one for every new tracklet."""

    def __init__(self, num_classes: int):
        """Of none."""
        self._rows = {
            "count": Rows(dtype=int),  # observations
            "passes": Rows(dtype=int),  # tracklets that have become this one
            "last_seen": Rows(dtype=int),  # pose
            "alive": Rows(dtype=bool),  # has not become another
            "object": Rows(dtype=int),  # its oldest tracklet
            "seen": Rows((num_classes,)),  # what they say of its class, logarithms, floored
            "allowed": Rows((num_classes,), dtype=bool),  # by all of them
        }
        self._beside, self.uncertain = [], False  # whether any report was no certainty

    def __len__(self) -> int:
        return len(self._beside)

    def __getattr__(self, name: str) -> np.ndarray:
        """The rows of a column, a view."""
        if name.startswith("_") or name not in self._rows:
            raise AttributeError(name)
        return self._rows[name].array

    def begin(self) -> int:
        """A new tracklet, an object of its own."""
        new = len(self)
        values = {"count": 0, "passes": 1, "last_seen": 0, "alive": True, "object": new, "seen": 0.0, "allowed": True}
        for name, rows in self._rows.items():
            rows.append(values[name])
        self._beside.append(set())
        return new

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
