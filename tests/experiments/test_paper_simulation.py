"""The paper's result, on the authors' own data where it is, and on our scene everywhere."""

import numpy as np
import pytest

from npslam_teach import datasets, evaluation, np_graph, pose_graph, simulate
from npslam_teach.cli import reports
from npslam_teach.experiments import paper_simulation
from npslam_teach.methods import METHODS
from npslam_teach.types import RobotLog

ALL = [name for name, method in METHODS.items() if method.in_paper]  # the others have tests of their own


@pytest.fixture(scope="module")
def own():
    """Our scene, twelve rooms."""
    return paper_simulation.run_all(paper_simulation.scenes(None, 1.0, range(12)), ALL, 8, 12)[0]["summary"]


def test_our_scene_tells_the_papers_story(own):
    """The seeds were not chosen: of a method that finds 15 in nine rooms of ten, two in three is far below chance."""
    assert own["np-graph"]["share_exact"] >= 2 / 3
    assert own["np-graph"]["median_mean_pose_error"] < own["open-loop"]["median_mean_pose_error"] / 3
    assert own["np-graph"]["median_mean_object_error"] < own["open-loop"]["median_mean_object_error"] / 3
    assert own["open-loop"]["median_num_objects"] > 100
    assert own["robust-slam"]["median_num_objects"] == 5
    assert own["frame-by-frame"]["median_mean_pose_error"] == own["open-loop"]["median_mean_pose_error"]


def test_the_true_association_fits_our_scene():
    values = [evaluation.chi2_per_dof(evaluation.true_association_fit(*simulate.fifteen_objects(s))) for s in range(8)]
    assert np.mean(values) == pytest.approx(1.0, abs=0.03)


@pytest.fixture(scope="module")
def authors(request):
    return datasets.load_mu2016_simulation(request.getfixturevalue("mu2016_path"))


def test_the_two_traps_of_the_authors_file_are_handled(authors):
    """chi2 with the true association: 2167.8 on 2166 degrees of freedom; an off-by-one gives 2425.9."""
    log, truth = authors
    fit = evaluation.true_association_fit(log, truth)
    assert pose_graph.chi2(fit) == pytest.approx(2167.8, abs=0.05)
    assert evaluation.chi2_per_dof(fit) == pytest.approx(pose_graph.chi2(fit) / 2166, rel=1e-12)
    assert 0.95 < evaluation.chi2_per_dof(fit) < 1.05


def test_an_off_by_one_would_be_found(authors):
    log, truth = authors
    shifted = RobotLog(
        log.odometry,
        np.minimum(log.obs_time + 1, log.num_poses - 1),
        log.obs_xy,
        log.obs_class,
        log.num_classes,
        log.odometry_std,
        log.observation_std,
    )
    assert evaluation.chi2_per_dof(evaluation.true_association_fit(shifted, truth)) > 1.05


def test_the_authors_file_as_it_is(authors):
    log, truth = authors
    snapshots = list(np_graph(log))
    assert [s.num_objects for s in snapshots] == [1098, 24, 17, 15, 15]
    metrics = evaluation.evaluate(snapshots[-1], truth, log)
    assert metrics.mean_pose_error <= 0.055
    assert metrics.mean_object_error <= 0.04
    assert metrics.ari == 1.0
    assert 0.95 < metrics.chi2_per_dof < 1.05


@pytest.mark.slow
def test_the_papers_run_over_thirty_seeds(mu2016_path):
    scenes = paper_simulation.scenes(mu2016_path, 1.0, range(30))
    result, _, _ = paper_simulation.run_all(scenes, ALL, 8, 30)
    summary = result["summary"]
    ours, robust, open_loop = (summary[name] for name in ("np-graph", "robust-slam", "open-loop"))
    assert ours["num_exact"] >= 24
    assert 28 <= ours["median_counts_per_iteration"][1] <= 45
    assert 17 <= ours["median_counts_per_iteration"][2] <= 28
    assert ours["median_mean_pose_error"] <= 0.095
    assert 3 * ours["median_mean_pose_error"] <= robust["median_mean_pose_error"]
    assert 3 * ours["median_mean_pose_error"] <= open_loop["median_mean_pose_error"]
    assert robust["median_mean_pose_error"] <= 1.1 * open_loop["median_mean_pose_error"]
    assert open_loop["median_num_objects"] > 100
    assert robust["median_num_objects"] == 5


def test_three_times_the_noise_is_too_much_and_is_reported_as_that(mu2016_path):
    result, _, _ = paper_simulation.run_all(paper_simulation.scenes(mu2016_path, 3.0, range(3)), ["np-graph"], 8, 3)
    assert result["summary"]["np-graph"]["num_exact"] == 0
    assert "exactly 15 objects: 0 of 3 runs" in reports.reproduce_text(result)


def test_the_office_log_can_be_solved(stata_path):
    log = datasets.load_stata_office(stata_path)
    *_, last = np_graph(log)
    assert 10 < last.num_objects < log.num_observations / 2
    assert np.isfinite(last.graph.poses).all()
