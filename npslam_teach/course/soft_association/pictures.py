"""Pictures of lesson 13: pairs and their probabilities, beliefs, EM on a line, and runs over the share of errors."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from npslam_teach.course.soft_association import table
from npslam_teach.experiments.confused_classes import SHARES
from npslam_teach.methods.gating import GATE
from npslam_teach.plotting.style import (
    CLASS_COLORS,
    CLASS_MARKERS,
    ESTIMATE_COLOR,
    TEXT_SIZE,
    TRUTH_LINE,
    class_style,
    label_axes,
    legend_beside,
    method_style,
    new_figure,
)
from npslam_teach.pose_graph import squared_radius

LOOKS = {
    "np-graph": method_style("np-graph"),
    "ekf hard": {"color": CLASS_COLORS[1], "marker": "s", "linestyle": "--"},
    "ekf": method_style("ekf"),
    "soft-em": method_style("soft-em"),
    "max-mixture": {"color": CLASS_COLORS[5], "marker": CLASS_MARKERS[6], "linestyle": "--"},
    "posterior": method_style("posterior"),
    "overconfident": method_style("soft-em") | {"linestyle": "-.", "marker": "v"},
    "true identities": TRUTH_LINE | {"marker": "s"},
}
QUANTITIES = {
    "objects": "objects (number, log scale)",
    "ari_used": "ARI of what is used (1 = perfect)",
    "pose_error": "mean pose error (m, log scale)",
}


def plot_pairs(ax: Axes, seen: np.ndarray, objects: np.ndarray, probability: np.ndarray, title: str) -> Axes:
    """Observations and objects of one frame; a line for every pair, as wide as it is probable, with its number.

    Args:
        ax: a map.
        seen: (m, 2) m, where the observations are.
        objects: (K, 2) m.
        probability: (m, K) of the pairs.
        title: of the plot, to which the most probable object of each observation is added.
    """
    color, marker = class_style(0)
    for (k, j), share in np.ndenumerate(probability):
        line = np.array([seen[k], objects[j]])
        ax.plot(*line.T, color=ESTIMATE_COLOR, linewidth=8 * share, alpha=0.55, solid_capstyle="butt", zorder=1)
        at = line[0] + (0.34 + 0.26 * (j % 2)) * (line[1] - line[0])
        box = {"facecolor": "white", "edgecolor": "none", "pad": 1.2, "alpha": 0.85}
        ax.text(*at, f"{share:.2f}", ha="center", va="center", fontsize=TEXT_SIZE["tick"], bbox=box, zorder=3)
    ax.plot(*objects.T, marker, color=color, markersize=18, markeredgecolor=ESTIMATE_COLOR, label="objects", zorder=2)
    ax.plot(*seen.T, "x", color=ESTIMATE_COLOR, markersize=12, markeredgewidth=2.5, label="observations", zorder=4)
    for name, places in (("chair", objects), ("obs", seen)):
        for k, xy in enumerate(places):
            below = name == "chair"
            style = {"ha": "center", "va": "top" if below else "bottom", "fontsize": TEXT_SIZE["label"]}
            ax.annotate(f"{name} {k + 1}", xy, (0, -14 if below else 10), textcoords="offset points", **style)
    ax.margins(0.25, 0.35)
    ax.set_aspect("equal", "datalim")
    chosen = ", ".join(f"obs {k + 1} of chair {j + 1}" for k, j in enumerate(probability.argmax(axis=1)))
    return label_axes(ax, "x (m)", "y (m)", f"{title}: {chosen}")


def plot_beliefs(ax: Axes, beliefs: np.ndarray, class_names, title: str) -> Axes:
    """What an object is, report by report: one line for every class.

    Args:
        ax: any axes.
        beliefs: (N+1, C) probabilities, before the first report and after each.
        class_names: (C,).
        title: of the plot, to which the last belief is added.
    """
    for c, name in enumerate(class_names):
        color, marker = class_style(c)
        ax.plot(beliefs[:, c], color=color, marker=marker, markersize=8, label=name)
    ax.set(ylim=(-0.04, 1.04))
    ax.xaxis.set_major_locator(MaxNLocator(integer=True))
    legend_beside(ax)
    best = beliefs[-1].argmax()
    return label_axes(ax, "reports (number)", "probability", f"{title}: {class_names[best]} {beliefs[-1, best]:.3f}")


def plot_em(ax: Axes, rounds: list[np.ndarray], seen: np.ndarray, title: str) -> Axes:
    """EM on a line: where the objects are, round by round, and the observations as grey lines.

    Args:
        ax: any axes.
        rounds: of (K,) m, the places of the objects.
        seen: (M,) m.
        title: of the plot, to which the last places are added.
    """
    for x in seen:
        ax.axvline(x, color="0.75", linewidth=1.2, zorder=0)
    for k, places in enumerate(np.array(rounds).T):
        color, marker = class_style(k)
        ax.plot(places, np.arange(len(places)), color=color, marker=marker, markersize=9, label=f"object {k + 1}")
    ax.invert_yaxis()
    ax.yaxis.set_major_locator(MaxNLocator(integer=True))
    legend_beside(ax)
    last = " and ".join(f"{x:.2f}" for x in rounds[-1])
    return label_axes(ax, "x (m); grey: observations", "round (number)", f"{title}: {last} m at the end")


def plot_runs(ax: Axes, quantity: str, cases: tuple) -> Axes:
    """A quantity for each share of wrong reports: medians of all rooms, bars from the 10th to the 90th percentile.

    The cases stand side by side, in their order: where several are perfect, no mark covers another.

    Args:
        ax: any axes.
        quantity: of QUANTITIES.
        cases: of the table.
    """
    for k, case in enumerate(cases):
        values = [table.column(quantity, case, share) for share in SHARES]
        low, middle, high = np.array([np.percentile(each, (10, 50, 90)) for each in values]).T
        x = np.arange(len(SHARES)) + 0.8 / len(cases) * (k - (len(cases) - 1) / 2)
        look = LOOKS[case] | {"linestyle": "none", "elinewidth": 2.0, "zorder": 2.0}
        ax.errorbar(x, middle, [middle - low, high - middle], capsize=3, markersize=8, label=case, **look)
    if quantity != "ari_used":
        ax.set_yscale("log")
        ax.yaxis.set_major_formatter("{x:g}")
    if quantity == "objects":
        ax.set_yticks([10, 15, 20, 50, 100])
    if quantity == "pose_error":
        ax.set_yticks([0.05, 0.1, 0.2, 0.5, 1.0])
    ax.yaxis.set_minor_formatter("")
    ax.set_xticks(range(len(SHARES)), [f"{100 * share:g}" for share in SHARES])
    ax.set_xticks(np.arange(1, len(SHARES)) - 0.5, minor=True)
    ends = (f"{case} {np.median(table.column(quantity, case, SHARES[-1])):.2g}" for case in (cases[0], cases[-1]))
    label_axes(ax, "wrong reports (%)", QUANTITIES[quantity], f"{SHARES[-1]:.0%} wrong: " + ", ".join(ends))
    ax.grid(False, axis="x")
    ax.grid(axis="x", which="minor")  # between the shares
    return ax


def gates_figure(left: dict) -> Figure:
    """How far from an object an observation may lie, after a right report of its class and after a wrong one.

    Args:
        left: by the share of wrong reports: (right, wrong) in standard deviations of position.
    """
    figure, ax = new_figure(size=(9.0, 4.0))
    for k, name in enumerate(("right report", "wrong report")):
        at, heights = np.arange(len(left)) + 0.4 * (k - 0.5), [each[k] for each in left.values()]
        ax.bar(at, heights, 0.38, color=CLASS_COLORS[k], hatch=("", "//")[k], edgecolor="white", label=name)
    ax.axhline(np.sqrt(squared_radius(GATE)), label="position alone", **TRUTH_LINE | {"zorder": 3.0})
    ax.set_xticks(range(len(left)), [f"{share:.0%}" for share in left])
    legend_beside(ax)
    said = " and ".join(f"{each[1]:.1f}" for each in (list(left.values())[0], list(left.values())[-1]))
    title = f"a wrong report leaves a gate of {said} st. deviations"
    label_axes(ax, "wrong reports of the detector", "gate (st. deviations)", title)
    return figure


def gaps_figure(gaps: dict, true: float) -> Figure:
    """The distances between two chairs that a mixture finds, one mark a run, and their means.

    Args:
        gaps: by the name of the mixture: (N,) m.
        true: m, dashed.
    """
    figure, ax = new_figure(size=(9.0, 3.2))
    ax.axvline(true, label="truth", **TRUTH_LINE)
    for k, values in enumerate(gaps.values()):
        color, marker = class_style(k)
        ax.plot(values, k + 0.2 * np.linspace(-1, 1, len(values)), marker, color=color, alpha=0.7)
        mean = {"color": ESTIMATE_COLOR, "markersize": 30, "markeredgewidth": 2.5, "linestyle": "none"}
        ax.plot(np.mean(values), k, "|", label="mean" if k == 0 else None, **mean)
    ax.set_yticks(range(len(gaps)), list(gaps))
    ax.set_ylim(len(gaps) - 0.5, -0.5)
    legend_beside(ax)
    off = ", ".join(f"{name} {100 * (np.mean(values) - true):+.1f} cm" for name, values in gaps.items())
    label_axes(ax, "gap between the chairs (m)", "mixture", f"the gap is off by: {off}")
    return figure


def too_sure_figure() -> Figure:
    """In how many rooms the number is right, with a detector that is honest and with one that is too sure."""
    figure, ax = new_figure(size=(9.0, 4.0))
    for k, (case, name) in enumerate((("soft-em", "honest"), ("overconfident", "too sure"))):
        right = [np.sum(table.column("objects", case, share) == 15) for share in SHARES]
        ax.plot(100 * np.array(SHARES), right, markersize=8, label=name, **LOOKS[case] | {"color": CLASS_COLORS[k]})
    ax.set_ylim(0, 31)
    legend_beside(ax)
    rooms = len(table.column("objects", "soft-em", SHARES[0]))
    label_axes(ax, "wrong reports (%)", f"exactly 15 objects (of {rooms} rooms)", "the number alone hardly tells")
    return figure
