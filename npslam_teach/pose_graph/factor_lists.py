"""The factors of a drive under way, in the order in which they came: what ``submap_tree`` was told."""

import numpy as np

from npslam_teach.types import BetweenFactors, ObservationFactors, PoseGraph
from npslam_teach.validation import checked_array


class FactorLists:
    """Steps of odometry, and observations of landmarks from the newest pose."""

    def __init__(self):
        """None yet."""
        self._steps, self._sights = [], []

    @property
    def num_poses(self) -> int:
        """One more than there are steps."""
        return len(self._steps) + 1

    def add_step(self, relative_pose, information) -> tuple[np.ndarray, np.ndarray]:
        """A step (3,), and its information (3, 3); returns the step and L^T of the information L L^T."""
        step, root = checked_array("relative_pose", relative_pose, (3,)), _root(information, 3)
        self._steps.append((step, information))
        return step, root

    def add_sight(self, landmark: int, xy, information) -> tuple[np.ndarray, np.ndarray]:
        """A landmark is seen at (2,), with information (2, 2); returns the place and L^T of the information."""
        xy, root = checked_array("xy", xy, (2,)), _root(information, 2)
        self._sights.append((self.num_poses - 1, landmark, xy, information))
        return xy, root

    def graph(self, poses: np.ndarray, landmarks: np.ndarray, became: np.ndarray) -> tuple[PoseGraph, np.ndarray]:
        """All of them as a graph.

        Args:
            poses: (T, 3) W.
            landmarks: (N, 2) m, W.
            became: (N,) the landmark that each has become, or itself.

        Returns:
            the graph; (N,) the landmark of the graph for each, -1 where it was never seen.
        """
        pose, landmark, xy, information = _columns(self._sights, ((), (), (2,), (2, 2)))
        used, place = np.unique(became[landmark.astype(int)], return_inverse=True)
        number = np.full(len(became), -1)
        number[used] = np.arange(len(used))
        steps, of_steps = _columns(self._steps, ((3,), (3, 3)))
        i = np.arange(len(steps))
        factors = BetweenFactors(i, i + 1, steps, of_steps), ObservationFactors(pose, place, xy, information)
        return PoseGraph(poses, landmarks[used], *factors), number[became]


def _root(information: np.ndarray, size: int) -> np.ndarray:
    """L^T of an information matrix L L^T."""
    information = checked_array("information", information, (size, size))
    try:
        return np.linalg.cholesky(information).T
    except np.linalg.LinAlgError:
        raise ValueError("information: expected a symmetric positive definite matrix") from None


def _columns(rows: list, shapes: tuple) -> list[np.ndarray]:
    """Lists of what the rows hold, as arrays of these shapes."""
    columns = zip(*rows, strict=True) if rows else [[] for _ in shapes]
    return [np.array(column).reshape(-1, *shape) for column, shape in zip(columns, shapes, strict=True)]
