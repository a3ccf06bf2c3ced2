"""The robust solver against independent oracles: SciPy's least squares, hand-solved graphs, published minima."""

import importlib
import warnings
from dataclasses import replace

import numpy as np
import pytest
import scipy.optimize
import scipy.stats
from graphs import pack, quarrelling_graph, random_graph, three_pose_graph, unpack, whitened_residuals

from npslam_teach import datasets, np_graph, pose_graph, se2, simulate
from npslam_teach.course.pose_graph.explorer import bad_starts
from npslam_teach.pose_graph import factorization, levenberg_marquardt, linearization
from npslam_teach.types import BetweenFactors, ObservationFactors, PoseGraph

MODULE = importlib.import_module("npslam_teach.pose_graph.levenberg_marquardt")  # its function hides its name


@pytest.mark.parametrize("seed", range(8))
def test_solver_agrees_with_scipy_least_squares(seed):
    graph = random_graph(seed, num_landmarks=seed % 5)
    oracle = scipy.optimize.least_squares(
        lambda x: whitened_residuals(graph, x), pack(graph), xtol=1e-15, ftol=1e-15, gtol=1e-15
    )
    *_, last = levenberg_marquardt(graph, tolerance=1e-13)
    assert last.converged
    assert last.chi2 == pytest.approx(2 * oracle.cost, rel=1e-9)
    poses, landmarks = unpack(graph, oracle.x)
    np.testing.assert_allclose(last.graph.poses[:, :2], poses[:, :2], atol=1e-5)
    np.testing.assert_allclose(last.graph.landmarks, landmarks, atol=1e-5)


def test_newton_steps_solve_large_residual_problems_in_half_the_iterations(monkeypatch):
    """Loop closures that contradict the odometry by metres: a large-residual problem."""
    graphs = [quarrelling_graph(seed) for seed in range(8)]
    quick = [list(levenberg_marquardt(graph))[-1] for graph in graphs]
    monkeypatch.setattr(MODULE, "LINEAR_CONVERGENCE", np.inf)
    plain = [list(levenberg_marquardt(graph))[-1] for graph in graphs]
    assert sum(step.iteration for step in quick) < 0.5 * sum(step.iteration for step in plain)
    for graph, ours, linear in zip(graphs, quick, plain, strict=True):
        assert ours.converged
        assert ours.chi2 <= linear.chi2 * (1 + 1e-9)
        oracle = scipy.optimize.least_squares(
            lambda x, graph=graph: whitened_residuals(graph, x), pack(ours.graph), xtol=1e-15, ftol=1e-15, gtol=1e-15
        )
        assert ours.chi2 == pytest.approx(2 * oracle.cost, rel=1e-6)


def test_three_poses_solved_by_hand():
    *_, last = levenberg_marquardt(three_pose_graph())
    np.testing.assert_allclose(last.graph.poses, [[0, 0, 0], [14 / 15, 0, 0], [28 / 15, 0, 0]], atol=1e-12)
    assert last.chi2 == pytest.approx(3 / 15**2, rel=1e-12)


def test_headings_of_many_turns_do_not_swallow_the_steps():
    graph = random_graph(8)
    turned = replace(graph, poses=graph.poses + [0.0, 0.0, 2 * np.pi * 1e6])
    *_, last = levenberg_marquardt(turned)
    assert last.chi2 == pytest.approx(linearization.chi2(pose_graph.optimize(graph)), rel=1e-6)
    assert np.abs(last.graph.poses[:, 2]).max() <= np.pi


def test_numbers_beyond_floating_point_are_refused():
    with pytest.raises(ValueError, match="poses: expected numbers up to 1e[+]15"):
        replace(random_graph(0), poses=np.full((12, 3), 1e200))


def test_pose_zero_is_the_gauge():
    graph = random_graph(1)
    np.testing.assert_array_equal(pose_graph.optimize(graph).poses[0], graph.poses[0])


@pytest.mark.parametrize("seed", range(3))
def test_moving_the_world_moves_the_answer(seed):
    graph, motion = random_graph(seed), np.array([10.0, -4.0, 2.2])
    moved = replace(graph, poses=se2.compose(motion, graph.poses), landmarks=se2.apply(motion, graph.landmarks))
    a, b = pose_graph.optimize(graph, 1e-14), pose_graph.optimize(moved, 1e-14)
    assert linearization.chi2(b) == pytest.approx(linearization.chi2(a), rel=1e-9)
    np.testing.assert_allclose(b.landmarks, se2.apply(motion, a.landmarks), atol=1e-6)


def test_order_and_names_do_not_matter():
    graph, rng = random_graph(2), np.random.default_rng(0)
    f, g = rng.permutation(len(graph.between.i)), rng.permutation(len(graph.observations.pose))
    name = np.append(0, 1 + rng.permutation(len(graph.poses) - 1))  # pose 0 keeps its name: it is the gauge
    name_l = rng.permutation(len(graph.landmarks))
    poses, landmarks = np.empty_like(graph.poses), np.empty_like(graph.landmarks)
    poses[name], landmarks[name_l] = graph.poses, graph.landmarks
    b, o = graph.between, graph.observations
    shuffled = PoseGraph(
        poses,
        landmarks,
        BetweenFactors(name[b.i[f]], name[b.j[f]], b.relative_pose[f], b.information[f]),
        ObservationFactors(name[o.pose[g]], name_l[o.landmark[g]], o.xy[g], o.information[g]),
    )
    first, second = pose_graph.optimize(graph, 1e-14), pose_graph.optimize(shuffled, 1e-14)
    assert linearization.chi2(second) == pytest.approx(linearization.chi2(first), rel=1e-9)
    np.testing.assert_allclose(second.poses[name], first.poses, atol=1e-6)
    np.testing.assert_allclose(second.landmarks[name_l], first.landmarks, atol=1e-6)


@pytest.mark.parametrize("seed", range(20))
def test_chi2_never_rises_even_from_a_wild_start(seed):
    graph = random_graph(seed, start_noise=3.0)
    values = [step.chi2 for step in levenberg_marquardt(graph)]
    assert all(after <= before for before, after in zip(values, values[1:], strict=False))


def test_a_wild_start_needs_damping_and_gets_it():
    steps = [s for seed in range(20) for s in levenberg_marquardt(random_graph(seed, start_noise=3.0))]
    assert any(step.damping > 0 for step in steps)


def test_not_converged_is_said():
    graph = random_graph(3, start_noise=1.0)
    *_, last = levenberg_marquardt(graph, max_iterations=1)
    assert not last.converged
    assert last.status == "iteration limit"
    with pytest.warns(UserWarning, match="stopped after 1 iterations: iteration limit"):
        pose_graph.optimize(graph, max_iterations=1)


def test_a_perfect_start_is_converged_at_once():
    graph = random_graph(4, noise=0.0, start_noise=0.0)
    *_, last = levenberg_marquardt(graph)
    assert last.converged
    assert last.iteration == 1
    assert last.chi2 < 1e-20


def test_a_long_drive_that_has_to_bend_does_so_in_a_few_steps():
    """A first association over ten rooms: each full step overshoots, and damped ones would creep for hundreds."""
    log, _ = simulate.grid_of_rooms(10)
    start, first = np_graph(log, iterations=1)
    landmarks = [start.graph.landmarks[first.labels == k].mean(axis=0) for k in range(first.num_objects)]
    *_, last = levenberg_marquardt(replace(first.graph, poses=start.graph.poses, landmarks=landmarks))
    assert last.converged
    assert last.iteration <= 20
    assert last.chi2 == pytest.approx(first.chi2, rel=1e-6)


def test_a_wrong_derivative_ends_with_a_reason(monkeypatch):
    """Uphill whatever the damping: not converged, and nothing has moved."""
    wrong = [
        kind._replace(jacobians=lambda *ends, right=kind.jacobians: tuple(-j for j in right(*ends)))
        for kind in linearization.FACTOR_KINDS
    ]
    monkeypatch.setattr(linearization, "FACTOR_KINDS", wrong)
    steps = list(levenberg_marquardt(random_graph(4)))
    assert (steps[-1].converged, steps[-1].status) == (False, "no step lowers chi2")
    np.testing.assert_array_equal(steps[-1].graph.poses, steps[0].graph.poses)


def test_a_matrix_that_turns_singular_on_the_way_is_damped():
    """Rounding may take the last digit of a pivot in one iteration of many; the next bit of damping gives it back."""
    graph, calls = random_graph(4), []
    system = linearization.linear_system(graph)

    def failing_once(data):
        calls.append(len(calls))
        if len(calls) == 4:
            raise np.linalg.LinAlgError(factorization.SINGULAR)
        return system.factorize(data)

    steps = list(levenberg_marquardt(graph, system=system._replace(factorize=failing_once)))
    assert len(calls) > 4 and max(step.damping for step in steps) > 0
    assert steps[-1].converged
    assert steps[-1].chi2 == pytest.approx(linearization.chi2(pose_graph.optimize(graph)), rel=1e-8)


def test_a_solver_that_stops_early_says_why():
    *_, last = levenberg_marquardt(random_graph(4), max_iterations=1)
    assert (last.converged, last.status) == (False, "iteration limit")


@pytest.mark.skipif(not factorization.has_qdldl(), reason="qdldl is not installed")
@pytest.mark.parametrize("seed", range(5))
def test_both_libraries_give_the_same_solution(seed):
    graph = random_graph(seed)
    systems = [linearization.linear_system(graph, name) for name in ("qdldl", "superlu")]
    solutions = [list(levenberg_marquardt(graph, system=system))[-1] for system in systems]
    assert solutions[0].chi2 == pytest.approx(solutions[1].chi2, rel=1e-12)
    np.testing.assert_allclose(solutions[0].graph.poses, solutions[1].graph.poses, atol=1e-9)
    np.testing.assert_allclose(solutions[0].graph.landmarks, solutions[1].graph.landmarks, atol=1e-9)


def test_a_single_pose_has_nothing_to_solve():
    empty = BetweenFactors([], [], np.zeros((0, 3)), np.zeros((0, 3, 3)))
    sightings = ObservationFactors([0, 0], [0, 0], [[1.0, 0.0], [3.0, 0.0]], np.tile(np.eye(2), (2, 1, 1)))
    solved = pose_graph.optimize(PoseGraph(np.zeros((1, 3)), np.zeros((1, 2)), empty, sightings))
    np.testing.assert_allclose(solved.landmarks, [[2.0, 0.0]])


def test_a_graph_without_unknowns():
    empty = BetweenFactors([], [], np.zeros((0, 3)), np.zeros((0, 3, 3)))
    nothing = ObservationFactors([], [], np.zeros((0, 2)), np.zeros((0, 2, 2)))
    *_, last = levenberg_marquardt(PoseGraph(np.zeros((1, 3)), np.zeros((0, 2)), empty, nothing))
    assert last.converged
    assert last.chi2 == 0.0


def test_the_graph_that_comes_in_is_left_alone():
    graph = random_graph(6)
    poses, landmarks = graph.poses.copy(), graph.landmarks.copy()
    pose_graph.optimize(graph)
    np.testing.assert_array_equal(graph.poses, poses)
    np.testing.assert_array_equal(graph.landmarks, landmarks)
    with pytest.raises(ValueError, match="read-only"):
        graph.poses[0, 0] = 1.0


def test_the_same_graph_gives_the_same_bits():
    a, b = pose_graph.optimize(random_graph(7)), pose_graph.optimize(random_graph(7))
    assert a.poses.tobytes() == b.poses.tobytes()


@pytest.mark.parametrize(
    ("name", "expected"), [("intel", 45.004696), ("manhattan", 3549.0368), ("victoria_park", 6184.1206)]
)
def test_standard_graphs_reach_the_published_minimum(data_folder, name, expected):
    graph = datasets.load_g2o(data_folder / f"{name}.g2o")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert linearization.chi2(pose_graph.optimize(graph)) == pytest.approx(expected, rel=2e-8)


def in_other_units(graph, factor):
    """The same graph with lengths in another unit, standard deviations too."""
    scale = np.array([factor, factor, 1.0])
    between = replace(
        graph.between,
        relative_pose=graph.between.relative_pose * scale,
        information=graph.between.information / scale[:, None] / scale,
    )
    seen = replace(
        graph.observations, xy=graph.observations.xy * factor, information=graph.observations.information / factor**2
    )
    moved = graph.poses * scale, graph.landmarks * factor
    return replace(graph, poses=moved[0], landmarks=moved[1], between=between, observations=seen)


@pytest.mark.parametrize("start", ["wheels", "thrown about"])
def test_damping_does_not_depend_on_the_unit_of_length(start):
    """A multiple of H's own diagonal (Marquardt) is the same in metres and in feet; a constant (Levenberg) is not."""
    graph = bad_starts()[0][start]
    steps = list(levenberg_marquardt(graph))
    for factor in (0.3048, 1000.0):
        others = list(levenberg_marquardt(in_other_units(graph, factor)))
        assert [each.damping for each in others] == [each.damping for each in steps]
        np.testing.assert_allclose([each.chi2 for each in others], [each.chi2 for each in steps], rtol=1e-6)
    assert max(each.damping for each in steps) > 0


def test_the_last_step_uses_the_factors_of_the_one_before():
    """One matrix fewer than there are steps; the end is as close to the minimum as with a matrix for every step."""
    graph = random_graph(1, start_noise=0.1)
    structure = linearization.graph_structure(graph)
    factorize, matrices = factorization.factorizer(structure), []

    def counted(data):
        matrices.append(None if data is None else id(data))
        return factorize(data)

    steps = list(levenberg_marquardt(graph, 1e-6, system=factorization.LinearSystem(structure, counted)))
    assert steps[-1].converged and matrices[-1] is None
    exact = list(levenberg_marquardt(steps[-1].graph, 1e-15))[-1]
    assert steps[-1].chi2 <= exact.chi2 * (1 + 1e-11)
    np.testing.assert_allclose(steps[-1].graph.poses, exact.graph.poses, atol=1e-6)


def test_a_last_step_that_brings_more_than_was_foreseen_is_not_the_last(monkeypatch):
    """Half of it is left: the solver goes on until nothing is."""
    graph = random_graph(1, start_noise=0.1)
    least = list(levenberg_marquardt(graph, 1e-13))[-1].chi2
    monkeypatch.setattr(MODULE, "_next_reduction", lambda previous, reduction: 0.0)
    steps = list(levenberg_marquardt(graph, 1e-9))
    assert steps[-1].converged and steps[-1].chi2 == pytest.approx(least, rel=1e-6)
