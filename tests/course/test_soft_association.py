"""Lesson 13: its pictures show the table, its explorer tells the truth, its checks know the usual mistakes."""

import itertools
import re

import numpy as np
import pytest
from exercises import assert_names_the_mistake, checks_and_solutions
from readable import assert_readable

from npslam_teach import plotting
from npslam_teach.association.matchings import matching_probabilities
from npslam_teach.association.semantics import class_distances, log_likelihoods
from npslam_teach.course.soft_association import checks, figures, pictures, table
from npslam_teach.course.soft_association import explorer as soft_explorer
from npslam_teach.evaluation import distances_to_truth
from npslam_teach.experiments.confused_classes import SHARES, room

# --- exercises -------------------------------------------------------------------------------------------------------

CHECKS, solution = checks_and_solutions("13_soft_association")


def pairs_of(w, allowed=lambda used: len(set(used)) == len(used), none=1.0, normal=True):
    m, K = w.shape
    total, found = 0.0, np.zeros((m, K))
    for choice in itertools.product(range(K + 1), repeat=m):
        used = [j for j in choice if j < K]
        if allowed(used):
            product = np.prod([w[k, j] if j < K else none for k, j in enumerate(choice)])
            total += product
            for k, j in enumerate(choice):
                if j < K:
                    found[k, j] += product
    return found / total if normal and total else found


def bayes(r, C, rows=False, normal=True, combine=np.prod):
    L = combine([(C[k] if rows else C[:, k]) for k in r], axis=0)
    return L / L.sum() if normal else L


def best(x, w, W, weight=lambda w: w, matrix=lambda W: W):
    return np.array(
        [
            np.linalg.solve(np.einsum("m,mij->ij", own, matrix(W)), np.einsum("m,mij,mj->i", own, matrix(W), x))
            for own in weight(w).T
        ]
    )


WRONG = [
    (1, lambda w: pairs_of(w, allowed=lambda used: True), "may share an object"),
    (1, lambda w: pairs_of(w, none=0.0), "the matchings with none"),
    (1, lambda w: pairs_of(w, normal=False), "divide by the weight of all matchings"),
    (1, lambda w: w, "no probabilities"),
    (1, lambda w: w / w.sum(axis=1, keepdims=True), "its own sum"),
    (1, lambda w: pairs_of(w).T, "rows and columns are exchanged"),
    (1, lambda w: np.full(w.shape, 0.5), "your table"),
    (1, lambda w: 0.5, "shape"),
    (2, lambda r, C: bayes(r, C, rows=True), "exchanged"),
    (2, lambda r, C: bayes(r, C, combine=np.mean), "multiply"),
    (2, lambda r, C: bayes(r, C, normal=False), "divide by the sum"),
    (2, lambda r, C: np.bincount(r, minlength=len(C)) / len(r), "shares of votes"),
    (2, lambda r, C: bayes(r[-1:], C), "only the last report"),
    (2, lambda r, C: bayes(r[:1], C), "only the first report"),
    (2, lambda r, C: bayes(sorted(set(r)), C), "counts once"),
    (2, lambda r, C: np.full(len(C), 1 / len(C)), "your posterior"),
    (3, lambda p, L: 2 * np.log(p @ L / L.mean()), "the sign"),
    (3, lambda p, L: -np.log(p @ L / L.mean()), "the 2 is missing"),
    (3, lambda p, L: -2 * np.log(p @ L), "its mean over the classes"),
    (3, lambda p, L: -2 * np.log(p @ L / L.max()), "the best class"),
    (3, lambda p, L: -2 * np.log(p @ L / L.sum()), "the sum over the classes"),
    (3, lambda p, L: -2 * np.log10(p @ L / L.mean()), "base 10"),
    (3, lambda p, L: p @ L / L.mean(), "the ratio itself"),
    (3, lambda p, L: -2 * np.log(L[np.argmax(p)] / L.mean()), "only the most probable class"),
    (3, lambda p, L: 0.0, "your distance"),
    (4, lambda x, w, W: best(x, w, W, matrix=lambda W: 0 * W + np.eye(2)), "information matrices are not used"),
    (4, lambda x, w, W: best(x, w, W, matrix=np.linalg.inv), "counts more, not less"),
    (4, lambda x, w, W: best(x, w, W, matrix=lambda W: W * np.eye(2)), "only the diagonals"),
    (4, lambda x, w, W: best(x, w, W, weight=np.square), "squared"),
    (4, lambda x, w, W: best(x, w, W, weight=np.ones_like), "the weights are not used"),
    (4, lambda x, w, W: np.einsum("mk,mij,mj->ki", w, W, x), "not solved"),
    (4, lambda x, w, W: x[w.argmax(axis=0)], "most probable observation"),
    (4, lambda x, w, W: np.zeros((w.shape[1], 2)), "your places"),
]


@pytest.mark.parametrize(("number", "mistake", "message"), WRONG)
def test_usual_mistakes_are_named(number, mistake, message):
    assert_names_the_mistake(CHECKS[number], mistake, message)


def test_other_right_ways_are_right():
    def in_logarithms(reports, confusion):
        total = np.log(confusion[:, reports]).sum(axis=1)
        return (np.exp(total - total.max()) / np.exp(total - total.max()).sum()).tolist()

    def from_the_library(belief, likelihood):
        seen = log_likelihoods(None, len(belief), (likelihood / likelihood.sum())[None])
        return class_distances(seen, np.log(belief)[None])[0, 0]

    assert checks.check_pair_probabilities(matching_probabilities).passed
    assert checks.check_pair_probabilities(pairs_of).passed
    assert checks.check_true_class(in_logarithms).passed
    assert checks.check_class_distance(from_the_library).passed
    assert checks.check_m_step(best).passed


# --- pictures --------------------------------------------------------------------------------------------------------


@pytest.fixture
def ax():
    return plotting.new_figure(size=(9, 5))[1]


def test_pairs_are_drawn_as_wide_as_they_are_probable(ax):
    probability = np.array([[0.25, 0.5], [0.0, 1.0]])
    pictures.plot_pairs(ax, np.array([[0.0, 1.0], [1.0, 1.0]]), np.array([[0.0, 0.0], [1.0, 0.0]]), probability, "t")
    assert [line.get_linewidth() for line in ax.lines[:4]] == [2.0, 4.0, 0.0, 8.0]
    assert {"0.25", "0.50", "0.00", "1.00"} <= {text.get_text() for text in ax.texts}
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("x (m)", "y (m)")
    assert ax.get_title() == "t: obs 1 of chair 2, obs 2 of chair 2"


def test_beliefs_and_em_are_drawn_as_given(ax):
    beliefs = np.array([[0.5, 0.5], [0.9, 0.1]])
    pictures.plot_beliefs(ax, beliefs, ("cup", "book"), "t")
    np.testing.assert_array_equal([line.get_ydata() for line in ax.lines], beliefs.T)
    assert ax.get_title() == "t: cup 0.900"
    other = plotting.new_figure()[1]
    pictures.plot_em(other, [np.array([1.0, 2.0]), np.array([0.5, 2.5])], np.array([0.4, 2.6]), "t")
    moved = [line for line in other.lines if len(line.get_ydata()) == 2 and line.get_marker() != "None"]
    np.testing.assert_array_equal([line.get_xdata() for line in moved], [[1.0, 0.5], [2.0, 2.5]])
    assert other.get_title() == "t: 0.50 and 2.50 m at the end"


@pytest.mark.parametrize("quantity", pictures.QUANTITIES)
def test_runs_are_medians_of_the_table(ax, quantity):
    pictures.plot_runs(ax, quantity, ("np-graph", "soft-em"))
    for container, case in zip(ax.containers, ("np-graph", "soft-em"), strict=True):
        expected = [np.median(table.column(quantity, case, share)) for share in SHARES]
        np.testing.assert_allclose(container[0].get_ydata(), expected)
        assert container.get_label() == case
    ends = [np.median(table.column(quantity, case, SHARES[-1])) for case in ("np-graph", "soft-em")]
    assert ax.get_title() == f"50% wrong: np-graph {ends[0]:.2g}, soft-em {ends[1]:.2g}"


def test_marks_of_one_value_stand_side_by_side(ax):
    cases = ("np-graph", "ekf hard", "ekf", "soft-em", "posterior")
    pictures.plot_runs(ax, "objects", cases)
    ax.figure.canvas.draw()
    places = np.sort(np.concatenate([ax.transData.transform(each[0].get_xydata())[:, 0] for each in ax.containers]))
    assert len(places) == len(cases) * len(SHARES)
    widest = max(each[0].get_markersize() for each in ax.containers) * ax.figure.dpi / 72
    assert np.diff(places).min() > widest


def test_what_is_left_of_the_gate_is_drawn():
    figure = pictures.gates_figure({0.3: np.array([3.4, 2.7]), 0.01: np.array([3.5, 0.7])})
    (ax,) = figure.axes
    np.testing.assert_allclose([bar.get_height() for bar in ax.patches], [3.4, 3.5, 2.7, 0.7])
    assert ax.get_title() == "a wrong report leaves a gate of 2.7 and 0.7 st. deviations"
    assert_readable(figure)


def test_gaps_have_a_mark_a_run_and_their_mean():
    figure = pictures.gaps_figure({"sum": [0.25, 0.29], "max": [0.3, 0.32]}, true=0.3)
    truth, *lines = figure.axes[0].lines
    assert set(truth.get_xdata()) == {0.3}
    assert [float(np.mean(line.get_xdata())) for line in lines] == pytest.approx([0.27, 0.27, 0.31, 0.31])
    assert figure.axes[0].get_title() == "the gap is off by: sum -3.0 cm, max +1.0 cm"
    assert_readable(figure)


def test_rooms_with_the_right_number_are_those_of_the_table():
    figure = pictures.too_sure_figure()
    for line, case in zip(figure.axes[0].lines, ("soft-em", "overconfident"), strict=True):
        right = [np.sum(table.column("objects", case, share) == 15) for share in SHARES]
        np.testing.assert_array_equal(line.get_ydata(), right)
    assert_readable(figure)


def test_every_case_has_a_look_of_its_own():
    looks = [(look.get("color"), str(look.get("linestyle")), look.get("marker")) for look in pictures.LOOKS.values()]
    assert len(set(looks)) == len(looks)


@pytest.fixture(scope="module")
def results():
    return soft_explorer.results_of(1, (0.0, 0.3))


def test_the_explorer_tells_the_truth(results):
    explorer = soft_explorer.explore_confusion(1, results)
    truth = room(1, 0.0)[1]
    for (method, share), snapshots in results.items():
        for number in (1, len(snapshots)):
            words = explorer.move(method=method, share=share, round=number)
            last = snapshots[number - 1]
            assert f"round {number}: {last.num_objects} objects" in words and f"{100 * share:.0f} %" in words
            error = float(re.search(r"error ([\d.]+) m", words)[1])
            assert error == pytest.approx(distances_to_truth(last, truth)[0].mean(), abs=0.005)
    last = explorer.sliders["round"].max
    assert f"it ended after {len(results['NP-graph', 0.3])}" in explorer.move(method="NP-graph", round=last)


def test_the_figure_can_be_read():
    (entry,) = figures.FIGURES
    figure = entry.draw()
    assert_readable(figure)
    left, right = (int(re.search(r"(\d+) objects", ax.get_title())[1]) for ax in figure.axes[:2])
    assert right == 15 and left > 60
