"""Lesson 07: its two pictures, its explorer, and the checks of its exercises."""

import numpy as np
import pytest
from exercises import assert_names_the_mistake, solved_names
from readable import assert_readable

from npslam_teach import evaluation, np_graph, plotting, pose_graph, se2, simulate
from npslam_teach.course.fifteen_objects import checks, pictures
from npslam_teach.course.fifteen_objects import explorer as fifteen_objects_explorer


@pytest.fixture(scope="module")
def sparse_room():
    world = simulate.fifteen_objects()[1].world
    path, rng = simulate.designed_path(0.4), np.random.default_rng(2016)
    return simulate.simulate_run(world, path, simulate.paper_sensor(), rng)


# --- the pictures ----------------------------------------------------------------------------------------------------


def test_rooms_are_marked_by_whether_they_found_the_right_number():
    figure, ax = plotting.new_figure(size=(7, 4))
    pictures.plot_rooms(ax, [15, 21, 15, 18], [0.1, 0.9, 0.2, 0.5])
    exact, other = ax.lines
    np.testing.assert_allclose(exact.get_xydata(), [[15, 0.1], [15, 0.2]])
    np.testing.assert_allclose(other.get_xydata(), [[21, 0.9], [18, 0.5]])
    assert exact.get_marker() != other.get_marker() and exact.get_color() != other.get_color()
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("objects found (number)", "mean pose error (m)")
    assert ax.get_ylim()[0] == 0.0
    assert ax.get_title() == "2 of 4 rooms find 15\nmedian error 0.15 m there, 0.70 m elsewhere"
    assert_readable(figure)
    alike = pictures.plot_rooms(plotting.new_figure()[1], [15, 15], [0.1, 0.2])
    assert alike.get_title() == "2 of 2 rooms find 15"


def test_robust_kernels_are_told_apart_and_the_title_has_their_prices():
    figure, ax = plotting.new_figure(size=(8, 4))
    r = np.linspace(-4, 4, 9)
    pictures.plot_robust_kernels(ax, r, {"least squares": r**2, "bounded": r**2 / (1 + r**2)})
    np.testing.assert_allclose([line.get_ydata()[-1] for line in ax.lines], [16, 16 / 17])
    assert len({(line.get_color(), line.get_linestyle()) for line in ax.lines}) == 2
    assert ax.get_title() == "an error of 4 costs 16, 0.94"
    assert_readable(figure)


def test_the_map_of_settings_writes_every_cell():
    counts = np.array([[[15, 15, 16], [600, 610, 15]], [[14, 14, 14], [900, 901, 902]]])
    figure, ax = plotting.new_figure(size=(10, 4.4))
    pictures.plot_settings(ax, counts, (0.1, 0.9), (None, 0.3))
    written = {(round(text.get_position()[1]), round(text.get_position()[0])): text for text in ax.texts}
    expected = {(0, 0): "15\n2 of 3", (0, 1): "600\n1 of 3", (1, 0): "14\n0 of 3", (1, 1): "901\n0 of 3"}
    assert {place: text.get_text() for place, text in written.items()} == expected
    np.testing.assert_allclose(ax.images[0].get_array(), [[15, 600], [14, 901]])
    assert [label.get_text() for label in ax.get_yticklabels()] == ["0.1", "0.9"]
    assert [label.get_text() for label in ax.get_xticklabels()] == ["most probable\nwins", "0.3"]
    assert "probability" in ax.get_xlabel() and "votes" in ax.get_ylabel()
    assert_readable(figure)


def test_numbers_on_the_map_of_settings_can_be_read():
    """Text and the colour under it have enough contrast, from light to dark (WCAG: 4.5 for small text)."""
    _, ax = plotting.new_figure()
    counts = np.array([[[5], [15], [40], [100], [170], [241], [600], [1185]]])
    pictures.plot_settings(ax, counts, (0.9,), (None,) * 8)
    image = ax.images[0]

    def luminance(rgb):
        linear = [v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4 for v in rgb[:3]]
        return float(np.dot([0.2126, 0.7152, 0.0722], linear))

    for text in ax.texts:
        under = luminance(image.to_rgba(counts[0, round(text.get_position()[0]), 0]))
        ink = 1.0 if text.get_color() == "white" else 0.0
        assert (max(under, ink) + 0.05) / (min(under, ink) + 0.05) > 4.0, text.get_text()


# --- the explorer ----------------------------------------------------------------------------------------------------


def test_the_explorer_runs_the_whole_method(sparse_room):
    log, truth = sparse_room
    explorer = fifteen_objects_explorer.explore_method(log, truth)
    slider = explorer.sliders["alpha"]
    box = fifteen_objects_explorer.COUNTS
    for alpha in (slider.min, 1.0, slider.max):
        for threshold in (None, 0.002, 0.05, 0.5):
            words = explorer.move(alpha=alpha, threshold=threshold)
            snapshots = list(np_graph(log, slider.value, threshold, fifteen_objects_explorer.ITERATIONS))
            counts = [snapshot.num_objects for snapshot in snapshots]
            assert f"objects {', '.join(map(str, counts))};" in words
            metrics = evaluation.evaluate(snapshots[-1], truth, log)
            assert f"error {metrics.mean_pose_error:.2f} m, ARI {metrics.ari:.2f}" in words
            parts = explorer.scene.parts
            assert parts["map title"][2] == f"{counts[-1]} objects"
            of_object = np.bincount(snapshots[-1].labels)
            assert sum(name.startswith("object ") for name in parts) == np.count_nonzero(of_object > 1)
            curve = [each.split(",") for each in parts["counts curve"][1]["points"].split()]
            heights = np.array(curve, dtype=float)[:, 1]
            assert (heights > box[1]).all() and (heights < box[1] + box[3]).all()
            falls = np.diff(heights) / -box[3] * (np.ceil(np.log10(log.num_observations)) - 0.5)
            np.testing.assert_allclose(falls, np.diff(np.log10(counts)), atol=1e-4)


def test_errors_of_the_method_reach_the_student(sparse_room, monkeypatch):
    explorer = fifteen_objects_explorer.explore_method(*sparse_room)

    def broken(*arguments):
        raise RuntimeError("no such method")

    monkeypatch.setattr(fifteen_objects_explorer, "np_graph", broken)
    with pytest.raises(RuntimeError, match="no such method"):
        explorer.move(alpha=0.3)


# --- the checks ------------------------------------------------------------------------------------------------------


def test_the_solutions_measure_what_the_library_measures(sparse_room):
    solutions = solved_names("07")
    log, truth = sparse_room
    *_, last = np_graph(log)
    metrics = evaluation.evaluate(last, truth, log)
    assert solutions["mean_pose_error"](last.graph.poses, truth.poses) == pytest.approx(metrics.mean_pose_error)
    assert solutions["adjusted_rand"](truth.obs_object, last.labels) == pytest.approx(metrics.ari)
    best = pose_graph.fit(log, last.labels, last.graph.poses)
    chi2 = evaluation.chi2_per_dof(best) * 2 * (log.num_observations - last.num_objects)
    answer = solutions["per_dof"](chi2, log.num_poses, log.num_observations, last.num_objects)
    assert answer == pytest.approx(metrics.chi2_per_dof)


@pytest.mark.parametrize(
    ("wrong", "named"),
    [
        (lambda c, t, m, k: c / (3 * (t - 1) + 2 * m - 3 * t - 2 * k), "the gauge"),
        (lambda c, t, m, k: c / (3 * (t - 1) + 2 * m), "unknowns are not taken off"),
        (lambda c, t, m, k: c / (2 * m), "the objects are not taken off"),
        (lambda c, t, m, k: c / (m - 2 * k), "a sighting measures two"),
        (lambda c, t, m, k: c / (2 * m - 3 * k), "two unknown coordinates"),
        (lambda c, t, m, k: c / (m - k), "their coordinates are wanted"),
        (lambda c, t, m, k: c / 2 / (2 * m - 2 * k), "not half of it"),
        (lambda c, t, m, k: c, "count the measured numbers"),
    ],
)
def test_mistakes_in_the_degrees_of_freedom(wrong, named):
    assert_names_the_mistake(checks.check_per_dof, wrong, named)


def errors(poses, truth):
    motion = se2.align(poses[:, :2], truth[:, :2])
    return np.linalg.norm(se2.apply(motion, poses[:, :2]) - truth[:, :2], axis=1)


def shifted(poses, truth):
    difference = poses[:, :2] - truth[:, :2]
    return np.linalg.norm(difference - difference.mean(axis=0), axis=1).mean()


def backwards(poses, truth):
    motion = se2.align(truth[:, :2], poses[:, :2])
    return np.linalg.norm(se2.apply(motion, poses[:, :2]) - truth[:, :2], axis=1).mean()


def by_the_first(poses, truth):
    motion = se2.compose(truth[0], se2.inverse(poses[0]))
    return np.linalg.norm(se2.apply(motion, poses[:, :2]) - truth[:, :2], axis=1).mean()


@pytest.mark.parametrize(
    ("wrong", "named"),
    [
        (lambda p, t: np.linalg.norm((p - t)[:, :2], axis=1).mean(), "not laid over"),
        (shifted, "turned too"),
        (backwards, "wrong way round"),
        (by_the_first, "only the first poses"),
        (lambda p, t: np.sqrt((errors(p, t) ** 2).mean()), "root of the mean square"),
        (lambda p, t: (errors(p, t) ** 2).mean(), "squared metres"),
        (lambda p, t: errors(p, t).sum(), "added up"),
        (lambda p, t: np.median(errors(p, t)), "median"),
        (errors, "shape"),
    ],
)
def test_mistakes_in_the_pose_error(wrong, named):
    assert_names_the_mistake(checks.check_mean_pose_error, wrong, named)


def test_aligning_the_truth_instead_is_right():
    assert checks.check_mean_pose_error(lambda p, t: errors(t, p).mean()).passed


def pairs(true_labels, labels):
    pair = np.triu(np.ones((len(labels), len(labels)), dtype=bool), k=1)
    in_true, in_found = ((x[:, None] == x) & pair for x in (true_labels, labels))
    return (in_true & in_found).sum(), in_true.sum(), in_found.sum(), pair.sum()


def rand_index(true_labels, labels):
    n, a, b, total = pairs(true_labels, labels)
    return (total - a - b + 2 * n) / total


def without_chance(true_labels, labels):
    n, a, b, _ = pairs(true_labels, labels)
    return 2 * n / (a + b)


def above_only(true_labels, labels):
    n, a, b, total = pairs(true_labels, labels)
    return 2 * (n - a * b / total) / (a + b)


def the_larger(true_labels, labels):
    n, a, b, total = pairs(true_labels, labels)
    return (n - a * b / total) / (max(a, b) - a * b / total)


def with_itself(true_labels, labels):
    in_true, in_found = (x[:, None] == x for x in (true_labels, labels))
    n, a, b, total = (in_true & in_found).sum(), in_true.sum(), in_found.sum(), in_true.size
    return (n - a * b / total) / ((a + b) / 2 - a * b / total)


@pytest.mark.parametrize(
    ("wrong", "named"),
    [
        (rand_index, "this is the Rand index"),
        (without_chance, "chance is not taken off"),
        (above_only, "above the line only"),
        (the_larger, "you took the larger"),
        (with_itself, "no pair with itself"),
        (lambda true_labels, labels: np.mean(true_labels == labels), "names of objects mean nothing"),
        (lambda true_labels, labels: 1.0, "count the pairs"),
    ],
)
def test_mistakes_in_the_rand_index(wrong, named):
    assert_names_the_mistake(checks.check_adjusted_rand, wrong, named)
