"""The drawing page's pictures in the lesson: a world beside the same world without its defect."""

import numpy as np
import pytest
from pictures import lines_like, panels, titles

from npslam_teach.course.draw_your_own_world import messages, pictures
from npslam_teach.plotting.maps import laid_over_truth
from npslam_teach.simulate.hand_drawn import Drawing, drawn_run


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
