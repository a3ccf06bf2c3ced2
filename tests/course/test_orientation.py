"""Lesson 14: its pictures show the table, its explorer tells the truth, its checks know the usual mistakes."""

import re

import numpy as np
import pytest
from exercises import assert_names_the_mistake, checks_and_solutions
from readable import assert_readable

from npslam_teach import plotting, se2
from npslam_teach.course.orientation import checks, figures, hall_map, pictures, table
from npslam_teach.course.orientation import explorer as heading_explorer
from npslam_teach.evaluation import evaluate
from npslam_teach.experiments.back_to_back import DEGREES, answer, hall
from npslam_teach.methods.gating import squared_mahalanobis
from npslam_teach.pose_graph import mean_headings

# --- exercises -------------------------------------------------------------------------------------------------------

CHECKS, solution = checks_and_solutions("14_orientation")


def turned(t, n, parts=lambda n: n, after=lambda n: n):
    return se2.wrap(parts(n) * t) / after(n) if n else np.zeros_like(t)


def weighed(v, d, t, s, h, half=2):
    return v * np.exp(-(d**2) / (half * s**2)) * np.exp(-(t**2) / (half * h**2))


def averaged(t, n, parts=lambda n: n, after=lambda n: n):
    return np.arctan2(np.sin(parts(n) * t).sum(), np.cos(parts(n) * t).sum()) / after(n)


def away(
    seen, expected, cov, n, inverse=np.linalg.inv, turn=lambda off, n: (off + np.pi / n) % (2 * np.pi / n) - np.pi / n
):
    off = np.array([*(seen[:2] - expected[:2]), turn(seen[2] - expected[2], n)])
    return off @ inverse(cov) @ off


WRONG = [
    (1, lambda t, n: t if n else 0 * t, "nothing is wrapped"),
    (1, lambda t, n: turned(t, n, lambda n: 1, lambda n: 1), "the symmetry is not used"),
    (1, lambda t, n: np.mod(t, 2 * np.pi / n) if n else 0 * t, "between 0 and"),
    (1, lambda t, n: turned(t, n, after=lambda n: 1), "divide by n again"),
    (1, lambda t, n: turned(t, 2 * n), "not after pi / n"),
    (1, lambda t, n: np.abs(turned(t, n)), "the sign is lost"),
    (1, lambda t, n: turned(t, n, parts=lambda n: 1), "wrap after the multiplication"),
    (1, lambda t, n: se2.wrap(n * t) / n if n else t, "of something round"),
    (1, lambda t, n: 0.5, "shape"),
    (2, lambda v, d, t, s, h: v * np.exp(-(d**2) / (2 * s**2)), "the heading is not used"),
    (2, lambda v, d, t, s, h: v * np.exp(-(t**2) / (2 * h**2)), "the position is not used"),
    (2, lambda v, d, t, s, h: weighed(1, d, t, s, h), "votes are missing"),
    (2, lambda v, d, t, s, h: weighed(v, d, t, s, h, 1), "the 2 under both"),
    (2, lambda v, d, t, s, h: v * (np.exp(-(d**2) / (2 * s * s)) + np.exp(-(t**2) / (2 * h * h))), "they do not add"),
    (2, lambda v, d, t, s, h: weighed(v, d, t, s, np.sqrt(h)), "the square of its width"),
    (2, lambda v, d, t, s, h: weighed(v, d, np.sqrt(np.abs(t)), s, h), "the turn is not squared"),
    (2, lambda v, d, t, s, h: weighed(v, d, t, h, s), "belongs to the other"),
    (3, lambda t, n: np.mean(t), "mean of the numbers"),
    (3, lambda t, n: np.median(t), "median"),
    (3, lambda t, n: averaged(t, n, lambda n: 1, lambda n: 1), "symmetry is not used"),
    (3, lambda t, n: averaged(t, n, after=lambda n: 1), "divide the angle by n"),
    (3, lambda t, n: np.arctan2(np.cos(n * t).sum(), np.sin(n * t).sum()) / n, "exchanged"),
    (3, lambda t, n: np.mean(turned(t, n)), "at the seam"),
    (3, lambda t, n: turned(t, n)[0], "the first heading"),
    (4, lambda s, e, c, n: away(s, e, c, n, turn=lambda off, n: off), "is not wrapped"),
    (4, lambda s, e, c, n: away(s, e, c, 1), "as if nothing looked alike"),
    (4, lambda s, e, c, n: away(s, e, c, n, inverse=lambda c: c), "to be inverted"),
    (4, lambda s, e, c, n: away(s, e, c * np.eye(3), n), "only the diagonal"),
    (4, lambda s, e, c, n: (s - e)[:2] @ np.linalg.inv(c[:2, :2]) @ (s - e)[:2], "only the place"),
    (4, lambda s, e, c, n: np.sqrt(away(s, e, c, n)), "to be squared"),
    (4, lambda s, e, c, n: away(s, e, c * [[1, 1, 0], [1, 1, 0], [0, 0, 1]], n), "judged apart"),
    (4, lambda s, e, c, n: away(s, -e, c, n), "not of the sum"),
]


@pytest.mark.parametrize(("number", "mistake", "message"), WRONG)
def test_usual_mistakes_are_named(number, mistake, message):
    assert_names_the_mistake(CHECKS[number], mistake, message)


def test_other_right_ways_are_right():
    def from_the_library(seen, expected, cov, symmetry):
        off = np.append(seen[:2] - expected[:2], se2.wrap_symmetric(seen[2] - expected[2], symmetry))
        return squared_mahalanobis(off, cov)

    assert checks.check_smallest_turn(lambda t, n: se2.wrap_symmetric(t, n)).passed
    assert checks.check_smallest_turn(turned).passed
    assert checks.check_oriented_weights(weighed).passed
    mean = checks.check_mean_heading(lambda t, n: mean_headings(np.zeros(len(t), int), t, np.full(len(t), n))[0])
    assert mean.passed
    assert checks.check_mean_heading(averaged).passed
    assert checks.check_joint_distance(from_the_library).passed
    assert checks.check_joint_distance(away).passed


# --- pictures --------------------------------------------------------------------------------------------------------


@pytest.fixture
def ax():
    return plotting.new_figure(size=(9, 5))[1]


@pytest.fixture(scope="module")
def scene():
    return hall(0, 10.0)


def test_a_nose_begins_at_its_object_and_shows_where_it_faces():
    x, y = hall_map.noses(np.array([[1.0, 2.0], [0.0, 0.0]]), np.array([np.pi / 2, np.pi]), 0.5)
    np.testing.assert_allclose(x, [1.0, 1.0, np.nan, 0.0, -0.5, np.nan], atol=1e-12)
    np.testing.assert_allclose(y, [2.0, 2.5, np.nan, 0.0, 0.0, np.nan], atol=1e-12)


def test_an_answer_is_laid_over_the_truth_with_its_headings(scene):
    log, truth = scene
    told = answer("true identities", log, truth)
    path, xy, theta = hall_map.laid_over(told, truth)
    assert np.linalg.norm(path[:, :2] - truth.poses[:, :2], axis=1).mean() < 0.15
    order = [truth.obs_object[told.labels == k][0] for k in range(8)]
    assert np.abs(se2.wrap(theta - truth.world.object_theta[order])).max() < 0.15
    assert np.linalg.norm(xy - truth.world.object_xy[order], axis=1).max() < 0.3
    without = answer("true identities", *hall(0, 0.0))
    assert np.isnan(hall_map.laid_over(without, truth)[2]).all()


def test_sightings_of_a_pair_are_those_of_both_chairs(scene):
    log, truth = scene
    figure = pictures.pair_figure(log, truth, 1)
    points = [len(ax.lines[0].get_xdata()) for ax in figure.axes]
    assert points == [np.isin(truth.obs_object, (2, 3)).sum(), (truth.obs_object == 2).sum()]
    assert f"{points[0]} sightings" in figure.axes[0].get_title()
    assert_readable(figure)


def test_what_looks_alike_is_drawn_as_given():
    figure = pictures.alike_figure(se2.wrap_symmetric)
    tops = [np.nanmax(line.get_ydata()) for line in figure.axes[0].lines]
    np.testing.assert_allclose(tops, [180, 90, 45, 0], atol=1)
    assert_readable(figure)


def test_weights_means_and_distances_are_drawn_as_given():
    figure = pictures.weights_figure(np.array([3.0, 2.0]), np.array([0.5, 1.5]))
    assert [bar.get_height() for bar in figure.axes[0].patches] == [3.0, 2.0, 0.5, 1.5]
    assert figure.axes[0].get_title() == "position says A, position and heading say B"
    assert_readable(figure)
    figure = pictures.means_figure(np.array([0.0, 1.0]), {"a": 0.5, "b": np.pi}, "t")
    np.testing.assert_allclose(figure.axes[0].lines[3].get_xdata(), [0, -0.85])
    assert_readable(figure)
    place = np.array([[1.0, 2.0], [2.0, 1.0]])
    figure = pictures.distances_figure(place, place + [0, 50], gate=11.34)
    assert "50% nearer" in figure.axes[0].get_title() and "100% nearer" in figure.axes[1].get_title()
    assert_readable(figure)


@pytest.mark.parametrize("quantity", pictures.QUANTITIES)
def test_runs_are_medians_of_the_table(ax, quantity):
    pictures.plot_runs(ax, quantity, ("np-graph", "ekf"))
    for container, case in zip(ax.containers, ("np-graph", "ekf"), strict=True):
        expected = [np.median(table.column(quantity, case, degrees)) for degrees in DEGREES[1:]]
        np.testing.assert_allclose(container[0].get_ydata(), expected)
        assert container.get_label() == case
    assert_readable(pictures.runs_figure(quantity, ("np-graph", "ekf")))


def test_the_explorer_tells_the_truth():
    results = heading_explorer.results_of(1, (0.0, 20.0))
    explorer = heading_explorer.explore_headings(1, results)
    for (method, error), last in results.items():
        log, truth = hall(1, error)
        words = explorer.move(method=method, error=error)
        assert f"{last.num_objects} objects, 8 are there" in words
        assert float(re.search(r"ARI ([\d.]+)", words)[1]) == pytest.approx(evaluate(last, truth, log).ari, abs=0.005)
        assert ("no headings" in words) == (error == 0.0)


def test_the_figure_can_be_read():
    (entry,) = figures.FIGURES
    figure = entry.draw()
    assert_readable(figure)
    assert [ax.get_title() for ax in figure.axes] == ["points: 8 objects", "with headings: 8 objects"]
