"""Lesson 15: its checks name the usual mistakes, its pictures show what they are given, its explorer is right."""

import numpy as np
import pytest
from exercises import assert_names_the_mistake, checks_and_solutions
from readable import assert_readable

from npslam_teach import plotting
from npslam_teach.course.online import drives, figures, pictures, table
from npslam_teach.course.online.explorer import explore_drive
from npslam_teach.evaluation import wilson_interval
from npslam_teach.methods import METHODS, online
from npslam_teach.simulate import toy_objects

CHECKS, solution = checks_and_solutions("15_online")


def schur(H, g, sign=-1.0, inverse=np.linalg.inv):
    k = np.setdiff1d(np.arange(len(H)), g)
    return H[np.ix_(k, k)] + sign * H[np.ix_(k, g)] @ inverse(H[np.ix_(g, g)]) @ H[np.ix_(g, k)]


def powers(n):
    return [2**k for k in range(n.bit_length()) if n >> k & 1][::-1]


def gain(x, S, d, half=0.5, det=0.5, pi=2 * np.pi, prior=-1.0):
    squared = x @ np.linalg.solve(S, x)
    return -half * squared - det * np.log(np.linalg.det(S)) - np.log(pi) + prior * np.log(d)


WRONG = [
    (1, lambda H, g: np.delete(np.delete(H, g, 0), g, 1), "struck out"),
    (1, lambda H, g: schur(H, g, sign=1.0), "the sign is wrong"),
    (1, lambda H, g: schur(H, g, inverse=lambda A: A), "must be inverted"),
    (1, lambda H, g: np.delete(np.delete(np.linalg.inv(H), g, 0), g, 1), "a covariance"),
    (2, lambda n: powers(n)[::-1], "comes first"),
    (2, lambda n: [int(d) for d in f"{n:b}"], "binary digits"),
    (2, lambda n: powers(n)[:1], "largest tree alone"),
    (3, lambda x, S, d: gain(x, S, d, half=1.0), "1/2"),
    (3, lambda x, S, d: gain(x, S, d, det=0.0), "determinant is missing"),
    (3, lambda x, S, d: gain(x, S, d, pi=1.0), "2 pi"),
    (3, lambda x, S, d: gain(x, S, d, prior=0.0), "density of unseen objects"),
    (3, lambda x, S, d: gain(x, S, d, prior=1.0), "sign of their density"),
]


@pytest.mark.parametrize(("number", "mistake", "message"), WRONG)
def test_usual_mistakes_are_named(number, mistake, message):
    assert_names_the_mistake(CHECKS[number], mistake, message)


@pytest.fixture
def ax():
    return plotting.new_figure(size=(9, 5))[1]


def test_information_has_its_numbers(ax):
    pictures.plot_information(ax, np.array([[2.0, -1.0], [-1.0, 0.0]]), "ab", "t")
    assert sorted(text.get_text() for text in ax.texts) == ["-1", "-1", "2"]


@pytest.mark.parametrize(("sizes", "total"), [([1], 3), ([8, 2, 1], 23), ([4, 2], 13)])
def test_a_tree_has_a_box_for_each_submap(ax, sizes, total):
    pictures.plot_tree(ax, sizes, "t")
    boxes_of_joints = len(sizes) - 1  # joints of unequal trees are in the number, and left out of the picture
    assert len(ax.patches) == total - boxes_of_joints
    assert ax.get_title() == f"t: 2 of {total} submaps redone"


def test_runs_are_those_of_the_table():
    figure = pictures.errors_figure([("online", 9, 0)])
    lines = figure.axes[0].lines
    for line, name in zip(lines, ("error", "error_batch", "error_told"), strict=True):
        np.testing.assert_array_equal(line.get_ydata(), table.column(name, "online", 9, 0))
    figure = pictures.times_figure([("told", 9, 0)])
    np.testing.assert_array_equal(figure.axes[0].lines[0].get_ydata(), table.column("median_ms", "told", 9, 0))


def test_methods_have_their_shares_and_seconds():
    rows = table.all_methods()
    figure = pictures.methods_figure(rows)
    left, right = figure.axes
    for k, container in enumerate(left.containers):
        own = [row for row in rows if row["method"] == container.get_label()]
        exact, runs = (np.array([row[key] for row in own]) for key in ("exact", "runs"))
        np.testing.assert_array_equal(container[0].get_ydata(), exact / runs)
        ends = np.array([bar[:, 1] for bar in container[2][0].get_segments()])
        np.testing.assert_allclose(ends.T, wilson_interval(exact, runs))
        assert right.get_yticklabels()[k].get_text() == own[0]["method"]
        assert right.lines[k].get_xydata().tolist() == [[own[0]["seconds"], k]]
    assert len(left.containers) == len(METHODS)
    assert left.get_title() == "posterior is exact in 97 of 100 runs; the next, online, in 65"
    assert_readable(figure)


def test_drives_keep_their_books():
    log, truth = toy_objects()
    tree, work = drives.told_drive(log, truth)
    assert len(work) == log.num_poses and work.sum() == tree.redone
    robot, counts, first = drives.beliefs_under_way(log)
    assert len(counts) == log.num_poses and len(first) == log.num_observations
    assert counts[-1] == len(np.unique(robot.labels[robot.labels >= 0]))


def test_the_explorer_tells_the_truth():
    log, truth = toy_objects()
    snapshots = list(online(log))[1:]
    explorer = explore_drive(log, truth, snapshots)
    for tenth in (1, len(snapshots)):
        assert f"tenth {tenth} of the drive: {snapshots[tenth - 1].num_objects} objects" in explorer.move(tenth=tenth)


def test_the_pictures_can_be_read():
    (entry,) = figures.FIGURES
    assert_readable(entry.draw())
    assert_readable(pictures.work_figure(np.array([0, 1, 2, 2, 5]), 3))
    assert_readable(pictures.counts_figure(np.array([1, 2, 2, 1]), 2))
    assert_readable(pictures.alphas_figure({0.1: [15, 15], 1.0: [23, 15]}))
