"""Lesson 00: the drive shows what the robot has measured so far, its camera is a pinhole, and the end is the answer."""

import re

import numpy as np
import pytest

from npslam_teach import dead_reckoning, fifteen_objects, np_graph, se2
from npslam_teach.course.start_here import camera_view, drive


@pytest.fixture(scope="module")
def run():
    log, truth = fifteen_objects()
    return log, truth, list(np_graph(log))


@pytest.fixture(scope="module")
def explorer(run):
    return drive.explore_drive(*run)


def dots_of(scene):
    """All sightings on the map, px."""
    drawn = [part[1]["d"] for name, part in scene.parts.items() if re.match(r"to \d+ ", name)]
    return np.array(re.findall(r"M(-?\d+),(-?\d+)h0", "".join(drawn)), dtype=float).reshape(-1, 2)


def on_page(scene, xy):
    """Of points in the room, px: by the ticks that the map writes."""
    scale = []
    for axis, key in (("x", "x"), ("y", "y")):
        ticks = [part for name, part in scene.parts.items() if re.fullmatch(rf"map {axis}t\d+", name)]
        lines = [part for name, part in scene.parts.items() if re.fullmatch(rf"map {axis}\d+", name)]
        values = [float(part[2]) for part in ticks]
        places = [float(part[1][f"{key}1"]) for part in lines]
        scale.append(np.polyfit(values, places, 1))
    return np.column_stack([np.polyval(fit, column) for fit, column in zip(scale, np.transpose(xy), strict=True)])


def same_points(drawn, expected):
    """The same points in any order, to a pixel."""
    assert len(drawn) == len(expected)
    apart = np.linalg.norm(drawn[:, None] - expected, axis=-1)
    assert apart.min(axis=0).max() < 1.0 and apart.min(axis=1).max() < 1.0


@pytest.mark.parametrize("stop", [0, 3, 12, drive.STOPS - 1])
def test_every_sighting_so_far_lies_where_the_wheels_say(run, explorer, stop):
    log, truth, _ = run
    words = explorer.move(stop=stop)
    now = int(np.linspace(0, log.num_poses - 1, drive.STOPS).round()[stop])
    seen = log.obs_time <= now
    wheels = dead_reckoning(log.odometry, truth.poses[0])
    if seen.any():
        landed = se2.apply(wheels[log.obs_time], log.obs_xy)[seen]
        same_points(dots_of(explorer.scene), on_page(explorer.scene, landed))
    assert f"At pose {now} of 701 the robot has made {seen.sum()} sightings" in words
    assert explorer.scene.parts["map title"][2] == f"what the robot believes: {seen.sum()} objects"
    drawn = np.array([each.split(",") for each in explorer.scene.parts["path"][1]["points"].split()], dtype=float)
    np.testing.assert_allclose(drawn[-1], on_page(explorer.scene, wheels[[now], :2])[0], atol=0.1)


def test_the_last_step_is_the_answer_of_the_method(run, explorer):
    _, truth, snapshots = run
    words = explorer.move(stop=drive.STOPS)
    objects = se2.apply(truth.poses[0], snapshots[-1].graph.landmarks)
    drawn = np.unique(dots_of(explorer.scene), axis=0)
    assert len(drawn) == snapshots[-1].num_objects
    same_points(drawn, on_page(explorer.scene, objects))
    assert f"sightings are of {snapshots[-1].num_objects} objects" in words
    assert f" {snapshots[1].num_objects} " not in words, "what the lesson asks next"


def test_path_and_sightings_keep_their_numbers_and_so_they_glide(explorer):
    shapes, before = set(), {}
    for stop in (0, 5, drive.STOPS - 1, drive.STOPS):
        explorer.move(stop=stop)
        parts = explorer.scene.parts
        shapes.add(re.sub(r"-?\d+(\.\d+)?", "#", parts["path"][1]["points"]))
        dots = {name: re.sub(r"\d+", "#", part[1]["d"]) for name, part in parts.items() if name.startswith("to ")}
        assert dots.items() >= before.items(), "what has dropped stays"
        before = dots
    assert len(shapes) == 1


def test_the_camera_is_a_pinhole():
    pose = np.array([1.0, 2.0, 0.7])
    ahead, left = np.array([2.0, 4.0, 3.0, 1.0]), np.array([0.0, 0.0, 3.0 * np.tan(np.deg2rad(60)), -1.0])
    feet, scale = camera_view.project(pose, se2.apply(pose, np.column_stack([ahead, left])))
    half = camera_view.VIEW.box[2] / 2
    np.testing.assert_allclose(feet[:, 0], [0.0, 0.0, -half, half / np.tan(np.deg2rad(60))], atol=1e-9)
    np.testing.assert_allclose(scale * ahead, scale[0] * ahead[0])  # twice as far, half as large
    np.testing.assert_allclose((feet[:, 1] - camera_view.HORIZON) / scale, camera_view.EYE)
    assert camera_view.project(pose, se2.apply(pose, np.array([[-1.0, 0.5]])))[1] < 0, "behind it"


def test_every_sighting_of_a_moment_has_its_box_and_near_things_hide_far_ones(run, explorer):
    log, truth, _ = run
    boxes = 0
    for stop in range(drive.STOPS):
        words = explorer.move(stop=stop)
        now = int(np.linspace(0, log.num_poses - 1, drive.STOPS).round()[stop])
        parts = explorer.scene.parts
        things = [int(name[6:]) for name in parts if name.startswith("thing ")]
        sighted = truth.obs_object[log.obs_time == now]
        assert {int(name[4:]) for name in parts if re.fullmatch(r"box \d+", name)} == set(sighted.tolist())
        assert set(things) >= set(sighted.tolist())
        far = np.linalg.norm(truth.world.object_xy[things] - truth.poses[now, :2], axis=1)
        ahead = se2.apply_inverse(truth.poses[now], truth.world.object_xy[things])[:, 0] if things else far
        assert (np.diff(ahead) <= 0).all()
        names = [truth.world.class_names[c] for c in log.obs_class[log.obs_time == now]]
        for name in names:
            alike = names.count(name)
            assert (f"a {name}" if alike == 1 else f"{alike} {name}s") in words
        boxes += len(sighted)
    assert boxes > 10


@pytest.mark.parametrize("name", ["chair", "screen", "cup", "book", "lamp"])
def test_things_stand_on_the_floor_and_are_as_large_as_their_boxes(name):
    outline = camera_view.outline_of(name)
    assert outline[:, 1].min() == 0.0 and outline[:, 1].max() == camera_view.HEIGHT[name]
    assert np.abs(outline[:, 0]).max() == camera_view.HALF_WIDTH[name]
