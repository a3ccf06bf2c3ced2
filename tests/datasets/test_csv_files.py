"""Logs as tables: what is written comes back, what other programs write is understood, and what is wrong is named."""

import shutil
from dataclasses import replace

import numpy as np
import pytest
from layouts import fields_of, small_run

from npslam_teach import datasets
from npslam_teach.datasets.csv_files import NEEDED

SMALL = """kind,time,x,y,theta,class,object
odometry_std,,0.1,0.1,0.05,,
observation_std,,0.2,0.2,,,
odometry,0,1,0,0,,
odometry,1,1,0,0.5,,
observation,0,2,0,,chair,a
observation,2,1,1,,cup,
observation,2,3,1,,chair,clutter
"""


def write(folder, text, name="run.csv"):
    (folder / name).write_text(text, encoding="utf-8")
    return folder / name


def load(folder, text):
    return datasets.load_log(write(folder, text))


@pytest.mark.parametrize("seed", range(5))
def test_log_and_truth_come_back_exactly(tmp_path, seed):
    log, truth = small_run(np.random.default_rng(seed))
    truth = replace(truth, obs_object=np.where(np.arange(8) == 3, -1, truth.obs_object))
    datasets.save_log(tmp_path / "run.csv", log, truth)
    loaded = datasets.load_log(tmp_path / "run.csv")
    for name, value in fields_of(log, truth).items():
        np.testing.assert_array_equal(value, fields_of(*loaded)[name], err_msg=name)
    assert loaded[0].class_names == truth.world.class_names


@pytest.mark.parametrize("suffix", [".csv", ".npz"])
@pytest.mark.parametrize("which", [("odometry_cov",), ("observation_cov",), ("odometry_cov", "observation_cov")])
def test_covariances_of_single_steps_and_observations_come_back(tmp_path, suffix, which):
    rng = np.random.default_rng(0)
    log, truth = small_run(rng)
    roots = {"odometry_cov": rng.normal(size=(len(log.odometry), 3, 3))}
    roots["observation_cov"] = rng.normal(size=(log.num_observations, 2, 2))
    log = replace(log, **{name: roots[name] @ roots[name].swapaxes(1, 2) for name in which})
    datasets.save_log(tmp_path / f"run{suffix}", log, truth)
    loaded, _ = datasets.load_log(tmp_path / f"run{suffix}")
    for name in roots:
        if name in which:
            np.testing.assert_array_equal(getattr(loaded, name), getattr(log, name))
        else:
            assert getattr(loaded, name) is None


def test_a_covariance_that_is_none_or_is_not_whole_is_named(tmp_path):
    head, *rows = SMALL.splitlines()
    rows = [f"{row},{'' if 'observation,' not in row else '1,0,1'}" for row in rows]
    text = "\n".join([f"{head},cov_xx,cov_xy,cov_yy", *rows])
    assert load(tmp_path, text)[0].observation_cov.tolist() == [np.eye(2).tolist()] * 3
    with pytest.raises(ValueError, match="observation_cov: expected symmetric positive definite matrices, got .* at 1"):
        load(tmp_path, text.replace("cup,,1,0,1", "cup,,1,2,1"))
    with pytest.raises(ValueError, match="line 7: cov_xy: expected a number, got ''"):
        load(tmp_path, text.replace("cup,,1,0,1", "cup,,1,,1"))


@pytest.mark.parametrize("suffix", [".csv", ".npz"])
def test_class_probabilities_come_back(tmp_path, suffix):
    log, truth = small_run(np.random.default_rng(0))
    rows = np.random.default_rng(1).dirichlet(np.ones(log.num_classes), log.num_observations)
    log = replace(log, class_probabilities=rows)
    datasets.save_log(tmp_path / f"run{suffix}", log, truth)
    np.testing.assert_array_equal(datasets.load_log(tmp_path / f"run{suffix}")[0].class_probabilities, rows)


def test_class_probabilities_that_are_none_are_named(tmp_path):
    head, *rows = SMALL.splitlines()
    rows = [f"{row},{'' if 'observation,' not in row else '0.25 0.75'}" for row in rows]
    text = "\n".join([f"{head},class_probabilities", *rows])
    assert load(tmp_path, text)[0].class_probabilities.tolist() == [[0.25, 0.75]] * 3
    with pytest.raises(ValueError, match="line 7: class_probabilities: expected 2 numbers with spaces between, got"):
        load(tmp_path, text.replace("cup,,0.25 0.75", "cup,,0.25"))
    with pytest.raises(ValueError, match="line 7: class_probabilities: expected a number.*'x'"):
        load(tmp_path, text.replace("cup,,0.25 0.75", "cup,,0.25 x"))
    with pytest.raises(ValueError, match="class_probabilities: expected rows of probabilities that sum to one"):
        load(tmp_path, text.replace("cup,,0.25 0.75", "cup,,0.25 0.5"))


def test_a_class_that_is_never_seen_comes_back(tmp_path):
    log, _ = small_run(np.random.default_rng(0))
    log = replace(log, num_classes=7)
    datasets.save_log(tmp_path / "run.csv", log)
    loaded, truth = datasets.load_log(tmp_path / "run.csv")
    assert truth is None and loaded.num_classes == 7 and loaded.class_names is None
    np.testing.assert_array_equal(loaded.obs_class, log.obs_class)


def test_by_hand(tmp_path):
    log, truth = load(tmp_path, SMALL)
    np.testing.assert_array_equal(log.odometry, [[1, 0, 0], [1, 0, 0.5]])
    np.testing.assert_array_equal(log.obs_time, [0, 2, 2])
    np.testing.assert_array_equal(log.obs_xy, [[2, 0], [1, 1], [3, 1]])
    np.testing.assert_array_equal(log.obs_class, [0, 1, 0])
    assert log.class_names == ("chair", "cup")
    np.testing.assert_array_equal(log.odometry_std, [0.1, 0.1, 0.05])
    np.testing.assert_array_equal(truth.obs_object, [0, -2, -1])
    assert np.isnan(truth.poses).all() and np.isnan(truth.world.object_xy).all()


def as_excel_does(text):
    return "\ufeff" + text.replace(",", ";").replace("\n", "\r\n")


def shuffled(text):
    head, *rows = text.splitlines()
    return "\n".join([head, *rows[::-1], ""])


def other_columns(text):
    rows = [line.split(",") for line in text.splitlines()]
    return "\n".join("\t".join([row[5], row[0], row[6], *row[1:5]]) for row in rows)


def commented(text):
    return "# my robot, Tuesday\n\n" + text.replace("\n", "\n# and so on\n")


@pytest.mark.parametrize("other", [as_excel_does, other_columns, commented, str.upper, shuffled])
def test_other_writers_are_understood(tmp_path, other):
    text = other(SMALL) if other is not str.upper else SMALL.replace("kind,time", "Kind, TIME ")
    log, truth = load(tmp_path, text)
    expected, _ = load(tmp_path, SMALL)
    order = slice(None, None, -1 if other is shuffled else 1)
    np.testing.assert_array_equal(log.odometry, expected.odometry)
    np.testing.assert_array_equal(log.obs_xy[order], expected.obs_xy)
    np.testing.assert_array_equal(log.obs_class[order], expected.obs_class)
    np.testing.assert_array_equal(truth.obs_object[order], [0, -2, -1])


def test_a_folder_of_files(tmp_path):
    folder = tmp_path / "run"
    folder.mkdir()
    write(folder, "time,x,y,theta\n0,1,0,0\n1,1,0,0.5\n", "odometry.csv")
    write(folder, "time,x,y,class,object\n0,2,0,chair,a\n2,1,1,cup,\n2,3,1,chair,clutter\n", "observations.csv")
    write(folder, "kind,x,y,theta\nodometry_std,0.1,0.1,0.05\nobservation_std,0.2,0.2,\n", "sensor.csv")
    log, truth = datasets.load_log(folder)
    expected = load(tmp_path, SMALL)
    for name, value in fields_of(*expected).items():
        np.testing.assert_array_equal(value, fields_of(log, truth)[name], err_msg=name)
    write(folder, "time,x,y\n0,5,5\n2,7,5\n", "true_poses.csv")
    write(folder, "object,x,y,class\na,7,5,chair\nb,,,cup\n", "true_objects.csv")
    _, truth = datasets.load_log(folder)
    np.testing.assert_array_equal(truth.poses[[0, 2], :2], [[5, 5], [7, 5]])
    assert np.isnan(truth.poses[1]).all() and np.isnan(truth.poses[:, 2]).all()
    np.testing.assert_array_equal(truth.world.object_xy, [[7, 5], [np.nan, np.nan]])


@pytest.mark.parametrize("name", NEEDED)
def test_a_file_that_is_missing_is_named(tmp_path, name):
    folder = tmp_path / "run"
    folder.mkdir()
    for other in NEEDED:
        write(folder, "time,x\n", other)
    (folder / name).unlink()
    with pytest.raises(FileNotFoundError, match=f"run: expected the files .*, found no {name}"):
        datasets.load_log(folder)


WRONG = [
    ("1,0,0.5", "1,zero,0.5", "line 5: y: expected a number, got 'zero'"),
    ("1,0,0.5", "1,nan,0.5", "line 5: y: expected a number, got 'nan'"),
    ("1,0,0.5", '1,"0,5",0.5', "line 5: y: expected a number (decimals after a point), got '0,5'"),
    ("1,0,0.5", "1,,0.5", "line 5: y: expected a value in a row of odometry, got none"),
    ("odometry,1", "odometry,0", "line 5: time: expected another one than in "),
    ("odometry,1", "odometry,2", "line 5: time: expected a whole number from 0 to 1, got '2'"),
    ("observation,0", "observation,3", "line 6: time: expected a whole number from 0 to 2, got '3'"),
    ("observation,0", "observation,0.5", "line 6: time: expected a whole number from 0 to 2, got '0.5'"),
    ("observation,0", "observed,0", "line 6: kind: expected one of odometry_std, "),
    (",chair,a", ",,a", "line 6: class: expected a value in a row of observation, got none"),
    (",chair,a", ",chair,a,b", "line 6: expected 7 columns, got 8"),
    (",chair,a", ',"chair,a', "line 6: expected a line of CSV"),
    ("odometry_std,,0.1", "odometry_std,,-0.1", "odometry_std: expected positive numbers"),
    ("odometry_std,,0.1,0.1,0.05,,\n", "", "expected one row of odometry_std, got 0"),
    ("x,y,theta", "x,x,theta", "line 1: expected every column once, got 'x' twice"),
    ("kind,time,x,y,theta,class,object", "a,b,c,d,e,f,g", "line 1: expected columns out of kind, "),
    ("observation,2,1,1", "true_object,,1,1,,cup,b\nobservation,2,1,1", "line 6: object: expected one of those in"),
    ("observation,2,1,1", "class,,,,,chair,\nobservation,2,1,1", "line 8: class: expected one of those in rows of"),
    ("observation,2,1,1", "true_pose,9,1,1,,,\nobservation,2,1,1", "line 7: time: expected a whole number from 0 to 2"),
]


@pytest.mark.parametrize(("old", "new", "words"), WRONG, ids=range(len(WRONG)))
def test_what_is_wrong_is_named(tmp_path, old, new, words):
    assert SMALL.count(old) >= 1
    with pytest.raises(ValueError) as caught:
        load(tmp_path, SMALL.replace(old, new, 1))
    assert str(caught.value).startswith(str(tmp_path / "run.csv")) and "\n" not in str(caught.value)
    assert words in str(caught.value)


def test_numbers_of_classes_stay_what_they_are(tmp_path):
    log, _ = load(tmp_path, SMALL.replace("chair", "4").replace("cup", "2"))
    assert log.num_classes == 5 and log.class_names is None
    np.testing.assert_array_equal(log.obs_class, [4, 2, 4])
    with pytest.raises(ValueError, match="line 6: class: expected a whole number from 0 to 9999, got '1000000000'"):
        load(tmp_path, SMALL.replace("chair", "1000000000").replace("cup", "2"))


def test_columns_that_are_not_read_are_named(tmp_path):
    text = SMALL.replace("object\n", "object,battery\n", 1)
    with pytest.warns(UserWarning, match="run.csv, line 1: columns that are not read: 'battery'"):
        load(tmp_path, text)


def test_not_text_no_file_and_nothing(tmp_path):
    (tmp_path / "run.csv").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(ValueError, match="expected text in UTF-8"):
        datasets.load_log(tmp_path / "run.csv")
    with pytest.raises(FileNotFoundError, match="expected a file, found nothing"):
        datasets.load_log(tmp_path / "none.csv")
    with pytest.raises(ValueError, match="expected a line with the names of the columns"):
        load(tmp_path, "# nothing\n\n")


def test_damaged_files_end_in_one_sentence_or_a_log(tmp_path, damaged):
    rng = np.random.default_rng(0)
    datasets.save_log(tmp_path / "run.csv", *small_run(rng))
    original = (tmp_path / "run.csv").read_bytes()
    accepted = 0
    for _ in range(300):
        (tmp_path / "run.csv").write_bytes(damaged(original, rng))
        try:
            datasets.load_log(tmp_path / "run.csv")
            accepted += 1
        except UserWarning:
            pass  # a column lost its name
        except ValueError as error:
            assert str(error).startswith(str(tmp_path / "run.csv")) and "\n" not in str(error)
    assert 0 < accepted < 300
    shutil.rmtree(tmp_path)


def test_a_file_without_its_first_row_is_told_which_columns_there_are(tmp_path):
    (tmp_path / "run.csv").write_text("odometry_std,,0.2,0.05,0.02,,\nodometry,0,1,0,0,,\n", encoding="utf-8")
    with pytest.raises(ValueError, match=r"line 1: expected columns out of kind, time, x, .* got 'odometry_std,,0.2"):
        datasets.load_log(tmp_path / "run.csv")


def test_time_stamps_are_not_taken_for_poses(tmp_path):
    rows = ["kind,time,x,y,theta,class", "odometry_std,,1,1,1,", "observation_std,,1,1,,", "odometry,1.6e9,1,0,0,"]
    (tmp_path / "run.csv").write_text("\n".join(rows), encoding="utf-8")
    with pytest.raises(ValueError, match=r"line 4: time: .* got '1.6e9' \(poses are counted, this is no"):
        datasets.load_log(tmp_path / "run.csv")
