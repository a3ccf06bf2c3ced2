"""Pose graphs in and out: exact round trips, a line number for every mistake, nothing dropped silently."""

import gzip
import time
from dataclasses import replace

import numpy as np
import pytest

from npslam_teach import types
from npslam_teach.datasets import load_g2o, save_g2o
from npslam_teach.pose_graph import optimize

SMALL = """\
# two poses see one tree
VERTEX_SE2 4 0 0 0
VERTEX_SE2 7 1.5 0.25 -0.5

VERTEX_XY 5 2 1   # the tree
EDGE_SE2 4 7 1 0 0.1 4 0.5 0.25 5 0.125 6
EDGE_SE2_XY 7 5 1 2 3 0.5 4
"""


def write(folder, text, name="graph.g2o"):
    path = folder / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def random_information(rng, count, size):
    root = rng.normal(size=(count, size, size))
    information = root @ root.swapaxes(1, 2)
    return (information + information.swapaxes(1, 2)) / 2  # the product is symmetric only up to rounding


def random_graph(rng, num_poses=20, num_landmarks=5, num_edges=40, num_seen=30):
    i = rng.integers(num_poses, size=num_edges)
    j = (i + rng.integers(1, num_poses, size=num_edges)) % num_poses
    relative_pose = rng.normal(size=(num_edges, 3)) * 10.0 ** rng.integers(-12, 12, size=(num_edges, 1))
    between = types.BetweenFactors(i, j, relative_pose, random_information(rng, num_edges, 3))
    pose, landmark = rng.integers(num_poses, size=num_seen), rng.integers(num_landmarks, size=num_seen)
    information = random_information(rng, num_seen, 2)
    seen = types.ObservationFactors(pose, landmark, rng.normal(size=(num_seen, 2)), information)
    return types.PoseGraph(rng.normal(size=(num_poses, 3)), rng.normal(size=(num_landmarks, 2)), between, seen)


def arrays_of(graph):
    between, seen = graph.between, graph.observations
    return {
        "poses": graph.poses,
        "landmarks": graph.landmarks,
        **{"between." + name: getattr(between, name) for name in ("i", "j", "relative_pose", "information")},
        **{"seen." + name: getattr(seen, name) for name in ("pose", "landmark", "xy", "information")},
    }


def assert_equal(graph, other):
    """Bit for bit, but for the information of poses, which is turned on the way in and back on the way out."""
    others = arrays_of(other)
    for name, value in arrays_of(graph).items():
        if name == "between.information":
            scale = np.abs(value).max(axis=(1, 2), keepdims=True)
            np.testing.assert_allclose(value / scale, others[name] / scale, rtol=0, atol=1e-14, err_msg=name)
        else:
            np.testing.assert_array_equal(value, others[name], err_msg=name)


def chi2(graph):
    """From the formulas, in complex numbers: nothing of the library is used."""
    xy, turn = graph.poses[:, :2] @ [1, 1j], np.exp(1j * graph.poses[:, 2])
    i, j, relative = graph.between.i, graph.between.j, graph.between.relative_pose
    step = (xy[j] - xy[i]) / turn[i] - relative[:, :2] @ [1, 1j]
    residual = np.stack([step.real, step.imag, np.angle(turn[j] / turn[i] * np.exp(-1j * relative[:, 2]))], 1)
    total = np.einsum("ei,eij,ej", residual, graph.between.information, residual)
    seen = graph.observations
    offset = (graph.landmarks[seen.landmark] @ [1, 1j] - xy[seen.pose]) / turn[seen.pose] - seen.xy @ [1, 1j]
    residual = np.stack([offset.real, offset.imag], 1)
    return total + np.einsum("ei,eij,ej", residual, seen.information, residual)


def test_small_file_number_by_number(tmp_path):
    graph = load_g2o(write(tmp_path, SMALL))
    np.testing.assert_array_equal(graph.poses, [[0, 0, 0], [1.5, 0.25, -0.5]])
    np.testing.assert_array_equal(graph.landmarks, [[2, 1]])
    assert (graph.between.i, graph.between.j) == (0, 1)
    np.testing.assert_array_equal(graph.between.relative_pose, [[1, 0, 0.1]])
    c, s = np.cos(0.1), np.sin(0.1)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    in_frame_of_j = np.array([[4, 0.5, 0.25], [0.5, 5, 0.125], [0.25, 0.125, 6]])
    np.testing.assert_allclose(graph.between.information[0], turn @ in_frame_of_j @ turn.T, atol=1e-15)
    assert (graph.observations.pose, graph.observations.landmark) == (1, 0)
    np.testing.assert_array_equal(graph.observations.xy, [[1, 2]])
    np.testing.assert_array_equal(graph.observations.information, [[[3, 0.5], [0.5, 4]]])


def chi2_as_g2o_defines_it(text):
    """Straight from the lines: the error is ``measured^-1 * (x_i^-1 * x_j)``, in homogeneous matrices."""

    def matrix(x, y, theta):
        return np.array([[np.cos(theta), -np.sin(theta), x], [np.sin(theta), np.cos(theta), y], [0, 0, 1]])

    vertices, total = {}, 0.0
    for line in text.splitlines():
        if not (words := line.split("#")[0].split()):
            continue
        tag, *fields = words
        values = np.array(fields, float)
        if tag.startswith("VERTEX"):
            vertices[fields[0]] = values[1:]
        elif tag == "EDGE_SE2":
            i, j = (matrix(*vertices[name]) for name in fields[:2])
            error = np.linalg.inv(matrix(*values[2:5])) @ np.linalg.inv(i) @ j
            r = np.array([error[0, 2], error[1, 2], np.arctan2(error[1, 0], error[0, 0])])
            a, b, c, d, e, f = values[5:]
            total += r @ np.array([[a, b, c], [b, d, e], [c, e, f]]) @ r
        elif tag == "EDGE_SE2_XY":
            seen = np.linalg.inv(matrix(*vertices[fields[0]])) @ [*vertices[fields[1]], 1]
            r = seen[:2] - values[2:4]
            a, b, c = values[4:]
            total += r @ np.array([[a, b], [b, c]]) @ r
    return total


def test_chi2_is_what_g2o_would_say(tmp_path):
    assert chi2(load_g2o(write(tmp_path, SMALL))) == pytest.approx(chi2_as_g2o_defines_it(SMALL), rel=1e-12)
    rng = np.random.default_rng(9)
    graph = random_graph(rng)
    graph = replace(graph, between=replace(graph.between, relative_pose=rng.normal(size=(40, 3))))
    save_g2o(tmp_path / "graph.g2o", graph)
    assert chi2_as_g2o_defines_it((tmp_path / "graph.g2o").read_text()) == pytest.approx(chi2(graph), rel=1e-12)


@pytest.mark.parametrize("seed", range(5))
def test_round_trip_is_exact(tmp_path, seed):
    graph = random_graph(np.random.default_rng(seed))
    save_g2o(tmp_path / "graph.g2o", graph)
    assert_equal(load_g2o(tmp_path / "graph.g2o"), graph)


def test_round_trip_without_factors_or_landmarks(tmp_path):
    graph = random_graph(np.random.default_rng(0), num_landmarks=1, num_edges=0, num_seen=0)
    graph = types.PoseGraph(graph.poses, np.zeros((0, 2)), graph.between, graph.observations)
    save_g2o(tmp_path / "graph.g2o", graph)
    assert_equal(load_g2o(tmp_path / "graph.g2o"), graph)


@pytest.mark.parametrize("seed", range(5))
def test_the_order_of_lines_and_the_names_of_vertices_do_not_matter(tmp_path, seed):
    rng = np.random.default_rng(seed)
    graph = random_graph(rng)
    save_g2o(tmp_path / "graph.g2o", graph)
    lines = (tmp_path / "graph.g2o").read_text().splitlines()
    # Increasing numbers for increasing numbers: the order of the ids stays, the ids themselves do not.
    new_id = np.cumsum(rng.integers(1, 10**9, size=25))
    ids = {"VERTEX_SE2": 1, "VERTEX_XY": 1, "EDGE_SE2": 2, "EDGE_SE2_XY": 2}
    renamed = []
    for line in lines:
        tag, *values = line.split()
        values[: ids[tag]] = [str(new_id[int(v)]) for v in values[: ids[tag]]]
        renamed.append(" \t ".join([tag, *values]))
    rng.shuffle(renamed)
    shuffled = load_g2o(write(tmp_path, "\r\n# comment \xe9\n".join(renamed).encode("latin-1")))
    np.testing.assert_array_equal(shuffled.poses, graph.poses)
    np.testing.assert_array_equal(shuffled.landmarks, graph.landmarks)
    assert chi2(shuffled) == pytest.approx(chi2(graph), rel=1e-12)


@pytest.mark.parametrize(
    ("lines", "poses", "landmarks"),
    [
        ("", [0], []),
        ("FIX 4\n", [0], []),
        ("FIX 7\n", [1], []),
        ("FIX 7 4\n", [1, 0], []),
        ("FIX 7\nFIX 4\nFIX 7\n", [1, 0], []),
        ("FIX 5 7\n", [1], [0]),
        ("FIX 5\n", [], [0]),
    ],
)
def test_what_is_fixed_is_read_and_written_back(tmp_path, lines, poses, landmarks):
    graph = load_g2o(write(tmp_path, SMALL + lines))
    assert (graph.fixed_poses.tolist(), graph.fixed_landmarks.tolist()) == (poses, landmarks)
    save_g2o(tmp_path / "again.g2o", graph)
    again = load_g2o(tmp_path / "again.g2o")
    assert_equal(again, graph)
    assert (again.fixed_poses.tolist(), again.fixed_landmarks.tolist()) == (poses, landmarks)
    assert (again.pose_ids, again.landmark_ids) == (graph.pose_ids, graph.landmark_ids) == ((4, 7), (5,))


@pytest.mark.parametrize(
    ("kept", "fixed", "named"),
    [
        ("VERTEX_SE2", "FIX 5 4\n", "FIX 5: expected a line VERTEX_XY"),
        ("VERTEX_SE2", "FIX 4\nFIX 5\n", "FIX 5: expected a line VERTEX_XY"),
        ("VERTEX_XY", "FIX 4\nFIX 7\n", "FIX 4: expected a line VERTEX_SE2"),
        ("nothing", "FIX 5 7\n", "FIX 5: expected a line VERTEX_XY"),
    ],
)
@pytest.mark.filterwarnings("ignore:.*the estimates come from the edges alone")
def test_of_several_fixed_vertices_the_file_says_where_they_are(tmp_path, kept, fixed, named):
    """Held still at the origin, where the file has left them, they would bend the map without a sign."""
    lines = [line for line in SMALL.splitlines() if line.startswith(("EDGE", kept))]
    with pytest.raises(ValueError, match=rf"line \d+: {named} for it, because another vertex is fixed, too; got none"):
        load_g2o(write(tmp_path, "\n".join(lines) + "\n" + fixed))
    assert load_g2o(write(tmp_path, "\n".join(lines) + "\nFIX 7\n")).fixed_poses.tolist() == [1]


def test_a_fixed_pose_stays_and_the_others_come_to_it(cases_folder):
    graph = load_g2o(cases_folder / "fix_last.g2o")
    solved = optimize(graph)
    np.testing.assert_array_equal(solved.poses[2], [100.0, 50.0, 0.3])
    np.testing.assert_allclose(solved.poses[0, :2], [100 - 2 * np.cos(0.3), 50 - 2 * np.sin(0.3)], atol=1e-9)
    both = load_g2o(cases_folder / "fix_two_ids.g2o")
    assert both.fixed_poses.tolist() == [0, 1] and both.pose_ids == (10, 250, 4711)
    np.testing.assert_array_equal(optimize(both).poses[:2], both.poses[:2])


def test_errors_call_a_pose_by_its_id(cases_folder):
    with pytest.raises(np.linalg.LinAlgError, match="pose 8000 is not tied to pose 10 by any chain of factors"):
        optimize(load_g2o(cases_folder / "index_not_id.g2o"))


def test_a_file_of_edges_alone_is_read_with_a_warning(cases_folder):
    with pytest.warns(UserWarning, match="no VERTEX_SE2 lines, so the estimates come from the edges alone"):
        graph = load_g2o(cases_folder / "no_vertices.g2o")
    assert graph.pose_ids == (10, 250, 4711)
    np.testing.assert_allclose(optimize(graph).poses, [[0, 0, 0], [1, 0, 0], [1, 1, 1.57]], atol=1e-9)


def test_landmarks_of_edges_alone(tmp_path):
    path = write(tmp_path, "EDGE_SE2 2 1 -1 0 0 4 0 0 4 0 4\nEDGE_SE2_XY 2 9 1 1 4 0 4\nEDGE_SE2_XY 1 9 2 1 4 0 4\n")
    with pytest.warns(UserWarning):
        graph = load_g2o(path)
    assert (graph.pose_ids, graph.landmark_ids) == ((1, 2), (9,))
    assert chi2(optimize(graph)) < 1e-18


def test_no_offset_of_the_sensor_is_accepted_and_any_other_refused(cases_folder, tmp_path):
    assert len(load_g2o(cases_folder / "params_zero_offset.g2o").poses) == 3
    with pytest.raises(ValueError, match="line 1: PARAMS_SE2OFFSET: expected a sensor at the robot's origin"):
        load_g2o(write(tmp_path, "PARAMS_SE2OFFSET 0 0.1 0 0\n" + SMALL))


def test_a_byte_order_mark_and_gzip_are_read(cases_folder, tmp_path):
    assert load_g2o(cases_folder / "bom.g2o").pose_ids == (10, 250, 4711)
    packed = write(tmp_path, gzip.compress(SMALL.encode()), "graph.g2o.gz")
    assert_equal(load_g2o(packed), load_g2o(write(tmp_path, SMALL)))
    with pytest.raises(ValueError, match=r"graph.g2o.gz: expected a whole gzip file"):
        load_g2o(write(tmp_path, gzip.compress(SMALL.encode())[:-9], "graph.g2o.gz"))
    with pytest.raises(ValueError, match="expected ASCII or UTF-8, got UTF-16"):
        load_g2o(write(tmp_path, SMALL.encode("utf-16")))


def test_a_gzip_bomb_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr("npslam_teach.datasets.graph_lines.MAX_BYTES", 1000)
    with pytest.raises(ValueError, match="expected at most 1000 bytes when unpacked, got more"):
        load_g2o(write(tmp_path, gzip.compress(b"# " + b"0" * 5000 + b"\n"), "graph.g2o.gz"))


def test_toro_has_the_same_numbers_in_another_order(tmp_path):
    toro = "VERTEX2 4 0 0 0\nVERTEX2 7 1.5 0.25 -0.5\nEDGE2 4 7 1 0 0.1 4 0.5 5 6 0.25 0.125\n"
    lines = SMALL.splitlines(keepends=True)
    g2o = "".join(line for line in lines if line.startswith(("VERTEX_SE2", "EDGE_SE2 ")))
    assert_equal(load_g2o(write(tmp_path, toro)), load_g2o(write(tmp_path, g2o, "other.g2o")))


def test_other_programs_are_named(tmp_path):
    with pytest.raises(ValueError, match="line 1: expected a file of g2o or TORO, got the tag 'ODOMETRY' of iSAM"):
        load_g2o(write(tmp_path, "ODOMETRY 0 1 1 0 0 1 0 0 1 0 1\n"))


def test_information_that_printing_made_indefinite_is_read_with_a_warning(cases_folder, tmp_path):
    with pytest.warns(UserWarning, match="1 information matrices, the first in line 4, are indefinite by the rounding"):
        graph = load_g2o(cases_folder / "rounded_information.g2o")
    information = graph.between.information
    assert np.linalg.eigvalsh(information[0])[0] > 0
    np.testing.assert_allclose(information[0], [[100, 100, 0], [100, 99.9999, 0], [0, 0, 1]], atol=3e-3)
    assert chi2(optimize(graph)) < 1e-12
    with pytest.raises(ValueError, match="line 8: I11: expected a positive semidefinite matrix"):
        load_g2o(write(tmp_path, SMALL + "EDGE_SE2 4 7 1 0 0 100 100 0 99.9 0 1\n"))


WRONG = [
    ("VERTEX_SE2 4 1 1 1", 8, "id: expected a new id, got 4, which line 2 defines already"),
    ("VERTEX_XY 4 1 1", 8, "id: expected a new id, got 4, which line 2 defines already"),
    ("VERTEX_SE2 8 1 1", 8, "VERTEX_SE2: expected 4 values (id x y theta), got 3"),
    ("VERTEX_SE2 8 1 1 1 1", 8, "VERTEX_SE2: expected 4 values (id x y theta), got 5"),
    ("VERTEX_SE2 8 1 1e200 1", 8, "VERTEX_SE2 y: expected a number up to 1e+15, got '1e200'"),
    ("VERTEX_SE2 8 1 nan 1", 8, "VERTEX_SE2 y: expected a finite number, got 'nan'"),
    ("VERTEX_SE2 8 1 1 inf", 8, "VERTEX_SE2 theta: expected a finite number, got 'inf'"),
    ("VERTEX_SE2 8 1 1 1e999", 8, "VERTEX_SE2 theta: expected a finite number, got '1e999'"),
    ("VERTEX_SE2 8 one 1 1", 8, "VERTEX_SE2 x: expected a finite number, got 'one'"),
    ("VERTEX_SE2 8 1_0 1 1", 8, "VERTEX_SE2 x: expected a finite number, got '1_0'"),
    ("VERTEX_SE2 8.0 1 1 1", 8, "VERTEX_SE2 id: expected a non-negative integer, got '8.0'"),
    ("VERTEX_SE2 -8 1 1 1", 8, "VERTEX_SE2 id: expected a non-negative integer, got '-8'"),
    ("VERTEX_XY " + "9" * 5000 + " 1 1", 8, "VERTEX_XY id: expected a non-negative integer, got '999"),
    ("VERTEX_XY 8 \xb2 1", 8, "VERTEX_XY x: expected a finite number, got"),
    ("EDGE_SE2 4 8 1 0 0 1 0 0 1 0 1", 8, "j: expected the id of a VERTEX_SE2, got 8"),
    ("EDGE_SE2 5 7 1 0 0 1 0 0 1 0 1", 8, "i: expected the id of a VERTEX_SE2, got 5"),
    ("EDGE_SE2 7 7 1 0 0 1 0 0 1 0 1", 8, "j: expected a pose other than i, got 7 twice"),
    ("EDGE_SE2 4 7 1 0 0 1 0 0 1 0", 8, "EDGE_SE2: expected 11 values (i j dx dy dtheta I11"),
    ("EDGE_SE2 4 7 1 0 0 1 0 0 1 NaN 1", 8, "EDGE_SE2 I23: expected a finite number, got 'NaN'"),
    (
        "EDGE_SE2 4 7 1 0 0 1 0 0 -1 0 1",
        8,
        "I11: expected a positive semidefinite matrix, got the upper triangle",
    ),
    ("EDGE_SE2 4 7 1 0 0 1 2 0 1 0 1", 8, "I11: expected a positive semidefinite matrix"),
    ("EDGE_SE2_XY 7 4 1 2 3 0 4", 8, "l: expected the id of a VERTEX_XY, got 4"),
    ("EDGE_SE2_XY 5 5 1 2 3 0 4", 8, "i: expected the id of a VERTEX_SE2, got 5"),
    (
        "EDGE_SE2_XY 7 5 1 2 3 4 4",
        8,
        "I11: expected a positive semidefinite matrix, got the upper triangle [3.0, 4",
    ),
    ("FIX 8", 8, "FIX id: expected the id of a vertex, got 8"),
    ("FIX 4 8", 8, "FIX id: expected the id of a vertex, got 8"),
    ("FIX", 8, "FIX: expected 1 values (id), got 0"),
    ("FIX 4 seven", 8, "FIX id: expected a non-negative integer, got 'seven'"),
    (
        "EDGE_SE2_RANGE 4 7 1 1",
        8,
        "expected landmarks measured as x y, in EDGE_SE2_XY, got 'EDGE_SE2_RANGE', which is of bearings or",
    ),
    ("vertex_se2 8 1 1 1", 8, "expected the tag VERTEX_SE2 in capitals"),
    ("VERTEX_SE 8 1 1 1", 8, "expected one of the tags VERTEX_SE2, VERTEX_XY, EDGE_SE2, EDGE_SE2_XY, FIX, PARAMS_SE2"),
    ("\x00\x01\x02", 8, "expected one of the tags"),
    ("VERTEX_SE3:QUAT 8 0 0 0 0 0 0 1", 8, "expected a two-dimensional graph, got the tag 'VERTEX_SE3:QUAT'"),
    ("EDGE_SE3:QUAT 4 7", 8, "expected a two-dimensional graph, got the tag 'EDGE_SE3:QUAT'"),
]


@pytest.mark.parametrize(("line", "number", "words"), WRONG, ids=[str(k) for k in range(len(WRONG))])
def test_a_wrong_line_is_one_sentence_with_its_number(tmp_path, line, number, words):
    path = write(tmp_path, SMALL + line + "\n# more\nVERTEX_SE2 99 0 0 0\n")
    with pytest.raises(ValueError) as caught:
        load_g2o(path)
    message = str(caught.value)
    assert message.startswith(f"{path}, line {number}: {words}")
    assert "\n" not in message and len(message) < len(str(path)) + 300


@pytest.mark.parametrize("position", [0, 1, 17, 99])
def test_indefinite_information_is_found_among_many_edges(tmp_path, position):
    edges = ["EDGE_SE2 4 7 1 0 0 1 0 0 1 0 1"] * 100
    edges[position] = "EDGE_SE2 4 7 1 0 0 1 0 0 1 0 -1"
    path = write(tmp_path, SMALL + "\n".join(edges))
    with pytest.raises(ValueError, match=f"line {8 + position}: I11: expected a positive semidefinite"):
        load_g2o(path)


@pytest.mark.parametrize("text", ["# nothing\n", "VERTEX_XY 1 0 0\n", "\n\n"])
def test_a_graph_needs_a_pose(tmp_path, text):
    path = write(tmp_path, text)
    with pytest.raises(ValueError, match="expected at least one VERTEX_SE2 or EDGE_SE2, got none") as caught:
        load_g2o(path)
    assert str(path) in str(caught.value)


def test_a_line_that_is_no_text_is_refused_without_being_split(tmp_path):
    path = write(tmp_path, SMALL.encode() + b"\0" * 2_000_000)
    with pytest.raises(ValueError, match="graph.g2o, line 8: expected at most 1048576 bytes, got 2000000"):
        load_g2o(path)


def test_information_that_is_too_large_once_it_is_turned_names_the_file(tmp_path):
    path = write(
        tmp_path, SMALL + "EDGE_SE2 4 7 1 0 0.7 1e15 0 0 1e14 0 1\nEDGE_SE2 4 7 1 0 0.7 1e15 9e14 0 1e15 0 1\n"
    )
    with pytest.raises(ValueError, match=r"graph.g2o: information: expected numbers up to 1e\+15, got 1\."):
        load_g2o(path)


def test_a_file_that_is_no_file(tmp_path):
    with pytest.raises(FileNotFoundError, match="missing.g2o: expected a file"):
        load_g2o(tmp_path / "missing.g2o")
    with pytest.raises(ValueError, match="expected a file, got a folder"):
        load_g2o(tmp_path)
    with pytest.raises(ValueError, match="graph.g2o: expected a file with contents, got an empty one"):
        load_g2o(write(tmp_path, ""))


def test_a_failed_save_leaves_the_old_file_and_nothing_else(tmp_path, monkeypatch):
    path = write(tmp_path, SMALL)
    monkeypatch.setattr("os.replace", lambda *args: (_ for _ in ()).throw(OSError(28, "No space left on device")))
    with pytest.raises(ValueError, match="graph.g2o: expected a place to write, got no space left on device"):
        save_g2o(path, random_graph(np.random.default_rng(0)))
    assert path.read_text() == SMALL
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.filterwarnings("ignore:.*come from the edges alone")
def test_an_id_is_not_both_a_pose_and_a_landmark(tmp_path):
    path = write(tmp_path, "VERTEX_SE2 4 0 0 0\nVERTEX_SE2 7 1 0 0\nEDGE_SE2_XY 7 4 1 1 1 0 1\n")
    with pytest.raises(ValueError, match="line 3: l: expected the id of a landmark, got 4, which is a pose"):
        load_g2o(path)


def test_damaged_files_end_in_one_sentence_or_a_graph(tmp_path, damaged):
    rng = np.random.default_rng(0)
    save_g2o(tmp_path / "graph.g2o", random_graph(rng, num_edges=5, num_seen=5))
    original = (tmp_path / "graph.g2o").read_bytes()
    accepted = 0
    for _ in range(400):
        path = write(tmp_path, damaged(original, rng), "damaged.g2o")
        try:
            assert isinstance(load_g2o(path), types.PoseGraph)
            accepted += 1
        except ValueError as error:
            assert str(error).startswith(str(path)) and "\n" not in str(error)
    assert 0 < accepted < 400  # some changes only make another number


@pytest.mark.parametrize(
    ("name", "num_poses", "num_landmarks", "num_edges", "num_seen"),
    [("intel", 1728, 0, 2512, 0), ("manhattan", 3500, 0, 5453, 0), ("victoria_park", 6969, 151, 6968, 3640)],
)
def test_standard_graphs(data_folder, tmp_path, name, num_poses, num_landmarks, num_edges, num_seen):
    start = time.process_time()
    graph = load_g2o(data_folder / f"{name}.g2o")
    assert time.process_time() - start < 3  # 0.1 s on a quiet machine; this is a guard against something quadratic
    assert (len(graph.poses), len(graph.landmarks)) == (num_poses, num_landmarks)
    assert (len(graph.between.i), len(graph.observations.pose)) == (num_edges, num_seen)
    save_g2o(tmp_path / "again.g2o", graph)
    assert_equal(load_g2o(tmp_path / "again.g2o"), graph)


@pytest.mark.parametrize("name", ["intel", "manhattan"])
def test_standard_graphs_start_from_integrated_odometry(data_folder, name):
    # Every step between successive poses then has no residual: this ties vertices, edges and signs together.
    graph = load_g2o(data_folder / f"{name}.g2o")
    steps = np.flatnonzero(graph.between.j == graph.between.i + 1)
    first = steps[np.unique(graph.between.i[steps], return_index=True)[1]]
    between = graph.between
    columns = [column[first] for column in (between.i, between.j, between.relative_pose, between.information)]
    odometry = types.PoseGraph(graph.poses, graph.landmarks, types.BetweenFactors(*columns), graph.observations)
    assert chi2(odometry) < 1e-6 * chi2(graph)


def test_time_grows_in_proportion_to_the_size(tmp_path):
    seconds = []
    for count in (2000, 16000):
        graph = random_graph(np.random.default_rng(0), count, 10, count, count)
        save_g2o(tmp_path / "graph.g2o", graph)
        runs = []
        for _ in range(3):
            start = time.process_time()
            load_g2o(tmp_path / "graph.g2o")
            runs.append(time.process_time() - start)
        seconds.append(min(runs))
    assert seconds[1] < 8 * 4 * seconds[0]  # eight times the lines; a quadratic step would make it 64


@pytest.mark.parametrize("tag", ["EDGE_BEARING_SE2_XY", "EDGE_SE2_BEARING_XY", "EDGE_RANGE_SE2"])
def test_bearings_are_named_as_what_they_are(tmp_path, tag):
    (tmp_path / "a.g2o").write_text(f"VERTEX_SE2 0 0 0 0\nVERTEX_XY 1 1 1\n{tag} 0 1 0.7 1\n")
    with pytest.raises(ValueError, match=f"line 3: expected landmarks measured as x y, in EDGE_SE2_XY, got .*{tag}"):
        load_g2o(tmp_path / "a.g2o")


def test_tags_in_small_letters_are_named_too(tmp_path):
    (tmp_path / "a.g2o").write_text("vertex_se2 0 0 0 0\n")
    with pytest.raises(ValueError, match="line 1: expected the tag VERTEX_SE2 in capitals, got 'vertex_se2'"):
        load_g2o(tmp_path / "a.g2o")
