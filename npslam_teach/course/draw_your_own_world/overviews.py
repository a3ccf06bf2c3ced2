"""Draw your own world: the gallery at a glance, and how the number of objects scatters from drive to drive."""

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from npslam_teach import se2
from npslam_teach.course.small_pictures import dots_figure
from npslam_teach.plotting.maps import plot_objects, plot_trajectory
from npslam_teach.plotting.style import (
    ESTIMATE_COLOR,
    class_handles,
    class_style,
    label_map,
    legend_inside,
    new_figure,
    path_handles,
)
from npslam_teach.simulate import GalleryWorld
from npslam_teach.simulate.hand_drawn import Drawing, drawn_path, drawn_run

_PLACES = [["twins", "one-class", "moving", "false-detector"], ["corridor", "corridor", "corridor", "legend"]]
ASSUMPTIONS = {
    "twins": "two chairs are half a metre apart",
    "corridor": "no place is seen again",
    "one-class": "all are chairs",
    "moving": "one screen moves",
    "false-detector": "pale: what is not there",
}


def gallery_figure(gallery: dict[str, GalleryWorld]) -> Figure:
    """The worlds as they were drawn, each under the assumption that it breaks.

    Args:
        gallery: by the keys of ``ASSUMPTIONS``.
    """
    figure, whole = new_figure(size=(13.0, 5.6))
    whole.remove()
    axes = figure.subplot_mosaic(_PLACES, height_ratios=(1.0, 0.9))
    for key, says in ASSUMPTIONS.items():
        _plot_drawing(axes[key], gallery[key].drawing, says)
    names = gallery["moving"].drawing.class_names
    legend_inside(axes["legend"], class_handles(range(len(names)), names) + path_handles(["true path"])).axis("off")
    return figure


def _plot_drawing(ax: Axes, drawing: Drawing, says: str) -> None:
    plot_trajectory(ax, drawn_path(drawing.stroke), truth=True)
    if drawing.clutter_rate > 0:
        _plot_false_sightings(ax, drawing)
    plot_objects(ax, drawing.object_xy, drawing.object_class, drawing.class_names, sizes=60)
    for here, there in zip(drawing.object_xy, drawing.object_goal, strict=True):
        if (here != there).any():
            arrow = {"arrowstyle": "-|>", "color": ESTIMATE_COLOR, "linewidth": 1.6, "mutation_scale": 16}
            ax.annotate("", there, here, arrowprops=arrow)
    left, bottom, right, top = drawing.room
    label_map(ax, says).set(xlim=(left, right), ylim=(bottom, top))


def _plot_false_sightings(ax: Axes, drawing: Drawing) -> None:
    log, truth = drawn_run(drawing)
    false = truth.obs_object < 0
    at = se2.apply(truth.poses[log.obs_time[false]], log.obs_xy[false])
    for xy, c in zip(at, log.obs_class[false], strict=True):
        color, marker = class_style(c)
        ax.plot(*xy, marker, color=color, markersize=5, alpha=0.45, markeredgewidth=0, zorder=1.7)


def gaps_figure(found: dict[float, list[int]], there: int) -> Figure:
    """How many objects were found where two of a class stand at some distance from each other.

    Args:
        found: by the distance in m, the number in each run; at one of them most are right.
        there: how many there are.
    """
    apart = min(gap for gap, numbers in found.items() if max(numbers) >= there)
    right = min(gap for gap, numbers in found.items() if 2 * numbers.count(there) > len(numbers))
    title = f"they begin to come apart at {apart:g} m, most runs are right from {right:g} m on"
    groups = {f"{gap:g} m": numbers for gap, numbers in found.items()}
    return dots_figure(groups, ("gap", "objects found"), title, line=(there, "are there"))


def drives_figure(found: list[int], there: int) -> Figure:
    """How many objects were found in several drives through one drawing, which differ in their noise alone.

    Args:
        found: in each drive.
        there: how many there are.
    """
    title = f"one drawing, {len(found)} drives: exactly {there} found in {found.count(there)}"
    groups = {str(seed): [number] for seed, number in enumerate(found)}
    figure = dots_figure(groups, ("seed of the noise", "objects found"), title, line=(there, "are there"))
    figure.axes[0].yaxis.set_major_locator(MaxNLocator(integer=True))
    return figure
