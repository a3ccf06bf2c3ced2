"""From a drawing to an answer: the smoothed path, objects that are carried, refusals, messages, files."""

import json
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from npslam_teach import World, datasets, np_graph, simulate
from npslam_teach.course.draw_your_own_world import messages
from npslam_teach.evaluation import evaluate
from npslam_teach.simulate import carried, drawn_fifteen, drawn_run, gallery, simulate_run, visible_objects
from npslam_teach.simulate.hand_drawn import (
    MAX_LENGTH,
    MAX_OBJECTS,
    MAX_POINTS,
    drawn_path,
    drawn_sensor,
    stroke_length,
)


@pytest.fixture(scope="module")
def small():
    """A short drive past fifteen objects."""
    return drawn_fifteen(stroke=gallery.ellipse(0.5))


@pytest.fixture(scope="module")
def solved(small):
    return messages.solve_drawing(small)


def through(*points, **changes):
    return drawn_fifteen(stroke=points, **changes)


# ---- the smoothed path


@settings(deadline=None)
@given(st.floats(1.0, 9.0), st.floats(1.0, 7.0), st.floats(-np.pi, np.pi), st.floats(1.0, 4.0), st.integers(2, 200))
def test_a_straight_line_stays_straight_however_many_points_it_has(x, y, angle, length, num_points):
    """The smoothing must not move an end or bend a straight line."""
    direction = np.array([np.cos(angle), np.sin(angle)])
    stroke = np.array([x, y]) + np.linspace(0.0, length, num_points)[:, None] * direction
    poses = drawn_path(stroke)
    np.testing.assert_allclose(poses[0, :2], [x, y], atol=1e-9)
    np.testing.assert_allclose([np.cos(poses[0, 2]), np.sin(poses[0, 2])], direction, atol=1e-9)
    assert np.linalg.norm(poses[-1, :2] - stroke[-1]) < 0.1 + 1e-6  # the last step has no room for another
    across = (poses[:, :2] - stroke[0]) @ [-direction[1], direction[0]]
    assert np.abs(across).max() < 1e-9


def test_steps_are_equal_and_lead_where_the_robot_looks():
    poses = drawn_path(gallery.figure_of_eight())
    steps = np.diff(poses[:, :2], axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    assert np.abs(lengths - 0.1).max() < 1e-3
    np.testing.assert_allclose(np.arctan2(steps[:, 1], steps[:, 0]), poses[:-1, 2], atol=1e-9)


def test_the_tremor_of_a_hand_is_smoothed_away_and_a_curve_is_kept():
    rng = np.random.default_rng(0)
    phase = np.linspace(0.0, 2 * np.pi, 700)
    circle = np.array([6.0, 4.0]) + 2.0 * np.column_stack([np.cos(phase), np.sin(phase)])
    radius = np.linalg.norm(drawn_path(circle + rng.normal(size=circle.shape) * 0.01)[:, :2] - [6.0, 4.0], axis=1)
    assert np.abs(radius - 2.0).max() < 0.03
    turns = np.abs(np.diff(np.unwrap(drawn_path(circle + rng.normal(size=circle.shape) * 0.01)[:, 2])))
    assert turns.max() < 0.15  # 0.05 rad per step on the circle itself; the raw line turns by a radian and more


def test_repeated_points_change_nothing():
    stroke = gallery.ellipse()
    np.testing.assert_allclose(drawn_path(np.repeat(stroke, 3, axis=0)), drawn_path(stroke), atol=1e-12)


@settings(max_examples=30, deadline=None)
@given(st.lists(st.tuples(st.floats(0.0, 12.0), st.floats(0.0, 8.0)), min_size=0, max_size=12))
def test_any_line_inside_the_room_is_driven_or_refused_in_a_sentence(points):
    try:
        log, truth = drawn_run(through(*points))
    except ValueError as error:
        assert str(error).startswith(("path: expected", "stroke: expected"))
        return
    assert len(truth.poses) == log.num_poses >= 5


# ---- refusals: one sentence each


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"stroke": [(3, 3)]}, r"^path: expected at least 1 m, got 0\.00 m; .* a click alone is no path$"),
        ({"stroke": np.empty((0, 2))}, r"^path: expected at least 1 m, got 0\.00 m"),
        ({"stroke": [(3, 3), (13, 3)]}, r"^path: expected all inside the room, .*, got one at \(13\.00, 3\.00\) m$"),
        ({"stroke": [(0, 0), (12, 8)] * 8}, rf"^path: expected at most {MAX_LENGTH:g} m, got 216\.3 m"),
        ({"stroke": np.full((MAX_POINTS + 1, 2), 3.0)}, rf"^path: expected at most {MAX_POINTS} points, got 20001$"),
        ({"stroke": [(3, 3), (3.05, 3)] * 200}, r"^path: expected at least 0\.5 m after smoothing, got 0\.\d\d m$"),
        ({"stroke": [(3, 3), (np.nan, 3)]}, r"^stroke: expected finite numbers"),
        ({"object_xy": [(3, -1)], "object_class": [0]}, r"^objects: expected all inside the room"),
        ({"object_goal": np.full((15, 2), 99.0)}, r"^goals: expected all inside the room"),
        ({"object_class": [5] * 15}, r"^object_class: expected a class index from 0 to 4, got 5"),
        (
            {"object_xy": np.ones((MAX_OBJECTS + 1, 2)), "object_class": np.zeros(MAX_OBJECTS + 1, int)},
            rf"^objects: expected at most {MAX_OBJECTS}, got {MAX_OBJECTS + 1}$",
        ),
        ({"noise": -1}, r"^noise: expected a number from 0 to 5, got -1$"),
        ({"noise": float("nan")}, r"^noise: expected a number from 0 to 5, got nan$"),
        ({"clutter_rate": 2.0}, r"^clutter_rate: expected a number from 0 to 1, got 2\.0$"),
        ({"seed": 0.5}, r"^seed: expected an integer from 0"),
        ({"room": (0, 0, 0, 8)}, r"^room: expected left < right and bottom < top"),
    ],
)
def test_what_cannot_be_driven_is_refused_in_one_sentence(changes, sentence):
    with pytest.raises(ValueError, match=sentence) as caught:
        drawn_run(drawn_fifteen(**changes))
    assert "\n" not in str(caught.value)


def test_more_sightings_than_can_be_waited_for_are_refused():
    xy = np.random.default_rng(0).uniform(3.0, 5.0, (MAX_OBJECTS, 2))
    crowd = drawn_fifteen(object_xy=xy, object_class=np.zeros(MAX_OBJECTS, int), stroke=gallery.ellipse(4.0))
    with pytest.raises(ValueError, match=r"^observations: expected at most 5000, got about \d+; draw a shorter path"):
        drawn_run(crowd)


# ---- objects that are carried


def test_what_is_carried_nowhere_is_the_run_of_a_world_that_stands_still(small):
    world = simulate.fifteen_objects()[1].world
    path, sensor = drawn_path(small.stroke), drawn_sensor(small)
    paths = carried(world.object_xy, world.object_xy, len(path))
    still, moved = (simulate_run(world, path, sensor, np.random.default_rng(3), each)[0] for each in (None, paths))
    for name in ("odometry", "obs_time", "obs_xy", "obs_class"):
        np.testing.assert_array_equal(getattr(still, name), getattr(moved, name))


def test_what_is_carried_is_seen_where_it_is_at_that_moment(small):
    """Without noise, every observation carried back into the world lies on its way, at its share of the time."""
    exact = replace(drawn_sensor(small), odometry_std=(0, 0, 0), observation_std=(0, 0))
    path = drawn_path(small.stroke)
    world = World([(6.0, 6.0)], [0], ("chair",))
    paths = carried(world.object_xy, [(4.0, 4.0)], len(path))
    times, _, xy_robot = visible_objects(world, path, exact, paths)
    assert len(times) > 20
    share = times / (len(path) - 1)
    expected = np.array([6.0, 6.0]) - 2.0 * share[:, None]
    heading = path[times, 2]
    cos, sin = np.cos(heading), np.sin(heading)
    x = path[times, 0] + cos * xy_robot[:, 0] - sin * xy_robot[:, 1]
    y = path[times, 1] + sin * xy_robot[:, 0] + cos * xy_robot[:, 1]
    np.testing.assert_allclose(np.column_stack([x, y]), expected, atol=1e-12)


def test_carried_begins_here_ends_there_and_is_even():
    paths = carried(np.array([(0.0, 0.0), (1.0, 1.0)]), np.array([(3.0, -3.0), (1.0, 1.0)]), 4)
    np.testing.assert_allclose(paths[:, 0], [(0, 0), (1, -1), (2, -2), (3, -3)])
    np.testing.assert_array_equal(paths[:, 1], np.ones((4, 2)))


def test_paths_of_objects_must_fit_the_poses(small):
    world = World([(6.0, 6.0)], [0], ("chair",))
    with pytest.raises(ValueError, match=r"^object_paths: expected shape \(7, 1, 2\), got \(6, 1, 2\)"):
        visible_objects(world, np.zeros((7, 3)), drawn_sensor(small), np.zeros((6, 1, 2)))


def test_a_log_does_not_tell_what_moved(small):
    """Only the simulator knows: the log has the same fields, and the truth holds the first position."""
    goal = np.array(small.object_xy)
    goal[0] += 0.5
    log, truth = drawn_run(replace(small, object_goal=goal))
    assert vars(log).keys() == vars(drawn_run(small)[0]).keys()
    np.testing.assert_array_equal(truth.world.object_xy, small.object_xy)


# ---- the answer


def test_the_same_drawing_gives_the_same_run_and_another_seed_another(small):
    first, second, other = (drawn_run(each)[0] for each in (small, small, replace(small, seed=2)))
    np.testing.assert_array_equal(first.obs_xy, second.obs_xy)
    assert not np.array_equal(first.odometry, other.odometry)


def test_noise_and_false_sightings_reach_the_run(small):
    log, _ = drawn_run(replace(small, noise=3.0))
    np.testing.assert_allclose(log.odometry_std, simulate.paper_sensor(3.0).odometry_std)
    assert not (drawn_run(small)[1].obs_object < 0).any()
    share = np.mean([(drawn_run(replace(small, clutter_rate=0.5, seed=k))[1].obs_object < 0).sum() for k in range(8)])
    assert share == pytest.approx(0.5 * log.num_poses, rel=0.15)


def test_the_answer_is_the_librarys(solved):
    snapshots = list(np_graph(solved.log))
    metrics = evaluate(snapshots[-1], solved.truth, solved.log)
    result = messages.answer(solved)
    assert [each["count"] for each in result["rounds"]] == [each.num_objects for each in snapshots]
    assert result["num_seen"] == metrics.num_objects_true
    assert f"off by {metrics.mean_pose_error:.2f} m on average" in result["words"]
    assert " → ".join(str(each.num_objects) for each in snapshots) in result["words"]
    assert result["rounds"][-1]["words"].startswith(f"Round {len(snapshots) - 1} of {len(snapshots) - 1}: ")
    for each, snapshot in zip(result["rounds"], snapshots, strict=True):
        assert each["labels"] == snapshot.labels.tolist()
        assert len(each["objects"]) == 4 * snapshot.num_objects
        assert sum(each["objects"][3::4]) == solved.log.num_observations


def test_the_picture_is_laid_over_the_truth(solved):
    """Distances on the page equal those in the words, up to the millimetres that are sent."""
    result = messages.answer(solved)
    true_xy = np.reshape(result["path"], (-1, 2))
    for k, each in enumerate(result["rounds"]):
        off = np.linalg.norm(np.reshape(each["path"], (-1, 2)) - true_xy, axis=1).mean()
        assert off == pytest.approx(messages.pose_error(solved, k), abs=2e-3)


def test_the_first_look_is_the_first_round(solved):
    first = messages.answer(messages.initial(solved.log, solved.truth))
    complete = messages.answer(solved)
    assert first["rounds"] == complete["rounds"][:1]
    assert (first["path"], first["num_seen"]) == (complete["path"], complete["num_seen"])


def test_a_robot_that_sees_nothing_is_told_so():
    nothing = messages.solve_drawing(drawn_fifteen(object_xy=np.empty((0, 2)), object_class=[]))
    text = messages.words(nothing)
    assert text.startswith("The robot saw nothing") and f"{messages.pose_error(nothing, 0):.2f} m" in text
    assert [each["count"] for each in messages.answer(nothing)["rounds"]][-1] == 0


def test_one_object_is_not_several():
    one = messages.solve_drawing(through((1, 4), (5, 4), object_xy=[(6, 4)], object_class=[2]))
    assert "; 1 was there to be seen." in messages.words(one)
    assert messages.round_words(one, -1).count("1 object,") == 1


# ---- to the page and back


def test_a_message_is_plain_text_and_comes_back_as_the_same_run(small):
    message = json.loads(json.dumps(messages.to_message(small)))
    back = messages.from_message(message)
    assert messages.to_message(back) == message
    np.testing.assert_array_equal(drawn_run(back)[0].obs_xy, drawn_run(small)[0].obs_xy)


def test_what_is_carried_survives_the_message():
    moving = gallery.GALLERY["moving"].drawing
    back = messages.from_message(messages.to_message(moving))
    np.testing.assert_array_equal(back.object_goal, moving.object_goal)
    assert (back.object_goal != back.object_xy).any()


def test_an_answer_is_plain_text(solved):
    result = messages.answer(solved)
    assert json.loads(json.dumps(result, allow_nan=False)) == result


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"noise": "1"}, r"^noise: expected a number, got '1'$"),
        ({"seed": None}, r"^seed: expected a number, got None$"),
        ({"stroke": "round"}, r"^stroke: expected a list, got 'round'$"),
        ({"stroke": [[1, 2], [3]]}, r"^stroke: expected a regular array"),
        ({"stroke": [["a", "b"]]}, r"^stroke: expected real numbers"),
        ({"objects": [{"x": 1, "y": 1}]}, r"^objects: expected class, goal_x, goal_y, x, y for each, got"),
        ({"objects": [3]}, r"^objects: expected class, goal_x, goal_y, x, y for each, got 3$"),
        ({"room": [0, 0, 1]}, r"^room: expected shape \(4\), got \(3,\)$"),
    ],
)
def test_a_broken_message_is_refused_in_one_sentence(small, changes, sentence):
    with pytest.raises(ValueError, match=sentence):
        messages.from_message(messages.to_message(small) | changes)


def test_a_message_without_its_parts_is_refused(small):
    message = messages.to_message(small)
    del message["room"]
    with pytest.raises(ValueError, match=r"^drawing: expected the entries .*, missing room$"):
        messages.from_message(message)


# ---- files


@pytest.mark.parametrize("noise", [0.0, 0.7, 2.0])
def test_a_saved_world_can_be_drawn_again(tmp_path, small, noise):
    made = replace(small, noise=noise)
    log, truth = drawn_run(made)
    datasets.save_log(tmp_path / "world.npz", log, truth)
    back = messages.drawing_of(*datasets.load_log(tmp_path / "world.npz"))
    np.testing.assert_array_equal(back.object_xy, made.object_xy)
    assert (back.class_names, back.noise) == (made.class_names, pytest.approx(noise, abs=1e-3))
    assert stroke_length(back.stroke) == pytest.approx(0.1 * (len(truth.poses) - 1), rel=1e-3)
    again = drawn_run(back)[1]
    assert np.linalg.norm(again.poses[-1, :2] - truth.poses[-1, :2]) < 0.3


def test_false_sightings_are_counted_from_the_file(small):
    made = replace(small, clutter_rate=0.4)
    assert messages.drawing_of(*drawn_run(made)).clutter_rate == pytest.approx(0.4, abs=0.15)
