"""ROS bags: written by rosbags' own writers from a run that is known, and read back as that run."""

import json
import math
import sys
import tomllib

import numpy as np
import pytest
from commands import ROOT, call, small_log
from scipy.spatial.transform import Rotation

from npslam_teach import datasets, se2
from npslam_teach.cli import parser
from npslam_teach.datasets import ros_messages
from npslam_teach.datasets.ros_frames import rotation_of
from npslam_teach.datasets.trajectories import STEP, keyframes

pytest.importorskip("rosbags", reason="rosbags is not installed: pip install -r tests/requirements.txt")

from robot_bags import (  # noqa: E402
    BEGIN,
    BOXES,
    CAMERA,
    FOCAL,
    FRAME,
    HEIGHT,
    IMAGE,
    MOUNT,
    ODOMETRY,
    PICTURES,
    TRANSFORMS,
    WIDTH,
    bag_writer,
    forget_definitions,
    write_run,
)

KINDS = {"ros1": (1, ""), "sqlite3": (2, "sqlite3"), "mcap": (2, "mcap")}
NAMES = {1: "run.bag", 2: "run"}  # a file, a folder
SECOND = 1_000_000_000
UPRIGHT = (0, 0, 0, 1)


def assert_same_run(found, log, obs_tolerance=1e-6):
    np.testing.assert_allclose(found.odometry, log.odometry, rtol=0, atol=1e-6)
    np.testing.assert_array_equal(found.obs_time, log.obs_time)
    np.testing.assert_allclose(found.obs_xy, log.obs_xy, rtol=0, atol=obs_tolerance)
    assert [found.class_names[c] for c in found.obs_class] == [str(c) for c in log.obs_class]


@pytest.fixture
def drive(tmp_path):
    """A function that writes a small bag: a robot that drives ahead at 2 m/s for 4 s, and messages of one's own."""

    def write(others=(), ros=2, steps=41, odometry=True, name=None):
        path = tmp_path / (name or NAMES[ros])
        with bag_writer(path, ros) as (add, messages):
            for t in range(steps if odometry else 0):
                stamp = BEGIN + t * FRAME
                add("/odom", ODOMETRY, messages.odometry(stamp, (0.2 * t, 0, 0), UPRIGHT), stamp)
            for other in others:
                add(*other(messages))
        return path

    return write


def boxes(*seen, at=1.0, frame="laser", topic="/detections"):
    """Detections in space, so many seconds after the beginning, None for no stamp: (scores, x, y, z) each."""
    stamp = 0 if at is None else BEGIN + round(at * SECOND)
    return lambda messages: (topic, BOXES, messages.boxes(stamp, frame, seen), stamp + SECOND)


CHAIR = ({"chair": 0.9}, 2.0, 0.5, 0.3)


# ---- a run that is known ----


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("what", ["boxes", "pictures"])
def test_a_bag_is_the_run_that_was_written(tmp_path, kind, what):
    log, _ = small_log()
    path = write_run(tmp_path / NAMES[KINDS[kind][0]], log, *KINDS[kind], what)
    found, _ = datasets.load_rosbag(
        path, mount=MOUNT if what == "boxes" else None, odometry_std=[0.03, 0.03, 0.02], observation_std=[0.2, 0.3]
    )
    assert_same_run(found, log)
    np.testing.assert_array_equal(found.odometry_std, [0.03, 0.03, 0.02])
    np.testing.assert_array_equal(found.observation_std, [0.2, 0.3])
    assert len(np.unique(log.obs_time)) < log.num_poses and np.bincount(log.obs_time).max() > 1  # none, and several


@pytest.mark.parametrize(("kind", "file"), [("sqlite3", "*.db3"), ("mcap", "*.mcap")])
def test_a_file_of_a_bag_is_read_without_its_folder(tmp_path, kind, file):
    log, _ = small_log()
    (path,) = write_run(tmp_path / "run", log, *KINDS[kind]).glob(file)
    assert_same_run(datasets.load_rosbag(path, mount=MOUNT)[0], log)


@pytest.mark.parametrize("what", ["boxes", "pictures"])
def test_a_bag_that_stores_no_definitions_is_taken_for_one_of_humble(tmp_path, what):
    log, _ = small_log()
    path = write_run(tmp_path / "run", log, what=what)
    before = datasets.load_rosbag(path)[0]
    forget_definitions(path)
    with ros_messages.open_bag(path) as bag:
        assert not any(each.msgdef.data for each in bag.reader.connections)
    np.testing.assert_array_equal(datasets.load_rosbag(path)[0].obs_xy, before.obs_xy)


@pytest.mark.parametrize(
    ("image", "tolerance"),
    [
        ({"encoding": "16UC1"}, 0.003),
        ({"encoding": "32FC1", "big": True}, 1e-6),
        ({"encoding": "32FC1", "padding": 12}, 1e-6),
    ],
)
def test_depth_in_millimetres_or_in_another_order_of_bytes(tmp_path, image, tolerance):
    log, _ = small_log()
    path = write_run(tmp_path / "run", log, what="pictures", **image)
    assert_same_run(datasets.load_rosbag(path)[0], log, tolerance)


def test_what_is_recorded_out_of_order_is_sorted_by_its_stamps(tmp_path):
    log, _ = small_log()
    poses = se2.dead_reckoning(log.odometry)
    order = np.random.default_rng(0).permutation(len(poses))
    with bag_writer(tmp_path / "run") as (write, messages):
        for recorded, t in enumerate(order):
            stamp, now = BEGIN + t * FRAME, BEGIN + recorded
            half = np.array([0, 0, np.sin(poses[t, 2] / 2), np.cos(poses[t, 2] / 2)])
            write("/odom", ODOMETRY, messages.odometry(stamp, (*poses[t, :2], 0), half), now)
            mine = np.flatnonzero(log.obs_time == t)
            seen = [({int(log.obs_class[k]): 1.0}, *log.obs_xy[k], 0.1) for k in mine]
            write("/detections", BOXES, messages.boxes(stamp, "laser", seen), now)
    assert_same_run(datasets.load_rosbag(tmp_path / "run")[0], log)


def test_the_pose_of_a_detection_is_interpolated_at_its_time(tmp_path, drive):
    turned = [(BEGIN + t * FRAME, (0.02 * t, 0.0, 0.0), 0.03 * t) for t in range(40)]
    times = np.array([0.33, 1.0, 2.47])
    with bag_writer(tmp_path / "run") as (write, messages):
        for stamp, xyz, yaw in turned:
            half = (0, 0, math.sin(yaw / 2), math.cos(yaw / 2))
            write("/odom", ODOMETRY, messages.odometry(stamp, xyz, half), stamp)
        for time in times:
            write(*boxes(CHAIR, at=time)(messages))
    log, _ = datasets.load_rosbag(tmp_path / "run")
    path = se2.dead_reckoning(log.odometry)
    expected = np.column_stack([0.2 * times, np.zeros(3), 0.3 * times])  # 0.2 m/s and 0.3 rad/s
    np.testing.assert_allclose(path[log.obs_time], expected, atol=1e-7)
    # Between them poses of the odometry, none farther from the one before than a step and one message.
    assert (np.abs(log.odometry[:, 2]) <= 0.1 + 0.03 + 1e-9).all()
    assert len(log.odometry) < len(turned) // 2


# ---- odometry ----


def test_roll_pitch_height_and_the_length_of_a_quaternion_do_not_matter(tmp_path):
    rng = np.random.default_rng(0)
    yaws = np.cumsum(rng.uniform(-0.5, 0.5, 30))
    with bag_writer(tmp_path / "run") as (write, messages):
        for t, yaw in enumerate(yaws):
            tilted = Rotation.from_euler("ZYX", [yaw, *rng.uniform(-0.3, 0.3, 2)]).as_quat() * rng.uniform(0.1, 9)
            xyz = (0.2 * t, 0.1 * t, 0.05 * t)
            write("/odom", ODOMETRY, messages.odometry(BEGIN + t * FRAME, xyz, tilted), BEGIN)
        write(*boxes(CHAIR)(messages))
    log, remarks = datasets.load_rosbag(tmp_path / "run")
    path = np.column_stack([0.2 * np.arange(30), 0.1 * np.arange(30), yaws])
    np.testing.assert_allclose(log.odometry, se2.between(path[:-1], path[1:]), atol=1e-9)
    assert any("heights over 1.45 m, roll and pitch up to" in line for line in remarks)


def test_a_rotation_agrees_with_scipys_and_needs_a_length():
    rng = np.random.default_rng(1)
    for q in rng.normal(size=(50, 4)):
        named = type("Quaternion", (), dict(zip("xyzw", q, strict=True)))
        np.testing.assert_allclose(rotation_of(named), Rotation.from_quat(q).as_matrix(), atol=1e-12)
    assert np.isnan(rotation_of(type("Quaternion", (), dict.fromkeys("xyzw", 0.0)))).all()


def test_odometry_that_cannot_be_used_is_counted(drive):
    def odometry(stamp, xyz, quaternion=UPRIGHT):
        return lambda messages: ("/odom", ODOMETRY, messages.odometry(stamp, xyz, quaternion), BEGIN)

    bad = [
        odometry(0, (1, 1, 0)),
        odometry(BEGIN + 1, (math.nan, 0, 0)),
        odometry(BEGIN + 2, (0, 0, 0), (0, 0, 0, 0)),
        odometry(BEGIN, (5, 5, 0)),
    ]
    log, remarks = datasets.load_rosbag(drive([boxes(CHAIR), *bad]))
    np.testing.assert_allclose(se2.dead_reckoning(log.odometry)[-1], [8, 0, 0], atol=1e-9)
    assert "left out: 3 odometry messages without a time stamp or a pose" in remarks
    assert "left out: 1 odometry messages of a time that another one has" in remarks


def test_odometry_that_begins_anew_is_said(drive):
    def anew(messages):
        return "/odom", ODOMETRY, messages.odometry(BEGIN + 41 * FRAME, (0, 0, 0), UPRIGHT), BEGIN

    _, remarks = datasets.load_rosbag(drive([THERE, anew]))
    assert "beware: jumps of the odometry at up to 80 m/s, 1 in all: did it begin anew?" in remarks


def test_what_nobody_gave_is_assumed_and_said(drive):
    log, remarks = datasets.load_rosbag(drive([boxes(CHAIR)]))
    np.testing.assert_allclose(log.odometry[:, 0], 0.2)
    np.testing.assert_allclose(log.odometry_std, [0.02, 0.02, 0.005])  # a tenth of 0.2 m; no turn, so the least
    np.testing.assert_array_equal(log.observation_std, [0.1, 0.1])
    assert any(line.startswith("assumed: odometry_std 0.02,0.02,0.005") for line in remarks)


def test_keyframes_are_a_step_or_a_turn_apart_or_asked_for():
    path = np.column_stack([np.arange(20) * 0.03, np.zeros(20), np.zeros(20)])
    np.testing.assert_array_equal(keyframes(path), [0, 4, 8, 12, 16, 19])
    np.testing.assert_array_equal(keyframes(path, np.arange(20) == 5), [0, 4, 5, 9, 13, 17, 19])
    spinning = np.column_stack([np.zeros(20), np.zeros(20), se2.wrap(3.0 + np.arange(20) * 0.06)])
    np.testing.assert_array_equal(keyframes(spinning), [*range(0, 20, 2), 19])
    assert STEP == 0.1


def test_a_heading_turns_the_short_way_between_two_poses():
    middle = se2.interpolate(np.array([0.5]), np.array([0.0, 1.0]), np.array([[0, 0, 3.1], [1, 0, -3.1]]))
    np.testing.assert_allclose(middle, [[0.5, 0, -math.pi]], atol=1e-9)


# ---- detections ----


def test_the_class_is_that_of_the_largest_score(drive):
    seen = [({"cup": 0.2, "chair": 0.7, "plant": 0.1}, 1, 0, 0), ({"chair": 0.3, "cup": 0.4}, 2, 0, 0)]
    log, _ = datasets.load_rosbag(drive([boxes(*seen, CHAIR)]))
    assert log.class_names == ("chair", "cup")
    np.testing.assert_array_equal(log.obs_class, [0, 1, 0])


def test_classes_that_are_numbers_stand_in_their_order(drive):
    seen = [({name: 1.0}, 1, 0, 0) for name in ("10", "9", "tree", "100")]
    assert datasets.load_rosbag(drive([boxes(*seen)]))[0].class_names == ("9", "10", "100", "tree")


def test_detections_that_cannot_be_used_are_counted(drive):
    bad = [({}, 1, 0, 0), ({"cup": math.nan}, 1, 0, 0), ({"cup": 0.4}, 1, 0, 0), ({"cup": 0.9}, 0, 0, 0)]
    bad += [({"cup": 0.9}, math.nan, 0, 0), ({"cup": 0.9}, 1e300, 0, 0)]
    path = drive([boxes(*bad, CHAIR), boxes(CHAIR, CHAIR, at=9.0), boxes(CHAIR, at=None)])
    log, remarks = datasets.load_rosbag(path, min_score=0.5)
    np.testing.assert_array_equal(log.obs_xy, [[2, 0.5]])
    assert log.class_names == ("chair",)
    assert {line for line in remarks if line.startswith("left out")} == {
        "left out: 2 detections without a class",
        "left out: 1 detections scored below 0.5",
        "left out: 3 detections without a position",
        "left out: 1 detections without a time stamp",
        "left out: 2 detections before or after the odometry",
    }


def test_the_time_and_the_frame_of_a_detection_stand_in_where_the_array_has_none(drive):
    def bare(messages):
        array = messages.boxes(BEGIN + SECOND, "camera_optical_frame", [CHAIR])
        array.header = messages.header(0, "")
        return "/detections", BOXES, array, BEGIN

    log, _ = datasets.load_rosbag(drive([bare]))
    np.testing.assert_allclose(log.obs_xy, [[0.3, -2.0]])
    np.testing.assert_allclose(se2.dead_reckoning(log.odometry)[log.obs_time], [[2, 0, 0]], atol=1e-9)


def test_a_gap_in_the_odometry_is_said(drive):
    path = drive(
        [
            boxes(CHAIR, CHAIR, at=9.0),
            boxes(CHAIR),
            *[lambda messages: ("/odom", ODOMETRY, messages.odometry(BEGIN + 12 * SECOND, (8, 0, 0), UPRIGHT), BEGIN)],
        ]
    )
    _, remarks = datasets.load_rosbag(path)
    assert "beware: 2 detections fall into gaps of the odometry longer than 1 s" in remarks


def test_a_lower_rate_keeps_the_first_message_of_each_period(drive):
    cup = ({"cup": 0.9}, 1, 0, 0)
    times = [1.0, 1.1, 1.19, 1.31, 1.6, 2.05]
    path = drive([boxes(at=0.9), boxes(cup, at=1.0), *(boxes(CHAIR, CHAIR, at=time) for time in times), boxes(at=1.55)])
    log, remarks = datasets.load_rosbag(path, rate=4)
    seen_from = se2.dead_reckoning(log.odometry)[log.obs_time, 0]
    # Periods begin at 0.9, 1.15, 1.4, 1.65 and 1.9 s; the robot drives at 2 m/s.
    np.testing.assert_allclose(seen_from, np.repeat(2 * np.array([1.0, 1.19, 1.6, 2.05]), [3, 2, 2, 2]), atol=1e-9)
    assert "left out: 4 detections beyond 4 messages a second" in remarks


# ---- where the sensor is ----


@pytest.mark.parametrize(
    ("frame", "options", "expected"),
    [
        ("laser", {}, (2, 0.5)),
        ("camera_optical_frame", {}, (0.3, -2)),
        ("camera_optical_frame", {"optical": False}, (2, 0.5)),
        ("laser", {"optical": True}, (0.3, -2)),
        ("laser", {"mount": (1, 2, math.pi / 2)}, (0.5, 4)),
        ("camera_optical_frame", {"mount": (1, 2, math.pi / 2)}, (3, 2.3)),
    ],
)
def test_the_frame_of_a_sensor(drive, frame, options, expected):
    log, remarks = datasets.load_rosbag(drive([boxes(CHAIR, frame=frame)]), **options)
    np.testing.assert_allclose(log.obs_xy, [expected], atol=1e-12)
    assert sum(line.startswith(frame) for line in remarks) == 1


def static(*edges):
    return lambda messages: ("/tf_static", TRANSFORMS, messages.transforms(edges), BEGIN)


@pytest.mark.parametrize("ros", [1, 2])
def test_static_transforms_lead_from_the_sensor_to_the_robot(drive, ros):
    """A camera on a mast, looking to the left and down; the odometry is of base_link, a child of base_footprint."""
    mast, pan, tilt = (0.1, 0.2, 1.0), Rotation.from_euler("z", 0.5), Rotation.from_euler("y", 0.4)
    optical = Rotation.from_euler("ZYX", [-math.pi / 2, 0, -math.pi / 2])
    edges = [
        ("base_footprint", "base_link", (0.3, 0, 0.1), (0, 0, 1, 1)),
        ("/base_footprint", "mast", mast, pan.as_quat() * 2),
        ("mast", "camera", (0, 0, 0), tilt.as_quat()),
        ("camera", "camera_optical_frame", (0, 0.05, 0), optical.as_quat()),
        ("elsewhere", "lamp", (0, 0, 0), UPRIGHT),
    ]
    seen = ({1: 1.0}, 0.2, 0.3, 2.0)
    path = drive([static(*edges[:2]), static(*edges[2:]), boxes(seen, frame="camera_optical_frame")], ros)
    in_camera = optical.apply(seen[1:]) + [0, 0.05, 0]
    in_footprint = pan.apply(tilt.apply(in_camera)) + mast
    base = Rotation.from_quat([0, 0, 1, 1])
    expected = base.inv().apply(in_footprint - [0.3, 0, 0.1])[:2]
    log, remarks = datasets.load_rosbag(path)
    np.testing.assert_allclose(log.obs_xy, [expected], atol=1e-9)
    assert any("mounted as /tf_static says" in line for line in remarks)
    by_hand, _ = datasets.load_rosbag(path, mount=(0, 0, 0))
    np.testing.assert_allclose(by_hand.obs_xy, [[2.0, -0.2]], atol=1e-12)


@pytest.mark.parametrize(
    "edges",
    [
        [("base_link", "lamp", (1, 1, 1), UPRIGHT)],
        [("a", "laser", (1, 1, 1), UPRIGHT), ("laser", "a", (1, 1, 1), UPRIGHT)],
        [("base_link", "laser", (1, 1, 1), (0, 0, 0, 0))],
        [("base_link", "laser", (math.inf, 1, 1), UPRIGHT)],
    ],
    ids=["no way", "a ring", "no rotation", "not finite"],
)
def test_static_transforms_that_do_not_help_leave_the_sensor_at_the_origin(drive, edges):
    log, remarks = datasets.load_rosbag(drive([static(*edges), boxes(CHAIR)]))
    np.testing.assert_array_equal(log.obs_xy, [[2, 0.5]])
    assert any("so assumed" in line for line in remarks)


# ---- boxes in pictures ----


def picture(*seen, at=1.0, frame="camera_optical_frame"):
    stamp = BEGIN + round(at * SECOND)
    return lambda messages: ("/detections", PICTURES, messages.pictures(stamp, frame, seen), stamp)


def depth(pixels, at=1.0, encoding="32FC1", topic="/depth"):
    stamp = BEGIN + round(at * SECOND)
    return lambda messages: (topic, IMAGE, messages.image(stamp, pixels, encoding), stamp)


def camera(topic="/camera_info", **more):
    return lambda messages: (topic, CAMERA, messages.camera(BEGIN, **more), BEGIN)


WALL = np.full((HEIGHT, WIDTH), 3.0)
MIDDLE = ({"cup": 1.0}, (WIDTH - 1) / 2 + FOCAL, HEIGHT / 2, 20, 20)  # as far right as it is ahead


def test_the_depth_is_the_median_of_the_readings_in_the_middle_of_the_box(drive):
    pixels = np.full((HEIGHT, WIDTH), 9.0)
    u, v = round(MIDDLE[1]), round(MIDDLE[2])
    pixels[v - 5 : v + 6, u - 5 : u + 6] = 2.0  # the half of the box
    pixels[v - 5 : v - 1, u - 5 : u + 6] = 0.0  # a third without a reading,
    pixels[v, u - 5 : u + 6] = np.nan  # or another sign for it,
    pixels[v + 1, u - 5 : u + 6] = 2.5  # and outliers on both sides
    pixels[v + 2, u - 5 : u + 6] = 1.0
    log, _ = datasets.load_rosbag(drive([picture(MIDDLE), depth(pixels), camera()]))
    np.testing.assert_allclose(log.obs_xy, [[2, -2]], atol=1e-6)


def test_boxes_in_pictures_are_seen_from_the_frame_of_the_camera_matrix(drive):
    way = static(
        (
            "base_link",
            "eye_optical_frame",
            (0.5, 0, 1),
            Rotation.from_euler("ZYX", [-math.pi / 2, 0, -math.pi / 2]).as_quat(),
        )
    )
    log, _ = datasets.load_rosbag(
        drive([picture(MIDDLE, frame="what"), depth(WALL), camera(frame="eye_optical_frame"), way])
    )
    np.testing.assert_allclose(log.obs_xy, [[3.5, -3]], atol=1e-6)
    # Whatever the frame is called, a picture looks along z.
    log, _ = datasets.load_rosbag(drive([picture(MIDDLE), depth(WALL), camera(frame="eye")], name="other"))
    np.testing.assert_allclose(log.obs_xy, [[3, -3]], atol=1e-6)


def test_the_depth_image_next_in_time_is_used(drive):
    images = [depth(WALL, 1.04), depth(WALL / 3, 1.01), depth(WALL * 2, 0.98), depth(WALL, 2.0)]
    path = drive([picture(MIDDLE), picture(MIDDLE, at=2.06), *images, camera()])
    log, remarks = datasets.load_rosbag(path)
    np.testing.assert_allclose(log.obs_xy, [[1, -1]], atol=1e-6)
    assert "left out: 1 detections without a depth image of their time" in remarks


def test_a_box_without_a_depth_is_left_out(drive):
    corner, outside = ({"cup": 1.0}, 0, 0, 8, 8), ({"cup": 1.0}, 5000, -900, 8, 8)
    flat, vast = ({"cup": 1.0}, 9, 9, 0, 8), ({"cup": 1.0}, 0, 0, 1e14, 1e14)
    pixels = WALL.copy()
    pixels[:12, :12] = 0
    path = drive([picture(MIDDLE, corner, outside, flat, vast), depth(pixels), camera()])
    log, remarks = datasets.load_rosbag(path)
    assert log.num_observations == 2  # the middle one, and the one that covers all
    assert "left out: 2 detections without a valid depth" in remarks
    assert "left out: 1 detections without a position" in remarks


def test_boxes_in_space_are_preferred_to_those_in_pictures(drive):
    path = drive([picture(MIDDLE), depth(WALL), camera(), boxes(CHAIR, topic="/boxes")])
    assert datasets.load_rosbag(path)[0].class_names == ("chair",)
    assert datasets.load_rosbag(path, detection_topic="/detections")[0].class_names == ("cup",)


# ---- what is refused ----


def second_odometry(messages):
    return "/wheels", ODOMETRY, messages.odometry(BEGIN, (0, 0, 0), UPRIGHT), BEGIN


THERE, LOOK, WALLS = boxes(CHAIR), picture(MIDDLE), depth(WALL)
REFUSALS = {  # messages beside the odometry, options, words of the answer
    "no detections": (
        [],
        [],
        "expected a topic of vision_msgs/msg/Detection3DArray or vision_msgs/msg/Detection2DArray",
    ),
    "two odometries": ([THERE, second_odometry], [], "got /odom, /wheels: choose by --odometry-topic"),
    "another odometry": (
        [THERE],
        ["--odometry-topic", "/x"],
        "--odometry-topic: expected one of the topics /odom, got",
    ),
    "another type": ([THERE], ["--odometry-topic", "/detections"], "nav_msgs/msg/Odometry, got /detections of another"),
    "two detections": ([THERE, boxes(CHAIR, topic="/more")], [], "/detections, /more: choose by --detection-topic"),
    "nothing seen": ([boxes()], [], "expected detections, got none that can be used: its messages are empty"),
    "unsure": ([THERE], ["--min-score", "0.95"], "none that can be used: 1 detections scored below 0.95"),
    "too late": (
        [boxes(CHAIR, at=50)],
        [],
        "odometry's 1790000000.123 to 1790000004.123 s, got all of them in 1790000050",
    ),
    "no depth": ([LOOK], [], "expected a topic of sensor_msgs/msg/Image"),
    "no camera": ([LOOK, WALLS], [], "expected a topic of sensor_msgs/msg/CameraInfo"),
    "two depths": ([LOOK, WALLS, depth(WALL, topic="/depth2"), camera()], [], "choose by --depth-topic"),
    "two cameras": ([LOOK, WALLS, camera("/a"), camera("/b")], [], "choose by --camera-info-topic"),
    "encoding": (
        [LOOK, depth(WALL, encoding="rgb8"), camera()],
        [],
        "expected the encoding 32FC1 or 16UC1 or mono16, got",
    ),
    "size": ([LOOK, depth(WALL[:50]), camera()], [], "images of the camera's (640, 120) pixels, got (640, 50)"),
    "focal length": ([LOOK, WALLS, camera(focal=0)], [], "expected a matrix K with focal lengths above zero"),
    "rate": ([THERE], ["--rate", "0"], "rate: expected a positive number of messages per second, got 0"),
    "endless rate": ([THERE], ["--rate", "inf"], "rate: expected a positive number of messages per second, got inf"),
    "mount": ([THERE], ["--mount", "0", "nan", "0"], "mount: expected finite numbers"),
    "standard deviation": ([THERE], ["--odometry-std", "0,1,1"], "odometry_std: expected positive numbers"),
}


@pytest.mark.parametrize("case", REFUSALS)
def test_what_cannot_be_a_log_is_refused_in_a_sentence(drive, tmp_path, refused, case):
    messages, options, words = REFUSALS[case]
    path = drive(messages)
    said = refused("import", "rosbag", path, *options, "--out", tmp_path / "run.npz")
    assert words in said and f"{path}: " in said
    assert not (tmp_path / "run.npz").exists()


def test_a_bag_without_odometry_is_refused_with_its_topics(drive):
    with pytest.raises(ValueError, match="expected a topic of nav_msgs/msg/Odometry, got the topics /detections$"):
        datasets.load_rosbag(drive([THERE], odometry=False))


def test_an_image_with_too_few_bytes_is_refused(drive):
    def short(messages):
        topic, kind, image, stamp = depth(WALL)(messages)
        image.data = image.data[:-1]
        return topic, kind, image, stamp

    with pytest.raises(ValueError, match="/depth: expected 120 rows of at least 2560 bytes, got 307199 bytes"):
        datasets.load_rosbag(drive([picture(MIDDLE), short, camera()]))


def test_one_message_of_odometry_is_not_enough(drive):
    with pytest.raises(ValueError, match="/odom: expected at least two poses with different time stamps, got 1"):
        datasets.load_rosbag(drive([boxes(CHAIR)], steps=1))


@pytest.mark.parametrize("name", ["nothing", "nothing.bag"])
def test_a_missing_bag_is_named(tmp_path, refused, name):
    assert f"{name}: no such file or folder" in refused(
        "import", "rosbag", tmp_path / name, "--out", tmp_path / "a.npz"
    )


@pytest.mark.parametrize("name", ["text.bag", "text.db3", "text.mcap", "text.txt", "folder"])
def test_what_is_no_bag_is_refused(tmp_path, refused, name):
    path = tmp_path / name
    path.mkdir() if name == "folder" else path.write_text("hello")
    said = refused("import", "rosbag", path, "--out", tmp_path / "a.npz")
    assert f"{path}: expected a ROS bag that can be read, got" in said


def test_a_folder_that_is_called_as_a_file_of_ros_1_is_refused(drive):
    with pytest.raises(ValueError, match="run.bag: expected a folder with another name"):
        datasets.load_rosbag(drive([THERE], name="run.bag"))


def test_detections_of_another_layout_are_refused_where_no_definition_is_stored(drive):
    """As in a bag of Foxy: what is taken for vision_msgs 4 leaves some of the bytes over."""

    def longer(messages):
        topic, kind, array, stamp = THERE(messages)
        return topic, kind, bytes(messages.store.serialize_cdr(array, kind)) + bytes(40), stamp

    path = drive([longer])
    forget_definitions(path)
    with pytest.raises(ValueError, match="that can be read, got on /detections AnyReaderError: CDR message size"):
        datasets.load_rosbag(path)


@pytest.mark.parametrize("kind", KINDS)
def test_a_damaged_bag_ends_in_a_sentence_or_in_a_log(tmp_path, damaged, kind):
    log, _ = small_log()
    path = write_run(tmp_path / NAMES[KINDS[kind][0]], log, *KINDS[kind])
    file = path if path.is_file() else next(each for each in path.iterdir() if each.suffix != ".yaml")
    original, rng, outcomes = file.read_bytes(), np.random.default_rng(0), []
    for _ in range(60):
        file.write_bytes(damaged(original, rng))
        try:
            found, _ = datasets.load_rosbag(path)
            outcomes.append(np.isfinite(found.odometry).all())
        except ValueError as error:
            assert str(error).startswith(f"{path}: ") and "\n" not in str(error)
            outcomes.append(False)
    assert 5 < sum(outcomes) < 55  # damage that is always noticed, or never, would test only half


def test_a_damaged_list_of_files_is_refused(tmp_path, refused):
    log, _ = small_log()
    path = write_run(tmp_path / "run", log)
    for text in ("", "a: [", "rosbag2_bagfile_information: 3", "[1, 2]"):
        (path / "metadata.yaml").write_text(text, encoding="utf-8")
        said = refused("import", "rosbag", path, "--out", tmp_path / "a.npz")
        assert f"{path}: expected a ROS bag that can be read" in said


# ---- the package, and the command ----


def test_a_missing_package_is_named_with_its_remedy(tmp_path, monkeypatch, refused):
    monkeypatch.setitem(sys.modules, "rosbags.highlevel", None)
    said = refused("import", "rosbag", tmp_path, "--out", tmp_path / "a.npz")
    assert f'"{sys.executable}" -m pip install "{ros_messages.REQUIREMENT}"' in said


def test_the_requirement_is_that_of_the_extra_and_of_the_tests():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert project["optional-dependencies"]["ros"] == [ros_messages.REQUIREMENT]
    lines = (ROOT / "tests" / "requirements.txt").read_text(encoding="utf-8").splitlines()
    assert ros_messages.REQUIREMENT in lines


def test_from_a_bag_to_a_map(tmp_path, capsys):
    log, truth = small_log()
    path, out = write_run(tmp_path / "run", log), tmp_path / "run.npz"
    mount = [str(number) for number in MOUNT]
    assert parser.main(["import", "rosbag", str(path), "--mount", *mount, "--out", str(out)]) == 0
    said = capsys.readouterr().out.splitlines()
    assert said[0] == f"{out}: {log.num_poses} poses, {log.num_observations} observations of 2 classes"
    assert len(said) == 4
    code, out, _ = call(capsys, "solve", out, "--method", "posterior", "--json")
    assert code == 0
    assert json.loads(out)["num_objects"] == len(np.unique(truth.obs_object))
