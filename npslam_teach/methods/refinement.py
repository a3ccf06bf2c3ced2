"""What the search has found is looked at again at a finer grain, with the whole map at hand.

Tracklets are tied before anything is known of the map; some are of two objects, and some observations were left out. So
observations change their object where all frames together say so (``exchanges``), and so do parts of passes
(``pass_moves``). What pays in the posterior of all observations, solved anew, is kept (``partition_score``). Then the
passes are taken for tracklets, warmed up and cooled again, and what comes of it is refined in the same way.
"""

import numpy as np

from npslam_teach.association import first_observations, in_order_of_sight, same_partition
from npslam_teach.methods.annealing import Model, State, anneal, settled, tied_anew
from npslam_teach.methods.exchanges import with_exchanges
from npslam_teach.methods.partition_score import Found, scored
from npslam_teach.methods.pass_moves import with_moved_passes
from npslam_teach.methods.persistence import passes_of
from npslam_teach.methods.repair import attached

WARM, STIRS, ROUNDS = (3.0, 1.0, 0.3, 0.1), 4, 3
SAME = 1e-3  # of the log posterior
MOST_POSES = 500_000  # of as many solved graphs as there are tracklets; long logs are spared that


def refined(model: Model, state: State, rng: np.random.Generator) -> Found:
    """The best of a search, improved where that pays.

    Args:
        model: with N tracklets.
        state: the best of a search.
        rng: the generator.
    """
    best = scored(model, _with_left_out(model, state), state.graph.poses)
    if len(model.rivals) * model.log.num_poses > MOST_POSES:
        return best
    best = _improved(model, best)
    for _ in range(STIRS):
        again = _stirred(model, best, rng)
        if same_partition(again.labels, best.labels):
            break
        again = _improved(model, again)
        if again.score > best.score - SAME and again.score < best.score + SAME:
            break
        best = max(best, again, key=lambda each: each.score)
    return best


def _improved(model: Model, found: Found) -> Found:
    """Exchanges and moves of passes, until nothing pays any more."""
    for _ in range(ROUNDS):
        before = found.score
        found = with_moved_passes(model, with_exchanges(model, found))
        if found.score <= before + SAME:
            break
    return found


def _stirred(model: Model, found: Found, rng: np.random.Generator) -> Found:
    """The best that a warm start from the passes comes to, each of which moves as a whole."""
    number, _ = passes_of(found.labels, model.log.obs_time)
    number = in_order_of_sight(number, found.labels >= 0)
    finer, graph = tied_anew(model, found.graph, number)
    *_, state = anneal(finer, graph, found.labels[first_observations(number)], WARM, rng)
    state = settled(finer, state, rng)
    return scored(model, _with_left_out(finer, state), state.graph.poses)


def _with_left_out(model: Model, state: State) -> np.ndarray:
    """Labels (M,) in which those that were left out go where they fit best, if their frame has not taken it."""
    landmarks = state.graph.landmarks[first_observations(state.labels)]
    return attached(model.log, model.of_observations(state.labels), state.graph.poses, landmarks)
