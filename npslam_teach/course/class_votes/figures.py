"""Deck figures 9 to 11: votes of the toy scene's clusters, the Dirichlet distribution, the false-positive vote."""

from dataclasses import replace

import numpy as np

from npslam_teach import association, plotting, simulate
from npslam_teach.course.class_votes import pictures
from npslam_teach.course.figure_file import FigureFile
from npslam_teach.methods import np_graph
from npslam_teach.plotting.style import legend_below
from npslam_teach.types import RobotLog, Snapshot

CLASSES = simulate.TOY_CLASSES


def toy_clusters(log: RobotLog) -> Snapshot:
    """The result of the method for the toy scene with alpha = 0.5 and the sensors' own noise."""
    *_, last = np_graph(log, alpha=0.5, odometry_std=log.odometry_std, observation_std=log.observation_std)
    return last


def votes_by_cluster(snapshot: Snapshot) -> tuple[list[str], np.ndarray]:
    """The observations of each cluster, ``Obj_3`` for index 2, and its votes; in the order of first observation."""
    order = list(dict.fromkeys(snapshot.labels.tolist()))
    members = [np.flatnonzero(snapshot.labels == i) for i in order]
    return ["\n".join(f"Obj_{k + 1}" for k in own) for own in members], snapshot.votes[order]


def votes_figure():
    """Deck figure 9: the votes of each cluster; and how they change when one observation is misread."""
    log, _ = simulate.toy_objects()
    misread = log.obs_class.copy()
    misread[4] = 1  # Obj_5, a chair, taken for a screen
    figure, axes = plotting.new_figure(1, 2, (13.0, 4.4), sharey=True)
    for ax, seen, title in zip(axes, (log.obs_class, misread), ("as it was", "Obj_5 read as a screen"), strict=True):
        found = toy_clusters(replace(log, obs_class=seen))
        names, votes = votes_by_cluster(found)
        cast = votes * [0, 1, 1, 1]  # the deck brings in the false-positive vote only later
        pictures.plot_votes(ax, cast, names, CLASSES, f"{title}: {found.num_objects} clusters")
    axes[1].set_ylabel("")
    return figure


def dirichlet_figure():
    """Deck figure 10: the Dirichlet distribution over three classes, for growing votes, and below 1."""
    figure, axes = plotting.new_figure(2, 2, (10.5, 9.0))
    panels = {
        "no votes, prior 1: all equally likely": (1.0, 1.0, 1.0),
        "2 chairs: leaning": (3.0, 1.0, 1.0),
        "7 chairs, 3 screens: fairly sure": (8.0, 4.0, 1.0),
        "no votes, prior 0.5: rather one than a mixture": (0.5, 0.5, 0.5),
    }
    for ax, (title, concentration) in zip(axes.flat, panels.items(), strict=True):
        pictures.plot_triangle(ax, concentration, CLASSES, title, key=ax in axes[:, 1])
        a = np.array(concentration)
        pictures.plot_summaries(ax, {"mean": a / a.sum(), "mode": association.mode(a)})
    return legend_below(figure, pictures.summary_handles(("mean", "mode")))


def false_positive_figure():
    """Deck figure 11: beta_3, the screen's votes, before and after the false-positive vote."""
    _, votes = votes_by_cluster(toy_clusters(simulate.toy_objects()[0]))
    return pictures.plot_doubt(votes[2], CLASSES)


FIGURES = (
    FigureFile(
        "fig09_class_votes",
        "Stacked bars of class votes. Left, the five clusters of the toy scene: chair 2, chair 2, screen 2, cup 1 and, "
        "from the false detection, screen 1. Right, the same with Obj_5 misread as a screen: six clusters, because it "
        "no longer joins Obj_2.",
        votes_figure,
    ),
    FigureFile(
        "fig10_dirichlet_distribution",
        "Four triangles with the density of a Dirichlet distribution over chair, screen and cup: even without votes; "
        "leaning to the chair's corner after two votes; a narrow hill between chair and screen after seven and three; "
        "dark along the edges and corners for concentrations of one half.",
        dirichlet_figure,
    ),
    FigureFile(
        "fig11_false_positive_vote",
        "Bars of beta_3, the votes of the screen. Before: nothing there 0, chair 0, screen 2, cup 0. After: the same "
        "with one vote for nothing there.",
        false_positive_figure,
    ),
)
