"""The explorer of lesson 10: noise and kernel width, with the share of all rooms and the map of one."""

from npslam_teach import plotting
from npslam_teach.course.explorers import Explorer, choice, slider
from npslam_teach.course.what_breaks import pictures, table
from npslam_teach.evaluation import compare_partitions, distances_to_truth
from npslam_teach.methods import METHODS
from npslam_teach.plotting import moving_map
from npslam_teach.plotting.style import ESTIMATE_COLOR, legend_below
from npslam_teach.types import GroundTruth, Snapshot

NOISES = (1, 2, 3)


def results_of(scenes: dict) -> dict[tuple, Snapshot]:
    """What NP-graph finds for every noise and kernel width of the table, by (noise, kernel_std).

    Args:
        scenes: noise to (log, truth); all of one room.
    """
    kernels = table.swept("kernel_std")
    return {
        (noise, width): list(METHODS["np-graph"](log, **({} if case == "np-graph" else {"kernel_std": width})))[-1]
        for noise, (log, _) in scenes.items()
        for width, case in kernels.items()
    }


def explore_kernel(scenes: dict, results: dict[tuple, Snapshot]) -> Explorer:
    """Choose noise and kernel width; the results are computed in advance, so that the picture follows at once.

    Args:
        scenes: noise to (log, truth), for whole numbers without a gap.
        results: from ``results_of``.
    """
    kernels = table.swept("kernel_std")
    figure, (left, right) = plotting.new_figure(1, 2, (12.0, 5.8), width_ratios=(1.3, 1))
    log, truth = next(iter(scenes.values()))
    move_map = moving_map.plot_moving_map(left, list(results.values()), log, truth)
    curves = [_curve(right, noise) for noise in scenes]
    (here,) = right.plot([], [], "o", markersize=16, markerfacecolor="none", color=ESTIMATE_COLOR, markeredgewidth=2.5)
    right.set_title("all rooms; dashed: the paper's width")
    legend_below(figure, moving_map.moving_map_handles(truth), columns=8)

    def update(noise: int, kernel_std: float) -> str:
        for each, artists in zip(scenes, curves, strict=True):
            for artist in artists:
                artist.set_visible(each == noise)
        right_runs, runs, _, _ = table.share_of(kernels[kernel_std], noise)
        here.set_data([list(kernels).index(kernel_std)], [right_runs / runs])
        last = results[noise, kernel_std]
        move_map(last, f"one room: {last.num_objects} objects")
        return words(noise, kernel_std, last, scenes[noise][1])

    sliders = {
        "noise": slider("noise (paper = 1)", int(min(scenes)), int(min(scenes)), int(max(scenes)), 1),
        "kernel_std": choice("kernel width (m)", {f"{width:g}": width for width in kernels}),
    }
    return Explorer(figure, update, {"noise": list(scenes), "kernel_std": list(kernels)[::2]}, **sliders)


def words(noise: int, kernel_std: float, last: Snapshot, truth: GroundTruth) -> str:
    """The share over all rooms, and the result in one, in numbers."""
    right, runs, low, high = table.share_of(table.swept("kernel_std")[kernel_std], noise)
    ari, error = compare_partitions(truth.obs_object, last.labels)[0], distances_to_truth(last, truth)[0].mean()
    return (
        f"Noise {noise:g}, kernel {kernel_std:g} m: right in {right} of {runs} rooms (95 % interval {100 * low:.0f} to "
        f"{100 * high:.0f} %). This room: {last.num_objects} objects, ARI {ari:.2f}, mean pose error {error:.2f} m."
    )


def _curve(ax, noise: float) -> list:
    """The curve of one noise with its intervals: every artist of it."""
    before = set(ax.get_children())
    pictures.plot_setting(ax, "kernel_std", noise)
    papers_line = ax.lines[-1]
    return [artist for artist in ax.get_children() if artist not in before and artist is not papers_line]
