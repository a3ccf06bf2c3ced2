"""From a drawing to an answer: a run through the drawn world, the result of the paper's method, and words for it.

Nothing here draws or needs a browser; ``explorer`` connects it to one. The page and the kernel exchange plain numbers
and text, in dictionaries that are described below.
"""

from dataclasses import dataclass

import numpy as np

from npslam_teach import se2
from npslam_teach.evaluation import distances_to_truth
from npslam_teach.methods import METHODS, np_graph
from npslam_teach.simulate.hand_drawn import MAX_CLUTTER, MAX_NOISE, Drawing, drawn_run
from npslam_teach.simulate.robot_run import ADDED_ODOMETRY_STD, FILE_ODOMETRY_STD
from npslam_teach.system.files import shorten
from npslam_teach.types import GroundTruth, RobotLog, Snapshot

SHOWN_METHODS = {"np-graph": "NP-graph", "ekf": "EKF", "posterior": "posterior"}  # by name: what the page calls it
MILLIMETRES = 3  # decimals of metres on their way to the page
_OBJECT_KEYS = {"x", "y", "class", "goal_x", "goal_y"}
_MARGIN = 1.0  # m around a loaded world


@dataclass(frozen=True, eq=False)
class SolvedWorld:
    """A run through a drawn world, and every round of the method on it."""

    log: RobotLog
    truth: GroundTruth
    snapshots: list[Snapshot]


def solve(log: RobotLog, truth: GroundTruth, method: str = "np-graph") -> SolvedWorld:
    """Run a method with its own settings; the paper's as ``python3 -m npslam_teach solve`` does.

    Args:
        log: what the robot measured.
        truth: what really happened.
        method: one of ``SHOWN_METHODS``.

    Raises:
        ValueError: it is another one.
    """
    if method not in SHOWN_METHODS:
        raise ValueError(f"method: expected one of {', '.join(SHOWN_METHODS)}, got {shorten(method)}")
    return SolvedWorld(log, truth, list(METHODS[method](log)))


def initial(log: RobotLog, truth: GroundTruth) -> SolvedWorld:
    """The run before the first round: the odometry path, and every observation an object of its own."""
    return SolvedWorld(log, truth, [next(np_graph(log))])


def solve_drawing(drawing: Drawing) -> SolvedWorld:
    """Drive through the drawn world and run the method on what was measured."""
    return solve(*drawn_run(drawing))


def num_seen(solved: SolvedWorld) -> int:
    """How many of the true objects were seen at least once."""
    return len(np.unique(solved.truth.obs_object[solved.truth.obs_object >= 0]))


def pose_error(solved: SolvedWorld, iteration: int) -> float:
    """The mean distance of the poses of a round from the true ones after the best rigid alignment, in m."""
    return float(distances_to_truth(solved.snapshots[iteration], solved.truth)[0].mean())


def words(solved: SolvedWorld) -> str:
    """The answer in two sentences, for those who cannot see the picture and for print."""
    wheels = pose_error(solved, 0)
    if solved.log.num_observations == 0:
        return (
            "The robot saw nothing: no object came within its range and view. "
            f"Only its wheels tell where it went, and they are off by {wheels:.2f} m on average."
        )
    counts = " → ".join(str(snapshot.num_objects) for snapshot in solved.snapshots)
    there = num_seen(solved)
    return (
        f"Objects: {counts}; {there} {'was' if there == 1 else 'were'} there to be seen. "
        f"The path is off by {pose_error(solved, -1):.2f} m on average, by the wheels alone {wheels:.2f} m."
    )


def round_words(solved: SolvedWorld, iteration: int) -> str:
    """One round in a sentence."""
    count = solved.snapshots[iteration].num_objects
    name = "At the start" if iteration == 0 else f"Round {iteration} of {len(solved.snapshots) - 1}"
    error = pose_error(solved, iteration)
    return f"{name}: {count} object{'' if count == 1 else 's'}, path off by {error:.2f} m on average."


def answer(solved: SolvedWorld) -> dict:
    """What the page needs to draw: the true path, and for each round the path, the objects and the associations.

    Returns:
        ``words``; ``num_seen``; ``path`` [x, y, x, y, ...] in m, W, the true one; ``sighting_class`` (M,); ``rounds``,
        each with ``words``, ``count``, ``path``, ``objects`` [x, y, class, observations, ...] and ``labels`` (M,), all
        aligned to the truth.
    """
    return {
        "words": words(solved),
        "num_seen": num_seen(solved),
        "path": _flat(solved.truth.poses[:, :2]),
        "sighting_class": solved.log.obs_class.tolist(),
        "rounds": [_round(solved, k) for k in range(len(solved.snapshots))],
    }


def _round(solved: SolvedWorld, iteration: int) -> dict:
    snapshot = solved.snapshots[iteration]
    xy = snapshot.graph.poses[:, :2]
    motion = se2.align(xy, solved.truth.poses[:, :2])
    votes = snapshot.votes[:, 1:]
    landmarks = se2.apply(motion, snapshot.graph.landmarks)
    objects = np.column_stack([landmarks, votes.argmax(axis=1), votes.sum(axis=1)])
    return {
        "words": round_words(solved, iteration),
        "count": snapshot.num_objects,
        "path": _flat(se2.apply(motion, xy)),
        "objects": _flat(objects),
        "labels": snapshot.labels.tolist(),
    }


def _flat(array: np.ndarray) -> list[float]:
    return np.round(array, MILLIMETRES).ravel().tolist()


def to_message(drawing: Drawing) -> dict:
    """A drawing as the page holds it.

    Returns:
        ``stroke`` [[x, y], ...] m; ``objects`` [{x, y, class, goal_x, goal_y}, ...]; ``class_names``; ``room``;
        ``noise``; ``clutter_rate``; ``seed``; ``method``, that of the paper.
    """
    rows = zip(_rounded(drawing.object_xy), _rounded(drawing.object_goal), drawing.object_class, strict=True)
    objects = [{"x": x, "y": y, "class": int(c), "goal_x": u, "goal_y": v} for (x, y), (u, v), c in rows]
    return {
        "stroke": _rounded(drawing.stroke),
        "objects": objects,
        "class_names": list(drawing.class_names),
        "room": _rounded(drawing.room),
        "noise": float(drawing.noise),
        "clutter_rate": float(drawing.clutter_rate),
        "seed": int(drawing.seed),
        "method": "np-graph",
    }


def _rounded(array: np.ndarray) -> list:
    return np.round(array, MILLIMETRES).tolist()


def from_message(message: dict) -> Drawing:
    """The drawing that a page sent.

    Args:
        message: as ``to_message`` makes it; other entries are ignored.

    Raises:
        ValueError: an entry is missing or is not what it should be.
    """
    wanted = ("stroke", "objects", "class_names", "room", "noise", "clutter_rate", "seed")
    missing = [name for name in wanted if name not in message]
    if missing:
        raise ValueError(f"drawing: expected the entries {', '.join(wanted)}, missing {', '.join(missing)}")
    for name in wanted:
        is_list, is_number = isinstance(message[name], list), isinstance(message[name], (int, float))
        if name in ("noise", "clutter_rate", "seed") and not is_number:
            raise ValueError(f"{name}: expected a number, got {shorten(message[name])}")
        if name in ("stroke", "objects", "class_names", "room") and not is_list:
            raise ValueError(f"{name}: expected a list, got {shorten(message[name])}")
    objects = message["objects"]
    for each in objects:
        if not isinstance(each, dict) or not each.keys() >= _OBJECT_KEYS:
            raise ValueError(f"objects: expected {', '.join(sorted(_OBJECT_KEYS))} for each, got {shorten(each)}")
    return Drawing(
        stroke=_pairs(message["stroke"]),
        object_xy=_pairs([(each["x"], each["y"]) for each in objects]),
        object_goal=_pairs([(each["goal_x"], each["goal_y"]) for each in objects]),
        object_class=[each["class"] for each in objects],
        **{name: message[name] for name in wanted[2:]},
    )


def _pairs(points: list):
    return points if points else np.empty((0, 2))


def drawing_of(log: RobotLog, truth: GroundTruth) -> Drawing:
    """The drawing that could have made a log: its true path and objects, and the noise that its odometry states.

    A file keeps neither the seed nor which objects were carried, so driving again gives another run, in a world where
    nothing moves.

    Raises:
        ValueError: the world is too large to be drawn, see ``simulate.Drawing``.
    """
    points = np.concatenate([truth.poses[:, :2], truth.world.object_xy])
    low, high = np.floor(points.min(axis=0) - _MARGIN), np.ceil(points.max(axis=0) + _MARGIN)
    file_var, added_var = FILE_ODOMETRY_STD[0] ** 2, ADDED_ODOMETRY_STD[0] ** 2
    noise = np.sqrt(max(float(log.odometry_std[0]) ** 2 - file_var, 0.0) / added_var)
    clutter_rate = np.count_nonzero(truth.obs_object < 0) / log.num_poses
    return Drawing(
        stroke=truth.poses[:, :2],
        object_xy=truth.world.object_xy,
        object_class=truth.world.object_class,
        class_names=truth.world.class_names,
        room=(*low, *high),
        noise=round(min(noise, MAX_NOISE), 3),
        clutter_rate=round(min(clutter_rate, MAX_CLUTTER), 3),
    )
