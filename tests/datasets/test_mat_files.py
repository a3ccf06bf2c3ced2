"""The .mat reader against SciPy's on intact files, and its own limits."""

import zlib

import numpy as np
import pytest
import scipy.io

from npslam_teach.datasets.mat_files import read_mat


def assert_same_as_scipy(value, other):
    if isinstance(value, list):
        others = np.ravel(other, order="F")
        assert len(value) == len(others)
        for structure, other_structure in zip(value, others, strict=True):
            assert list(structure) == list(other.dtype.names)
            for field, entry in structure.items():
                assert_same_as_scipy(entry, other_structure[field])
    else:
        assert value.dtype == np.float64
        assert value.shape == other.shape
        np.testing.assert_array_equal(value, other)


@pytest.mark.parametrize("do_compression", [False, True])
def test_mat_reader_agrees_with_scipy(tmp_path, do_compression):
    rng = np.random.default_rng(0)
    variables = {f"n_{t}": (rng.normal(size=(3, 5)) * 100).astype(t) for t in "i1 u1 i2 u2 i4 u4 f4 i8 u8 f8".split()}
    variables |= {
        "cube": rng.normal(size=(2, 3, 4)),
        "empty": np.zeros((0, 3)),
        "yes": np.array([[True, False]]),
    }
    variables["nested"] = {"a": {"b": {"c": np.arange(3.0)}}, "long_name_of_a_field": 7}
    structures = np.empty((2, 3), [("p", "O"), ("q", "O")])
    for k in range(6):
        structures[k // 3, k % 3] = (k, np.full((k, k), float(k)))
    variables["structures"] = structures
    scipy.io.savemat(tmp_path / "v.mat", variables, do_compression=do_compression)
    ours, theirs = read_mat(tmp_path / "v.mat", set(variables)), scipy.io.loadmat(tmp_path / "v.mat")
    assert set(ours) == set(variables)
    for name in variables:
        assert_same_as_scipy(ours[name], theirs[name])


def test_mat_reader_agrees_with_scipy_on_the_originals(mu2016_path, stata_path):
    for path in (mu2016_path, stata_path):
        theirs = {name: value for name, value in scipy.io.loadmat(path).items() if not name.startswith("__")}
        for name, value in read_mat(path, set(theirs)).items():
            assert_same_as_scipy(value, theirs.pop(name))
        assert not theirs


def test_mat_reader_knows_the_other_byte_order(tmp_path):
    def element(kind, contents):
        return np.array([kind, len(contents)], ">u4").tobytes() + contents + b"\0" * (-len(contents) % 8)

    flags, shape = np.array([6, 0], ">u4").tobytes(), np.array([1, 2], ">i4").tobytes()
    numbers = np.array([1.5, -2.0], ">f8").tobytes()
    matrix = element(14, element(6, flags) + element(5, shape) + element(1, b"x") + element(9, numbers))
    (tmp_path / "v.mat").write_bytes(b"big endian".ljust(124) + b"\x01\x00MI" + matrix)
    np.testing.assert_array_equal(read_mat(tmp_path / "v.mat", {"x"})["x"], [[1.5, -2.0]])


def test_a_mat_file_that_unpacks_to_too_much_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr("npslam_teach.datasets.mat_files._MAX_BYTES", 1 << 20)
    contents = zlib.compress(b"\0" * (1 << 21))
    header = b"MATLAB 5.0".ljust(124) + b"\x00\x01IM"
    (tmp_path / "run.mat").write_bytes(header + np.array([15, len(contents)], "<u4").tobytes() + contents)
    with pytest.raises(ValueError, match=r"run\.mat: expected an intact .mat file, got too much data"):
        read_mat(tmp_path / "run.mat", {"node_edge"})


def test_a_mat_file_nested_too_deeply_is_refused(tmp_path):
    value = 1.0
    for _ in range(12):
        value = {"a": value}
    scipy.io.savemat(tmp_path / "run.mat", {"node_edge": value})
    with pytest.raises(ValueError, match="node_edge: expected real numbers or a structure, got too deep"):
        read_mat(tmp_path / "run.mat", {"node_edge"})


def test_a_mat_file_of_too_many_numbers_is_refused(tmp_path):
    """A byte of the file is eight bytes of memory once it has become a number."""
    scipy.io.savemat(tmp_path / "run.mat", {"truth_traj": np.zeros((400_000, 3), np.uint8)}, do_compression=True)
    with pytest.raises(ValueError, match=r"run\.mat: truth_traj: expected an intact .mat file, got too much data"):
        read_mat(tmp_path / "run.mat", {"truth_traj"})


def test_a_mat_file_of_too_many_structures_is_refused(tmp_path):
    frames = np.zeros((1, 100_001), [("T", "O")])
    frames["T"] = 0
    scipy.io.savemat(tmp_path / "run.mat", {"stata_frames": frames})
    with pytest.raises(ValueError, match=r"run\.mat: stata_frames: expected at most 100000 structures, got 100001"):
        read_mat(tmp_path / "run.mat", {"stata_frames"})
