"""Laws that hold for every world, log and graph, tried on generated ones.

The suite tries the same examples every time. ``NPSLAM_TEACH_EXAMPLES=2000`` tries so many others, new ones every time.
"""

import json
import os
import subprocess
import sys
import warnings
from dataclasses import replace

import numpy as np
import pytest
from graphs import random_graph
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from npslam_teach import datasets, evaluation, pose_graph, se2, simulate
from npslam_teach.methods import METHODS
from npslam_teach.types import BetweenFactors, ObservationFactors, PoseGraph, RobotLog, SensorModel, World

EXAMPLES = int(os.environ.get("NPSLAM_TEACH_EXAMPLES", "0"))
# One that takes seconds for an example is not among the quick ones.
EACH_METHOD = [pytest.param(name, marks=pytest.mark.slow if name == "posterior" else ()) for name in METHODS]
tried = settings(
    max_examples=EXAMPLES or 40,
    derandomize=not EXAMPLES,
    deadline=None,
    database=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.function_scoped_fixture],
)

# ---- what is generated ----

metres = st.floats(-1e4, 1e4, allow_subnormal=False)
poses = st.tuples(metres, metres, st.floats(-50, 50)).map(np.array)
seeds = st.integers(0, 2**32 - 1)


@st.composite
def runs(draw):
    """A run of one to nine poses through a world of up to five objects; also without objects, or without sightings."""
    rng = np.random.default_rng(draw(seeds))
    num_classes, num_objects, num_poses = draw(st.integers(1, 3)), draw(st.integers(0, 5)), draw(st.integers(1, 9))
    spread = draw(st.sampled_from([0.1, 3.0, 100.0]))
    world = World(
        rng.uniform(-spread, spread, (num_objects, 2)),
        rng.integers(0, num_classes, num_objects),
        [f"class {c}" for c in range(num_classes)],
    )
    confusion = draw(st.sampled_from([None, 0.0, 0.3]))
    sensor = SensorModel(
        odometry_std=10.0 ** rng.uniform(-4, 0, 3),
        observation_std=10.0 ** rng.uniform(-4, 0, 2),
        max_range=draw(st.sampled_from([0.0, 2.0, 1000.0])),
        field_of_view=draw(st.sampled_from([0.5, 2 * np.pi])),
        class_confusion=None if confusion is None else _confusion(num_classes, confusion),
        detection_probability=draw(st.sampled_from([0.0, 0.7, 1.0])),
        clutter_rate=draw(st.sampled_from([0.0, 0.5])),
    )
    path = np.column_stack([rng.uniform(-spread, spread, (num_poses, 2)), rng.uniform(-4, 4, num_poses)])
    return simulate.simulate_run(world, path, sensor, rng)


def _confusion(num_classes, share):
    return (1 - share) * np.eye(num_classes) + share / num_classes


def graphs():
    """Well-determined graphs of up to fourteen poses."""
    return st.builds(
        random_graph,
        seeds,
        num_poses=st.integers(4, 14),
        num_landmarks=st.integers(0, 5),
        num_loops=st.integers(0, 4),
        noise=st.sampled_from([0.0, 0.02, 0.1]),
        start_noise=st.sampled_from([0.0, 0.2]),
    )


# ---- se2 ----


def assert_same_pose(a, b, scale):
    np.testing.assert_allclose(a[..., :2], b[..., :2], rtol=0, atol=1e-13 * scale + 1e-13)
    assert np.abs(se2.wrap(a[..., 2] - b[..., 2])).max() < 1e-12


@tried
@given(poses, poses, poses)
def test_rigid_motions_are_a_group(a, b, c):
    scale = np.abs([a, b, c]).max()
    assert_same_pose(se2.compose(se2.compose(a, b), c), se2.compose(a, se2.compose(b, c)), 10 * scale)
    assert_same_pose(se2.compose(a, np.zeros(3)), a, scale)
    assert_same_pose(se2.compose(np.zeros(3), a), a, scale)
    assert_same_pose(se2.compose(a, se2.inverse(a)), np.zeros(3), 10 * scale)
    assert_same_pose(se2.compose(a, se2.between(a, b)), b, 10 * scale)
    assert_same_pose(se2.inverse(se2.compose(a, b)), se2.compose(se2.inverse(b), se2.inverse(a)), 10 * scale)


@tried
@given(poses, poses, st.tuples(metres, metres).map(np.array))
def test_motions_of_points_follow_motions_of_frames(a, b, xy):
    scale = 10 * np.abs([*a, *b, *xy]).max()
    composed, in_turn = se2.apply(se2.compose(a, b), xy), se2.apply(a, se2.apply(b, xy))
    np.testing.assert_allclose(composed, in_turn, rtol=0, atol=1e-13 * scale + 1e-13)
    np.testing.assert_allclose(se2.apply_inverse(a, se2.apply(a, xy)), xy, rtol=0, atol=1e-13 * scale + 1e-13)


@tried
@given(st.floats(-1e9, 1e9))
def test_wrapped_angles_point_the_same_way(angle):
    wrapped = float(se2.wrap(angle))
    assert -np.pi <= wrapped < np.pi
    assert np.exp(1j * wrapped) == pytest.approx(np.exp(1j * angle), abs=1e-15 * max(abs(angle), 10))


# ---- methods ----


def results(method, log):
    """All snapshots; a solver that says that it did not converge is none of these tests' business.

    The posterior searches once: a law that holds for every search holds for the best of several.
    """
    settings_of = {"starts": 1} if method == "posterior" else {}
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "the solver stopped", UserWarning)
        return list(METHODS[method](log, **settings_of))


@pytest.mark.parametrize("method", EACH_METHOD)
@tried
@given(runs(), seeds)
def test_every_method_keeps_its_books_whatever_classes_are_called(method, run, seed):
    """Numbers are finite and fit together; other names of classes change no partition."""
    log, _ = run
    name = np.random.default_rng(seed).permutation(log.num_classes)
    found, renamed = results(method, log), replace(log, obs_class=name[log.obs_class])
    for snapshot in found:
        assert_books_are_kept(snapshot, log, METHODS[method].has_objective)
    if np.array_equal(renamed.obs_class, log.obs_class):
        return  # nothing has another name
    for snapshot, other in zip(found, results(method, renamed), strict=True):
        np.testing.assert_array_equal(same_names(snapshot.labels), same_names(other.labels))


def assert_books_are_kept(snapshot, log, has_objective):
    assert np.isfinite(snapshot.chi2)
    assert np.isfinite(snapshot.objective) if has_objective else snapshot.objective is None
    assert np.isfinite(snapshot.graph.poses).all() and np.isfinite(snapshot.graph.landmarks).all()
    assert snapshot.graph.poses.shape == (log.num_poses, 3)
    assert snapshot.labels.shape == (log.num_observations,)
    used = snapshot.labels[snapshot.labels >= 0]
    np.testing.assert_array_equal(np.unique(used), np.arange(snapshot.num_objects))
    counts = np.bincount(used, minlength=snapshot.num_objects)
    assert snapshot.votes.shape == (snapshot.num_objects, log.num_classes + 1)
    np.testing.assert_array_equal(snapshot.votes.sum(axis=1), counts + 1)
    assert (snapshot.votes[:, 0] == 1).all() and (snapshot.votes >= 0).all()
    assert snapshot.chi2 == pytest.approx(pose_graph.chi2(snapshot.graph), rel=1e-12, abs=1e-18)
    assert snapshot.chi2 >= 0


def same_names(labels):
    """The labels in order of first appearance; -1 stays."""
    names = {-1: -1}
    return [names.setdefault(label, len(names) - 1) for label in labels.tolist()]


@tried
@given(runs(), seeds)
def test_what_true_objects_are_called_does_not_matter(run, seed):
    log, truth = run
    order = np.random.default_rng(seed).permutation(len(truth.world.object_xy))
    name = np.append(np.argsort(order), -1)  # clutter stays clutter
    world = replace(truth.world, object_xy=truth.world.object_xy[order], object_class=truth.world.object_class[order])
    renamed = replace(truth, world=world, obs_object=name[truth.obs_object])
    *_, last = results("np-graph", log)
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "the solver stopped", UserWarning)
        metrics, others = (evaluation.evaluate(last, each, log).as_dict() for each in (truth, renamed))
    assert metrics == pytest.approx(others, rel=1e-9, nan_ok=True)


# ---- logs and files ----


def arrays_of(instance):
    """Every array of a dataclass, those of dataclasses within included."""
    for name, value in vars(instance).items():
        if hasattr(value, "__dataclass_fields__"):
            yield from ((f"{name}.{inner}", array) for inner, array in arrays_of(value))
        else:
            yield name, np.asarray(value)


def assert_identical(a, b):
    for (name, value), (_, other) in zip(arrays_of(a), arrays_of(b), strict=True):
        np.testing.assert_array_equal(value, other, err_msg=name)


@pytest.mark.filterwarnings("ignore:.*are these degrees", "ignore:.*is it one row too many")  # random steps are either
@tried
@given(runs(), st.booleans())
def test_a_log_comes_back_from_its_file_exactly(tmp_path, run, with_truth):
    log, truth = run
    datasets.save_log(tmp_path / "run.npz", log, truth if with_truth else None)
    log_again, truth_again = datasets.load_log(tmp_path / "run.npz")
    # The file has one list of names: those of the truth are then the log's, too.
    assert_identical(replace(log, class_names=truth.world.class_names) if with_truth else log, log_again)
    assert (truth_again is not None) == with_truth
    if with_truth:
        assert_identical(truth, truth_again)


@tried
@given(graphs())
def test_a_graph_comes_back_from_its_file(tmp_path, graph):
    datasets.save_g2o(tmp_path / "graph.g2o", graph)
    again = datasets.load_g2o(tmp_path / "graph.g2o")
    for (name, value), (_, other) in zip(arrays_of(graph), arrays_of(again), strict=True):
        if name == "between.information":  # turned on the way in and back on the way out
            np.testing.assert_allclose(value, other, rtol=0, atol=1e-13 * np.abs(value).max(initial=0))
        else:
            np.testing.assert_array_equal(value, other, err_msg=name)
    assert pose_graph.chi2(again) == pytest.approx(pose_graph.chi2(graph), rel=1e-9, abs=1e-18)


@tried
@given(runs(), seeds)
def test_noise_of_nothing_changes_nothing(run, seed):
    assert_identical(run[0], simulate.add_noise(run[0], 0.0, np.random.default_rng(seed)))


@tried
@given(runs())
def test_a_log_holds_nothing_but_what_was_measured(run):
    log, truth = run
    assert isinstance(log, RobotLog)
    assert len(truth.obs_object) == log.num_observations
    assert (np.diff(log.obs_time) >= 0).all()


# ---- the solver ----


def solved(graph, tolerance=1e-13):
    *_, last = pose_graph.levenberg_marquardt(graph, tolerance)
    return last


@tried
@given(graphs(), poses)
def test_a_rigid_motion_of_the_start_changes_no_chi2(graph, motion):
    moved = replace(graph, poses=se2.compose(motion, graph.poses), landmarks=se2.apply(motion, graph.landmarks))
    blur = 1e-9 * np.abs(motion).max()  # far from the origin differences of coordinates lose digits
    assert pose_graph.chi2(moved) == pytest.approx(pose_graph.chi2(graph), rel=1e-9 + blur, abs=1e-12 + blur)
    assert solved(moved).chi2 == pytest.approx(solved(graph).chi2, rel=1e-8 + blur, abs=1e-12 + blur)


@tried
@given(graphs(), seeds)
def test_the_order_of_factors_does_not_matter(graph, seed):
    rng = np.random.default_rng(seed)
    between, seen = graph.between, graph.observations
    f, g = rng.permutation(len(between.i)), rng.permutation(len(seen.pose))
    shuffled = replace(
        graph,
        between=BetweenFactors(between.i[f], between.j[f], between.relative_pose[f], between.information[f]),
        observations=ObservationFactors(seen.pose[g], seen.landmark[g], seen.xy[g], seen.information[g]),
    )
    # With the solver's own rule for stopping: near the last digit of chi2 the order decides whether one more step,
    # which moves the poses by a billionth, still counts as lower.
    first, second = solved(graph, 1e-9), solved(shuffled, 1e-9)
    assert second.chi2 == pytest.approx(first.chi2, rel=1e-9, abs=1e-12)
    blur = 1e-9 * np.abs(first.graph.poses).max()
    np.testing.assert_allclose(second.graph.poses[:, :2], first.graph.poses[:, :2], rtol=0, atol=blur)
    np.testing.assert_allclose(second.graph.landmarks, first.graph.landmarks, rtol=0, atol=blur)
    assert np.abs(se2.wrap(second.graph.poses[:, 2] - first.graph.poses[:, 2])).max() < 1e-9


@st.composite
def difficult_graphs(draw):
    """Graphs with parts cut off, information that is next to nothing or enormous, of a great or tiny scale."""
    graph, rng = draw(graphs()), np.random.default_rng(draw(seeds))
    between, seen = graph.between, graph.observations
    scale = 10.0 ** draw(st.integers(-6, 6))
    kept = draw(st.sampled_from([1.0, 1.0, 0.9, 0.5, 0.0]))
    f, g = rng.random(len(between.i)) < kept, rng.random(len(seen.pose)) < draw(st.sampled_from([1.0, 1.0, 0.5, 0.0]))
    metric = np.array([scale, scale, 1.0])
    return PoseGraph(
        graph.poses * metric * (1 + draw(st.sampled_from([0.0, 0.0, 10.0])) * rng.normal(size=graph.poses.shape)),
        graph.landmarks * scale,
        BetweenFactors(
            between.i[f], between.j[f], between.relative_pose[f] * metric, _weighted(draw, rng, between.information[f])
        ),
        ObservationFactors(
            seen.pose[g], seen.landmark[g], seen.xy[g] * scale, _weighted(draw, rng, seen.information[g])
        ),
    )


def _weighted(draw, rng, information):
    """The information times powers of ten, all alike or each its own, sometimes without one direction."""
    powers = draw(st.sampled_from([np.zeros(1), np.array([-12.0]), np.array([9.0]), np.linspace(-8, 8, 7)]))
    information = information * 10.0 ** rng.choice(powers, (len(information), 1, 1))
    if draw(st.integers(0, 4)) == 0:
        flat = np.eye(information.shape[1])
        flat[-1, -1] = draw(st.sampled_from([0.0, 1e-8]))
        information = flat @ information @ flat
    return (information + information.swapaxes(1, 2)) / 2


@settings(tried, max_examples=EXAMPLES or 150)
@given(difficult_graphs())
def test_the_solver_answers_with_numbers_or_with_a_reason(graph):
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # an overflow or a division by zero is not an answer
        try:
            steps = list(pose_graph.levenberg_marquardt(graph, max_iterations=30))
        except np.linalg.LinAlgError as error:
            assert any(word in str(error) for word in ("pose ", "landmark ", "singular")), error
            return
    last = steps[-1]
    assert np.isfinite(last.graph.poses).all() and np.isfinite(last.graph.landmarks).all()
    assert np.isfinite([last.chi2, last.damping]).all() and np.isfinite(last.dx).all()
    assert last.converged == (last.status == "converged")
    assert last.converged or last.status not in ("", "running")
    values = [step.chi2 for step in steps]
    assert all(after <= before for before, after in zip(values, values[1:], strict=False))
    assert pose_graph.chi2(last.graph) == pytest.approx(last.chi2, rel=1e-12, abs=1e-300)


@tried
@given(graphs(), seeds)
def test_what_is_cut_off_is_named(graph, seed):
    """Whatever loses its last chain of factors to pose 0 is the one that the error is about."""
    lonely = int(np.random.default_rng(seed).integers(1, len(graph.poses)))
    between, seen = graph.between, graph.observations
    f, g = (between.i != lonely) & (between.j != lonely), seen.pose != lonely
    assume(not len(graph.landmarks) or g.any())
    cut = replace(
        graph,
        between=BetweenFactors(between.i[f], between.j[f], between.relative_pose[f], between.information[f]),
        observations=ObservationFactors(seen.pose[g], seen.landmark[g], seen.xy[g], seen.information[g]),
    )
    with pytest.raises(np.linalg.LinAlgError) as caught:
        list(pose_graph.levenberg_marquardt(cut))
    named = str(caught.value).split(" is not tied")[0].split()
    assert named[0] in ("pose", "landmark")
    if len(graph.landmarks):  # every other pose still sees the landmarks
        assert named == ["pose", str(lonely)]


# ---- threads ----

THREADS = """
import json, sys
sys.path.insert(0, {tests!r})
from graphs import random_graph
from npslam_teach import pose_graph
*_, last = pose_graph.levenberg_marquardt(random_graph(3, num_poses=400, num_landmarks=60, num_loops=40))
pose_cov, _ = pose_graph.marginal_covariance(last.graph, [399])
print(json.dumps([last.chi2, last.graph.poses.tolist(), last.graph.landmarks.tolist(), pose_cov.tolist()]))
"""


def test_the_number_of_threads_does_not_matter():
    answers = []
    for threads in ("1", "2"):
        environment = os.environ | {f"{name}_NUM_THREADS": threads for name in ("OMP", "OPENBLAS", "MKL")}
        code = THREADS.format(tests=os.path.join(os.path.dirname(__file__), "helpers"))
        done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
        answers.append(json.loads(done.stdout))
    one, two = answers
    assert one[0] == pytest.approx(two[0], rel=1e-9)
    for a, b in zip(one[1:], two[1:], strict=True):
        np.testing.assert_allclose(a, b, rtol=0, atol=1e-9)
