"""A truth of which only a part is known gives every measure that it allows, and no other."""

import math
from dataclasses import replace

import numpy as np
import pytest

from npslam_teach import datasets, evaluation, np_graph, simulate
from npslam_teach.types import UNKNOWN

OF_POSES = {"mean_pose_error", "rmse_pose_error", "cumulative_pose_error"}
OF_LABELS = {"num_objects_true", "ari", "v_measure"}
OF_OBJECTS = {"mean_object_error"}


@pytest.fixture(scope="module")
def solved():
    log, truth = simulate.fifteen_objects(3)
    *_, last = np_graph(log)
    return log, truth, last


def measures(snapshot, truth, log):
    return evaluation.evaluate(snapshot, truth, log).as_dict()


def unknown_in(found):
    return {name for name, value in found.items() if math.isnan(value)}


def test_headings_are_not_needed(solved):
    log, truth, last = solved
    without = replace(truth, poses=truth.poses * [1, 1, np.nan])
    assert measures(last, without, log) == measures(last, truth, log)


def test_labels_alone(solved):
    log, truth, last = solved
    nowhere = replace(truth.world, object_xy=np.full_like(truth.world.object_xy, np.nan))
    found = measures(last, replace(truth, poses=np.full_like(truth.poses, np.nan), world=nowhere), log)
    assert unknown_in(found) == OF_POSES | OF_OBJECTS
    whole = measures(last, truth, log)
    assert {name: value for name, value in found.items() if not math.isnan(value)}.items() <= whole.items()


def test_positions_alone(solved):
    log, truth, last = solved
    found = measures(last, replace(truth, obs_object=np.full(log.num_observations, UNKNOWN)), log)
    assert unknown_in(found) == OF_LABELS | OF_OBJECTS
    assert found["mean_pose_error"] == measures(last, truth, log)["mean_pose_error"]


def test_gaps_are_left_out(solved):
    """Half of the poses, and of the identities: what one gets from a log of that half alone."""
    log, truth, last = solved
    known = np.arange(log.num_poses) % 2 == 0
    found = measures(last, replace(truth, poses=np.where(known[:, None], truth.poses, np.nan)), log)
    motion = evaluation.align_to_truth(last.graph.poses[known], replace(truth, poses=truth.poses[known]))
    x, y = last.graph.poses[known, :2].T
    moved = np.exp(1j * motion[2]) * (x + 1j * y) + motion[0] + 1j * motion[1]
    errors = np.abs(moved - truth.poses[known, :2] @ [1, 1j])
    assert found["mean_pose_error"] == pytest.approx(errors.mean(), rel=1e-12)
    assert found["cumulative_pose_error"] == pytest.approx(errors.sum(), rel=1e-12)

    told = np.arange(log.num_observations) % 3 == 0
    found = measures(last, replace(truth, obs_object=np.where(told, truth.obs_object, UNKNOWN)), log)
    assert found["ari"] == evaluation.compare_partitions(truth.obs_object[told], last.labels[told])[0]
    assert found["num_objects_true"] == len(np.unique(truth.obs_object[told]))


def test_one_known_position_lays_nothing_over_anything(solved):
    log, truth, last = solved
    poses = np.full_like(truth.poses, np.nan)
    poses[5] = truth.poses[5]
    assert unknown_in(measures(last, replace(truth, poses=poses), log)) == OF_POSES | OF_OBJECTS


@pytest.mark.parametrize("suffix", [".npz", ".csv"])
def test_what_is_known_comes_back_from_a_file(tmp_path, solved, suffix):
    log, truth, last = solved
    poses = truth.poses * [1, 1, np.nan]
    poses[10:40] = np.nan
    object_xy = truth.world.object_xy.copy()
    object_xy[4] = np.nan
    obs_object = truth.obs_object.copy()
    obs_object[::7] = UNKNOWN
    partial = replace(truth, world=replace(truth.world, object_xy=object_xy), poses=poses, obs_object=obs_object)
    datasets.save_log(tmp_path / f"run{suffix}", log, partial)
    _, loaded = datasets.load_log(tmp_path / f"run{suffix}")
    np.testing.assert_array_equal(loaded.poses, poses)
    np.testing.assert_array_equal(loaded.world.object_xy, object_xy)
    np.testing.assert_array_equal(loaded.obs_object, obs_object)
    assert not loaded.is_complete and truth.is_complete


FIELDS = {
    "positions": {"true_poses": lambda truth: truth.poses[:, :2]},
    "labels": {"true_object": lambda truth: truth.obs_object},
    "objects": {
        "object_xy": lambda truth: truth.world.object_xy,
        "object_class": lambda truth: truth.world.object_class,
    },
}
NOT_ALLOWED = {
    "positions": OF_LABELS | OF_OBJECTS,
    "labels": OF_POSES | OF_OBJECTS,
    "objects": OF_POSES | OF_LABELS | OF_OBJECTS,
}


@pytest.mark.parametrize("part", FIELDS)
def test_a_file_may_hold_any_part_of_the_truth(tmp_path, solved, part):
    log, truth, last = solved
    names = ("odometry", "obs_time", "obs_xy", "obs_class", "num_classes", "odometry_std", "observation_std")
    fields = {name: getattr(log, name) for name in names}
    np.savez(tmp_path / "run.npz", **fields, **{name: of(truth) for name, of in FIELDS[part].items()})
    _, loaded = datasets.load_log(tmp_path / "run.npz")
    assert unknown_in(measures(last, loaded, log)) == NOT_ALLOWED[part]
    assert loaded.world.object_class.tolist() == ([] if part == "positions" else truth.world.object_class.tolist())


def test_the_class_of_an_object_that_nobody_saw_must_be_told(tmp_path, solved):
    log, truth, _ = solved
    datasets.save_log(tmp_path / "run.npz", log, truth)
    with np.load(tmp_path / "run.npz") as file:
        fields = {name: file[name] for name in file if name != "object_class"}
    np.savez(tmp_path / "run.npz", **fields)
    assert datasets.load_log(tmp_path / "run.npz")[1].world.object_class.tolist() == truth.world.object_class.tolist()
    fields["object_xy"] = np.vstack([fields["object_xy"], [0, 0]])
    np.savez(tmp_path / "run.npz", **fields)
    with pytest.raises(ValueError, match="object_class: expected it beside object_xy, because no observation is of"):
        datasets.load_log(tmp_path / "run.npz")


def test_a_scene_has_no_gaps():
    log, truth = simulate.toy_objects()
    world = replace(truth.world, object_xy=truth.world.object_xy * np.nan)
    with pytest.raises(ValueError, match="world.object_xy: expected finite numbers"):
        simulate.simulate_run(world, truth.poses, simulate.paper_sensor(), np.random.default_rng(0))
