"""Pictures before formulas say what the formulas say: what is drawn is compared with it."""

import numpy as np
import pytest

from npslam_teach import se2, toy_objects
from npslam_teach.course import small_pictures
from npslam_teach.course.alternation.pictures import weights_figure
from npslam_teach.course.class_votes.cups import unseen_figure
from npslam_teach.course.filtering.update_pictures import CLASSES, promises_figure, update_figure
from npslam_teach.course.pose_graph import ideas
from npslam_teach.course.start_here.pictures import plot_carried
from npslam_teach.plotting.style import CLASS_COLORS, ESTIMATE_COLOR, new_figure

LABELS = ("name", "number")


def points(line) -> np.ndarray:
    return np.asarray(line.get_xydata())


def test_bars_are_as_high_as_their_numbers_and_say_them():
    (ax,) = small_pictures.bars_figure({"a": 2.0, "b": -1.5}, LABELS, "title", line=(1, "one")).axes
    assert [patch.get_height() for patch in ax.patches] == [2.0, -1.5]
    assert [text.get_text() for text in ax.texts] == ["2", "-1.5"]


@pytest.mark.parametrize("alike", [1, 5, 40])
def test_every_value_has_a_dot_of_its_own_in_its_column(alike):
    groups = {"a": [15] * alike + [21], "b": [3, 4]}
    (ax,) = small_pictures.dots_figure(groups, LABELS, "title").axes
    for k, (values, line) in enumerate(zip(groups.values(), ax.lines, strict=True)):
        xy = points(line)
        assert sorted(xy[:, 1]) == sorted(values) and len(np.unique(xy, axis=0)) == len(values)
        assert np.abs(xy[:, 0] - k).max() <= 0.5


def test_a_turn_moves_what_is_seen_by_the_angle_times_the_distance():
    turn = 1e-3
    (ax,) = ideas.lever_figure((1.0, 2.0, 5.0), turn).axes
    seen = [points(line)[0] for line in ax.lines if line.get_markersize() == 11][1::2]
    assert np.allclose([left for left, _ in seen], [-turn, -2 * turn, -5 * turn], rtol=1e-5)


def test_a_moved_map_keeps_the_distances_that_are_measured():
    poses, chair = np.array([[0.0, 0, 0], [1, 0, 1], [1, 1, 2]]), np.array([2.0, 2.0])
    turned = np.append(np.column_stack([-poses[:, 1], poses[:, 0], np.ones(3)]).ravel(), [-2.0, 2.0])
    ax, _ = ideas.gauge_figure(poses, chair, {"turned": turned, "back": -turned}, size=1e-4).axes
    rays = np.array([points(line) for line in ax.lines if line.get_linestyle() == ":"])
    lengths = np.linalg.norm(rays[:, 0] - rays[:, 1], axis=1).reshape(2, 3)
    assert np.allclose(lengths[0], lengths[1], atol=1e-6) and not np.allclose(rays[:3], rays[3:], atol=1e-6)


def test_an_object_reaches_as_far_as_the_formula_says():
    """m exp(-4 d^2) crosses alpha at the root of log(m / alpha), halved."""
    (ax,) = weights_figure((1, 3, 20), alpha=0.9).axes
    for m, line in zip((1, 3, 20), ax.lines, strict=False):
        distance, weight = points(line).T
        assert distance[weight > 0.9].max() == pytest.approx(np.sqrt(np.log(m / 0.9)) / 2, abs=0.01)


def test_a_class_without_votes_has_no_mode_below_a_prior_of_one():
    (ax,) = unseen_figure(np.array([7.0, 3.0, 0.0]), np.array([0.5, 1.0, 2.0])).axes
    mean, mode = points(ax.lines[0])[:, 1], points(ax.lines[1])[:, 1]
    assert np.allclose(mean, [0.5 / 11.5, 1 / 13, 2 / 16])
    assert np.isnan(mode[0]) and np.allclose(mode[1:], [0, 1 / 13])


@pytest.mark.parametrize("heading", np.deg2rad([0, 30, 90, 200, 300]))
def test_what_is_carried_into_the_room_is_in_the_picture(heading):
    _, ax = new_figure()
    plot_carried(ax, [1.0, 2.0, heading], [3.0, 1.0])
    x, y = se2.apply(np.array([1.0, 2.0, heading]), np.array([3.0, 1.0]))
    assert ax.get_xlim()[0] < x < ax.get_xlim()[1] and ax.get_ylim()[0] < y < ax.get_ylim()[1]


def test_a_promise_that_is_broken_has_another_sign():
    (ax,) = promises_figure({"held": (0.1, 0.1), "broken": (0.5, 0.1)}).axes
    signs = [line.get_marker() for line in ax.lines if line.get_marker() != "None"]
    assert signs == ["o", "X"] and ax.get_title() == "1 of 2 promises are broken"


def test_a_thing_has_the_colour_of_its_class_before_the_filter_too():
    assert toy_objects()[1].world.class_names == CLASSES
    names = {"robot": slice(0, 2), "chair B": slice(2, 4), "screen": slice(4, 6)}
    state = np.arange(6.0), 0.01 * np.eye(6)
    (ax,) = update_figure(state, state, names).axes
    expected = [ESTIMATE_COLOR, CLASS_COLORS[0], CLASS_COLORS[1]]
    assert [text.get_color() for text in ax.texts] == expected
    assert [line.get_color() for line in ax.lines if line.get_linestyle() == "-"] == expected
