"""Why association: a timeline, the two ways to divide the work, the output of a detector, and two factor graphs."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, FancyBboxPatch, Rectangle

from npslam_teach.plotting.style import (
    CLASS_COLORS,
    ESTIMATE_COLOR,
    TEXT_SIZE,
    class_style,
    label_axes,
)

# Year, what, and the thread it belongs to: an index into THREADS (deck "Introduction and Motivation", figure 1).
THREADS = ("objects in the map", "geometry and solvers", "detectors")
EVENTS = (
    (1979, "Moravec: the Stanford Cart finds its way between chairs", 0),
    (1995, "the name SLAM", 1),
    (2005, "Galindo et al.: rooms, and coloured boxes that stand for furniture", 0),
    (2007, "Vasudevan et al.: maps of objects recognised by SIFT", 0),
    (2007, "Klein and Murray: PTAM, tracking beside mapping", 1),
    (2008, "Kaess et al.: iSAM, a graph solved as it grows", 1),
    (2011, "Kümmerle et al.: g2o, a solver for any graph", 1),
    (2014, "Girshick et al.: R-CNN", 2),
    (2015, "Ren et al.: Faster R-CNN", 2),
    (2016, "Cadena et al.: a survey of SLAM, divided into front end and back end", 1),
    (2016, "Mu et al.: association as part of the estimate (this course)", 0),
    (2017, "Bowman et al.: semantic factors", 0),
)
TURNING_YEAR = 2000  # text stands to the right of earlier events, to the left of later ones


def plot_timeline(ax: Axes, events=EVENTS) -> Axes:
    """One row per event, its mark at its year, earliest on top (deck figure 1).

    Args:
        ax: any axes, wide.
        events: (year, text, index of the thread) in the order of the rows.
    """
    for row, (year, text, thread) in enumerate(events):
        color, marker = class_style(thread)
        ax.plot([year], [-row], marker=marker, color=color, markersize=11, markeredgecolor=ESTIMATE_COLOR, ls="none")
        early = year < TURNING_YEAR
        place = {"xytext": (12 if early else -12, 0), "textcoords": "offset points", "va": "center"}
        ax.annotate(f"{year}  {text}", (year, -row), ha="left" if early else "right", fontsize=11, **place)
    handles = [
        Line2D([], [], color=class_style(k)[0], marker=class_style(k)[1], ls="none", markersize=10, label=name)
        for k, name in enumerate(THREADS)
    ]
    ax.legend(handles=handles, loc="lower left", frameon=False, fontsize=TEXT_SIZE["legend"])
    ax.set(xlim=(1975, 2020), ylim=(0.2 - len(events), 0.8), yticks=[])
    label_axes(ax, "year (CE)", "", "the solvers are older than the detectors that can name objects")
    ax.grid(axis="y", visible=False)
    return ax


def plot_split(ax: Axes) -> Axes:
    """The front end that decides once, above the alternation that can revise its decisions (deck figure 2).

    Args:
        ax: any axes; its frame is hidden.
    """
    rows = (
        (3.1, "divided: every sighting is named once", "front end:\nwhich object is it?", "back end:\nwhere was I?"),
        (0.6, "in turns: names may change", "associate:\nwhich object is it?", "optimise:\nwhere was I?"),
    )
    for y, title, first, second in rows:
        ax.text(0.1, y + 1.55, title, fontsize=TEXT_SIZE["title"], weight="bold")
        _box(ax, (0.1, y), "wheels,\ncamera", "white")
        _box(ax, (3.0, y), first, "#dcebf5")
        _box(ax, (6.4, y), second, "#fbe6d4")
        _box(ax, (9.6, y), "path,\nmap", "white")
        for start, end in ((2.1, 3.0), (8.8, 9.6)):
            _arrow(ax, (start, y + 0.6), (end, y + 0.6))
    _arrow(ax, (5.4, 3.7), (6.4, 3.7))
    _arrow(ax, (5.4, 1.45), (6.4, 1.45))
    _arrow(ax, (6.4, 0.95), (5.4, 0.95))
    ax.text(5.9, 1.58, "names", ha="center", fontsize=11)
    ax.text(5.9, 0.62, "poses", ha="center", fontsize=11)
    ax.text(5.9, 3.83, "names", ha="center", fontsize=11)
    ax.set(xlim=(0, 11.7), ylim=(0.4, 5.1))
    ax.set_axis_off()
    return ax


def _box(ax: Axes, corner, text: str, color: str) -> None:
    width = 2.4 if ":" in text else 2.0
    shape = FancyBboxPatch(corner, width, 1.2, boxstyle="round,pad=0,rounding_size=0.15", fc=color, ec=ESTIMATE_COLOR)
    ax.add_patch(shape)
    ax.text(corner[0] + width / 2, corner[1] + 0.6, text, ha="center", va="center", fontsize=12)


def _arrow(ax: Axes, start, end) -> None:
    arrow = {"arrowstyle": "-|>", "color": ESTIMATE_COLOR, "mutation_scale": 16, "shrinkA": 2, "shrinkB": 2}
    ax.annotate("", end, start, arrowprops=arrow)


BOXES = ((60, 190, 170, 240), (275, 90, 190, 214), (520, 225, 70, 75))  # px: column, row, width, height


def plot_detections(image: Axes, bars: Axes, posteriors: np.ndarray, class_names) -> None:
    """A drawn camera picture with three boxes, and beside it the class posterior of each (deck figure 3).

    Args:
        image: for the picture.
        bars: for the class posteriors.
        posteriors: (3, 3) probabilities: a row for the chair, the screen and the cup.
        class_names: (3,).
    """
    _draw_furniture(image)
    for k, ((x, y, width, height), posterior) in enumerate(zip(BOXES, posteriors, strict=True)):
        best = int(np.argmax(posterior))
        color = class_style(best)[0]
        image.add_patch(Rectangle((x, y), width, height, fill=False, edgecolor=color, linewidth=2.8))
        label = f"{k + 1}: {class_names[best]} {posterior[best]:.2f}"
        image.text(x + width / 2, y - 8, label, ha="center", va="bottom", fontsize=12, weight="bold")
    image.set(xlim=(0, 640), ylim=(480, 0), aspect="equal")
    label_axes(image, "column (px)", "row (px)", "argmax keeps one class for each box")
    image.grid(visible=False)
    _draw_bars(bars, posteriors, class_names)


def _draw_furniture(ax: Axes) -> None:
    """A room in a few rectangles: chair, screen on a desk, and a cup beside it."""
    dark, wood = "#5c5c5c", "#b8b0a4"
    shapes = [(0, 0, 640, 330, "#f2f0ec"), (0, 330, 640, 150, "#dedad2"), (255, 300, 365, 18, wood)]
    shapes += [(270, 318, 14, 130, wood), (592, 318, 14, 130, wood)]  # the legs of the desk
    shapes += [(75, 200, 26, 220, dark), (75, 300, 140, 26, dark), (190, 326, 22, 94, dark)]  # the chair
    shapes += [(285, 100, 170, 120, dark), (295, 110, 150, 100, "#c9d6de"), (360, 220, 20, 65, dark)]  # the screen
    shapes += [(325, 285, 90, 15, dark), (530, 240, 36, 58, dark)]
    for x, y, width, height, color in shapes:
        ax.add_patch(Rectangle((x, y), width, height, color=color, linewidth=0))
    ax.add_patch(Circle((569, 268), 14, fill=False, edgecolor=dark, linewidth=5))  # the handle of the cup


def _draw_bars(ax: Axes, posteriors: np.ndarray, class_names) -> None:
    width = 0.27
    for c, name in enumerate(class_names):
        at = np.arange(len(posteriors)) + 1 + (c - 1) * width
        heights = posteriors[:, c]
        ax.bar(at, heights, width, color=class_style(c)[0], edgecolor=ESTIMATE_COLOR, linewidth=0.6, label=name)
        for x, height, row in zip(at, heights, posteriors, strict=True):
            best = height == row.max()
            ax.text(x, height + 0.015, f"{height:.2f}", ha="center", fontsize=11, weight="bold" if best else "normal")
    ax.set(ylim=(0, 1.18), xticks=np.arange(len(posteriors)) + 1, yticks=np.linspace(0, 1, 6))
    ax.legend(loc="upper center", ncols=len(class_names), frameon=False, fontsize=TEXT_SIZE["legend"])
    label_axes(ax, "box (number)", "class posterior (probability)", "what it forgets: box 3 is nearly a screen")
    ax.grid(axis="x", visible=False)


POSE_XY = np.array([[1.0, 1.0], [4.0, 1.0], [7.0, 1.0]])
CHAIR_XY = np.array([[2.5, 3.6], [5.8, 3.6]])
SEEN = ((0, 0), (2, 1))  # pose, chair: the unambiguous observations
DOUBTFUL_POSE, SHARES = 1, (0.3, 0.7)  # one more, which may be of either chair


def plot_factor_graph(ax: Axes, semantic: bool) -> Axes:
    """Poses, chairs and the factors between them; one observation is ambiguous (deck figure 4).

    Args:
        ax: any axes; its frame is hidden.
        semantic: False: every observation is tied to one chair, the current association, as in this course.
            True: the ambiguous one is tied to both, each factor weighted by the probability of its class and place.
    """
    for start, end in zip(POSE_XY[:-1], POSE_XY[1:], strict=True):
        _factor(ax, start, end, ESTIMATE_COLOR)
    for pose, chair in SEEN:
        _factor(ax, POSE_XY[pose], CHAIR_XY[chair], ESTIMATE_COLOR)
    for chair, share in enumerate(SHARES):
        if semantic or share == max(SHARES):
            weight = share if semantic else 1.0
            _factor(ax, POSE_XY[DOUBTFUL_POSE], CHAIR_XY[chair], CLASS_COLORS[1], 1.2 + 3.5 * weight, f"{weight:.1f}")
    for k, xy in enumerate(POSE_XY):
        _node(ax, xy, f"$x_{k}$", "white")
    for name, xy in zip("AB", CHAIR_XY, strict=True):
        _node(ax, xy, f"$l_{name}$", "#dcebf5")
        label = f"chair {name}: class $c_{name}$" if semantic else f"chair {name}"
        ax.text(xy[0], xy[1] + 0.65, label, ha="center", fontsize=12)
    title = (
        "semantic factors: it pulls on both, more on B" if semantic else "one chair for each sighting: it pulls on B"
    )
    ax.set_title(title, fontsize=TEXT_SIZE["title"])
    ax.set(xlim=(0.2, 7.8), ylim=(0.3, 4.7), aspect="equal")
    ax.set_axis_off()
    return ax


def _node(ax: Axes, xy, name: str, color: str) -> None:
    ax.add_patch(Circle(xy, 0.45, facecolor=color, edgecolor=ESTIMATE_COLOR, linewidth=1.5, zorder=3))
    ax.text(*xy, name, ha="center", va="center", fontsize=14, zorder=4)


def _factor(ax: Axes, start, end, color: str, width: float = 1.5, weight: str = "") -> None:
    """A line with a square in its middle, and the weight beside the square."""
    ax.plot(*np.stack([start, end]).T, color=color, linewidth=width, zorder=1)
    middle = np.mean([start, end], axis=0)
    ax.plot(*middle, marker="s", color=color, markersize=11, zorder=2)
    if weight:
        ax.text(middle[0] + 0.28, middle[1] - 0.05, weight, fontsize=12, va="center", color=ESTIMATE_COLOR)


def factor_handles() -> list[Line2D]:
    """Legend entries of the factor graphs."""
    square = {"marker": "s", "markersize": 9}
    round_ = {"marker": "o", "markersize": 12, "linestyle": "none", "markeredgecolor": ESTIMATE_COLOR}
    return [
        Line2D([], [], color=ESTIMATE_COLOR, label="odometry, sighting", **square),
        Line2D([], [], color=CLASS_COLORS[1], linewidth=3, label="doubtful sighting, its weight", **square),
        Line2D([], [], markerfacecolor="white", label="pose", **round_),
        Line2D([], [], markerfacecolor="#dcebf5", label="chair", **round_),
    ]
