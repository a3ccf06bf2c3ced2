"""How noisy is this log? Estimated from the log itself: who is who and where, given the noise; the noise, given these.

Residuals are smaller than errors, because the trajectory was bent to fit them: of n measured numbers the fit uses up as
many as their leverages add up to, and ``sum r^2 / (n - sum of leverages)`` is the variance (MacKay, "Bayesian
Interpolation", 1992). Association and noise are estimated in turn until the noise stays.

Errors of real sensors resemble those just before. A camera that sees everything a little too far does so for a whole
pass, and to a model of white noise the robot seems to have moved instead. Therefore one observation of every pass is
taken, many times over: errors of different passes are independent. Where all observations together say the same, their
noise is white, and they say it more precisely.
"""

import warnings
from dataclasses import dataclass, replace

import numpy as np

from npslam_teach.association import first_observations, in_order_of_sight
from npslam_teach.methods.gating import GATE, squared_residuals
from npslam_teach.methods.noise import with_noise
from npslam_teach.methods.posterior import posterior
from npslam_teach.methods.tracklets import in_passes
from npslam_teach.pose_graph import fit, mean_leverages, squared_radius
from npslam_teach.pose_graph.factor_kinds import FACTOR_KINDS
from npslam_teach.system.progress import track
from npslam_teach.types import PoseGraph, RobotLog

CHOICES = 8  # of one observation per pass
LEVERAGES = 80  # of the factors of a kind that are worked out
MOST_STEPS, SETTLED = 30, 0.02  # relative change of a standard deviation that counts as none
ALIKE = 1.25  # white noise: passes and all observations say the same, up to this factor
# Of normal residuals within the gate the mean square is less than that of all: E[s; s < q] / 2 with s = chi-squared.
KEPT_SHARE = 1 - (1 - GATE) * squared_radius(GATE) / (2 * GATE)


@dataclass(frozen=True, eq=False)
class NoiseEstimate:
    """What the residuals of a log say of its noise."""

    odometry_std: np.ndarray  # (3,) m, m, rad per step; so do errors grow from one pass over an object to the next
    observation_std: np.ndarray  # (2,) m, from pass to pass
    within_pass_std: np.ndarray  # (2,) m, of observations against others shortly before; less where errors last
    outlier_share: float  # of all observations: without an object, or beyond what a normal distribution explains
    rounds: int
    converged: bool

    @property
    def is_white(self) -> bool:
        """Whether errors of observations shortly after each other are independent, as every method here assumes."""
        return bool((self.observation_std <= ALIKE * self.within_pass_std).all())

    def applied_to(self, log: RobotLog) -> RobotLog:
        """The log with this noise instead of its own."""
        return with_noise(log, self.odometry_std, self.observation_std)


def estimate_noise(log: RobotLog, rounds: int = 8, *, seed: int = 0) -> NoiseEstimate:
    """Estimate how far a log's standard deviations are off: one factor for odometry, one for observations.

    The proportions among the three numbers of a step, and the two of an observation, stay as the log has them; so does
    the noise of headings.

    Args:
        log: with steps, and objects that are seen in more than one pass; its own noise is where the search begins.
        rounds: of association at most; each is one search of ``posterior``.
        seed: of the random numbers.

    Raises:
        ValueError: there is no odometry, or nothing was found to be seen again.
    """
    if rounds != int(rounds) or rounds < 1:
        raise ValueError(f"rounds: expected a positive integer, got {rounds}")
    if len(log.odometry) == 0:
        raise ValueError("log: expected steps of odometry, got none")
    # Too narrow gates cut objects into pieces, which costs more than too wide ones do: begin with twice the noise.
    log, converged = with_noise(log, 2 * log.odometry_std, 2 * log.observation_std), False
    for number in track(range(1, rounds + 1), rounds, "noise", "rounds"):
        with warnings.catch_warnings(record=True) as said:
            *_, last = posterior(log, starts=1, seed=seed)
            # The same draws in every round: what differs between two rounds is then not the luck of the draw.
            estimate = _given_labels(log, last.labels, last.graph.poses, number, np.random.default_rng(seed))
        before, log = _scales(log), estimate.applied_to(log)
        if np.abs(_scales(log) / before - 1).max() <= SETTLED:
            converged = True
            break
    for each in said:  # of the last round; what an earlier one could not finish, it had another noise for
        warnings.warn(each.message, stacklevel=2)
    return replace(estimate, converged=converged)


def _given_labels(log: RobotLog, labels: np.ndarray, poses: np.ndarray, number: int, rng) -> NoiseEstimate:
    """The noise of a log whose associations are known, both ways, and the one that is to be believed."""
    single = in_order_of_sight(labels, labels >= 0)
    choices = [_one_per_pass(log, single, rng) for _ in range(CHOICES)]
    if not any(np.bincount(each[each >= 0]).max(initial=0) > 1 for each in choices):
        raise ValueError("log: expected an object that is seen in more than one pass, found none")
    everything, near, poses = _fixed_point(log, single, [single], poses)
    by_pass, _, _ = _fixed_point(everything, single, choices, poses)
    white = by_pass.observation_std[0] <= ALIKE * everything.observation_std[0]
    best = everything if white else by_pass
    share = 1 - np.count_nonzero(near >= 0) / log.num_observations - (1 - GATE)
    within = everything.observation_std
    return NoiseEstimate(best.odometry_std, best.observation_std, within, max(share, 0.0), number, False)


def _fixed_point(
    log: RobotLog, labels: np.ndarray, choices: list[np.ndarray], poses: np.ndarray
) -> tuple[RobotLog, np.ndarray, np.ndarray]:
    """The log with the noise that its residuals have, by several choices of observations (labels (M,), -1 left out).

    Returns:
        the log; (M,) the labels without outliers; (T, 3) poses.
    """
    for _ in range(MOST_STEPS):
        near, poses = without_outliers(log, labels, poses)
        squares, free = np.zeros(2), np.zeros(2)
        for choice in choices:
            used = np.where(near >= 0, choice, -1)
            graph = fit(log, in_order_of_sight(used, used >= 0), poses)
            of_choice = residual_squares(graph, LEVERAGES)
            squares, free = squares + of_choice[0], free + of_choice[1]
        factors = np.sqrt(squares / np.maximum(free, 1e-9) / [1.0, KEPT_SHARE])
        log = with_noise(log, factors[0] * log.odometry_std, factors[1] * log.observation_std)
        if np.abs(factors - 1).max() <= SETTLED / 4:
            break
    return log, near, poses


def residual_squares(graph: PoseGraph, most: int = 300) -> tuple[np.ndarray, np.ndarray]:
    """Squared residuals of odometry and observations in standard deviations, and of how many free numbers they are.

    Args:
        graph: at its minimum.
        most: as in ``mean_leverages``.

    Returns:
        (2,) sums of squares; (2,) how many measured numbers are not used up by the fit.
    """
    squares, free = np.zeros(2), np.zeros(2)
    of_positions = zip((kind for kind in FACTOR_KINDS if kind.displaces), mean_leverages(graph, most), strict=False)
    for k, (kind, leverage) in enumerate(of_positions):
        off = kind.residuals(graph)
        squares[k] = np.einsum("ei,eij,ej->", off, kind.information(graph), off)
        free[k] = len(off) * np.sum(1 - leverage)
    return squares, free


def without_outliers(log: RobotLog, labels: np.ndarray, poses: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Leave out what lies beyond the gate of its own object.

    Args:
        log: what was measured.
        labels: (M,) the object of each observation, from 0 without gaps; -1 = of none.
        poses: (T, 3) W, from which the solver sets out.

    Returns:
        (M,) the labels, -1 for the outliers; (T, 3) the poses of the graph in which they still count.
    """
    graph, used, near = fit(log, labels, poses), np.flatnonzero(labels >= 0), labels.copy()
    near[used[squared_residuals(log, used, graph.poses, graph.landmarks[labels[used]]) > squared_radius(GATE)]] = -1
    return near, graph.poses


def _one_per_pass(log: RobotLog, labels: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Labels (M,) of one observation for each time that an object was in view; -1 for the others."""
    order, passes = in_passes(labels, log.obs_time)
    number = np.full(len(labels), -1)
    number[order] = passes
    shuffled = rng.permutation(len(labels))
    chosen = shuffled[first_observations(number[shuffled])]
    return np.where(np.isin(np.arange(len(labels)), chosen), labels, -1)


def _scales(log: RobotLog) -> np.ndarray:
    """(2,) how large the noise of odometry and of observations is."""
    return np.array([log.odometry_std[0], log.observation_std[0]])
