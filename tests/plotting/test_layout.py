"""Every kind of figure: nothing cut off, nothing on top of anything, everything named."""

import io
import itertools
import subprocess
import sys

import numpy as np
import pytest
from matplotlib.legend import Legend
from pictures import lines_like, on_axes, panels, parsed, scatters
from PIL import Image

from npslam_teach import plotting

FIGURES = {
    "truth": lambda log, truth, runs, last: on_axes(plotting.plot_truth, truth),
    "start": lambda log, truth, runs, last: on_axes(plotting.plot_snapshot, runs["np-graph"][0], log, truth),
    "end": lambda log, truth, runs, last: on_axes(plotting.plot_snapshot, last["np-graph"], log, truth),
    "iterations": lambda log, truth, runs, last: plotting.plot_iterations(runs["np-graph"], log, truth),
    "four": lambda log, truth, runs, last: plotting.plot_iterations(runs["np-graph"][:4], log, truth),
    "methods": lambda log, truth, runs, last: plotting.plot_methods(last, log, truth),
    "counts": lambda log, truth, runs, last: on_axes(plotting.plot_object_counts, runs["np-graph"], 15),
    "objective": lambda log, truth, runs, last: on_axes(plotting.plot_objective, runs["np-graph"]),
    "trajectory": lambda log, truth, runs, last: on_axes(plotting.plot_cumulative_error, last, truth),
    "objects": lambda log, truth, runs, last: on_axes(plotting.plot_error_against_objects, last, truth),
}


@pytest.fixture(params=FIGURES, scope="module")
def figure(request, scene, runs, last):
    made = FIGURES[request.param](*scene, runs, last)
    made.draw_without_rendering()
    return made


def drawn_texts(figure):
    """Every text that is really seen: not the numbers of ticks beyond the ends of an axis."""
    texts = [text for legend in figure.findobj(Legend) for text in legend.get_texts()]
    for ax in panels(figure):
        texts += [ax.title, ax.xaxis.label, ax.yaxis.label, *ax.texts]
        for axis in (ax.xaxis, ax.yaxis):
            low, high = sorted(axis.get_view_interval())
            ticks = axis.get_major_ticks(len(axis.get_majorticklocs()))
            texts += [tick.label1 for tick in ticks if low <= tick.get_loc() <= high and tick.label1.get_visible()]
    return [text for text in texts if text.get_visible() and text.get_text().strip()]


def test_no_label_is_cut_off(figure):
    for text in drawn_texts(figure):
        box = text.get_window_extent()
        assert box.x0 >= 0 and box.y0 >= 0, text
        assert box.x1 <= figure.bbox.x1 and box.y1 <= figure.bbox.y1, text


def test_no_two_texts_overlap(figure):
    for a, b in itertools.combinations(drawn_texts(figure), 2):
        assert not a.get_window_extent().overlaps(b.get_window_extent()), (a, b)


def test_no_legend_covers_data(figure):
    for legend in figure.findobj(Legend):
        covered = legend.get_window_extent()
        for ax in panels(figure):
            points = [ax.transData.transform(line.get_xydata()) for line in lines_like(ax, dashed=False)]
            points += [ax.transData.transform(a.get_offsets()) for a in scatters(ax, hollow=False)]
            points = np.concatenate([*points, np.empty((0, 2))])
            assert not ((points > covered.min) & (points < covered.max)).all(axis=1).any()


def test_every_text_can_be_read_from_the_back_of_the_room(figure):
    assert min(text.get_fontsize() for text in drawn_texts(figure)) >= 11


def test_every_axis_names_its_unit(figure):
    labels = [label for ax in panels(figure) for label in (ax.get_xlabel(), ax.get_ylabel())]
    labels = [label for label in labels if label]
    assert len(labels) >= 2
    assert all(label.endswith(")") and "(" in label for label in labels)


def test_pyplot_holds_no_figure(figure):
    import matplotlib.pyplot as plt

    assert plt.get_fignums() == []


def test_pyplot_is_not_even_loaded():
    program = (
        "import sys; from npslam_teach import plotting as p; from npslam_teach.simulate import fifteen_objects;"
        "figure, ax = p.new_figure(); p.plot_truth(ax, fifteen_objects()[1]); figure.draw_without_rendering();"
        "assert 'matplotlib.pyplot' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", program], check=True)


def test_pictures_in_notebooks_are_small_and_true_to_their_colours(figure):
    figure.set_layout_engine("none")  # the layout moves by a hair whenever it is computed again
    data = parsed(plotting.show(figure, "a figure"))[2]
    assert 10_000 < len(data) < 120_000
    stream = io.BytesIO()
    figure.savefig(stream, dpi=125)
    exact = np.asarray(Image.open(stream).convert("RGB")).astype(int)
    shown = np.asarray(Image.open(io.BytesIO(data)).convert("RGB")).astype(int)
    assert np.abs(exact - shown).max() <= 20  # of 255
