"""Lesson 03: its pictures, its explorer, its checks and its figure files."""

from dataclasses import replace

import numpy as np
import pytest
from graphs import random_graph
from matplotlib.collections import LineCollection
from matplotlib.patches import Ellipse
from readable import assert_readable

from npslam_teach import plotting, pose_graph, se2, simulate
from npslam_teach.course.pose_graph import checks, figures, pictures
from npslam_teach.course.pose_graph import explorer as pose_graph_explorer
from npslam_teach.course.pose_graph import springs as springs_explorer
from npslam_teach.evaluation import true_association_fit
from npslam_teach.plotting import factor_graph, uncertainty
from npslam_teach.pose_graph import chi2, gauss_newton, levenberg_marquardt, linearize

TOY_CLASSES = simulate.TOY_CLASSES


@pytest.fixture
def ax():
    return plotting.new_figure()[1]


@pytest.fixture(scope="module")
def toy():
    return true_association_fit(*simulate.toy_objects())


# The checks


def test_the_library_passes_too():
    assert checks.check_observation_residual(pose_graph.observation_residual).passed
    assert checks.check_observation_jacobian(lambda *a: pose_graph.observation_jacobians(*a)[0]).passed
    assert checks.check_between_residual(pose_graph.between_residual).passed


def seen(pose, landmark):
    return se2.apply_inverse(pose, landmark)


@pytest.mark.parametrize(
    "student, message",
    [
        (lambda x, m, z: z - seen(x, m), "sign is turned round"),
        (lambda x, m, z: seen(x, m), "has not been subtracted"),
        (lambda x, m, z: m - x[:2] - z, "room's frame"),
        (lambda x, m, z: se2.rotate(x[2], m - x[:2]) - z, "turned by +theta"),
        (lambda x, m, z: se2.rotate(-x[2], m) - z, "own position is missing"),
        (lambda x, m, z: m - se2.apply(x, z), "residual in the room"),
        (lambda x, m, z: seen(x, m) - z + [0, 1e-3], "entry 1 is off by 0.001"),
    ],
)
def test_exercise_1_names_the_mistake(student, message):
    assert message in checks.check_observation_residual(student).message


def jacobian(pose, landmark):
    return pose_graph.observation_jacobians(pose, landmark)[0]


def untransposed(pose, landmark):
    wrong = jacobian(pose, landmark)
    wrong[:, :2] = wrong[:, :2].T
    return wrong


def third_column_of_the_room(pose, landmark):
    wrong = jacobian(pose, landmark)
    wrong[:, 2] = [landmark[1] - pose[1], pose[0] - landmark[0]]
    return wrong


@pytest.mark.parametrize(
    "student, message",
    [
        (lambda *a: jacobian(*a) * [1, 1, -1], "third column has the wrong sign"),
        (lambda *a: jacobian(*a) * [-1, -1, 1], "first two columns have the wrong sign"),
        (lambda *a: -jacobian(*a), "every sign"),
        (untransposed, "R transposed"),
        (third_column_of_the_room, "third column is in the room's frame"),
        (lambda *a: jacobian(*a) * [1, 1, 0], "third column is zero"),
        (lambda *a: jacobian(*a).T, "shape (2, 3), yours has (3, 2)"),
        (lambda *a: jacobian(*a) * [1, 1.1, 1], "column 1"),
    ],
)
def test_exercise_2_names_the_mistake(student, message):
    assert message in checks.check_observation_jacobian(student).message


def between(pose_i, pose_j, measured, heading=None, wrapped=se2.wrap):
    heading = -pose_i[2] if heading is None else heading
    xy = se2.rotate(heading, pose_j[:2] - pose_i[:2]) - measured[:2]
    return np.append(xy, wrapped(pose_j[2] - pose_i[2] - measured[2]))


@pytest.mark.parametrize(
    "student, message",
    [
        (lambda i, j, o: between(i, j, o, wrapped=lambda angle: angle), "not wrapped"),
        (
            lambda i, j, o: np.append(between(i, j, o)[:2], se2.wrap(j[2] - i[2]) - o[2]),
            "wrapped before the subtraction",
        ),
        (lambda i, j, o: -between(i, j, o), "sign is turned round"),
        (lambda i, j, o: between(i, j, o, heading=0.0), "still in the room's frame"),
        (lambda i, j, o: between(i, j, o, heading=i[2]), "turned by +theta_i"),
        (lambda i, j, o: between(i, j, o, heading=-j[2]), "pose j's heading"),
        (
            lambda i, j, o: np.append(between(i, np.append(2 * i[:2] - j[:2], j[2]), o)[:2], between(i, j, o)[2]),
            "swapped",
        ),
    ],
)
def test_exercise_3_names_the_mistake(student, message):
    assert message in checks.check_between_residual(student).message


def held(H, b, keep=slice(3, None), sign=-1):
    dx = np.zeros(len(b))
    dx[keep] = sign * np.linalg.solve(H[keep, keep], b[keep])
    return dx


@pytest.mark.parametrize(
    "student, message",
    [
        (lambda H, b: held(H, b, sign=1), "this step climbs"),
        (lambda H, b: np.linalg.solve(H + np.eye(len(b)), -b), "added the identity"),
        (lambda H, b: -np.linalg.pinv(H, rcond=1e-9) @ b, "moves pose 0"),
        (lambda H, b: held(H, b, slice(0, -3)), "last three unknowns"),
        (lambda H, b: -b / np.diag(H), "only the diagonal"),
        (lambda H, b: np.linalg.solve(H[3:, 3:], -b[3:]), "three zeros in front"),
        (lambda H, b: np.linalg.solve(0 * H, -b), "H alone has no inverse"),
        (lambda H, b: np.linalg.solve(H, -b), "H alone has no inverse"),
    ],
)
def test_exercise_4_names_the_mistake(student, message):
    assert message in checks.check_gauss_newton_step(student).message


def test_exercise_4_accepts_any_way_to_hold_pose_0():
    """With the identity added to the block of pose 0 the step is the same: it does not move pose 0."""

    def with_a_prior(H, b):
        H = H.copy()
        H[:3, :3] += np.eye(3)
        return np.linalg.solve(H, -b)

    assert checks.check_gauss_newton_step(with_a_prior).passed


def place(num_poses, k, late=0):
    first = 3 * (num_poses - 1) + 2 * k + late
    return slice(first, first + 2)


@pytest.mark.parametrize(
    "student, message",
    [
        (lambda H, T, k: H[place(T, k), place(T, k)], "a block of H"),
        (lambda H, T, k: np.linalg.inv(H[place(T, k), place(T, k)]), "inverted the block alone"),
        (lambda H, T, k: np.linalg.inv(H)[place(T, k, 3), place(T, k, 3)], "three places too late"),
        (lambda H, T, k: np.linalg.inv(H)[2 * k : 2 * k + 2, 2 * k : 2 * k + 2], "a piece of a pose"),
        (lambda H, T, k: np.sqrt(np.abs(np.linalg.inv(H)[place(T, k), place(T, k)])), "square roots"),
        (lambda H, T, k: np.linalg.inv(H), "should have shape (2, 2)"),
    ],
)
def test_exercise_5_names_the_mistake(student, message):
    assert message in checks.check_landmark_covariance(student).message


# The pictures


def test_segments_join_what_the_factors_join():
    graph = random_graph(3)
    steps, sightings = factor_graph.odometry_segments(graph), factor_graph.observation_segments(graph)
    k = 5
    np.testing.assert_array_equal(steps[k], graph.poses[[graph.between.i[k], graph.between.j[k]], :2])
    np.testing.assert_array_equal(sightings[k][0], graph.poses[graph.observations.pose[k], :2])
    np.testing.assert_array_equal(sightings[k][1], graph.landmarks[graph.observations.landmark[k]])


def test_a_pull_is_as_long_as_its_residual():
    graph = random_graph(4)
    observations = graph.observations
    pulls = factor_graph.residual_segments(graph)
    expected = pose_graph.observation_residual(
        graph.poses[observations.pose], graph.landmarks[observations.landmark], observations.xy
    )
    lengths = np.linalg.norm(pulls[:, 1] - pulls[:, 0], axis=1)
    np.testing.assert_allclose(lengths, np.linalg.norm(expected, axis=1))


def test_factor_graph_shows_every_factor_and_names_every_pose(ax, toy):
    factor_graph.plot_factor_graph(ax, toy, [0, 0, 1, 2], TOY_CLASSES, "toy")
    collections = [c for c in ax.collections if isinstance(c, LineCollection)]
    assert [len(c.get_segments()) for c in collections] == [5, 7, 7, 6]
    assert [text.get_text() for text in ax.texts] == list("012345")
    assert (ax.get_xlabel(), ax.get_ylabel(), ax.get_title()) == ("x (m)", "y (m)", "toy")
    assert ax.get_aspect() == 1.0


def brute_force_fill(pattern):
    """Dense elimination: taking out a variable joins all its neighbours."""
    filled = pattern.copy()
    for k in range(len(filled)):
        later = [i for i in range(k + 1, len(filled)) if filled[i, k]]
        filled[np.ix_(later, later)] = True
    return np.tril(filled)


@pytest.mark.parametrize("seed", range(6))
def test_factor_pattern_is_that_of_an_elimination(seed):
    from scipy.sparse import csc_array

    rng = np.random.default_rng(seed)
    pattern = rng.random((25, 25)) < 0.08
    pattern |= pattern.T | np.eye(25, dtype=bool)
    factor = pose_graph.factor_pattern(csc_array(pattern.astype(float)))
    np.testing.assert_array_equal(factor.toarray() > 0, brute_force_fill(pattern))


def test_factor_pattern_holds_the_numbers_of_cholesky():
    H = linearize(random_graph(8))[0]
    factor = np.linalg.cholesky(H.toarray())
    assert not factor[pose_graph.factor_pattern(H).toarray() == 0].any()


def test_three_orders_are_the_same_matrix():
    graph = random_graph(2, num_poses=5, num_landmarks=3)
    H = linearize(graph)[0].toarray()
    matrices = pose_graph.in_three_orders(graph)
    np.testing.assert_array_equal(matrices["poses first"].toarray(), H)
    np.testing.assert_array_equal(matrices["objects first"].toarray()[:6, :6], H[-6:, -6:])
    for matrix in matrices.values():
        np.testing.assert_allclose(np.linalg.eigvalsh(matrix.toarray()), np.linalg.eigvalsh(H))


def test_the_fifteen_objects_fill_as_the_lesson_says():
    """Numbers of the pattern alone; that of the fill-reducing order depends on SuperLU's ties."""
    matrices = pose_graph.in_three_orders(true_association_fit(*simulate.fifteen_objects()))
    counts = {name: pose_graph.factor_pattern(matrix).nnz for name, matrix in matrices.items()}
    assert counts["objects first"] > 20 * counts["poses first"]
    assert counts["poses first"] > 2 * counts["reordered"]


def test_sparsity_picture_shows_numbers_and_fill(ax):
    from scipy.sparse import csc_array

    # An arrow that points the wrong way: the first variable is tied to all, and its removal fills everything.
    arrow = np.eye(6)
    arrow[0] = arrow[:, 0] = 1.0
    pictures.plot_sparsity(ax, csc_array(arrow), "arrow")
    picture = np.asarray(ax.images[0].get_array())
    np.testing.assert_array_equal(picture == 2, arrow > 0)
    np.testing.assert_array_equal(picture == 1, np.tril(np.ones((6, 6)) - (arrow > 0)) > 0)
    assert ax.get_title() == "arrow\n$H$ 16, factor 21 numbers"
    assert ax.get_xlabel() == ax.get_ylabel() == "unknown (index)"


def test_ellipses_hold_95_percent():
    rng = np.random.default_rng(0)
    cov = np.array([[0.5, 0.3], [0.3, 0.4]])
    patch = uncertainty.ellipse(np.array([1.0, -2.0]), cov)
    points = rng.multivariate_normal([1.0, -2.0], cov, 20_000)
    inside = np.linalg.norm(patch.get_patch_transform().inverted().transform(points), axis=1) < 1
    assert inside.mean() == pytest.approx(0.95, abs=0.005)


def test_uncertainty_draws_an_ellipse_for_everything(toy):
    figure = uncertainty.uncertainty_figure({"one": (toy, [0, 0, 1, 2]), "two": (toy, [0, 0, 1, 2])}, TOY_CLASSES)
    for ax, title in zip(figure.axes, ("one", "two"), strict=True):
        assert sum(isinstance(patch, Ellipse) for patch in ax.patches) == 6 + 4
        assert (ax.get_title(), ax.get_xlabel(), ax.get_aspect()) == (title, "x (m)", 1.0)
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels == ["pose", "95 % ellipse", *TOY_CLASSES]


def all_figures(toy):
    yield from (entry.draw() for entry in figures.FIGURES)
    yield factor_graph.factor_graph_figure(toy, "chair")
    yield uncertainty.uncertainty_figure({"before": (toy, [0, 0, 1, 2]), "after": (toy, [0, 0, 1, 2])}, TOY_CLASSES)
    yield pose_graph_explorer.explore_gauss_newton({"wheels": toy}).figure


def test_text_is_inside_the_figure_large_enough_and_apart(toy):
    for figure in all_figures(toy):
        assert_readable(figure)


def test_figure_files_have_names_and_texts():
    assert [entry.name for entry in figures.FIGURES] == ["fig12a_factor_graph_solved", "fig12b_sparsity"]
    assert all(len(entry.alt) > 60 for entry in figures.FIGURES)


def test_figure_12_falls_to_the_minimum():
    before, after = figures.toy_before_and_after()
    *_, last = levenberg_marquardt(before)
    assert chi2(before) > 20 * chi2(after)
    assert chi2(after) == pytest.approx(last.chi2)


# The explorer


@pytest.fixture(scope="module")
def starts():
    return pose_graph_explorer.bad_starts()


@pytest.fixture(scope="module")
def explorer(starts):
    graphs, truth = starts
    return pose_graph_explorer.explore_gauss_newton(graphs, truth.poses[:, :2])


def test_both_bad_starts_end_at_the_same_minimum(starts):
    last = [list(levenberg_marquardt(graph))[-1] for graph in starts[0].values()]
    assert all(step.converged for step in last)
    assert last[0].chi2 == pytest.approx(last[1].chi2)
    assert starts[0]["thrown about"].poses[0].tolist() == starts[0]["wheels"].poses[0].tolist()


@pytest.mark.parametrize("name", ["wheels", "thrown about"])
def test_the_explorer_shows_what_the_solver_did(explorer, starts, name):
    run = list(levenberg_marquardt(starts[0][name]))
    left, right = explorer.figure.axes
    sightings, steps = (c for c in left.collections if isinstance(c, LineCollection))
    for k, step in enumerate(run):
        words = explorer.move(start=name, iteration=k)
        assert words.startswith(f"Iteration {k}")
        assert f"{step.chi2:.0f}" in words
        assert ("damped" in words) == (step.damping > 0)
        assert ("last one" in words) == (k == len(run) - 1)
        np.testing.assert_array_equal(steps.get_segments(), factor_graph.odometry_segments(step.graph))
        np.testing.assert_array_equal(sightings.get_segments(), factor_graph.observation_segments(step.graph))
        np.testing.assert_array_equal(np.transpose(left.lines[0].get_data()), step.graph.landmarks)
        assert right.lines[1].get_data()[0] == [k]
        assert right.lines[1].get_data()[1] == [step.chi2]


def test_the_explorer_stays_at_the_end_of_a_shorter_run(explorer):
    high = explorer.sliders["iteration"].max
    assert "last one" in explorer.move(start="wheels", iteration=high)
    assert "last one" in explorer.move(start="thrown about", iteration=high)


def test_the_window_of_the_explorer_holds_everything(explorer, starts):
    left = explorer.figure.axes[0]
    for graph in starts[0].values():
        for step in levenberg_marquardt(graph):
            points = np.vstack([step.graph.poses[:, :2], step.graph.landmarks])
            assert (points > [left.get_xlim()[0], left.get_ylim()[0]]).all()
            assert (points < [left.get_xlim()[1], left.get_ylim()[1]]).all()


def test_an_error_in_the_explorer_is_raised(toy, monkeypatch):
    explorer = pose_graph_explorer.explore_gauss_newton({"wheels": toy})
    monkeypatch.setattr(pose_graph_explorer, "words", lambda run, iteration: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        explorer.refresh()
    assert "ZeroDivisionError" in explorer.shown["error"]


def test_words_name_the_largest_move(toy):
    run = list(levenberg_marquardt(figures.toy_before_and_after()[0]))
    moved = np.linalg.norm(run[1].graph.poses[:, :2] - run[0].graph.poses[:, :2], axis=1).max()
    assert f"no pose moved more than {moved:.2f} m" in pose_graph_explorer.words(run, 1)


# The springs that are pulled


@pytest.fixture(scope="module")
def springs():
    return springs_explorer.explore_springs()


def test_the_words_say_what_the_solver_says_of_springs_that_are_pulled(springs):
    _, rest = figures.toy_before_and_after()
    xy = np.concatenate([rest.poses[1:, :2], rest.landmarks])
    xy[2] += (0.5, 0.6)
    poses = rest.poses.copy()
    poses[1:, :2] = xy[:5]
    run = list(gauss_newton(replace(rest, poses=poses, landmarks=xy[5:])))
    for k in range(3):
        assert f"chi2 is {run[min(k, len(run) - 1)].chi2:.1f}." in springs.move(xy=xy, iteration=k)
        assert springs.scene.parts["chi2 title"][2] == f"chi2: {run[min(k, len(run) - 1)].chi2:.1f}"


def test_springs_at_rest_and_let_go_lie_at_the_same_place(springs):
    _, rest = figures.toy_before_and_after()
    xy = np.concatenate([rest.poses[1:, :2], rest.landmarks])
    springs.move(xy=xy, iteration=0)
    at_rest = {name: part[1] for name, part in springs.scene.parts.items() if name.startswith("handle")}
    assert len(at_rest) == 9 and {part["data-places"] for part in at_rest.values()} == {"xy"}
    pulled = xy + np.eye(9, 1) * (0.3, -0.2)
    springs.move(xy=pulled, iteration=0)
    assert springs.scene.parts["handle 0"][1]["cx"] != at_rest["handle 0"]["cx"]
    springs.move(iteration=6)
    for name, part in at_rest.items():
        for key in ("cx", "cy"):
            assert abs(float(springs.scene.parts[name][1][key]) - float(part[key])) < 0.1  # px


def test_red_bars_are_the_residuals(springs):
    _, rest = figures.toy_before_and_after()
    xy = np.concatenate([rest.poses[1:, :2], rest.landmarks])
    xy[5] += (0.4, 0.3)  # an object is pulled away by 0.5 m: whoever sees it misses by that, and nobody else
    springs.move(xy=xy, iteration=0)
    scale = springs_explorer.ROOM.scale
    for k, landmark in enumerate(rest.observations.landmark):
        points = springs.scene.parts[f"miss {k}"][1]["points"].split()
        ends = np.array([point.split(",") for point in points], dtype=float)
        length = np.linalg.norm((ends[1] - ends[0]) / (scale[0], scale[2]))
        assert abs(length - 0.5 * (landmark == 0)) < 0.02
