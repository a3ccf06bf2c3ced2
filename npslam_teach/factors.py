"""The factors of a pose graph: what was measured between two of its variables, and how certain it is.

Each measures something in the frame of a pose, R_pose. Metres and radians.
"""

from dataclasses import dataclass

import numpy as np

from npslam_teach.validation import require_positive, require_semidefinite, set_checked


@dataclass(frozen=True, eq=False)
class BetweenFactors:
    """E measurements of pose j in the frame of pose i: odometry steps and loop closures."""

    i: np.ndarray  # (E,)
    j: np.ndarray  # (E,)
    relative_pose: np.ndarray  # (E, 3) R_j in R_i
    information: np.ndarray  # (E, 3, 3)

    def __post_init__(self):
        set_checked(self, "i", (None,), int)
        num_factors = len(self.i)
        set_checked(self, "j", (num_factors,), int)
        set_checked(self, "relative_pose", (num_factors, 3))
        set_checked(self, "information", (num_factors, 3, 3))
        require_semidefinite("information", self.information)
        if (self.i == self.j).any():
            raise ValueError(f"j: expected a pose other than i, got i = j = {self.i[self.i == self.j][0]}")


@dataclass(frozen=True, eq=False)
class ObservationFactors:
    """M measurements of a landmark's position in the frame of a pose."""

    pose: np.ndarray  # (M,)
    landmark: np.ndarray  # (M,)
    xy: np.ndarray  # (M, 2) m, R_pose
    information: np.ndarray  # (M, 2, 2)

    def __post_init__(self):
        set_checked(self, "pose", (None,), int)
        num_factors = len(self.pose)
        set_checked(self, "landmark", (num_factors,), int)
        set_checked(self, "xy", (num_factors, 2))
        set_checked(self, "information", (num_factors, 2, 2))
        require_semidefinite("information", self.information)


@dataclass(frozen=True, eq=False)
class HeadingFactors:
    """H measurements of which way a landmark faces, in the frame of a pose."""

    pose: np.ndarray  # (H,)
    landmark: np.ndarray  # (H,)
    theta: np.ndarray  # (H,) rad, R_pose
    symmetry: np.ndarray  # (H,) how many headings look alike: 1 = one, 2 = half-turn, 4 = quarter-turn
    information: np.ndarray  # (H, 1, 1)

    def __post_init__(self):
        set_checked(self, "pose", (None,), int)
        num_factors = len(self.pose)
        for name, dtype in (("landmark", int), ("theta", float), ("symmetry", int)):
            set_checked(self, name, (num_factors,), dtype)
        require_positive("symmetry", self.symmetry)
        set_checked(self, "information", (num_factors, 1, 1))
        require_semidefinite("information", self.information)


NO_HEADINGS = HeadingFactors([], [], [], [], np.zeros((0, 1, 1)))
