"""Two hundred runs of one scene: are the errors as large as the solver says they are?

With the true association everything is known about what must come out. chi2 is chi-squared distributed with as many
degrees of freedom as numbers were measured less numbers estimated; errors in units of their own covariance (NEES) are,
too; and a 2-sigma ellipse holds the truth in ``1 - exp(-2)`` of all cases. Seeds are 0 to 199, none chosen. A right
solver fails each of these tests once in ten thousand choices of seeds.
"""

import functools
import math
from dataclasses import dataclass, replace

import numpy as np
import pytest
import scipy.stats

from npslam_teach import evaluation, pose_graph, se2, simulate
from npslam_teach.types import BetweenFactors, ObservationFactors, PoseGraph

SEEDS, LEVEL = range(200), 0.9999
INSIDE = 1 - math.exp(-2)  # of a 2-sigma ellipse in the plane: 86.5 %


@dataclass(frozen=True)
class Runs:
    """What came out, seed by seed (S of them)."""

    chi2: np.ndarray  # (S,)
    dof: np.ndarray  # (S,)
    num_unknowns: np.ndarray  # (S,)
    joint_nees: np.ndarray  # (S,) of all unknowns together
    pose_nees: np.ndarray  # (S, P) of some poses, 3 numbers each
    xy_nees: np.ndarray  # (S, P) of their positions alone
    object_nees: np.ndarray  # (S, K)


@functools.cache
def scene():
    """Twice round a circle, among twelve objects that are seen again and again."""
    world = simulate.scattered_world(3, ("chair", "cup", "plant", "lamp"), np.random.default_rng(0), size=8.0)
    turn = np.linspace(0, 4 * np.pi, 2000)
    path = simulate.follow(np.column_stack([4 + 2.5 * np.cos(turn), 4 + 2.5 * np.sin(turn)]), 0.5)
    return world, path, simulate.paper_sensor(0.0)


def solved(seed, odometry_factor=1.0, observation_factor=1.0):
    """The fit with true associations to one run; the factors make the solver believe in other standard deviations."""
    log, truth = simulate.simulate_run(*scene(), np.random.default_rng(seed))
    log = replace(
        log,
        odometry_std=log.odometry_std * odometry_factor,
        observation_std=log.observation_std * observation_factor,
    )
    return evaluation.true_association_fit(log, truth), truth


def nees(error, cov):
    """(N,) squared errors (N, k) in units of their covariances (N, k, k)."""
    return np.einsum("nk,nk->n", error, np.linalg.solve(cov, error[..., None])[..., 0])


def measured(seeds, **factors):
    """Solve the runs of all seeds."""
    return Runs(*map(np.array, zip(*(measure(*solved(seed, **factors)) for seed in seeds), strict=True)))


def measure(graph, truth):
    seen = np.unique(truth.obs_object)
    chosen = np.linspace(0, len(graph.poses) - 1, 7).astype(int)[1:]
    error = graph.poses - truth.poses
    error[:, 2] = se2.wrap(error[:, 2])
    object_error = graph.landmarks - truth.world.object_xy[seen]
    pose_cov, object_cov = pose_graph.marginal_covariance(graph, chosen, np.arange(len(seen)))
    h, _, chi2 = pose_graph.linearize(graph)
    joint = np.concatenate([error[1:].ravel(), object_error.ravel()])
    measured_numbers = 3 * len(graph.between.i) + 2 * len(graph.observations.pose)
    return (
        chi2,
        measured_numbers - len(joint),
        len(joint),
        joint @ h @ joint,
        nees(error[chosen], pose_cov),
        nees(error[chosen, :2], pose_cov[:, :2, :2]),
        nees(object_error, object_cov),
    )


@pytest.fixture(scope="module")
def runs():
    return measured(SEEDS)


# ---- the verdicts ----


def is_chi_squared(total, dof):
    """Whether a sum over independent runs lies where a chi-squared variable does."""
    low, high = scipy.stats.chi2.interval(LEVEL, dof)
    return low < total < high


def has_mean(per_run, expected):
    """Whether the mean over independent runs agrees with what is expected (Student's t)."""
    return scipy.stats.ttest_1samp(per_run, expected).pvalue > 1 - LEVEL


def is_share(hits, expected):
    """Whether independent events happened as often as expected (binomial)."""
    return scipy.stats.binomtest(int(np.count_nonzero(hits)), len(hits), expected).pvalue > 1 - LEVEL


def verdicts(runs):
    """Test by test, whether these runs pass it."""
    one_each = np.arange(len(runs.chi2)), np.arange(len(runs.chi2)) % runs.object_nees.shape[1]
    found = {
        "chi2": is_chi_squared(runs.chi2.sum(), runs.dof.sum()),
        "joint NEES": is_chi_squared(runs.joint_nees.sum(), runs.num_unknowns.sum()),
        # Objects and poses of one run err together; whole runs are independent.
        "pose NEES": has_mean(runs.pose_nees.mean(axis=1), 3.0),
        "object NEES": has_mean(runs.object_nees.mean(axis=1), 2.0),
        "ellipses of poses": has_mean((runs.xy_nees < 4).mean(axis=1), INSIDE),
        "ellipses of objects": has_mean((runs.object_nees < 4).mean(axis=1), INSIDE),
        "ellipse of one object per run": is_share(runs.object_nees[one_each] < 4, INSIDE),
        "ellipse of the last pose": is_share(runs.xy_nees[:, -1] < 4, INSIDE),
    }
    for k in range(runs.pose_nees.shape[1]):
        found[f"NEES of pose {k}"] = is_chi_squared(runs.pose_nees[:, k].sum(), 3 * len(runs.chi2))
    for k in range(runs.object_nees.shape[1]):
        found[f"NEES of object {k}"] = is_chi_squared(runs.object_nees[:, k].sum(), 2 * len(runs.chi2))
    return found


def failed(runs):
    return {name for name, passed in verdicts(runs).items() if not passed}


def with_covariance(runs, factor):
    """What would have come out had the solver reported its covariances times ``factor``."""
    names = ("joint_nees", "pose_nees", "xy_nees", "object_nees")
    return replace(runs, **{name: getattr(runs, name) / factor for name in names})


def test_the_scene_says_something(runs):
    assert (runs.dof > 200).all()
    assert (runs.num_unknowns > 150).all()
    assert runs.object_nees.shape == (len(SEEDS), 12)


def test_errors_are_as_large_as_the_solver_says(runs):
    assert not failed(runs)


@pytest.mark.parametrize("factor", [1.2, 1 / 1.2])
def test_covariances_a_fifth_off_would_be_noticed(runs, factor):
    noticed = failed(with_covariance(runs, factor))
    assert {"joint NEES", "pose NEES", "object NEES"} <= noticed
    assert "chi2" not in noticed


@pytest.mark.parametrize("factor", [2.0, 0.5])
def test_ellipses_of_twice_the_area_or_half_of_it_would_be_noticed(runs, factor):
    everything_but_chi2 = set(verdicts(runs)) - {"chi2"}
    assert failed(with_covariance(runs, factor)) == everything_but_chi2


@pytest.mark.slow
@pytest.mark.parametrize("factor", [1.1, 0.9])
def test_standard_deviations_ten_percent_off_would_be_noticed(factor):
    assert {"chi2", "joint NEES"} <= failed(measured(SEEDS, observation_factor=factor))
    assert "joint NEES" in failed(measured(SEEDS, odometry_factor=factor))


@pytest.mark.parametrize(
    ("fixed_poses", "fixed_landmarks", "unknowns"),
    [((0,), (), 8), ((0, 2), (), 5), ((0,), (0,), 6), ((), (0,), 11 - 2)],
)
def test_degrees_of_freedom_counted_by_hand(fixed_poses, fixed_landmarks, unknowns):
    """Three poses, two steps, one object seen from all three: 6 + 6 measured numbers, 9 + 2 numbers in all."""
    steps = BetweenFactors([0, 1], [1, 2], [[1.0, 0, 0]] * 2, [np.eye(3)] * 2)
    seen = ObservationFactors([0, 1, 2], [0, 0, 0], [[2.0, 0.5], [1.0, 0.0], [0.0, 0.0]], [np.eye(2)] * 3)
    poses = [[0, 0, 0], [1, 0, 0], [2, 0, 0]]
    graph = PoseGraph(poses, [[2.0, 0.0]], steps, seen, fixed_poses, fixed_landmarks)
    assert evaluation.chi2_per_dof(graph) == pytest.approx(0.25 / (12 - unknowns))


def split_in_two(runs, choose):
    """chi2 scores of each run after every true object is cut in two by ``choose(xy_world, of_the_object)``."""
    scores = []
    for seed in runs:
        log, truth = simulate.fifteen_objects(seed)
        off = se2.apply(truth.poses[log.obs_time], log.obs_xy) - truth.world.object_xy[truth.obs_object]
        labels = np.unique(2 * truth.obs_object + choose(off), return_inverse=True)[1]
        scores.append(evaluation.chi2_score(pose_graph.fit(log, labels, truth.poses)))
    return np.array(scores)


def test_chi2_score_has_both_tails():
    """Splits that do not look at the noise are silent; splits by where the noise points lower chi2, and it shows."""
    blind = split_in_two(range(3), lambda off: np.arange(len(off)) % 2)
    by_side = split_in_two(range(3), lambda off: off[:, 0] > 0)
    assert np.all(np.abs(blind) < 3.5)
    assert np.all(by_side < -5)


def test_chi2_score_by_hand():
    """Twelve numbers, eight unknowns, chi2 of 0.25: (0.25 - 4) / sqrt(8); no degrees of freedom, no score."""
    steps = BetweenFactors([0, 1], [1, 2], [[1.0, 0, 0]] * 2, [np.eye(3)] * 2)
    seen = ObservationFactors([0, 1, 2], [0, 0, 0], [[2.0, 0.5], [1.0, 0.0], [0.0, 0.0]], [np.eye(2)] * 3)
    graph = PoseGraph([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[2.0, 0.0]], steps, seen)
    assert evaluation.chi2_score(graph) == pytest.approx((0.25 - 4) / math.sqrt(8))
    once = ObservationFactors([0], [0], [[2.0, 0.5]], [np.eye(2)])
    assert math.isnan(evaluation.chi2_score(replace(graph, observations=once)))


@pytest.mark.parametrize(("dof", "share"), [(1, 0.95), (6, 0.5), (400, 0.99)])
def test_chi2_bounds_leave_as_much_at_either_end(dof, share):
    low, high = evaluation.chi2_bounds(dof, share)
    below, above = scipy.stats.chi2.cdf(low * dof, dof), scipy.stats.chi2.sf(high * dof, dof)
    np.testing.assert_allclose([below, above], (1 - share) / 2)


def test_chi2_bounds_of_two_degrees_of_freedom_by_hand():
    # Two squared standard normal numbers have an exponential sum: P(sum > x) = exp(-x / 2).
    low, high = evaluation.chi2_bounds(np.array([2, 2]), 0.9)
    np.testing.assert_allclose(low, -np.log(0.95))
    np.testing.assert_allclose(high, -np.log(0.05))
