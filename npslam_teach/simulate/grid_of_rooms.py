"""A grid of rooms, each like that of the fifteen objects, to measure how methods scale."""

from dataclasses import replace

import numpy as np

from npslam_teach.simulate.fifteen_objects import FIFTEEN_CLASSES, designed_path, scattered_world
from npslam_teach.simulate.robot_run import follow, paper_sensor, simulate_run
from npslam_teach.types import GroundTruth, RobotLog, World

ROOM = 14.0  # m, from one room to the next
POSES_PER_ROOM = 766  # as many as the paper's whole run


def grid_of_rooms(num_rooms: int, seed: int = 0, noise: float = 0.0) -> tuple[RobotLog, GroundTruth]:
    """Any number of rooms, each with fifteen objects and 766 poses: the size grows and the density stays the same.

    Rooms lie on a square grid and are visited row by row, to the right and back. In each the robot drives the designed
    path of ``fifteen_objects``; then it crosses the room to reach the next. It also sees a little into the row beside
    it. The detector misses some objects, so that the number of observations per room is the paper's, about 1100.

    Args:
        num_rooms: 1 is about the size of the paper's run, 100 is 76,600 poses and 1,500 objects.
        seed: of ``numpy.random.default_rng``: objects and noise.
        noise: 1 is the paper's; see ``paper_sensor``.
    """
    if int(num_rooms) != num_rooms or num_rooms < 1:
        raise ValueError(f"num_rooms: expected a positive integer, got {num_rooms}")
    rng = np.random.default_rng(seed)
    corners = room_corners(int(num_rooms))
    rooms = [scattered_world(3, FIFTEEN_CLASSES, rng) for _ in corners]
    object_xy = np.concatenate([corner + room.object_xy for corner, room in zip(corners, rooms, strict=True)])
    world = World(object_xy, np.concatenate([room.object_class for room in rooms]), FIFTEEN_CLASSES)
    sensor = replace(paper_sensor(noise), detection_probability=0.85)
    return simulate_run(world, house_path(corners), sensor, rng)


def room_corners(num_rooms: int) -> np.ndarray:
    """Lower left corners (N, 2) m of the rooms in the order of the visit: along one row, and back along the next."""
    row, step = np.divmod(np.arange(num_rooms), int(np.ceil(np.sqrt(num_rooms))))
    column = np.where(row % 2 == 0, step, int(np.ceil(np.sqrt(num_rooms))) - 1 - step)
    return ROOM * np.column_stack([column, row])


def house_path(corners: np.ndarray) -> np.ndarray:
    """The designed path in one room after another: (766 N, 3) poses in W, evenly spaced."""
    line = np.concatenate([corner + designed_path()[:, :2] for corner in corners])
    length = np.linalg.norm(np.diff(line, axis=0), axis=1).sum()
    num_poses = POSES_PER_ROOM * len(corners)
    return follow(line, length / (num_poses - 1) * (1 - 1e-12))[:num_poses]
