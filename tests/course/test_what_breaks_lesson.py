"""Lesson 10: its pictures show the table, its slider tells the truth, its checks know the usual mistakes."""

import re

import numpy as np
import pytest
from exercises import assert_names_the_mistake, checks_and_solutions
from readable import assert_readable

from npslam_teach import evaluation, plotting, se2, simulate
from npslam_teach.association import PAPER_ALPHA, PAPER_KERNEL_STD, association_probabilities, decide
from npslam_teach.course.what_breaks import checks, figures, passes, pictures, table
from npslam_teach.course.what_breaks import explorer as what_breaks_explorer
from npslam_teach.methods import np_graph, settings_for
from npslam_teach.methods.tracklets import tied_both_ways
from npslam_teach.pose_graph import fit, marginal_covariance

# --- exercises -------------------------------------------------------------------------------------------------------

CHECKS, solution = checks_and_solutions("10_what_breaks")


def wald(k, n, z):
    return k / n + np.array([-z, z]) * np.sqrt(k / n * (1 - k / n) / n)


def ends(k, n, z, middle=None, root=None, under=None):
    p, c = k / n, z * z / n
    middle = p + c / 2 if middle is None else middle
    half = z * np.sqrt(p * (1 - p) / n + c / 4 / n) if root is None else root
    return (middle - half) / (under or 1 + c), (middle + half) / (under or 1 + c)


def apart(xy, S, i, j, a=1, b=1, solve=np.linalg.solve, root=np.sqrt):
    at, to = [2 * i, 2 * i + 1], [2 * j, 2 * j + 1]
    C = S[np.ix_(at, at)] + S[np.ix_(to, to)] - a * S[np.ix_(at, to)] - b * S[np.ix_(to, at)]
    d = xy[j] - xy[i]
    return root(d @ solve(C, d))


WRONG = [
    (1, wald, "at 30 of 30 it has no width"),
    (1, lambda k, n, z: ends(k, n, z, middle=k / n), "the middle is the share itself"),
    (1, lambda k, n, z: ends(k, n, z, root=z * np.sqrt(k / n * (1 - k / n) / n)), "missing under the root"),
    (1, lambda k, n, z: ends(k, n, z, under=1), "division by 1 + z^2 / n"),
    (1, lambda k, n, z: ends(k, n, z)[::-1], "low, then high"),
    (1, lambda k, n, z: n * np.array(ends(k, n, z)), "these are counts"),
    (1, lambda k, n, z: ends(k, n, z, root=z * (k / n * (1 - k / n) / n + z * z / 4 / n**2)), "the root is missing"),
    (1, lambda k, n, z: (0.0, 1.0), "your interval should be"),
    (1, lambda k, n, z: k / n, "shape (2,), yours has ()"),
    (2, lambda n, a, s: 2 * s**2 * np.log(n / a), "take the root"),
    (2, lambda n, a, s: s * np.sqrt(np.log(n / a)), "the 2 of the kernel's exponent"),
    (2, lambda n, a, s: np.sqrt(2 * np.log(n / a)), "width is missing"),
    (2, lambda n, a, s: s * np.sqrt(2 * abs(np.log(n * a))) * np.sign(np.log(n * a)), "divide by it"),
    (2, lambda n, a, s: s * np.sqrt(2 * np.log10(n / a)), "base 10"),
    (2, lambda n, a, s: s * np.sqrt(2 * np.log(1 / a)), "votes are left out"),
    (2, lambda n, a, s: s * np.sqrt(2 * np.log(n)), "alpha is left out"),
    (2, lambda n, a, s: np.sqrt(2 * s * np.log(n / a)), "outside the root"),
    (2, lambda n, a, s: s, "your distance should be"),
    (3, lambda own, paper, kernel: kernel * paper / own, "upside down"),
    (3, lambda own, paper, kernel: kernel * own**2 / paper**2, "with the square"),
    (3, lambda own, paper, kernel: kernel, "as it was"),
    (3, lambda own, paper, kernel: own + kernel - paper, "multiply"),
    (3, lambda own, paper, kernel: own / paper, "the ratio alone"),
    (3, lambda own, paper, kernel: own * kernel, "divide by the paper's noise"),
    (3, lambda own, paper, kernel: kernel * (own / paper) ** 0.5, "root of the ratio"),
    (3, lambda own, paper, kernel: 2 * own, "your kernel should be"),
    (4, lambda *a: apart(*a, 0, 0), "what the two passes share is left out"),
    (4, lambda *a: apart(*a, -1, -1), "the shared blocks are added"),
    (4, lambda *a: apart(*a, 0.5, 0.5), "counts twice"),
    (4, lambda *a: apart(*a, root=np.square) ** 0.5, "the squared distance"),
    (4, lambda xy, S, i, j: np.hypot(*(xy[i] - xy[j])), "in metres"),
    (4, lambda *a: apart(*a, solve=np.matmul), "multiplied, not divided"),
    (4, lambda *a: apart(*a, solve=lambda C, d: d / np.diag(C)), "only the diagonal"),
    (4, lambda *a: 2 * apart(*a), "your distance should be"),
]


@pytest.mark.parametrize(("number", "mistake", "message"), WRONG)
def test_usual_mistakes_are_named(number, mistake, message):
    assert_names_the_mistake(CHECKS[number], mistake, message)


def test_other_right_ways_are_right():
    def roots(k, n, z):
        c = z * z / n
        return np.sort(np.roots([1 + c, -(2 * k / n + c), (k / n) ** 2]).real)

    def by_a_matrix(xy, S, i, j):
        E = np.zeros((2, len(S)))
        E[:, 2 * i : 2 * i + 2] += np.eye(2)
        E[:, 2 * j : 2 * j + 2] -= np.eye(2)
        d = E @ xy.ravel()
        return (d @ np.linalg.inv(E @ S @ E.T) @ d) ** 0.5

    assert checks.check_wilson(roots).passed
    assert checks.check_reach(passes.reach).passed
    assert checks.check_pass_distance(by_a_matrix).passed
    assert checks.check_pass_distance(apart).passed


def test_the_solutions_are_what_the_library_does():
    for k, n in ((0, 7), (26, 30), (30, 30)):
        np.testing.assert_allclose(solution(1)(k, n, 1.959964), evaluation.wilson_interval(k, n), atol=1e-6)
    for noise in (0.0, 1.0, 3.0):
        log, _ = simulate.fifteen_objects(noise=noise)
        own = solution(3)(log.observation_std[0], np.hypot(0.1, 0.1), PAPER_KERNEL_STD)
        assert own == pytest.approx(settings_for(log)["kernel_std"])


@pytest.mark.parametrize("votes", [1.0, 3.0, 40.0])
def test_within_reach_it_joins_and_beyond_it_does_not(votes):
    radius = passes.reach(votes, PAPER_ALPHA, PAPER_KERNEL_STD)
    for distance, answer in ((0.999 * radius, 0), (1.001 * radius, 1)):
        assert decide(association_probabilities(np.array([votes]), np.array([distance]))) == answer
    assert passes.reach(0.5, PAPER_ALPHA, PAPER_KERNEL_STD) == 0.0


# --- the table and its pictures --------------------------------------------------------------------------------------


@pytest.fixture
def ax():
    return plotting.new_figure(size=(9, 5))[1]


def test_shares_are_counts_of_rows():
    rows = [row for row in table.load() if row["case"] == "np-graph" and row["noise"] == 2.0]
    right = [row["objects"] == 15 and row["ari"] >= 0.99 for row in sorted(rows, key=lambda row: row["seed"])]
    np.testing.assert_array_equal(table.right_of("np-graph", 2.0), right)
    successes, runs, low, high = table.share_of("np-graph", 2.0)
    assert (successes, runs) == (sum(right), 30)
    np.testing.assert_allclose((low, high), evaluation.wilson_interval(successes, runs))


def test_what_is_left_out_counts_only_when_asked_to():
    strict, lenient = (table.right_of("ekf", 1.0, of_used) for of_used in (False, True))
    assert (lenient >= strict).all() and lenient.sum() > strict.sum()
    for noise in (1.0, 3.0):
        assert table.share_of("np-graph", noise, True) == table.share_of("np-graph", noise)


@pytest.mark.parametrize("setting", ["alpha", "threshold", "kernel_std"])
def test_a_sweep_holds_the_papers_value_in_its_place(setting):
    values = table.swept(setting)
    numbers = [-1.0 if value is None else value for value in values]
    assert numbers == sorted(numbers) and len(values) >= 5
    assert [case for case in values.values() if case == "np-graph"] == ["np-graph"]
    assert all(len(table.runs_of(case, 2.0)) == 30 for case in values.values())


def test_success_has_a_curve_and_a_band_for_each(ax):
    cases = {"a": "np-graph", "b": "ekf"}
    pictures.plot_success(ax, cases, of_used=("b",))
    for (name, case), line, band in zip(cases.items(), ax.lines, ax.collections, strict=True):
        shares = [table.share_of(case, noise, name == "b") for noise in table.noises_of(case)]
        np.testing.assert_allclose(line.get_ydata(), [right / runs for right, runs, *_ in shares])
        edges = band.get_paths()[0].vertices
        for noise, (_, _, low, high) in zip(table.noises_of(case), shares, strict=True):
            own = edges[edges[:, 0] == noise, 1]
            assert own.min() == pytest.approx(low) and own.max() == pytest.approx(high)
    assert [text.get_text() for text in ax.get_legend().get_texts()] == list(cases)
    assert_readable(ax.figure)


@pytest.mark.parametrize("setting", ["alpha", "threshold", "kernel_std"])
def test_a_setting_has_a_curve_a_noise_and_its_intervals(ax, setting):
    pictures.plot_setting(ax, setting)
    noises = (1.0, 2.0, 3.0, 4.0) if setting == "kernel_std" else (1.0, 2.0, 3.0)
    assert len(ax.containers) == len(noises)
    for noise, (points, _, (bars,)) in zip(noises, ax.containers, strict=True):
        shares = [table.share_of(case, noise) for case in table.swept(setting).values()]
        np.testing.assert_allclose(points.get_ydata(), [right / runs for right, runs, *_ in shares])
        np.testing.assert_allclose([bar[:, 1] for bar in bars.get_segments()], [each[2:] for each in shares])
    assert len({container[0].get_color() for container in ax.containers}) == len(noises)
    assert_readable(ax.figure)


def test_the_table_of_shares_says_what_the_table_says():
    figure, ax = plotting.new_figure(size=(9.5, 7))
    pictures.plot_shares(ax, pictures.CAUSES, (1.0, 4.0))
    assert len(ax.texts) == 2 * len(pictures.CAUSES)
    for text in ax.texts:
        column, row = map(int, text.get_position())
        right, runs, low, high = table.share_of(list(pictures.CAUSES.values())[row], (1.0, 4.0)[column])
        assert text.get_text() == f"{right} of {runs}\n{100 * low:.0f} to {100 * high:.0f} %"
    assert [label.get_text() for label in ax.get_yticklabels()] == list(pictures.CAUSES)
    assert_readable(figure)


def test_titles_say_what_the_table_says(ax):
    pictures.plot_success(ax, {"a": "np-graph", "b": "ekf"}, of_used=("b",))
    own, others = (table.share_of(case, 3.0, of_used)[0] for case, of_used in (("np-graph", False), ("ekf", True)))
    assert ax.get_title() == f"right at noise 3, of 30 rooms: a: {own}; b: {others}"
    other = plotting.new_figure()[1]
    pictures.plot_setting(other, "kernel_std")
    best = max(table.share_of(case, 3.0)[0] for case in table.swept("kernel_std").values())
    assert other.get_title() == f"noise 3: at best {best} of 30 rooms"


def test_one_curve_alone_is_not_shifted(ax):
    pictures.plot_setting(ax, "kernel_std", chosen=1.0)
    np.testing.assert_array_equal(ax.lines[0].get_xdata(), np.arange(len(table.swept("kernel_std"))))


def test_an_interval_runs_where_wilson_says(ax):
    pictures.plot_interval(ax, (0, 26, 30), 30)
    for count, line in zip((0, 26, 30), ax.lines[1:], strict=True):
        np.testing.assert_allclose(line.get_xdata(), evaluation.wilson_interval(count, 30))
        assert set(line.get_ydata()) == {count}
    assert ax.get_title() == "30 of 30 right: the true share may be as low as 0.89"
    assert_readable(ax.figure)


def test_half_a_metre_is_two_distances():
    figure, axes = plotting.new_figure(1, 2, (12, 3.6))
    cov = 0.0025 * np.eye(3) + 0.1 * np.outer([0, 1, 1], [0, 1, 1])
    pictures.plot_half_metres(axes, np.array([2.0, 2.5, 3.0]), cov)
    spans = [np.ptp(bar[:, 0]) / 2 for bar in axes[1].containers[0][2][0].get_segments()]
    np.testing.assert_allclose(spans, np.sqrt([0.105, 0.005]))
    assert axes[1].get_title() == "from one chair: 1.5 and 7.1 st. deviations"
    assert_readable(figure)


def test_the_room_to_show_is_ringed(ax):
    pictures.plot_room_to_show(ax, [15, 21, 18], [0.3, 0.1, 0.2])
    ring = ax.lines[-1]
    assert (ring.get_xdata()[0], ring.get_ydata()[0]) == (21, 0.1)
    assert ax.get_legend().get_texts()[-1].get_text() == "the room to show"


def test_figure_21_shows_passes_at_three_noises_and_one_kernel():
    figure = figures.drift_figure()
    spans = []
    for ax, noise in zip(figure.axes, figures.NOISES, strict=True):
        (ring,) = ax.patches
        assert ring.get_radius() == PAPER_KERNEL_STD
        assert len(ax.lines) == 15 and ax.get_title() == f"noise {noise}"
        lengths = [np.ptp(line.get_xydata(), axis=0).max() for line in ax.lines]
        assert all(len(line.get_xdata()) >= 2 for line in ax.lines)
        spans.append(np.median(lengths))
        low, high = ax.get_xlim()
        assert all(low < x < high for line in ax.lines for x in line.get_xdata())
    assert spans[0] < spans[1] < spans[2] and spans[0] > 2 * PAPER_KERNEL_STD
    assert_readable(figure)
    (entry,) = figures.FIGURES
    assert entry.name.startswith("fig21_") and len(entry.alt) > 60


def test_passes_are_joined_where_the_wheels_carry_them(ax):
    log, truth = simulate.fifteen_objects(3)
    pictures.plot_passes(ax, log, truth, 0.35)
    xy = se2.apply(se2.dead_reckoning(log.odometry, truth.poses[0])[log.obs_time], log.obs_xy)
    seen = truth.obs_object == 4
    first = log.obs_time[seen] <= log.obs_time[seen][0] + 20
    line = ax.lines[4].get_xydata()
    np.testing.assert_allclose(line[0], xy[seen][first].mean(axis=0), atol=0.2)
    gaps = np.diff(log.obs_time[seen]) > 20
    assert len(line) == 1 + gaps.sum()


# --- passes ----------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def room():
    return simulate.fifteen_objects(1, 2.0)


def test_pairs_of_passes_are_those_of_the_dense_inverse(room):
    log, truth = room
    pairs = passes.pairs_of_passes(log, truth)
    labels = tied_both_ways(log)
    graph = fit(log, labels)
    count = len(graph.landmarks)
    from npslam_teach import linearize

    cov = np.linalg.inv(linearize(graph)[0].toarray())[-2 * count :, -2 * count :]
    own = marginal_covariance(graph, landmarks=[3])[1][0]
    np.testing.assert_allclose(cov[6:8, 6:8], own, rtol=1e-6)
    expected = []
    for i in range(count):
        for j in range(i + 1, count):
            times = [set(log.obs_time[labels == k].tolist()) for k in (i, j)]
            if log.obs_class[labels == i][0] == log.obs_class[labels == j][0] and not times[0] & times[1]:
                expected.append(apart(graph.landmarks, cov, i, j))
    np.testing.assert_allclose(pairs.deviations, expected, rtol=1e-5)
    assert pairs.same.sum() >= 15 and (~pairs.same).sum() > pairs.same.sum()


def test_pairs_are_all_drawn(ax, room):
    pairs = passes.pairs_of_passes(*room)
    pictures.plot_pairs(ax, pairs, 0.9, 3.0)
    far, beyond = (np.sum(pairs.same & (d > limit)) for d, limit in ((pairs.metres, 0.9), (pairs.deviations, 3.0)))
    assert ax.get_title() == f"of {pairs.same.sum()} true pairs the kernel turns away {far}, the gate {beyond}"
    others, same = ax.lines[:2]
    assert len(same.get_xdata()) == pairs.same.sum() and len(others.get_xdata()) == (~pairs.same).sum()
    assert set(ax.lines[2].get_xdata()) == {0.9} and set(ax.lines[3].get_ydata()) == {3.0}
    assert_readable(ax.figure)


# --- the explorer ----------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def explorer():
    world = simulate.fifteen_objects()[1].world
    path = simulate.designed_path(0.4)
    scenes = {
        noise: simulate.simulate_run(world, path, simulate.paper_sensor(noise), np.random.default_rng(1))
        for noise in (1, 2, 3)
    }
    results = what_breaks_explorer.results_of(scenes)
    return what_breaks_explorer.explore_kernel(scenes, results), scenes, results


@pytest.mark.parametrize("noise", [1, 3])
@pytest.mark.parametrize("width", list(table.swept("kernel_std")))
def test_words_and_artists_agree_with_the_table_and_the_run(explorer, noise, width):
    explorer, scenes, results = explorer
    words = explorer.move(noise=noise, kernel_std=width)
    right, runs, low, high = table.share_of(table.swept("kernel_std")[width], noise)
    last = results[noise, width]
    assert f"right in {right} of {runs} rooms" in words and f"{100 * low:.0f} to {100 * high:.0f} %" in words
    assert f"This room: {last.num_objects} objects" in words
    ari = evaluation.evaluate(last, scenes[noise][1], scenes[noise][0]).ari
    assert float(re.search(r"ARI ([-\d.]+)", words).group(1)) == pytest.approx(ari, abs=0.006)
    left, axes = explorer.figure.axes
    assert left.get_title() == f"one room: {last.num_objects} objects"
    np.testing.assert_allclose(axes.lines[-1].get_ydata(), [right / runs])
    shown = [container for container in axes.containers if container[0].get_visible()]
    assert [container.get_label() for container in shown] == [f"noise {noise:g}"]
    assert_readable(explorer.figure)


def test_the_results_are_the_methods(explorer):
    _, scenes, results = explorer
    for (noise, width), last in results.items():
        *_, again = np_graph(scenes[noise][0], kernel_std=PAPER_KERNEL_STD if width == 0.354 else width)
        np.testing.assert_array_equal(last.labels, again.labels)


# --- what the lesson claims ------------------------------------------------------------------------------------------


def shares(case, noises=(1.0, 2.0, 3.0, 4.0)):
    return [table.share_of(case, noise)[0] for noise in noises]


def test_the_method_falls_to_nothing_and_no_setting_holds_it_up():
    assert min(shares("np-graph", (0.5, 1.0))) > 20 and max(shares("np-graph", (2.5, 3.0, 4.0))) == 0
    for setting in ("alpha", "threshold", "kernel_std"):
        assert max(shares(case, (3.0,))[0] for case in table.swept(setting).values()) <= 3
    assert shares("np-graph sensor")[2] <= 3
    for noise in table.noises_of("np-graph repeated"):
        alone, both = (table.right_of(f"np-graph {kind}", noise) for kind in ("repeated", "sensor"))
        np.testing.assert_array_equal(alone, both, "one object a frame puts no room right")


def test_the_right_answer_is_a_resting_place_once_the_kernel_fits_the_camera():
    for case in ("true poses sensor", "true start sensor", "true identities"):
        assert min(shares(case)) >= 28
    assert min(shares("true poses repeated", (1.0, 2.0, 3.0))) >= 28 and shares("true poses repeated", (4.0,)) == [17]
    assert max(shares("true poses")[2:]) == 0
    assert max(shares("30 rounds sensor")[2:]) <= 3
