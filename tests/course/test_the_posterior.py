"""Lesson 11: its scenes are as described, pictures and sliders tell the truth, checks know the usual mistakes."""

import itertools
import math
import re

import numpy as np
import pytest
from exercises import assert_names_the_mistake, checks_and_solutions
from readable import assert_readable

from npslam_teach import association, plotting, se2
from npslam_teach.association.dirichlet_process import log_partition_prior
from npslam_teach.association.partition_posterior import joint_system, log_posterior, plain_weights
from npslam_teach.course.the_posterior import checks, figures, hand_pictures, pictures, scenes
from npslam_teach.course.the_posterior.annealing_film import COUNTS, explore_annealing
from npslam_teach.course.the_posterior.explorer import ExactPosterior, explore_posterior
from npslam_teach.evaluation.reliability import Reliability, reliability
from npslam_teach.pose_graph import fit, linearize
from npslam_teach.pose_graph.reduced_system import reduced_system

# --- exercises -------------------------------------------------------------------------------------------------------

CHECKS, solution = checks_and_solutions("11_the_posterior")


def crp(counts, alpha, first=0, guests=lambda n: math.factorial(n - 1), tables=len):
    below = math.prod(alpha + i for i in range(first, first + sum(map(int, counts))))
    return alpha ** tables(counts) * math.prod(guests(int(n)) for n in counts) / below


def logs_of(log_p, labels, k):
    others = np.unique(np.delete(labels, k), return_inverse=True)[1]
    return np.array([log_p(np.insert(others, k, place)) for place in range(others.max() + 2)])


def softmax(x):
    return np.exp(x - np.max(x)) / np.exp(x - np.max(x)).sum()


def no_largest_taken_off(x):
    with np.errstate(invalid="ignore"):
        return np.exp(x) / np.exp(x).sum()


def parts(H, b, n):
    return H[:n, :n], H[:n, n:], H[n:, n:], b[:n], b[n:]


def eliminate(H, b, n, sign=1.0, only_b=False, keep_b=False, inverse=np.linalg.inv):
    xx, xl, ll, bx, bl = parts(H, b, n)
    gain = xl.T @ inverse(xx)
    return ll - (0 if only_b else sign) * gain @ xl, bl - (0 if keep_b else sign) * gain @ bx


def accept(apart, merged, weights, sits, way_back=1.0, cap=1.0):
    shares = np.take_along_axis(weights, sits[:, None], 1)[:, 0] - np.logaddexp(*weights.T)
    return min(cap, math.exp(min(700.0, merged - apart + way_back * shares.sum())))


def together(partitions):
    return (partitions[:, :, None] == partitions[:, None]).mean(axis=0)


WRONG = [
    (1, lambda c, a: a ** len(c) * math.prod(math.factorial(n - 1) for n in c.tolist()), "below the line are missing"),
    (1, lambda c, a: crp(c, a, tables=lambda c: 1), "once for every table"),
    (1, lambda c, a: crp(c, a, guests=math.factorial), "not n!"),
    (1, lambda c, a: crp(c, a, first=1), "not alpha + 1"),
    (1, lambda c, a: crp(c, a, guests=lambda n: 1), "own factors"),
    (1, lambda c, a: math.log(crp(c, a)), "that is the logarithm"),
    (1, lambda c, a: 2 * crp(c, a), "should be"),
    (2, logs_of, "logarithms of the weights"),
    (2, lambda *t: logs_of(*t) / logs_of(*t).sum(), "these are logarithms"),
    (2, lambda *t: np.exp(logs_of(*t) - logs_of(*t).max()), "add up to one"),
    (2, lambda *t: np.roll(softmax(logs_of(*t)), 1), "comes last, not first"),
    (2, lambda *t: softmax(logs_of(*t)[:-1]), "no place in your answer"),
    (2, lambda *t: np.ones(len(logs_of(*t))) / len(logs_of(*t)), "log_p is not used"),
    (2, lambda *t: no_largest_taken_off(logs_of(*t)), "holds nan"),
    (2, lambda p, x, k: softmax(np.array([p(np.where(np.arange(5) == k, i, x)) for i in range(9)])), "without gaps"),
    (3, lambda H, b, n: (H[n:, n:], b[n:]), "poses were known exactly"),
    (3, lambda *t: eliminate(*t, sign=-1.0), "is added"),
    (3, lambda *t: eliminate(*t, inverse=lambda x: x), "instead of its inverse"),
    (3, lambda *t: eliminate(*t, inverse=lambda x: 1 / x), "number by number"),
    (3, lambda H, b, n: (np.linalg.inv(H)[n:, n:], b[n:]), "that is the covariance"),
    (3, lambda *t: eliminate(*t, keep_b=True), "has been forgotten"),
    (3, lambda *t: (eliminate(*t)[0], eliminate(*t, sign=-1.0)[1]), "sign of what the poses add"),
    (3, lambda *t: (eliminate(*t)[0], -eliminate(*t)[1]), "keep the sign of b"),
    (3, lambda *t: (eliminate(*t)[0], 2 * eliminate(*t)[1]), "your gradient should be"),
    (3, lambda *t: (eliminate(*t)[0], ...), "your gradient is still the dots"),
    (3, lambda *t: eliminate(*t)[0], "your information should have shape"),
    (4, lambda x, n: (np.mean(x.max(axis=1) == n), together(x)), "labels count from 0"),
    (4, lambda x, n: (np.sum(x.max(axis=1) + 1 == n), together(x)), "divide by the number of samples"),
    (4, lambda x, n: (np.mean(x.max(axis=1) + 1 <= n), together(x)), "not at most"),
    (4, lambda x, n: (np.mean(x.max(axis=1) + 1 == n), len(x) * together(x)), "that is how often; divide"),
    (4, lambda x, n: (np.mean(x.max(axis=1) + 1 == n), 1 - together(x)), "they are apart"),
    (4, lambda x, n: (np.mean(x.max(axis=1) + 1 == n), x[-1][:, None] == x[-1]), "the last, is no probability"),
    (4, lambda x, n: (np.mean(x.max(axis=1) + 1 == n), together(x) - np.eye(x.shape[1])), "one object with itself"),
    (4, lambda x, n: np.mean(x.max(axis=1) + 1 == n), "return two things"),
    (5, lambda *t: accept(*t, cap=math.inf), "never above 1"),
    (5, lambda *t: accept(*t, way_back=0.0), "the way back is missing"),
    (5, lambda *t: accept(*t, way_back=-1.0), "belongs above"),
    (5, lambda a, m, w, s: accept(m, a, w, s), "changed places"),
    (5, lambda a, m, w, s: accept(0, 0, w, s), "posteriors are missing"),
    (5, lambda a, m, w, s: accept(a, m, w, 1 - s), "take that where each sits"),
    (5, lambda *t: math.log(accept(*t)), "that is the logarithm"),
    (5, lambda *t: accept(*t) / 2, "should be"),
]


@pytest.mark.parametrize(("number", "mistake", "message"), WRONG)
def test_usual_mistakes_are_named(number, mistake, message):
    assert_names_the_mistake(CHECKS[number], mistake, message)


def test_other_right_ways_are_right():
    assert checks.check_crp_probability(lambda c, a: math.exp(log_partition_prior(c, a))).passed
    assert checks.check_eliminate(eliminate).passed
    covariance = checks.check_eliminate(
        lambda H, b, n: (np.linalg.inv(np.linalg.inv(H)[n:, n:]), eliminate(H, b, n)[1])
    )
    assert covariance.passed
    assert checks.check_merge_acceptance(accept).passed


def test_the_solution_of_exercise_1_adds_up_to_one():
    partitions = [np.bincount(labels) for labels in association.all_partitions([0] * 6)]
    for alpha in (0.3, 1.0, 4.0):
        assert sum(solution(1)(counts, alpha) for counts in partitions) == pytest.approx(1.0)


def test_the_solution_of_exercise_2_is_the_samplers():
    evidence = scenes.evidence_of(scenes.eight_sightings()[0])
    labels = np.array([0, 1, 0, 1, 2, 2, 0, 0])
    for k in range(8):
        expected = softmax(plain_weights(evidence, labels, k))
        found = solution(2)(lambda x: log_posterior(evidence, x), labels, k)
        np.testing.assert_allclose(found, expected, atol=1e-12)


def test_the_solution_of_exercise_3_is_the_reduced_system():
    log, _ = scenes.eight_sightings()
    graph = fit(log, np.arange(8))
    h, b, _ = linearize(graph)
    information, gradient = solution(3)(h.toarray(), b, 3 * (log.num_poses - 1))
    reduced = reduced_system(graph)
    np.testing.assert_allclose(information, reduced.information, rtol=1e-8, atol=1e-8)
    np.testing.assert_allclose(information @ graph.landmarks.ravel() - gradient, reduced.vector, rtol=1e-7, atol=1e-6)


def test_the_solution_of_exercise_5_balances():
    """From apart to merged as much flows as back: p(apart) a = p(merged) q a', q the probability of this split."""
    rng = np.random.default_rng(3)
    for _ in range(20):
        apart, merged, weights = *rng.normal(0, 2, 2), rng.normal(size=(3, 2))
        for sits in itertools.product((0, 1), repeat=3):
            way = math.exp(sum(weights[k, s] - np.logaddexp(*weights[k]) for k, s in enumerate(sits)))
            back = min(1.0, math.exp(apart - merged) / way)
            there = solution(5)(apart, merged, weights, np.array(sits))
            assert math.exp(apart) * there == pytest.approx(math.exp(merged) * way * back)


# --- scenes ----------------------------------------------------------------------------------------------------------


def test_the_eight_sightings_lie_as_the_lesson_says():
    log, truth = scenes.eight_sightings()
    xy = se2.apply(se2.dead_reckoning(log.odometry)[log.obs_time], log.obs_xy)
    chair_a, chair_b, _ = truth.world.object_xy
    np.testing.assert_allclose(np.linalg.norm(xy[6:] - chair_a, axis=1), 0.2, atol=1e-9)
    np.testing.assert_allclose(np.linalg.norm(xy[6:] - chair_b, axis=1), 0.4, atol=1e-9)
    np.testing.assert_allclose(xy[:6], truth.world.object_xy[truth.obs_object[:6]], atol=1e-9)


@pytest.mark.parametrize("scene", [scenes.eight_sightings, scenes.four_and_four])
def test_all_4140_partitions_and_two_that_matter(scene):
    log, truth = scene()
    exact = ExactPosterior(scenes.evidence_of(log))
    p = exact.probabilities()
    assert len(p) == 4140 and p.sum() == pytest.approx(1.0)
    first, second = np.argsort(-p)[:2]
    assert p[first] > 0.5 and 0.25 < p[second] < 0.5
    np.testing.assert_array_equal(exact.partitions[second], truth.obs_object)


def test_alpha_and_temperature_do_what_they_say():
    log, _ = scenes.eight_sightings()
    exact = ExactPosterior(scenes.evidence_of(log, alpha=1.0))
    again = ExactPosterior(scenes.evidence_of(log, alpha=7.0))
    np.testing.assert_allclose(exact.probabilities(alpha=7.0), again.probabilities(alpha=7.0), atol=1e-12)
    p = exact.probabilities(alpha=7.0)
    np.testing.assert_allclose(exact.probabilities(7.0, 2.0), np.sqrt(p) / np.sqrt(p).sum(), atol=1e-12)


# --- pictures --------------------------------------------------------------------------------------------------------


@pytest.fixture
def ax():
    return plotting.new_figure()[1]


def test_names_of_partitions():
    assert pictures.partition_name([0, 1, 0, 1, 2]) == "{1 3} {2 4} {5}"
    assert pictures.partition_name([]) == ""


def test_bars_are_the_most_probable_partitions(ax):
    partitions = [np.array(x) for x in association.all_partitions([0] * 4)]
    p = np.random.default_rng(0).dirichlet(np.ones(len(partitions)))
    pictures.plot_partitions(ax, partitions, p, true_labels=partitions[3], rows=15)
    widths = [bar.get_width() for bar in ax.patches]
    np.testing.assert_allclose(widths, np.sort(p)[::-1])
    texts = [text.get_text() for text in ax.texts]
    assert texts[0].startswith(f"{p.max():.3f}  {pictures.partition_name(partitions[int(p.argmax())])}")
    assert ax.get_title() == f"of {len(p)} partitions two hold {np.sort(p)[-2:].sum():.2f}"
    assert [("(true)" in text) for text in texts].index(True) == np.argsort(-p).tolist().index(3)


@pytest.mark.parametrize("scene", [scenes.eight_sightings, scenes.four_and_four])
def test_the_map_of_sightings_can_be_read(scene):
    figure, ax = plotting.new_figure(size=(7, 4.6))
    pictures.plot_numbered_sightings(ax, *scene(), "sightings")
    assert_readable(figure)
    numbers = [int(n) for text in ax.texts for n in re.findall(r"\d+", text.get_text())]
    assert sorted(numbers) == list(range(1, 9))
    assert ax.get_aspect() == 1.0


def test_bars_of_the_number_of_objects(ax):
    pictures.plot_num_objects(ax, {"a": {15: 0.7, 16: 0.3}, "b": {14: 1.0}}, num_true=15)
    heights = {round(bar.get_x() + bar.get_width() / 2, 6): bar.get_height() for bar in ax.patches}
    assert heights[14.8] == 0.7 and heights[15.8] == 0.3 and heights[14.2] == 1.0
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["true number: 15", "a", "b"]
    assert ax.get_title() == "probability of 15: a 0.70, b 0.00"


def test_the_matrix_is_sorted_by_object(ax):
    best = np.array([1, 0, 1, 0])
    matrix = np.where(best[:, None] == best, 0.9, 0.2)
    pictures.plot_together(ax, matrix, best, "pairs")
    shown = ax.images[0].get_array()
    assert (shown[:2, :2] == 0.9).all() and (shown[2:, 2:] == 0.9).all() and (shown[:2, 2:] == 0.2).all()
    assert len(ax.lines) == 2


def test_ellipses_of_objects(ax):
    cov = np.array([np.diag([0.04, 0.01])] * 2)
    pictures.plot_credible(ax, np.array([[0.0, 0], [2, 1]]), cov, np.array([[0.1, 0]]), "where")
    axes = sorted([ax.patches[1].width, ax.patches[1].height])
    np.testing.assert_allclose(axes, 2 * np.sqrt(-2 * np.log(0.05)) * np.array([0.1, 0.2]), rtol=1e-6)


def test_running_means():
    chains = np.array([[1, 1, 2, 2], [2, 2, 2, 2]])
    figure = pictures.chains_figure({"one": (chains, 1.5), "two": (chains[::-1], 1.5)})
    np.testing.assert_allclose(figure.axes[0].lines[0].get_ydata(), [1, 1, 4 / 3, 1.5])
    np.testing.assert_allclose(figure.axes[1].lines[0].get_ydata(), [2, 2, 2, 2])
    assert_readable(figure)


def test_reliability_has_a_point_for_every_group(ax):
    table = Reliability(np.array([0.1, 0.8]), np.array([0.2, 0.7]), np.array([10, 30]), np.array([0.1, 0.2]))
    pictures.plot_reliability(ax, table, "right?")
    assert ax.get_title() == "right?:\n2 of 2 groups as it should be"
    points = next(line for line in ax.lines if line.get_marker() == "o")
    np.testing.assert_allclose(points.get_xydata(), [[0.1, 0.2], [0.8, 0.7]])


def test_moves_are_bars_by_place_and_case():
    figure = hand_pictures.moves_figure({"A": {"A": 0.9, "new": 0.1}, "B": {"A": 0.2, "new": 0.8}})
    (ax,) = figure.axes
    assert [bar.get_height() for bar in ax.patches] == [0.9, 0.1, 0.2, 0.8]
    assert_readable(figure)


def test_running_shares_end_at_the_mean_of_each_chain():
    chains = np.random.default_rng(0).random((4, 60)) < 0.4
    figure = hand_pictures.running_share_figure(chains, 0.37, "8 is with B")
    (ax,) = figure.axes
    np.testing.assert_allclose([line.get_ydata()[-1] for line in ax.lines[:4]], chains.mean(axis=1))
    assert f"{chains.mean(axis=1).min():.2f} to {chains.mean(axis=1).max():.2f}" in ax.get_title()
    assert_readable(figure)


def test_the_chairs_of_the_corridor_are_densities():
    figure = hand_pictures.corridor_figure(np.array([1.0, 1.4]), np.array([0.1, 0.2]))
    (ax,) = figure.axes
    for line, place in zip(ax.lines, (1.0, 1.4), strict=True):
        x, density = line.get_data()
        assert np.trapezoid(density, x) == pytest.approx(1.0, abs=1e-3)
        assert x[np.argmax(density)] == pytest.approx(place, abs=0.01)
    assert_readable(figure)


def test_what_two_share_is_not_in_their_difference():
    shared, own = np.diag([0.16, 0.09]), 0.01 * np.eye(2)
    figure = hand_pictures.shared_drift_figure(np.array([shared + own, shared + own]), 2 * own)
    (ax,) = figure.axes
    wide = [np.ptp(line.get_xdata()) for line in ax.lines]
    np.testing.assert_allclose(wide, 2 * np.sqrt(-2 * np.log(0.05) * np.array([0.17, 0.17, 0.02])), rtol=1e-3)
    assert ax.get_legend().get_texts()[2].get_text() == "8 less 7: std in x 0.14 m"
    assert_readable(figure)


def test_atoms_are_as_large_as_their_weights(ax):
    pictures.plot_atoms(ax, np.array([0.75, 0.25]), np.array([[1.0, 1], [2, 2]]), "a world")
    sizes = ax.collections[0].get_sizes()
    assert sizes[0] == pytest.approx(3 * sizes[1])


# --- explorers -------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def exact():
    return ExactPosterior(scenes.evidence_of(scenes.eight_sightings()[0]))


@pytest.fixture(scope="module")
def explorer(exact):
    return explore_posterior(exact, scenes.eight_sightings()[1].obs_object)


@pytest.mark.parametrize(("log_alpha", "temperature"), [(0.0, 1.0), (-3.0, 0.1), (3.0, 1.0), (1.0, 8.0)])
def test_words_and_bars_are_the_exact_posterior(explorer, exact, log_alpha, temperature):
    words = explorer.move(log_alpha=log_alpha, temperature=temperature)
    p = exact.probabilities(10**log_alpha, temperature)
    best = int(p.argmax())
    assert f"{pictures.partition_name(exact.partitions[best])} has {p[best]:.3f}" in words
    needed = int(re.search(r"; (\d+) partitions hold 95 %", words).group(1))
    top = np.cumsum(np.sort(p)[::-1])
    assert top[needed - 1] >= 0.95 and (needed == 1 or top[needed - 2] < 0.95)
    left, right = explorer.figure.axes
    assert left.patches[0].get_width() == pytest.approx(p.max())
    heights = [bar.get_height() for bar in right.patches]
    np.testing.assert_allclose(heights, [p[exact.num_objects == k].sum() for k in range(1, 9)], atol=1e-12)
    assert_readable(explorer.figure)


@pytest.fixture(scope="module")
def film():
    return figures.annealing_film()


@pytest.mark.parametrize("number", [0, 2, 12])
def test_the_film_shows_its_states(film, number):
    explorer = explore_annealing(film)
    words = explorer.move(state=number)
    state = film.states[number]
    assert f"in {state.labels.max() + 1} objects" in words
    assert f"Temperature {state.temperature:.2f}" in words
    parts = explorer.scene.parts
    marks = [part for name, part in parts.items() if name.startswith("tracklet ")]
    spokes = [part[1]["points"].split() for name, part in parts.items() if name.startswith("spoke ")]
    assert len(marks) == len(spokes) == len(state.labels)
    ends = np.array([spoke[1].split(",") for spoke in spokes], dtype=float)
    for label in range(state.labels.max() + 1):
        assert np.ptp(ends[state.labels == label], axis=0).max() < 1e-9, "spokes of one object end in one place"
    # A marker and a colour together tell the objects apart.
    shapes = film.tracklet_class
    looks = {(c, mark[1]["fill"], label) for c, mark, label in zip(shapes, marks, state.labels, strict=True)}
    if number == 12:
        assert len({look[:2] for look in looks}) == len({look[2] for look in looks}) == 15
    assert parts["map title"][2] == film.title(number)
    assert parts["cooling title"][2] == f"{state.labels.max() + 1} objects"
    box = dict(zip(("left", "top", "width", "height"), COUNTS, strict=True))
    dot = parts["cooling dot"][1]
    assert box["left"] < float(dot["cx"]) < box["left"] + box["width"]
    assert box["top"] < float(dot["cy"]) < box["top"] + box["height"]


def test_the_film_ends_on_the_truth(film):
    true_xy = film.truth.world.object_xy
    away = np.linalg.norm(film.object_xy[-1][:, None] - true_xy, axis=2).min(axis=1)
    at_first = np.linalg.norm(film.object_xy[0][:, None] - true_xy, axis=2).min(axis=1)
    assert away.mean() < 0.6 < at_first.mean()


def test_figure_22_can_be_read():
    (entry,) = figures.FIGURES
    assert entry.name == "fig22_annealing" and len(entry.alt) > 60
    figure = entry.draw()
    assert_readable(figure)
    assert [ax.get_title() for ax in figure.axes] == [
        "temperature 8: 30 objects",
        "temperature 3.4: 20 objects",
        "temperature 0.05: 15 objects",
    ]


# --- what the lesson claims ------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_probabilities_are_true_once_the_border_is_weighed_in():
    """The method lets chairs stand outside the square; weighing partitions by the share inside corrects this."""
    rng, noise = np.random.default_rng(11), np.random.default_rng(12).normal(size=(200, 12))
    plain, weighed = [], []
    for world in range(200):
        log, truth = scenes.drawn_world(rng)
        evidence = scenes.evidence_of(log, area=scenes.DRAWN_SIDE**2)
        listed = ExactPosterior(evidence)
        p = listed.probabilities()
        inside = np.zeros(len(p))
        for k in np.flatnonzero(p > 1e-3):
            inside[k] = share_inside(evidence, listed.partitions[k], noise)
        pairs = np.array([x[:3, None] == x[3:] for x in listed.partitions])
        true = (truth.obs_object[:3, None] == truth.obs_object[3:]).ravel()
        for rows, weight in ((plain, p), (weighed, p * inside)):
            said = np.tensordot(weight / weight.sum(), pairs, 1).ravel()
            rows += [(q, one, world) for q, one in zip(said, true, strict=True)]
    plain, weighed = (reliability(*np.array(rows).T) for rows in (plain, weighed))
    assert plain.expected_calibration_error < 0.05
    assert weighed.expected_calibration_error < min(0.03, plain.expected_calibration_error)
    assert weighed.within.sum() >= 4


def share_inside(evidence, labels, noise) -> float:
    """How probable it is that all objects of a partition are in the square, by 200 draws."""
    precision, vector = joint_system(evidence, labels)
    root = np.linalg.cholesky(np.linalg.inv(precision))
    xy = np.linalg.solve(precision, vector) + noise[:, : len(vector)] @ root.T
    xy = xy.reshape(len(xy), -1, 2) - np.array([0.0, -2.5])
    return float(((xy >= 0) & (xy <= scenes.DRAWN_SIDE)).all(axis=(1, 2)).mean())


def test_a_model_that_believes_half_the_noise_is_sure_and_wrong():
    rows, rng = [], np.random.default_rng(21)
    for world in range(40):
        log, truth = scenes.drawn_world(rng, noise=2.0)
        listed = ExactPosterior(scenes.evidence_of(log, area=scenes.DRAWN_SIDE**2))
        said = np.tensordot(listed.probabilities(), [x[:3, None] == x[3:] for x in listed.partitions], 1).ravel()
        true = (truth.obs_object[:3, None] == truth.obs_object[3:]).ravel()
        rows += [(q, one, world) for q, one in zip(said, true, strict=True)]
    table = reliability(*np.array(rows).T)
    assert table.expected_calibration_error > 0.12
    assert table.happened[0] > 0.08 > table.said[0]
