"""The recording errs as it says, is what its files say, and gives no identity away."""

import numpy as np
import pytest

from npslam_teach import datasets, se2
from npslam_teach.course.a_real_robot import errors
from npslam_teach.simulate import recording, write_mrclam
from npslam_teach.simulate.recording import FIRST_LANDMARK, HALF_VIEW, MISREAD_SHARE


@pytest.fixture(scope="module")
def imported(tmp_path_factory):
    """Seed to what ``load_mrclam`` makes of the recording's files."""

    def load(seed, num_classes=5):
        folder = tmp_path_factory.mktemp(f"seed{seed}")
        write_mrclam(recording(seed), folder)
        return datasets.load_mrclam(folder, 1, num_classes)

    return load


def test_a_seed_is_a_recording_and_another_seed_another(tmp_path):
    for name in ("a", "b", "c"):
        (tmp_path / name).mkdir()
    for name, seed in (("a", 3), ("b", 3), ("c", 4)):
        write_mrclam(recording(seed, 40.0), tmp_path / name)
    texts = {name: {f.name: f.read_bytes() for f in (tmp_path / name).iterdir()} for name in ("a", "b", "c")}
    assert texts["a"] == texts["b"]
    assert all(texts["a"][file] != texts["c"][file] for file in texts["a"])


def test_the_files_hold_what_was_recorded(tmp_path):
    recorded = recording(1)
    write_mrclam(recorded, tmp_path)
    expected = {
        "Barcodes": recorded.barcodes,
        "Landmark_Groundtruth": recorded.landmarks,
        "Robot1_Odometry": recorded.wheels,
        "Robot1_Measurement": recorded.sightings,
        "Robot1_Groundtruth": recorded.motion_capture,
    }
    assert {file.stem for file in tmp_path.iterdir()} == set(expected)
    for name, rows in expected.items():
        table = np.loadtxt(tmp_path / f"{name}.dat")[:, : rows.shape[1]]
        np.testing.assert_allclose(table, rows, atol=1e-4)


@pytest.mark.parametrize("seed", [0, 5, 11])
def test_what_is_imported_is_what_was_driven_and_seen(imported, seed):
    recorded = recording(seed)
    log, truth = imported(seed)
    assert log.num_observations == len(recorded.sightings)
    np.testing.assert_allclose(truth.world.object_xy, recorded.landmarks[:, 1:], atol=1e-4)
    np.testing.assert_allclose(truth.poses[0], recorded.motion_capture[0, 1:], atol=1e-3)
    np.testing.assert_allclose(np.hypot(*log.obs_xy.T), recorded.sightings[:, 2], atol=1e-3)
    subject = dict(zip(*recorded.barcodes.T[::-1], strict=True))
    number = np.array([subject[code] for code in recorded.sightings[:, 1]]) - FIRST_LANDMARK
    np.testing.assert_array_equal(log.obs_class, number % 5)
    assert (truth.obs_object == number)[truth.obs_object >= 0].all()


def test_recordings_err_as_real_ones_do(imported):
    """Ten seeds; bounds from the statistics of real recordings, wide enough for every one of ours."""
    for seed in range(10):
        log, truth = imported(seed)
        off = errors.sighting_errors(log, truth)
        order, passes = errors.in_passes(truth.obs_object, log.obs_time)
        assert 0.25 < errors.lag_one(errors.along_the_ray(log, off)[order], passes) < 0.95
        one, twenty = (errors.growth(log.odometry, truth.poses, n) for n in (1, 20))
        ahead, _, turn = twenty / one / np.sqrt(20)
        assert 1.8 < ahead < 4.4 and 0.9 < turn < 2.1
        assert 0.01 < np.mean(truth.obs_object < 0) < 0.08
        assert (np.abs(log.observation_std - 0.115) < 0.06).all()
        assert 300 < log.num_poses < 600 and 200 < log.num_observations < 350


def test_barcodes_are_misread_so_often():
    shares = []
    for seed in range(8):
        recorded = recording(seed, 400.0)
        path, (time, code, distance, bearing) = recorded.motion_capture, recorded.sightings.T
        poses = np.column_stack([np.interp(time, path[:, 0], column) for column in np.unwrap(path[:, 1:], axis=0).T])
        seen = se2.apply(poses, distance[:, None] * np.column_stack([np.cos(bearing), np.sin(bearing)]))
        subject = dict(zip(*recorded.barcodes.T[::-1], strict=True))
        number = np.array([subject[each] for each in code]) - FIRST_LANDMARK
        shares.append(np.mean(np.linalg.norm(seen - recorded.landmarks[number, 1:], axis=1) > 1.0))
        assert np.abs(bearing).max() < HALF_VIEW + 0.15
    # One misreading of fourteen is of the neighbour beside it, and cannot be seen.
    assert np.mean(shares) == pytest.approx(MISREAD_SHARE * 13 / 14, abs=0.01)


def test_clocks_are_uneven_and_increase():
    recorded = recording(2)
    for table in (recorded.wheels, recorded.motion_capture):
        ticks = np.diff(table[:, 0])
        assert ticks.min() > 0.09 and ticks.std() > 0.001
    assert (np.diff(recorded.sightings[:, 0]) >= 0).all()


def test_the_order_within_a_frame_does_not_give_landmarks_away():
    up = []
    for seed in range(6):
        recorded = recording(seed)
        subject = dict(zip(*recorded.barcodes.T[::-1], strict=True))
        number = np.array([subject[code] for code in recorded.sightings[:, 1]])
        same = np.diff(recorded.sightings[:, 0]) == 0
        up += (np.diff(number)[same] > 0).tolist()
    assert len(up) > 300 and 0.4 < np.mean(up) < 0.6


def test_landmarks_stand_in_pairs_of_two_classes(imported):
    _, truth = imported(7)
    xy, classes = truth.world.object_xy, truth.world.object_class
    assert np.bincount(classes).tolist() == [3, 3, 3, 3, 3]
    apart = np.linalg.norm(xy[0:14:2] - xy[1:15:2], axis=1)
    assert apart.min() > 0.17 and apart.max() < 0.31
    assert (classes[0:14:2] != classes[1:15:2]).all()


@pytest.mark.parametrize("seconds", [0, 29.9, 1e6, float("nan")])
def test_a_time_that_cannot_be_meant_is_refused(seconds):
    with pytest.raises(ValueError, match="seconds: expected a number from 30 to 36000, got"):
        recording(0, seconds)
