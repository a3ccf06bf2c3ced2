"""Deck figure 13: false positives are removed from the toy scene."""

import numpy as np

from npslam_teach import plotting, simulate
from npslam_teach.course.alternation import pictures
from npslam_teach.course.figure_file import FigureFile
from npslam_teach.methods import np_graph
from npslam_teach.plotting.style import legend_below

EPSILON = 0.45


def false_positives_figure():
    """Deck figure 13: the vote against each object, and the map without the rejected objects."""
    log, truth = simulate.toy_objects()
    stds = {"odometry_std": log.odometry_std, "observation_std": log.observation_std}
    *_, before, after = np_graph(log, alpha=0.5, **stds, false_positive_threshold=EPSILON)
    gone = np.unique(before.labels[after.labels < 0])
    figure, (left, right) = plotting.new_figure(1, 2, (13.0, 4.4), width_ratios=(1, 1.6))
    pictures.plot_nothing_there(left, before.votes, pictures.member_names(before.labels), EPSILON)
    rejected_xy, names = before.graph.landmarks[gone], pictures.member_names(after.labels)
    pictures.plot_kept_objects(right, after, truth, rejected_xy, names)
    return legend_below(figure, pictures.kept_handles(truth), columns=7)


FIGURES = (
    FigureFile(
        "fig13_false_positives_removed",
        "Left: five bars, the probability that nothing is there, one third for three objects seen twice and one half "
        "for two objects seen once, which rise above epsilon at 0.45. Right: the map with the three that remain, and "
        "crosses where the false screen and the cup were taken away.",
        false_positives_figure,
    ),
)
