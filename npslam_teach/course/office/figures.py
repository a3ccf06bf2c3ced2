"""Deck figures 18 and 19: from a detection to an observation, and the maps of the office by every method."""

from functools import cache

import numpy as np

from npslam_teach import plotting
from npslam_teach.course.figure_file import FigureFile
from npslam_teach.course.office import pictures
from npslam_teach.evaluation import valid_only
from npslam_teach.methods import METHODS
from npslam_teach.simulate.office import OFFICE_CLASSES, office, office_scene
from npslam_teach.simulate.office_camera import rendered_frame_and_truth

EPSILON = 0.1  # false_positive_threshold of the lesson
POSE_INDEX = 610  # of the rendered frame
PAPERS = ("np-graph", "robust-slam", "open-loop", "frame-by-frame")  # the methods that the paper compares


@cache
def _frame():
    """A frame, its truth, and the largest box."""
    frame, truth = rendered_frame_and_truth(office_scene(), POSE_INDEX)
    width, height = (frame.boxes[:, 2:] - frame.boxes[:, :2]).T
    return frame, truth, int(np.argmax(width * height))


@cache
def _results():
    """The log, the truth, and the result of each of the paper's methods, with its valid objects only."""
    log, truth = office()
    std = {"odometry_std": log.odometry_std, "observation_std": log.observation_std}
    return log, truth, {name: valid_only(list(METHODS[name](log, **std))[-1], EPSILON) for name in PAPERS}


def draw_frame():
    """Deck figure 18: the picture, its boxes, and the depth."""
    frame, _, chosen = _frame()
    return pictures.frame_figure(frame, OFFICE_CLASSES, chosen)


def draw_centre():
    """Deck figure 18: the point cloud of a box and its centre."""
    frame, truth, chosen = _frame()
    return pictures.centre_figure(frame, chosen, truth.obs_xy[chosen])


def draw_office():
    """Deck figure 19: the trajectory and the valid objects of every method, in space."""
    log, truth, results = _results()
    return pictures.office_3d_figure(results, log, truth)


def draw_maps():
    """Deck figure 19 from above."""
    log, truth, results = _results()
    return plotting.plot_methods(results, log, truth)


FIGURES = (
    FigureFile(
        "fig18a_office_detections",
        "A small camera picture of an office with boxes around chairs, screens and things on desks, and beside it the "
        "depth image of the same view, one box marked in both.",
        draw_frame,
    ),
    FigureFile(
        "fig18b_office_centroid",
        "Left, the point cloud of the frame in space with the points of one box in blue. Right, these points from "
        "above: the object, the wall behind it, and the mean of all between the two; the median and the mean of the "
        "foreground lie on the object.",
        draw_centre,
    ),
    FigureFile(
        "fig19a_office_methods_3d",
        "Four views in space of the same office: the NP-graph's path with many objects on stems as high as their "
        "number of sightings, robust SLAM with next to no object, open loop with low stems, frame by frame with none.",
        draw_office,
    ),
    FigureFile(
        "fig19b_office_methods_maps",
        "The same four results from above, over the true path and the true objects in grey: the NP-graph covers most "
        "true objects, open loop fewer and beside them, robust SLAM one at most, frame by frame none.",
        draw_maps,
    ),
)
