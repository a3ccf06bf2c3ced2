"""The explorer of lesson 15: what a robot believes after each tenth of its drive."""

from npslam_teach import plotting
from npslam_teach.course.explorers import Explorer, slider
from npslam_teach.evaluation import compare_partitions
from npslam_teach.plotting import moving_map
from npslam_teach.plotting.style import legend_below
from npslam_teach.types import GroundTruth, RobotLog, Snapshot


def explore_drive(log: RobotLog, truth: GroundTruth, snapshots: list[Snapshot]) -> Explorer:
    """Drive on by a tenth; the map follows.

    Args:
        log: what was measured.
        truth: to compare with.
        snapshots: of ``online``, without the frame-by-frame start.
    """
    figure, ax = plotting.new_figure(size=(8.0, 7.2))
    move_map = moving_map.plot_moving_map(ax, snapshots, log, truth)
    legend_below(figure, moving_map.moving_map_handles(truth), columns=4)

    def update(tenth: int) -> str:
        now = snapshots[tenth - 1]
        seen = now.labels >= 0
        ari = compare_partitions(truth.obs_object[seen], now.labels[seen])[0]
        move_map(now, f"after tenth {tenth}: {now.num_objects} objects")
        return (
            f"After tenth {tenth} of the drive: {now.num_objects} objects; {100 * seen.mean():.0f} % of all "
            f"observations have one, ARI {ari:.3f} among these."
        )

    sliders = {"tenth": slider("tenth", len(snapshots), 1, len(snapshots), 1)}
    return Explorer(figure, update, {"tenth": sliders["tenth"].grid()}, **sliders)
