"""What is in view stays in view: how improbable it is that something comes into view once more.

Frame by frame the nearest object explains an observation best. But that an object leaves the view for a single frame,
and another near it comes into view for just that frame, is less probable than an observation that is far off. How often
things come into view, and how long they stay, is estimated from the tracklets: where the detector misses nothing a
coming is rare and costs much; where it misses every other frame it costs next to nothing.

A *pass* is what a tracklet would be if nothing had been left out: the observations of one object, as long as it is not
out of sight for longer than ``tracklets.LONGEST_GAP``. A *coming* is an observation of an object that the frame before,
of those in which anything was seen, has not seen.
"""

import math
from typing import NamedTuple

import numpy as np

from npslam_teach.association import in_order_of_sight
from npslam_teach.methods.tracklets import LONGEST_GAP


class Persistence(NamedTuple):
    """Log probabilities of what a partition adds to that of the tracklets."""

    look: np.ndarray  # (M,) of each observation, the number of its frame among those in which anything was seen
    log_coming: float  # of one more coming: of coming in some frame, and of going after some observation
    log_pass: float  # of one more pass: that it is drawn from the Chinese restaurant, whose seats are the observations
    comings: int  # of the tracklets
    passes: int  # tracklets

    def log_prior(self, comings: int, passes: int) -> float:
        """Of a partition with so many comings and passes, as against the tracklets."""
        return (comings - self.comings) * self.log_coming + (passes - self.passes) * self.log_pass


def persistence(tracklet: np.ndarray, time: np.ndarray, alpha: float) -> Persistence:
    """How often things come into view.

    Args:
        tracklet: (M,) of each observation, -1 = of none; at least one observation.
        time: (M,) pose of each, ascending.
        alpha: concentration of the Dirichlet process.
    """
    look = np.unique(time, return_inverse=True)[1]
    count, tied = num_comings(tracklet, look), np.count_nonzero(tracklet >= 0)
    per_frame, per_observation = max(count, 1) / (look[-1] + 1), max(count, 1) / max(tied, 1)
    log_coming = min(math.log(per_frame), 0.0) + min(math.log(per_observation), 0.0)
    return Persistence(look, log_coming, -math.log(len(time) + alpha), count, tracklet.max(initial=-1) + 1)


def num_comings(labels: np.ndarray, look: np.ndarray) -> int:
    """How often an object is seen that the frame before has not seen.

    Args:
        labels: (M,) the object of each observation, -1 = of none.
        look: (M,) the frame of each.
    """
    used, count = labels >= 0, labels.max(initial=-1) + 1
    seen = np.unique(look[used] * count + labels[used])
    return int(np.count_nonzero(~np.isin(seen - count, seen, assume_unique=True)))


def passes_of(labels: np.ndarray, time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The pass of each observation (M,), in the order of first sight; the object of each pass (N,), likewise.

    Args:
        labels: (M,) the object of each, -1 = of none: such an observation is a pass, and an object, of its own.
        time: (M,) pose of each, ascending.
    """
    labels = singled_out(labels)
    order = np.argsort(labels, kind="stable")
    goes_on = (np.diff(labels[order]) == 0) & (np.diff(time[order]) <= LONGEST_GAP)
    number = np.empty(len(labels), dtype=int)
    number[order] = np.cumsum(np.append(0, ~goes_on))
    number = in_order_of_sight(number)
    return number, in_order_of_sight(labels[np.unique(number, return_index=True)[1]])


def singled_out(labels: np.ndarray) -> np.ndarray:
    """Labels (M,) in which every observation that is of none, -1, is an object of its own."""
    return np.where(labels < 0, labels.max(initial=-1) + 1 + np.arange(len(labels)), labels)


def between_two(squared: np.ndarray, look: np.ndarray, log_coming: float, log_alone: float) -> np.ndarray:
    """Which of two objects each observation is of, if any, by all frames together (Viterbi).

    A frame sees each of the two at most once. Which it sees is the hidden state: neither, the first, the second, both.

    Args:
        squared: (m, 2) squared distances of observations to the objects.
        look: (m,) the frame of each, ascending.
        log_coming: of an object that was not seen in the frame before.
        log_alone: that an observation is of neither.

    Returns:
        (m,) 0, 1, or -1 for neither.
    """
    frames, frame, counts = np.unique(look, return_inverse=True, return_counts=True)
    place, most = np.arange(len(look)) - np.searchsorted(frame, frame), counts.max()
    cost = np.full((len(frames), most, 2), np.inf)  # instead of being of neither
    cost[frame, place] = squared / 2 + log_alone
    both = cost[:, :, None, 0] + cost[:, None, :, 1]
    both[:, np.arange(most), np.arange(most)] = np.inf
    both = both.reshape(len(frames), -1)
    state = _viterbi(
        np.column_stack([np.zeros(len(frames)), cost.min(axis=1), both.min(axis=1)]),
        -log_coming * _comings_between(np.diff(frames) == 1),
    )
    together = np.column_stack(np.divmod(both.argmin(axis=1), most))
    which = np.where((state == 3)[:, None], together, cost.argmin(axis=1))
    answer = np.full((len(frames), most), -1)
    for each, states in enumerate(((1, 3), (2, 3))):
        seen = np.flatnonzero(np.isin(state, states))
        answer[seen, which[seen, each]] = each
    return answer[frame, place]


def _comings_between(adjacent: np.ndarray) -> np.ndarray:
    """How many of two objects come into view from one frame (F - 1,) to the next: (F - 1, 4, 4), before and now."""
    seen = (np.arange(4)[:, None] >> [0, 1]) & 1
    return np.where(adjacent[:, None, None], (seen > seen[:, None]).sum(axis=-1), seen.sum(axis=-1))


def _viterbi(cost: np.ndarray, step: np.ndarray) -> np.ndarray:
    """The states (F,) of the least sum of costs (F, S) and of the steps between them (F - 1, S, S)."""
    best, back = cost[0], []
    for k in range(len(step)):
        total = best[:, None] + step[k]
        back.append(total.argmin(axis=0))
        best = total.min(axis=0) + cost[k + 1]
    state = [int(best.argmin())]
    for came_from in reversed(back):
        state.append(int(came_from[state[-1]]))
    return np.array(state[::-1])
