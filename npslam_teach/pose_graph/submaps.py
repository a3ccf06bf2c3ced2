"""Submaps: a stretch of a drive as one quadratic form in the few variables that anybody else will ask for.

A submap lives in the frame S of its first pose. Its variables are its last pose and those landmarks that are seen from
outside too; all others have been eliminated, exactly as far as the graph is linear. Two submaps that follow one
another make a larger one: the pose at the seam and the landmarks that only these two see are eliminated. Because each
lives in a frame of its own, it stays as it is when the drive before it is turned or moved (Ni and Dellaert,
"Multi-level submap based SLAM using nested dissection", 2010).
"""

import math
from typing import NamedTuple

import numpy as np

from npslam_teach.pose_graph.factorization import SINGULAR


class Submap(NamedTuple):
    """``chi2(at + d) = constant + 2 gradient^T d + d^T information d``, everything else at its best.

    The variables, n = 3 + 2k: the last pose [x, y, theta], then k landmarks [x, y], all in S.
    """

    ids: np.ndarray  # (k,) which landmarks
    at: np.ndarray  # (n,) m, m, rad, m ...: around which it is linear
    gradient: np.ndarray  # (n,)
    information: np.ndarray  # (n, n)
    constant: float

    def moved_to(self, values: np.ndarray) -> tuple[np.ndarray, float]:
        """Gradient (n,) and chi2 at other values (n,)."""
        d = self.difference(values)
        pull = self.information @ d
        return self.gradient + pull, self.constant + float(d @ (2 * self.gradient + pull))

    def minimum(self) -> np.ndarray:
        """The values (n,) where chi2 is least."""
        return self.at - np.linalg.solve(self.information, self.gradient)

    def difference(self, values: np.ndarray) -> np.ndarray:
        """How far values (n,) are from ``at``; the angle the short way."""
        return turned_back(values - self.at, 2)


class Eliminated(NamedTuple):
    """What is left of a quadratic form when some of its variables are at their best, and how to find these."""

    information: np.ndarray  # (o, o)
    gradient: np.ndarray  # (o,)
    constant: float
    back: np.ndarray  # (i, o)
    step: np.ndarray  # (i,)

    def inside(self, outside: np.ndarray) -> np.ndarray:
        """How the variables that were eliminated move (i,) when the others move by ``outside`` (o,)."""
        return -(self.step + self.back @ outside)


def eliminate(information: np.ndarray, gradient: np.ndarray, constant: float, inside, outside) -> Eliminated:
    """Minimise ``constant + 2 gradient^T d + d^T information d`` over some of the variables (Schur complement).

    Args:
        information: (n, n).
        gradient: (n,).
        constant: chi2 at d = 0.
        inside: (i,) indices of those to eliminate.
        outside: (o,) indices of those that stay.

    Raises:
        numpy.linalg.LinAlgError: the others do not determine the variables inside.
    """
    from scipy.linalg.lapack import dposv

    kept, pull = information[outside[:, None], outside], gradient[outside]
    if len(inside) == 0:
        return Eliminated(kept, pull, constant, np.zeros((0, len(outside))), np.zeros(0))
    tie = information[inside[:, None], outside]
    right = np.empty((len(inside), len(outside) + 1), order="F")
    right[:, :-1], right[:, -1] = tie, gradient[inside]
    _, solution, status = dposv(information[inside[:, None], inside], right, overwrite_a=1, overwrite_b=1)
    if status != 0:
        raise np.linalg.LinAlgError(SINGULAR)
    taken = tie.T @ solution
    kept = kept - taken[:, :-1]
    gain = float(gradient[inside] @ solution[:, -1])
    return Eliminated((kept + kept.T) / 2, pull - taken[:, -1], constant - gain, solution[:, :-1], solution[:, -1])


class Seam(NamedTuple):
    """The sum of two submaps that follow one another, in the frame of the first, before anything is eliminated.

    The variables, N = 6 + 2K: the last pose of the second, the pose at the seam, then the landmarks of both.
    """

    information: np.ndarray  # (N, N) of Gauss and Newton
    gradient: np.ndarray  # (N,)
    constant: float
    of_second: np.ndarray  # where the variables of the second stand, those of the seam in front
    local: np.ndarray  # (n,) the values of the second's variables in its own frame
    jacobian: np.ndarray  # (n, 3 + n) of these by the variables of_second


def add_up(first: Submap, second: Submap, places: tuple[np.ndarray, np.ndarray], at: np.ndarray) -> Seam:
    """Add two submaps up, linearized around ``at`` (N,).

    Args:
        first: from S to the seam.
        second: from the seam to its last pose.
        places: (k1,) and (k2,) where the landmarks of each stand among the K of both.
        at: (N,) in S.
    """
    of_first = np.concatenate([[3, 4, 5], variables(places[0], 6)])
    of_second = np.concatenate([[3, 4, 5, 0, 1, 2], variables(places[1], 6)])
    local, jacobian = seen_from_seam(at[of_second])
    information, gradient = np.zeros((len(at), len(at))), np.zeros(len(at))
    pull, constant = first.moved_to(at[of_first])
    information[of_first[:, None], of_first] = first.information
    gradient[of_first] = pull
    pull, more = second.moved_to(local)
    information[of_second[:, None], of_second] += jacobian.T @ (second.information @ jacobian)
    gradient[of_second] += jacobian.T @ pull
    return Seam(information, gradient, constant + more, of_second, local, jacobian)


def seen_from_seam(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A pose and landmarks in the frame of a pose m, and the derivatives.

    Args:
        values: (3 + n,) in S: m, another pose, landmarks.

    Returns:
        (n,) the other pose and the landmarks as seen from m; (n, 3 + n).
    """
    cos, sin = math.cos(values[2]), math.sin(values[2])
    turn = np.array([[cos, -sin], [sin, cos]])  # R(m), of rows: ``xy @ turn = R^T xy``
    count = (len(values) - 6) // 2
    xy = np.concatenate([values[3:5], values[6:]]).reshape(-1, 2) - values[:2]
    xy = xy @ turn
    local = np.concatenate([xy[0], [values[5] - values[2]], xy[1:].ravel()])
    jacobian = np.zeros((3 + 2 * count, 6 + 2 * count))
    rows = np.concatenate([[0, 1], np.arange(3, 3 + 2 * count)]).reshape(-1, 2)
    jacobian[rows[:, :, None], 3 + rows[:, None, :]] = turn.T
    jacobian[rows, :2] = -turn.T
    jacobian[rows[:, 0], 2], jacobian[rows[:, 1], 2] = xy[:, 1], -xy[:, 0]
    jacobian[2, 2], jacobian[2, 5] = -1.0, 1.0
    return local, jacobian


def carried(pose: np.ndarray, values: np.ndarray) -> np.ndarray:
    """The last pose and the landmarks of a submap (n,), carried from its frame into that of ``pose`` (3,)."""
    cos, sin = math.cos(pose[2]), math.sin(pose[2])
    turn = np.array([[cos, sin], [-sin, cos]])
    out = np.empty_like(values)
    out[:2] = pose[:2] + values[:2] @ turn
    out[2] = pose[2] + values[2]
    out[3:] = (pose[:2] + values[3:].reshape(-1, 2) @ turn).ravel()
    return out


def turned_back(difference: np.ndarray, *angles: int) -> np.ndarray:
    """The same with the entries that are angles brought into [-pi, pi]; changed in place."""
    for i in angles:
        difference[i] = math.remainder(difference[i], 2 * math.pi)
    return difference


def variables(places: np.ndarray, first: int) -> np.ndarray:
    """Where x and y of landmarks (k,) stand if those of the first stand at ``first``: (2k,)."""
    return (first + 2 * places[:, None] + np.array([0, 1])).ravel()
