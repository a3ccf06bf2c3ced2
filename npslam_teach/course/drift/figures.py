"""Deck figure 5, the frame-by-frame start; and what one wrong heading does, which the deck has no figure of."""

import numpy as np

from npslam_teach import plotting, se2, simulate
from npslam_teach.course.drift import pictures
from npslam_teach.course.figure_file import FigureFile
from npslam_teach.plotting.style import class_handles, legend_below, path_handles


def frame_by_frame_figure():
    """The toy scene twice: observations along the true path, and along the odometry path."""
    log, truth = simulate.toy_objects()
    figure, (left, right) = plotting.new_figure(1, 2, (13.0, 4.7), sharex=True, sharey=True)
    pictures.plot_frame_by_frame(left, log, truth.poses, truth, "if the path were known: sightings coincide")
    for text in left.texts:
        text.set_visible(False)  # two observations of one object lie on each other here
    wheels = se2.dead_reckoning(log.odometry)
    pictures.plot_frame_by_frame(right, log, wheels, truth, "believing the wheels: 8 sightings, 8 objects")
    right.set_ylabel("")
    handles = class_handles(range(3), truth.world.class_names)
    return legend_below(figure, handles + path_handles(("estimated path", "true path", "true object")), columns=6)


def wrong_heading_figure():
    """Nine metres around two corners, with one turn reported 15 degrees too large."""
    steps = np.tile([0.5, 0.0, 0.0], (18, 1))
    steps[[7, 13], 2] = np.pi / 2  # the true corners
    figure, ax = plotting.new_figure(size=(9.0, 4.8))
    pictures.plot_one_wrong_turn(ax, steps, wrong=3, error=np.deg2rad(15))
    return figure


FIGURES = (
    FigureFile(
        "fig05_frame_by_frame_start",
        "Two maps of the toy scene. Left, along the true path, the sightings of one object lie on each other. Right, "
        "along the path that the wheels report, each of the eight sightings is an object of its own: those seen after "
        "the wheels slipped lie 0.3 m beside the ring of the true object.",
        frame_by_frame_figure,
    ),
    FigureFile(
        "fig25_one_wrong_heading",
        "Two paths around two corners from the same start. One turn is reported 15 degrees too large; from there on "
        "the whole estimated path is turned by 15 degrees, and its end lies 0.8 m from the true one.",
        wrong_heading_figure,
    ),
)
