"""Recordings of real robots: files of the same format that the tests write, and a robot that is known."""

import numpy as np
import pytest

from npslam_teach import datasets, evaluation, se2, simulate
from npslam_teach.cli import parser
from npslam_teach.pose_graph import fit

LANDMARKS = np.array([[2.0, 1.0], [4.0, -1.5], [0.5, -2.0], [-1.5, 1.0]])


def write_mrclam(folder, noise=0.0, seed=0):
    """A robot that drives in a circle for 40 s at 10 Hz, sees a landmark each half second, and another robot once."""
    rng = np.random.default_rng(seed)
    time = 100.0 + np.arange(0, 40, 0.1)
    wheels = np.column_stack([time, np.full(len(time), 0.306), np.full(len(time), 0.249)])  # not quite as it drives
    path = se2.dead_reckoning(np.tile([0.03, 0.0, 0.025], (len(time) - 1, 1)), (0.5, 0.2, 0.3))
    seen = []
    for k in range(3, len(time), 5):
        subject = 6 + int(rng.integers(len(LANDMARKS)))
        xy = se2.apply_inverse(path[k], LANDMARKS[subject - 6]) + rng.normal(0, noise, 2)
        seen.append([time[k], 10 * subject, np.hypot(*xy), np.arctan2(xy[1], xy[0])])
    seen.append([time[7], 20, 1.0, 0.0])  # robot 2
    tables = {
        "Barcodes": [[subject, 10 * subject] for subject in range(1, 6 + len(LANDMARKS))],
        "Landmark_Groundtruth": [[6 + i, *xy, 0.001, 0.001] for i, xy in enumerate(LANDMARKS)],
        "Robot1_Odometry": wheels,
        "Robot1_Measurement": seen,
        "Robot1_Groundtruth": np.column_stack([time, path]),
    }
    for name, rows in tables.items():
        lines = ["# a comment", *("\t".join(f"{number:.9f}" for number in row) for row in rows)]
        (folder / f"{name}.dat").write_text("\n".join(lines), encoding="utf-8")


def test_a_recording_of_mrclam_is_the_robot_that_was_written(tmp_path):
    write_mrclam(tmp_path, 0.02)
    log, truth = datasets.load_mrclam(tmp_path, 1, 2)
    assert (log.num_classes, log.num_observations) == (2, 80)
    assert np.abs(log.odometry[:, 0]).max() < 0.1 + 0.0306
    np.testing.assert_allclose(truth.world.object_xy, LANDMARKS)
    np.testing.assert_array_equal(log.obs_class, truth.obs_object % 2)
    seen = se2.apply(truth.poses[log.obs_time], log.obs_xy)
    off = np.linalg.norm(seen - LANDMARKS[truth.obs_object], axis=1)
    assert off.max() < 0.1
    np.testing.assert_allclose(log.observation_std, 0.02, rtol=0.4)
    graph = fit(log, np.unique(truth.obs_object, return_inverse=True)[1])
    motion = evaluation.align_to_truth(graph.poses, truth)
    assert np.abs(se2.apply(motion, graph.poses[:, :2]) - truth.poses[:, :2]).max() < 0.1


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("Barcodes", "1 2 3\n4 5 6", "Barcodes.dat: line 1: expected 2 columns, got 3"),
        ("Barcodes", "6 60\n7 60", "Barcodes.dat: expected one subject for barcode 60, got several"),
        ("Barcodes", "6 60\n7 70.5", "Barcodes.dat: line 2: expected a whole number in column 2, got 70.5"),
        ("Robot1_Odometry", "1 2 x\n1 2 3", "Robot1_Odometry.dat: line 1: expected numbers only, got '1 2 x'"),
        ("Robot1_Measurement", "1 60 1 0\n2 60 -1 0", "Robot1_Measurement.dat: expected distances from 0, got -1"),
        ("Landmark_Groundtruth", "6 0 0 1 1\n8 1 1 1 1", "expected subjects 6 to 7, each once, got 6, 8"),
        ("Landmark_Groundtruth", "6 0 0 1 1\n6 1 1 1 1", "expected subjects 6 to 7, each once, got 6, 6"),
        ("Robot1_Odometry", "# nothing", "Robot1_Odometry.dat: expected at least two lines of numbers, got 0"),
        ("Robot1_Measurement", "1 60 1 0\n2 60 1 0", "expected a landmark in view while the robot drives"),
        (
            "Robot1_Groundtruth",
            "1 0 0 0\n2 0 0 0",
            "Robot1_Groundtruth.dat: expected the pose at two sights or more, got 0",
        ),
        ("Landmark_Groundtruth", "6 0 0 1 1\n7 1 1 1 1", "expected subject 9, which is seen"),
    ],
)
def test_a_recording_that_is_not_one_is_refused_in_a_sentence(tmp_path, refused, name, text, words):
    write_mrclam(tmp_path)
    (tmp_path / f"{name}.dat").write_text(text, encoding="utf-8")
    assert words in refused("import", "mrclam", tmp_path, "--out", tmp_path / "run.npz")
    assert not (tmp_path / "run.npz").exists()


@pytest.mark.parametrize("encoding", ["utf-16", "latin-1"])
def test_other_encodings_are_refused_and_a_mark_of_utf_8_is_not(tmp_path, refused, encoding):
    write_mrclam(tmp_path)
    file = tmp_path / "Barcodes.dat"
    text = "# caf\u00e9\n" + file.read_text(encoding="utf-8")
    file.write_text(text, encoding="utf-8-sig")
    datasets.load_mrclam(tmp_path)
    file.write_text(text, encoding=encoding)
    assert "Barcodes.dat: expected text in UTF-8" in refused(
        "import", "mrclam", tmp_path, "--out", tmp_path / "run.npz"
    )
    assert f"{file}: expected a folder, got a file" in refused("import", "mrclam", file, "--out", tmp_path / "run.npz")


def test_a_graph_without_information_is_refused(tmp_path, refused):
    graph = "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\nVERTEX_XY 2 1 1\n"
    graph += "EDGE_SE2 0 1 1 0 0 0 0 0 0 0 0\nEDGE_SE2_XY 0 2 1 1 1 0 1\n"
    (tmp_path / "graph.g2o").write_text(graph, encoding="utf-8")
    said = refused("import", "victoria-park", tmp_path / "graph.g2o", "--out", tmp_path / "run.npz")
    assert "graph.g2o: expected information above 0, got a median of 0" in said


def test_a_missing_file_is_named(tmp_path, refused):
    write_mrclam(tmp_path)
    assert "Robot3_Odometry.dat: no such file" in refused(
        "import", "mrclam", tmp_path, "--robot", "3", "--out", tmp_path / "run.npz"
    )


def test_a_graph_of_known_landmarks_is_a_log_that_hides_them(tmp_path):
    log, truth = simulate.fifteen_objects(0)
    labels = np.unique(truth.obs_object, return_inverse=True)[1]
    datasets.save_g2o(tmp_path / "graph.g2o", fit(log, labels))
    assert (
        parser.main(["import", "victoria-park", str(tmp_path / "graph.g2o"), "--out", str(tmp_path / "run.npz")]) == 0
    )
    hidden, known = datasets.load_log(tmp_path / "run.npz")
    np.testing.assert_array_equal(known.obs_object, labels)
    np.testing.assert_allclose(hidden.odometry, log.odometry, atol=1e-9)
    np.testing.assert_allclose(hidden.obs_xy, log.obs_xy, atol=1e-9)
    np.testing.assert_allclose(hidden.odometry_std, log.odometry_std)
    assert hidden.num_classes == 1


@pytest.mark.parametrize(("option", "owner"), [("--robot", "mrclam"), ("--classes", "mrclam"), ("--rate", "rosbag")])
def test_an_option_of_another_format_is_refused(tmp_path, refused, option, owner):
    log, truth = simulate.toy_objects()
    datasets.save_log(tmp_path / "run.csv", log, truth)
    said = refused("import", "csv", tmp_path / "run.csv", option, "2", "--out", tmp_path / "run.npz")
    assert f"{option}: expected with {owner} only, got csv" in said


def test_victoria_park(data_folder):
    log, truth = datasets.load_hidden(data_folder / "victoria_park.g2o")
    assert (log.num_poses, log.num_observations, len(truth.world.object_xy)) == (6969, 3640, 151)


def test_tables_become_a_log(tmp_path, capsys):
    log, truth = simulate.toy_objects()
    datasets.save_log(tmp_path / "run.csv", log, truth)
    assert parser.main(["import", "csv", str(tmp_path / "run.csv"), "--out", str(tmp_path / "run.npz")]) == 0
    assert capsys.readouterr().out.endswith(f"{log.num_poses} poses, 8 observations of {log.num_classes} classes\n")
    np.testing.assert_array_equal(datasets.load_log(tmp_path / "run.npz")[0].obs_xy, log.obs_xy)
