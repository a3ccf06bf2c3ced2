"""Pictures of lesson 10: shares of many runs with their confidence, settings, causes, and passes over one object."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle

from npslam_teach import se2
from npslam_teach.course.what_breaks import table
from npslam_teach.course.what_breaks.passes import Pairs
from npslam_teach.plotting.style import (
    CLASS_COLORS,
    CLASS_MARKERS,
    ESTIMATE_COLOR,
    TRUTH_LINE,
    class_style,
    label_axes,
    label_map,
    legend_beside,
    method_style,
)
from npslam_teach.plotting.success_maps import plot_share_table
from npslam_teach.types import GroundTruth, RobotLog

SENSOR_LOOK = {"color": CLASS_COLORS[5], "marker": CLASS_MARKERS[6], "linestyle": "--"}
NOISE_LINES = ("-", "--", "-.", ":")
CAUSES = {  # the paper's method alone, and with more rounds, true values or a scaled kernel; name to case
    "the paper's": "np-graph",
    "30 rounds": "30 rounds",
    "true poses": "true poses",
    "true start": "true start",
    "scaled": "np-graph sensor",
    "scaled, 30 rounds": "30 rounds sensor",
    "scaled, true poses": "true poses sensor",
    "scaled, true start": "true start sensor",
    "true identities": "true identities",
}


def look_of(case: str) -> dict:
    """Colour, line and marker of a case: its method's, and those of NP-graph scaled to the sensor."""
    return method_style("np-graph") | SENSOR_LOOK if case == "np-graph sensor" else method_style(case)


def plot_success(ax: Axes, cases: dict, of_used: tuple = (), faint: tuple = ()) -> Axes:
    """The share of right runs over noise, each in the band that holds the true share with 95 %.

    Args:
        ax: any axes.
        cases: name for the legend to case of the table.
        of_used: names of those judged only by the observations that they use; see ``table.right_of``.
        faint: names of those drawn faintly.
    """
    for name, case in cases.items():
        noises = table.noises_of(case)
        right, runs, low, high = np.array([table.share_of(case, noise, name in of_used) for noise in noises]).T
        look, strength = look_of(case), 0.45 if name in faint else 1.0
        ax.fill_between(noises, low, high, color=look["color"], alpha=0.16 * strength, linewidth=0)
        ax.plot(noises, right / runs, label=name, alpha=strength, markersize=8, **look)
    ax.set(ylim=(-0.04, 1.04))
    legend_beside(ax)
    title = "exactly fifteen, and the right ones"
    return label_axes(ax, "noise (times the paper's)", f"share of {int(runs[0])} runs (95 % bands)", title)


def plot_setting(ax: Axes, setting: str, chosen=None):
    """The share of right runs over the values of one setting, one curve a noise, with 95 % intervals.

    Args:
        ax: any axes.
        setting: of ``table.swept``.
        chosen: None, or a noise whose curve alone is drawn.

    Returns:
        the axes.
    """
    values = table.swept(setting)
    noises = table.noises_of(next(case for case in values.values() if case != "np-graph"))
    for k, noise in enumerate(noises):
        if chosen not in (None, noise):
            continue
        right, runs, low, high = np.array([table.share_of(case, noise) for case in values.values()]).T
        # Curves are shifted sideways a little, so that no interval covers another.
        x = np.arange(len(values)) + 0.08 * (k - (len(noises) - 1) / 2)
        color, marker = class_style(k)
        spread = [right / runs - low, high - right / runs]
        style = {"color": color, "marker": marker, "linestyle": NOISE_LINES[k], "markersize": 7}
        ax.errorbar(x, right / runs, spread, capsize=3, label=f"noise {noise:g}", **style)
    ax.axvline(list(values.values()).index("np-graph"), label="the paper's value", **TRUTH_LINE)
    ax.set_xticks(range(len(values)), ["none" if value is None else f"{value:g}" for value in values])
    ax.set(ylim=(-0.04, 1.04))
    unit = {"alpha": "alpha (votes)", "threshold": "threshold (probability)", "kernel_std": "kernel width (m)"}
    return label_axes(ax, unit[setting], "share of right runs (95 %)")


def plot_shares(ax: Axes, cases: dict, noises: tuple) -> Axes:
    """A table of shares: how many runs were right, and the interval of the share.

    Args:
        ax: any axes.
        cases: name of the row to case of the table.
        noises: the columns.
    """
    shares = [[table.share_of(case, noise) for noise in noises] for case in cases.values()]
    title = "runs that were right, and 95 % intervals of the share"
    return plot_share_table(ax, shares, list(cases), [f"{noise:g}" for noise in noises], "what was run", title)


def plot_pairs(ax: Axes, pairs: Pairs, reach: float, gate: float) -> Axes:
    """Pairs of passes: how far apart in metres, and in standard deviations of the pose graph.

    Args:
        ax: any axes.
        pairs: of one room.
        reach: m, how far the kernel reaches.
        gate: a Mahalanobis distance.
    """
    for k, (chosen, name) in enumerate([(~pairs.same, "two objects"), (pairs.same, "one object, seen twice")]):
        color, marker = class_style(1 - k)
        edge = {"markeredgecolor": ESTIMATE_COLOR, "markeredgewidth": 0.5, "alpha": 0.8}
        x, y = pairs.metres[chosen], pairs.deviations[chosen]
        ax.plot(x, y, marker, color=color, markersize=7, label=name, **edge)
    ax.axvline(reach, label=f"reach of the kernel: {reach:.2f} m", color=ESTIMATE_COLOR, linestyle=":", linewidth=2.2)
    ax.axhline(gate, label=f"gate: {gate:.2f} st. deviations", color=ESTIMATE_COLOR, linestyle="--", linewidth=1.8)
    ax.set(xscale="log", yscale="log")
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_major_formatter("{x:g}")
    legend_beside(ax)
    return label_axes(ax, "distance (m, log scale)", "distance (st. deviations, log scale)", "pairs of passes")


def plot_passes(ax: Axes, log: RobotLog, truth: GroundTruth, kernel_std: float, gap: int = 20) -> Axes:
    """A map along the odometry path: the position of each pass over an object; lines join passes over one object.

    Args:
        ax: a map.
        log: what the robot measured.
        truth: tells which passes are over one object; the path begins at its first pose.
        kernel_std: m; a circle in the corner shows it.
        gap: poses; observations of one object further apart are two passes.
    """
    poses = se2.dead_reckoning(log.odometry, truth.poses[0])
    xy = se2.apply(poses[log.obs_time], log.obs_xy)
    for k in np.unique(truth.obs_object[truth.obs_object >= 0]):
        seen = np.flatnonzero(truth.obs_object == k)
        parts = np.split(xy[seen], np.flatnonzero(np.diff(log.obs_time[seen]) > gap) + 1)
        centres = np.array([part.mean(axis=0) for part in parts])
        color, marker = class_style(truth.world.object_class[k])
        look = {"marker": marker, "markersize": 7, "markeredgecolor": ESTIMATE_COLOR, "markeredgewidth": 0.5}
        ax.plot(*centres.T, "-", color=color, linewidth=1.4, **look)
    corner = (0.9, 0.9)
    ax.add_patch(Circle(corner, kernel_std, facecolor="none", edgecolor=ESTIMATE_COLOR, linewidth=2.2, zorder=4))
    return label_map(ax)
