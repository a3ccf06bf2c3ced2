"""A picture that is drawn in part is the picture that is drawn in full, pixel for pixel, for every explorer."""

import functools
import io

import numpy as np
import pytest
from PIL import Image

from npslam_teach import plotting, simulate
from npslam_teach.course.a_real_robot.explorer import explore_believed_noise, results_of_recording_0
from npslam_teach.course.alternation import false_positives_explorer
from npslam_teach.course.drift.explorer import explore_noise
from npslam_teach.course.office import explorer as office_explorer
from npslam_teach.course.pose_graph.explorer import bad_starts, explore_gauss_newton
from npslam_teach.course.what_breaks.explorer import explore_kernel, results_of
from npslam_teach.methods import METHODS
from npslam_teach.plotting.blitting import SCREEN_DPI, Redrawing


def pixels(png):
    return np.asarray(Image.open(io.BytesIO(png)).convert("RGB"))


def drawn_in_full(figure):
    stream = io.BytesIO()
    figure.savefig(stream, format="png", dpi=SCREEN_DPI)
    return pixels(stream.getvalue())


def small_room():
    """Fifteen objects on a path of 115 poses."""
    world = simulate.fifteen_objects()[1].world
    return simulate.simulate_run(world, simulate.designed_path(0.6), simulate.paper_sensor(), np.random.default_rng(3))


def explore_bad_starts():
    starts, truth = bad_starts()
    return explore_gauss_newton(starts, truth.poses[:, :2])


def explore_office():
    log, truth = small_room()
    results = {name: list(METHODS[name](log))[-1] for name in ("np-graph", "frame-by-frame")}
    return office_explorer.explore_office(results, log, truth)


@functools.cache
def room_results():
    scenes = {noise: small_room() for noise in (1, 2, 3)}
    return scenes, results_of(scenes)


def explore_widths():
    return explore_kernel(*room_results())


recording_0 = functools.cache(results_of_recording_0)


# Each explorer, and places to go that move all there is to move, hide some of it and bring it back.
EXPLORERS = {
    "drift": (explore_noise, [{"noise": 3.0}, {"noise": 0.0}, {"noise": 1.0}]),
    "solver": (explore_bad_starts, [{"iteration": 3}, {"start": "thrown about"}, {"iteration": 0}]),
    "false_positives": (
        lambda: false_positives_explorer.explore_false_positives(*simulate.toy_objects()),
        [{"epsilon": value} for value in (0.2, 0.49, 0.34, 0.0, 0.6)],
    ),
    "office": (explore_office, [{"epsilon": 0.4}, {"method": "frame-by-frame"}, {"epsilon": 0.02}]),
    "kernel": (explore_widths, [{"noise": 2}, {"kernel_std": 0.5}, {"noise": 3}, {"kernel_std": 0.15}]),
    "believed noise": (
        lambda: explore_believed_noise(recording_0()),
        [{"power": 2}, {"method": "ekf"}, {"power": -2}, {"method": "posterior"}],
    ),
}


@pytest.mark.parametrize("name", EXPLORERS)
def test_every_explorer_shows_what_drawing_everything_shows(name):
    make, moves = EXPLORERS[name]
    explorer, other = make(), make()  # a full drawing of the first would tell it what moved
    different = set()
    for move in [{}, *moves]:
        explorer.move(**move)
        other.move(**move)
        picture = explorer._drawing.png()
        np.testing.assert_array_equal(pixels(picture), drawn_in_full(other.figure))
        different.add(picture)
    assert len(different) >= 3


@pytest.fixture
def scene():
    figure, (left, right) = plotting.new_figure(1, 2, (8.0, 3.0))
    left.plot([0, 1], [0, 1], color="0.5", zorder=1)
    (line,) = left.plot([0, 1], [1, 0], label="a line", linewidth=5)
    left.scatter([0.5], [0.5], s=900, color="k", zorder=3)  # lies over the line
    left.legend(loc="upper right")
    right.plot([0, 1], [0, 1])
    return figure, left, right, line


def check(drawing, figure):
    picture = pixels(drawing.png())
    np.testing.assert_array_equal(picture, drawn_in_full(figure))
    return picture


def test_what_lies_over_a_drawn_artist_stays_over_it(scene):
    figure, _, _, line = scene
    drawing = Redrawing(figure)
    before = check(drawing, figure)
    line.set_ydata([0.5, 0.5])
    after = check(drawing, figure)
    assert (before != after).any()


def test_only_what_moves_and_what_lies_over_it_is_drawn_again(scene):
    figure, left, right, line = scene
    drawing = Redrawing(figure)
    drawing.png()
    line.set_ydata([0.5, 0.5])
    drawing.png()
    assert line in drawing._drawn and left.collections[0] in drawing._drawn and left.get_legend() in drawing._drawn
    assert left.lines[0] not in drawing._drawn and left.xaxis not in drawing._drawn
    assert not set(right.get_children()) & set(drawing._drawn)


def test_artists_may_come_and_go(scene):
    figure, left, right, line = scene
    drawing = Redrawing(figure)
    pictures = [check(drawing, figure)]
    text = right.text(0.2, 0.8, "new")
    pictures.append(check(drawing, figure))
    line.set_visible(False)
    pictures.append(check(drawing, figure))
    text.remove()
    left.lines[0].remove()  # never moved
    pictures.append(check(drawing, figure))
    line.set_visible(True)
    pictures.append(check(drawing, figure))
    for before, after in zip(pictures, pictures[1:], strict=False):
        assert (before != after).any()


def test_titles_and_texts_of_the_figure_follow_too(scene):
    figure, left, _, line = scene
    note = figure.text(0.5, 0.5, "a note", fontsize=20)
    drawing = Redrawing(figure)
    drawing.png()
    left.set_title("another")
    check(drawing, figure)
    note.set_text("a longer note")
    line.set_ydata([0.4, 0.6])
    check(drawing, figure)


def test_a_file_in_between_changes_nothing(scene):
    figure, _, _, line = scene
    drawing = Redrawing(figure)
    drawing.png()
    line.set_ydata([0.4, 0.6])
    before = drawing.png()
    file = plotting.export.png_bytes(figure)
    assert drawing.png() == before
    line.set_ydata([0.1, 0.2])
    assert plotting.export.png_bytes(figure) != file  # what moves is in the file
    check(drawing, figure)
