"""Headings in the association: two chairs at one place may face different ways.

Position and heading of an observation err independently, so their kernels multiply: the weight of an object is
``votes * exp(-d^2 / (2 s^2)) * exp(-delta^2 / (2 s_theta^2))`` with delta the turn between observation and object, by
the symmetry of the object the smallest that looks alike.
"""

import math
from typing import NamedTuple

import numpy as np

from npslam_teach import se2


class SeenHeadings(NamedTuple):
    """Which way the object of each observation faces, carried into the world."""

    theta: np.ndarray  # (M,) rad, W
    symmetry: np.ndarray  # (M,) how many headings look alike; 0: nothing is said
    std: float  # rad, the width of the kernel

    def squared(self, which, theta: np.ndarray) -> np.ndarray:
        """How far observations are turned from objects, squared, in widths of the kernel.

        Args:
            which: (...) indices of the observations.
            theta: (...) rad, W, of the objects.
        """
        return (se2.wrap_symmetric(self.theta[which] - theta, self.symmetry[which]) / self.std) ** 2


def turned(headings: SeenHeadings | None, which, landmarks: np.ndarray) -> np.ndarray | float:
    """``squared`` of observations against landmarks (..., 3); 0 where there are no headings.

    Args:
        headings: of all observations, or None.
        which: (...) indices of the observations.
        landmarks: (..., 3) m, m, rad, W, one for each, or many for one observation.
    """
    return 0.0 if headings is None else headings.squared(which, np.asarray(landmarks)[..., 2])


def opened_at(obs_xy_world: np.ndarray, headings: SeenHeadings | None, k: int) -> np.ndarray:
    """The object that observation k opens: (2,) m, W, or (3,) with its heading."""
    return obs_xy_world[k] if headings is None else np.append(obs_xy_world[k], headings.theta[k])


def heading_kernel(turn: np.ndarray, symmetry: np.ndarray, std: float) -> np.ndarray:
    """``exp(-delta^2 / (2 s^2))``, delta the smallest turn that looks alike: 1 for something round.

    Args:
        turn: (...) rad, between an observation and an object.
        symmetry: (...) how many headings look alike.
        std: s, rad.
    """
    return np.exp(-((se2.wrap_symmetric(turn, symmetry) / std) ** 2) / 2)


def log_heading_evidence(theta: np.ndarray, cov: np.ndarray, symmetry: int) -> float:
    """How well headings agree to be one, against being all of different objects: 0 for one alone, or for none said.

    An object faces any way alike. ``n`` measured headings of one object are the same angle up to what looks alike, with
    errors of covariance Sigma; the angle is integrated out, and the density compared with that of guesses:

        log [ integral of N(theta; phi, Sigma) dphi / range ] - n log(1 / range),      range = 2 pi / symmetry

    Each heading is first turned by what looks alike to the nearest of the first, so the errors must be small beside the
    range.

    Args:
        theta: (n,) rad.
        cov: (n, n) rad^2 of their errors.
        symmetry: how many headings look alike; 0: nothing is said.
    """
    count = len(theta)
    if symmetry == 0 or count < 2:
        return 0.0
    span, off = 2 * math.pi / symmetry, se2.wrap_symmetric(theta - theta[0], symmetry)
    whitened = np.linalg.solve(cov, np.column_stack([np.ones(count), off]))
    weight, pull = whitened[:, 0].sum(), whitened[:, 1].sum()
    squared = off @ whitened[:, 1] - pull**2 / weight
    log_det = np.linalg.slogdet(cov)[1] + math.log(weight)
    return float((count - 1) * (math.log(span) - math.log(2 * math.pi) / 2) - squared / 2 - log_det / 2)
