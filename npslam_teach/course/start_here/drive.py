"""The opening of the course: the robot drives, sightings drop along the path that it believes, and then they join."""

from collections import Counter

import numpy as np

from npslam_teach import fifteen_objects, np_graph, se2
from npslam_teach.course import moving_scene
from npslam_teach.course.explorers import Explorer, player
from npslam_teach.course.scene import Panel, Scene
from npslam_teach.course.start_here import camera_view
from npslam_teach.types import GroundTruth, RobotLog, Snapshot

SIZE = (980.0, 500.0)  # px
MAP = (60.0, 36.0, 420.0, 390.0)
STOPS = 29  # of the drive, the first pose and the last among them
BEGIN = 12  # the stop that is shown first: on the way, with something before the camera
EVERY = 4  # of the poses of the path is drawn
ROBOT = np.array([(0.45, 0.0), (-0.3, 0.27), (-0.15, 0.0), (-0.3, -0.27)])  # m, larger than life


def explore_first_drive() -> Explorer:
    """Play the drive through the room of the lesson, which is all that its first cell does."""
    log, truth = fifteen_objects()
    return explore_drive(log, truth, list(np_graph(log)))


def explore_drive(log: RobotLog, truth: GroundTruth, snapshots: list[Snapshot]) -> Explorer:
    """Play the drive, from above as the robot believes it and through its camera; the last step is the answer.

    Nothing of the truth is on the map, which begins at the true start; the camera sees the world as it is.

    Args:
        log: what the robot measured.
        truth: the world that the camera looks at.
        snapshots: of a method that ran on the log; the last one is its answer.
    """
    stops = np.linspace(0, log.num_poses - 1, STOPS).round().astype(int).tolist()
    start = truth.poses[0]
    wheels, answer = se2.dead_reckoning(log.odometry, start), se2.compose(start, snapshots[-1].graph.poses)
    landed = se2.apply(wheels[log.obs_time], log.obs_xy)
    joined = se2.apply(start, snapshots[-1].graph.landmarks[snapshots[-1].labels])
    everywhere = np.concatenate([wheels[:, :2], answer[:, :2], landed, joined])
    room = Panel.around(everywhere, moving_scene.MARGIN, MAP)

    def update(stop: int) -> tuple[str, Scene]:
        now = stops[min(stop, STOPS - 1)]
        poses, xy = (wheels, landed) if stop < STOPS else (answer, joined)
        seen = int(np.count_nonzero(log.obs_time <= now))
        scene = Scene(SIZE)
        objects = seen if stop < STOPS else snapshots[-1].num_objects
        _draw_map(scene, room, f"what the robot believes: {objects} objects", poses, now)
        _drop_sightings(scene, room, log, xy, stops, stop)
        if stop == STOPS:
            moving_scene.draw_objects(scene, room, snapshots[-1], se2.apply(start, snapshots[-1].graph.landmarks))
        camera_view.draw(scene, log, truth, now)
        moving_scene.draw_key(scene, truth, (MAP[0], SIZE[1] - 10), ("estimated path",))
        return words(log, truth, now, seen, None if stop < STOPS else snapshots), scene

    position = player("the drive", STOPS, 800)
    position.put(BEGIN)
    return Explorer(None, update, {"stop": position.grid()}, stop=position)


def words(log: RobotLog, truth: GroundTruth, now: int, seen: int, snapshots: list[Snapshot] | None) -> str:
    """What the robot has done so far and sees; after the drive, what the method has made of it."""
    if snapshots is not None:
        rounds = snapshots[-1].iteration
        return (
            f"After {rounds} rounds the method says that the {seen} sightings are of {snapshots[-1].num_objects} "
            f"objects, and it has moved the path."
        )
    counts = Counter(truth.world.class_names[c] for c in log.obs_class[log.obs_time == now])
    things = [f"a {name}" if number == 1 else f"{number} {name}s" for name, number in counts.items()]
    looks = f"Its camera sees {', '.join(things) or 'nothing that it knows'}."
    return (
        f"At pose {now} of {log.num_poses - 1} the robot has made {seen} sightings, each an object of its own. {looks}"
    )


def _draw_map(scene: Scene, room: Panel, title: str, poses: np.ndarray, now: int) -> None:
    """The path so far, with as many points always: those to come wait at the robot, and so the path glides."""
    room.map_axes(scene, title, moving_scene.TICKS)
    driven = np.minimum(np.arange(0, len(poses) + EVERY, EVERY), now)
    moving_scene.draw_path(scene, room, "path", poses[driven, :2])
    corners = room.to_page(se2.apply(poses[now], ROBOT))
    scene.add("robot", "polygon", points=" ".join(f"{x:.1f},{y:.1f}" for x, y in corners), class_="ink")


def _drop_sightings(scene: Scene, room: Panel, log: RobotLog, xy: np.ndarray, stops: list[int], stop: int) -> None:
    """What was seen on the way to each stop, a part for each class; a part appears when the robot comes there."""
    before = -1
    for k, now in enumerate(stops[: stop + 1]):
        fresh = (log.obs_time > before) & (log.obs_time <= now)
        before = now
        name = f"to {k}"
        moving_scene.draw_sightings(scene, room, xy[fresh], log.obs_class[fresh], name, "dot drop")
