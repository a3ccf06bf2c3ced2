"""A pose graph that grows with the drive, in little time per frame: a binary tree of submaps.

The drive is cut into stretches of a few poses. Each is condensed into a quadratic form in its last pose and in those
landmarks that are seen from outside (``submaps``), two neighbours into that of both, and so on up to the whole drive: a
nested dissection in time; the tree grows like a binary counter. A frame changes the newest stretch alone, and only its
joint with all before is done again, whatever the length of the drive. An old landmark that comes into view again, or
turns out to be another, is kept on the way from where it was eliminated up to the top: log2(T / 32) joints. Estimates
of the past are found from the top down. Treemap does the same over space (Frese 2006).

Where a joint's linear model no longer holds, all that has moved within its stretch is linearized anew at once, as iSAM
does (Kaess, Ranganathan and Dellaert, 2008): piece by piece the tree would hold information that nobody has measured,
and swing about its minimum. That frame takes time in proportion to what has moved; of a large tree it is one in
``SELDOM`` at most. In all others a joint costs O(b^3) for b landmarks that both sides share with the rest: in a
building driven row by row those seen from two rows, which grow with its width, not with the drive.
"""

import numpy as np

from npslam_teach import se2
from npslam_teach.pose_graph.factor_lists import FactorLists
from npslam_teach.pose_graph.linearization import chi2
from npslam_teach.pose_graph.multi_start import optimize
from npslam_teach.pose_graph.rows import Rows
from npslam_teach.pose_graph.stretches import Joint, Stretch, condense, linearize, mark, size
from npslam_teach.pose_graph.submaps import Submap, carried, turned_back
from npslam_teach.types import PoseGraph
from npslam_teach.validation import checked_array, checked_index

STRETCH, WALK = 32, 32  # poses; steps per frame towards the past
FEW, SELDOM, MOST_IN_A_ROW = 64, 120, 3  # a tree of more stretches waits so many frames, or has not waited so often
MOST_PASSES, NEAR = 10, 1e-6  # of ``finish``; relative change of chi2 after which the tree is left


class SubmapTree:
    """The graph of a drive under way; pose 0 is the origin, and held still.

    >>> tree = SubmapTree()
    >>> chair = tree.add_landmark([2.0, 1.0])
    >>> tree.add_observation(chair, [2.0, 1.0], np.diag([50.0, 50.0]))
    >>> here = tree.add_pose([0.5, 0.0, 0.1], np.diag([400.0, 400.0, 900.0]))
    >>> tree.solve()
    array([0.5, 0. , 0.1])
    """

    def __init__(self, stretch: int = STRETCH):
        """With so many poses in a stretch."""
        self._length = stretch
        self._top = self._open = Stretch(0)
        self._whole, self._spine = [], []  # complete trees, ever smaller; the joints of the first one, two, three ...
        self._leaves, self._walk, self._bent = [self._open], [], []
        self._xy, self._first, self._last = Rows((2,)), Rows(dtype=int), Rows(dtype=int)
        self._active, self._became, self._leaves_of = Rows(dtype=bool), Rows(dtype=int), []
        self._factors = FactorLists()
        self.pose, self.redone = np.zeros(3), 0  # (3,) W, the newest; stretches and joints condensed so far
        self._credit = float(MOST_IN_A_ROW)  # how often all may be linearized anew now

    def add_pose(self, relative_pose: np.ndarray, information: np.ndarray) -> int:
        """Drive one step.

        Args:
            relative_pose: (3,) m, m, rad: the new pose in the frame of the newest.
            information: (3, 3) of the step.

        Returns:
            the index of the new pose.
        """
        step, root = self._factors.add_step(relative_pose, information)
        if len(self._open.steps) == self._length:
            self._close()
        self._open.add_step(step, root)
        mark(self._open)
        self.pose = carried(self.pose, step)
        return self._factors.num_poses - 1

    def add_landmark(self, xy: np.ndarray) -> int:
        """A new landmark, (2,) m in W, which is active; returns its index."""
        index, values = len(self._leaves_of), (checked_array("xy", xy, (2,)), len(self._leaves), -1, True)
        for rows, value in zip((self._xy, self._first, self._last, self._active), values, strict=True):
            rows.append(value)
        self._became.append(index)
        self._leaves_of.append([])
        return index

    def add_observation(self, landmark: int, xy: np.ndarray, information: np.ndarray) -> None:
        """A landmark is seen from the newest pose.

        Args:
            landmark: its index; not one that has become another.
            xy: (2,) m, in the frame of the pose.
            information: (2, 2).
        """
        checked_index("landmark", landmark, len(self._leaves_of))
        xy, root = self._factors.add_sight(landmark, xy, information)
        leaf, first, last = self._open, self._first.array, self._last.array
        leaf.add_sight(landmark, xy, root)
        if last[landmark] < leaf.begin:
            self._leaves_of[landmark].append(leaf)
            last[landmark], first[landmark] = leaf.begin, min(first[landmark], leaf.begin)
            self._lift(landmark)
        mark(leaf)

    def activate(self, landmarks: np.ndarray, active: bool = True) -> None:
        """Have landmarks (k,) among the variables of ``front``, or no longer."""
        for landmark in landmarks:
            is_new, self._active.array[landmark] = active and not self._active.array[landmark], active
            if is_new:
                self._lift(landmark)

    def merge(self, gone: int, stays: int) -> None:
        """What were two landmarks is one."""
        self._lift(stays)
        for leaf in self._leaves_of[gone]:
            leaf.rename(gone, stays)
            mark(leaf)
            if leaf not in self._leaves_of[stays]:
                self._leaves_of[stays].append(leaf)
        self._first.array[stays] = min(self._first.array[stays], self._first.array[gone])
        self._last.array[stays] = max(self._last.array[stays], self._last.array[gone])
        self._lift(stays)
        self._active.array[stays] |= self._active.array[gone]
        self._active.array[gone], self._leaves_of[gone] = False, []
        became = self.became()
        became[became == gone] = stays

    def front(self) -> Submap:
        """The newest pose and the active landmarks in W, everything else at its best: what a new frame is about."""
        self.redone += condense(self._top, self._is_asked_for)
        return self._top.part

    def solve(self, walk: int = WALK) -> np.ndarray:
        """The newest pose (3,) at the minimum; and ``walk`` steps towards all others."""
        self.tell(self.front().minimum(), walk)
        return self.pose

    def tell(self, values: np.ndarray, walk: int = WALK) -> None:
        """Take values for the variables of ``front`` (n,), and go ``walk`` steps on towards those of the past."""
        self._take(values, walk)
        self._keep_linear()

    def _take(self, values: np.ndarray, walk: int) -> None:
        self._top.frame = np.zeros(3)
        self._inform(self._top, values)
        self.pose, self._xy.array[self._top.part.ids] = turned_back(values[:3].copy(), 2), values[3:].reshape(-1, 2)
        if self._top is not self._open:
            self._visit(self._open)
        for _ in range(walk):
            if not self._walk:
                self._walk = [] if self._top is self._open else [self._top.left]
                break
            self._visit(self._walk.pop())

    def landmarks(self) -> np.ndarray:
        """(N, 2) m, W: where each stands as far as is known now; of those that became another, as they were then."""
        return self._xy.array

    def is_active(self) -> np.ndarray:
        """(N,) bool: which landmarks are variables of ``front``."""
        return self._active.array

    def became(self) -> np.ndarray:
        """(N,) which landmark each is now: another where they were merged, or itself."""
        return self._became.array

    def graph(self) -> tuple[PoseGraph, np.ndarray]:
        """Everything, told from the top down; and the landmark of each index, (N,) -1 = unseen."""
        if self._top.stale:
            self._take(self.front().minimum(), 0)  # not ``solve``: what that linearizes anew would be stale again
        self._walk_all()
        poses = [np.zeros((1, 3)), *(se2.compose(leaf.frame, leaf.poses[1:]) for leaf in self._leaves)]
        return self._factors.graph(np.concatenate(poses), self.landmarks(), self.became())

    def finish(self, tolerance: float = 1e-13) -> PoseGraph:
        """The graph at its minimum: linearized anew as a whole, and the last digits left to ``optimize``.

        Args:
            tolerance: of ``optimize``.
        """
        (graph, _), before = self.graph(), np.inf
        for _ in range(MOST_PASSES):
            if abs(before - (now := chi2(graph))) <= NEAR * (1.0 + now):
                break
            before, graph = now, self.linearized_anew()
        return optimize(graph, tolerance)

    def linearized_anew(self) -> PoseGraph:
        """The graph after one step of Gauss and Newton on the whole tree: time in proportion to the drive."""
        self.graph()
        linearize(self._leaves)
        return self.graph()[0]

    def _walk_all(self) -> None:
        """Tell everything what the top was told."""
        self._walk = [self._open] if self._top is self._open else [self._top.left]
        while self._walk:
            self._visit(self._walk.pop())

    def _keep_linear(self) -> None:
        """Linearize anew the stretches that are bent, or all that have moved if a joint is."""
        self._credit = min(self._credit + 1.0 / SELDOM, MOST_IN_A_ROW)
        leaves = [node for node in self._bent if isinstance(node, Stretch)]
        if len(leaves) < len(self._bent) and (self._credit >= 1.0 or len(self._leaves) <= FEW):
            self._walk_all()
            leaves = [leaf for leaf in self._leaves if leaf.has_moved]
            self._credit = max(self._credit - 1.0, 0.0)
        linearize(leaves)
        self._bent = []

    def _close(self) -> None:
        """The newest stretch is full: it becomes a leaf, and trees of one size become one of twice the size."""
        self._open.grows = False
        self._whole.append(self._open)
        while len(self._whole) > 1 and size(self._whole[-1]) == size(self._whole[-2]):
            self._whole[-2:] = [Joint(*self._whole[-2:])]
        del self._spine[len(self._whole) - 1 :]
        for tree in self._whole[len(self._spine) :]:
            self._spine.append(Joint(self._spine[-1], tree) if self._spine else tree)
        self._open = Stretch(len(self._leaves))
        self._leaves.append(self._open)
        self._top, self._walk = Joint(self._spine[-1], self._open), []

    def _lift(self, landmark: int) -> None:
        """A landmark is asked for by more than before: it must not be eliminated where it was."""
        node = next(iter(self._leaves_of[landmark]), None)
        while node is not None and not node.stale and landmark in node.part.ids:
            node = node.parent
        if node is not None and not node.stale:
            mark(node)

    def _is_asked_for(self, ids: np.ndarray, begin: int, end: int) -> np.ndarray:
        """Which landmarks (k,) are seen from other leaves than begin .. end - 1, or active: (k,) bool."""
        return self._active.array[ids] | (self._first.array[ids] < begin) | (self._last.array[ids] >= end)

    def _visit(self, node) -> None:
        """Tell a node what its parent knows; the next ones on the walk are its children."""
        if node.stale:
            return
        parent = node.parent
        if parent is not None:
            is_left = node is parent.left
            node.frame = parent.frame if is_left else carried(parent.frame, parent.seam_pose)
            self._inform(node, parent.of_left() if is_left else parent.of_right)
        if isinstance(node, Joint):
            self._walk += [node.left, node.right]

    def _inform(self, node, values: np.ndarray) -> None:
        """Give a node the values (n,) of its part; its own landmarks are then known in W."""
        if node.told(values):
            self._bent.append(node)
        ids, xy = node.landmarks_here()
        self._xy.array[ids] = se2.apply(node.frame, xy)
