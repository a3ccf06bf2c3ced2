"""How every picture of the course looks: one palette, one marker per class, one style per method, and the axes.

Nothing here uses ``pyplot``: figures are plain ``Figure`` objects, so none is left open behind a notebook.
The colours start from those of Okabe and Ito (2008), with the lightness of each moved until all of them differ under
deuteranopia, under protanopia and on a grey printer. The first five, those of the lessons, differ most. Where colour
is not enough there is always a second sign: a marker, a dash pattern or a width.
"""

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from npslam_teach.methods import METHODS

CLASS_COLORS = ("#00659f", "#d45e00", "#38ba8d", "#712553", "#ddd32e", "#4b98dc", "#f6a0cf", "#432c00")
CLASS_MARKERS = ("o", "s", "^", "D", "v", "P", "X", "*")

TRUTH_COLOR = "#757575"
ESTIMATE_COLOR = "#1a1a1a"
TRUTH_LINE = {"color": TRUTH_COLOR, "linestyle": "--", "linewidth": 1.8, "zorder": 1.5}
ESTIMATE_LINE = {"color": ESTIMATE_COLOR, "linestyle": "-", "linewidth": 1.2, "zorder": 2.0}
TRUTH_OBJECT = {"facecolors": "none", "edgecolors": TRUTH_COLOR, "linewidths": 1.5}
START = {"color": ESTIMATE_COLOR, "linestyle": "none", "marker": "o", "markersize": 8, "zorder": 3.0}

TEXT_SIZE = {"title": 13, "label": 12, "tick": 11, "legend": 11}  # pt: readable from the back of a room

_LEGEND = {"frameon": False, "fontsize": TEXT_SIZE["legend"]}


def put_settings_aside() -> None:
    """Forget what a ``matplotlibrc`` asks for: LaTeX that may not be there, other fonts, sizes and colours."""
    matplotlib.rcdefaults()


def class_style(c: int) -> tuple[str, str]:
    """The colour and the marker of class ``c``, the same in every lesson.

    From the ninth class on the colours return, each with another marker; 64 classes stay distinct.

    Args:
        c: class index, 0 or more.
    """
    if c < 0:
        raise ValueError(f"c: expected a class index of 0 or more, got {c}")
    num_styles = len(CLASS_COLORS)
    return CLASS_COLORS[c % num_styles], CLASS_MARKERS[(c + c // num_styles) % num_styles]


def method_style(name: str) -> dict:
    """Colour, line style, marker, line width and order of drawing of a method's curve, as keywords of ``Axes.plot``.

    Args:
        name: as on the command line, "np-graph" for example.

    Raises:
        ValueError: no method of this name has a style.
    """
    if name not in METHODS:
        raise ValueError(f"name: expected one of {', '.join(METHODS)}, got {name!r}")
    return {"linewidth": 2.0, "zorder": 2.0} | METHODS[name].style


def new_figure(rows: int = 1, cols: int = 1, size=(7.0, 5.5), **subplots) -> tuple[Figure, Axes | np.ndarray]:
    """A figure that pyplot does not know of, with its axes; its layout leaves room for every label.

    Args:
        rows: of panels.
        cols: of panels.
        size: (width, height) in inches.
        **subplots: passed on to ``Figure.subplots``, ``sharex`` for example.

    Returns:
        the figure, and its axes as ``Figure.subplots`` returns them.
    """
    sizes = {"axes.titlesize": TEXT_SIZE["title"], "axes.labelsize": TEXT_SIZE["label"], "font.size": 11}
    with matplotlib.rc_context(sizes | {"figure.facecolor": "white", "axes.facecolor": "white"}):
        # "compressed" is the constrained layout that also closes the gaps between maps of equal aspect.
        figure = Figure(figsize=size, layout="compressed")
        return figure, figure.subplots(rows, cols, **subplots)


def label_axes(ax: Axes, x_label: str, y_label: str, title: str | None = None) -> Axes:
    """Name both axes, with their units, and the plot."""
    ax.set_xlabel(x_label, fontsize=TEXT_SIZE["label"])
    ax.set_ylabel(y_label, fontsize=TEXT_SIZE["label"])
    if title is not None:
        ax.set_title(title, fontsize=TEXT_SIZE["title"])
    ax.tick_params(labelsize=TEXT_SIZE["tick"])
    ax.grid(True, color="0.9", linewidth=0.6)
    ax.set_axisbelow(True)
    return ax


def label_map(ax: Axes, title: str | None = None) -> Axes:
    """Make ``ax`` a map: metres on both axes, and a metre as long on one as on the other."""
    ax.set_aspect("equal", adjustable="box")
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_major_locator(MaxNLocator(8, steps=[1, 2, 5, 10]))
    return label_axes(ax, "x (m)", "y (m)", title)


def legend_beside(ax: Axes, handles: list | None = None) -> Axes:
    """Put the legend to the right of the axes, where it covers no data."""
    handles = ax.get_legend_handles_labels()[0] if handles is None else handles
    ax.legend(handles=handles, loc="upper left", bbox_to_anchor=(1.02, 1.0), borderaxespad=0.0, **_LEGEND)
    return ax


def legend_inside(ax: Axes, handles: list) -> Axes:
    """Put the legend in the middle of axes that show nothing else."""
    ax.legend(handles=handles, loc="center", **_LEGEND)
    return ax


def legend_below(figure: Figure, handles: list, columns: int = 4) -> Figure:
    """Put one legend for all panels under them."""
    figure.legend(handles=handles, loc="outside lower center", ncols=min(columns, len(handles)), **_LEGEND)
    return figure


def class_handles(classes, class_names) -> list[Line2D]:
    """Legend entries of classes, in the colour and with the marker of each."""
    handles = []
    for c in classes:
        color, marker = class_style(c)
        style = {"color": color, "marker": marker, "markeredgecolor": ESTIMATE_COLOR, "markeredgewidth": 0.6}
        handles.append(Line2D([], [], linestyle="none", markersize=9, label=class_names[c], **style))
    return handles


def path_handles(labels) -> list[Line2D]:
    """Legend entries named "estimated path", "true path", "true object" and "start"; those of ``labels``."""
    hollow = {"marker": "o", "markersize": 11, "markerfacecolor": "none", "markeredgecolor": TRUTH_COLOR}
    looks = {
        "estimated path": ESTIMATE_LINE,
        "true path": TRUTH_LINE,
        "true object": {"linestyle": "none"} | hollow,
        "start": START,
    }
    return [Line2D([], [], label=label, **looks[label]) for label in labels]
