"""A pose graph in complex numbers, in which its constraints on headings are all that is not quadratic.

A heading is ``z = exp(i theta)``, a position ``p = x + i y``. That b was measured at t in the frame of a reads
``p_b - p_a = z_a t``, and a turn by delta ``z_b = z_a exp(i delta)``: both linear (Carlone et al., "Planar Pose Graph
Optimization: Duality, Optimal Solutions, and Verification", T-RO 2016). ``certificate`` and ``relaxation`` build on it.
"""

from typing import NamedTuple

import numpy as np

from npslam_teach.pose_graph.factor_kinds import End
from npslam_teach.pose_graph.unknowns import VARIABLES, unknowns_of
from npslam_teach.types import PoseGraph


class Numbers(NamedTuple):
    """Complex numbers ``factor * y[index]``: the headings or positions of several poses or landmarks."""

    index: np.ndarray
    factor: np.ndarray

    def of(self, which: np.ndarray) -> "Numbers":
        """Some of them."""
        return Numbers(self.index[which], self.factor[which])

    def values(self, y: np.ndarray) -> np.ndarray:
        """What they are for some y."""
        return self.factor * y[self.index]


class Layout(NamedTuple):
    """The variables y: the heading of the whole map, those of the free poses, then all free positions.

    What is fixed turns with the whole map about the origin: it is a multiple of the first variable.
    """

    y: np.ndarray  # (N,) complex, at the estimate
    num_headings: int
    headings: dict[str, Numbers]  # by variable, where it has any
    positions: dict[str, Numbers]  # by variable

    def heading(self, end: End) -> Numbers:
        """The headings at one end of some factors."""
        return self.headings[end.variable].of(end.index)

    def position(self, end: End) -> Numbers:
        """The positions at one end of some factors."""
        return self.positions[end.variable].of(end.index)


def layout_of(graph: PoseGraph) -> Layout:
    """The complex variables of a graph."""
    free, y = unknowns_of(graph).free, [1.0 + 0j]

    def numbers(values: np.ndarray, variable: str) -> Numbers:
        index, factor = np.zeros(len(values), int), values.copy()
        index[free[variable]] = len(y) + np.arange(len(free[variable]))
        factor[free[variable]] = 1.0
        y.extend(values[free[variable]])
        return Numbers(index, factor)

    headings = {"poses": numbers(np.exp(1j * graph.poses[:, 2]), "poses")}
    num_headings = len(y)
    positions = {variable: numbers(as_complex(getattr(graph, variable)), variable) for variable in VARIABLES}
    return Layout(np.array(y), num_headings, headings, positions)


def as_complex(xy: np.ndarray) -> np.ndarray:
    """``x + i y`` of the first two numbers of each row."""
    return xy[:, 0] + 1j * xy[:, 1]


class QuadraticForm:
    """``y^H Q y``, a real number for every y, that grows term by term."""

    def __init__(self):
        self._entries = []

    def add(self, u: Numbers, v: Numbers, weight: np.ndarray) -> None:
        """Add ``2 Re(weight conj(u) v)`` for all pairs of u and v."""
        value = u.factor.conj() * weight * v.factor
        self._entries += [(u.index, v.index, value), (v.index, u.index, value.conj())]

    def add_displacement(self, layout: Layout, ends: tuple[End, End], weight: np.ndarray, linear: np.ndarray) -> None:
        """Add ``weight |d|^2 + 2 Re(conj(linear) d)``, with ``d = conj(z_a) (p_b - p_a)``: b in the frame of a."""
        z_a, (p_a, p_b) = layout.heading(ends[0]), (layout.position(end) for end in ends)
        for position, sign in ((p_b, 1.0), (p_a, -1.0)):
            self.add(position, position, weight / 2)
            self.add(z_a, position, sign * linear.conj())
        self.add(p_a, p_b, -weight)

    def matrix(self, size: int):
        """Q, a ``scipy.sparse.csc_array`` (size, size), Hermitian."""
        from scipy.sparse import coo_array

        rows, cols, values = (np.concatenate(each) for each in zip(*self._entries, strict=True))
        return coo_array((values, (rows, cols)), shape=(size, size)).tocsc()


def isotropic_part(information: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Weights w of positions and k of headings (E,) such that diag(w, w, k) is nowhere above Omega (E, d, d)."""
    position = np.maximum(np.linalg.eigvalsh(information[:, :2, :2])[:, 0], 0.0)
    if information.shape[1] == 2:
        return position, np.zeros_like(position)
    heading = information[:, 2, 2]
    scale = 1 / np.sqrt(np.maximum(np.column_stack([position, position, heading]), 1e-300))
    share = np.linalg.eigvalsh(information * scale[:, :, None] * scale[:, None, :])[:, 0]
    share = np.maximum(share, 0.0)
    return share * position, share * heading
