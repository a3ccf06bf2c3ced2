"""The graphs that are solved: standard ones where their files are, and houses of 1 to 100 rooms."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from npslam_teach import datasets, evaluation, simulate
from npslam_teach.datasets.g2o import turned_information
from npslam_teach.types import PoseGraph

STANDARD = ("intel", "manhattan", "victoria_park")
ROOMS = (1, 10, 100)


def standard_graph(name: str, folder: Path) -> PoseGraph:
    """A graph of the literature, from its start in the file."""
    return datasets.load_g2o(folder / f"{name}.g2o")


def house_graph(num_rooms: int, seed: int = 0) -> PoseGraph:
    """The house with its true associations; the start is the solution, disturbed by 2 cm and 0.005 rad everywhere.

    From dead reckoning, over 7 km off by many turns, and even from the true path, the first step of a plain
    Gauss-Newton overshoots, and not every solver goes on from there. Sightings from less than a metre are left out: the
    bearing, which gtsam must use, says nothing where the robot drives through an object.
    """
    log, truth = simulate.grid_of_rooms(num_rooms, seed)
    rng = np.random.default_rng(seed)
    far = np.linalg.norm(log.obs_xy, axis=1) > 1.0
    log = replace(log, obs_time=log.obs_time[far], obs_xy=log.obs_xy[far], obs_class=log.obs_class[far])
    truth = replace(truth, obs_object=truth.obs_object[far])
    solved = evaluation.true_association_fit(log, truth)
    poses = solved.poses + rng.normal(size=solved.poses.shape) * [0.02, 0.02, 0.005]
    poses[0] = solved.poses[0]
    return replace(solved, poses=poses, landmarks=solved.landmarks + rng.normal(size=solved.landmarks.shape) * 0.02)


def save(graph: PoseGraph, path: Path) -> None:
    """The arrays of a graph, as every solver is given them.

    Ours measures the error of a step in the frame of its first pose, all others in that of its second: they get the
    same information, turned.
    """
    between, sightings = graph.between, graph.observations
    np.savez(
        path,
        poses=graph.poses,
        landmarks=graph.landmarks,
        i=between.i,
        j=between.j,
        relative_pose=between.relative_pose,
        pose_information=between.information,
        pose_information_at_j=turned_information(between, -1).information,
        pose=sightings.pose,
        landmark=sightings.landmark,
        xy=sightings.xy,
        point_information=sightings.information,
    )
