"""Pictures of a sweep: how many runs were right, with the interval that holds the true share with 95 % (Wilson)."""

from collections.abc import Iterable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure

from npslam_teach.evaluation import wilson_interval
from npslam_teach.experiments.runs import LEAST_ARI
from npslam_teach.experiments.sweep import SETTINGS, is_right
from npslam_teach.plotting.style import TEXT_SIZE, label_axes, legend_beside, method_style, new_figure

LABELS = {
    "noise": "noise (times the paper's)",
    "alpha": "alpha (votes)",
    "threshold": "threshold (probability)",
    "kernel_std": "kernel width (m)",
}
_NONE_TO_ALL = LinearSegmentedColormap.from_list("none_to_all", ["#f6f6f6", "#9dc3e0"])  # black text on all of it


def success_figures(rows: Iterable[dict]) -> dict[str, Figure]:
    """Every figure of a sweep, by the name of its file: all methods over noise, and a map for each varied setting.

    Args:
        rows: of ``experiments.sweep``.

    Raises:
        ValueError: there are no rows.
    """
    rows = list(rows)
    if not rows:
        raise ValueError("rows: expected at least one run, got none")
    figures = {}
    for scene, scale in _each(rows, "scene", "scale"):
        some = [row for row in rows if (row["scene"], row["scale"]) == (scene, scale)]
        name = "_".join(("success", "".join(c if c.isalnum() else "-" for c in scene), scale))
        figures[name] = _curves(some, f"{scene}, {scale} settings")
        for method in dict.fromkeys(row["method"] for row in some):
            own = [row for row in some if row["method"] == method]
            for setting in (setting for setting in SETTINGS if len(_each(own, setting)) > 1):
                figures[f"{name}_{method}_{setting}"] = _maps(own, setting, f"{method}, {scene}, {scale} settings")
    return figures


def _each(rows: list[dict], *names: str) -> list[tuple]:
    """The different values of some columns, in order; None, a method's own value, comes first."""
    found = {tuple(row[name] for name in names) for row in rows}
    return sorted(found, key=lambda values: [(value is not None, value or 0) for value in values])


def _share(rows: list[dict]) -> tuple[int, int, float, float]:
    right = sum(map(is_right, rows))
    low, high = wilson_interval(right, len(rows))
    return right, len(rows), float(low), float(high)


def _curves(rows: list[dict], title: str) -> Figure:
    """The share of right runs over noise for every method, with the settings that are its own or come first."""
    figure, ax = new_figure()
    for method in dict.fromkeys(row["method"] for row in rows):
        own = [row for row in rows if row["method"] == method]
        first = _each(own, *SETTINGS)[0]
        own = [row for row in own if tuple(row[name] for name in SETTINGS) == first]
        noises = [noise for (noise,) in _each(own, "noise")]
        shares = [_share([row for row in own if row["noise"] == noise]) for noise in noises]
        right, runs, low, high = np.array(shares).T
        look = method_style(method)
        ax.fill_between(noises, low, high, color=look["color"], alpha=0.16, linewidth=0)
        said = [
            f"{LABELS[name].split(' (')[0]} {value:g}" for name, value in zip(SETTINGS, first, strict=True) if value
        ]
        ax.plot(noises, right / runs, label=", ".join([method, *said]), markersize=8, **look)
    ax.set(ylim=(-0.04, 1.04))
    legend_beside(ax)
    label_axes(
        ax,
        LABELS["noise"],
        f"share of {_span(rows)} runs (95 % bands)",
        f"right number of objects, ARI at least {LEAST_ARI}: {title}",
    )
    return figure


def _span(rows: list[dict]) -> str:
    return str(len(_each(rows, "seed")))


def _maps(rows: list[dict], setting: str, title: str) -> Figure:
    """Right runs over noise and a setting, one map for each combination of the other settings."""
    others = [name for name in SETTINGS if name != setting]
    combinations = _each(rows, *others)
    noises, values = _each(rows, "noise"), _each(rows, setting)
    size = (2.6 + 1.5 * len(noises), (1.6 + 0.75 * len(values)) * len(combinations))
    figure, axes = new_figure(len(combinations), 1, size=size, squeeze=False)
    for ax, combination in zip(axes.flat, combinations, strict=True):
        own = [row for row in rows if tuple(row[name] for name in others) == combination]
        cells = [[_share_at(own, setting, value, noise) for (noise,) in noises] for (value,) in values]
        said = [f"{name} {value:g}" for name, value in zip(others, combination, strict=True) if value is not None]
        names = [_word(value) for (value,) in values], [f"{noise:g}" for (noise,) in noises]
        plot_share_table(ax, cells, *names, LABELS[setting], "; ".join([title, *said]))
    return figure


def _share_at(rows: list[dict], setting: str, value, noise: float) -> tuple | None:
    own = [row for row in rows if row[setting] == value and row["noise"] == noise]
    return _share(own) if own else None


def _word(value: float | None) -> str:
    return "own" if value is None else f"{value:g}"


def plot_share_table(
    ax: Axes, cells: list[list[tuple | None]], rows: list[str], columns: list[str], what: str, title: str
) -> Axes:
    """A table of shares over the noise: how many runs were right, of how many, and the 95 % interval of the share.

    Args:
        ax: any axes.
        cells: by row and column (right, runs, low, high); None where nothing was run.
        rows: their names.
        columns: the noises.
        what: the rows are, with the unit.
        title: of the plot.
    """
    shares = [[np.nan if cell is None else cell[0] / cell[1] for cell in row] for row in cells]
    ax.imshow(shares, cmap=_NONE_TO_ALL, vmin=0, vmax=1, aspect="auto")
    for y, row in enumerate(cells):
        for x, cell in enumerate(row):
            if cell is not None:
                right, runs, low, high = cell
                text = f"{right:.0f} of {runs:.0f}\n{100 * low:.0f} to {100 * high:.0f} %"
                ax.text(x, y, text, ha="center", va="center", fontsize=TEXT_SIZE["tick"])
    ax.set_xticks(range(len(columns)), columns)
    ax.set_yticks(range(len(rows)), rows)
    label_axes(ax, LABELS["noise"], what, title).grid(False)
    return ax
