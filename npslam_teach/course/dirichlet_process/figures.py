"""Deck figures 6 to 8: Obj_5 of the toy scene, from weights to a decision."""

import numpy as np

from npslam_teach import plotting, se2, simulate
from npslam_teach.association import association_probabilities, association_weights, decide
from npslam_teach.course.dirichlet_process import pictures
from npslam_teach.course.figure_file import FigureFile

ASKS = 4  # Obj_5, counted from zero
ALPHA = 0.5


def _scene():
    """The log, its class names, the odometry path (T, 3), and the observations (M, 2) m along it."""
    log, truth = simulate.toy_objects()
    poses = se2.dead_reckoning(log.odometry)
    return log, truth.world.class_names, poses, se2.apply(poses[log.obs_time], log.obs_xy)


def _bars_of_obj_5():
    """Votes (7,) for its class and distances (7,) m to the others, the names under their bars, and their classes."""
    log, class_names, _, xy = _scene()
    others = np.delete(np.arange(log.num_observations), ASKS)
    votes = (log.obs_class[others] == log.obs_class[ASKS]).astype(float)
    distance = np.linalg.norm(xy[others] - xy[ASKS], axis=1)
    names = pictures.sighting_names(log.obs_class, class_names)
    return votes, distance, [names[k] for k in others], [int(c) for c in log.obs_class[others]]


def association_figure():
    """Deck figure 6: where Obj_5 is, and how well it fits every other observation."""
    log, class_names, poses, xy = _scene()
    votes, distance, names, bar_class = _bars_of_obj_5()
    weights = association_weights(votes, distance)
    figure, (left, right) = plotting.new_figure(1, 2, (13.0, 4.6), width_ratios=(1.35, 1))
    pictures.plot_sightings(left, poses, xy, log.obs_class, class_names, ASKS)
    pictures.plot_bars(
        right, weights / weights.sum(), names, bar_class, "probability (no unit)", "Is Obj_5 the same as ...?"
    )
    return figure


def process_figure():
    """Deck figure 7: the probabilities of Obj_5 without and with the possibility of a new object."""
    votes, distance, names, bar_class = _bars_of_obj_5()
    weights = association_weights(votes, distance)
    after = association_probabilities(votes, distance, ALPHA)
    panels = {"before: among the others": weights / weights.sum(), f"after: alpha = {ALPHA} for a new object": after}
    return pictures.plot_bar_panels(panels, names, bar_class)


def threshold_figure():
    """Deck figure 8: the same probabilities under two thresholds."""
    votes, distance, names, bar_class = _bars_of_obj_5()
    probabilities = association_probabilities(votes, distance, ALPHA)
    answers = [name.split("\n")[0] for name in names] + ["a new object"]
    thresholds = (0.3, 0.5)
    panels = {f"threshold {t}: Obj_5 is {answers[decide(probabilities, t)]}": probabilities for t in thresholds}
    return pictures.plot_bar_panels(panels, names, bar_class, thresholds)


FIGURES = (
    FigureFile(
        "fig06_association_probability",
        "Left, map of the eight sightings along the wheels' path; Obj_5 is 0.3 m from Obj_2, 0.4 m from Obj_1 and "
        "0.7 m from Obj_4. Right, bars of the probability that Obj_5 is the same as each other sighting: 0.39 "
        "for Obj_1, 0.51 for Obj_2, 0.10 for Obj_4, nothing for those of another class.",
        association_figure,
    ),
    FigureFile(
        "fig07_dirichlet_process",
        "Bars of the probabilities of Obj_5 before and after the Dirichlet process with alpha 0.5. Before: Obj_1 0.39, "
        "Obj_2 0.51, Obj_4 0.10. After: Obj_1 0.28, Obj_2 0.37, Obj_4 0.08, and a hatched bar, new, 0.27.",
        process_figure,
    ),
    FigureFile(
        "fig08_threshold",
        "The same bars twice, under a dashed threshold. At 0.3 the bar of Obj_2, 0.37, stands above it, so Obj_5 is "
        "Obj_2; at 0.5 no bar reaches it, so Obj_5 is a new object.",
        threshold_figure,
    ),
)
