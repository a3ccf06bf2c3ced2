"""The explorer of lesson 14: one hall with ever worse headings."""

from npslam_teach import plotting
from npslam_teach.course.explorers import Explorer, choice
from npslam_teach.course.orientation.hall_map import hall_handles, laid_over, noses, plot_noses
from npslam_teach.evaluation import evaluate
from npslam_teach.experiments.back_to_back import DEGREES, answer, hall
from npslam_teach.plotting import moving_map
from npslam_teach.plotting.style import ESTIMATE_COLOR, legend_below
from npslam_teach.types import Snapshot

METHODS = {"NP-graph": "np-graph", "filter": "ekf"}


def results_of(seed: int, degrees=DEGREES) -> dict[tuple, Snapshot]:
    """The end of both methods, by (method, degrees).

    Args:
        seed: of the hall.
        degrees: by which a heading errs; 0: without headings.
    """
    return {(name, each): answer(case, *hall(seed, each)) for name, case in METHODS.items() for each in degrees}


def said_of(degrees: float) -> str:
    """How good headings are, in words."""
    return f"{degrees:g} degrees" if degrees else "no headings"


def explore_headings(seed: int, results: dict[tuple, Snapshot]) -> Explorer:
    """Choose the method and how much a heading errs; the map follows.

    Args:
        seed: of the hall.
        results: from ``results_of``.
    """
    degrees = sorted({each for _, each in results})
    log, truth = hall(seed, degrees[-1])
    figure, ax = plotting.new_figure(size=(7.6, 7.6))
    move_map = moving_map.plot_moving_map(ax, list(results.values()), log, truth)
    plot_noses(ax, truth.world.object_xy, truth.world.object_theta, truth=True)
    (lines,) = ax.plot([], [], color=ESTIMATE_COLOR, linewidth=1.6, zorder=2.7)
    legend_below(figure, hall_handles(truth))

    def update(method: str, error: float) -> str:
        last = results[method, error]
        _, xy, theta = laid_over(last, truth)
        found = evaluate(last, truth, hall(seed, error)[0])
        move_map(last, f"{method}, {said_of(error)}: {last.num_objects} objects")
        lines.set_data(*noses(xy, theta))
        return (
            f"{method}, {said_of(error)}: {last.num_objects} objects, 8 are there; ARI {found.ari:.2f}, "
            f"mean pose error {found.mean_pose_error:.2f} m."
        )

    sliders = {
        "method": choice("method", {name: name for name in METHODS}),
        "error": choice("a heading errs by", {said_of(each): each for each in degrees}),
    }
    return Explorer(figure, update, {name: each.grid() for name, each in sliders.items()}, **sliders)
