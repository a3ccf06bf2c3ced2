"""The restaurant: guests at their tables, and how likely the next guest is to sit down at each of them."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle

from npslam_teach.association import reweight
from npslam_teach.course.dirichlet_process.pictures import NEW
from npslam_teach.plotting.style import CLASS_COLORS, ESTIMATE_COLOR, TEXT_SIZE

TABLE_COLOR = "#cfe3f1"


def plot_restaurant(ax: Axes, counts, alpha: float) -> Axes:
    """A disc for each table, a dot for each guest, an empty table, and the next guest's probabilities below.

    Args:
        ax: any axes; its frame is hidden.
        counts: (K,) guests at each table.
        alpha: the weight of a new table.
    """
    probabilities = reweight(np.array(counts, dtype=float), alpha)
    for k, probability in enumerate(probabilities):
        is_new = k == len(counts)
        style = NEW | {"linewidth": 1.0} if is_new else {"facecolor": TABLE_COLOR, "edgecolor": ESTIMATE_COLOR}
        ax.add_patch(Circle((2.6 * k, 0.0), 0.7, **style))
        guests = 0 if is_new else counts[k]
        around = np.linspace(0.0, 2 * np.pi, max(guests, 1), endpoint=False) + np.pi / 2
        seats = np.column_stack([2.6 * k + np.cos(around), np.sin(around)])[:guests]
        ax.plot(*seats.T, linestyle="none", marker="o", markersize=12, color=CLASS_COLORS[0])
        weight = f"{alpha:g}" if is_new else f"{guests}"
        text = f"{'new table' if is_new else 'table ' + str(k + 1)}: weight {weight}\nprobability {probability:.2f}"
        ax.text(2.6 * k, -1.75, text, ha="center", va="center", fontsize=TEXT_SIZE["legend"])
    ax.set(xlim=(-1.4, 2.6 * len(counts) + 1.4), ylim=(-2.3, 1.4), aspect="equal")
    ax.set_title("the next guest prefers the table where most sit", fontsize=TEXT_SIZE["title"])
    ax.set_axis_off()
    return ax
