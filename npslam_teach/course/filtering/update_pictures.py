"""What one sighting does to a filter's whole state, and what a filter promises after a wrong match."""

import numpy as np
from matplotlib.figure import Figure

from npslam_teach.course.small_pictures import bars_figure, curves_figure
from npslam_teach.plotting.style import (
    CLASS_COLORS,
    ESTIMATE_COLOR,
    TRUTH_COLOR,
    class_style,
    label_axes,
    label_map,
    new_figure,
)
from npslam_teach.plotting.uncertainty import ellipse_points

CLASSES = ("chair", "screen", "cup")  # of the toy scene, in its order


def update_figure(before: tuple, after: tuple, names: dict[str, slice]) -> Figure:
    """The ellipses of robot and objects before a sighting is used, dashed, and afterwards.

    Args:
        before: mean (n,) and covariance (n, n) of the filter.
        after: the same, after the update.
        names: by name, where its two numbers stand in the state.
    """
    figure, ax = new_figure(size=(7.5, 5.0))
    for name, place in names.items():
        own, marker = _look_of(name)
        right = -np.inf
        for (mean, cov), color, line in ((before, TRUTH_COLOR, "--"), (after, own, "-")):
            outline = ellipse_points(mean[place], cov[place, place])
            ax.plot(*outline.T, line, color=color, linewidth=2.0)
            ax.plot(*mean[place], marker, color=color, markersize=6)
            right = max(right, outline[:, 0].max())
        arrow = {"arrowstyle": "-|>", "color": ESTIMATE_COLOR, "linewidth": 1.6}
        if np.linalg.norm(after[0][place] - before[0][place]) > 0.02:
            ax.annotate("", after[0][place], before[0][place], arrowprops=arrow)
        at = (right, after[0][place][1])
        ax.annotate(name, at, (6, 0), textcoords="offset points", color=own, va="center")
    ax.margins(0.1)
    return label_map(ax, "one sighting of a chair moves the robot, and shrinks its ellipse").figure


def _look_of(name: str) -> tuple[str, str]:
    """Colour and marker: of its class, which is the first word, as on every map; or of an estimated pose."""
    word = name.split()[0]
    return class_style(CLASSES.index(word)) if word in CLASSES else (ESTIMATE_COLOR, "o")


def promises_figure(cases: dict[str, tuple[float, float]]) -> Figure:
    """How far off a filter is, and two of the standard deviations that it promises.

    Args:
        cases: by name, (m, m): how far off, and the promised standard deviation.
    """
    figure, ax = new_figure(size=(8.5, 3.8))
    for k, (off, std) in enumerate(cases.values()):
        held = off <= 2 * std
        ax.plot([0, 2 * std], [k, k], color=CLASS_COLORS[0], linewidth=12, alpha=0.35, solid_capstyle="butt")
        ax.plot(off, k, "o" if held else "X", markersize=12, color=CLASS_COLORS[0 if held else 1], mec=ESTIMATE_COLOR)
    ax.set_yticks(range(len(cases)), list(cases))
    ax.set_xlim(left=0)
    ax.invert_yaxis()
    broken = sum(off > 2 * std for off, std in cases.values())
    title = f"{broken} of {len(cases)} promises are broken"
    return label_axes(ax, "y at pose 4, off by (m); bars: two promised standard deviations", "told", title).figure


def prices_figure(prices: dict[str, float]) -> Figure:
    """The objective of the graph, by what it is told."""
    title = "chair A is far too dear; chair B and new are nearly alike"
    return bars_figure(prices, ("Obj_5 is", "objective (nats)"), title)


def circle_figure(headings: np.ndarray, squared: dict[str, np.ndarray]) -> Figure:
    """The NIS of a filter that turns once around, by how it subtracts two angles.

    Args:
        headings: (N,) degrees.
        squared: by name, (N,) the NIS.
    """
    labels, title = ("heading (degrees)", "NIS (log scale)"), "beyond 180 degrees the plain difference is a whole turn"
    return curves_figure(headings, squared, labels, title, log=True)
