"""The explorer of lesson 07: the whole method is run for every alpha and threshold."""

from npslam_teach import plotting
from npslam_teach.course.explorers import Explorer, choice, slider
from npslam_teach.evaluation import compare_partitions, distances_to_truth
from npslam_teach.methods import np_graph
from npslam_teach.plotting import moving_map
from npslam_teach.plotting.style import ESTIMATE_COLOR, TEXT_SIZE, TRUTH_LINE, label_axes, legend_below
from npslam_teach.types import GroundTruth, RobotLog, Snapshot

RULES = {"the most probable wins": None} | {f"p above {p}": p for p in (0.002, 0.01, 0.03, 0.05, 0.1, 0.2, 0.5)}
ITERATIONS = 5


def explore_method(log: RobotLog, truth: GroundTruth) -> Explorer:
    """Choose alpha and the rule of acceptance; five rounds are run, and the result is aligned to the truth.

    Args:
        log: what the robot measured; a run must take a fraction of a second.
        truth: drawn behind.
    """
    figure, (left, right) = plotting.new_figure(1, 2, (11.5, 5.6), width_ratios=(1.5, 1))
    # The result of frame-by-frame is the largest; the limits of its map hold every other result too.
    move_map = moving_map.plot_moving_map(left, [next(np_graph(log))], log, truth)
    (curve,) = right.plot([], [], "o-", color=ESTIMATE_COLOR, markersize=8)
    num_true = len(truth.world.object_xy)
    right.axhline(num_true, label=f"true number: {num_true}", **TRUTH_LINE)
    right.set(yscale="log", xlim=(-0.4, ITERATIONS + 0.4), ylim=(3, 1.6 * log.num_observations))
    right.legend(loc="upper right", frameon=False, fontsize=TEXT_SIZE["legend"])
    label_axes(right, "iteration (number)", "objects (number, log scale)", "objects per iteration")
    legend_below(figure, moving_map.moving_map_handles(truth), columns=8)

    def update(alpha: float, threshold: float | None) -> str:
        snapshots = list(np_graph(log, alpha, threshold, ITERATIONS))
        move_map(snapshots[-1], f"{snapshots[-1].num_objects} objects")
        curve.set_data([s.iteration for s in snapshots], [s.num_objects for s in snapshots])
        return words(alpha, threshold, snapshots, truth)

    sliders = {"alpha": slider("alpha", 0.9, 0.05, 1.5, 0.05), "threshold": choice("acceptance", RULES)}
    frames = {"alpha": (0.3, 0.9, 1.2), "threshold": (None, 0.03)}
    return Explorer(figure, update, frames, **sliders)


def words(alpha: float, threshold: float | None, snapshots: list[Snapshot], truth: GroundTruth) -> str:
    """The result of a run, in numbers."""
    last = snapshots[-1]
    rule = "the most probable wins" if threshold is None else f"a match needs p above {threshold}"
    error = distances_to_truth(last, truth)[0].mean()
    ari = compare_partitions(truth.obs_object, last.labels)[0]
    counts = ", ".join(str(s.num_objects) for s in snapshots)
    return f"Alpha {alpha:.2f}, {rule}: objects {counts}; mean pose error {error:.2f} m, ARI {ari:.2f}."
