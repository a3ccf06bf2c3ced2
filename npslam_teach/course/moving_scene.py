"""A map as a scene: every sighting lies on its object, so when sightings are joined they glide together."""

import numpy as np

from npslam_teach import se2
from npslam_teach.course.scene import Panel, Scene
from npslam_teach.plotting.maps import laid_over_truth
from npslam_teach.plotting.style import class_style
from npslam_teach.types import GroundTruth, RobotLog, Snapshot

MARGIN, TICKS = 0.4, 2.0  # m
EVERY = 2  # of the poses of a path is drawn
SEEN_TWICE = 2  # what was seen once is a dot, what was seen more often a mark

LINES = ("estimated path", "true path", "true object")


def room_of(snapshots: list[Snapshot], truth: GroundTruth, box: tuple[float, float, float, float]) -> Panel:
    """The map that holds some snapshots and the truth, with one scale for both axes, no larger than a box.

    Args:
        snapshots: each is laid over the truth.
        truth: its path and its objects.
        box: left, top, width and height, px.
    """
    points = [xy[:, :2] for snapshot in snapshots for xy in laid_over_truth(snapshot, truth)]
    return Panel.around(np.concatenate([*points, truth.poses[:, :2], truth.world.object_xy]), MARGIN, box)


def draw_snapshot(scene: Scene, room: Panel, snapshot: Snapshot, log: RobotLog, truth: GroundTruth, title: str) -> None:
    """The truth, and over it path, sightings and objects of a snapshot.

    Args:
        scene: gets them.
        room: the map.
        snapshot: laid over the truth.
        log: what it was made from.
        truth: dashed path and rings.
        title: of the map.
    """
    room.map_axes(scene, title, TICKS)
    room.line(scene, "truth", truth.poses[::EVERY, :2], "truth")
    for k, (x, y) in enumerate(room.to_page(truth.world.object_xy)):
        scene.add(f"true object {k}", "circle", cx=x, cy=y, r=11, class_="truth")
    poses, landmarks = laid_over_truth(snapshot, truth)
    draw_path(scene, room, "path", poses[::EVERY, :2])
    own = se2.apply(poses[log.obs_time], log.obs_xy)
    used = snapshot.labels >= 0
    own[used] = landmarks[snapshot.labels[used]]  # what no object uses lies where it was seen
    draw_sightings(scene, room, own, log.obs_class)
    draw_objects(scene, room, snapshot, landmarks)


def draw_path(scene: Scene, room: Panel, name: str, xy: np.ndarray) -> None:
    """A path (N, 2) m, drawn to a tenth of a pixel."""
    points = " ".join(f"{x:.1f},{y:.1f}" for x, y in room.to_page(xy))
    scene.add(name, "polyline", points=points, class_="estimate")


def draw_sightings(
    scene: Scene, room: Panel, xy: np.ndarray, obs_class: np.ndarray, name: str = "sightings", style: str = "dot"
) -> None:
    """A dot for each sighting, those of a class in one part.

    Args:
        scene: gets them.
        room: the map.
        xy: (M, 2) m, W.
        obs_class: (M,).
        name: a prefix for the names of the parts.
        style: classes of the parts.
    """
    for c in np.unique(obs_class).tolist():
        dots = "".join(f"M{x:.0f},{y:.0f}h0" for x, y in room.to_page(xy[obs_class == c]))
        scene.add(f"{name} {c}", "path", d=dots, stroke=class_style(c)[0], class_=style)


def draw_objects(scene: Scene, room: Panel, snapshot: Snapshot, landmarks: np.ndarray) -> None:
    """A mark for each object seen at least twice; it bears the name of its first sighting, and glides with it.

    Args:
        scene: gets them.
        room: the map.
        snapshot: with K objects.
        landmarks: (K, 2) m, W.
    """
    counts, classes = snapshot.votes[:, 1:].sum(axis=1), snapshot.votes[:, 1:].argmax(axis=1)
    first = {label: m for m, label in reversed(list(enumerate(snapshot.labels.tolist())))}
    for j in np.flatnonzero(counts >= SEEN_TWICE).tolist():
        radius = min(3.5 + 0.55 * np.sqrt(counts[j]), 9.0)
        room.mark(scene, f"object {first.get(j, f'without {j}')}", landmarks[j], int(classes[j]), radius)


def draw_key(
    scene: Scene, truth: GroundTruth, place: tuple[float, float], lines=LINES, fill: str | None = None
) -> None:
    """What the marks and lines mean, in one row.

    Args:
        scene: gets it.
        truth: has the names of the classes.
        place: px, where the row begins.
        lines: of ``LINES`` those that there are.
        fill: of the marks; None: the colours of the classes.
    """
    x, y = place
    for c in np.unique(truth.world.object_class).tolist():
        name = truth.world.class_names[c]
        scene.page.mark(scene, f"key {c}", (x, y - 5), c, 6.5, **({"fill": fill} if fill else {}))
        scene.add(f"key name {c}", "text", name, x=x + 13, y=y, class_="quiet")
        x += 34 + 8.0 * len(name)
    for name in lines:
        if name == "true object":
            scene.add(f"key {name}", "circle", cx=x + 14, cy=y - 5, r=8, class_="truth")
        else:
            style = "truth" if name == "true path" else "estimate"
            scene.add(f"key {name}", "path", d=f"M{x},{y - 5}h28", class_=style)
        scene.add(f"key name {name}", "text", name, x=x + 35, y=y, class_="quiet")
        x += 60 + 7.5 * len(name)


def draw_curve(scene: Scene, panel: Panel, name: str, values, now: int | None = None) -> None:
    """A curve over 0, 1, 2, ..., with a dot at the present place; both only if there is one.

    Args:
        scene: gets it.
        panel: its axes.
        name: a prefix for the names of the parts.
        values: (N,) in the units of the panel.
        now: which of them is the present one; None marks all.
    """
    points = np.column_stack([np.arange(len(values)), values])
    panel.line(scene, f"{name} curve", points, "estimate")
    for k, (x, y) in enumerate(panel.to_page(points)):
        if now is None or k == now:
            scene.add(f"{name} dot{'' if now is not None else f' {k}'}", "circle", cx=x, cy=y, r=5.5, class_="ink")


def log_axes(scene: Scene, panel: Panel, name: str, title: str, x_label: str, x_ticks) -> None:
    """Axes whose y is log10 of a number, which is written in full.

    Args:
        scene: gets them.
        panel: y in powers of ten.
        name: a prefix for the names of the parts.
        title: of the panel.
        x_label: with unit.
        x_ticks: values on x.
    """
    powers = np.arange(np.ceil(panel.y[0]), panel.y[1] + 1e-9)
    panel.axes(scene, name, title, (x_label, ""), (x_ticks, powers))
    for k, power in enumerate(powers):
        tick = scene.parts[f"{name} yt{k}"]
        scene.parts[f"{name} yt{k}"] = [*tick[:2], f"{10.0**power:g}"]
