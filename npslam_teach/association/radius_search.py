"""The candidates of each observation: the objects of its class within a search radius. All others are negligible.

Comparing every observation with every object fills a matrix whose entries are nearly all zero: the kernel falls off so
fast that beyond a few of its widths no number of votes makes up for it. A k-d tree of positions for each class
(``scipy.spatial.cKDTree``) finds the objects within the radius.
"""

from collections.abc import Iterator

import numpy as np

from npslam_teach.association.headings import opened_at, turned

NEGLIGIBLE = 1e-13  # a share of the total weight that cannot be told from rounding
PAIRS_AT_ONCE = 25_000  # about as many candidates as stay in a processor's cache
NO_CANDIDATES = ([], [])
TREE_REBUILDS = 8  # how often in a long sweep objects that have lost all their votes are left out of the search


def kernel(xy: np.ndarray, centres: np.ndarray, kernel_std: float, squared_turn: np.ndarray | float = 0.0):
    """``exp(-d^2 / (2 s^2))`` between points, row by row or many against one: (N,); times the kernel of headings.

    Args:
        xy: (N, 2) or (2,) m.
        centres: (N, 2) or (2,) m.
        kernel_std: s, m.
        squared_turn: (N,) of headings, see ``headings.SeenHeadings``.
    """
    dx, dy = (centres - xy).T
    # A root that is squared again gives the same bits as the distance in `association.association_weights`.
    return np.exp(-(np.sqrt(dx * dx + dy * dy) ** 2) / (2 * kernel_std**2) - squared_turn / 2)


def search_radius(
    alpha: float, threshold: float | None, kernel_std: float, labels: np.ndarray, obs_xy_world, obs_class
) -> float:
    """The distance (m) beyond which an object cannot be chosen.

    Without a threshold the question is whether an object outweighs a new one: ``votes exp(-d^2 / (2 s^2)) > alpha``.
    With a threshold all weights are added up, and all that lies beyond must be negligible together.

    Args:
        alpha: concentration.
        threshold: see ``association.decide``.
        kernel_std: s, m.
        labels: (M,) the object of each observation at the start of the sweep.
        obs_xy_world: (M, 2) m.
        obs_class: (M,).
    """
    neglected = 1.0 if threshold is None else 2 * len(labels) / NEGLIGIBLE
    within = _distance(neglected * len(labels) / alpha, kernel_std)
    # No object gets more votes than it has and than there are observations of its class around it.
    cells = np.column_stack([np.floor(obs_xy_world / max(within, 1e-6)).astype(np.int64), obs_class])
    most_votes = np.bincount(labels).max() + most_around(cells)
    return min(within, _distance(neglected * most_votes / alpha, kernel_std))


def _distance(ratio: float, kernel_std: float) -> float:
    """Where the kernel has fallen to one in ``ratio``; slightly more, so that rounding never excludes a candidate."""
    slack = 1 + 1e-9
    return slack * kernel_std * np.sqrt(2 * np.log(slack * max(ratio, 1.0)))


def most_around(cells: np.ndarray) -> int:
    """The largest number of points in a cell and its eight neighbours together.

    Args:
        cells: (M, 3) column and row of the cell of each point, and its class; points of other classes do not count.
    """
    column, row, kind = (cells - cells.min(axis=0)).T
    width, num_kinds = column.max() + 3, kind.max() + 1  # an empty column at each end keeps rows apart
    keys, counts = np.unique(((row + 1) * width + column + 1) * num_kinds + kind, return_counts=True)
    around = np.zeros(len(keys), dtype=np.int64)
    for step in (down * width + right for down in (-1, 0, 1) for right in (-1, 0, 1)):
        place = np.minimum(np.searchsorted(keys, keys + step * num_kinds), len(keys) - 1)
        around += np.where(keys[place] == keys + step * num_kinds, counts[place], 0)
    return int(around.max())


class CandidateIndex:
    """The objects within the search radius of each observation, while a sweep opens new ones.

    Attributes:
        votes: list of C lists: the votes of every object for each class.
    """

    def __init__(self, labels, landmarks, obs_xy_world, obs_class, kernel_std: float, radius: float, headings=None):
        """Take the start of a sweep, see ``association.sweep``, and the ``search_radius`` (m)."""
        from scipy.spatial import cKDTree

        self._headings, self._start = headings, landmarks
        self._xy, self._class, self._kernel_std, self._radius = obs_xy_world, obs_class, kernel_std, radius
        self._members = {c: np.flatnonzero(obs_class == c) for c in np.unique(obs_class).tolist()}
        self._trees = {c: cKDTree(obs_xy_world[members]) for c, members in self._members.items()}
        self._start_xy, votes = landmarks[:, :2], np.zeros((len(landmarks), obs_class.max() + 1))
        np.add.at(votes, (labels, obs_class), 1.0)
        self._opened, self.votes = [], votes.T.tolist()
        self._near_opened = {}  # by observation: the new objects near it and their kernels, as in `candidates`

    @property
    def landmarks(self) -> np.ndarray:
        """(K, 2) m, W, or (K, 3): the objects of the start and then those that were opened."""
        return np.concatenate([self._start, np.reshape(self._opened, (-1, self._start.shape[1]))])

    def candidates(self, order: np.ndarray) -> Iterator[tuple[int, list, list]]:
        """For one observation k after the other: k, the objects of its class near it, and their kernels.

        Args:
            order: (M,) the observations in the order of the visits.
        """
        for k, objects, kernels in self._known_candidates(order):
            opened, opened_kernels = self._near_opened.pop(k, NO_CANDIDATES)
            yield (k, objects + opened, kernels + opened_kernels) if opened else (k, objects, kernels)

    def add_object(self, k: int) -> None:
        """Open an object where observation k was seen: a candidate for all observations of its class nearby."""
        c, new = int(self._class[k]), len(self._start_xy) + len(self._opened)
        self._opened.append(opened_at(self._xy, self._headings, k))
        members = self._members[c][self._trees[c].query_ball_point(self._xy[k], self._radius)]
        off = turned(self._headings, members, self._opened[-1])
        kernels = kernel(self._xy[members], self._xy[k], self._kernel_std, off).tolist()
        for member, value in zip(members.tolist(), kernels, strict=True):
            objects_of_member, kernels_of_member = self._near_opened.setdefault(member, ([], []))
            objects_of_member.append(new)
            kernels_of_member.append(value)
        for votes in self.votes:
            votes.append(0.0)

    def _known_candidates(self, order: np.ndarray) -> Iterator[tuple[int, list, list]]:
        """As ``candidates``, of the objects of the start that still have votes: one without never gets any."""
        trees = self._trees_of_objects()
        num_pairs = sum(self._trees[c].count_neighbors(tree, self._radius) for c, (tree, _) in trees.items())
        num_chunks = 1 + num_pairs // PAIRS_AT_ONCE
        for chunk, asked in enumerate(np.array_split(order, num_chunks)):
            if chunk and chunk % (1 + num_chunks // TREE_REBUILDS) == 0:
                trees = self._trees_of_objects()  # without the objects that have lost all their votes meanwhile
            turn, objects = np.concatenate([self._pairs(asked, c, *tree) for c, tree in trees.items()], axis=1)
            by_turn = np.argsort(turn * len(self._start_xy) + objects)
            turn, objects = turn[by_turn], objects[by_turn]
            off = turned(self._headings, asked[turn], self._start[objects])
            kernels = kernel(self._xy[asked[turn]], self._start_xy[objects], self._kernel_std, off).tolist()
            ends = np.searchsorted(turn, np.arange(len(asked) + 1)).tolist()
            objects = objects.tolist()
            for k, first, last in zip(asked.tolist(), ends[:-1], ends[1:], strict=True):
                yield k, objects[first:last], kernels[first:last]

    def _trees_of_objects(self) -> dict:
        """For each class: a tree of the objects of the start that have votes for it, and their indices."""
        from scipy.spatial import cKDTree

        num_start = len(self._start_xy)
        known = {c: np.flatnonzero(np.array(self.votes[c][:num_start]) > 0) for c in self._members}
        return {c: (cKDTree(self._start_xy[objects]), objects) for c, objects in known.items()}

    def _pairs(self, asked: np.ndarray, c: int, tree, objects: np.ndarray) -> np.ndarray:
        """Observations of class c among those asked, by their turn, and objects within their search radius: (2, P)."""
        from scipy.spatial import cKDTree

        turns = np.flatnonzero(self._class[asked] == c)
        near = cKDTree(self._xy[asked[turns]]).sparse_distance_matrix(tree, self._radius, output_type="ndarray")
        return np.stack([turns[near["i"]], objects[near["j"]]])
