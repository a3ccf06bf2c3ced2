"""Pictures of what lesson 11 computes by hand: a Gibbs move, four chains, an eliminated pose, and shared drift."""

import numpy as np
from matplotlib.figure import Figure

from npslam_teach.plotting.style import (
    CLASS_COLORS,
    CLASS_MARKERS,
    TRUTH_LINE,
    label_axes,
    label_map,
    legend_beside,
    new_figure,
)
from npslam_teach.plotting.uncertainty import ellipse_points


def moves_figure(moves: dict) -> Figure:
    """Where one sighting goes, in groups of bars: a group for every place, a bar for every case.

    Args:
        moves: by the object that 7 is with: place to probability, the same places in each.
    """
    figure, ax = new_figure(size=(9.0, 3.8))
    width = 0.8 / len(moves)
    for k, (name, move) in enumerate(moves.items()):
        at = np.arange(len(move)) + (k - (len(moves) - 1) / 2) * width
        style = {"color": CLASS_COLORS[k], "hatch": ("", "//")[k % 2], "edgecolor": "white"}
        ax.bar(at, list(move.values()), width, label=f"7 is with {name}", **style)
    ax.set_xticks(range(len(move)), list(move))
    ax.set_ylim(0.0, 1.02)
    legend_beside(ax)
    label_axes(ax, "where 8 goes (object)", "probability (no unit)", "8 goes where 7 is")
    return figure


def running_share_figure(chains: np.ndarray, exact: float, what: str) -> Figure:
    """The share of samples so far along every chain, and the exact one.

    Args:
        chains: (C, n) bool.
        exact: dashed grey.
        what: of which samples the share is.
    """
    figure, ax = new_figure(size=(9.0, 4.0))
    counts = np.arange(1, chains.shape[1] + 1)
    shares = np.cumsum(chains, axis=1) / counts
    for k, share in enumerate(shares):
        style = {"color": CLASS_COLORS[k], "marker": CLASS_MARKERS[k], "markevery": (4 * k, 20), "markersize": 7}
        ax.plot(counts, share, label=f"chain {k + 1}", **style)
    ax.axhline(exact, label=f"exact: {exact:.2f}", **TRUTH_LINE)
    ax.set_ylim(-0.02, 1.02)
    legend_beside(ax)
    last = shares[:, -1]
    title = f"after {len(counts)} sweeps the chains still differ, {last.min():.2f} to {last.max():.2f}"
    label_axes(ax, "sweeps (number)", f"{what}, share so far", title)
    return figure


def corridor_figure(places: np.ndarray, std: np.ndarray) -> Figure:
    """Where each chair of the corridor is, as a Gaussian density; the robot starts at 0.

    Args:
        places: (2,) m.
        std: (2,) m, with the pose integrated out.
    """
    figure, ax = new_figure(size=(9.0, 3.8))
    x = np.linspace(0.0, 2.6, 400)
    for k, (place, spread) in enumerate(zip(places, std, strict=True)):
        density = np.exp(-(((x - place) / spread) ** 2) / 2) / (spread * np.sqrt(2 * np.pi))
        look = {"color": CLASS_COLORS[k], "linestyle": ("-", "--")[k], "linewidth": 2.0}
        ax.plot(x, density, label=f"chair {k + 1}: {place:.1f} m, std {spread:.3f} m", **look)
        ax.fill_between(x, density, color=CLASS_COLORS[k], alpha=0.15, linewidth=0)
    ax.set_ylim(bottom=0.0)
    legend_beside(ax)
    title = "the second chair has the errors of wheels and camera"
    label_axes(ax, "place along the corridor (m)", "density (per m)", title)
    return figure


def shared_drift_figure(cov: np.ndarray, apart: np.ndarray) -> Figure:
    """The 95 % ellipses of the places of 7 and 8 and of their difference, all around 0.

    Args:
        cov: (2, 2, 2) m^2, of 7 and of 8.
        apart: (2, 2) m^2, of the place of 8 less that of 7.
    """
    figure, ax = new_figure(size=(8.0, 3.6))
    for k, (name, spread) in enumerate({"7": cov[0], "8": cov[1], "8 less 7": apart}.items()):
        look = {"color": CLASS_COLORS[k], "linestyle": ("-", "--", "-.")[k], "linewidth": 2.5}
        label = f"{name}: std in x {spread[0, 0] ** 0.5:.2f} m"
        ax.plot(*ellipse_points(np.zeros(2), spread).T, label=label, **look)
    legend_beside(ax)
    label_map(ax, "7 and 8 share their drift: it cancels in their difference")
    ax.set(xlabel="off in x (m, 95 % ellipses)", ylabel="off in y (m)")
    return figure
