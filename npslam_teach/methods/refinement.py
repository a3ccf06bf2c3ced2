"""What the search has found is looked at again at a finer grain, with the whole map at hand.

Tracklets are tied before anything is known of the map, and some are of two objects. So they are cut, put together
again, and cut otherwise; observations that were left out go where they fit. What pays in the posterior of all
observations, solved anew, is kept (``partition_score``).
"""

import numpy as np

from npslam_teach.association import first_observations, in_order_of_sight, same_partition
from npslam_teach.methods.annealing import COLD, Model, State, anneal, settled, tied_anew
from npslam_teach.methods.exchanges import with_exchanges, with_moved_passes
from npslam_teach.methods.partition_score import Found, partition_score, with_whole_tracklets
from npslam_teach.methods.persistence import passes
from npslam_teach.methods.repair import attached, classes_of, cut_in_two, pieces, reassigned
from npslam_teach.methods.takeovers import with_takeovers
from npslam_teach.pose_graph import fit
from npslam_teach.types import PoseGraph

WARM, ROUNDS = (3.0, 1.0, 0.3, 0.1), 3
TRIES = 4
SAME = 1e-3  # of the log posterior
MOST_POSES = 500_000  # of as many solved graphs as there are tracklets; long logs are spared that


def refined(model: Model, state: State, rng: np.random.Generator) -> Found:
    """The best of a search, repaired where it pays.

    Args:
        model: with N tracklets.
        state: the best of a search.
        rng: the generator.
    """
    best = with_whole_tracklets(model, _with_left_out(model, state), state.graph.poses)
    if not _is_short(model):
        return best
    best = _improved(model, best)
    for _ in range(TRIES):
        again = _stirred(model, best, rng)
        if same_partition(again.labels, best.labels):
            break
        again = _improved(model, again)
        if again.score > best.score + SAME:
            best = again
        elif again.score > best.score - SAME:
            break
    return best


def _improved(model: Model, found: Found) -> Found:
    for _ in range(ROUNDS):
        before = found.score
        found = with_moved_passes(model, with_exchanges(model, found))
        if found.score <= before + SAME:
            break
    return found


def _stirred(model: Model, found: Found, rng: np.random.Generator) -> Found:
    used = found.labels >= 0
    piece = in_order_of_sight(passes(found.labels, model.log.obs_time), used)
    finer, state = _descended(model, found.graph, piece, found.labels[first_observations(piece)], WARM, rng)
    labels = attached(model.log, finer.of_observations(state.labels), state.graph.poses, _objects(finer, state)[0])
    graph = fit(model.log, labels, state.graph.poses)
    return Found(labels, graph, partition_score(model, labels, graph))


def repaired(model: Model, state: State, rng: np.random.Generator) -> tuple[Model, State]:
    """Look at everything again at a finer grain, with the whole map at hand.

    Tracklets are cut into pieces that may change their object; then every observation takes the object that suits it
    best, those that were left out as well. The parts of a tracklet that stay together are tied together again.
    """
    tied = model.tracklet
    halves = cut_in_two(model.log, state.graph.poses, state.graph.landmarks, tied)
    of_half = model.of_observations(state.labels)[first_observations(halves)]
    model, state = _descended(model, state.graph, halves, of_half, WARM, rng)
    for _ in range(ROUNDS):
        before = model.of_observations(state.labels)
        seen = reassigned(model.log, state.graph.poses, *_objects(model, state))
        model, state = _descended(model, state.graph, *pieces(tied, seen), (COLD,), rng)
        if same_partition(before, model.of_observations(state.labels)):
            break
    return model, state


def _is_short(model: Model) -> bool:
    """Whether there is time to solve the graph without every tracklet in turn."""
    return len(model.rivals) * model.log.num_poses <= MOST_POSES


def _with_left_out(model: Model, state: State) -> np.ndarray:
    """Labels (M,) in which those that were left out go where they fit best, if their frame has not taken it."""
    return attached(model.log, model.of_observations(state.labels), state.graph.poses, _objects(model, state)[0])


def _settled(model: Model, found: Found, rng: np.random.Generator) -> Found:
    """The best near by, where all pieces of tracklets of one object move together."""
    finer, state = _descended(model, found.graph, *pieces(model.tracklet, found.labels), (COLD,), rng)
    return with_whole_tracklets(model, finer.of_observations(state.labels), state.graph.poses)


def _descended(model: Model, graph: PoseGraph, tracklet, labels, temperatures, rng) -> tuple[Model, State]:
    """The partition with other tracklets (M,), whose objects (N,) are given, and then the best that is near."""
    model, graph = tied_anew(model, graph, tracklet)
    *_, state = anneal(model, graph, labels, temperatures, rng)
    return model, settled(model, state, rng)


def _objects(model: Model, state: State) -> tuple[np.ndarray, np.ndarray]:
    """Where the objects are, (K, 2) m, W, and what they may be, (K, C)."""
    first = first_observations(state.labels)
    return state.graph.landmarks[first], classes_of(model.log, model.of_observations(state.labels))
