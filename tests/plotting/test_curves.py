"""Curves over iterations and methods."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from pictures import METHODS, is_grey, kabsch, lines_like

from npslam_teach import plotting
from npslam_teach.evaluation import evaluate
from npslam_teach.types import GroundTruth, RobotLog, World


def test_object_counts_are_written_at_their_points(ax, runs):
    snapshots = runs["np-graph"]
    assert plotting.plot_object_counts(ax, iter(snapshots), 15) is ax
    (curve,), (level,) = lines_like(ax, dashed=False), lines_like(ax, dashed=True)
    counts = [snapshot.num_objects for snapshot in snapshots]
    assert np.array_equal(curve.get_xydata(), np.column_stack([range(len(counts)), counts]))
    assert [text.get_text() for text in ax.texts] == [str(count) for count in counts]
    assert [text.xy for text in ax.texts] == list(enumerate(counts))
    assert set(level.get_ydata()) == {15} and is_grey(level.get_color())
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["true number: 15"]
    assert ax.get_yscale() == "log"
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("iteration (number)", "objects (number, log scale)")


def test_object_counts_are_written_where_they_can_be_read(ax, runs):
    plotting.plot_object_counts(ax, runs["np-graph"], 15)
    ax.figure.draw_without_rendering()
    corners = ax.transData.transform(lines_like(ax, dashed=False)[0].get_xydata())
    along = np.linspace(0, 1, 200)[:, None]
    curve = np.concatenate([a + along * (b - a) for a, b in itertools.pairwise(corners)])
    for text, corner in zip(ax.texts, corners, strict=True):
        box, frame = text.get_window_extent(), ax.get_window_extent()
        assert not ((curve > box.min) & (curve < box.max)).all(axis=1).any()
        assert (box.min > frame.min).all() and (box.max < frame.max).all()
        assert np.linalg.norm(box.min - corner) < 20  # pixels


def test_object_counts_where_the_truth_is_unknown(ax, runs):
    plotting.plot_object_counts(ax, runs["np-graph"])
    assert not lines_like(ax, dashed=True) and ax.get_legend() is None


def test_objective_per_iteration(ax, runs):
    snapshots = runs["np-graph"]
    assert plotting.plot_objective(ax, snapshots) is ax
    assert np.array_equal(ax.lines[0].get_ydata(), [snapshot.objective for snapshot in snapshots])
    assert np.array_equal(ax.lines[0].get_xdata(), [snapshot.iteration for snapshot in snapshots])
    assert ax.get_ylabel() == "objective (nats)"
    ax.figure.draw_without_rendering()
    assert all(float(tick).is_integer() for tick in ax.get_xticks())


def test_cumulative_error_of_every_method(ax, scene, last):
    log, truth = scene
    assert plotting.plot_cumulative_error(ax, last, truth) is ax
    for line, (name, snapshot) in zip(ax.lines, last.items(), strict=True):
        drawn = kabsch(snapshot.graph.poses[:, :2], truth.poses[:, :2])(snapshot.graph.poses[:, :2])
        errors = np.linalg.norm(drawn - truth.poses[:, :2], axis=1)
        assert np.allclose(line.get_ydata(), [errors[: t + 1].sum() for t in range(len(errors))])
        assert line.get_ydata()[-1] == pytest.approx(evaluate(snapshot, truth, log).cumulative_pose_error)
        assert (line.get_label(), line.get_color()) == (name, plotting.method_style(name)["color"])
        assert line.get_marker() == plotting.method_style(name)["marker"]
    assert ax.get_yscale() == "log"
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("pose t (index)", "cumulative trajectory error (m, log scale)")


@pytest.mark.parametrize("names", [("open-loop", "frame-by-frame"), ("frame-by-frame", "open-loop")])
def test_curves_that_coincide_are_both_seen(ax, scene, last, names):
    plotting.plot_cumulative_error(ax, {name: last[name] for name in names}, scene[1])
    line = {artist.get_label(): artist for artist in ax.lines}
    thin, wide = line["open-loop"], line["frame-by-frame"]
    assert np.allclose(thin.get_ydata(), wide.get_ydata())
    assert thin.get_zorder() > wide.get_zorder()
    assert wide.get_linewidth() >= 2.5 * thin.get_linewidth()
    assert thin.get_linestyle() == "--"  # the wide one shows between the dashes, too
    first_markers = {artist.get_markevery()[0] for artist in ax.lines}
    assert len(first_markers) == 2


def test_error_against_objects(ax, scene, last):
    log, truth = scene
    assert plotting.plot_error_against_objects(ax, last, truth) is ax
    level, *points = ax.lines
    assert set(level.get_xdata()) == {15} and level.get_linestyle() == "--" and is_grey(level.get_color())
    for point, (name, snapshot) in zip(points, last.items(), strict=True):
        expected = (snapshot.num_objects, evaluate(snapshot, truth, log).mean_object_error)
        assert np.allclose(point.get_xydata(), [expected])
        assert (point.get_label(), point.get_marker()) == (name, plotting.method_style(name)["marker"])
    assert ax.get_xscale() == "log" and ax.get_ylim()[0] == 0
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("objects found (number, log scale)", "mean object error (m)")


def test_a_perfect_trajectory_draws_without_complaint(ax):
    world = World([[1, 1]], [0], ["a"])
    truth = GroundTruth(world, [[0, 0, 0], [1, 0, 0], [2, 0, 0]], [0])
    log = RobotLog([[1, 0, 0], [1, 0, 0]], [0], [[1, 1]], [0], 1, [0.1] * 3, [0.1] * 2)
    exact = {"np-graph": list(METHODS["np-graph"](log))[-1]}
    plotting.plot_cumulative_error(ax, exact, truth)
    ax.figure.draw_without_rendering()
    plotting.plot_error_against_objects(plotting.new_figure()[1], exact, truth)


def test_a_method_that_used_no_observation_has_no_point(ax, scene, last):
    unused = replace(last["np-graph"], labels=np.full_like(last["np-graph"].labels, -1))
    plotting.plot_error_against_objects(ax, {"np-graph": unused}, scene[1])
    assert len(ax.lines) == 1
