"""What the search has found is looked at again at a finer grain, with the whole map at hand.

Tracklets are tied before anything is known of the map, and some are of two objects. So they are cut, put together
again, and cut otherwise; observations that were left out go where they fit. What pays in the posterior of all
observations, solved anew, is kept (``partition_score``).
"""

import numpy as np

from npslam_teach.association import first_observations, same_partition
from npslam_teach.methods.annealing import COLD, Model, State, anneal, settled, tied_anew
from npslam_teach.methods.partition_score import Found, with_whole_tracklets
from npslam_teach.methods.polish import MARGIN
from npslam_teach.methods.repair import attached, classes_of, cut_in_two, pieces, reassigned
from npslam_teach.methods.takeovers import with_takeovers
from npslam_teach.types import PoseGraph

WARM, ROUNDS = (1.0, 0.3, 0.1), 3
SAME = 1e-3  # of the log posterior
MOST_POSES = 500_000  # of as many solved graphs as there are tracklets; long logs are spared that


def refined(model: Model, state: State, rng: np.random.Generator) -> Found:
    """The best of a search, repaired where it pays.

    Args:
        model: with N tracklets.
        state: the best of a search.
        rng: the generator.
    """
    whole = with_whole_tracklets(model, _with_left_out(model, state), state.graph.poses)
    finer, state = repaired(model, state, rng)
    again = with_whole_tracklets(model, finer.of_observations(state.labels), state.graph.poses)
    best = max(again, _settled(model, again, rng), key=lambda each: each.score)
    if best.score < whole.score + MARGIN:  # less is within the error of linear models
        best = whole
    for _ in range(ROUNDS if _is_short(model) else 0):
        best = with_takeovers(model, best)
        again = _settled(model, best, rng)
        if again.score <= best.score + SAME:
            break
        best = again
    return best


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
