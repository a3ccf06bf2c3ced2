"""Pictures of lesson 10: shares of many runs with their confidence, settings, causes, and passes over one object."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle

from npslam_teach import se2
from npslam_teach.course.fifteen_objects.pictures import plot_rooms
from npslam_teach.course.what_breaks import table
from npslam_teach.course.what_breaks.passes import Pairs
from npslam_teach.evaluation import wilson_interval
from npslam_teach.plotting.style import (
    CLASS_COLORS,
    CLASS_MARKERS,
    ESTIMATE_COLOR,
    TEXT_SIZE,
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
CAUSES = {  # the paper's method alone, with more rounds, true values, a scaled kernel, no object twice; name to case
    "the paper's": "np-graph",
    "30 rounds": "30 rounds",
    "true poses": "true poses",
    "true start": "true start",
    "scaled": "np-graph repeated",
    "scaled, true poses": "true poses repeated",
    "scaled, true start": "true start repeated",
    "scaled, exclusive": "np-graph sensor",
    "scaled, exclusive, 30 rounds": "30 rounds sensor",
    "scaled, exclusive, true poses": "true poses sensor",
    "scaled, exclusive, true start": "true start sensor",
    "true identities": "true identities",
}


def look_of(case: str) -> dict:
    """Colour, line and marker of a case: its method's, and those of NP-graph scaled to the sensor."""
    scaled = case in ("np-graph sensor", "np-graph repeated")
    return method_style("np-graph") | SENSOR_LOOK if scaled else method_style(case)


def plot_success(ax: Axes, cases: dict, of_used: tuple = (), faint: tuple = ()) -> Axes:
    """The share of right runs over noise, each in the band that holds the true share with 95 %.

    The title says how many are right at noise 3.

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
    at_three = "; ".join(f"{name}: {table.share_of(case, 3.0, name in of_used)[0]}" for name, case in cases.items())
    title = f"right at noise 3, of {int(runs[0])} rooms: {at_three}"
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
    title = None if chosen is not None else f"noise 3: at best {max(right_at(3.0, values))} of 30 rooms"
    for k, noise in enumerate(noises):
        if chosen not in (None, noise):
            continue
        right, runs, low, high = np.array([table.share_of(case, noise) for case in values.values()]).T
        # Curves beside each other are shifted sideways a little, so that no interval covers another.
        x = np.arange(len(values)) + (0.08 * (k - (len(noises) - 1) / 2) if chosen is None else 0.0)
        color, marker = class_style(k)
        spread = [right / runs - low, high - right / runs]
        style = {"color": color, "marker": marker, "linestyle": NOISE_LINES[k], "markersize": 7}
        ax.errorbar(x, right / runs, spread, capsize=3, label=f"noise {noise:g}", **style)
    ax.axvline(list(values.values()).index("np-graph"), label="the paper's value", **TRUTH_LINE)
    ax.set_xticks(range(len(values)), ["none" if value is None else f"{value:g}" for value in values])
    ax.set(ylim=(-0.04, 1.04))
    unit = {"alpha": "alpha (votes)", "threshold": "threshold (probability)", "kernel_std": "kernel width (m)"}
    return label_axes(ax, unit[setting], "share of right runs (95 %)", title)


def right_at(noise: float, values: dict) -> list[int]:
    """In how many rooms each case of ``table.swept`` was right at a noise."""
    return [table.share_of(case, noise)[0] for case in values.values()]


def plot_shares(ax: Axes, cases: dict, noises: tuple) -> Axes:
    """A table of shares: how many runs were right, and the interval of the share.

    Args:
        ax: any axes.
        cases: name of the row to case of the table.
        noises: the columns.
    """
    shares = [[table.share_of(case, noise) for noise in noises] for case in cases.values()]
    title = "scaled and exclusive: true poses or a true start are enough"
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
    far, beyond = (int(np.sum(pairs.same & (d > limit))) for d, limit in zip(pairs[:2], (reach, gate), strict=True))
    title = f"of {pairs.same.sum()} true pairs the kernel turns away {far}, the gate {beyond}"
    return label_axes(ax, "distance (m, log scale)", "distance (st. deviations, log scale)", title)


def plot_interval(ax: Axes, counts: tuple, trials: int) -> Axes:
    """How many of the trials go right under every share, and under which shares a count would be no surprise.

    Args:
        ax: any axes.
        counts: numbers of right trials; each has a thick line from end to end of its interval.
        trials: how many were made.
    """
    p = np.linspace(0.0, 1.0, 401)
    spread = 1.96 * np.sqrt(trials * p * (1 - p))
    style = {"color": CLASS_COLORS[5], "alpha": 0.25, "linewidth": 0, "label": "95 % of all counts"}
    ax.fill_between(p, trials * p - spread, trials * p + spread, **style)
    ax.plot(p, trials * p, color=CLASS_COLORS[5], linewidth=1.2, label="count on average")
    for k, count in enumerate(counts):
        low, high = wilson_interval(count, trials)
        label = "shares that fit a count" if k == 0 else None
        ax.plot([low, high], [count, count], color=CLASS_COLORS[1], linewidth=4.0, label=label)
        end = {"ha": "left" if low < 0.5 else "right", "va": "center", "fontsize": TEXT_SIZE["label"]}
        x = high + 0.02 if low < 0.5 else low - 0.02
        ax.text(x, count, f"{count}: {low:.2f} to {high:.2f}", **end)
    ax.set(xlim=(-0.02, 1.02), ylim=(-2.0, trials + 2.0))
    legend_beside(ax)
    title = f"{count} of {trials} right: the true share may be as low as {low:.2f}"
    return label_axes(ax, "true share p (no unit)", f"right of {trials} (number)", title)


def plot_half_metres(axes, x: np.ndarray, cov: np.ndarray) -> None:
    """Three passes in a corridor with their standard deviations, and the differences of neighbours with theirs.

    Args:
        axes: two; the passes, and the differences.
        x: (3,) m.
        cov: (3, 3) m^2.
    """
    look = {"fmt": "o", "color": CLASS_COLORS[0], "capsize": 6, "markersize": 9, "elinewidth": 2.0}
    axes[0].errorbar(x, [0, 1, 2], xerr=np.sqrt(np.diag(cov)), **look)
    axes[0].set_yticks([0, 1, 2], ["pass 1", "pass 2", "pass 3"])
    label_axes(axes[0], "x (m)", "", "alone, 2 is as unsure as 3")
    apart, std = np.diff(x), np.sqrt([cov[i, i] + cov[i + 1, i + 1] - 2 * cov[i, i + 1] for i in (0, 1)])
    axes[1].errorbar(apart, [0, 1], xerr=std, **look)
    axes[1].axvline(0.0, **TRUTH_LINE)
    axes[1].set_yticks([0, 1], ["2 less 1", "3 less 2"])
    far = " and ".join(f"{d / s:.1f}" for d, s in zip(apart, std, strict=True))
    label_axes(axes[1], "difference (m); dashed: one chair", "", f"from one chair: {far} st. deviations")
    for ax in axes:
        ax.margins(y=0.3)
        ax.invert_yaxis()


def plot_room_to_show(ax: Axes, found, errors) -> Axes:
    """All rooms, and a ring around the one that somebody would show: that with the smallest error.

    Args:
        ax: any axes.
        found: (N,) numbers of objects.
        errors: (N,) m, mean pose errors.
    """
    plot_rooms(ax, found, errors)
    best = int(np.argmin(errors))
    style = {"markersize": 18, "markerfacecolor": "none", "color": ESTIMATE_COLOR, "markeredgewidth": 2.2}
    ax.plot(found[best], errors[best], "o", label="the room to show", **style)
    legend_beside(ax)
    ax.set_title(f"the room that is shown is one of {len(found)}", fontsize=TEXT_SIZE["title"])
    return ax


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
