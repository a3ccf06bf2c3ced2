"""A pose graph that grows with the drive: one frame after the other is added, and solved again from where it stood."""

from dataclasses import replace

import numpy as np

from npslam_teach import se2
from npslam_teach.pose_graph.covariance import joint_covariance
from npslam_teach.pose_graph.linearization import chi2
from npslam_teach.pose_graph.multi_start import optimize
from npslam_teach.pose_graph.observability import require_connected
from npslam_teach.pose_graph.rows import Rows
from npslam_teach.types import BetweenFactors, ObservationFactors, PoseGraph
from npslam_teach.validation import checked_array, checked_index

SETTLED = 1e-18  # chi2 of new factors that ask nobody to move


class IncrementalSolver:
    """The graph of a drive under way.

    Add a pose, the objects it discovers and what it sees, then ``solve``. A frame that brings nothing but a step and
    new objects fits perfectly and costs nothing; one that sees an old object again moves the whole trajectory a little,
    and two or three steps of Gauss-Newton from the previous solution do.

    >>> solver = IncrementalSolver()
    >>> here = solver.add_pose([1.0, 0.0, 0.1], np.diag([100.0, 100.0, 100.0]))
    >>> chair = solver.add_landmark([3.0, 1.0])
    >>> solver.add_observation(here, chair, [2.0, 0.8], np.diag([25.0, 25.0]))
    >>> graph = solver.solve()
    """

    def __init__(self, start: np.ndarray = (0.0, 0.0, 0.0)):
        """Begin with pose 0, (3,) in W, which is held still."""
        self._poses = Rows((3,), [checked_array("start", start, (3,))])
        self._landmarks = Rows((2,))
        self._between = {"i": Rows((), dtype=int), "j": Rows((), dtype=int), "relative_pose": Rows((3,))}
        self._between |= {"information": Rows((3, 3))}
        self._observations = {"pose": Rows((), dtype=int), "landmark": Rows((), dtype=int), "xy": Rows((2,))}
        self._observations |= {"information": Rows((2, 2))}
        self._settled = True

    @property
    def graph(self) -> PoseGraph:
        """All poses, landmarks and factors so far, at the latest estimate."""
        between = BetweenFactors(**{name: rows.array for name, rows in self._between.items()})
        observations = ObservationFactors(**{name: rows.array for name, rows in self._observations.items()})
        return PoseGraph(self._poses.array, self._landmarks.array, between, observations)

    def add_pose(self, relative_pose: np.ndarray, information: np.ndarray) -> int:
        """Drive one step; the new pose begins where odometry puts it.

        Args:
            relative_pose: (3,) m, m, rad: the new pose in the frame of the newest.
            information: (3, 3) of the step.

        Returns:
            the index of the new pose.
        """
        newest = len(self._poses) - 1
        relative_pose = checked_array("relative_pose", relative_pose, (3,))
        factor = BetweenFactors([newest], [newest + 1], [relative_pose], [information])
        self._poses.append(se2.compose(self._poses.array[newest], relative_pose))
        _extend(self._between, factor)
        return newest + 1

    def add_landmark(self, xy: np.ndarray) -> int:
        """A new object, (2,) m in W; returns its index. It needs an observation before the next ``solve``."""
        self._landmarks.append(checked_array("xy", xy, (2,)))
        return len(self._landmarks) - 1

    def add_between(self, i: int, j: int, relative_pose: np.ndarray, information: np.ndarray) -> None:
        """A loop closure: pose j was measured from pose i.

        Args:
            i: index of the measuring pose.
            j: index of the measured pose.
            relative_pose: (3,) m, m, rad, R_j in R_i.
            information: (3, 3).
        """
        checked_index("i", i, len(self._poses))
        checked_index("j", j, len(self._poses))
        self._settled = False
        _extend(self._between, BetweenFactors([i], [j], [relative_pose], [information]))

    def add_observation(self, pose: int, landmark: int, xy: np.ndarray, information: np.ndarray) -> None:
        """A landmark was seen from a pose.

        Args:
            pose: index of the pose.
            landmark: index of the landmark.
            xy: (2,) m, in the frame of the pose.
            information: (2, 2).
        """
        checked_index("pose", pose, len(self._poses))
        checked_index("landmark", landmark, len(self._landmarks))
        factor = ObservationFactors([pose], [landmark], [xy], [information])
        ends = self._poses.array[[pose]], self._landmarks.array[[landmark]]
        alone = replace(factor, pose=[0], landmark=[0])
        nothing = BetweenFactors([], [], np.zeros((0, 3)), np.zeros((0, 3, 3)))
        self._settled &= chi2(PoseGraph(*ends, nothing, alone)) <= SETTLED
        _extend(self._observations, factor)

    def solve(self, tolerance: float = 1e-9) -> PoseGraph:
        """The graph at its minimum, found from the latest estimate; it becomes the latest estimate.

        Args:
            tolerance: see ``pose_graph.gauss_newton``.

        Raises:
            numpy.linalg.LinAlgError: when a pose or landmark is not determined by the factors; it is named.
        """
        graph = self.graph
        require_connected(graph)
        if not self._settled:
            graph = optimize(graph, tolerance)
            self._poses.array[:], self._landmarks.array[:] = graph.poses, graph.landmarks
            self._settled = True
        return graph

    def joint_covariance(self, landmarks: np.ndarray) -> np.ndarray:
        """The newest pose and each candidate landmark together: what gating an observation needs.

        Args:
            landmarks: (L,) indices.

        Returns:
            (L, 5, 5) covariances of ``[x, y, theta]`` of the newest pose and ``[x, y]`` of the landmark, in W, at the
            latest solution.
        """
        return joint_covariance(self.graph, len(self._poses) - 1, landmarks)


def _extend(columns: dict, factor) -> None:
    for name, rows in columns.items():
        rows.append(getattr(factor, name)[0])
