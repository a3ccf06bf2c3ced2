"""Moved parts of passes: what the linear model says of a move, and tracklets that run on into another object."""

import sys

import numpy as np

from npslam_teach import simulate
from npslam_teach.association import in_order_of_sight, same_partition
from npslam_teach.methods.annealing import Model, rivals_of
from npslam_teach.methods.change_points import after_change
from npslam_teach.methods.partition_score import scored
from npslam_teach.methods.pass_moves import Move, _moves, parts_of_passes, with_moved_passes
from npslam_teach.methods.persistence import passes_of
from npslam_teach.methods.posterior import in_time, start_model
from npslam_teach.methods.refinement import _improved
from npslam_teach.methods.repair import without_gaps


def with_one_tracklet_of_two_objects(model: Model, truth: np.ndarray, last: int, then: int):
    """The model and labels (M,) when a tracklet runs on into another one, and both are taken for the first's object."""
    joined = np.where(model.tracklet == then, last, model.tracklet)
    tracklet = in_order_of_sight(joined, joined >= 0)
    labels = np.where(model.tracklet == then, truth[model.tracklet == last][0], truth)
    return model._replace(tracklet=tracklet, rivals=rivals_of(model.log, tracklet)), labels


def test_a_tracklet_that_runs_on_into_another_object_is_cut_where_the_other_begins(room):
    model, graph, truth = room
    last, then = soonest_after_another(model, truth)
    wrong, labels = with_one_tracklet_of_two_objects(model, truth, last, then)
    labels = labels_once_in_a_frame(model.log, labels, model.tracklet == then)
    before = scored(wrong, labels, graph.poses)
    assert with_moved_passes(wrong, before).score > before.score + 10
    after = _improved(wrong, before)
    tied = model.tracklet >= 0
    assert not same_partition(labels[tied], truth[tied])
    assert same_partition(after.labels[tied], truth[tied])
    assert after.score > before.score + 10
    frames = np.column_stack([model.log.obs_time, after.labels])[after.labels >= 0]
    assert len(np.unique(frames, axis=0)) == len(frames)


def test_two_left_out_observations_found_an_object(room):
    """Labelled as of none, all observations of an object are put together, one after the other."""
    model, graph, truth = room
    gone = np.argmin(np.bincount(truth))
    labels = without_gaps(np.where(truth == gone, -1, truth))
    after = with_moved_passes(model, scored(model, labels, graph.poses))
    assert (after.labels >= 0).all() and same_partition(after.labels, truth)


def changed_by(move: Move, labels: np.ndarray) -> np.ndarray:
    labels = labels.copy()
    labels[move.own] = labels[move.there] if move.there >= 0 else labels.max() + 1
    return without_gaps(labels)


def test_the_linear_model_foretells_what_a_move_is_worth(room):
    """For moves that hardly bend the trajectory, the gain it names is that of the partition solved anew."""
    model, graph, truth = room
    wrong = truth.copy()
    own = np.flatnonzero(parts_of_passes(model, scored(model, truth, graph.poses))[0] == 3)
    wrong[own] = truth.max() + 1
    found = scored(model, without_gaps(wrong), graph.poses)
    moves = [move for move in _moves(model, found) if found.labels[move.there] >= 0 or move.there < 0]
    real = np.array([scored(model, changed_by(move, found.labels), graph.poses).score - found.score for move in moves])
    gain = np.array([move.gain for move in moves])
    assert len(moves) > 0 and gain.max() > 5
    np.testing.assert_allclose(real[gain > 0], gain[gain > 0], atol=1.0)


def test_parts_are_of_one_pass_and_cut_where_others_of_the_class_begin_or_end_or_the_object_may_change(room):
    model, graph, truth = room
    found = scored(model, truth, graph.poses)
    part, of_pass = parts_of_passes(model, found)
    after = after_change(model, truth, found.graph)
    number, of_object = passes_of(truth, model.log.obs_time)
    assert (of_pass[part] == number).all()
    time, classes = model.log.obs_time, model.log.obs_class
    for each in range(len(of_object)):
        own = np.flatnonzero(number == each)
        alike = [other for other in range(len(of_object)) if classes[number == other][0] == classes[own[0]]]
        borders = {time[number == other].min() for other in alike} | {
            time[number == other].max() + 1 for other in alike
        }
        inside = [border for border in borders if time[own].min() < border <= time[own].max()]
        steps = {(time[own] >= border).argmax() for border in inside} | {after[own].argmax()}
        assert len(np.unique(part[own])) == len(steps - {0}) + 1


def soonest_after_another(model: Model, truth: np.ndarray) -> tuple[int, int]:
    """Two tracklets of a class, the second begins soonest after the first has ended; its object has others as well."""
    log, own = model.log, [np.flatnonzero(model.tracklet == k) for k in range(len(model.rivals))]
    begin, end = (np.array([log.obs_time[each][i] for each in own]) for i in (0, -1))
    objects, classes = (np.array([values[each[0]] for each in own]) for values in (truth, log.obs_class))
    follows = (classes[:, None] == classes) & (objects[:, None] != objects) & (end[:, None] < begin)
    follows &= np.bincount(objects)[objects] > 1
    gap = np.where(follows, begin - end[:, None], np.inf)
    return np.unravel_index(gap.argmin(), gap.shape)


def labels_once_in_a_frame(log, labels, moved):
    """Labels (M,) in which what the moved observations displace in their own frame is of none."""
    taken = labels[moved] + 1000 * log.obs_time[moved]
    displaced = ~moved & np.isin(labels + 1000 * log.obs_time, taken)
    labels = np.where(displaced, -1, labels)
    return in_order_of_sight(labels, labels >= 0)


def test_two_moves_at_once_where_neither_pays_alone(monkeypatch):
    """Two passes of a room at six times the noise, each in a wrong object: the trajectory bends to suit both."""
    log, truth = simulate.fifteen_objects(20024, 6.0)
    log, back = in_time(log)
    truth = in_order_of_sight(truth.obs_object[np.argsort(back)])
    (model, graph), (number, of_object) = start_model(log), passes_of(truth, log.obs_time)
    right, wrong = scored(model, truth, graph.poses), truth.copy()
    wrong[number == 18] = of_object[20]  # which begins beside it when it ends
    wrong[number == 17] = truth.max() + 1
    found = scored(model, without_gaps(wrong), right.graph.poses)
    assert found.score < right.score - 1
    with monkeypatch.context() as patch:
        patch.setattr(sys.modules[with_moved_passes.__module__], "FIRST", 0)
        assert with_moved_passes(model, found).score < right.score - 1
    assert same_partition(with_moved_passes(model, found).labels, truth)
