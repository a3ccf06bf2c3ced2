"""Where each variable stands in the step dx, and how a graph moves by a step.

The unknowns are the world coordinates ``[x, y, theta]`` of the free poses, in their order, and then ``[x, y]`` of the
free landmarks, or ``[x, y, theta]`` where these have headings. Whatever is fixed is left out: at least one variable has
to be, because the whole map could be shifted and turned without any measurement noticing. Fixing one pose removes this
freedom, the *gauge*.
"""

import copy
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from npslam_teach import se2
from npslam_teach.pose_graph.block_sparsity import FIXED
from npslam_teach.types import PoseGraph
from npslam_teach.validation import LARGEST, checked_array

VARIABLES = {"poses": "pose", "landmarks": "landmark"}  # the fields of a graph that hold variables, and one of each


@dataclass(frozen=True, eq=False)
class Unknowns:
    """The layout of dx for one graph."""

    free: dict[str, np.ndarray]  # by variable: the indices of the free ones, in the order of dx
    block: dict[str, np.ndarray]  # by variable: (T,) or (K,), the place among all free variables, or FIXED
    sizes: np.ndarray  # (N,) how many unknowns each free variable has

    @property
    def count(self) -> int:
        """n, the length of dx."""
        return int(self.sizes.sum())

    def of(self, variable: str, index: np.ndarray, size: int) -> np.ndarray:
        """The unknowns of some variables of one kind, (B, size); FIXED for those that have none.

        Args:
            variable: "poses" or "landmarks".
            index: (B,) which.
            size: how many each has.
        """
        block = self.block[variable][index][:, None]
        starts = np.append(np.cumsum(self.sizes) - self.sizes, 0)
        return np.where(block == FIXED, FIXED, starts[block] + np.arange(size))

    def flatten(self, by_variable: dict[str, np.ndarray]) -> np.ndarray:
        """Numbers (T, 3) of all poses and (K, 2) of all landmarks in the order of dx; those of fixed ones drop out."""
        return np.concatenate([by_variable[name][free].ravel() for name, free in self.free.items()])


def unknowns_of(graph: PoseGraph) -> Unknowns:
    """Work out the layout of dx."""
    fixed = (graph.fixed_poses, graph.fixed_landmarks)
    return _unknowns(graph.poses.shape, graph.landmarks.shape, *(tuple(index.tolist()) for index in fixed))


@lru_cache(maxsize=8)  # a solver asks again and again for that of one graph
def _unknowns(pose_shape: tuple, landmark_shape: tuple, fixed_poses: tuple, fixed_landmarks: tuple) -> Unknowns:
    free, block, sizes, num_before = {}, {}, [], 0
    for name, (count, size), fixed in (
        ("poses", pose_shape, fixed_poses),
        ("landmarks", landmark_shape, fixed_landmarks),
    ):
        is_free = np.ones(count, dtype=bool)
        is_free[list(fixed)] = False
        free[name], block[name] = np.flatnonzero(is_free), np.full(count, FIXED)
        block[name][is_free] = num_before + np.arange(len(free[name]))
        sizes.append(np.full(len(free[name]), size))
        num_before += len(free[name])
    return Unknowns(free, block, np.concatenate(sizes))


def steps_by_variable(graph: PoseGraph, dx: np.ndarray) -> dict[str, np.ndarray]:
    """What a step (n,) does to every variable: (T, 3) of the poses and (K, 2) of the landmarks, zero where fixed."""
    steps, begin = {}, 0
    for name, free in unknowns_of(graph).free.items():
        steps[name] = np.zeros_like(getattr(graph, name))
        end = begin + steps[name][free].size
        steps[name][free] = dx[begin:end].reshape(steps[name][free].shape)
        begin = end
    return steps


def retract(graph: PoseGraph, dx: np.ndarray) -> PoseGraph:
    """The graph after a step: dx (n,) is added to the world coordinates, and the headings are wrapped."""
    steps = steps_by_variable(graph, dx)
    poses = graph.poses + steps["poses"]
    poses[:, 2] = se2.wrap(poses[:, 2])
    as_given = graph.fixed_poses[np.abs(graph.poses[graph.fixed_poses, 2]) <= np.pi]
    poses[as_given] = graph.poses[as_given]  # to the last bit
    landmarks = graph.landmarks + steps["landmarks"]
    if landmarks.shape[1] == 3:
        landmarks[:, 2] = se2.wrap(landmarks[:, 2])
        landmarks[graph.fixed_landmarks] = graph.landmarks[graph.fixed_landmarks]
    return with_estimates(graph, poses, landmarks)


def within_bounds(numbers: np.ndarray) -> bool:
    """Whether a step (n,) or positions, in m, leave room for what ``PoseGraph`` accepts; infinite ones do not."""
    return bool(np.abs(numbers).max(initial=0.0) < LARGEST / 10)


def with_estimates(graph: PoseGraph, poses: np.ndarray, landmarks: np.ndarray) -> PoseGraph:
    """The same factors with other poses (T, 3) and landmarks (K, 2): only these are checked, not all once more."""
    moved = copy.copy(graph)
    for name, estimates in (("poses", poses), ("landmarks", landmarks)):
        object.__setattr__(moved, name, checked_array(name, estimates, getattr(graph, name).shape))
    return moved


def named(graph: PoseGraph, variable: str, index: int) -> str:
    """What a pose or landmark is called, such as "pose 3": by its id in the file it comes from, or by its index.

    Args:
        graph: that has it.
        variable: "poses" or "landmarks".
        index: which.
    """
    ids = graph.pose_ids if variable == "poses" else graph.landmark_ids
    return f"{VARIABLES[variable]} {index if ids is None else ids[index]}"


def name_of(graph: PoseGraph, unknown: int) -> str:
    """The variable that one of the n unknowns belongs to, such as "pose 3"."""
    for name, free in unknowns_of(graph).free.items():
        size = getattr(graph, name).shape[1]
        if unknown < size * len(free):
            return named(graph, name, free[unknown // size])
        unknown -= size * len(free)
    raise IndexError("unknown: expected one of the unknowns of the graph, got one beyond")
