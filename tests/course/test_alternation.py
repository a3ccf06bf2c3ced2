"""Lesson 06: the alternation, its pictures and explorers, and the checks of its exercises."""

import math
import re

import numpy as np
import pytest
from exercises import assert_names_the_mistake
from matplotlib.backends.backend_agg import FigureCanvasAgg
from partitions import partitions
from readable import assert_readable

from npslam_teach import evaluation, np_graph, optimize, plotting, pose_graph, se2, simulate, sweep
from npslam_teach.association import all_partitions, objective
from npslam_teach.course import moving_scene
from npslam_teach.course.alternation import checks, false_positives_explorer, pictures
from npslam_teach.course.alternation import explorer as alternation_explorer
from npslam_teach.course.alternation import figures as figures06
from npslam_teach.methods.np_graph import CONSISTENT_STD, half_steps
from npslam_teach.methods.snapshots import snapshot
from npslam_teach.plotting.maps import laid_over_truth
from npslam_teach.pose_graph import with_associations


@pytest.fixture(scope="module")
def toy():
    return simulate.toy_objects()


@pytest.fixture(scope="module")
def toy_run(toy):
    log, _ = toy
    return list(np_graph(log, alpha=0.5, odometry_std=log.odometry_std, observation_std=log.observation_std))


@pytest.fixture(scope="module")
def room():
    return simulate.fifteen_objects()


# --- the alternation -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(3))
def test_every_half_step_lowers_the_objective(seed):
    steps = half_steps(simulate.fifteen_objects(seed)[0])
    assert len(steps) % 2 == 1
    assert [step.iteration for step in steps] == list(range(len(steps)))
    assert np.diff([step.objective for step in steps]).max() < 1e-6


def test_half_steps_are_the_rounds_of_np_graph(room):
    log, _ = room
    steps = half_steps(log)
    rounds = list(np_graph(log, iterations=10, observation_std=CONSISTENT_STD))
    assert [step.num_objects for step in steps[::2]] == [snapshot.num_objects for snapshot in rounds]
    assert steps[-1].objective == pytest.approx(rounds[-1].objective)
    for sweep_step, solver_step in zip(steps[1::2], steps[2::2], strict=True):
        np.testing.assert_array_equal(sweep_step.labels, solver_step.labels)


def test_groupings_are_the_partitions_of_one_class_each():
    classes = [0, 1, 0, 0, 1]
    pure = [p for p in partitions(5) if len({(i, classes[k]) for k, i in enumerate(p)}) == max(p) + 1]
    assert sorted(all_partitions(classes)) == sorted(pure)
    assert [sum(1 for _ in all_partitions([0] * n)) for n in range(6)] == [1, 1, 2, 5, 15, 52]


def fitted(log, labels, std, poses=None):
    return snapshot(log, 0, labels, pose_graph.fit(log, labels, poses, observation_std=std), 0.5)


def test_another_start_pose_shifts_everything_and_leaves_the_fit_alone(toy):
    log, _ = toy
    labels = [0, 1, 2, 0, 1, 2, 3, 4]
    best = fitted(log, labels, (0.05, 0.05))
    assert best.objective == pytest.approx(objective(pose_graph.chi2(best.graph), best.votes, 0.5))
    assert optimize(best.graph).poses == pytest.approx(best.graph.poses, abs=1e-6)
    elsewhere = fitted(log, labels, (0.05, 0.05), best.graph.poses + [[0.1, -0.1, 0.02]])
    assert elsewhere.objective == pytest.approx(best.objective)


def test_what_the_lesson_says_of_the_toys_valleys(toy):
    log, _ = toy
    ways = list(all_partitions(log.obs_class.tolist()))
    truth, one_chair = [0, 1, 2, 0, 1, 2, 3, 4], [0, 0, 1, 0, 0, 1, 2, 3]
    for std, best in ((CONSISTENT_STD, one_chair), ((0.05, 0.05), truth)):
        numbers = [fitted(log, way, std).objective for way in ways]
        assert ways[int(np.argmin(numbers))] == best


# --- the pictures ----------------------------------------------------------------------------------------------------


def apart(ax):
    """No two names on a map overlap."""
    canvas = FigureCanvasAgg(ax.figure)
    canvas.draw()
    renderer = canvas.get_renderer()
    boxes = [text.get_window_extent(renderer) for text in ax.texts if text.get_visible()]
    for k, box in enumerate(boxes):
        assert not any(box.overlaps(other) for other in boxes[:k])


def axis_labels(ax):
    return ax.get_xlabel(), ax.get_ylabel()


def test_names_of_objects_list_their_sightings():
    assert pictures.member_names(np.array([0, 1, -1, 0, 1])) == ["Obj_1+4", "Obj_2+5"]
    assert pictures.member_names(np.array([-1, -1])) == []


def test_the_map_of_belonging_ties_each_sighting_to_its_object(toy, toy_run):
    log, truth = toy
    figure, axes = plotting.new_figure(1, 2, (13, 4.4), sharey=True)
    steps = half_steps(log, 0.5, log.observation_std, 1, log.odometry_std)
    for ax, now in zip(axes, steps[1:], strict=True):
        xy = se2.apply(now.graph.poses[log.obs_time], log.obs_xy)
        pictures.plot_belonging(ax, now, log, xy, truth, "a title")
        assert ax.get_title() == "a title"
        ties = [line for line in ax.lines if line.get_color() == pictures.TIE["color"]]
        ends = np.array([line.get_xydata() for line in ties])
        np.testing.assert_allclose(ends, np.stack([xy, now.graph.landmarks[now.labels]], axis=1))
        assert axis_labels(ax) == ("x (m)", "y (m)") and ax.get_aspect() == 1.0
    assert {text.get_text() for text in axes[0].texts} == {f"Obj_{k}" for k in range(1, 9)}
    assert {text.get_text() for text in axes[1].texts} == {"Obj_1+4", "Obj_2+5", "Obj_3+6", "Obj_7", "Obj_8"}
    assert_readable(figure)
    for ax in axes:
        apart(ax)


def test_half_steps_alternate_between_two_markers():
    figure, ax = plotting.new_figure(size=(7, 4))
    pictures.plot_half_steps(ax, [9.0, 5.0, 4.0, 3.0, 2.0])
    curve, who, where, start = ax.lines
    np.testing.assert_array_equal(curve.get_ydata(), [9, 5, 4, 3, 2])
    np.testing.assert_array_equal(who.get_xydata(), [[1, 5], [3, 3]])
    np.testing.assert_array_equal(where.get_xydata(), [[2, 4], [4, 2]])
    assert len({who.get_marker(), where.get_marker(), start.get_marker()}) == 3
    assert axis_labels(ax) == ("half-step (number)", "objective (nats)")
    assert ax.get_title() == "the objective rises in no half-step"
    assert_readable(figure)


@pytest.mark.parametrize(("values", "rises"), [([9.0, 5.0, 6.0], "1 half-step"), ([9.0, 9.5, 9.6], "2 half-steps")])
def test_half_steps_that_rise_are_counted_in_the_title(values, rises):
    ax = plotting.new_figure()[1]
    assert pictures.plot_half_steps(ax, values).get_title() == f"the objective rises in {rises}"


def test_groupings_are_ranked_and_some_are_named():
    figure, ax = plotting.new_figure()
    pictures.plot_groupings(ax, [7.0, 3.0, 5.0, 90.0], {"truth": 2, "worst": 3}, "all of them")
    assert [line.get_label() for line in ax.lines] == ["a grouping", "truth: 5.00", "worst: 90.00"]
    np.testing.assert_array_equal(ax.lines[0].get_xdata(), [3, 1, 2, 4])
    assert [line.get_xydata()[0].tolist() for line in ax.lines[1:]] == [[2.0, 5.0], [4.0, 90.0]]
    assert "nats" in ax.get_ylabel()
    assert ax.get_title() == "all of them", "the lowest has no name here"
    assert_readable(figure)
    pictures.plot_groupings(ax, [7.0, 3.0], {"worst": 0, "truth": 1}, "two")
    assert ax.get_title() == "two\nlowest: truth"


def test_split_objects_are_tied_to_their_true_place():
    log, truth = simulate.fifteen_objects(0)
    *_, last = np_graph(log, iterations=10)
    copies = evaluation.copies_of(last, truth)
    for true_object, found in copies.items():
        for k in range(last.num_objects):
            held = np.count_nonzero((last.labels == k) & (truth.obs_object == true_object))
            assert (k in found) == (held >= 5)
    figure, ax = plotting.new_figure(size=(8.5, 6.5))
    pictures.plot_split_objects(ax, last, log, truth)
    ties = [line for line in ax.lines if line.get_color() == pictures.TIE["color"]]
    assert len(ties) == sum(len(found) for found in copies.values() if len(found) > 1) > 4
    starts = np.array([line.get_xydata()[0] for line in ties])
    assert all(np.isclose(truth.world.object_xy, start).all(axis=1).any() for start in starts)
    assert ax.get_title().startswith(f"{last.num_objects} objects found")
    assert_readable(figure)


def test_the_vote_against_each_object(toy_run):
    figure, ax = plotting.new_figure()
    before = toy_run[-1]
    pictures.plot_nothing_there(ax, before.votes, pictures.member_names(before.labels), 0.45)
    np.testing.assert_allclose([bar.get_height() for bar in ax.patches], 1 / (before.votes[:, 1:].sum(axis=1) + 1))
    assert ax.lines[0].get_ydata()[0] == 0.45
    assert [text.get_text() for text in ax.get_xticklabels()] == ["Obj_1+4", "Obj_2+5", "Obj_3+6", "Obj_8", "Obj_7"]
    assert "probability" in ax.get_ylabel()
    assert_readable(figure)


def test_figure_13_shows_what_its_text_says():
    (entry,) = figures06.FIGURES
    figure = entry.draw()
    left, right = figure.axes
    heights = sorted(bar.get_height() for bar in left.patches)
    np.testing.assert_allclose(heights, [1 / 3, 1 / 3, 1 / 3, 1 / 2, 1 / 2])
    crosses = next(line for line in right.lines if line.get_marker() == "x").get_xydata()
    assert crosses.shape == (2, 2)
    np.testing.assert_allclose(sorted(crosses.tolist()), [[0.5, 1.7], [0.6, 0.2]], atol=0.05)  # the ghost, the cup
    assert right.get_title() == "3 objects remain"
    assert right.get_aspect() == 1.0
    assert "0.45" in entry.alt and len(entry.alt) > 60
    assert_readable(figure)
    apart(right)


# --- the explorers ---------------------------------------------------------------------------------------------------


def middle_of(part):
    """The middle of a circle or a polygon, px."""
    if part[0] == "circle":
        return [float(part[1]["cx"]), float(part[1]["cy"])]
    corners = np.array([each.split(",") for each in part[1]["points"].split()], dtype=float)
    return (corners.min(axis=0) + corners.max(axis=0)) / 2


def dots_of(part):
    """The points of a path of dots, px."""
    return np.array(re.findall(r"M(-?\d+),(-?\d+)h0", part[1]["d"]), dtype=float)


def test_the_alternation_player_shows_every_half_step(room):
    """Every sighting lies on its object, and every object that was seen twice has its mark."""
    log, truth = room
    explorer = alternation_explorer.explore_alternation(log, truth)
    steps = half_steps(log)
    panel = moving_scene.room_of(steps, truth, alternation_explorer.MAP)
    assert explorer.sliders["half_step"].max == len(steps) - 1
    for k, step in enumerate(steps):
        words = explorer.move(half_step=k)
        parts = explorer.scene.parts
        assert f"{step.objective:.1f}" in words
        if k % 2 or k == 0:
            assert f"{step.num_objects}" in words
        _, landmarks = laid_over_truth(step, truth)
        for c in range(log.num_classes):
            own = landmarks[step.labels[log.obs_class == c]]
            np.testing.assert_allclose(dots_of(parts[f"sightings {c}"]), panel.to_page(own), atol=0.51)
        marks = np.array([middle_of(part) for name, part in parts.items() if name.startswith("object ")])
        twice = panel.to_page(landmarks[np.bincount(step.labels) >= 2]) if k else np.zeros((0, 2))
        assert len(marks) == len(twice)
        if k:
            apart = np.linalg.norm(marks[:, None] - twice, axis=-1)
            assert apart.min(axis=0).max() < 3.0, "px; a triangle's middle is not its centre"
        assert parts["counts title"][2] == f"{step.num_objects} objects (log scale)"
        assert parts["falls title"][2] == f"objective: {step.objective:.1f} nats"
        assert float(parts["counts dot"][1]["cx"]) == float(parts["falls dot"][1]["cx"])
        title = "start" if k == 0 else ("who is who" if k % 2 else "where everything is")
        assert parts["map title"][2] == title


def test_every_part_that_glides_keeps_its_numbers(room):
    """A text glides into another one if they differ in their numbers alone: paths and sightings have as many always."""
    explorer = alternation_explorer.explore_alternation(*room)
    shapes = set()
    for k in (0, 1, 2, explorer.sliders["half_step"].max):
        explorer.move(half_step=k)
        parts = explorer.scene.parts
        texts = [parts["path"][1]["points"], *(parts[f"sightings {c}"][1]["d"] for c in range(5))]
        shapes.add(tuple(re.sub(r"-?\d+(\.\d+)?", "#", text) for text in texts))
    assert len(shapes) == 1


def test_the_words_do_not_hide_a_rise(toy):
    """A solver whose noise does not match the kernel may raise the objective, and the caption must say so."""
    log, _ = toy
    order = half_steps(log, 0.5, rounds=2)
    risen = [order[0], order[2], order[1]]
    assert f"{order[2].objective:.1f} to {order[1].objective:.1f}" in alternation_explorer.words(risen, 2)


def test_the_false_positive_slider_over_its_whole_range(toy, toy_run):
    log, truth = toy
    explorer = false_positives_explorer.explore_false_positives(log, truth)
    left, right = explorer.figure.axes
    slider = explorer.sliders["epsilon"]
    for epsilon in np.arange(slider.min, slider.max + 0.001, 0.03).round(9):
        words = explorer.move(epsilon=epsilon)
        stays = [1 / (1 + m) <= epsilon for m in toy_run[-1].votes[:, 1:].sum(axis=1)]
        assert f"{sum(stays)} of 5 objects remain" in words
        assert f"{sum(stays)} of 5" in right.get_title()
        crosses = next(line for line in right.lines if line.get_marker() == "x").get_xydata()
        assert len(crosses) == 5 - sum(stays)
        assert left.lines[0].get_ydata()[0] == epsilon
        assert [bar.get_hatch() or "" for bar in left.patches] == ["" if stay else "xx" for stay in stays]
        shown = {text.get_text() for text in right.texts if text.get_visible()}
        assert all((name in words) != (name in shown) or not name for name in ("Obj_7", "Obj_8"))
        assert [text.get_visible() for text in right.texts] == stays
        apart(right)
    assert "0.30 m" in explorer.move(epsilon=0.2)  # without objects the path is the odometry path again
    assert_readable(explorer.figure)


def test_below_one_half_the_cup_goes_with_the_ghost(toy):
    explorer = false_positives_explorer.explore_false_positives(*toy)
    assert "nothing is taken away" in explorer.move(epsilon=0.5)
    words = explorer.move(epsilon=0.49)
    assert "Obj_7" in words and "Obj_8" in words and "3 of 5 objects remain" in words


@pytest.mark.parametrize("module", [alternation_explorer, false_positives_explorer])
def test_errors_of_the_explorers_reach_the_student(module, toy, monkeypatch):
    make = (
        alternation_explorer.explore_alternation
        if module is alternation_explorer
        else false_positives_explorer.explore_false_positives
    )
    explorer = make(*toy)

    def broken(*arguments):
        raise RuntimeError("no words")

    monkeypatch.setattr(module, "words", broken)
    with pytest.raises(RuntimeError, match="no words"):
        explorer.move(**{name: each.max for name, each in explorer.sliders.items()})


# --- the checks ------------------------------------------------------------------------------------------------------


def crowds(votes, gamma=math.lgamma):
    return sum(gamma(m) for m in votes[:, 1:].ravel() if m > 0)


@pytest.mark.parametrize(
    ("wrong", "named"),
    [
        (lambda c, v, a, s: c - len(v) * math.log(a / s) - crowds(v), "chi2 is not halved"),
        (lambda c, v, a, s: c / 2 - len(v) * math.log(a) - crowds(v), "area is missing"),
        (lambda c, v, a, s: c / 2 + len(v) * math.log(a / s) - crowds(v), "sign of the alpha term"),
        (lambda c, v, a, s: c / 2 - len(v) * math.log(a / s) + crowds(v), "sign of the log Gamma term"),
        (lambda c, v, a, s: c / 2 - len(v) * math.log(a / s) - crowds(v, math.log), "not of m"),
        (lambda c, v, a, s: c / 2 - len(v) * math.log(a / s) - crowds(v, lambda m: math.lgamma(m + 1)), "log m!"),
        (lambda c, v, a, s: -(c / 2 - len(v) * math.log(a / s) - crowds(v)), "turned round"),
        (lambda c, v, a, s: c / 2 - math.log(a / s) - crowds(v), "once for every object"),
        (
            lambda c, v, a, s: c / 2 - len(v) * math.log(a / s) - sum(math.lgamma(m) for m in v.ravel() if m > 0),
            "column 0",
        ),
        (
            lambda c, v, a, s: c / 2 - len(v) * math.log(a / s) - sum(map(math.lgamma, v[:, 1:].sum(axis=1))),
            "added up first",
        ),
        (lambda c, v, a, s: c / 2 - len(v) * math.log(a / s) - sum(map(math.lgamma, v[:, 1:].ravel())), "stops with"),
    ],
)
def test_mistakes_in_the_objective(wrong, named):
    assert_names_the_mistake(checks.check_objective, wrong, named)


@pytest.mark.parametrize(
    ("wrong", "named"),
    [
        (lambda k, y, u, n: np.bincount(y[u == u[k]], minlength=n), "nothing would ever move"),
        (lambda k, y, u, n: np.bincount(np.delete(y, k), minlength=n), "only about its own class"),
        (lambda k, y, u, n: np.bincount(y, minlength=n), "every class"),
        (lambda k, y, u, n: np.bincount(y[(u == u[k]) & (y != y[k])], minlength=n), "all votes of its own object"),
        (lambda k, y, u, n: np.bincount(y[u == u[k]], minlength=n) - 1, "from every object"),
        (lambda k, y, u, n: np.bincount(y[u == u[k]], minlength=n + 1), "shape"),
    ],
)
def test_mistakes_in_the_votes(wrong, named):
    assert_names_the_mistake(checks.check_votes_of_others, wrong, named)


def one_round(log, graph, labels, alpha, std, poses=None, solve=True, answer=None):
    poses = graph.poses if poses is None else poses
    who = sweep(labels, graph.landmarks, se2.apply(poses[log.obs_time], log.obs_xy), log.obs_class, alpha)
    tied = with_associations(log, graph, who.labels, who.landmarks, std)
    new = optimize(tied) if solve else tied
    return answer(who.labels, labels, new, graph) if answer else (who.labels, new)


def variant(**changes):
    return lambda *arguments: one_round(*arguments, **changes)


@pytest.mark.parametrize(
    ("wrong", "named"),
    [
        (variant(answer=lambda new, old, solved, graph: (old, solved)), "no label has changed"),
        (variant(answer=lambda new, old, solved, graph: (new, graph)), "the graph is the old one"),
        (variant(solve=False), "the second half is missing"),
        (
            lambda log, graph, labels, alpha, std: one_round(
                log, graph, labels, alpha, std, poses=se2.dead_reckoning(log.odometry)
            ),
            "along the wheels' path",
        ),
        (variant(answer=lambda new, old, solved, graph: new), "two things"),
        (variant(answer=lambda new, old, solved, graph: (new, solved.poses)), "should be a graph"),
        (
            lambda log, graph, labels, alpha, std: one_round(log, graph, labels, alpha, (0.01, 0.01)),
            "with observation_std",
        ),
        (lambda log, graph, labels, alpha, std: one_round(log, graph, labels, 0.8, std), "the labels"),
    ],
)
def test_mistakes_in_the_alternation(wrong, named):
    assert_names_the_mistake(checks.check_one_alternation, wrong, named)


@pytest.mark.parametrize(
    ("wrong", "named"),
    [
        (lambda v, e: v[:, 0] / v.sum(axis=1) > e, "these are the objects that go"),
        (lambda v, e: v[:, 0] / v.sum(axis=1) < e, "exactly at epsilon"),
        (lambda v, e: v[:, 0] / v[:, 1:].sum(axis=1) <= e, "compared with the other votes"),
        (lambda v, e: v[:, 0] <= e, "not yet a probability"),
        (lambda v, e: v[:, 0] / v.sum() <= e, "votes of all objects"),
        (lambda v, e: v[:, 1] / v.sum(axis=1) <= e, "column 1"),
        (lambda v, e: np.ones(len(v), dtype=bool), "every object stays"),
    ],
)
def test_mistakes_in_what_is_kept(wrong, named):
    assert_names_the_mistake(checks.check_kept, wrong, named)
