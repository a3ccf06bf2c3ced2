"""The springs of lesson 03, to be pulled: drag a pose or an object, watch chi2, and let go."""

from dataclasses import replace
from itertools import islice

import numpy as np

from npslam_teach import se2, simulate
from npslam_teach.course.explorers import Explorer, places, player
from npslam_teach.course.pose_graph.figures import toy_before_and_after
from npslam_teach.course.scene import Panel, Scene
from npslam_teach.plotting.factor_graph import observation_segments, residual_segments
from npslam_teach.pose_graph import gauss_newton
from npslam_teach.types import PoseGraph

SIZE = (980.0, 430.0)  # px
ROOM = Panel((60.0, 36.0, 560.0, 340.0), (-1.1, 5.7), (-1.3, 2.8))  # m; 82 px per metre on both axes, nearly
STEPS = 6  # of Gauss-Newton
CHI2 = Panel((710.0, 36.0, 250.0, 340.0), (-0.6, STEPS + 0.6), (0.0, 5.0))  # log10 of 1 + chi2


def explore_springs() -> Explorer:
    """The toy scene with known associations, at its minimum; where a drag ends, Gauss-Newton begins."""
    _, graph = toy_before_and_after()
    object_class = simulate.toy_objects()[1].world.object_class
    moved = len(graph.poses) - 1  # pose 0 stands still
    runs: dict[bytes, list] = {}

    def update(xy: np.ndarray, iteration: int) -> tuple[str, Scene]:
        if xy.tobytes() not in runs:
            runs.clear()  # the present one is enough
            runs[xy.tobytes()] = list(islice(gauss_newton(_placed(graph, xy)), STEPS + 1))
        run = runs[xy.tobytes()]
        now = run[min(iteration, len(run) - 1)]
        scene = Scene(SIZE)
        _draw_room(scene, now.graph, object_class)
        _draw_chi2(scene, [step.chi2 for step in run], min(iteration, len(run) - 1))
        return words(now.graph, iteration, now.chi2), scene

    xy = np.concatenate([graph.poses[1:, :2], graph.landmarks])
    points = places(f"poses 1 to {moved}, and the objects", xy, ROOM, key=0.1, released="iteration")
    return Explorer(None, update, xy=points, iteration=player("Gauss-Newton step", STEPS, 700))


def words(graph: PoseGraph, iteration: int, chi2: float) -> str:
    """chi2, and the spring that is stretched most."""
    lengths = np.linalg.norm(np.diff(residual_segments(graph), axis=1)[:, 0], axis=1)
    k = int(np.argmax(lengths))
    pose, thing = graph.observations.pose[k], graph.observations.landmark[k]
    when = f"After step {iteration} of Gauss-Newton" if iteration else "As it is held"
    return (
        f"{when}, chi2 is {chi2:.1f}. The sighting that misses most is that of object {thing + 1} "
        f"from pose {pose}: by {lengths[k]:.2f} m."
    )


def _placed(graph: PoseGraph, xy: np.ndarray) -> PoseGraph:
    """The graph with its poses but pose 0 and its landmarks moved; headings stay."""
    poses, moved = graph.poses.copy(), len(graph.poses) - 1
    poses[1:, :2] = xy[:moved]
    return replace(graph, poses=poses, landmarks=xy[moved:].copy())


def _draw_room(scene: Scene, graph: PoseGraph, object_class) -> None:
    ROOM.axes(scene, "map", "every measurement is a spring", ("x (m)", "y (m)"), (range(-1, 6), range(-1, 3)))
    ROOM.line(scene, "path", graph.poses[:, :2], "estimate")
    for k, (sight, miss) in enumerate(zip(observation_segments(graph), residual_segments(graph), strict=True)):
        ROOM.line(scene, f"sighting {k}", sight, "spring")
        ROOM.line(scene, f"miss {k}", miss, "pull")
    predicted = se2.compose(graph.poses[graph.between.i], graph.between.relative_pose)
    for k, (wheels, j) in enumerate(zip(predicted, graph.between.j, strict=True)):
        ROOM.line(scene, f"slip {k}", [wheels[:2], graph.poses[j, :2]], "pull")
    points = [*graph.poses[1:, :2], *graph.landmarks]
    for t, pose in enumerate(graph.poses):
        x, y = ROOM.to_page(pose[:2])[0]
        ahead = pose[:2] + 0.25 * np.array([np.cos(pose[2]), np.sin(pose[2])])
        ROOM.line(scene, f"heading {t}", [pose[:2], ahead], "estimate")
        scene.add(f"pose {t}", "circle", cx=x, cy=y, r=6, class_="ink")
        ROOM.text(scene, f"pose name {t}", pose[:2], f"{t}", (12.0, -9.0), "bold")
    for k, point in enumerate(graph.landmarks):
        ROOM.mark(scene, f"object {k}", point, int(object_class[k]))
    hint = "drag a pose or an object and let go, or move it with the arrow keys; pose 0 stands still"
    scene.add("hint", "text", hint, x=60, y=SIZE[1] - 4, class_="quiet small", data_places="xy")
    for k, point in enumerate(points):
        name = f"pose {k + 1}" if k < len(graph.poses) - 1 else f"object {k - len(graph.poses) + 2}"
        ROOM.handle(scene, f"handle {k}", point, ("xy", k), f"{name} at {point[0]:.2f} m, {point[1]:.2f} m", 13.0)


def _draw_chi2(scene: Scene, values: list[float], now: int) -> None:
    """A bar for every step; the present one is dark."""
    height = np.log10(1 + np.array(values))
    title = f"chi2: {values[now]:.1f}"
    CHI2.axes(scene, "chi2", title, ("step of Gauss-Newton", "log10 of 1 + chi2"), (range(STEPS + 1), range(6)))
    for k in range(STEPS + 1):
        top = min(height[min(k, len(values) - 1)], CHI2.y[1])
        corner, foot = CHI2.to_page([(k - 0.35, top), (k + 0.35, 0.0)])
        size = {"width": foot[0] - corner[0], "height": foot[1] - corner[1]}
        color = "#00659f" if k == now else "#b5b5b5"
        scene.add(f"chi2 {k}", "rect", x=corner[0], y=corner[1], fill=color, class_="mark", **size)
