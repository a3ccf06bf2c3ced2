"""Several maps side by side or one after another."""

import io
import itertools
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from pictures import METHODS, kabsch, legend_texts, lines_like, offsets, panels, parsed, scatters, titles
from PIL import Image

from npslam_teach import plotting
from npslam_teach.types import GroundTruth, RobotLog, World


def test_iterations_side_by_side(scene, runs):
    (log, truth), snapshots = scene, runs["np-graph"]
    figure = plotting.plot_iterations(iter(snapshots), log, truth)
    counts = [snapshot.num_objects for snapshot in snapshots]
    names = ["frame by frame"] + [f"iteration {k}" for k in range(1, len(snapshots))]
    assert titles(figure) == [f"{name}\n{count} objects" for name, count in zip(names, counts, strict=True)]
    for ax, snapshot in zip(panels(figure), snapshots, strict=True):
        assert len(offsets(scatters(ax, hollow=False))) == snapshot.num_objects
        assert ax.get_aspect() == 1.0
    assert len({(ax.get_xlim(), ax.get_ylim()) for ax in panels(figure)}) == 1
    assert legend_texts(figure) == [*truth.world.class_names, "estimated path", "true path", "true object"]


def test_many_iterations_leave_out_the_middle_and_keep_the_last(scene, runs):
    log, snapshot = scene[0], runs["np-graph"][-1]
    figure = plotting.plot_iterations([replace(snapshot, iteration=k) for k in range(10)], log)
    assert [title.split("\n")[0] for title in titles(figure)] == [
        "frame by frame",
        *(f"iteration {k}" for k in (1, 2, 3, 4, 9)),
    ]


@pytest.mark.parametrize("count", [1, 2, 3, 4, 5, 6])
def test_the_outer_panels_carry_labels_and_numbers(scene, runs, count):
    log, snapshot = scene[0], runs["np-graph"][-1]
    figure = plotting.plot_iterations([snapshot] * count, log)
    figure.draw_without_rendering()
    boxes = {ax: ax.get_window_extent() for ax in panels(figure)}
    assert len(boxes) == count
    for ax, box in boxes.items():
        below = any(np.isclose(b.x0, box.x0, atol=2) and b.y1 <= box.y0 for b in boxes.values())
        left = any(np.isclose(b.y0, box.y0, atol=2) and b.x1 <= box.x0 for b in boxes.values())
        assert ax.get_xlabel() == ("" if below else "x (m)")
        assert ax.get_ylabel() == ("" if left else "y (m)")
        assert any(label.get_visible() for label in ax.get_xticklabels()) == (not below)
        assert any(label.get_visible() for label in ax.get_yticklabels()) == (not left)


def test_methods_side_by_side(scene, last):
    (log, truth), names = scene, scene[1].world.class_names
    figure = plotting.plot_methods(last, log, truth, names)
    assert titles(figure) == [f"{name}: {snapshot.num_objects} objects" for name, snapshot in last.items()]
    assert len({round(ax.get_position().x0, 3) for ax in panels(figure)}) == 2
    for ax, snapshot in zip(panels(figure), last.values(), strict=True):
        motion = kabsch(snapshot.graph.poses[:, :2], truth.poses[:, :2])
        drawn = lines_like(ax, dashed=False)[0].get_xydata()
        assert np.allclose(drawn, motion(snapshot.graph.poses[:, :2]), atol=1e-9)
        assert len(offsets(scatters(ax, hollow=False))) == snapshot.num_objects


def test_maps_fill_the_figure_whatever_their_shape():
    world = World([[0, 0], [12, 4]], [0, 0], ["a"])
    truth = GroundTruth(world, [[0, 0, 0], [12, 4, 0]], [0])
    log = RobotLog([[12, 4, 0]], [0], [[1, 1]], [0], 1, [0.1] * 3, [0.1] * 2)
    figure = plotting.plot_iterations(list(METHODS["np-graph"](log))[:1] * 4, log, truth)
    figure.draw_without_rendering()
    covered = sum(np.prod(ax.get_window_extent().size) for ax in panels(figure))
    assert covered > 0.35 * np.prod(figure.bbox.size)


@pytest.mark.parametrize("draw", [plotting.plot_iterations, plotting.animate])
def test_nothing_to_draw_is_an_error(scene, draw):
    with pytest.raises(ValueError, match="snapshots: expected at least one snapshot, got none"):
        draw([], scene[0])
    with pytest.raises(ValueError, match="last_snapshots: expected at least one"):
        plotting.plot_methods({}, scene[0])


@pytest.fixture(scope="module")
def gif(scene, runs):
    return plotting.animate(iter(runs["np-graph"]), *scene)


def frames(gif):
    picture = Image.open(io.BytesIO(gif))
    for k in range(picture.n_frames):
        picture.seek(k)
        yield picture.info["duration"], np.asarray(picture.convert("RGB")).astype(int)


def test_animation_has_a_frame_per_iteration_and_rests_on_the_last(gif, runs):
    durations = [duration for duration, _ in frames(gif)]
    assert durations == [1200] * (len(runs["np-graph"]) - 1) + [2500]
    assert Image.open(io.BytesIO(gif)).info["loop"] == 0  # for ever
    assert len(gif) < 400_000


def test_animation_is_the_same_on_every_run(gif, scene, runs):
    assert plotting.animate(runs["np-graph"], *scene) == gif


def test_animation_keeps_its_axes_still_while_the_estimate_moves(gif):
    pictures = [picture for _, picture in frames(gif)]

    def long_dark_lines(picture):
        dark = (picture < 60).all(axis=2)
        return [np.flatnonzero(dark.mean(axis=k) > 0.6).tolist() for k in (0, 1)]

    assert all(len(lines) == 2 for lines in long_dark_lines(pictures[0]))  # the four sides of the map
    assert all(long_dark_lines(picture) == long_dark_lines(pictures[0]) for picture in pictures)
    # The numbers on the axes stand still too: so does everything below the map.
    bottom = long_dark_lines(pictures[0])[1][1]
    assert all(np.abs(picture[bottom + 2 :] - pictures[0][bottom + 2 :]).max() <= 20 for picture in pictures)
    assert all((a != b).any() for a, b in itertools.pairwise(pictures))


def test_animation_shows_everything_in_every_frame(monkeypatch):
    log = RobotLog([[1, 0, 0]], [0, 1, 1], [[9, 0], [8, 0.1], [0, 7]], [0, 0, 0], 1, [0.1] * 3, [0.1] * 2)
    truth = GroundTruth(World([[9, 0], [1, 7], [-5, -5]], [0, 0, 0], ["a"]), [[0, 0, 0], [1, 0, 0]], [0, 0, 1])
    monkeypatch.setattr("npslam_teach.plotting.panels.gif_bytes", lambda figures, durations: figures)
    snapshots = list(METHODS["np-graph"](log))
    moved = replace(snapshots[-1], graph=replace(snapshots[-1].graph, landmarks=[[-20.0, 0.0], [1.0, 30.0]]))
    maps = [panels(figure)[0] for figure in plotting.animate([*snapshots, moved], log, truth)]
    assert len({(ax.get_xlim(), ax.get_ylim()) for ax in maps}) == 1
    for ax in maps:
        points = np.concatenate([line.get_xydata() for line in ax.lines] + [offsets(ax.collections)])
        (left, right), (bottom, top) = ax.get_xlim(), ax.get_ylim()
        assert (points > [left, bottom]).all() and (points < [right, top]).all()


def test_animation_keeps_the_colours_of_the_classes(gif):
    for _, picture in frames(gif):
        for c in range(5):
            wanted = np.rint(255 * np.array(to_rgb(plotting.class_style(c)[0])))
            close = np.abs(picture - wanted).max(axis=2) <= 12
            assert np.count_nonzero(close) > 20, c


def test_animation_in_a_notebook(gif):
    parser, media_type, data = parsed(plotting.show_animation(gif, "1185 objects become 15"))
    assert (media_type, data, parser.attributes["alt"]) == ("image/gif", gif, "1185 objects become 15")
