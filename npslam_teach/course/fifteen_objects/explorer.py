"""The explorer of lesson 07: the whole method is run for every alpha and threshold."""

import numpy as np

from npslam_teach.course import moving_scene
from npslam_teach.course.explorers import Explorer, choice, slider
from npslam_teach.course.scene import Panel, Scene
from npslam_teach.evaluation import compare_partitions, distances_to_truth
from npslam_teach.methods import np_graph
from npslam_teach.types import GroundTruth, RobotLog, Snapshot

RULES = {"the most probable wins": None} | {f"p above {p}": p for p in (0.002, 0.01, 0.03, 0.05, 0.1, 0.2, 0.5)}
ITERATIONS = 5
FRAMES = {"alpha": (0.3, 0.5, 0.7, 0.9, 0.95, 1.0, 1.2), "threshold": (None, 0.03)}  # without a kernel
SIZE = (980.0, 560.0)  # px
MAP, COUNTS = (60.0, 36.0, 560.0, 440.0), (700.0, 36.0, 260.0, 440.0)


def explore_method(log: RobotLog, truth: GroundTruth) -> Explorer:
    """Choose alpha and the rule of acceptance; five rounds are run, and the result is aligned to the truth.

    Args:
        log: what the robot measured; a run must take a fraction of a second.
        truth: drawn behind.
    """
    # The result of frame-by-frame is the largest; its map holds every other result too.
    room = moving_scene.room_of([next(np_graph(log))], truth, MAP)
    num_true = len(truth.world.object_xy)
    panel = Panel(COUNTS, (-0.4, ITERATIONS + 0.4), (0.5, float(np.ceil(np.log10(log.num_observations)))))

    def update(alpha: float, threshold: float | None) -> tuple[str, Scene]:
        snapshots = list(np_graph(log, alpha, threshold, ITERATIONS))
        counts = [s.num_objects for s in snapshots]
        scene = Scene(SIZE)
        moving_scene.draw_snapshot(scene, room, snapshots[-1], log, truth, f"{counts[-1]} objects")
        title = "objects (log scale)"
        moving_scene.log_axes(scene, panel, "counts", title, "iteration (number)", range(ITERATIONS + 1))
        panel.line(scene, "true number", [(x, np.log10(num_true)) for x in panel.x], "truth")
        panel.text(scene, "true name", (panel.x[1], np.log10(num_true)), f"true: {num_true}", (-6.0, 18.0), "end quiet")
        moving_scene.draw_curve(scene, panel, "counts", np.log10(counts))
        moving_scene.draw_key(scene, truth, (MAP[0], SIZE[1] - 12))
        return words(alpha, threshold, snapshots, truth), scene

    sliders = {"alpha": slider("alpha", 0.9, 0.05, 1.5, 0.05, 1200), "threshold": choice("acceptance", RULES)}
    return Explorer(None, update, FRAMES, **sliders)


def words(alpha: float, threshold: float | None, snapshots: list[Snapshot], truth: GroundTruth) -> str:
    """The result of a run, in numbers."""
    last = snapshots[-1]
    rule = "the most probable wins" if threshold is None else f"a match needs p above {threshold}"
    error = distances_to_truth(last, truth)[0].mean()
    ari = compare_partitions(truth.obs_object, last.labels)[0]
    counts = ", ".join(str(s.num_objects) for s in snapshots)
    return f"Alpha {alpha:.2f}, {rule}: objects {counts}; mean pose error {error:.2f} m, ARI {ari:.2f}."
