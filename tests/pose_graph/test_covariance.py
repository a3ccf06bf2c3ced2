"""Covariances against dense inverses, hand-solved graphs and statistics."""

import numpy as np
import pytest
import scipy.optimize
import scipy.stats
from graphs import random_graph, three_pose_graph

from npslam_teach import evaluation, pose_graph, se2, simulate


def test_covariance_of_three_poses_by_hand():
    """In x alone H is [[2, -1], [-1, 2]], whose inverse is [[2, 1], [1, 2]] / 3."""
    solved = pose_graph.optimize(three_pose_graph())
    pose_cov, _ = pose_graph.marginal_covariance(solved, poses=[0, 1, 2])
    np.testing.assert_array_equal(pose_cov[0], np.zeros((3, 3)))
    assert pose_cov[1, 0, 0] == pytest.approx(2 / 3)
    assert pose_cov[2, 0, 0] == pytest.approx(2 / 3)


@pytest.mark.parametrize("seed", range(3))
def test_marginal_covariance_is_the_inverse_of_h(seed):
    solved = pose_graph.optimize(random_graph(seed))
    h, _, _ = pose_graph.linearize(solved)
    inverse = np.linalg.inv(h.toarray())
    pose_cov, landmark_cov = pose_graph.marginal_covariance(solved, poses=[5, 0, 2], landmarks=[3, 1])
    np.testing.assert_allclose(pose_cov[0], inverse[12:15, 12:15], rtol=1e-8, atol=1e-12)
    np.testing.assert_array_equal(pose_cov[1], 0)
    np.testing.assert_allclose(pose_cov[2], inverse[3:6, 3:6], rtol=1e-8, atol=1e-12)
    first = 3 * (len(solved.poses) - 1)
    np.testing.assert_allclose(landmark_cov[0], inverse[first + 6 : first + 8, first + 6 : first + 8], rtol=1e-8)
    np.testing.assert_allclose(landmark_cov[1], inverse[first + 2 : first + 4, first + 2 : first + 4], rtol=1e-8)


@pytest.mark.parametrize("wrong", [{"poses": [-1]}, {"poses": [99]}, {"landmarks": [-1]}, {"landmarks": [1.7]}])
def test_covariances_of_what_does_not_exist_are_refused(wrong):
    solved = pose_graph.optimize(random_graph(0))
    with pytest.raises(ValueError, match=f"{next(iter(wrong))}: expected"):
        pose_graph.marginal_covariance(solved, **wrong)


def test_estimates_are_as_uncertain_as_they_say():
    """NEES over seeds: the squared error in units of the marginal covariance has its number of entries as mean."""
    pose_nees, landmark_nees, chi2_values = [], [], []
    for seed in range(30):
        log, truth = simulate.fifteen_objects(seed)
        origin = truth.poses[0]
        solved = evaluation.true_association_fit(log, truth)
        seen = np.unique(truth.obs_object)
        chosen = [200, 500, len(truth.poses) - 1]
        pose_cov, landmark_cov = pose_graph.marginal_covariance(solved, chosen, np.arange(len(seen)))
        # The fit starts at the true first pose, so both live in the same frame.
        np.testing.assert_allclose(solved.poses[0], origin)
        error = solved.poses[chosen] - truth.poses[chosen]
        error[:, 2] = se2.wrap(error[:, 2])
        pose_nees.append([e @ np.linalg.solve(c, e) for e, c in zip(error, pose_cov, strict=True)])
        error = solved.landmarks - truth.world.object_xy[seen]
        landmark_nees.append(np.mean([e @ np.linalg.solve(c, e) for e, c in zip(error, landmark_cov, strict=True)]))
        chi2_values.append(evaluation.chi2_per_dof(solved))
    # Each pose's sum over independent seeds is chi-squared; three poses are tested, so 99.9% each.
    for total in np.sum(pose_nees, axis=0):
        low, high = scipy.stats.chi2.interval(0.999, 3 * 30)
        assert low < total < high
    assert np.mean(landmark_nees) == pytest.approx(2.0, abs=0.5)
    assert np.mean(chi2_values) == pytest.approx(1.0, abs=0.02)


@pytest.mark.parametrize("probability", [0.0, 0.5, 0.95, 0.999999])
def test_the_squared_radius_is_a_quantile_of_chi_squared(probability):
    expected = scipy.stats.chi2.ppf(probability, 2)
    assert pose_graph.squared_radius(probability) == pytest.approx(expected, rel=1e-9, abs=1e-12)
