"""The measures, against pair counting and by hand."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

from npslam_teach import evaluation, np_graph, pose_graph, se2, simulate
from npslam_teach.methods import frame_by_frame, robust_slam


@pytest.fixture(scope="module")
def solved():
    log, truth = simulate.fifteen_objects()
    *_, last = np_graph(log)
    return log, truth, last


def ari_by_pairs(a, b):
    """Hubert and Arabie's index from the four counts of pairs."""
    both = only_a = only_b = neither = 0
    for i, j in itertools.combinations(range(len(a)), 2):
        together = (a[i] == a[j], b[i] == b[j])
        both += together == (True, True)
        only_a += together == (True, False)
        only_b += together == (False, True)
        neither += together == (False, False)
    return (
        2
        * (both * neither - only_a * only_b)
        / ((both + only_a) * (only_a + neither) + (both + only_b) * (only_b + neither))
    )


@pytest.mark.parametrize("seed", range(10))
def test_ari_agrees_with_counting_pairs(seed):
    rng = np.random.default_rng(seed)
    a, b = rng.integers(0, 4, 30), rng.integers(0, 5, 30)
    assert evaluation.compare_partitions(a, b)[0] == pytest.approx(ari_by_pairs(a, b))


@pytest.mark.parametrize("seed", range(5))
def test_v_measure_agrees_with_its_definition(seed):
    rng = np.random.default_rng(seed)
    a, b = rng.integers(0, 4, 60), rng.integers(0, 5, 60)

    def entropy(labels):
        p = np.bincount(labels)[np.bincount(labels) > 0] / len(labels)
        return -(p * np.log(p)).sum()

    def conditional(x, given):
        return sum(np.mean(given == g) * entropy(x[given == g]) for g in np.unique(given))

    homogeneity = 1 - conditional(a, b) / entropy(a)
    completeness = 1 - conditional(b, a) / entropy(b)
    expected = 2 * homogeneity * completeness / (homogeneity + completeness)
    assert evaluation.compare_partitions(a, b)[1] == pytest.approx(expected)


def test_the_same_partition_scores_one_whatever_the_names():
    a = np.array([0, 0, 1, 2, 2, 2])
    assert evaluation.compare_partitions(a, np.array([7, 7, 3, 5, 5, 5])) == (1.0, 1.0)
    assert evaluation.compare_partitions(np.zeros(5, int), np.zeros(5, int)) == (1.0, 1.0)
    assert evaluation.compare_partitions(np.arange(5), np.arange(5)) == (1.0, 1.0)
    assert evaluation.compare_partitions(np.zeros(0, int), np.zeros(0, int)) == (1.0, 1.0)


def test_random_partitions_score_zero_on_average():
    rng = np.random.default_rng(0)
    scores = [evaluation.compare_partitions(rng.integers(0, 5, 200), rng.integers(0, 5, 200))[0] for _ in range(200)]
    assert abs(np.mean(scores)) < 0.003


def test_an_unassigned_observation_is_a_cluster_of_its_own():
    labels = evaluation.singletons_for_unassigned(np.array([0, -1, 0, -1, 1]))
    assert labels[0] == labels[2]
    assert len(np.unique(labels)) == 4


def test_errors_of_the_truth_are_zero(solved):
    log, truth, last = solved
    seen, labels = np.unique(truth.obs_object, return_inverse=True)
    graph = replace(last.graph, poses=truth.poses, landmarks=truth.world.object_xy[seen])
    perfect = replace(last, labels=labels, graph=graph, votes=np.ones((len(seen), 6)))
    metrics = evaluation.evaluate(perfect, truth, log)
    assert metrics.mean_pose_error == pytest.approx(0.0, abs=1e-12)
    assert metrics.mean_object_error == pytest.approx(0.0, abs=1e-12)
    assert (metrics.ari, metrics.v_measure, metrics.observations_used) == (1.0, 1.0, 1.0)


def test_errors_do_not_depend_on_where_the_estimate_lives(solved):
    log, truth, last = solved
    motion = np.array([30.0, -7.0, 1.9])
    graph = replace(
        last.graph,
        poses=se2.compose(motion, last.graph.poses),
        landmarks=se2.apply(motion, last.graph.landmarks),
    )
    here, there = (evaluation.evaluate(s, truth, log) for s in (last, replace(last, graph=graph)))
    assert there.mean_pose_error == pytest.approx(here.mean_pose_error, rel=1e-9)
    assert there.mean_object_error == pytest.approx(here.mean_object_error, rel=1e-9)
    assert there.chi2_per_dof == pytest.approx(here.chi2_per_dof, rel=1e-6)


def test_a_known_error_is_measured(solved):
    """Push one pose 1 m sideways: the mean grows by about 1 / T; the object error by exactly what its share is."""
    log, truth, last = solved
    seen, labels = np.unique(truth.obs_object, return_inverse=True)
    landmarks = truth.world.object_xy[seen].copy()
    landmarks[0] += [0.3, 0.4]
    graph = replace(last.graph, poses=truth.poses, landmarks=landmarks)
    wrong = replace(last, labels=labels, graph=graph, votes=np.ones((len(seen), 6)))
    assert evaluation.evaluate(wrong, truth, log).mean_object_error == pytest.approx(0.5 * np.mean(labels == 0))


def test_cumulative_and_mean_and_rmse_fit_together(solved):
    log, truth, last = solved
    m = evaluation.evaluate(last, truth, log)
    assert m.cumulative_pose_error == pytest.approx(m.mean_pose_error * log.num_poses)
    assert m.mean_pose_error < m.rmse_pose_error < 3 * m.mean_pose_error


def test_chi2_per_dof_tells_true_from_merged(solved):
    """Two objects declared one cannot be fitted; that is what chi2 sees, while too many objects always fit."""
    log, truth, last = solved
    assert evaluation.evaluate(last, truth, log).chi2_per_dof == pytest.approx(1.0, abs=0.1)
    first_class = np.flatnonzero(last.votes[:, 1] > 0)[:2]
    merged = np.where(last.labels == first_class[1], first_class[0], last.labels)
    labels = np.unique(merged, return_inverse=True)[1]
    assert evaluation.chi2_per_dof(pose_graph.fit(log, labels, last.graph.poses)) > 3


def test_chi2_per_dof_does_not_exist_without_redundancy(solved):
    log, truth, _ = solved
    *_, singletons = frame_by_frame(log)
    assert math.isnan(evaluation.evaluate(singletons, truth, log).chi2_per_dof)


def test_the_truth_of_another_log_is_refused(solved):
    log, _, last = solved
    with pytest.raises(ValueError, match="truth: expected 702 poses"):
        evaluation.evaluate(last, simulate.fifteen_objects(1)[1], log)


def test_observations_used(solved):
    log, truth, _ = solved
    *_, last = robust_slam(log)
    metrics = evaluation.evaluate(last, truth, log)
    assert metrics.num_observations_used == np.count_nonzero(last.labels >= 0)
    assert metrics.observations_used == pytest.approx(metrics.num_observations_used / log.num_observations)


def test_clutter_counts_for_no_object_error(solved):
    log, truth, last = solved
    obs_object = truth.obs_object.copy()
    obs_object[::7] = -1
    _, errors = evaluation.distances_to_truth(last, replace(truth, obs_object=obs_object))
    assert len(errors) == np.count_nonzero(obs_object >= 0)
