"""The kinds of factor that a pose graph may hold, as a list that everything else runs over.

A new kind is a new entry: where its factors stand in the graph, which variables they tie together, its residual and its
Jacobians. Every kind measures a variable in the frame of a pose. Where it *displaces*, the first two numbers of its
residual are ``R(theta_a)^T (p_b - p_a)`` minus what was measured; else its residual is linear, but for the wrapping.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from npslam_teach.pose_graph.residuals import (
    between_jacobians,
    between_residual,
    heading_jacobians,
    heading_residual,
    observation_jacobians,
    observation_residual,
)
from npslam_teach.types import PoseGraph


class End(NamedTuple):
    """One of the two variables that a factor ties together."""

    variable: str  # "poses" or "landmarks"
    index: np.ndarray  # (E,) which of them
    estimate: np.ndarray  # (E, size) where they are at present


class FactorKind(NamedTuple):
    """One kind of factor between a variable a and a variable b."""

    name: str  # of its factors in ``PoseGraph``
    measured: tuple[str, ...]  # the fields that hold what was measured
    end_a: tuple[str, str]  # the variable, and the field that holds its index
    end_b: tuple[str, str]
    residual: Callable[..., np.ndarray]  # of the estimates a and b and of what was measured
    jacobians: Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]
    displaces: bool = True

    def ends(self, graph: PoseGraph) -> tuple[End, End]:
        """Both ends of all factors of this kind, a first."""
        factors = getattr(graph, self.name)
        indices = [(variable, getattr(factors, field)) for variable, field in (self.end_a, self.end_b)]
        a, b = (End(variable, index, getattr(graph, variable)[index]) for variable, index in indices)
        return a, b

    def residuals(self, graph: PoseGraph) -> np.ndarray:
        """The residuals of all factors of this kind at the present estimate, (E, d)."""
        (a, b), factors = self.ends(graph), getattr(graph, self.name)
        if len(a.index) == 0 and not self.displaces:
            return np.zeros((0, 1))  # landmarks without headings have no third number to look at
        return self.residual(a.estimate, b.estimate, *(getattr(factors, field) for field in self.measured))

    def information(self, graph: PoseGraph) -> np.ndarray:
        """Omega of all factors of this kind, (E, d, d)."""
        return getattr(graph, self.name).information


FACTOR_KINDS = (
    FactorKind("between", ("relative_pose",), ("poses", "i"), ("poses", "j"), between_residual, between_jacobians),
    FactorKind(
        "observations",
        ("xy",),
        ("poses", "pose"),
        ("landmarks", "landmark"),
        observation_residual,
        observation_jacobians,
    ),
    FactorKind(
        "headings",
        ("theta", "symmetry"),
        ("poses", "pose"),
        ("landmarks", "landmark"),
        heading_residual,
        heading_jacobians,
        displaces=False,
    ),
)
