"""Give one observation of the toy scene to another object, and see how the pose graph changes."""

from dataclasses import dataclass

import numpy as np

from npslam_teach import se2, simulate
from npslam_teach.course.explorers import Explorer, choice
from npslam_teach.course.scene import Panel, Scene
from npslam_teach.evaluation import chi2_per_dof
from npslam_teach.pose_graph import chi2, fit
from npslam_teach.types import GroundTruth, PoseGraph, RobotLog

SIZE = (980.0, 468.0)  # px
ROOM = Panel((60.0, 36.0, 680.0, 370.0), (-1.2, 5.9), (-1.1, 2.76))  # m; 96 px per metre on both axes, nearly
RATIO = Panel((805.0, 36.0, 130.0, 370.0), (0.0, 1.0), (-1.0, 2.2))  # log10 of chi2 per degree of freedom
NEW = np.array([5.1, -0.55])  # m, where a new object is offered
# Where on its way from the robot each sighting is taken hold of: clear of the others and of the objects.
HELD_AT = np.array([0.5, 0.22, 0.4, 0.35, 0.37, 0.4, 0.37, 0.3])
REACH = 40.0  # px
OBJECTS = ("chair A", "chair B", "the screen", "the cup", "the ghost", "a new object")
BELONGS_TO = np.array([0, 1, 2, 0, 1, 2, 3, 4])  # the object of each observation, as it should be


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
    """Drop an observation on the object it is given to; the map is solved anew (the toy scene of the deck)."""
    log, truth = simulate.toy_objects()
    as_it_should_be = reassign(log, 0, BELONGS_TO[0])

    def update(sighting: int, to: int) -> tuple[str, Scene]:
        outcome = reassign(log, sighting, to)
        scene = Scene(SIZE)
        _draw_room(scene, log, truth, outcome, None if to == BELONGS_TO[sighting] else sighting)
        _draw_ratio(scene, chi2_per_dof(outcome.graph))
        return in_words(as_it_should_be, outcome, sighting, to), scene

    sightings = choice("sighting", {f"Obj_{k + 1}": k for k in range(log.num_observations)})
    objects = choice("is given to", {name: k for k, name in enumerate(OBJECTS)})
    sightings.put(4)
    objects.put(int(BELONGS_TO[4]))  # Obj_5, at its own object
    frames = {"sighting": sightings.grid(), "to": objects.grid()}
    return Explorer(None, update, frames, sighting=sightings, to=objects)


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


def _draw_room(scene: Scene, log: RobotLog, truth: GroundTruth, outcome: Outcome, wrong: int | None) -> None:
    """The solved map; the spring of the wrong observation is thick and red."""
    graph, labels, world = outcome.graph, outcome.labels, truth.world
    title = "drop a sighting on another object" if wrong is None else f"Obj_{wrong + 1} pulls, and the map gives way"
    ROOM.axes(scene, "map", title, ("x (m)", "y (m)"), (range(-1, 6), range(-1, 3)))
    ROOM.line(scene, "truth", truth.poses[:, :2], "truth")
    for k, (x, y) in enumerate(ROOM.to_page(world.object_xy)):
        scene.add(f"true object {k}", "circle", cx=x, cy=y, r=13, class_="truth")
    landed = se2.apply(graph.poses[log.obs_time], log.obs_xy)
    seen_from = graph.poses[log.obs_time, :2]
    _lines(scene, "sights", np.stack([seen_from, landed], axis=1), "grid")
    right = np.arange(len(labels)) != wrong
    _lines(scene, "springs", np.stack([landed, graph.landmarks[labels]], axis=1)[right], "spring")
    if wrong is not None:
        ROOM.line(scene, "pull", [landed[wrong], graph.landmarks[labels[wrong]]], "pull")
    ROOM.line(scene, "path", graph.poses[:, :2], "estimate")
    ROOM.dots(scene, "poses", graph.poses[:, :2], 9)
    held = seen_from + HELD_AT[:, None] * (landed - seen_from)
    _draw_objects(scene, log, outcome, held)
    _draw_sightings(scene, log, outcome, held)


def _lines(scene: Scene, name: str, pairs: np.ndarray, style: str) -> None:
    """Lines between pairs of points (N, 2, 2) m, as one part."""
    ends = ROOM.to_page(pairs.reshape(-1, 2)).reshape(-1, 4)
    scene.add(name, "path", d=" ".join(f"M{a:.1f},{b:.1f}L{c:.1f},{d:.1f}" for a, b, c, d in ends), class_=style)


def _draw_objects(scene: Scene, log: RobotLog, outcome: Outcome, held: np.ndarray) -> None:
    """Each object with its name and the numbers of its observations, and the place of a new one."""
    landmarks = outcome.graph.landmarks
    # The class of an object is that of most of its observations; in a tie, the one with the lower index.
    members = [np.flatnonzero(outcome.labels == k) for k in range(len(landmarks))]
    texts = []
    for k, each in enumerate(members):
        ROOM.mark(scene, f"object {k}", landmarks[k], int(np.bincount(log.obs_class[each]).argmax()), 8.0)
        texts.append(f"{OBJECTS[outcome.objects[k]].removeprefix('the ')}: {'+'.join(str(m + 1) for m in each)}")
    in_the_way = [landmarks, held, held + (0.13, 0.13), outcome.graph.poses[:, :2]]  # the third are numbers
    places = free_places(np.concatenate(in_the_way), texts)
    for k, (text, (x, y, align)) in enumerate(zip(texts, places, strict=True)):
        style = {"left": "bold over", "right": "end bold over", "center": "middle bold over"}[align]
        ROOM.text(scene, f"name {k}", (x, y), text, (0.0, 5.0), style)
    x, y = ROOM.to_page(NEW)[0]
    scene.add("new", "circle", cx=x, cy=y, r=20, class_="frame", stroke_dasharray="4 3")
    scene.add("new name", "text", "a new object", x=x, y=y + 38, class_="middle quiet")


def _draw_sightings(scene: Scene, log: RobotLog, outcome: Outcome, held: np.ndarray) -> None:
    """Each observation on its way from the robot, with a ring to drop it on an object by."""
    places = {int(thing): xy for thing, xy in zip(outcome.objects, outcome.graph.landmarks, strict=True)}
    for k, xy in enumerate(held):
        ROOM.mark(scene, f"sighting {k}", xy, int(log.obs_class[k]), 5.5)
        ROOM.text(scene, f"number {k}", xy, str(k + 1), (9.0, -9.0), "bold")
    for k, xy in enumerate(held):
        own = int(BELONGS_TO[k])
        offered = {own: NEW, len(OBJECTS) - 1: NEW} if own not in places else {len(OBJECTS) - 1: NEW}
        offered = dict(list(offered.items())[:1]) | {j: at for j, at in places.items() if j < len(OBJECTS) - 1}
        stops = [(at, {"sighting": k, "to": j}) for j, at in offered.items()]
        label = f"Obj_{k + 1} of {OBJECTS[own]}; drag it to an object, or point with an arrow key"
        ROOM.grip(scene, f"ring {k}", xy, stops, label, REACH, r=13.0)
    hint = "drag a sighting by its ring to another object, or to the new one; all others stay where they belong"
    scene.add("hint", "text", hint, x=60, y=SIZE[1] - 4, class_="quiet small", data_hint="true")


def _draw_ratio(scene: Scene, ratio: float) -> None:
    """chi2 per degree of freedom, with 1, which is expected, as a level."""
    RATIO.axes(scene, "ratio", f"chi2 per dof: {ratio:.1f}", ("", "log10 of chi2 per dof"), ((), (-1, 0, 1, 2)))
    corner, foot = RATIO.to_page([(0.25, np.log10(ratio)), (0.75, RATIO.y[0])])
    size = {"width": foot[0] - corner[0], "height": foot[1] - corner[1]}
    scene.add("bar", "rect", x=corner[0], y=corner[1], fill="#00659f", class_="mark", **size)
    RATIO.line(scene, "expected", [(0.0, 0.0), (1.0, 0.0)], "level")
    RATIO.text(scene, "expected name", (0.5, RATIO.y[0]), "dashed: expected", (0.0, 19.0), "middle quiet")


def free_places(xy: np.ndarray, texts: list) -> list[tuple]:
    """Where to write each text beside its point so that none covers another or a marker: (x, y, alignment), m.

    Args:
        xy: (N, 2) m, what must not be covered; the first ones are those of the texts.
        texts: (K,).
    """
    size = [np.array([0.09 * len(text) + 0.06, 0.2]) for text in texts]  # of 14 px on this map
    taken = [(point, np.array([0.2, 0.2])) for point in xy]
    places = []
    for point, box in zip(xy, size, strict=False):
        sides = [(0.14 + box[0] / 2, 0.0, "left"), (-0.14 - box[0] / 2, 0.0, "right")]
        heights = [sign * height for height in (0.25, 0.45, 0.65, 0.85) for sign in (1, -1)]
        sides += [(side, height, "center") for height in heights for side in (0.0, 0.3, -0.3, 0.5, -0.5, 0.8, -0.8)]
        free = (side for side in sides if not _covers(point + side[:2], box, taken))
        x, y, align = next(free, sides[0])
        taken.append((point + [x, y], box))
        edge = {"left": -box[0] / 2, "right": box[0] / 2, "center": 0.0}[align]
        places.append((point[0] + x + edge, point[1] + y, align))
    return places


def _covers(centre: np.ndarray, box: np.ndarray, taken: list) -> bool:
    return any((np.abs(centre - other) < (box + other_box) / 2).all() for other, other_box in taken)
