"""The explorer of lesson 12: how much noise a method believes in, what it finds, and how well."""

from npslam_teach import plotting
from npslam_teach.course.a_real_robot import pictures, table
from npslam_teach.course.explorers import Explorer, choice, slider
from npslam_teach.evaluation import compare_partitions, distances_to_truth, singletons_for_unassigned
from npslam_teach.experiments.real_robot import COMPARED, FACTORS, Case, imported, run_case, scaled
from npslam_teach.methods.snapshots import snapshot
from npslam_teach.plotting import moving_map
from npslam_teach.plotting.style import ESTIMATE_COLOR, legend_below
from npslam_teach.pose_graph import fit
from npslam_teach.types import GroundTruth, Snapshot


def results_of_recording_0() -> dict[tuple, Snapshot]:
    """What each method finds in recording 0 for every factor of the noise, by (method, factor).

    The labels of the slowest are those of the table; its map is solved from them.
    """
    results = {}
    for factor in FACTORS:
        for method in COMPARED[:2]:
            results[method, factor] = run_case(Case(method, "own", factor), 0)
        log, labels = scaled(imported(0)[0], factor), table.labels_of(COMPARED[2], factor)
        results[COMPARED[2], factor] = snapshot(log, 1, labels, fit(log, labels))
    return results


def explore_believed_noise(results: dict[tuple, Snapshot]) -> Explorer:
    """Choose a method and what it believes; nothing is run, so that the picture follows at once.

    Args:
        results: from ``results_of_recording_0``.
    """
    figure, (left, middle, right) = plotting.new_figure(1, 3, (14.5, 5.6), width_ratios=(1.1, 1, 1))
    log, truth = imported(0)
    move_map = moving_map.plot_moving_map(left, list(results.values()), log, truth)
    pictures.plot_factors(middle, "objects", "objects (number, log scale)", len(truth.world.object_xy))
    pictures.plot_factors(right, "pose_error", "mean pose error (m, log scale)")
    middle.set_title("objects in all recordings")
    right.set_title("path in all recordings")
    ring = {"markersize": 16, "markerfacecolor": "none", "color": ESTIMATE_COLOR, "markeredgewidth": 2.5}
    rings = [ax.plot([], [], "o", **ring)[0] for ax in (middle, right)]
    handles = moving_map.moving_map_handles(truth) + middle.get_legend_handles_labels()[0]
    legend_below(figure, handles, columns=6)

    def update(method: str, power: int) -> str:
        factor, last = 2.0**power, results[method, 2.0**power]
        (row, *_) = table.runs_of(method, "own", factor)
        for artist, name in zip(rings, ("objects", "pose_error"), strict=True):
            artist.set_data([factor], [row[name]])
        move_map(last, f"recording 0: {last.num_objects} objects")
        return words(method, factor, last, truth)

    sliders = {
        "method": choice("method", {name: name for name in COMPARED[::-1]}),
        "power": slider("log2 of noise factor", 0, -2, 2, 1),
    }
    return Explorer(figure, update, {"method": COMPARED, "power": (-2, 0, 2)}, **sliders)


def words(method: str, factor: float, last: Snapshot, truth: GroundTruth) -> str:
    """One recording, and the medians of all, in numbers."""
    labels = (singletons_for_unassigned(each) for each in (truth.obs_object, last.labels))
    ari, error = compare_partitions(*labels)[0], distances_to_truth(last, truth)[0].mean()
    runs = [table.column(name, method, "own", factor) for name in ("objects", "pose_error")]
    objects, path = (table.median_and_range(values, decimals) for values, decimals in zip(runs, (0, 2), strict=True))
    return (
        f"{method} believes {factor:g} times the true noise. Recording 0 (ring): {last.num_objects} objects, ARI "
        f"{ari:.2f}, path off by {error:.2f} m. {len(runs[0])} recordings: {objects} objects, path "
        f"off by {path} m."
    )
