"""What a certificate claims, against solvers that search long: never too much, and enough to be of use."""

from dataclasses import replace

import numpy as np
import pytest
from graphs import random_graph

from npslam_teach import datasets, pose_graph, se2
from npslam_teach.pose_graph import certified_minimum, certify, chi2, levenberg_marquardt
from npslam_teach.pose_graph.certificate import _chordal_weight, _quadratic_below
from npslam_teach.pose_graph.complex_form import layout_of
from npslam_teach.pose_graph.linearization import residuals


def noisy_graph(seed, num_poses=8, std=0.4):
    """A short drive whose headings err by 20 degrees and more, so that wrong minima are common; any information."""
    rng = np.random.default_rng(seed)
    graph = random_graph(seed, num_poses=num_poses, num_landmarks=seed % 3, num_loops=6, noise=0.0, start_noise=0.0)
    measured = graph.between.relative_pose + rng.normal(0, std, graph.between.relative_pose.shape)
    between = replace(graph.between, relative_pose=np.column_stack([measured[:, :2], se2.wrap(measured[:, 2])]))
    seen = replace(graph.observations, xy=graph.observations.xy + rng.normal(0, std, graph.observations.xy.shape))
    return replace(graph, between=between, observations=seen)


def anywhere(graph, rng):
    """The same factors, and an estimate that knows nothing but what is fixed."""
    poses = np.column_stack([rng.normal(0, 4, (len(graph.poses), 2)), rng.uniform(-np.pi, np.pi, len(graph.poses))])
    poses[graph.fixed_poses] = graph.poses[graph.fixed_poses]
    return replace(graph, poses=poses, landmarks=rng.normal(0, 4, graph.landmarks.shape))


def quadratic(graph, at, where):
    """The quadratic below chi2 that touches it at one graph, at another, relative to chi2 at the first."""
    q = _quadratic_below(at, layout_of(at), residuals(at).by_kind)
    y, y_at = layout_of(where).y, layout_of(at).y
    return chi2(at) + (y.conj() @ (q @ y) - y_at.conj() @ (q @ y_at)).real


@pytest.mark.parametrize("seed", range(20))
def test_the_quadratic_touches_chi2_and_is_nowhere_above_it(seed):
    graph, rng = noisy_graph(seed), np.random.default_rng(seed)
    fixed = ((0,), ()), ((2, 5), ()), ((1,), (0,) if len(graph.landmarks) else ())
    for poses, landmarks in fixed:
        at = anywhere(replace(graph, fixed_poses=poses, fixed_landmarks=landmarks), rng)
        for _ in range(20):
            where = anywhere(at, rng)
            assert quadratic(graph, at, where) <= chi2(where) * (1 + 1e-9)
        dx = rng.normal(size=len(pose_graph.linearize(at)[1]))
        step = 1e-5
        rise = [
            (f(step) - f(-step)) / (2 * step)
            for f in (
                lambda s, at=at, dx=dx: chi2(pose_graph.retract(at, s * dx)),
                lambda s, at=at, dx=dx: quadratic(graph, at, pose_graph.retract(at, s * dx)),
            )
        ]
        assert rise[0] == pytest.approx(rise[1], rel=1e-4, abs=1e-3)


@pytest.mark.parametrize("seed", range(5))
def test_the_weight_of_a_heading_leaves_the_chordal_distance_below(seed):
    rng = np.random.default_rng(seed)
    weight, slope, error = rng.uniform(0, 2, 200), rng.normal(0, 2, 200), rng.uniform(-np.pi, np.pi, 200)
    k = _chordal_weight(weight, slope, error)
    u = np.linspace(-np.pi, np.pi, 5001) - error[:, None]
    above = weight[:, None] * u**2 + 2 * slope[:, None] * (u - np.sin(u)) - 2 * k[:, None] * (1 - np.cos(u))
    assert above.min() >= -1e-9


def lowest_of_many(graph, rng, num_starts):
    return min(list(levenberg_marquardt(anywhere(graph, rng), 1e-10))[-1].chi2 for _ in range(num_starts))


@pytest.mark.slow
def test_no_certified_minimum_has_a_lower_one_and_no_gap_is_too_small():
    certified = 0
    for seed in range(60):
        graph, rng = noisy_graph(seed), np.random.default_rng(seed)
        found = [certified_minimum(graph).certificate]
        found += [certify(list(levenberg_marquardt(anywhere(graph, rng)))[-1].graph) for _ in range(3)]
        lowest = min([lowest_of_many(graph, rng, 10), *(each.chi2 for each in found)])
        for each in found:
            assert each.chi2 - each.gap <= lowest * (1 + 1e-6) + 1e-9
            certified += each.status == "certified"
    assert certified > 60


def test_of_two_minima_the_higher_is_not_certified(cases_folder):
    graph = datasets.load_g2o(cases_folder / "wrong_minimum.g2o")
    *_, wrong = levenberg_marquardt(graph)
    assert wrong.converged and wrong.chi2 == pytest.approx(175.7355, abs=1e-3)
    assert certify(wrong.graph).status != "certified"
    best = certified_minimum(graph)
    assert best.certificate.chi2 == pytest.approx(15.889198, abs=1e-5)
    assert best.certificate.status == "certified" and str(best.certificate) == "certified"


@pytest.mark.parametrize("name", ["intel", "manhattan", "victoria_park"])
def test_standard_graphs_are_certified(data_folder, name):
    assert certify(pose_graph.optimize(datasets.load_g2o(data_folder / f"{name}.g2o"))).status == "certified"


def test_away_from_a_minimum_nothing_is_certified():
    graph = noisy_graph(0)
    certificate = certify(anywhere(graph, np.random.default_rng(0)))
    assert certificate.status != "certified"
    assert certificate.chi2 - certificate.gap <= chi2(pose_graph.optimize(graph))


def test_a_perfect_fit_is_certified():
    perfect = random_graph(0, noise=0.0, start_noise=0.0)
    assert certify(pose_graph.optimize(perfect)).status == "certified"


@pytest.mark.parametrize("seed", range(5))
def test_it_does_not_depend_on_where_the_map_lies(seed):
    solved = pose_graph.optimize(noisy_graph(seed))
    move = np.array([30.0, -20.0, 2.0])
    poses = se2.compose(move, solved.poses)
    moved = replace(solved, poses=poses, landmarks=se2.apply(move, solved.landmarks))
    first, second = certify(solved), certify(moved)
    assert first.status == second.status
    assert first.gap == pytest.approx(second.gap, rel=1e-3, abs=1e-6 * first.chi2)


@pytest.mark.parametrize("east", [1e3, 5e5])
def test_far_from_the_origin_the_proof_is_the_same(cases_folder, east):
    """As in a survey's coordinates: the same map, certified by the same numbers."""
    for graph in (datasets.load_g2o(cases_folder / "wrong_minimum.g2o"), noisy_graph(3, std=0.05)):
        away = np.array([east, 9 * east, 0.0])
        moved = replace(graph, poses=graph.poses + away, landmarks=graph.landmarks + away[:2])
        here, there = certified_minimum(graph), certified_minimum(moved)
        assert str(there.certificate) == str(here.certificate) == "certified"
        assert there.certificate.gap == pytest.approx(here.certificate.gap, rel=1e-4)


def test_measurements_of_bearing_alone_leave_it_open():
    """Positions that only differently directed strips fix have no isotropic weight: nothing is claimed."""
    graph = random_graph(0, num_landmarks=0)
    turns = np.linspace(0, 3, len(graph.between.i))
    strips = np.stack([np.cos(turns), np.sin(turns), np.zeros_like(turns)], axis=1)
    information = strips[:, :, None] * strips[:, None, :] + np.diag([0.0, 0.0, 1.0])
    certificate = certify(replace(graph, between=replace(graph.between, information=information)))
    assert certificate.status == "none" and certificate.gap == certificate.chi2


def test_in_words():
    assert str(pose_graph.Certificate(10.0, 1.25, -0.1)) == "gap <= 1.25"
    assert str(pose_graph.Certificate(10.0, 10.0, -9.0)) == "none"
