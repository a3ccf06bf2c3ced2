"""Deck figures 1 to 4: the history, the division of work, the detector, and semantic factors."""

import numpy as np

from npslam_teach import plotting
from npslam_teach.course.figure_file import FigureFile
from npslam_teach.course.why_association import pictures
from npslam_teach.plotting.style import legend_below
from npslam_teach.simulate import TOY_CLASSES

# What a detector might say of a chair, a screen and a cup: sure, sure, and in doubt.
POSTERIORS = np.array([[0.86, 0.09, 0.05], [0.07, 0.88, 0.05], [0.12, 0.41, 0.47]])


def timeline_figure():
    """Deck figure 1: objects in maps from 1979 to 2017."""
    figure, ax = plotting.new_figure(size=(11.0, 6.0))
    pictures.plot_timeline(ax)
    return figure


def split_figure():
    """Deck figure 2: front end and back end, and taking turns."""
    figure, ax = plotting.new_figure(size=(11.0, 4.6))
    pictures.plot_split(ax)
    return figure


def detector_figure(posteriors: np.ndarray = POSTERIORS):
    """Deck figure 3: boxes, class posteriors and the most likely class."""
    figure, (image, bars) = plotting.new_figure(1, 2, (13.0, 5.2))
    pictures.plot_detections(image, bars, posteriors, TOY_CLASSES)
    return figure


def semantic_figure():
    """Deck figure 4: a factor graph without and with semantic factors."""
    figure, (left, right) = plotting.new_figure(1, 2, (13.0, 5.0))
    pictures.plot_factor_graph(left, semantic=False)
    pictures.plot_factor_graph(right, semantic=True)
    return legend_below(figure, pictures.factor_handles())


FIGURES = (
    FigureFile(
        "fig01_history",
        "Timeline of twelve events from 1979 to 2017 in three threads: objects in the map, from Moravec's cart to "
        "semantic factors; geometry and solvers; and, from 2014, detectors by neural networks.",
        timeline_figure,
    ),
    FigureFile(
        "fig02_front_end_back_end",
        "Two block diagrams. Divided: measurements go to a front end that names every sighting once, then to a back "
        "end that finds the path. In turns: association and optimisation hand names and poses back and forth.",
        split_figure,
    ),
    FigureFile(
        "fig03_detector",
        "A drawn camera picture of a chair, a screen and a cup in boxes; beside it bars of the class posterior of each "
        "box. Chair and screen are sure; the cup is called a cup with 0.47 against 0.41 for a screen.",
        detector_figure,
    ),
    FigureFile(
        "fig04_semantic_factors",
        "Two factor graphs of three poses and two chairs. Left, each sighting is tied to one chair. Right, a doubtful "
        "sighting is tied to both chairs, with weights 0.3 and 0.7, and each chair carries its class.",
        semantic_figure,
    ),
)
