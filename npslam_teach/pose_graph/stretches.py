"""The leaves and the joints of ``submap_tree``: a few poses in a row, and two submaps put together.

Both know how to condense themselves into a ``Submap``, and how to find their own variables again once those of the
submap are known. A stretch is linear around the values that it had when it was full or when the tree was linearized
anew; a joint around those of its two children, whatever it was told since. Were one submap linear around what is
believed today and the next around what was believed yesterday, the two would disagree about lever arms, and the sum
would hold information about headings that no measurement has given (Huang, Mourikis and Roumeliotis,
"Observability-based rules for designing consistent EKF SLAM estimators", 2010).
"""

from collections.abc import Callable

import numpy as np

from npslam_teach import se2
from npslam_teach.pose_graph.residuals import (
    between_jacobians,
    between_residual,
    observation_jacobians,
    observation_residual,
)
from npslam_teach.pose_graph.submaps import (
    Submap,
    add_up,
    carried,
    eliminate,
    seen_from_seam,
    variables,
)

# Of landmarks (k,), those asked for from outside of the leaves first .. last: (ids, first, last + 1) -> (k,) bool.
Kept = Callable[[np.ndarray, int, int], np.ndarray]

LARGEST_TURN = 0.05  # rad, by which a pose of a stretch may turn before the stretch is linearized anew
NONLINEAR = 0.3  # of chi2, by which a joint's linear model may be off before the tree is linearized anew
MOVED = 1e-3  # m or rad: what has moved less within its stretch need not be linearized anew


class Stretch:
    """Steps of odometry in a row and what was seen after each of them; the frame is the pose before the first."""

    def __init__(self, begin: int):
        """An empty one, the leaf of this index."""
        self.begin, self.end = begin, begin + 1
        self.parent, self.stale, self.part, self.grows = None, True, None, True
        self.anew, self.has_moved = True, False  # to be linearized; whether what was told last is elsewhere
        self.steps, self.step_roots = [], []  # (3,), and L^T (3, 3) of the information L L^T
        self.sights = []  # (pose, id, xy, L^T)
        self.ids = np.zeros(0, dtype=int)
        self.poses, self.xy = np.zeros((1, 3)), np.zeros((0, 2))  # in S, as told last; row 0 is S itself
        self._around = self.poses, self.xy  # where it is linear

    def add_step(self, step: np.ndarray, root: np.ndarray) -> None:
        """Drive on by (3,); root (3, 3) is L^T of its information L L^T."""
        self.steps.append(step)
        self.anew = True
        self.step_roots.append(root)
        self.poses = np.vstack([self.poses, carried(self.poses[-1], step)])

    def add_sight(self, landmark: int, xy: np.ndarray, root: np.ndarray) -> None:
        """A landmark is seen from the newest pose at (2,); root (2, 2) as above."""
        self.sights.append((len(self.steps), landmark, xy, root))
        self.anew = True
        if landmark not in self.ids:
            self.ids = np.append(self.ids, landmark)
            self.xy = np.vstack([self.xy, se2.apply(self.poses[-1], xy)])

    def rename(self, gone: int, stays: int) -> None:
        """What was one landmark is another, which may be here already."""
        self.sights = [(pose, stays if each == gone else each, *rest) for pose, each, *rest in self.sights]
        if stays in self.ids:
            kept = self.ids != gone
            poses, xy = self._around
            self.ids, self.xy, self._around = self.ids[kept], self.xy[kept], (poses, xy[kept[: len(xy)]])
        else:
            self.ids = np.where(self.ids == gone, stays, self.ids)

    def condense(self, kept: Kept) -> None:
        """Linearize, and eliminate all poses but the last and the landmarks that nobody asks for."""
        if self.grows or self.anew:
            self._around, self.anew = (self.poses, self.xy), False
        poses, xy = self._around
        jacobian, residual = self._rows()
        count = len(self.steps)
        information, gradient = jacobian.T @ jacobian, jacobian.T @ residual
        if count == 0:  # the last pose is S itself: it stays where it is, whatever its weight
            information[:3, :3], count = np.eye(3), 1
        asked = kept(self.ids, self.begin, self.end)
        self._inside = np.append(np.arange(3 * count - 3), variables(np.flatnonzero(~asked), 3 * count))
        self._outside = np.append(np.arange(3 * count - 3, 3 * count), variables(np.flatnonzero(asked), 3 * count))
        self._lin = np.concatenate([poses[-count:].ravel(), xy.ravel()])
        self._left = eliminate(information, gradient, float(residual @ residual), self._inside, self._outside)
        left = self._left
        at = self._lin[self._outside]
        self.part = Submap(self.ids[asked], at, left.gradient, left.information, left.constant)
        self.stale, self._gone = False, np.flatnonzero(~asked)

    def told(self, outside: np.ndarray) -> bool:
        """Find all values when those of ``part`` are (n,); whether to linearize around them would matter."""
        values = self._lin.copy()
        moved = self.part.difference(outside)
        values[self._inside] += self._left.inside(moved)
        values[self._outside] = self.part.at + moved
        count = (len(values) - 2 * len(self.xy)) // 3
        moved = np.abs(values - self._lin)
        self.has_moved = bool(moved.max() > MOVED)
        self.poses = np.concatenate([self.poses[:-count], values[: 3 * count].reshape(-1, 3)])
        self.xy = values[3 * count :].reshape(-1, 2)
        return not self.grows and float(moved[2 : 3 * count : 3].max()) > LARGEST_TURN

    def landmarks_here(self) -> tuple[np.ndarray, np.ndarray]:
        """The landmarks that were eliminated here, (g,) and (g, 2) m in S."""
        return self.ids[self._gone], self.xy[self._gone]

    def _rows(self) -> tuple[np.ndarray, np.ndarray]:
        """The whitened Jacobian (R, N) and residuals (R,) of all factors."""
        (poses, _), count, size = self._around, len(self.steps), max(3 * len(self.steps), 3)
        jacobian = np.zeros((3 * count + 2 * len(self.sights), size + 2 * len(self.ids)))
        residual = np.zeros(len(jacobian))
        if count:
            roots = np.array(self.step_roots)
            ends, steps = (poses[:-1], poses[1:]), np.arange(count)
            by_i, by_j = between_jacobians(*ends)
            blocks = jacobian[: 3 * count, :size].reshape(count, 3, count, 3)
            blocks[steps, :, steps] = roots @ by_j
            blocks[steps[1:], :, steps[:-1]] = (roots @ by_i)[1:]
            off = between_residual(*ends, np.array(self.steps))
            residual[: 3 * count] = (roots @ off[:, :, None]).ravel()
        if self.sights:
            self._fill_sights(jacobian[3 * count :], residual[3 * count :], size)
        return jacobian, residual

    def _fill_sights(self, jacobian: np.ndarray, residual: np.ndarray, size: int) -> None:
        pose, landmark, xy, roots = (np.array(column) for column in zip(*self.sights, strict=True))
        order = np.argsort(self.ids)
        place = order[np.searchsorted(self.ids, landmark, sorter=order)]
        poses, places = self._around[0][pose], self._around[1][place]
        by_pose, by_landmark = observation_jacobians(poses, places)
        off = observation_residual(poses, places, xy)
        residual[:] = (roots @ off[:, :, None]).ravel()
        rows = 2 * np.arange(len(pose))[:, None, None] + np.array([[0], [1]])
        jacobian[rows, size + 2 * place[:, None, None] + np.array([0, 1])] = roots @ by_landmark
        free = pose > 0
        columns = 3 * (pose[free, None, None] - 1) + np.array([0, 1, 2])
        jacobian[rows[free], columns] = (roots @ by_pose)[free]


class Joint:
    """Two submaps that follow one another."""

    def __init__(self, left, right):
        """Of two stretches or joints, of which the right begins where the left ends."""
        self.left, self.right = left, right
        self.begin, self.end = left.begin, right.end
        left.parent = right.parent = self
        self.parent, self.stale, self.part = None, True, None

    def condense(self, kept: Kept) -> None:
        """Add both up, and eliminate the seam and the landmarks that nobody asks for."""
        first, second = self.left.part, self.right.part
        ids = np.union1d(first.ids, second.ids)
        self._places = np.searchsorted(ids, first.ids), np.searchsorted(ids, second.ids)
        self._lin = self._around(len(ids))
        self._seam = seam = add_up(first, second, self._places, self._lin)
        asked = kept(ids, self.begin, self.end)
        self._inside = np.append([3, 4, 5], variables(np.flatnonzero(~asked), 6))
        self._outside = np.append([0, 1, 2], variables(np.flatnonzero(asked), 6))
        self._left = left = eliminate(seam.information, seam.gradient, seam.constant, self._inside, self._outside)
        at = self._lin[self._outside]
        self.part = Submap(ids[asked], at, left.gradient, left.information, left.constant)
        self.stale, self._values = False, self._lin
        self._gone = ids[~asked], variables(np.flatnonzero(~asked), 6)
        self.seam_pose, self.of_right = self._lin[3:6], seam.local

    def told(self, outside: np.ndarray) -> bool:
        """Find all values when those of ``part`` are (n,); whether to linearize around them would matter."""
        values = self._lin.copy()
        moved = self.part.difference(outside)
        values[self._inside] += self._left.inside(moved)
        values[self._outside] = self.part.at + moved
        self._values = values
        seam, own = self._seam, self._seam.of_second
        self.seam_pose = values[3:6]
        self.of_right, _ = seen_from_seam(values[own])
        moved = values[own] - self._lin[own]
        off = self.of_right - seam.local - seam.jacobian @ moved
        off[2] = 0.0  # headings add up: nothing to linearize
        return float(off @ (self.right.part.information @ off)) > NONLINEAR

    def of_left(self) -> np.ndarray:
        """What the left child is told (n,)."""
        return self._values[np.append([3, 4, 5], variables(self._places[0], 6))]

    def landmarks_here(self) -> tuple[np.ndarray, np.ndarray]:
        """The landmarks that were eliminated here, (g,) and (g, 2) m in S."""
        return self._gone[0], self._values[self._gone[1]].reshape(-1, 2)

    def _around(self, count: int) -> np.ndarray:
        """Values (6 + 2 count,) around which the children are linear; for landmarks of both, the first's."""
        first, second = self.left.part.at, self.right.part.at
        values, carried_over = np.empty(6 + 2 * count), carried(first[:3], second)
        values[:3], values[3:6] = carried_over[:3], first[:3]
        values[variables(self._places[1], 6)] = carried_over[3:]
        values[variables(self._places[0], 6)] = first[3:]
        return values


def mark(node) -> None:
    """A stretch or joint has changed, and all above it with it."""
    node.stale = False
    while node is not None and not node.stale:
        node.stale, node = True, node.parent


def linearize(leaves: list[Stretch]) -> None:
    """Have some stretches linear around where they are."""
    for leaf in leaves:
        leaf.anew = True
        mark(leaf)


def condense(node, kept: Kept) -> int:
    """Condense what is stale, from the leaves up; how many nodes that were."""
    if not node.stale:
        return 0
    below = sum(condense(child, kept) for child in (node.left, node.right)) if isinstance(node, Joint) else 0
    node.condense(kept)
    return below + 1


def size(node) -> int:
    """How many leaves there are in it."""
    return node.end - node.begin
