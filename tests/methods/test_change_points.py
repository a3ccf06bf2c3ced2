"""Changes of the object within a pass: by how much chi2 falls, and where."""

import numpy as np
import pytest

from npslam_teach.association import in_order_of_sight
from npslam_teach.methods.annealing import Model, rivals_of
from npslam_teach.methods.change_points import _ranks, after_change, falls_of_chi2
from npslam_teach.methods.partition_score import in_pieces, scored
from npslam_teach.methods.persistence import passes_of
from npslam_teach.pose_graph import chi2, fit
from npslam_teach.types import RobotLog


@pytest.fixture(scope="module")
def pieces(room):
    """The true partition solved, the pieces of its passes, and the falls of chi2."""
    model, graph, truth = room
    found, number = scored(model, truth, graph.poses), passes_of(truth, model.log.obs_time)[0]
    piece = in_order_of_sight(np.column_stack([number, _ranks(number) // 4]))
    return found, number, piece, falls_of_chi2(model, truth, found.graph, piece)


def from_here_on(piece, number, k):
    """Which observations (M,) are of piece k or of later ones of its pass."""
    return (piece >= k) & (number == number[piece == k][0])


def test_falls_are_those_of_the_linear_model(room, pieces):
    """Least squares with the places of all objects, and one more for what is seen from a piece on."""
    model, _, truth = room
    found, number, piece, falls = pieces
    _, reduced = in_pieces(model, truth, found.graph, piece)
    of_piece = truth[np.unique(piece, return_index=True)[1]]

    def least(labels):
        gather = np.kron(labels[:, None] == np.arange(labels.max() + 1), np.eye(2))
        best = np.linalg.solve(gather.T @ reduced.information @ gather, gather.T @ reduced.vector)
        return reduced.chi2((gather @ best).reshape(-1, 2))

    first = np.unique(number[np.unique(piece, return_index=True)[1]], return_index=True)[1]
    assert (falls[first] == 0).all()
    whole = least(of_piece)
    for k in np.setdiff1d(np.arange(len(falls)), first)[::7]:
        later = np.unique(piece[from_here_on(piece, number, k)])
        split = np.where(np.isin(np.arange(len(of_piece)), later), of_piece.max() + 1, of_piece)
        assert falls[k] == pytest.approx(whole - least(split), abs=1e-6)


def test_and_nearly_those_of_the_solver(room, pieces):
    model, _, truth = room
    found, number, piece, falls = pieces
    for k in np.argsort(-falls)[:5]:
        split = np.where(from_here_on(piece, number, k), truth.max() + 1, truth)
        assert falls[k] == pytest.approx(chi2(found.graph) - chi2(fit(model.log, split, found.graph.poses)), rel=0.05)


def seen_in_passing(changes_at, rng):
    """A robot that stands still sees a thing at every pose, and from some pose on another 0.4 m beside it."""
    xy = np.where(np.arange(40)[:, None] < changes_at, [2.0, 0.0], [2.4, 0.0]) + rng.normal(scale=0.1, size=(40, 2))
    log = RobotLog(np.zeros((39, 3)), np.arange(40), xy, np.zeros(40, int), 1, (1e-3,) * 3, (0.1, 0.1))
    labels = np.zeros(40, int)
    return Model(log, labels, rivals_of(log, labels), 1.0, 100.0), labels, fit(log, labels)


@pytest.mark.parametrize("changes_at", [5, 18, 30])
def test_a_change_is_found_where_it_is(changes_at):
    """To one observation in nine of ten; drawn anew thirty times."""
    found = []
    for seed in range(30):
        after = after_change(*seen_in_passing(changes_at, np.random.default_rng(seed)))
        assert after.any() and (np.diff(after.astype(int)) >= 0).all()
        found.append(after.argmax())
    assert np.mean(np.abs(np.array(found) - changes_at) <= 1) >= 0.9


def test_where_nothing_changes_little_is_cut():
    """By chance the best of all places of a pass is above what one place in twenty is above; not in most passes."""
    cut = [after_change(*seen_in_passing(40, np.random.default_rng(seed))).any() for seed in range(60)]
    assert np.mean(cut) < 0.5
