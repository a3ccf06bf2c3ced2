"""Pictures of lesson 06: associations, the objective half-step by half-step, groupings, and false positives."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator, MaxNLocator, NullLocator, ScalarFormatter

from npslam_teach.association import class_posterior
from npslam_teach.course.small_pictures import curves_figure
from npslam_teach.evaluation import distances_to_truth
from npslam_teach.evaluation.clustering import copies_of
from npslam_teach.plotting.maps import laid_over_truth, names_of_classes, plot_objects, plot_snapshot, plot_trajectory
from npslam_teach.plotting.style import (
    ESTIMATE_COLOR,
    TEXT_SIZE,
    TRUTH_COLOR,
    class_handles,
    class_style,
    label_axes,
    label_map,
    legend_beside,
    path_handles,
)
from npslam_teach.types import GroundTruth, RobotLog, Snapshot

LEVEL_COLOR = "#712553"
LEVEL_LINE = {"color": LEVEL_COLOR, "linestyle": "--", "linewidth": 1.8}
REJECTED = {"color": LEVEL_COLOR, "linestyle": "none", "marker": "x", "markersize": 12, "markeredgewidth": 2.5}
TIE = {"color": LEVEL_COLOR, "linestyle": "-", "linewidth": 1.6, "zorder": 2.2}
BESIDE = {
    "xytext": (-13, 0),
    "textcoords": "offset points",
    "ha": "right",
    "va": "center",
    "fontsize": TEXT_SIZE["label"],
}
HALVES = ("who is who", "where everything is")  # of a round: the sweep, then the solver


def member_names(labels: np.ndarray) -> list[str]:
    """What to call each object: the observations it holds, ``Obj_1+4`` for those of index 0 and 3.

    Args:
        labels: (M,) index of the object, from 0 without gaps; -1 belongs to none.
    """
    members = [np.flatnonzero(labels == i) + 1 for i in range(labels.max(initial=-1) + 1)]
    return ["Obj_" + "+".join(str(k) for k in ks) for ks in members]


def plot_belonging(
    ax: Axes, snapshot: Snapshot, log: RobotLog, xy: np.ndarray, truth: GroundTruth, title: str = ""
) -> Axes:
    """Map of a small scene: every observation with its name, and a line to its estimated object.

    The estimate is not aligned to the truth: pose 0 is the origin of both.

    Args:
        ax: a map.
        snapshot: the estimate.
        log: what it was made from.
        xy: (M, 2) m, W: each observation carried into the room along the estimated path.
        truth: dashed grey behind.
        title: of the map.
    """
    names = truth.world.class_names
    plot_trajectory(ax, truth.poses, truth=True)
    plot_trajectory(ax, snapshot.graph.poses)
    plot_objects(ax, truth.world.object_xy, truth.world.object_class, names, truth=True)
    plot_objects(ax, xy, log.obs_class, names)
    for k, label in enumerate(snapshot.labels):
        if label >= 0:
            ax.plot(*np.stack([xy[k], snapshot.graph.landmarks[label]]).T, **TIE)
    _name_observations(ax, snapshot.labels, xy)
    ax.margins(x=0.1, y=0.12)
    return label_map(ax, title)


def _name_observations(ax: Axes, labels: np.ndarray, xy: np.ndarray, within: float = 0.1) -> None:
    """Write names beside observations: one name for those of one object that are all ``within`` so many m."""
    for label in np.unique(labels):
        members = np.flatnonzero(labels == label)
        together = label >= 0 and np.ptp(xy[members], axis=0).max() < within
        for group in [members] if together else members[:, None]:
            name = "Obj_" + "+".join(str(k + 1) for k in group)
            ax.annotate(name, xy[group].mean(axis=0), **BESIDE)


def belonging_handles(truth: GroundTruth) -> list[Line2D]:
    """The legend of ``plot_belonging``; it lies below, because the maps need the width."""
    classes = class_handles(np.unique(truth.world.object_class), truth.world.class_names)
    ties = [Line2D([], [], label="belongs to", **TIE)]
    return classes + ties + path_handles(("estimated path", "true path", "true object"))


def plot_half_steps(ax: Axes, values) -> Axes:
    """The objective after every half-step: circles after the sweep, squares after the solver.

    Args:
        ax: any axes.
        values: the start, then after the sweep and after the solver of each round, in turn.
    """
    values = np.asarray(values, dtype=float)
    ax.plot(values, color=ESTIMATE_COLOR, linewidth=1.4, zorder=2.0)
    for first, name in enumerate(HALVES, start=1):
        at = np.arange(first, len(values), 2)
        color, marker = class_style(first - 1)
        ax.plot(at, values[at], marker, color=color, markersize=8, label=f"after asking {name}", zorder=2.5)
    ax.plot(0, values[0], "D", color=TRUTH_COLOR, markersize=8, label="start", zorder=2.5)
    ax.legend(loc="upper right", frameon=False, fontsize=TEXT_SIZE["legend"])
    ax.xaxis.set_major_locator(MaxNLocator(integer=True))
    rises = np.count_nonzero(np.diff(values) > 1e-6)
    title = f"the objective rises in {rises or 'no'} half-step{'s' if rises > 1 else ''}"
    return label_axes(ax, "half-step (number)", "objective (nats)", title)


def plot_groupings(ax: Axes, objectives, marked: dict[str, int], title: str) -> Axes:
    """Every grouping of the observations from the best to the worst, some of them named.

    Args:
        ax: any axes.
        objectives: (G,) positive, after the solver, one of each grouping.
        marked: name of a grouping to its index in ``objectives``.
        title: of the plot; the lowest grouping is added if it is marked.
    """
    objectives = np.asarray(objectives, dtype=float)
    rank = np.empty(len(objectives), dtype=int)
    rank[np.argsort(objectives, kind="stable")] = np.arange(1, len(objectives) + 1)
    ax.plot(rank, objectives, "o", color=TRUTH_COLOR, markersize=4, label="a grouping")
    for k, (name, index) in enumerate(marked.items()):
        color, marker = class_style(k)
        style = {"color": color, "marker": marker, "markersize": 11, "markeredgecolor": ESTIMATE_COLOR}
        ax.plot(rank[index], objectives[index], linestyle="none", label=f"{name}: {objectives[index]:.2f}", **style)
    ax.set_yscale("log")  # the worst are larger by hundreds
    ax.yaxis.set_major_locator(FixedLocator([2, 3, 4, 5, 7, 10, 20, 50, 100, 200, 500]))
    ax.yaxis.set_major_formatter(ScalarFormatter())
    ax.yaxis.set_minor_locator(NullLocator())
    ax.legend(loc="lower right", frameon=False, fontsize=TEXT_SIZE["legend"])
    lowest = [name for name, index in marked.items() if rank[index] == 1]
    title += f"\nlowest: {lowest[0]}" if lowest else ""
    return label_axes(ax, "rank (number)", "objective (nats, log scale)", title)


def plot_split_objects(ax: Axes, snapshot: Snapshot, log: RobotLog, truth: GroundTruth) -> Axes:
    """Map of a result in which some true objects are found more than once, each with lines to its copies.

    A found object counts as a copy of a true one when it holds at least five of its observations.

    Args:
        ax: a map.
        snapshot: the estimate.
        log: what it was made from.
        truth: the true objects and path.
    """
    plot_snapshot(ax, snapshot, log, truth, legend=False)
    _, landmarks = laid_over_truth(snapshot, truth)
    for true_object, copies in copies_of(snapshot, truth).items():
        for copy in copies if len(copies) > 1 else []:
            ax.plot(*np.stack([truth.world.object_xy[true_object], landmarks[copy]]).T, **TIE)
    names = names_of_classes(log, truth, None)
    ties = [Line2D([], [], label="one object, found\nmore than once", **TIE)]
    handles = class_handles(np.unique(log.obs_class), names)
    legend_beside(ax, handles + ties + path_handles(("estimated path", "true path", "true object")))
    worst = distances_to_truth(snapshot, truth)[0].max()
    return label_map(ax, f"{snapshot.num_objects} objects found; the path is off by up to {worst:.1f} m")


def plot_nothing_there(ax: Axes, votes: np.ndarray, names: list[str], epsilon: float) -> Axes:
    """The probability that nothing is there, for each object, beside epsilon (deck figure 13).

    Args:
        ax: any axes; its lines[0] is epsilon.
        votes: (K, C+1).
        names: (K,) to write under the bars.
        epsilon: an object above it is removed.
    """
    ax.axhline(epsilon, label="epsilon", **LEVEL_LINE)
    colors = [class_style(c)[0] for c in votes[:, 1:].argmax(axis=1)]
    ax.bar(names, class_posterior(votes)[:, 0], color=colors, edgecolor=ESTIMATE_COLOR, width=0.6)
    ax.set_ylim(0.0, 0.68)
    ax.legend(loc="upper left", frameon=False, fontsize=TEXT_SIZE["legend"])
    return label_axes(ax, "object", "nothing is there (probability)", "one vote against each object")


def plot_kept_objects(
    ax: Axes, snapshot: Snapshot, truth: GroundTruth, rejected_xy: np.ndarray, names: list[str]
) -> Axes:
    """Map of the objects that remain, and crosses where objects were removed (deck figure 13).

    The estimate is not aligned to the truth: pose 0 is the origin of both.

    Args:
        ax: a map.
        snapshot: after the removal.
        truth: dashed grey behind.
        rejected_xy: (R, 2) m, W: where the removed objects were.
        names: (K,) of the objects that remain.
    """
    classes = snapshot.votes[:, 1:].argmax(axis=1)
    plot_trajectory(ax, truth.poses, truth=True)
    plot_objects(ax, truth.world.object_xy, truth.world.object_class, truth.world.class_names, truth=True)
    plot_trajectory(ax, snapshot.graph.poses)
    plot_objects(ax, snapshot.graph.landmarks, classes, truth.world.class_names)
    ax.plot(*np.reshape(rejected_xy, (-1, 2)).T, **REJECTED)
    for name, xy in zip(names, snapshot.graph.landmarks, strict=True):
        ax.annotate(name, xy, **BESIDE)
    ax.margins(x=0.1, y=0.12)
    return label_map(ax, f"{snapshot.num_objects} objects remain")


def kept_handles(truth: GroundTruth) -> list[Line2D]:
    """The legend of ``plot_kept_objects``."""
    classes = np.unique(truth.world.object_class)
    gone = [Line2D([], [], label="taken away", **REJECTED)]
    paths = path_handles(("estimated path", "true path", "true object"))
    return class_handles(classes, truth.world.class_names) + gone + paths


def weights_figure(votes=(1, 3, 20), alpha: float = 0.9) -> Figure:
    """How much an object weighs for a sighting, by the distance and by the votes of the others.

    Args:
        votes: of the objects.
        alpha: the weight of a new object, dashed.
    """
    x = np.linspace(0.0, 1.4, 141)
    curves = {f"{m} vote{'s' if m > 1 else ''}": m * np.exp(-4 * x**2) for m in votes}
    title = "who has more votes reaches further"
    labels = ("distance from the object (m)", "weight (log scale)")
    figure = curves_figure(x, curves, labels, title, line=(alpha, f"a new object: {alpha:g}"), log=True)
    figure.axes[0].set_ylim(0.05, 40)
    return figure
