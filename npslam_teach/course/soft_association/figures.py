"""Figure 24, which the deck does not have: one room, a detector that errs in three reports of ten, two methods."""

from npslam_teach import plotting
from npslam_teach.course.figure_file import FigureFile
from npslam_teach.experiments.confused_classes import room
from npslam_teach.methods import np_graph, soft_em
from npslam_teach.plotting import moving_map
from npslam_teach.plotting.style import legend_below

SEED, SHARE = 1, 0.3


def confused_figure():
    """The maps of NP-graph and of soft association."""
    log, truth = room(SEED, SHARE)
    ends = {"NP-graph": list(np_graph(log))[-1], "soft association": list(soft_em(log))[-1]}
    figure, axes = plotting.new_figure(1, 2, (13.0, 6.8), sharex=True, sharey=True)
    for ax, (name, last) in zip(axes, ends.items(), strict=True):
        moving_map.plot_moving_map(ax, list(ends.values()), log, truth)(last, f"{name}: {last.num_objects} objects")
    axes[1].set_ylabel("")
    return legend_below(figure, moving_map.moving_map_handles(truth), columns=8)


FIGURES = (
    FigureFile(
        "fig24_confused_detector",
        "Two maps of one room whose detector errs in three reports of ten. Left, NP-graph: wrong reports open "
        "objects of their own, and the true fifteen lie under piles of markers. Right, soft association: fifteen "
        "objects, each in its place.",
        confused_figure,
    ),
)
