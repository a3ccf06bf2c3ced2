"""Pictures of lesson 12: errors by pass and over steps, estimates of noise, ellipses, and methods over recordings."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from matplotlib.ticker import LogLocator, MaxNLocator, NullLocator

from npslam_teach import se2
from npslam_teach.course.a_real_robot import errors, table
from npslam_teach.evaluation.consistency import chi2_bounds
from npslam_teach.experiments.real_robot import COMPARED, FACTORS, KNOWN
from npslam_teach.plotting.maps import plot_trajectory, plot_truth
from npslam_teach.plotting.style import (
    ESTIMATE_COLOR,
    TRUTH_LINE,
    class_handles,
    class_style,
    label_axes,
    label_map,
    legend_beside,
    method_style,
    new_figure,
    path_handles,
)
from npslam_teach.types import GroundTruth, RobotLog

MEDIAN = {"color": ESTIMATE_COLOR, "marker": "|", "markersize": 26, "markeredgewidth": 2.5, "linestyle": "none"}
KNOWN_LOOK = {"color": "0.45", "marker": "X"}


def plot_wheels(ax: Axes, log: RobotLog, truth: GroundTruth, title: str = "the wheels' path drifts off") -> Axes:
    """A map of the true path and landmarks, and of the path that the wheels tell from the same first pose."""
    plot_truth(ax, truth)
    plot_trajectory(ax, se2.dead_reckoning(log.odometry, truth.poses[0]))
    names = truth.world.class_names
    legend_beside(ax, class_handles(range(len(names)), names) + path_handles(("estimated path", "true path", "start")))
    return label_map(ax, title)


def plot_errors(ax: Axes, log: RobotLog, truth: GroundTruth, count: int = 80, title: str = "") -> Axes:
    """How much too far each landmark seems, pass by pass, with the mean of every pass as a bar.

    Args:
        ax: any axes.
        log: what was measured.
        truth: what each sighting should have been.
        count: sightings, from the first.
        title: of the axes.
    """
    first = np.where(np.arange(log.num_observations) < count, truth.obs_object, -1)
    order, passes = errors.in_passes(first, log.obs_time)
    off = errors.along_the_ray(log, errors.sighting_errors(log, truth))[order]
    ax.axhline(0.0, **TRUTH_LINE)
    for number in range(passes.max() + 1):
        at, (color, marker) = np.flatnonzero(passes == number), class_style(number % 2)
        ax.plot(at, off[at], linestyle="-", linewidth=0.8, color=color, marker=marker, markersize=5)
        ax.plot(at[[0, -1]] + [-0.4, 0.4], 2 * [off[at].mean()], "-", color=color, linewidth=4, alpha=0.5)
    return label_axes(ax, "sighting (number, pass by pass)", "seen too far by (m)", title)


def plot_gate(ax: Axes, off: np.ndarray, squared_gate: float, title: str) -> Axes:
    """Errors of sightings in standard deviations, and the gate that should hold nearly all of them.

    Args:
        ax: any axes.
        off: (n, 2) standard deviations.
        squared_gate: a squared Mahalanobis distance.
        title: of the axes.
    """
    beyond = (off**2).sum(axis=1) > squared_gate
    for k, (chosen, name) in enumerate(((~beyond, "inside"), (beyond, "beyond"))):
        color, marker = class_style(k)
        ax.plot(*off[chosen].T, linestyle="none", color=color, marker=marker, markersize=5, label=name, alpha=0.7)
    ax.add_patch(Circle((0, 0), np.sqrt(squared_gate), facecolor="none", edgecolor=ESTIMATE_COLOR, linewidth=1.8))
    ax.set_aspect("equal")
    return label_axes(ax, "ahead (st. deviations)", "to the left (st. deviations)", title)


def plot_passes(ax: Axes, seen: np.ndarray, drift: np.ndarray) -> Axes:
    """Where one landmark, really at 0, seems to be in its pass of each drive, beside the drift.

    Args:
        ax: any axes.
        seen: (P, n) m, the sightings of each pass.
        drift: (P,) m, of each drive.
    """
    ax.axhline(0.0, label="landmark", **TRUTH_LINE)
    across = np.linspace(-0.3, 0.3, seen.shape[1])
    for k, values in enumerate(seen):
        color, marker = class_style(0)
        name = "sightings of one pass" if k == 0 else None
        ax.plot(k + across, values, linestyle="none", color=color, marker=marker, markersize=5, label=name)
    look = {"color": ESTIMATE_COLOR, "marker": "_", "markersize": 30, "markeredgewidth": 2.5, "linestyle": "none"}
    ax.plot(np.arange(len(seen)), drift, label="drift of the drive", **look)
    legend_beside(ax)
    return label_axes(ax, "drive (number)", "seen at (m)", "a pass agrees with itself, not with drift or truth")


def plot_growth(ax: Axes, curves: dict, what: str) -> Axes:
    """How errors grow over steps, in multiples of the error of one, on logarithmic axes.

    Args:
        ax: any axes.
        curves: name to ((n,) steps, (R, n) errors of several runs); the title tells where the first one ends.
        what: errs.
    """
    for k, (name, (steps, grown)) in enumerate(curves.items()):
        ratio, (color, marker) = grown / grown[:, :1], class_style(k)
        ax.fill_between(steps, ratio.min(axis=0), ratio.max(axis=0), color=color, alpha=0.2, linewidth=0)
        ax.plot(steps, np.median(ratio, axis=0), color=color, marker=marker, markersize=7, label=name)
    steps, (first, (_, grown)) = np.array(steps), next(iter(curves.items()))
    times = np.median(grown[:, -1] / grown[:, 0]) / np.sqrt(steps[-1])
    ax.plot(steps, np.sqrt(steps), label="root of n", **TRUTH_LINE)
    ax.set(xscale="log", yscale="log")
    _plain(ax.xaxis)
    _plain(ax.yaxis)
    legend_beside(ax)
    return label_axes(
        ax,
        "steps n (number, log scale)",
        "error of n steps (errors of one, log scale)",
        f"{what}: {first} {times:.1f} times root n",
    )


def plot_noise(ax: Axes, everything: np.ndarray, by_pass: np.ndarray, title: str = "") -> Axes:
    """Two estimates of one standard deviation in every recording, as multiples of the true one.

    Args:
        ax: any axes.
        everything: (R,) of all sightings.
        by_pass: (R,) of one of every pass.
        title: of the axes.
    """
    ax.axhline(1.0, label="against motion capture", **TRUTH_LINE)
    at = np.arange(len(everything))
    ax.vlines(at, everything, by_pass, color="0.8", linewidth=1.5, zorder=1)
    for k, (name, values) in enumerate({"from all sightings": everything, "one of every pass": by_pass}.items()):
        color, marker = class_style(k)
        # The first are hollow and larger, so that they show around the second where both are alike.
        look = {"markersize": 12, "markerfacecolor": "none", "markeredgewidth": 2} if k == 0 else {"markersize": 7}
        ax.plot(at, values, linestyle="none", color=color, marker=marker, label=name, **look)
    ax.set_ylim(bottom=0.0)
    ax.xaxis.set_major_locator(MaxNLocator(integer=True))
    legend_beside(ax)
    return label_axes(ax, "recording (seed)", "standard deviation (multiples of the true one)", title)


def plot_honesty(axes, chi2_per_dof: np.ndarray, nees: np.ndarray, dof: int) -> None:
    """What a graph says of itself, and what is true: chi2 without the truth, NEES with it; 1 is consistent.

    Args:
        axes: two.
        chi2_per_dof: (R,) of every recording.
        nees: (R,) mean squared Mahalanobis distance of its landmarks over 2.
        dof: degrees of freedom of a typical graph, for the two-sided 95 % interval.
    """
    low, high = chi2_bounds(dof, 0.95)
    cases = ((chi2_per_dof, "chi2 per degree of freedom", "without the truth"), (nees, "NEES / 2", "with the truth"))
    for k, (ax, (values, name, title)) in enumerate(zip(axes, cases, strict=True)):
        color, marker = class_style(k)
        title += f": median {np.median(values):.2g}"
        if k == 0:
            ax.axhspan(low, high, color="0.85")
            title += " (grey: 95 % if consistent)"
        ax.axhline(1.0, **TRUTH_LINE)
        ax.xaxis.set_major_locator(MaxNLocator(integer=True))
        ax.plot(np.arange(len(values)), values, linestyle="none", marker=marker, color=color, markersize=8)
        ax.set_ylim(0.0, max(1.3, 1.1 * values.max()))
        label_axes(ax, "recording (seed)", f"{name} (number)", title)


def plot_over_recordings(ax: Axes, name: str, rows: dict, x_label: str, best: float | None = None) -> Axes:
    """One line a method, one mark a recording, a bar at the median; a logarithmic axis.

    Args:
        ax: any axes.
        name: a column of the table.
        rows: name of the line to the case of the table.
        x_label: with the unit.
        best: where everybody would like to be; None: nowhere in particular.
    """
    if best is not None:
        ax.axvline(best, **TRUTH_LINE)
    for k, case in enumerate(rows.values()):
        values = table.column(name, *case)
        look = KNOWN_LOOK if case[0] == KNOWN else {key: method_style(case[0])[key] for key in ("color", "marker")}
        beside = k + 0.24 * np.linspace(-1, 1, len(values))
        ax.plot(values, beside, linestyle="none", markersize=6, markeredgecolor="0.3", markeredgewidth=0.4, **look)
        ax.plot(np.median(values), k, **MEDIAN)
    ax.set_yticks(range(len(rows)), list(rows))
    ax.set(xscale="log", ylim=(len(rows) - 0.5, -0.5))
    _plain(ax.xaxis)
    own = {row: np.median(table.column(name, *case)) for row, case in rows.items() if case[0] != KNOWN}
    nearest = min(own, key=lambda row: abs(own[row] - (best or 0.0)))
    title = f"{'lowest median' if best is None else f'median nearest to {best:g}'}: {nearest}"
    return label_axes(ax, x_label, "what was run (name)" if ax.get_subplotspec().is_first_col() else "", title)


def over_recordings_figure(rows: dict) -> Figure:
    """Objects and errors of the path of every recording, side by side; see ``plot_over_recordings``."""
    figure, axes = new_figure(1, 2, (14.0, 4.6), sharey=True)
    plot_over_recordings(axes[0], "objects", rows, "objects (number, log scale)", 15)
    plot_over_recordings(axes[1], "pose_error", rows, "mean pose error (m, log scale)")
    return figure


def plot_factors(ax: Axes, name: str, y_label: str, best: float | None = None) -> Axes:
    """A column of the table over the factor that the noise is multiplied by: medians and quartiles."""
    if best is not None:
        ax.axhline(best, **TRUTH_LINE)
    for k, method in enumerate(COMPARED):
        values = np.array([table.column(name, method, "own", factor) for factor in FACTORS])
        at = np.array(FACTORS) * (1 + 0.04 * (k - 1))
        low, middle, high = np.quantile(values, [0.25, 0.5, 0.75], axis=1)
        ax.errorbar(at, middle, [middle - low, high - middle], capsize=3, label=method, **method_style(method))
    ax.set(xscale="log", yscale="log")
    ax.set_xticks(FACTORS, [f"{factor:g}" for factor in FACTORS])
    ax.xaxis.set_minor_locator(NullLocator())
    _plain(ax.yaxis)
    return label_axes(ax, "noise believed (multiples of the true one)", y_label)


def _plain(axis) -> None:
    """Labels 1, 2, 5, 10 and so on, no powers of ten, on a logarithmic axis."""
    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.set_major_formatter("{x:g}")
    axis.set_minor_locator(NullLocator())
