"""The drawing page's pictures in the lesson: a world beside the same world without its defect."""

import numpy as np
import pytest
from pictures import lines_like, panels, titles

from npslam_teach.course.draw_your_own_world import messages, overviews, pictures
from npslam_teach.plotting.maps import laid_over_truth
from npslam_teach.simulate import GALLERY
from npslam_teach.simulate.hand_drawn import Drawing, drawn_path, drawn_run


def solved(room, stroke, object_xy):
    """A world of chairs."""
    xy = np.array(object_xy, dtype=float)
    drawing = Drawing(np.array(stroke, dtype=float), xy, np.zeros(len(xy), dtype=int), ("chair",), room)
    return messages.solve(*drawn_run(drawing))


@pytest.fixture(scope="module")
def square():
    stroke = [[2, 2], [6, 2], [6, 6], [2, 6], [2, 2]]
    return solved([0, 0, 8, 8], stroke, [[4, 4], [7.5, 4]]), solved([0, 0, 8, 8], stroke, [[4, 4]])


def test_two_worlds_stand_side_by_side_with_one_scale_and_say_how_many_were_found(square):
    left, right = panels(pictures.pair_figure(*square, ("two", "one")))
    found = [world.snapshots[-1].num_objects for world in square]
    expected = [f"two: {found[0]} objects, 2 are there", f"one: {found[1]} objects, 1 are there"]
    assert [left.get_title(), right.get_title()] == expected
    assert left.get_xlim() == right.get_xlim() and left.get_ylim() == right.get_ylim()
    low, high = np.array([left.get_xlim(), left.get_ylim()]).T
    for world in square:
        inside = np.vstack([world.truth.world.object_xy, world.truth.poses[:, :2]])
        assert (inside > low + 0.5).all() and (inside < high - 0.5).all(), "no marker stands on the frame"


def test_a_long_room_shows_how_far_the_path_bends():
    world = solved([0, 0, 30, 6], [[1, 3], [28, 3]], [[5, 4], [15, 2], [25, 4]])
    figure = pictures.pair_figure(world, world, ("long", "long, too"))
    bend = panels(figure)[2]
    (true,), (found,) = lines_like(bend, dashed=True), lines_like(bend, dashed=False)
    assert (np.asarray(true.get_ydata()) == 0).all()
    np.testing.assert_array_equal(found.get_xdata(), world.truth.poses[:, 0])
    believed, _ = laid_over_truth(world.snapshots[-1], world.truth)
    np.testing.assert_allclose(found.get_ydata(), believed[:, 1] - world.truth.poses[:, 1])
    assert np.ptp(found.get_ydata()) > 0.05, "there is a bend to be seen"
    assert "off to the left (m)" in bend.get_ylabel() and titles(figure)[2] == "the first path, stretched sideways"


def test_the_hand_turns_more_than_the_robot_that_follows_it():
    rng = np.random.default_rng(3)
    drawn = np.column_stack([np.linspace(1, 6, 251), 4 + 0.02 * rng.normal(size=251)])
    path = drawn_path(drawn)
    (ax,) = panels(pictures.headings_figure(drawn, path))
    by_hand, robot = (np.asarray(line.get_ydata()) for line in ax.lines)
    np.testing.assert_allclose(np.tan(np.deg2rad(by_hand)), np.diff(drawn[:, 1]) / np.diff(drawn[:, 0]))
    np.testing.assert_array_equal(robot, np.rad2deg(path[:, 2]))
    turns = [f"{np.std(np.diff(each)):.0f}" for each in (by_hand, robot)]
    assert f"{turns[0]} degrees" in ax.get_title() and ax.get_title().endswith(f"the robot by {turns[1]}")


def test_the_gallery_shows_all_its_worlds_and_what_makes_them_differ():
    maps = {ax.get_title(): ax for ax in panels(overviews.gallery_figure(GALLERY)) if ax.get_title()}
    assert list(GALLERY) == list(overviews.ASSUMPTIONS)
    arrows = {title for title, ax in maps.items() if any(text.arrow_patch for text in ax.texts)}
    assert arrows == {overviews.ASSUMPTIONS["moving"]}
    for key, says in overviews.ASSUMPTIONS.items():
        drawing, ax = GALLERY[key].drawing, maps[says]
        drawn = np.concatenate([np.asarray(each.get_offsets()) for each in ax.collections])
        assert sorted(map(tuple, drawn)) == sorted(map(tuple, drawing.object_xy))
        assert ax.get_xlim() == tuple(drawing.room[[0, 2]])
        is_noisy = len(ax.lines) > 10
        assert is_noisy == (drawing.clutter_rate > 0), "pale markers for false sightings alone"


def test_where_most_runs_are_right_and_how_many_drives_are():
    (ax,) = overviews.gaps_figure({0.6: [15, 15, 15], 1.0: [15, 16, 20], 1.4: [16, 16, 18]}, 16).axes
    assert ax.get_title() == "they begin to come apart at 1 m, most runs are right from 1.4 m on"
    (ax,) = overviews.drives_figure([15, 18, 15], 15).axes
    assert ax.get_title() == "one drawing, 3 drives: exactly 15 found in 2"
    assert [line.get_ydata()[0] for line in ax.lines[:3]] == [15, 18, 15]
