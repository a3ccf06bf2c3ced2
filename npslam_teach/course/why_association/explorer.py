"""Associate one observation of the toy scene with another object, and see how the pose graph changes."""

from dataclasses import dataclass

import numpy as np

from npslam_teach import plotting, se2, simulate
from npslam_teach.course.explorers import Explorer, choice
from npslam_teach.course.why_association.pictures import plot_springs
from npslam_teach.evaluation import chi2_per_dof
from npslam_teach.plotting.style import (
    CLASS_COLORS,
    ESTIMATE_LINE,
    TRUTH_COLOR,
    Line2D,
    class_handles,
    legend_beside,
    path_handles,
)
from npslam_teach.pose_graph import chi2, fit
from npslam_teach.types import PoseGraph, RobotLog

OBJECTS = ("chair A", "chair B", "the screen", "the cup", "the ghost", "a new object")
BELONGS_TO = np.array([0, 1, 2, 0, 1, 2, 3, 4])  # the object of each observation, as it should be
WRONG_COLOR = CLASS_COLORS[3]  # of no class in this scene


@dataclass(frozen=True, eq=False)
class Outcome:
    """The pose graph solved with one observation given to some object."""

    labels: np.ndarray  # (M,) index into the graph's landmarks
    objects: np.ndarray  # (K,) index into OBJECTS of each landmark
    graph: PoseGraph


def reassign(log: RobotLog, sighting: int, to: int) -> Outcome:
    """Give ``sighting`` to object ``to`` (an index into ``OBJECTS``) and solve with the log's own noise."""
    given = BELONGS_TO.copy()
    given[sighting] = to
    objects, labels = np.unique(given, return_inverse=True)
    return Outcome(labels, objects, fit(log, labels, se2.dead_reckoning(log.odometry)))


def explore_wrong_association() -> Explorer:
    """Choose an observation and the object it is given to; the map is solved anew (the toy scene of the deck)."""
    log, truth = simulate.toy_objects()
    as_it_should_be = reassign(log, 0, BELONGS_TO[0])
    figure, ax = plotting.new_figure(size=(9.0, 4.6))
    artists = _draw(ax, log, truth)

    def update(sighting: int, to: int) -> str:
        outcome = reassign(log, sighting, to)
        _move(artists, log, outcome, None if to == BELONGS_TO[sighting] else sighting)
        return in_words(as_it_should_be, outcome, sighting, to)

    sightings = choice("sighting", {f"Obj_{k + 1}": k for k in range(log.num_observations)})
    objects = choice("is given to", {name: k for k, name in enumerate(OBJECTS)})
    sightings.put(4)
    objects.put(int(BELONGS_TO[4]))  # Obj_5, at its own object
    return Explorer(figure, update, {"to": objects.grid()}, sighting=sightings, to=objects)


def in_words(before: Outcome, after: Outcome, sighting: int, to: int) -> str:
    """What happened to chi2, and how far the path and the objects moved."""
    name, ratio = f"Obj_{sighting + 1}", f"{chi2_per_dof(after.graph):.2f} per degree of freedom"
    if to == BELONGS_TO[sighting]:
        return f"{name} belongs to {OBJECTS[to]}: chi2 is {chi2(after.graph):.1f}, {ratio}."
    path = np.linalg.norm((after.graph.poses - before.graph.poses)[:, :2], axis=1).max()
    moved = after.graph.landmarks[after.labels] - before.graph.landmarks[before.labels]
    return (
        f"{name} of {OBJECTS[BELONGS_TO[sighting]]} is given to {OBJECTS[to]}: chi2 goes from "
        f"{chi2(before.graph):.1f} to {chi2(after.graph):.1f}, {ratio}. The path moves by up to {path:.2f} m, "
        f"the objects by up to {np.linalg.norm(moved, axis=1).max():.2f} m."
    )


def _draw(ax, log, truth) -> dict:
    """Draw the truth, and make the artists that will move."""
    world = truth.world
    plotting.plot_trajectory(ax, truth.poses, truth=True)
    plotting.plot_objects(ax, world.object_xy, world.object_class, world.class_names, truth=True)
    (path,) = ax.plot([], [], **ESTIMATE_LINE)
    springs = plot_springs(ax, np.zeros((log.num_observations, 2)), np.zeros((log.num_observations, 2)))
    markers = []
    for c in range(log.num_classes):
        plotting.plot_objects(ax, np.zeros((1, 2)), [c], world.class_names)
        markers.append(ax.collections[-1])
    paper = {"facecolor": "white", "alpha": 0.8, "linewidth": 0, "pad": 0.5}  # lines must not strike numbers out
    texts = [ax.text(0, 0, "", fontsize=11, va="center", zorder=4, bbox=paper) for _ in OBJECTS]
    spring, wrong = ({"color": color, "linewidth": 2.5} for color in (TRUTH_COLOR, WRONG_COLOR))
    handles = class_handles(range(3), world.class_names) + path_handles(("estimated path", "true path", "true object"))
    handles += [
        Line2D([], [], label="sighting to its object", **spring),
        Line2D([], [], label="the wrong one", **wrong),
    ]
    legend_beside(ax, handles)
    ax.set(xlim=(-1.1, 5.7), ylim=(-1.3, 2.8))  # holds every choice
    ax.set_title("numbers: the sightings of each object", fontsize=plotting.style.TEXT_SIZE["title"])
    return {"path": path, "springs": springs, "markers": markers, "texts": texts}


def _move(artists: dict, log: RobotLog, outcome: Outcome, wrong: int | None) -> None:
    """Bring every artist to the solved graph; the spring of the wrong observation is thick and coloured."""
    graph, labels = outcome.graph, outcome.labels
    artists["path"].set_data(*graph.poses[:, :2].T)
    landed = se2.apply(graph.poses[log.obs_time], log.obs_xy)
    for k, spring in enumerate(artists["springs"]):
        spring.set_data(*np.stack([landed[k], graph.landmarks[labels[k]]]).T)
        spring.set(color=WRONG_COLOR if k == wrong else TRUTH_COLOR, linewidth=4.0 if k == wrong else 2.0)
    # The class of an object is that of most of its observations; in a tie, the one with the lower index.
    members = [np.flatnonzero(labels == k) for k in range(len(graph.landmarks))]
    classes = np.array([np.bincount(log.obs_class[each]).argmax() for each in members])
    for c, markers in enumerate(artists["markers"]):
        markers.set_offsets(graph.landmarks[classes == c])
    for text in artists["texts"]:
        text.set_text("")
    numbers = ["+".join(str(m + 1) for m in each) for each in members]
    for text, number, place in zip(artists["texts"], numbers, free_places(graph.landmarks, numbers), strict=False):
        text.set(text=number, position=place[:2], ha=place[2])


def free_places(xy: np.ndarray, texts: list) -> list[tuple]:
    """Where to write each text beside its point so that none covers another or a marker: (x, y, alignment), m.

    Args:
        xy: (K, 2) m.
        texts: one for each point.
    """
    size = [np.array([0.13 * len(text) + 0.08, 0.30]) for text in texts]  # of 11 pt on this map
    taken = [(point, np.array([0.22, 0.22])) for point in xy]
    places = []
    for point, box in zip(xy, size, strict=True):
        sides = [(0.18 + box[0] / 2, 0.0, "left"), (-0.18 - box[0] / 2, 0.0, "right")]
        sides += [(side, height, "center") for height in (0.32, -0.32) for side in (0.0, 0.3, -0.3)]
        sides += [(side, height, "center") for height in (0.62, -0.62) for side in (0.0, 0.5, -0.5)]
        free = [(x, y, align) for x, y, align in sides if not _covers(point + [x, y], box, taken)]
        x, y, align = (free or sides)[0]
        taken.append((point + [x, y], box))
        edge = {"left": -box[0] / 2, "right": box[0] / 2, "center": 0.0}[align]
        places.append((point[0] + x + edge, point[1] + y, align))
    return places


def _covers(centre: np.ndarray, box: np.ndarray, taken: list) -> bool:
    return any((np.abs(centre - other) < (box + other_box) / 2).all() for other, other_box in taken)
