"""The solver against independent oracles: SciPy's least squares, dense algebra, hand-solved graphs and statistics."""

import warnings
from dataclasses import replace

import numpy as np
import pytest
import scipy.optimize
import scipy.stats
from graphs import quarrelling_graph, random_graph

from npslam_teach import datasets, evaluation, np_graph, pose_graph, se2, simulate
from npslam_teach.pose_graph import between_jacobians, factorization, levenberg_marquardt, linearization
from npslam_teach.types import BetweenFactors, ObservationFactors, PoseGraph

LIBRARIES = [
    "superlu",
    pytest.param("qdldl", marks=pytest.mark.skipif(not factorization.has_qdldl(), reason="no qdldl")),
]


def unpack(graph, x):
    poses = graph.poses.copy()
    split = 3 * (len(poses) - 1)
    poses[1:] = x[:split].reshape(-1, 3)
    return poses, x[split:].reshape(-1, 2)


def whitened_residuals(graph, x):
    """Written out factor by factor, from the definition, without any of the package's residual functions."""
    poses, landmarks = unpack(graph, x)
    out = []
    for i, j, o, information in zip(
        graph.between.i,
        graph.between.j,
        graph.between.relative_pose,
        graph.between.information,
        strict=True,
    ):
        c, s = np.cos(poses[i, 2]), np.sin(poses[i, 2])
        d = poses[j, :2] - poses[i, :2]
        turn = (poses[j, 2] - poses[i, 2] - o[2] + np.pi) % (2 * np.pi) - np.pi
        r = np.array([c * d[0] + s * d[1] - o[0], -s * d[0] + c * d[1] - o[1], turn])
        out.append(np.linalg.cholesky(information).T @ r)
    obs = graph.observations
    for p, k, z, information in zip(obs.pose, obs.landmark, obs.xy, obs.information, strict=True):
        c, s = np.cos(poses[p, 2]), np.sin(poses[p, 2])
        d = landmarks[k] - poses[p, :2]
        r = np.array([c * d[0] + s * d[1] - z[0], -s * d[0] + c * d[1] - z[1]])
        out.append(np.linalg.cholesky(information).T @ r)
    return np.concatenate(out)


def pack(graph):
    return np.concatenate([graph.poses[1:].ravel(), graph.landmarks.ravel()])


@pytest.mark.parametrize("seed", range(8))
def test_solver_agrees_with_scipy_least_squares(seed):
    graph = random_graph(seed, num_landmarks=seed % 5)
    oracle = scipy.optimize.least_squares(
        lambda x: whitened_residuals(graph, x), pack(graph), xtol=1e-15, ftol=1e-15, gtol=1e-15
    )
    *_, last = levenberg_marquardt.gauss_newton(graph, tolerance=1e-13)
    assert last.converged
    assert last.chi2 == pytest.approx(2 * oracle.cost, rel=1e-9)
    poses, landmarks = unpack(graph, oracle.x)
    np.testing.assert_allclose(last.graph.poses[:, :2], poses[:, :2], atol=1e-5)
    np.testing.assert_allclose(last.graph.landmarks, landmarks, atol=1e-5)


def test_chi2_is_the_sum_of_squared_whitened_residuals():
    graph = random_graph(11)
    assert levenberg_marquardt.chi2(graph) == pytest.approx(
        (whitened_residuals(graph, pack(graph)) ** 2).sum(), rel=1e-12
    )


@pytest.mark.parametrize("seed", range(3))
def test_normal_equations_are_j_transposed_j(seed):
    graph = random_graph(seed)
    x, step = pack(graph), 1e-6
    jacobian = np.column_stack(
        [
            (whitened_residuals(graph, x + step * e) - whitened_residuals(graph, x - step * e)) / (2 * step)
            for e in np.eye(len(x))
        ]
    )
    h, b, chi2 = levenberg_marquardt.linearize(graph)
    r = whitened_residuals(graph, pack(graph))
    np.testing.assert_allclose(h.toarray(), jacobian.T @ jacobian, rtol=1e-7, atol=1e-6)
    np.testing.assert_allclose(b, jacobian.T @ r, atol=1e-6)
    assert chi2 == pytest.approx(r @ r, rel=1e-12)
    np.testing.assert_allclose(h.toarray(), h.toarray().T, rtol=0, atol=1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_with_the_curvature_h_is_the_slope_of_b(seed):
    """Gauss-Newton's H is not: it leaves out that the residuals themselves are curved."""
    graph = random_graph(seed, noise=1.0)
    structure, at = linearization.graph_structure(graph), linearization.residuals(graph)
    data, _ = linearization.normal_equations(graph, structure, at)
    curved = structure.matrix(data + linearization.second_order_term(graph, structure, at)).toarray()
    x, step, slope = pack(graph), 1e-5, []
    for e in np.eye(len(x)):
        ends = [unpack(graph, x + sign * step * e) for sign in (1, -1)]
        above, below = (levenberg_marquardt.linearize(replace(graph, poses=p, landmarks=m))[1] for p, m in ends)
        slope.append((above - below) / (2 * step))
    np.testing.assert_allclose(curved, slope, rtol=1e-6, atol=1e-5)
    assert np.abs(structure.matrix(data).toarray() - slope).max() > 1.0


def test_where_gauss_newton_creeps_newton_arrives(monkeypatch):
    """Loop closures that contradict the wheels by metres: the residuals stay large, and and count."""
    graphs = [quarrelling_graph(seed) for seed in range(8)]
    quick = [list(levenberg_marquardt.gauss_newton(graph))[-1] for graph in graphs]
    monkeypatch.setattr(levenberg_marquardt, "CREEPING", np.inf)
    plain = [list(levenberg_marquardt.gauss_newton(graph))[-1] for graph in graphs]
    assert sum(step.iteration for step in quick) < 0.5 * sum(step.iteration for step in plain)
    for graph, ours, creeping in zip(graphs, quick, plain, strict=True):
        assert ours.converged
        assert ours.chi2 <= creeping.chi2 * (1 + 1e-9)
        oracle = scipy.optimize.least_squares(
            lambda x, graph=graph: whitened_residuals(graph, x), pack(ours.graph), xtol=1e-15, ftol=1e-15, gtol=1e-15
        )
        assert ours.chi2 == pytest.approx(2 * oracle.cost, rel=1e-6)


def three_pose_graph():
    """A robot drives 1 m, 1 m, and then recognises that it stands 1.8 m from where it began; headings are known.

    All weights are 1. With x1, x2 free the cost is (x1-1)^2 + (x2-x1-1)^2 + (x2-1.8)^2. Setting both derivatives to
    zero gives 2 x1 = x2 and x2 - x1 - 1 + x2 - 1.8 = 0, so x2 = 28/15, x1 = 14/15 and every residual is 1/15 in size.
    """
    steps = np.array([[1.0, 0, 0], [1.0, 0, 0], [1.8, 0, 0]])
    factors = BetweenFactors([0, 1, 0], [1, 2, 2], steps, np.tile(np.eye(3), (3, 1, 1)))
    return PoseGraph(
        np.zeros((3, 3)), np.zeros((0, 2)), factors, ObservationFactors([], [], np.zeros((0, 2)), np.zeros((0, 2, 2)))
    )


def test_three_poses_solved_by_hand():
    *_, last = levenberg_marquardt.gauss_newton(three_pose_graph())
    np.testing.assert_allclose(last.graph.poses, [[0, 0, 0], [14 / 15, 0, 0], [28 / 15, 0, 0]], atol=1e-12)
    assert last.chi2 == pytest.approx(3 / 15**2, rel=1e-12)


def test_covariance_of_three_poses_by_hand():
    """In x alone H is [[2, -1], [-1, 2]], whose inverse is [[2, 1], [1, 2]] / 3."""
    solved = levenberg_marquardt.optimize(three_pose_graph())
    pose_cov, _ = levenberg_marquardt.marginal_covariance(solved, poses=[0, 1, 2])
    np.testing.assert_array_equal(pose_cov[0], np.zeros((3, 3)))
    assert pose_cov[1, 0, 0] == pytest.approx(2 / 3)
    assert pose_cov[2, 0, 0] == pytest.approx(2 / 3)


@pytest.mark.parametrize("seed", range(3))
def test_marginal_covariance_is_the_inverse_of_h(seed):
    solved = levenberg_marquardt.optimize(random_graph(seed))
    h, _, _ = levenberg_marquardt.linearize(solved)
    inverse = np.linalg.inv(h.toarray())
    pose_cov, landmark_cov = levenberg_marquardt.marginal_covariance(solved, poses=[5, 0, 2], landmarks=[3, 1])
    np.testing.assert_allclose(pose_cov[0], inverse[12:15, 12:15], rtol=1e-8, atol=1e-12)
    np.testing.assert_array_equal(pose_cov[1], 0)
    np.testing.assert_allclose(pose_cov[2], inverse[3:6, 3:6], rtol=1e-8, atol=1e-12)
    first = 3 * (len(solved.poses) - 1)
    np.testing.assert_allclose(landmark_cov[0], inverse[first + 6 : first + 8, first + 6 : first + 8], rtol=1e-8)
    np.testing.assert_allclose(landmark_cov[1], inverse[first + 2 : first + 4, first + 2 : first + 4], rtol=1e-8)


@pytest.mark.parametrize("wrong", [{"poses": [-1]}, {"poses": [99]}, {"landmarks": [-1]}, {"landmarks": [1.7]}])
def test_covariances_of_what_does_not_exist_are_refused(wrong):
    solved = levenberg_marquardt.optimize(random_graph(0))
    with pytest.raises(ValueError, match=f"{next(iter(wrong))}: expected"):
        levenberg_marquardt.marginal_covariance(solved, **wrong)


def test_headings_of_many_turns_do_not_swallow_the_steps():
    graph = random_graph(8)
    turned = replace(graph, poses=graph.poses + [0.0, 0.0, 2 * np.pi * 1e6])
    *_, last = levenberg_marquardt.gauss_newton(turned)
    assert last.chi2 == pytest.approx(levenberg_marquardt.chi2(levenberg_marquardt.optimize(graph)), rel=1e-6)
    assert np.abs(last.graph.poses[:, 2]).max() <= np.pi


def test_numbers_beyond_floating_point_are_refused():
    with pytest.raises(ValueError, match="poses: expected numbers up to 1e[+]15"):
        replace(random_graph(0), poses=np.full((12, 3), 1e200))


def test_a_singular_graph_is_refused_with_words():
    graph = random_graph(0, num_landmarks=0, num_loops=0)
    nothing = replace(graph.between, information=np.zeros_like(graph.between.information))
    with pytest.raises(np.linalg.LinAlgError, match="H is singular"):
        levenberg_marquardt.optimize(replace(graph, between=nothing))


def test_pose_zero_is_the_gauge():
    graph = random_graph(1)
    np.testing.assert_array_equal(levenberg_marquardt.optimize(graph).poses[0], graph.poses[0])


@pytest.mark.parametrize("seed", range(3))
def test_moving_the_world_moves_the_answer(seed):
    graph, motion = random_graph(seed), np.array([10.0, -4.0, 2.2])
    moved = replace(graph, poses=se2.compose(motion, graph.poses), landmarks=se2.apply(motion, graph.landmarks))
    a, b = levenberg_marquardt.optimize(graph, 1e-14), levenberg_marquardt.optimize(moved, 1e-14)
    assert levenberg_marquardt.chi2(b) == pytest.approx(levenberg_marquardt.chi2(a), rel=1e-9)
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
    first, second = levenberg_marquardt.optimize(graph, 1e-14), levenberg_marquardt.optimize(shuffled, 1e-14)
    assert levenberg_marquardt.chi2(second) == pytest.approx(levenberg_marquardt.chi2(first), rel=1e-9)
    np.testing.assert_allclose(second.poses[name], first.poses, atol=1e-6)
    np.testing.assert_allclose(second.landmarks[name_l], first.landmarks, atol=1e-6)


@pytest.mark.parametrize("seed", range(20))
def test_chi2_never_rises_even_from_a_wild_start(seed):
    graph = random_graph(seed, start_noise=3.0)
    values = [step.chi2 for step in levenberg_marquardt.gauss_newton(graph)]
    assert all(after <= before for before, after in zip(values, values[1:], strict=False))


def test_a_wild_start_needs_damping_and_gets_it():
    steps = [s for seed in range(20) for s in levenberg_marquardt.gauss_newton(random_graph(seed, start_noise=3.0))]
    assert any(step.damping > 0 for step in steps)


def test_not_converged_is_said():
    graph = random_graph(3, start_noise=1.0)
    *_, last = levenberg_marquardt.gauss_newton(graph, max_iterations=1)
    assert not last.converged
    assert last.status == "iteration limit"
    with pytest.warns(UserWarning, match="stopped after 1 iterations: iteration limit"):
        levenberg_marquardt.optimize(graph, max_iterations=1)


def test_a_perfect_start_is_converged_at_once():
    graph = random_graph(4, noise=0.0, start_noise=0.0)
    *_, last = levenberg_marquardt.gauss_newton(graph)
    assert last.converged
    assert last.iteration == 1
    assert last.chi2 < 1e-20


def test_a_landmark_that_nobody_sees_is_named():
    graph = random_graph(5)
    lonely = replace(graph, landmarks=np.vstack([graph.landmarks, [[9.0, 9.0]]]))
    with pytest.raises(np.linalg.LinAlgError, match="landmark 4 is not tied to pose 0"):
        levenberg_marquardt.optimize(lonely)


def test_a_pose_cut_off_from_the_rest_is_named():
    graph = random_graph(5, num_landmarks=0, num_loops=0)
    keep = np.arange(len(graph.between.i)) != 6
    b = graph.between
    cut = replace(graph, between=BetweenFactors(b.i[keep], b.j[keep], b.relative_pose[keep], b.information[keep]))
    with pytest.raises(np.linalg.LinAlgError, match="pose 7 is not tied to pose 0"):
        levenberg_marquardt.optimize(cut)


def chain_and_a_loose_pose(seed, num_poses=12):
    """A chain whose last pose is tied to the rest by nothing but one object: it can circle around it."""
    graph = random_graph(seed, num_poses, num_landmarks=2)
    between, sightings = graph.between, graph.observations
    last = num_poses - 1
    kept = (between.i != last) & (between.j != last)
    seen = (sightings.pose != last) | (sightings.landmark == 0)
    return PoseGraph(
        graph.poses,
        graph.landmarks,
        BetweenFactors(*(getattr(between, name)[kept] for name in ("i", "j", "relative_pose", "information"))),
        ObservationFactors(*(getattr(sightings, name)[seen] for name in ("pose", "landmark", "xy", "information"))),
    )


@pytest.mark.parametrize("library", LIBRARIES)
@pytest.mark.parametrize("num_poses", [12, 2000])
def test_a_pose_that_can_circle_around_an_object_is_named(num_poses, library):
    graph = chain_and_a_loose_pose(3, num_poses)
    with pytest.raises(np.linalg.LinAlgError, match=f"pose {num_poses - 1} can move .* H is singular"):
        list(levenberg_marquardt.gauss_newton(graph, library=library))


def test_a_landmark_seen_in_one_direction_only_is_named():
    graph = random_graph(6, num_landmarks=3)
    information = graph.observations.information.copy()
    information[graph.observations.landmark == 1] = 0.0
    information[np.flatnonzero(graph.observations.landmark == 1)[0]] = [[4.0, 2.0], [2.0, 1.0]]
    blind = replace(graph, observations=replace(graph.observations, information=information))
    with pytest.raises(np.linalg.LinAlgError, match="landmark 1 can move"):
        levenberg_marquardt.optimize(blind)
    with pytest.raises(np.linalg.LinAlgError, match="landmark 1 can move"):
        levenberg_marquardt.marginal_covariance(blind, landmarks=[0])


@pytest.mark.parametrize("library", LIBRARIES)
def test_a_long_open_chain_is_uncertain_but_not_singular(library):
    """Its far end is known a hundred million times worse than a single step: no reason to refuse it."""
    num_poses = 30_000
    steps = np.tile([1.0, 0.0, 0.0], (num_poses - 1, 1))
    i = np.arange(num_poses - 1)
    factors = BetweenFactors(i, i + 1, steps, np.tile(np.diag([1e4, 1e4, 1e4]), (num_poses - 1, 1, 1)))
    nothing = ObservationFactors([], [], np.zeros((0, 2)), np.zeros((0, 2, 2)))
    start = se2.dead_reckoning(steps) + np.random.default_rng(0).normal(0, 1e-3, (num_poses, 3))
    start[0] = 0.0
    *_, last = levenberg_marquardt.gauss_newton(PoseGraph(start, np.zeros((0, 2)), factors, nothing), library=library)
    assert last.converged
    assert last.chi2 < 1e-3


def test_a_long_drive_that_has_to_bend_does_so_in_a_few_steps():
    """A first association over ten rooms: each full step overshoots, and damped ones would creep for hundreds."""
    log, _ = simulate.grid_of_rooms(10)
    start, first = np_graph(log, iterations=1)
    landmarks = [start.graph.landmarks[first.labels == k].mean(axis=0) for k in range(first.num_objects)]
    *_, last = levenberg_marquardt.gauss_newton(replace(first.graph, poses=start.graph.poses, landmarks=landmarks))
    assert last.converged
    assert last.iteration <= 20
    assert last.chi2 == pytest.approx(first.chi2, rel=1e-6)


def test_a_wrong_derivative_ends_with_a_reason(monkeypatch):
    """Uphill whatever the damping: not converged, and nothing has moved."""
    right = pose_graph.observation_jacobians
    monkeypatch.setattr(linearization, "between_jacobians", lambda *poses: tuple(-j for j in between_jacobians(*poses)))
    monkeypatch.setattr(linearization, "observation_jacobians", lambda *ends: tuple(-j for j in right(*ends)))
    steps = list(levenberg_marquardt.gauss_newton(random_graph(4)))
    assert (steps[-1].converged, steps[-1].status) == (False, "no step lowers chi2")
    np.testing.assert_array_equal(steps[-1].graph.poses, steps[0].graph.poses)


def test_a_matrix_that_turns_singular_on_the_way_is_damped(monkeypatch):
    """Rounding may take the last digit of a pivot in one iteration of many; the next bit of damping gives it back."""
    graph, calls, factorizer = random_graph(4), [], factorization.factorizer

    def failing_once(structure, library):
        solver = factorizer(structure, library)

        def factorized(data):
            calls.append(len(calls))
            if len(calls) == 4:
                raise np.linalg.LinAlgError(factorization.SINGULAR)
            return solver(data)

        return factorized

    monkeypatch.setattr(levenberg_marquardt, "factorizer", failing_once)
    steps = list(levenberg_marquardt.gauss_newton(graph))
    assert len(calls) > 4 and max(step.damping for step in steps) > 0
    assert steps[-1].converged
    monkeypatch.undo()
    assert steps[-1].chi2 == pytest.approx(levenberg_marquardt.chi2(levenberg_marquardt.optimize(graph)), rel=1e-8)


def test_a_solver_that_stops_early_says_why():
    *_, last = levenberg_marquardt.gauss_newton(random_graph(4), max_iterations=1)
    assert (last.converged, last.status) == (False, "iteration limit")


@pytest.mark.skipif(not factorization.has_qdldl(), reason="qdldl is not installed")
@pytest.mark.parametrize("seed", range(5))
def test_both_libraries_give_the_same_solution(seed):
    solutions = [
        list(levenberg_marquardt.gauss_newton(random_graph(seed), library=name))[-1] for name in ("qdldl", "superlu")
    ]
    assert solutions[0].chi2 == pytest.approx(solutions[1].chi2, rel=1e-12)
    np.testing.assert_allclose(solutions[0].graph.poses, solutions[1].graph.poses, atol=1e-9)
    np.testing.assert_allclose(solutions[0].graph.landmarks, solutions[1].graph.landmarks, atol=1e-9)


def test_a_single_pose_has_nothing_to_solve():
    empty = BetweenFactors([], [], np.zeros((0, 3)), np.zeros((0, 3, 3)))
    sightings = ObservationFactors([0, 0], [0, 0], [[1.0, 0.0], [3.0, 0.0]], np.tile(np.eye(2), (2, 1, 1)))
    solved = levenberg_marquardt.optimize(PoseGraph(np.zeros((1, 3)), np.zeros((1, 2)), empty, sightings))
    np.testing.assert_allclose(solved.landmarks, [[2.0, 0.0]])


def test_a_graph_without_unknowns():
    empty = BetweenFactors([], [], np.zeros((0, 3)), np.zeros((0, 3, 3)))
    nothing = ObservationFactors([], [], np.zeros((0, 2)), np.zeros((0, 2, 2)))
    *_, last = levenberg_marquardt.gauss_newton(PoseGraph(np.zeros((1, 3)), np.zeros((0, 2)), empty, nothing))
    assert last.converged
    assert last.chi2 == 0.0


def test_the_graph_that_comes_in_is_left_alone():
    graph = random_graph(6)
    poses, landmarks = graph.poses.copy(), graph.landmarks.copy()
    levenberg_marquardt.optimize(graph)
    np.testing.assert_array_equal(graph.poses, poses)
    np.testing.assert_array_equal(graph.landmarks, landmarks)
    with pytest.raises(ValueError, match="read-only"):
        graph.poses[0, 0] = 1.0


def test_the_same_graph_gives_the_same_bits():
    a, b = levenberg_marquardt.optimize(random_graph(7)), levenberg_marquardt.optimize(random_graph(7))
    assert a.poses.tobytes() == b.poses.tobytes()


@pytest.mark.parametrize(
    ("name", "expected"), [("intel", 45.004696), ("manhattan", 3549.0368), ("victoria_park", 6184.1206)]
)
def test_standard_graphs_reach_the_published_minimum(data_folder, name, expected):
    graph = datasets.load_g2o(data_folder / f"{name}.g2o")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert levenberg_marquardt.chi2(levenberg_marquardt.optimize(graph)) == pytest.approx(expected, rel=2e-8)


def test_estimates_are_as_uncertain_as_they_say():
    """NEES over seeds: the squared error in units of the marginal covariance has its number of entries as mean."""
    pose_nees, landmark_nees, chi2_values = [], [], []
    for seed in range(30):
        log, truth = simulate.fifteen_objects(seed)
        origin = truth.poses[0]
        solved = evaluation.true_association_fit(log, truth)
        seen = np.unique(truth.obs_object)
        chosen = [200, 500, len(truth.poses) - 1]
        pose_cov, landmark_cov = levenberg_marquardt.marginal_covariance(solved, chosen, np.arange(len(seen)))
        # The fit starts at the true first pose, so both live in the same frame.
        np.testing.assert_allclose(solved.poses[0], origin)
        error = solved.poses[chosen] - truth.poses[chosen]
        error[:, 2] = se2.wrap(error[:, 2])
        pose_nees.append([e @ np.linalg.solve(c, e) for e, c in zip(error, pose_cov, strict=True)])
        error = solved.landmarks - truth.world.object_xy[seen]
        landmark_nees.append(np.mean([e @ np.linalg.solve(c, e) for e, c in zip(error, landmark_cov, strict=True)]))
        chi2_values.append(evaluation.chi2_per_dof(solved))
    # Each pose's sum over independent seeds is chi-squared; three poses are tested, so 99.9% each.
    for total in np.sum(pose_nees, axis=0):
        low, high = scipy.stats.chi2.interval(0.999, 3 * 30)
        assert low < total < high
    assert np.mean(landmark_nees) == pytest.approx(2.0, abs=0.5)
    assert np.mean(chi2_values) == pytest.approx(1.0, abs=0.02)
