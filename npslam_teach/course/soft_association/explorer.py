"""The explorer of lesson 13: rounds of soft association on one room, for detectors that err more or less often."""

from npslam_teach import plotting
from npslam_teach.course.explorers import Explorer, choice, slider
from npslam_teach.evaluation import distances_to_truth
from npslam_teach.experiments.confused_classes import SHARES, room
from npslam_teach.methods import np_graph, soft_em
from npslam_teach.plotting import moving_map
from npslam_teach.plotting.style import legend_below
from npslam_teach.types import Snapshot

METHODS = {"soft association": soft_em, "NP-graph": np_graph}


def results_of(seed: int, shares=SHARES) -> dict[tuple, list[Snapshot]]:
    """Every snapshot of both methods but the frame-by-frame start, by (method, share).

    Args:
        seed: of the room.
        shares: of wrong reports.
    """
    return {
        (name, share): list(method(room(seed, share)[0]))[1:] for name, method in METHODS.items() for share in shares
    }


def explore_confusion(seed: int, results: dict[tuple, list[Snapshot]]) -> Explorer:
    """Choose the method, the share of wrong reports and the round; the map follows.

    Args:
        seed: of the room.
        results: from ``results_of``.
    """
    shares = sorted({share for _, share in results})
    log, truth = room(seed, shares[0])
    figure, ax = plotting.new_figure(size=(8.0, 7.2))
    move_map = moving_map.plot_moving_map(ax, [snapshots[-1] for snapshots in results.values()], log, truth)
    legend_below(figure, moving_map.moving_map_handles(truth), columns=4)

    def update(method: str, share: float, round: int) -> str:
        snapshots = results[method, share]
        last = snapshots[min(round, len(snapshots)) - 1]
        error = distances_to_truth(last, truth)[0].mean()
        move_map(last, f"{method}: {last.num_objects} objects")
        ended = "" if round <= len(snapshots) else f" (it ended after {len(snapshots)})"
        return (
            f"{method}, {100 * share:.0f} % of the reports wrong, round {round}{ended}: {last.num_objects} objects, "
            f"15 are there; mean pose error {error:.2f} m."
        )

    most = max(len(snapshots) for snapshots in results.values())
    sliders = {
        "method": choice("method", {name: name for name in METHODS}),
        "share": choice("wrong reports", {f"{100 * share:.0f} %": share for share in shares}),
        "round": slider("round", most, 1, most, 1),
    }
    return Explorer(figure, update, {name: sliders[name].grid() for name in ("method", "share")}, **sliders)
