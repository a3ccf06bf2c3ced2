"""Pictures of lesson 14: what looks alike, means on a circle, two gates, halls, and runs over the noise."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from npslam_teach import se2
from npslam_teach.course.orientation import table
from npslam_teach.course.orientation.hall_map import hall_handles, plot_hall, plot_noses
from npslam_teach.experiments.back_to_back import DEGREES
from npslam_teach.plotting.style import (
    CLASS_COLORS,
    ESTIMATE_COLOR,
    TRUTH_LINE,
    class_style,
    label_axes,
    label_map,
    legend_below,
    legend_beside,
    method_style,
    new_figure,
)
from npslam_teach.types import GroundTruth, RobotLog

LOOKS = {name: method_style(name) for name in ("np-graph", "ekf", "posterior")}
LOOKS |= {"true identities": TRUTH_LINE | {"marker": "s"}}
QUANTITIES = {"ari": "ARI (1 = perfect)", "pose_error": "mean pose error (m)"}


def pair_figure(log: RobotLog, truth: GroundTruth, pair: int) -> Figure:
    """All sightings of one pair, carried into the world along the true path: as points, and with their headings.

    Args:
        log: with headings.
        truth: whose poses are taken.
        pair: its number.
    """
    figure, axes = new_figure(1, 2, (12.0, 5.4), sharex=True, sharey=True)
    poses, members = truth.poses[log.obs_time], (2 * pair, 2 * pair + 1)
    places, theta = se2.apply(poses, log.obs_xy), poses[:, 2] + log.obs_theta
    both = np.isin(truth.obs_object, members)
    axes[0].plot(*places[both].T, "o", color=ESTIMATE_COLOR, markersize=7, alpha=0.6)
    for k, member in enumerate(members):
        own = truth.obs_object == member
        color, marker = class_style(k)
        axes[1].plot(*places[own].T, marker, color=color, markersize=7, label=f"really chair {'AB'[k]}")
        plot_noses(axes[1], places[own], theta[own], color=color, linewidth=1.2)
    for ax, title in zip(axes, (f"{both.sum()} sightings of two chairs", "the same, with headings"), strict=True):
        label_map(ax, title)
    axes[1].set_ylabel("")
    return legend_below(figure, axes[1].get_legend_handles_labels()[0])


def alike_figure(smallest_turn) -> Figure:
    """The smallest turn that looks alike over the turn itself: a chair, a table, a square, a cup.

    Args:
        smallest_turn: a function of turns (N,) rad and of how many headings look alike.
    """
    figure, ax = new_figure(size=(9.0, 4.2))
    turn = np.linspace(-np.pi, np.pi, 721)[:-1]
    for k, (name, symmetry) in enumerate({"chair, 1": 1, "table, 2": 2, "square, 4": 4, "cup, 0": 0}.items()):
        found = np.asarray(smallest_turn(turn, symmetry), dtype=float)
        found[np.abs(np.diff(found, prepend=found[0])) > 0.5] = np.nan  # no line where it leaps
        style = {"color": CLASS_COLORS[k], "linestyle": ("-", "--", "-.", ":")[k], "label": name}
        ax.plot(np.rad2deg(turn), np.rad2deg(found), **style)
    ax.set_xticks(range(-180, 181, 60))
    ax.set_yticks(range(-180, 181, 90))
    legend_beside(ax)
    label_axes(
        ax, "turn (degrees)", "smallest that looks alike (degrees)", "the more looks alike, the less a turn says"
    )
    return figure


def weights_figure(position: np.ndarray, both: np.ndarray) -> Figure:
    """The weights of two chairs for one sighting, by position alone and with the heading.

    Args:
        position: (2,) weights.
        both: (2,).
    """
    figure, ax = new_figure(size=(8.5, 3.8))
    for k, (name, weights) in enumerate({"position alone": position, "and heading": both}.items()):
        at, style = np.arange(2) + 0.4 * (k - 0.5), {"hatch": ("", "//")[k], "edgecolor": "white"}
        ax.bar(at, weights, 0.38, color=CLASS_COLORS[k], label=name, **style)
    ax.set_xticks(range(2), ["chair A, nearer", "chair B, faces so"])
    legend_beside(ax)
    first, second = ("AB"[int(np.argmax(weights))] for weights in (position, both))
    label_axes(ax, "object", "weight", f"position says {first}, position and heading say {second}")
    return figure


def means_figure(theta: np.ndarray, means: dict, title: str) -> Figure:
    """Headings as marks on a circle, and what different means make of them, as arrows.

    Args:
        theta: (N,) rad.
        means: by name: rad.
        title: of the plot.
    """
    figure, ax = new_figure(size=(7.2, 4.8))
    around = np.linspace(0, 2 * np.pi, 200)
    ax.plot(np.cos(around), np.sin(around), color="0.8")
    ax.plot(
        np.cos(theta), np.sin(theta), "x", color=ESTIMATE_COLOR, markersize=11, markeredgewidth=2.2, label="headings"
    )
    for k, (name, mean) in enumerate(means.items()):
        tip, style = np.array([np.cos(mean), np.sin(mean)]), {"linestyle": ("-", "--", "-.")[k], "linewidth": 2.6}
        ax.plot(*np.stack([[0, 0], 0.85 * tip]).T, color=CLASS_COLORS[k], marker=class_style(k)[1], label=name, **style)
    legend_beside(ax)
    ax.set_aspect("equal")
    label_axes(ax, "cos of the heading (no unit)", "sin of the heading (no unit)", title)
    return figure


def distances_figure(position: np.ndarray, joint: np.ndarray, gate: float) -> Figure:
    """Squared distances of sightings of one chair to it and to the other, without and with headings.

    Args:
        position: (N, 2) to the right chair and to the other, of positions.
        joint: (N, 2) of positions and headings.
        gate: as a squared distance.
    """
    figure, axes = new_figure(1, 2, (12.0, 4.4), sharex=True, sharey=True)
    for ax, squared, name in zip(axes, (position, joint), ("position alone", "position and heading"), strict=True):
        nearer = np.mean(squared[:, 0] < squared[:, 1])
        ax.plot(*squared.T, "o", color=CLASS_COLORS[0], markersize=7, alpha=0.6)
        ax.plot([0.1, 300], [0.1, 300], **TRUTH_LINE)
        ax.axhline(gate, color=CLASS_COLORS[1], linestyle="-.")
        ax.set(xscale="log", yscale="log", xlim=(0.05, 400), ylim=(0.05, 400))
        title = f"{name}: {nearer:.0%} nearer to the right"
        label_axes(ax, "squared distance to the right chair", "to the other chair", title)
        ticks = [0.1, 1, 10, 100]
        ax.set(xticks=ticks, xticklabels=map(str, ticks), yticks=ticks, yticklabels=map(str, ticks))
        ax.minorticks_off()
    axes[1].set_ylabel("")
    return figure


def plot_runs(ax: Axes, quantity: str, cases: tuple) -> Axes:
    """A quantity over the noise of headings: medians of all halls, bars from the 10th to the 90th percentile.

    A thin line of the same colour shows the median without headings.

    Args:
        ax: any axes.
        quantity: of QUANTITIES.
        cases: of the table.
    """
    degrees = np.array(DEGREES[1:])
    for k, case in enumerate(cases):
        low, middle, high = np.array(
            [np.percentile(table.column(quantity, case, each), (10, 50, 90)) for each in degrees]
        ).T
        # Shifted sideways a little, so that no bar covers another.
        x = degrees + 0.9 * (k - (len(cases) - 1) / 2)
        ax.errorbar(x, middle, [middle - low, high - middle], capsize=3, markersize=8, label=case, **LOOKS[case])
        without = np.median(table.column(quantity, case, 0.0))
        ax.axhline(without, color=LOOKS[case]["color"], linewidth=1.0, linestyle=":", zorder=1)
    ax.set_xticks(degrees)
    best, poor = degrees[0], degrees[-2]  # the last says nothing any more
    at = {(case, each): np.median(table.column(quantity, case, each)) for case in cases for each in (best, poor)}
    ends = (f"{case} {at[case, best]:.2g} to {at[case, poor]:.2g}" for case in (cases[0], cases[-1]))
    title = f"errors of {best:g} to {poor:g} degrees: " + ", ".join(ends)
    return label_axes(ax, "error of a heading (degrees); dotted: without", QUANTITIES[quantity], title)


def runs_figure(quantity: str, cases: tuple) -> Figure:
    """``plot_runs`` with its legend."""
    figure, ax = new_figure(size=(9.5, 4.8))
    plot_runs(ax, quantity, cases)
    legend_beside(ax)
    return figure


def twins_figure(cases: dict, truth: GroundTruth) -> Figure:
    """Answers to one log side by side.

    Args:
        cases: by title: a snapshot.
        truth: of the hall.
    """
    size = (6.2 * len(cases), 6.4)
    figure, axes = new_figure(1, len(cases), size, sharex=True, sharey=True, squeeze=False)
    for k, (ax, (title, snapshot)) in enumerate(zip(axes.flat, cases.items(), strict=True)):
        plot_hall(ax, snapshot, truth, f"{title}: {snapshot.num_objects} objects")
        if k:
            ax.set_ylabel("")
    return legend_below(figure, hall_handles(truth), columns=2 * len(cases))
