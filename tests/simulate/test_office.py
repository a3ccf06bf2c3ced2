"""The simulated office, its camera, the way from a box to a sighting, and the measures without truth."""

import numpy as np
import pytest

from npslam_teach import np_graph, se2
from npslam_teach.camera import Intrinsics, back_project, centroid_from_box, foreground, on_floor, points_in_box
from npslam_teach.course.office.figures import PAPERS
from npslam_teach.evaluation import chi2_per_dof, map_quality, position_variance, true_association_fit, valid_only
from npslam_teach.methods import METHODS
from npslam_teach.pose_graph import chi2
from npslam_teach.simulate import office_camera
from npslam_teach.simulate.office import (
    DESKS,
    OFFICE_CLASSES,
    ROOM_SIZE,
    office,
    office_path,
    office_scene,
    office_sensor,
)
from npslam_teach.simulate.office_camera import (
    CAMERA_HEIGHT,
    MAX_DEPTH,
    Body,
    bodies_of,
    cast,
    rendered_frame,
    rendered_frame_and_truth,
)

CAMERA = office_camera.office_camera()


@pytest.fixture(scope="module")
def run():
    return office(3)


@pytest.fixture(scope="module")
def results(run):
    return {name: list(METHODS[name](run[0]))[-1] for name in PAPERS}


# --- the office


def test_the_same_seed_gives_the_same_run_and_another_seed_another(run):
    again, other = office(3)[0], office(4)[0]
    np.testing.assert_array_equal(run[0].obs_xy, again.obs_xy)
    assert run[0].obs_xy.shape != other.obs_xy.shape or not np.array_equal(run[0].obs_xy, other.obs_xy)


def test_the_walk_is_27_m_and_goes_around_twice():
    path = office_path()
    step = np.linalg.norm(np.diff(path[:, :2], axis=0), axis=1)
    assert 26 < step.sum() < 28
    turned = se2.wrap(np.diff(path[:, 2])).sum()
    assert turned == pytest.approx(4 * np.pi, abs=0.5)


@pytest.mark.parametrize("seed", range(5))
def test_nobody_walks_through_furniture_or_walls(seed):
    scene = office_scene(seed)
    assert (scene.path[:, :2] > 0).all() and (scene.path[:, :2] < ROOM_SIZE).all()
    assert np.linalg.norm(scene.path[:, None, :2] - scene.world.object_xy, axis=-1).min() > 0.3
    for desk in DESKS:
        assert (np.abs(se2.apply_inverse(desk, scene.path[:, :2])) > [0.8, 0.4]).any(axis=1).all()


@pytest.mark.parametrize("seed", range(3))
def test_things_stand_in_the_room_and_chairs_before_their_desks(seed):
    scene = office_scene(seed)
    xy, chair = scene.world.object_xy, scene.world.object_class == OFFICE_CLASSES.index("chair")
    assert (xy > 0).all() and (xy < ROOM_SIZE).all()
    for k in np.flatnonzero(scene.at_desk >= 0):
        in_desk = se2.apply_inverse(DESKS[scene.at_desk[k]], xy[k])
        assert in_desk[1] < -0.3 if chair[k] else (np.abs(in_desk) < [0.8, 0.4]).all()


def test_some_objects_of_one_class_stand_close_together():
    world = office_scene(0).world
    apart = np.linalg.norm(world.object_xy[:, None] - world.object_xy, axis=-1)
    alike = (world.object_class[:, None] == world.object_class) & (apart > 0)
    assert np.count_nonzero(apart[alike] < 1.0) // 2 >= 8


def test_the_detector_confuses_misses_and_invents_as_often_as_its_model_says():
    sensor, confused, real, ghosts, visible = office_sensor(), np.zeros((8, 8)), 0, 0, 0
    from npslam_teach.simulate import visible_objects

    for seed in range(6):
        log, truth = office(seed)
        seen = truth.obs_object >= 0
        true_class = truth.world.object_class[truth.obs_object[seen]]
        np.add.at(confused, (true_class, log.obs_class[seen]), 1)
        real, ghosts = real + seen.sum(), ghosts + (~seen).sum()
        visible += len(visible_objects(truth.world, truth.poses, sensor)[0])
    assert real / visible == pytest.approx(sensor.detection_probability, abs=0.02)
    assert ghosts / (6 * len(truth.poses)) == pytest.approx(sensor.clutter_rate, abs=0.02)
    share = confused / confused.sum(axis=1, keepdims=True)
    np.testing.assert_allclose(share, sensor.class_confusion, atol=0.07)


def test_the_noise_is_what_the_log_says():
    ratios = [chi2_per_dof(true_association_fit(*office(seed))) for seed in range(3)]
    assert np.mean(ratios) == pytest.approx(1.0, abs=0.05)


def test_the_noise_of_a_sighting_is_of_the_size_of_the_cameras():
    """``office_sensor`` promises what rendered frames show: robustly, because a hidden object is an outlier."""
    scene, errors = office_scene(0), []
    for k in range(0, len(scene.path), 12):
        frame, truth = rendered_frame_and_truth(scene, k)
        errors += [
            centroid_from_box(frame.depth, box, frame.intrinsics) - xy
            for box, xy in zip(frame.boxes, truth.obs_xy, strict=True)
        ]
    errors = np.array(errors)
    spread = 1.4826 * np.median(np.abs(errors - np.median(errors, axis=0)), axis=0)
    assert (spread > 0.4 * office_sensor().observation_std).all()
    assert (spread < 1.5 * office_sensor().observation_std).all()


# --- the camera


def marched(body: Body, pose, left, up, far=6.0, step=0.002):
    """Depth at which a ray enters a body, found by walking along it: an oracle that knows no geometry but "inside"."""
    depth = np.arange(step, far, step)
    floor = se2.apply_inverse(body.pose, se2.apply(pose, np.column_stack([depth, left * depth])))
    height = CAMERA_HEIGHT + up * depth
    beside = np.hypot(*floor.T) < body.half[0] if body.is_round else (np.abs(floor) < body.half).all(axis=1)
    inside = beside & (height > body.z[0]) & (height < body.z[1])
    return depth[np.argmax(inside)] if inside.any() else np.inf


@pytest.mark.parametrize("is_round", [False, True])
def test_rays_meet_bodies_where_walking_along_them_does(is_round):
    rng = np.random.default_rng(5)
    hits = 0
    for _ in range(150):
        pose = np.array([2.0, 3.0, rng.uniform(-np.pi, np.pi)])
        place = se2.compose(pose, [rng.uniform(1.0, 3.0), rng.uniform(-1, 1), rng.uniform(-np.pi, np.pi)])
        half = np.full(2, 0.3) if is_round else rng.uniform(0.1, 0.5, 2)
        body = Body(is_round, place, half, (0.2, rng.uniform(0.5, 1.5)), (1, 1, 1), 0)
        left, up = rng.uniform(-0.4, 0.4), rng.uniform(-0.3, 0.1)
        enter, _ = office_camera._enter(body, pose, np.array([left]), np.array([up]))
        expected = marched(body, pose, left, up)
        assert np.isinf(enter[0]) == np.isinf(expected) or min(enter[0], expected) > 5.9
        if np.isfinite(expected):
            hits += 1
            assert enter[0] == pytest.approx(expected, abs=0.005)
    assert hits > 10


def test_the_window_of_a_body_leaves_none_of_its_pixels_out(monkeypatch):
    scene = office_scene(1)
    for k in (0, 200, 431):
        depth, _, object_at, _ = cast(bodies_of(scene), scene.path[k], CAMERA)
        with monkeypatch.context() as patched:
            patched.setattr(office_camera, "_window", lambda *_: (slice(None), slice(None)))
            whole_depth, _, whole_object, _ = cast(bodies_of(scene), scene.path[k], CAMERA)
        np.testing.assert_array_equal(depth, whole_depth)
        np.testing.assert_array_equal(object_at, whole_object)


def test_walls_floor_and_ceiling_are_where_they_are():
    pose = np.array([4.0, 3.0, 0.7])
    depth, _ = office_camera._room(pose, *np.meshgrid(np.linspace(-0.5, 0.5, 9), np.linspace(-0.4, 0.4, 7)))
    left, up = np.meshgrid(np.linspace(-0.5, 0.5, 9), np.linspace(-0.4, 0.4, 7))
    xy = se2.apply(pose, np.stack([depth, left * depth], axis=-1))
    z = CAMERA_HEIGHT + up * depth
    on_a_face = np.minimum.reduce(
        [np.abs(xy[..., a] - s) for a in (0, 1) for s in (0.0, ROOM_SIZE[a])] + [np.abs(z), np.abs(z - 2.7)]
    )
    assert on_a_face.max() < 1e-9
    assert (
        (xy > -1e-9).all() and (xy < np.array(ROOM_SIZE) + 1e-9).all() and (z > -1e-9).all() and (z < 2.7 + 1e-9).all()
    )


def test_a_frame_is_complete_and_always_the_same():
    frame = rendered_frame(7, 100)
    again = rendered_frame(office_scene(7), 100)
    np.testing.assert_array_equal(frame.depth, again.depth)
    np.testing.assert_array_equal(frame.boxes, again.boxes)
    assert frame.rgb.shape == (120, 160, 3) and frame.rgb.min() >= 0 and frame.rgb.max() <= 1
    assert frame.depth.shape == (120, 160) and frame.depth.min() >= 0 and frame.depth.max() < MAX_DEPTH + 0.5
    assert len(frame.boxes) == len(frame.obs_class) == len(frame.score) > 0
    assert ((frame.score >= 0) & (frame.score <= 1)).all()
    assert not any("object" in name for name in vars(frame)), "no identity travels with the measurement"


def test_a_frame_without_detections_has_empty_arrays():
    scene = office_scene(0)
    frames = [rendered_frame(scene, k) for k in range(0, 677, 15)]
    empty = [frame for frame in frames if len(frame.boxes) == 0]
    for frame in empty:
        assert frame.boxes.shape == (0, 4) and frame.obs_class.shape == (0,)
    assert all((frame.boxes[:, :2] < frame.boxes[:, 2:]).all() for frame in frames)
    assert all((frame.boxes >= 0).all() and (frame.boxes <= [160, 120, 160, 120]).all() for frame in frames)


def test_boxes_hold_their_object_and_hardly_more():
    frame, truth = rendered_frame_and_truth(2016, 610)
    for (x1, y1, x2, y2), k in zip(frame.boxes, truth.obs_object, strict=True):
        v, u = np.nonzero(truth.object_at == k)
        assert x1 <= u.min() and u.max() < x2 and y1 <= v.min() and v.max() < y2
        assert x2 - x1 <= u.max() - u.min() + 7 and y2 - y1 <= v.max() - v.min() + 7


def test_beyond_its_range_the_sensor_reads_nothing():
    scene = office_scene(0)
    exact = cast(bodies_of(scene), scene.path[0], CAMERA)[0]
    frame = rendered_frame(scene, 0)
    np.testing.assert_array_equal(frame.depth == 0, exact >= MAX_DEPTH)
    near = exact < MAX_DEPTH
    assert 0.001 < np.std(frame.depth[near] - exact[near]) < 0.05


# --- from a box to a sighting


def test_projecting_a_back_projected_pixel_gives_it_back():
    camera = Intrinsics(160, 120, 140.0, 150.0, 81.0, 57.5)
    rng = np.random.default_rng(0)
    u, v, depth = rng.uniform(0, 160, 50), rng.uniform(0, 120, 50), rng.uniform(0.5, 4, 50)
    x, y, z = back_project(u, v, depth, camera).T
    np.testing.assert_allclose(camera.fx * x / z + camera.cx, u)
    np.testing.assert_allclose(camera.fy * y / z + camera.cy, v)
    np.testing.assert_allclose(z, depth)


def test_field_of_view_reaches_the_edges_of_the_picture():
    camera = Intrinsics.from_field_of_view(160, 120, np.deg2rad(57.0))
    edges = back_project(np.array([-0.5, 159.5]), camera.cy, 1.0, camera)
    np.testing.assert_allclose(np.rad2deg(np.arctan2(edges[:, 0], 1.0)), [-28.5, 28.5])


def test_left_is_left_of_the_view():
    assert on_floor(np.array([0.5, 0.2, 2.0])).tolist() == [2.0, -0.5]


def test_pixels_without_a_reading_are_left_out_and_boxes_may_stick_out():
    depth = np.full((4, 5), 2.0)
    depth[1, 1] = 0.0
    camera = Intrinsics(5, 4, 5.0, 5.0, 2.0, 1.5)
    assert len(points_in_box(depth, (-3, -3, 9, 9), camera)) == 19
    assert len(points_in_box(depth, (1, 1, 2, 2), camera)) == 0
    assert np.isnan(centroid_from_box(depth, (1, 1, 2, 2), camera)).all()


def test_the_wall_pulls_the_mean_away_and_neither_of_the_others():
    depth = np.full((40, 40), 4.0)
    depth[:, :26] = 2.0  # 65 % object
    camera = Intrinsics(40, 40, 50.0, 50.0, 19.5, 19.5)
    ahead = {use: centroid_from_box(depth, (0, 0, 40, 40), camera, use)[0] for use in ("mean", "median", "foreground")}
    assert ahead["mean"] == pytest.approx(0.65 * 2 + 0.35 * 4)
    assert ahead["median"] == ahead["foreground"] == 2.0
    depth[:, 18:] = 4.0  # 45 %: the median gives in, the foreground does not
    assert centroid_from_box(depth, (0, 0, 40, 40), camera, "median")[0] == 4.0
    assert centroid_from_box(depth, (0, 0, 40, 40), camera)[0] == 2.0


def test_foreground_forgives_a_few_stray_readings():
    points = np.column_stack([np.zeros(20), np.zeros(20), np.r_[0.5, np.full(11, 2.0), np.full(8, 3.5)]])
    np.testing.assert_array_equal(foreground(points), points[:, 2] == 2.0)


def test_unknown_centres_are_refused():
    with pytest.raises(ValueError, match="expected foreground, median or mean"):
        centroid_from_box(np.ones((3, 3)), (0, 0, 3, 3), CAMERA, "middle")


# --- measures without truth


def test_quality_by_hand(run, results):
    log, snapshot = run[0], results["np-graph"]
    by_hand, inliers = [], 0
    xy = se2.apply(snapshot.graph.poses[log.obs_time], log.obs_xy)
    for k in range(snapshot.num_objects):
        own = xy[snapshot.labels == k]
        if 1 / (len(own) + 1) <= 0.1:
            by_hand.append(np.var(own[:, 0]) + np.var(own[:, 1]))
            inliers += len(own)
    q = map_quality(snapshot, log, 0.1)
    assert (q.num_valid, q.num_inliers) == (len(by_hand), inliers)
    assert q.position_variance == pytest.approx(np.mean(by_hand))


def test_frame_by_frame_has_nothing_valid_and_no_variance(run, results):
    q = map_quality(results["frame-by-frame"], run[0], 0.1)
    assert (q.num_valid, q.num_inliers) == (0, 0) and np.isnan(q.position_variance)
    everything = map_quality(results["frame-by-frame"], run[0], 0.5)
    assert everything.num_inliers == everything.num_valid == run[0].num_observations
    assert everything.position_variance == pytest.approx(0.0, abs=1e-20)


def test_left_out_sightings_have_no_part_in_the_variance(run, results):
    snapshot = results["robust-slam"]
    assert (snapshot.labels == -1).any()
    assert position_variance(snapshot, run[0]).shape == (snapshot.num_objects,)


@pytest.mark.parametrize("name", PAPERS)
def test_valid_only_keeps_the_valid_and_nothing_else(run, results, name):
    log, snapshot = run[0], results[name]
    kept, q = valid_only(snapshot, 0.1), map_quality(snapshot, log, 0.1)
    assert kept.num_objects == q.num_valid
    assert np.count_nonzero(kept.labels >= 0) == q.num_inliers == len(kept.graph.observations.pose)
    np.testing.assert_array_equal(kept.votes[:, 1:].sum(axis=1), np.bincount(kept.labels[kept.labels >= 0]))
    np.testing.assert_array_equal(kept.labels[kept.labels >= 0], kept.graph.observations.landmark)
    np.testing.assert_array_equal(kept.graph.poses, snapshot.graph.poses)
    np.testing.assert_equal(vars(map_quality(kept, log, 0.1)), vars(q))
    assert chi2(kept.graph) <= snapshot.chi2 + 1e-9


def test_valid_only_agrees_with_the_methods_own_removal_on_who_stays(run):
    log = run[0]
    *_, before = np_graph(log)
    *_, removed = np_graph(log, false_positive_threshold=0.1)
    np.testing.assert_array_equal(valid_only(before, 0.1).labels, removed.labels)


# --- what the lesson says of the methods


def test_the_np_graph_keeps_more_sightings_than_its_rivals(run, results):
    inliers = {name: map_quality(snapshot, run[0], 0.1).num_inliers for name, snapshot in results.items()}
    assert max(inliers, key=inliers.get) == "np-graph"
    assert inliers["np-graph"] > 0.8 * run[0].num_observations


def test_the_nearest_body_is_seen_in_whatever_order_they_come():
    pose = np.array([1.0, 3.5, 0.0])
    near, far = (
        Body(False, np.array([x, 3.5, 0.0]), np.array([0.1, size]), (0.5, 1.7), (1, 1, 1), k)
        for k, (x, size) in enumerate([(2.5, 0.2), (4.0, 0.6)])
    )
    depth, _, object_at, whole = cast([near, far], pose, CAMERA)
    np.testing.assert_array_equal(cast([far, near], pose, CAMERA)[2], object_at)
    assert object_at[60, 80] == 0 and depth[60, 80] == pytest.approx(1.4, abs=0.01)
    assert (object_at == 1).sum() > 0, "it sticks out on both sides"
    assert whole[0] == (object_at == 0).sum() and whole[1] > (object_at == 1).sum()
