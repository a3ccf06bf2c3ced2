"""Where within a pass one object may have given way to another.

Where a thing goes out of view as another comes in beside it, a tracklet may run on from the one to the other, and if
nothing else begins or ends there no cut is tried. The trajectory bends to suit both, so that residuals do not show it.
What shows it is how much chi2 falls if all that is seen from there on is another object's, and everything else, the
trajectory too, is at its best: the generalised likelihood ratio (Willsky and Jones, "A generalized likelihood ratio
approach to the detection and estimation of jumps in linear systems", 1976). By the linear model of
``pose_graph.reduced_system`` it costs a few sums; first at every ``RUN`` observations, then one by one around the best.
"""

import numpy as np

from npslam_teach.association import first_observations, in_order_of_sight
from npslam_teach.methods.annealing import Model
from npslam_teach.methods.partition_score import in_pieces
from npslam_teach.methods.persistence import passes_of, singled_out
from npslam_teach.types import PoseGraph

RUN = 4  # observations that are looked at together
LEAST = 6.0  # of the fall of chi2; by chance one of twenty changes at a given place shows as much


def after_change(model: Model, labels: np.ndarray, graph: PoseGraph) -> np.ndarray:
    """Which observations of each pass come after the most probable change of its object: (M,) bool, all false if none.

    Args:
        model: the log and the prior.
        labels: (M,) the object of each observation, -1 = of none.
        graph: one landmark for each object, solved.
    """
    number, _ = passes_of(labels, model.log.obs_time)
    rank = _ranks(number)
    coarse = in_order_of_sight(np.column_stack([number, rank // RUN]))
    begins, fall = _best(model, labels, graph, number, coarse, rank)
    doubtful = (fall > LEAST)[number]
    near = np.clip(rank - begins[number] + RUN, 0, 2 * RUN)
    fine = in_order_of_sight(np.column_stack([number, np.where(doubtful, near, 0)]))
    begins, fall = _best(model, labels, graph, number, fine, rank)
    return (rank >= begins[number]) & (fall > LEAST)[number]


def falls_of_chi2(model: Model, labels: np.ndarray, graph: PoseGraph, piece: np.ndarray) -> np.ndarray:
    """How much chi2 falls if the pieces of a pass, from each one on, are seen of an object of their own.

    Args:
        model: the log and the prior.
        labels: (M,) the object of each observation, -1 = of none.
        graph: one landmark for each object, solved.
        piece: (M,) of N, each of one pass and without gaps, numbered in the order of first sight.

    Returns:
        (N,); 0 for the first piece of a pass.
    """
    first, (number, _) = first_observations(piece), passes_of(labels, model.log.obs_time)
    of_pass, of_object = number[first], in_order_of_sight(singled_out(labels)[first])
    _, reduced = in_pieces(model, labels, graph, piece)
    ties, own, force = _from_each_on(reduced.information, reduced.vector, of_pass)
    members = np.kron(np.equal.outer(np.arange(of_object.max() + 1), of_object), np.eye(2))
    joint, shared = members @ reduced.information @ members.T, members @ ties
    objects = np.linalg.solve(joint, np.column_stack([members @ reduced.vector, shared]))
    force = force - (objects[:, 0] @ shared).reshape(-1, 2)
    shared, objects = (array.reshape(len(joint), -1, 2) for array in (shared, objects[:, 1:]))
    own = own - np.einsum("kni,knj->nij", shared, objects)
    falls, inner = np.zeros(len(first)), np.setdiff1d(np.arange(len(first)), first_observations(of_pass))
    falls[inner] = (force[inner] * np.linalg.solve(own[inner], force[inner, :, None])[..., 0]).sum(axis=1)
    return falls


def _from_each_on(information: np.ndarray, vector: np.ndarray, of_pass: np.ndarray):
    """What is seen in a pass from each piece on, taken for an object: its ties, own information, and vector.

    Args:
        information: (2N, 2N) of the pieces.
        vector: (2N,).
        of_pass: (N,) the pass of each piece.

    Returns:
        (2N, 2N) with all pieces; (N, 2, 2) with itself; (N, 2).
    """
    count = len(of_pass)
    ties, force = information.reshape(2 * count, count, 2).copy(), vector.reshape(count, 2).copy()
    own = np.zeros((count, 2, 2))
    for each in range(of_pass.max() + 1):
        pieces = np.flatnonzero(of_pass == each)
        ties[:, pieces] = _summed_from_here_on(ties[:, pieces], 1)
        within = _summed_from_here_on(ties.reshape(count, 2, count, 2)[pieces][:, :, pieces], 0)
        own[pieces] = within[np.arange(len(pieces)), :, np.arange(len(pieces))]
        force[pieces] = _summed_from_here_on(force[pieces], 0)
    return ties.reshape(2 * count, -1), own, force


def _best(model: Model, labels: np.ndarray, graph: PoseGraph, number, piece, rank) -> tuple[np.ndarray, np.ndarray]:
    """Of each pass: the rank with which the piece begins from which on chi2 falls most, and by how much."""
    falls, first = falls_of_chi2(model, labels, graph, piece), first_observations(piece)
    order = np.lexsort((-falls, number[first]))
    best = order[first_observations(number[first][order])]
    return rank[first[best]], falls[best]


def _summed_from_here_on(values: np.ndarray, axis: int) -> np.ndarray:
    """Sums along an axis, of each and all that follow."""
    return np.flip(np.flip(values, axis).cumsum(axis), axis)


def _ranks(number: np.ndarray) -> np.ndarray:
    """How many observations of its pass, (M,) its number, come before each."""
    order = np.argsort(number, kind="stable")
    ranks = np.empty(len(number), dtype=int)
    ranks[order] = np.arange(len(number)) - np.searchsorted(number[order], number[order])
    return ranks
