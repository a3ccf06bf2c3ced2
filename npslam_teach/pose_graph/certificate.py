"""Is this minimum of chi2 the lowest one? A proof, or a bound on how much lower another could be.

A solver ends in some minimum. The dual problem gives a number that chi2 is nowhere below (Carlone, Calafiore,
Tommolillo and Dellaert, "Planar Pose Graph Optimization: Duality, Optimal Solutions, and Verification", T-RO 2016;
Rosen, Carlone, Bandeira and Leonard, "SE-Sync", IJRR 2019; with landmarks Holmes and Barfoot, RA-L 2023). Where chi2 at
the minimum is that number, no other minimum is lower.

In the complex numbers y of ``complex_form`` the sum of squares is ``c + y^H Q y``, and all that makes the problem hard
is ``|z| = 1`` for the headings z in y. With a multiplier lambda for each of these constraints

    c + y^H Q y  =  c + sum(lambda) + y^H (Q - diag(lambda)) y,

which is nowhere below ``c + sum(lambda)`` if ``Q - diag(lambda)`` is positive semidefinite. At a minimum lambda is
known, and then all depends on the smallest eigenvalue of one sparse matrix. If it is some -e below zero, the last term
is still at least -e for each heading.

The papers need isotropic noise of positions, not correlated with that of headings, and the chordal distance
``2 - 2 cos a`` for an error a of heading. chi2 is more general: it has any information matrix, and ``a^2``. Therefore a
quadratic of their kind is laid under it, factor by factor, which touches chi2 at the estimate in value and slope and is
nowhere above it; what bounds the quadratic from below bounds chi2. A certificate is thus valid for any noise. But the
further the noise is from isotropic, or the errors of heading from zero, the lower the quadratic lies elsewhere, and the
more often the lowest minimum is left without proof.

All of this holds up to rounding, like every statement about the sign of a computed eigenvalue.
"""

from dataclasses import dataclass

import numpy as np

from npslam_teach.pose_graph.block_sparsity import SYMMETRIC
from npslam_teach.pose_graph.complex_form import Layout, QuadraticForm, as_complex, isotropic_part, layout_of
from npslam_teach.pose_graph.factor_kinds import FACTOR_KINDS
from npslam_teach.pose_graph.linearization import residuals
from npslam_teach.pose_graph.unknowns import with_estimates
from npslam_teach.types import PoseGraph

NEGLIGIBLE_GAP = 1e-6  # the share of chi2 by which a certified minimum might at most be too high,
ROUNDING_GAP = 1e-9  # or this much: of a perfect fit, chi2 is rounding error
ROUNDING_SHARE = 1e-14  # of the largest number on the diagonal, by which an eigenvalue may be wrong
FEW = 4  # headings, of which all eigenvalues are found at once: Lanczos iterations need more
ERRORS = np.linspace(-np.pi, np.pi, 129)  # rad, of heading, at which the quadratic is held below chi2


@dataclass(frozen=True)
class Certificate:
    """How much lower than at an estimate chi2 could be elsewhere."""

    chi2: float  # at the estimate
    gap: float  # nowhere is chi2 below chi2 - gap
    smallest_eigenvalue: float  # of Q - diag(lambda) with all positions eliminated; where it is negative there is a gap

    @property
    def status(self) -> str:
        """certified: this is the lowest minimum; gap: no other is lower by more than that; none: nothing is known."""
        if self.gap <= max(NEGLIGIBLE_GAP * self.chi2, ROUNDING_GAP):
            return "certified"
        return "gap" if self.gap < self.chi2 else "none"

    def __str__(self) -> str:
        return f"gap <= {self.gap:.3g}" if self.status == "gap" else self.status


def certify(graph: PoseGraph) -> Certificate:
    """Bound how much lower than at this estimate chi2 could be elsewhere.

    Args:
        graph: at a minimum of chi2. The bound holds for any estimate, but away from a minimum it says little. Of a
            graph whose landmarks have headings nothing is known: headings that look alike are no one quadratic.
    """
    graph = _about_what_is_fixed(graph)
    at, layout = residuals(graph), layout_of(graph)
    if len(graph.headings.pose):
        return Certificate(at.chi2, at.chi2, -np.inf)
    quadratic = _quadratic_below(graph, layout, at.by_kind)
    y, num_headings = layout.y, layout.num_headings
    # A solver stops a little before the minimum. To the headings where it stopped, the best positions are known.
    positions = _best_positions(quadratic, y[:num_headings])
    if positions is None:
        return Certificate(at.chi2, at.chi2, -np.inf)
    best = np.append(y[:num_headings], positions)
    still_to_go = ((best - y).conj() @ (quadratic @ (best - y))).real
    multipliers = (best.conj() * (quadratic @ best)).real[:num_headings]
    allowed = NEGLIGIBLE_GAP * at.chi2 / num_headings
    smallest = _smallest_eigenvalue(quadratic, multipliers, allowed / 2)
    gap = still_to_go + num_headings * max(-smallest, 0.0)
    return Certificate(at.chi2, float(np.clip(gap, 0.0, at.chi2)), smallest)  # chi2 is nowhere negative


def _about_what_is_fixed(graph: PoseGraph) -> PoseGraph:
    """The same map with the mean of what is fixed at the origin: far from there, rounding would hide the proof."""
    poses, landmarks = graph.poses, graph.landmarks
    fixed = np.append(poses[graph.fixed_poses, :2], landmarks[graph.fixed_landmarks, :2], axis=0)
    shift = np.append(fixed.mean(axis=0), 0.0)
    return with_estimates(graph, poses - shift, landmarks - shift[: landmarks.shape[1]])


def _quadratic_below(graph: PoseGraph, layout: Layout, by_kind: tuple[np.ndarray, ...]):
    """Q of the quadratic that touches chi2 at the estimate and is nowhere above it.

    With d the place of b in the frame of a, d0 its value today, u the change of an error of heading, and g half the
    slope of chi2: ``w |d - d0|^2 + 2 Re(conj(g) (d - d0))`` and ``2 k (1 - cos u) + 2 g sin u``.
    """
    form = QuadraticForm()
    for kind, residual in zip(FACTOR_KINDS, by_kind, strict=True):
        if not kind.displaces:
            continue
        (a, b), information = kind.ends(graph), kind.information(graph)
        slope = np.einsum("eij,ej->ei", information, residual)
        weight, heading_weight = isotropic_part(information)
        today = np.exp(-1j * a.estimate[:, 2]) * (as_complex(b.estimate) - as_complex(a.estimate))
        form.add_displacement(layout, (a, b), weight, as_complex(slope) - weight * today)
        if b.variable in layout.headings:
            weight = _chordal_weight(heading_weight, slope[:, 2], residual[:, 2])
            turn = np.exp(1j * (a.estimate[:, 2] - b.estimate[:, 2]))
            form.add(layout.heading(a), layout.heading(b), -(weight + 1j * slope[:, 2]) * turn)
    return form.matrix(len(layout.y))


def _chordal_weight(weight: np.ndarray, slope: np.ndarray, error: np.ndarray) -> np.ndarray:
    """The largest k with ``2 slope sin u + 2 k (1 - cos u)`` nowhere above ``2 slope u + weight u^2``.

    u is how far an error of heading is from today's; both are between -pi and pi.

    Args:
        weight: (E,) of the squared error.
        slope: (E,) half the derivative of chi2 by the error.
        error: (E,) rad, today's.
    """
    u = ERRORS - error[:, None]
    u = np.clip(np.where(np.abs(u) < 1e-3, 1e-3, u), 1e-3 - 2 * np.pi, 2 * np.pi - 1e-3)  # away from where cos u = 1
    ratio = (weight[:, None] * u**2 + 2 * slope[:, None] * (u - np.sin(u))) / (2 - 2 * np.cos(u))
    # Between two points of the grid the curve may lie lower, by an eighth of its second difference.
    bend = np.abs(np.diff(ratio, 2, axis=1))
    lower = ratio[:, 1:-1] - bend
    return np.minimum(lower.min(axis=1), ratio[:, [0, -1]].min(axis=1))


def _best_positions(quadratic, headings: np.ndarray) -> np.ndarray | None:
    """The positions at which the quadratic is lowest, to given headings; None where isotropic weights leave it open."""
    num_headings = len(headings)
    if quadratic.shape[0] == num_headings:
        return np.zeros(0, complex)
    factors = _positive_factors(quadratic[num_headings:, num_headings:])
    return factors and factors.solve(-(quadratic[num_headings:, :num_headings] @ headings))


def _smallest_eigenvalue(quadratic, multipliers: np.ndarray, tolerance: float) -> float:
    """A lower bound of the smallest eigenvalue of ``Q - diag(multipliers)``, the positions eliminated.

    ``Q - diag(multipliers) + shift`` is positive definite where all pivots of its factors are positive, and then no
    eigenvalue is below -shift. So a small shift is tried at first; when that fails, shifts are raised until one
    succeeds. From there Lanczos iterations find the smallest eigenvalue, and a shift by a little more verifies it.
    """
    num_headings = len(multipliers)
    diagonal = np.zeros(quadratic.shape[0])

    def factorize(shift):
        diagonal[:num_headings] = shift - multipliers
        return _positive_factors(quadratic + _diagonal(diagonal))

    # Of less than that the signs of the pivots say nothing; of a graph without factors all is zero.
    size = max(np.abs(multipliers).max(), np.abs(quadratic.diagonal()[:num_headings]).max())
    shift = max(tolerance, ROUNDING_SHARE * size, np.finfo(float).tiny)
    if factorize(shift):
        return -shift
    while not (factors := factorize(shift)):
        shift *= 10
        if not np.isfinite(shift):
            return -np.inf

    guess = shift - 1 / _largest_eigenvalue_of_inverse(factors, num_headings)
    for more in (1e-5, 1e-3, 0.1):
        if factorize(guess * (1 + more)):
            return -guess * (1 + more)
    return -shift


def _largest_eigenvalue_of_inverse(factors, num_headings: int) -> float:
    """Of the inverse's block of the headings, by Lanczos iterations."""
    from scipy.sparse.linalg import LinearOperator, eigsh

    def solve(headings):
        return factors.solve(np.append(headings, np.zeros(factors.shape[0] - num_headings)))[:num_headings]

    if num_headings < FEW:
        return float(np.linalg.eigvalsh(np.column_stack([solve(column) for column in np.eye(num_headings)]))[-1])
    operator = LinearOperator((num_headings,) * 2, matvec=solve, dtype=complex)
    start = np.random.default_rng(0).normal(size=num_headings).astype(complex)
    return float(eigsh(operator, 1, which="LA", return_eigenvectors=False, v0=start, tol=1e-6)[0].real)


def _diagonal(values: np.ndarray):
    from scipy.sparse import diags_array

    return diags_array(values, format="csc")


def _positive_factors(matrix):
    """Factors of a Hermitian matrix, L D L^H; None where it is not positive definite."""
    from scipy.sparse.linalg import splu

    try:
        factors = splu(matrix, **SYMMETRIC)
    except RuntimeError:  # a pivot is exactly zero
        return None
    on_diagonal = np.array_equal(factors.perm_r, factors.perm_c)
    return factors if on_diagonal and (factors.U.diagonal().real > 0).all() else None
