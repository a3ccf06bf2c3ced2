"""Logs in and out, the authors' files and their traps, and every way in which a file can be wrong."""

import io
import os
import warnings
import zipfile

import numpy as np
import pytest
import scipy.io
from layouts import LOG_FIELDS, fields_of, office_variables, simulation_variables, small_run

from npslam_teach import datasets, se2, types
from npslam_teach.system import files


@pytest.fixture
def run():
    return small_run(np.random.default_rng(0))


def assert_same_run(run, other):
    fields, others = fields_of(*run), fields_of(*other)
    assert list(fields) == list(others)
    for name, value in fields.items():
        np.testing.assert_array_equal(value, others[name], err_msg=name)


def message_of(path, load=datasets.load_log, error=ValueError):
    """The one sentence that loading ends in; it begins with the file's name."""
    with pytest.raises(error) as caught:
        load(path)
    message = str(caught.value)
    assert message.startswith(f"{path}: ") and "\n" not in message
    assert len(message) < len(str(path)) + 400
    return message


def residuals_at_truth(log, truth):
    """(T-1, 3) and (M, 2), from the formulas in complex numbers: nothing of the library is used."""
    xy, turn = truth.poses[:, :2] @ [1, 1j], np.exp(1j * truth.poses[:, 2])
    step = (xy[1:] - xy[:-1]) / turn[:-1] - log.odometry[:, :2] @ [1, 1j]
    angle = np.angle(turn[1:] / turn[:-1] * np.exp(-1j * log.odometry[:, 2]))
    objects = truth.world.object_xy[truth.obs_object] @ [1, 1j]
    seen = (objects - xy[log.obs_time]) / turn[log.obs_time] - log.obs_xy @ [1, 1j]
    return np.column_stack([step.real, step.imag, angle]), np.column_stack([seen.real, seen.imag])


# ---- .npz logs ----


@pytest.mark.parametrize("seed", range(5))
def test_log_and_truth_come_back_exactly(tmp_path, seed):
    run = small_run(np.random.default_rng(seed))
    datasets.save_log(tmp_path / "run.npz", *run)
    assert_same_run(run, datasets.load_log(tmp_path / "run.npz"))


def test_log_without_truth_comes_back_without(tmp_path, run):
    datasets.save_log(str(tmp_path / "run.npz"), run[0])
    log, truth = datasets.load_log(str(tmp_path / "run.npz"))
    assert truth is None
    assert_same_run((run[0], None), (log, None))


def test_log_without_observations_comes_back(tmp_path):
    run = small_run(np.random.default_rng(0), num_poses=1, num_objects=0, num_observations=0)
    datasets.save_log(tmp_path / "run.npz", *run)
    assert_same_run(run, datasets.load_log(tmp_path / "run.npz"))


def test_other_writers_are_understood(tmp_path, run):
    fields = fields_of(*run) | {"comment": np.array("ignored"), "objects": np.array([None])}
    fields["odometry"] = np.asfortranarray(fields["odometry"].astype(">f8"))
    fields["obs_time"] = fields["obs_time"].astype(np.uint8)
    fields["num_classes"] = np.float64(2)
    del fields["class_names"]
    np.savez_compressed(tmp_path / "RUN.NPZ.npz", **fields)
    log, truth = datasets.load_log(tmp_path / "RUN.NPZ.npz")
    np.testing.assert_array_equal(log.odometry, run[0].odometry)
    np.testing.assert_array_equal(log.obs_time, run[0].obs_time)
    assert truth.world.class_names == ("class 0", "class 1")


def test_clutter_is_allowed_in_the_truth(tmp_path, run):
    np.savez(tmp_path / "run.npz", **fields_of(*run) | {"true_object": np.full(8, -1)})
    assert (datasets.load_log(tmp_path / "run.npz")[1].obs_object == -1).all()


def npy(array):
    stream = io.BytesIO()
    np.save(stream, array)
    return stream.getvalue()


def claiming(shape, descr="<f8", contents=b"\0" * 48):
    """An array whose header claims a shape and type that its contents do not have."""
    header = f"{{'descr': {descr!r}, 'fortran_order': False, 'shape': {shape!r}, }}".encode()
    header += b" " * (-(len(header) + 11) % 64) + b"\n"
    return b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header + contents


class Bomb:
    """An object whose unpickling would be noticed."""

    def __reduce__(self):
        return (pytest.fail, ("a pickle was loaded",))


WRONG_FIELDS = [
    ("odometry", np.full((5, 3), np.nan), "odometry: expected finite numbers, got 15 NaN or infinite"),
    ("odometry", np.zeros((5, 2)), "odometry: expected shape (any, 3), got (5, 2)"),
    ("odometry", np.full((5, 3), "x"), "odometry: expected real numbers, got dtype <U1"),
    ("odometry", np.zeros((5, 3), complex), "odometry: expected real numbers, got dtype complex128"),
    ("odometry", np.zeros((5, 3), "f8,f8"), "odometry: expected real numbers, got dtype [("),
    ("obs_xy", np.zeros((7, 2)), "obs_xy: expected shape (8, 2), got (7, 2)"),
    ("obs_time", np.full(8, 6), "obs_time: expected the index of a pose from 0 to 5, got 6 at entry 0"),
    ("obs_time", np.full(8, -1), "obs_time: expected the index of a pose from 0 to 5, got -1"),
    ("obs_time", np.zeros(8), "obs_time: expected integers, got dtype float64"),
    ("obs_class", np.full(8, 2), "obs_class: expected a class index from 0 to 1, got 2 at entry 0"),
    ("num_classes", np.array([2]), "num_classes: expected shape (), got (1,)"),
    ("num_classes", np.array(2.5), "num_classes: expected a positive integer, got 2.5"),
    ("num_classes", np.array(np.nan), "num_classes: expected finite numbers"),
    ("num_classes", np.array(10**12), "num_classes: expected at most 10000, got 1e+12"),
    ("num_classes", np.array("two"), "num_classes: expected real numbers, got dtype <U3"),
    ("odometry_std", np.zeros(3), "odometry_std: expected positive numbers, got [0.0, 0.0, 0.0]"),
    ("true_poses", np.zeros((5, 3)), "true_poses: expected shape (6, 3), got (5, 3)"),
    ("true_object", np.zeros(7, int), "true_object: expected shape (8), got (7,)"),
    (
        "true_object",
        np.full(8, 3),
        "true_object: obs_object: expected an object index (-1 = clutter, -2 = unknown) from -2 to 2, got 3",
    ),
    ("object_xy", np.zeros((3, 3)), "object_xy: expected shape (any, 2), got (3, 3)"),
    ("object_class", np.full(3, 2), "object_class: expected a class index from 0 to 1, got 2"),
    ("class_names", np.array(["a"]), "class_names: expected text of shape (2,), got <U1 of shape (1,)"),
    ("class_names", np.array([1, 2]), "class_names: expected text of shape (2,), got int64 of shape (2,)"),
    (
        "class_names",
        np.array([b"a", b"b"]),
        "class_names: expected text of shape (2,), got |S1 of shape (2,)",
    ),
    (
        "odometry",
        np.array([Bomb()] * 5),
        "odometry: expected plain numbers or text, got pickled Python objects",
    ),
    (
        "class_names",
        np.array([Bomb()] * 2),
        "class_names: expected plain numbers or text, got pickled Python obj",
    ),
]


@pytest.mark.parametrize(("field", "value", "words"), WRONG_FIELDS, ids=range(len(WRONG_FIELDS)))
def test_a_wrong_field_is_named(tmp_path, run, field, value, words):
    path = tmp_path / "run.npz"
    np.savez(path, allow_pickle=True, **fields_of(*run) | {field: value})
    assert words in message_of(path)


@pytest.mark.parametrize("field", LOG_FIELDS)
def test_a_missing_field_is_named(tmp_path, run, field):
    fields = fields_of(*run)
    del fields[field]
    np.savez(tmp_path / "run.npz", **fields)
    assert message_of(tmp_path / "run.npz").endswith(f"missing {field}")


WRONG_HEADERS = [
    (claiming((10**12, 3)), "expected an array of the 48 bytes in the file, got "),
    (claiming((2**62, 2**62, 2**62)), "expected an array of the 48 bytes in the file"),
    (claiming((-2, -3)), "expected an array of the 48 bytes in the file"),
    (claiming((10**12,), "<U0", b""), "expected an array of the 0 bytes in the file"),
    (claiming((2, 3), contents=b"\0" * 40), "expected an array of the 40 bytes in the file"),
    (claiming((2, 3), contents=b"\0" * 56), "expected an array of the 56 bytes in the file"),
    (claiming((2, 3), "<q9"), "expected an array in NumPy's format"),
    (claiming((2, 3), "|O"), "expected plain numbers or text, got pickled Python objects"),
    (claiming("x"), "expected an array in NumPy's format"),
    (b"\x93NUMPY\x09\x00" + b"\0" * 64, "expected an array in NumPy's format"),
    (b"\x93NUMPY\x01\x00\x05\x00((((\n", "expected an array in NumPy's format"),
    (b"not an array", "expected an array in NumPy's format"),
    (b"", "expected an array in NumPy's format"),
]


@pytest.mark.parametrize(("contents", "words"), WRONG_HEADERS, ids=range(len(WRONG_HEADERS)))
def test_a_header_is_not_believed(tmp_path, run, contents, words):
    path = tmp_path / "run.npz"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, value in fields_of(run[0]).items():
            archive.writestr(name + ".npy", contents if name == "odometry" else npy(value))
    assert message_of(path).startswith(f"{path}: odometry: {words}")


def test_a_directory_entry_that_claims_a_terabyte_is_not_believed(tmp_path, run):
    path = tmp_path / "run.npz"
    np.savez_compressed(path, **fields_of(run[0]))
    contents = bytearray(path.read_bytes())
    entry = contents.index(b"PK\x01\x02")  # the first entry of the central directory: the size after unpacking
    contents[entry + 24 : entry + 28] = (2**32 - 2).to_bytes(4, "little")
    path.write_bytes(contents)
    assert "odometry: expected at most 67108864 bytes, got 4294967294" in message_of(path)


@pytest.mark.parametrize("method", [zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA])
def test_an_entry_compressed_in_another_way_than_numpys_is_refused(tmp_path, run, method):
    path = tmp_path / "run.npz"
    with zipfile.ZipFile(path, "w", method) as archive:
        for name, value in fields_of(run[0]).items():
            archive.writestr(name + ".npy", npy(value))
    assert f"odometry: expected an entry stored or deflated, got method {method} of zip" in message_of(path)


def test_a_bomb_is_refused_before_it_is_unpacked(tmp_path, run):
    path = tmp_path / "run.npz"
    np.savez_compressed(path, **fields_of(run[0]) | {"odometry": np.zeros((3_000_000, 3))})
    assert message_of(path).endswith("odometry: expected at most 67108864 bytes, got 72000128")


@pytest.mark.parametrize("moves", [1.0, 0.0])
def test_neither_a_long_walk_nor_a_long_rest_is_a_bomb(tmp_path, moves):
    rng, count = np.random.default_rng(0), 60_000
    log = types.RobotLog(
        moves * rng.normal(0, [1.0, 1.0, 0.5], (count, 3)), [], np.zeros((0, 2)), [], 1, [1.0] * 3, [1.0] * 2
    )
    np.savez_compressed(tmp_path / "run.npz", **fields_of(log))
    np.testing.assert_array_equal(datasets.load_log(tmp_path / "run.npz")[0].odometry, log.odometry)


def test_headers_by_python_2_are_read_without_a_word(tmp_path, run):
    old = npy(run[0].odometry).replace(b"(5, 3), ", b"(5L, 3),")
    with zipfile.ZipFile(tmp_path / "run.npz", "w") as archive:
        for name, value in fields_of(run[0]).items():
            archive.writestr(name + ".npy", old if name == "odometry" else npy(value))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        log, _ = datasets.load_log(tmp_path / "run.npz")
    np.testing.assert_array_equal(log.odometry, run[0].odometry)


@pytest.mark.parametrize("name", ["run.npz", "run.mat", "run.g2o"])
def test_a_file_larger_than_any_log_is_not_read(tmp_path, monkeypatch, name):
    path = tmp_path / name
    with path.open("wb") as stream:
        stream.truncate(1 << 40)  # takes no room on the disk
    monkeypatch.setattr("pathlib.Path.read_bytes", lambda self: pytest.fail("read it"))
    load = datasets.load_g2o if name.endswith("g2o") else datasets.load_log
    assert "expected at most 134217728 bytes, got 1099511627776" in message_of(path, load)


def encrypted(contents):
    """Set the flag that says that an entry is encrypted, in both of its headers."""
    contents = bytearray(contents)
    contents[6] |= 1
    contents[contents.index(b"PK\x01\x02") + 8] |= 1
    return bytes(contents)


def test_an_entry_that_cannot_be_read_is_named(tmp_path, run):
    path = tmp_path / "run.npz"
    np.savez(path, **fields_of(run[0]))
    contents = path.read_bytes()
    path.write_bytes(encrypted(contents))
    assert "odometry: expected an intact entry, got " in message_of(path)
    position = contents.index(run[0].odometry.tobytes())
    path.write_bytes(contents[:position] + b"\xff" + contents[position + 1 :])
    assert "odometry: expected an intact entry, got " in message_of(path)


# ---- files that are something else ----


@pytest.mark.parametrize("suffix", [".npz", ".mat"])
def test_no_file_an_empty_file_and_a_folder(tmp_path, suffix):
    path = tmp_path / f"run{suffix}"
    assert "expected a file, found nothing" in message_of(path, error=FileNotFoundError)
    path.touch()
    assert "expected a file with contents, got an empty one" in message_of(path)
    path.unlink()
    path.mkdir()
    assert "expected a file, got a folder" in message_of(path)


@pytest.mark.parametrize("name", ["run.txt", "run", "run.npz.gz", "run.npy", ".npz"])
def test_another_suffix_is_an_error(tmp_path, run, name):
    (tmp_path / name).write_bytes(b"1 2 3")
    assert "expected a file name that ends in .npz, .csv or .mat, or a folder" in message_of(tmp_path / name)
    with pytest.raises(ValueError, match=r"expected a file name that ends in \.npz or \.csv, got"):
        datasets.save_log(tmp_path / name, run[0])
    assert (tmp_path / name).read_bytes() == b"1 2 3"


def test_a_file_that_may_not_be_read(tmp_path, run, monkeypatch):
    path = tmp_path / "run.npz"
    datasets.save_log(path, run[0])

    def refuse(self):
        raise PermissionError(13, "Permission denied", str(self))

    monkeypatch.setattr("pathlib.Path.read_bytes", refuse)
    assert "expected a readable file, got permission denied" in message_of(path)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes on this system")
def test_a_pipe_is_refused_and_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "run.npz")
    assert "expected a file, got a device or pipe" in message_of(tmp_path / "run.npz")


NOT_MAT = [
    (b"this is no MATLAB file at all", "expected a MATLAB Level 5 .mat file, got something else"),
    (b"\0" * 1000, "expected a MATLAB Level 5 .mat file, got something else"),
    (
        b"MATLAB 7.3 MAT-file".ljust(512) + b"\x89HDF\r\n\x1a\n",
        "got version 7.3 (HDF5), to be saved again with -v7",
    ),
    (b"\x89HDF\r\n\x1a\n".ljust(600, b"\0"), "got version 7.3 (HDF5), to be saved again with -v7"),
]


@pytest.mark.parametrize(("contents", "words"), NOT_MAT, ids=range(len(NOT_MAT)))
def test_a_mat_file_that_is_none(tmp_path, contents, words):
    (tmp_path / "run.mat").write_bytes(contents)
    assert words in message_of(tmp_path / "run.mat")


def test_a_npz_file_that_is_none(tmp_path):
    (tmp_path / "run.npz").write_bytes(b"this is no zip archive at all")
    assert "expected a .npz archive (zip), got 'BadZipFile: File is not a zip file'" in message_of(tmp_path / "run.npz")


# ---- writing ----


def test_a_failed_save_leaves_the_old_file_and_nothing_else(tmp_path, run, monkeypatch):
    path = tmp_path / "run.npz"
    path.write_bytes(b"old")

    def fail(stream, **fields):
        stream.write(b"half of it")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(np, "savez", fail)
    with pytest.raises(ValueError, match=r"run\.npz: expected a place to write, got no space left on device"):
        datasets.save_log(path, run[0])
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]


def test_a_truth_of_another_run_is_not_saved(tmp_path, run):
    _, other = small_run(np.random.default_rng(1), num_poses=7)
    with pytest.raises(ValueError, match=r"run\.npz: true_poses: expected shape \(6, 3\), got \(7, 3\)"):
        datasets.save_log(tmp_path / "run.npz", run[0], other)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(("mode", "contents"), [("w", "größe\n"), ("wb", b"\x00\r\n")])
def test_atomic_write_appears_only_when_done(tmp_path, mode, contents):
    path = tmp_path / "file"
    with files.atomic_write(path, mode) as stream:
        stream.write(contents)
        assert not path.exists()
    assert path.read_bytes() == (contents.encode() if mode == "w" else contents)
    assert list(tmp_path.iterdir()) == [path]


def test_atomic_write_passes_on_what_the_body_raises(tmp_path):
    for error in (KeyError("x"), FileNotFoundError(2, "No such file", "something else"), KeyboardInterrupt()):
        with pytest.raises(type(error)) as caught, files.atomic_write(tmp_path / "file", "w") as stream:
            stream.write("half")
            raise error
        assert caught.value is error
        assert not list(tmp_path.iterdir())


def test_atomic_write_refuses_what_it_cannot_replace(tmp_path):
    with pytest.raises(FileNotFoundError, match="expected a folder to write into"):
        with files.atomic_write(tmp_path / "no" / "file", "w"):
            pytest.fail("opened")
    with pytest.raises(ValueError, match="expected the name of a file to write, got a folder"):
        with files.atomic_write(tmp_path, "w"):
            pytest.fail("opened")
    with pytest.raises(ValueError, match="mode: expected 'w' or 'wb', got 'a'"):
        with files.atomic_write(tmp_path / "file", "a"):
            pytest.fail("opened")
    assert not list(tmp_path.iterdir())


@pytest.mark.skipif(os.name != "posix", reason="devices and links as on Unix")
def test_atomic_write_keeps_links_and_devices_and_permissions(tmp_path):
    (tmp_path / "file").write_text("old")
    (tmp_path / "link").symlink_to("file")
    with files.atomic_write(tmp_path / "link", "w") as stream:
        stream.write("new")
    assert (tmp_path / "link").is_symlink() and (tmp_path / "file").read_text() == "new"
    (tmp_path / "plain").touch()
    assert (tmp_path / "file").stat().st_mode == (tmp_path / "plain").stat().st_mode
    with pytest.raises(ValueError, match="expected the name of a file to write, got a device"):
        with files.atomic_write("/dev/null", "w"):
            pytest.fail("opened")


# ---- the authors' simulation ----


@pytest.mark.parametrize("do_compression", [False, True])
@pytest.mark.parametrize("seed", range(3))
def test_simulation_file_without_noise_leaves_no_residual(tmp_path, seed, do_compression):
    run = small_run(np.random.default_rng(seed))
    path = tmp_path / "run.mat"
    scipy.io.savemat(path, simulation_variables(*run), do_compression=do_compression)
    log, truth = datasets.load_mu2016_simulation(path)
    for residual in residuals_at_truth(log, truth):
        assert np.abs(residual).max() < 1e-12
    np.testing.assert_array_equal(log.obs_class, run[0].obs_class)
    np.testing.assert_array_equal(truth.obs_object, run[1].obs_object)
    np.testing.assert_allclose(truth.poses, run[1].poses, rtol=0, atol=1e-12)
    assert_same_run((log, truth), datasets.load_log(path))


@pytest.mark.parametrize("count", [0, 1])
def test_simulation_file_with_hardly_an_observation(tmp_path, count):
    # MATLAB has no vectors: what is left of one must not be mistaken for another shape.
    run = small_run(np.random.default_rng(0), num_poses=2, num_objects=1, num_observations=count)
    scipy.io.savemat(tmp_path / "run.mat", simulation_variables(*run))
    log, _ = datasets.load_log(tmp_path / "run.mat")
    np.testing.assert_array_equal(log.obs_xy, run[0].obs_xy)


def test_simulation_original(mu2016_path):
    log, truth = datasets.load_mu2016_simulation(mu2016_path)
    assert (log.num_poses, log.num_observations, log.num_classes) == (766, 1098, 5)
    assert len(truth.world.object_xy) == 15
    np.testing.assert_array_equal(np.unique(log.obs_class), range(5))
    np.testing.assert_array_equal(log.obs_class, truth.world.object_class[truth.obs_object])
    odometry, seen = residuals_at_truth(log, truth)
    # A wrong sign or a step too many makes these several times as large. The bounds are four standard errors.
    assert odometry.std(axis=0) == pytest.approx(log.odometry_std, rel=4 / np.sqrt(2 * 765))
    assert seen.std(axis=0) == pytest.approx(log.observation_std, rel=4 / np.sqrt(2 * 1098))
    chi2 = ((odometry / log.odometry_std) ** 2).sum() + ((seen / log.observation_std) ** 2).sum()
    degrees = 3 * 765 + 2 * 1098
    assert abs(chi2 - degrees) < 3 * np.sqrt(2 * degrees)
    assert np.abs(odometry.mean(axis=0)).max() < 4 * 0.01 / np.sqrt(765)
    assert np.abs(seen.mean(axis=0)).max() < 4 * 0.1 / np.sqrt(1098)


# Variable, field ("" for the variable itself), new value (None to remove it), and how the sentence begins.
WRONG_VARIABLES = [
    ("lm_edge", "", None, "expected the variables node_edge, lm_edge, truth_traj, "),
    ("lm_edge", "id2", None, "lm_edge: expected the fields id1, id2, dpos, label, missing id2"),
    ("node_edge", "dtheta", None, "node_edge: expected the fields dpos, dtheta, missing dtheta"),
    ("lm_edge", "", 3.0, "lm_edge: expected structures, got numbers of shape (1, 1)"),
    ("lm_edge", "", "text", "lm_edge: expected real numbers or a structure, got text"),
    ("truth_traj", "", np.zeros((6, 3), object), "truth_traj: expected real numbers or a str"),
    ("truth_traj", "", np.zeros((6, 3), complex), "truth_traj: expected real numbers or a str"),
    ("truth_traj", "", {"a": 1}, "truth_traj: expected real numbers, got dtype object"),
    ("truth_traj", "", np.zeros((0, 3)), "truth_traj: expected at least one pose, got none"),
    ("truth_traj", "", np.zeros((7, 3)), "node_edge.dpos: expected shape (2, 7), got (2, 6)"),
    ("truth_traj", "", np.full((6, 3), np.nan), "truth_traj: expected finite numbers, got 18 NaN"),
    ("truth_objects", "", np.zeros((3, 2)), "truth_objects: expected shape (any, 3), got (3, 2)"),
    ("truth_objects", "", np.full((3, 3), 0.5), "truth_objects(:, 3): expected whole numbers from 0 to 9999"),
    ("node_edge", "dtheta", np.zeros(5), "node_edge.dtheta: expected shape (6), got (5,)"),
    ("lm_edge", "id1", np.full(8, 6), "lm_edge.id1: expected whole numbers from 0 to 5, got 6 at entry 1"),
    ("lm_edge", "id2", np.zeros(8), "lm_edge.id2: expected whole numbers from 1 to 3, got 0 at entry 1"),
    ("lm_edge", "id2", np.full(8, 4), "lm_edge.id2: expected whole numbers from 1 to 3, got 4 at entry 1"),
    ("lm_edge", "label", np.zeros(8), "lm_edge.label: expected whole numbers from 1 to 10000, got 0"),
    ("lm_edge", "label", np.full(8, 1e14), "lm_edge.label: expected whole numbers from 1 to 10000"),
    ("lm_edge", "label", np.ones(7), "lm_edge.label: expected shape (8), got (7,)"),
    ("lm_edge", "dpos", np.zeros((3, 8)), "lm_edge.dpos: expected shape (2, any), got (3, 8)"),
    ("lm_edge", "dpos", {"x": 1}, "lm_edge.dpos: expected real numbers, got dtype object"),
]


@pytest.mark.parametrize(("name", "field", "value", "words"), WRONG_VARIABLES, ids=range(len(WRONG_VARIABLES)))
def test_a_wrong_variable_is_named(tmp_path, run, name, field, value, words):
    variables = simulation_variables(*run)
    place = variables[name] if field else variables
    place[field or name] = value
    if value is None:
        del place[field or name]
    scipy.io.savemat(tmp_path / "run.mat", variables)
    for load in (datasets.load_log, datasets.load_mu2016_simulation):
        assert message_of(tmp_path / "run.mat", load).startswith(f"{tmp_path / 'run.mat'}: {words}")


def test_a_mat_file_with_other_variables(tmp_path):
    scipy.io.savemat(tmp_path / "run.mat", {"x": 1, "note": "text", "c": np.array(["a", 1], object)})
    assert "(simulation) or stata_frames (office), got none of them" in message_of(tmp_path / "run.mat")
    for load in (datasets.load_mu2016_simulation, datasets.load_stata_office):
        assert "expected the variable" in message_of(tmp_path / "run.mat", load)


# ---- the office ----


@pytest.mark.parametrize("seed", range(3))
def test_office_file_becomes_the_run_it_was_made_of(tmp_path, seed):
    run = small_run(np.random.default_rng(seed))
    scipy.io.savemat(tmp_path / "run.mat", office_variables(*run))
    log = datasets.load_stata_office(tmp_path / "run.mat")
    np.testing.assert_allclose(log.odometry, run[0].odometry, rtol=0, atol=1e-12)
    order = np.argsort(run[0].obs_time, kind="stable")  # frames list what was seen in the order of time
    np.testing.assert_array_equal(log.obs_time, run[0].obs_time[order])
    np.testing.assert_allclose(log.obs_xy, run[0].obs_xy[order], rtol=0, atol=1e-12)
    np.testing.assert_array_equal(log.obs_class, 1 - run[0].obs_class[order])  # class 0 had the larger id, 17
    assert_same_run((log, None), datasets.load_log(tmp_path / "run.mat"))


def test_office_original(stata_path):
    log, truth = datasets.load_log(stata_path)
    assert truth is None
    assert (log.num_poses, log.num_observations) == (696, 1591)
    assert np.bincount(log.obs_class).tolist() == [75, 201, 99, 69, 291, 172, 681, 3]
    assert (log.obs_xy[:, 0] > 0).all()  # what a camera sees is in front of it
    assert np.hypot(*log.odometry[:, :2].T).sum() == pytest.approx(27.3, abs=0.1)
    turns = np.abs(log.odometry[:, 2])
    np.testing.assert_array_equal(np.flatnonzero(turns > 0.12), [264, 580])
    # The projection is rigid: chaining the steps gives back the camera's own path.
    frames = scipy.io.loadmat(stata_path, squeeze_me=True)["stata_frames"]
    camera = np.array([pose.astype(float) for pose in frames["T"]])
    path = np.column_stack([camera[:, 2, 3], -camera[:, 0, 3]])
    np.testing.assert_allclose(se2.dead_reckoning(log.odometry)[:, :2], path, rtol=0, atol=1e-9)
    # What is seen twice in a row stays where it is; with a mirrored axis it would run away.
    steps = np.flatnonzero(np.bincount(log.obs_time, minlength=696) == 1)
    one = np.flatnonzero(np.isin(log.obs_time, steps))
    two = [(a, b) for a, b in zip(one, one[1:], strict=False) if log.obs_time[b] - log.obs_time[a] == 1]
    xy = se2.apply(se2.dead_reckoning(log.odometry)[log.obs_time], log.obs_xy)
    moved = [np.hypot(*(xy[b] - xy[a])) for a, b in two if log.obs_class[a] == log.obs_class[b]]
    assert len(moved) > 30 and np.median(moved) < 0.1


OFFICE_WRONG = [
    ("T", np.eye(3), "T: expected shape (4, 4), got (3, 3)"),
    ("T", 2 * np.eye(4), "T: expected a rotation, got a matrix off by 3"),
    ("T", np.full((4, 4), np.nan), "T: expected finite numbers, got 16"),
    ("objects", 1.0, "objects: expected structures, got numbers"),
    ("objects", {"label": 1}, "objects: expected the fields T, label, missing T"),
    ("objects", {"label": 0.5, "T": np.eye(4)}, "objects(1).label: expected whole"),
    ("objects", {"label": [1, 2], "T": np.eye(4)}, "objects(1).label: expected shape (1)"),
    ("objects", {"label": 1, "T": [1, 2]}, "objects(1).T: expected shape (4, 4)"),
]


@pytest.mark.parametrize(("field", "value", "words"), OFFICE_WRONG, ids=range(len(OFFICE_WRONG)))
def test_a_wrong_frame_is_named(tmp_path, run, field, value, words):
    variables = office_variables(*run)
    variables["stata_frames"][0, 1][field] = value
    scipy.io.savemat(tmp_path / "run.mat", variables)
    assert message_of(tmp_path / "run.mat").startswith(f"{tmp_path / 'run.mat'}: stata_frames(2).{words}")


def test_an_office_without_frames_or_fields(tmp_path):
    scipy.io.savemat(tmp_path / "run.mat", {"stata_frames": np.zeros((0, 0))})
    assert "stata_frames: expected at least one frame, got none" in message_of(tmp_path / "run.mat")
    scipy.io.savemat(tmp_path / "run.mat", {"stata_frames": {"T": np.eye(4)}})
    assert "stata_frames: expected the fields T, objects, missing objects" in message_of(tmp_path / "run.mat")


# ---- damage ----


def write_npz(path, run, compressed):
    (np.savez_compressed if compressed else np.savez)(path, **fields_of(*run))


def write_simulation(path, run, compressed):
    scipy.io.savemat(path, simulation_variables(*run), do_compression=compressed)


def write_office(path, run, compressed):
    scipy.io.savemat(path, office_variables(*run), do_compression=compressed)


@pytest.mark.parametrize("compressed", [False, True])
@pytest.mark.parametrize(("write", "suffix"), [(write_npz, ".npz"), (write_simulation, ".mat"), (write_office, ".mat")])
def test_a_damaged_file_ends_in_one_sentence_or_a_log(tmp_path, run, damaged, write, suffix, compressed):
    path = tmp_path / f"run{suffix}"
    write(path, run, compressed)
    original, rng = path.read_bytes(), np.random.default_rng(0)
    refused = 0
    for _ in range(400):
        path.write_bytes(damaged(original, rng))
        try:
            log, _ = datasets.load_log(path)
            assert isinstance(log, types.RobotLog)
        except ValueError as error:
            assert str(error).startswith(f"{path}: ") and "\n" not in str(error) and ": expected " in str(error)
            refused += 1
    assert refused > 100


@pytest.mark.parametrize("name", ["mu2016_simulation.mat", "mu2016_stata_office.mat"])
def test_an_original_that_is_cut_short_or_damaged(data_folder, tmp_path, damaged, name):
    original, rng = (data_folder / name).read_bytes(), np.random.default_rng(0)
    path = tmp_path / name
    for size in (1, 50, 127, 128, 130, 136, 1000, len(original) // 2, len(original) - 1):
        path.write_bytes(original[:size])
        assert ": expected " in message_of(path)
    for _ in range(60):
        path.write_bytes(original[:128] + damaged(original[128:], rng))
        assert ": expected " in message_of(path)


def rested_log(**fields):
    """A drive of five steps, of which nothing is seen from the last pose."""
    odometry = np.tile([1.0, 0.0, 0.5], (5, 1))
    seen = {"obs_time": np.arange(5), "obs_xy": np.ones((5, 2)), "obs_class": np.zeros(5, int)}
    noise = {"odometry_std": np.full(3, 0.1), "observation_std": np.full(2, 0.1)}
    return {"odometry": odometry, "num_classes": np.array(1)} | seen | noise | fields


STILL = np.zeros((1, 3))


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({}, None),
        ({"odometry": np.tile([1.0, 0.0, -3.2], (5, 1))}, "step 0 of odometry turns by 3.2, more than half a turn"),
        ({"odometry": np.tile([1.0, 0.0, 3.1], (5, 1))}, None),
        ({"odometry": np.vstack([STILL, rested_log()["odometry"]])}, "the first step of odometry is zero"),
        ({"odometry": np.vstack([rested_log()["odometry"], STILL])}, "the last step of odometry is zero"),
        ({"odometry": np.zeros((5, 3))}, None),  # a robot may rest
        ({"odometry": np.vstack([STILL, rested_log()["odometry"][:4]]), "obs_time": np.arange(1, 6)}, None),
    ],
)
def test_what_is_more_often_a_mistake_is_said(tmp_path, recwarn, fields, words):
    np.savez(tmp_path / "run.npz", **rested_log(**fields))
    datasets.load_log(tmp_path / "run.npz")
    said = [str(warning.message) for warning in recwarn]
    assert len(said) == (words is not None) and all(words in text and "run.npz: " in text for text in said)


def test_one_row_of_odometry_too_many_and_classes_as_real_numbers_get_a_hint(tmp_path):
    np.savez(tmp_path / "run.npz", **rested_log(true_poses=np.zeros((5, 3))))
    with pytest.raises(ValueError, match=r"\(6, 3\), got \(5, 3\): one pose more than steps of odometry; has that one"):
        datasets.load_log(tmp_path / "run.npz")
    for wrong, hint in ((np.zeros(5), True), (np.full(5, 0.5), False), (np.full(5, np.nan), False)):
        np.savez(tmp_path / "run.npz", **rested_log(obs_class=wrong))
        with pytest.raises(ValueError, match="obs_class: expected integers, got dtype float64") as said:
            datasets.load_log(tmp_path / "run.npz")
        assert (".astype(int) will do" in str(said.value)) == hint
