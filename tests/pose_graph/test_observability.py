"""What the factors do not determine is refused, and named."""

from dataclasses import replace

import numpy as np
import pytest
from graphs import random_graph

from npslam_teach import pose_graph, se2
from npslam_teach.pose_graph import factorization, levenberg_marquardt
from npslam_teach.pose_graph.linearization import linear_system
from npslam_teach.types import BetweenFactors, ObservationFactors, PoseGraph

LIBRARIES = [
    "superlu",
    pytest.param("qdldl", marks=pytest.mark.skipif(not factorization.has_qdldl(), reason="no qdldl")),
]


def test_a_singular_graph_is_refused_with_words():
    graph = random_graph(0, num_landmarks=0, num_loops=0)
    nothing = replace(graph.between, information=np.zeros_like(graph.between.information))
    with pytest.raises(np.linalg.LinAlgError, match="H is singular"):
        pose_graph.optimize(replace(graph, between=nothing))


def test_a_landmark_that_nobody_sees_is_named():
    graph = random_graph(5)
    lonely = replace(graph, landmarks=np.vstack([graph.landmarks, [[9.0, 9.0]]]))
    with pytest.raises(np.linalg.LinAlgError, match="landmark 4 is not tied to pose 0"):
        pose_graph.optimize(lonely)


def test_a_pose_cut_off_from_the_rest_is_named():
    graph = random_graph(5, num_landmarks=0, num_loops=0)
    keep = np.arange(len(graph.between.i)) != 6
    b = graph.between
    cut = replace(graph, between=BetweenFactors(b.i[keep], b.j[keep], b.relative_pose[keep], b.information[keep]))
    with pytest.raises(np.linalg.LinAlgError, match="pose 7 is not tied to pose 0"):
        pose_graph.optimize(cut)


def chain_and_a_loose_pose(seed, num_poses=12):
    """A chain whose last pose is tied to the rest by nothing but one object: it can circle around it."""
    graph = random_graph(seed, num_poses, num_landmarks=2)
    between, sightings = graph.between, graph.observations
    last = num_poses - 1
    kept = (between.i != last) & (between.j != last)
    seen = (sightings.pose != last) | (sightings.landmark == 0)
    return PoseGraph(
        graph.poses,
        graph.landmarks,
        BetweenFactors(*(getattr(between, name)[kept] for name in ("i", "j", "relative_pose", "information"))),
        ObservationFactors(*(getattr(sightings, name)[seen] for name in ("pose", "landmark", "xy", "information"))),
    )


@pytest.mark.parametrize("library", LIBRARIES)
@pytest.mark.parametrize("num_poses", [12, 2000])
def test_a_pose_that_can_circle_around_an_object_is_named(num_poses, library):
    graph = chain_and_a_loose_pose(3, num_poses)
    with pytest.raises(np.linalg.LinAlgError, match=f"pose {num_poses - 1} is not determined .* H is singular"):
        list(levenberg_marquardt(graph, system=linear_system(graph, library)))


def test_a_landmark_seen_in_one_direction_only_is_named():
    graph = random_graph(6, num_landmarks=3)
    information = graph.observations.information.copy()
    information[graph.observations.landmark == 1] = 0.0
    information[np.flatnonzero(graph.observations.landmark == 1)[0]] = [[4.0, 2.0], [2.0, 1.0]]
    blind = replace(graph, observations=replace(graph.observations, information=information))
    with pytest.raises(np.linalg.LinAlgError, match="landmark 1 is not determined"):
        pose_graph.optimize(blind)
    with pytest.raises(np.linalg.LinAlgError, match="landmark 1 is not determined"):
        pose_graph.marginal_covariance(blind, landmarks=[0])


@pytest.mark.parametrize("library", LIBRARIES)
def test_a_long_open_chain_is_uncertain_but_not_singular(library):
    """Its far end is known a hundred million times worse than a single step: no reason to refuse it."""
    num_poses = 30_000
    steps = np.tile([1.0, 0.0, 0.0], (num_poses - 1, 1))
    i = np.arange(num_poses - 1)
    factors = BetweenFactors(i, i + 1, steps, np.tile(np.diag([1e4, 1e4, 1e4]), (num_poses - 1, 1, 1)))
    nothing = ObservationFactors([], [], np.zeros((0, 2)), np.zeros((0, 2, 2)))
    start = se2.dead_reckoning(steps) + np.random.default_rng(0).normal(0, 1e-3, (num_poses, 3))
    start[0] = 0.0
    graph = PoseGraph(start, np.zeros((0, 2)), factors, nothing)
    *_, last = levenberg_marquardt(graph, system=linear_system(graph, library))
    assert last.converged
    assert last.chi2 < 1e-3
