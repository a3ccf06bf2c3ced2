"""What is in view stays in view: which of two objects was seen, asked of all frames together.

Frame by frame, the nearest object explains an observation best; but an object that leaves the view for a single frame
while another, near it, comes into view for that frame, is less probable than an observation that is off. How often
things come into view, and how long they stay, the tracklets say.
"""

import math
from typing import NamedTuple

import numpy as np

from npslam_teach.association import in_order_of_sight
from npslam_teach.methods.tracklets import LONGEST_GAP
from npslam_teach.types import RobotLog


class Persistence(NamedTuple):
    """How improbable it is that something comes into view once more."""

    look: np.ndarray  # (M,) of each observation, the number of its frame among those in which anything was seen
    log_coming: float  # log of: comings per frame, times the share of observations after which the object goes
    comings: int  # of the tracklets
    log_draw: float  # log of: one of all observations; what a seat in the Chinese restaurant is drawn from


def persistence(log: RobotLog, tracklet: np.ndarray, alpha: float) -> Persistence:
    """How often things come into view in a log, by its tracklets (M,), observations in time."""
    look = np.unique(log.obs_time, return_inverse=True)[1]
    tied = int(np.count_nonzero(tracklet >= 0))
    count = comings(tracklet, look)
    log_coming = 2 * math.log(max(count, 1)) - math.log(look[-1] + 1) - math.log(max(tied, 1))
    return Persistence(look, min(log_coming, 0.0), count, -math.log(len(look) + alpha))


def comings(labels: np.ndarray, look: np.ndarray) -> int:
    """How often an object (M,), -1 = none, is seen that was not seen in the frame before."""
    used = labels >= 0
    seen = look[used] * (labels.max(initial=-1) + 1) + labels[used]
    before = seen - (labels.max(initial=-1) + 1)
    return int(np.count_nonzero(~np.isin(before, seen)))


def passes(labels: np.ndarray, time: np.ndarray) -> np.ndarray:
    """The number of the pass of each observation (M,): as long as an object is seen in every frame, or in a tracklet.

    Args:
        labels: (M,) the object of each, -1 = of none: such an observation is a pass of its own.
        tracklet: (M,) of each, -1 = of none.
        look: (M,) the frame of each, in order.
    """
    alone = np.where(labels < 0, np.arange(len(labels)), -1)
    order = np.lexsort((time, alone, labels))
    same = (np.diff(labels[order]) == 0) & (labels[order][1:] >= 0)
    goes_on = same & (np.diff(time[order]) <= LONGEST_GAP)
    number = np.empty(len(labels), dtype=int)
    number[order] = np.cumsum(np.append(0, ~goes_on))
    return in_order_of_sight(number)


def between_two(squared: np.ndarray, look: np.ndarray, log_coming: float, alone: float) -> np.ndarray:
    """Which of two objects each observation is of, if any, by all frames together (Viterbi).

    A frame sees each of the two at most once. Which of them it sees is a hidden state: 0 none, 1 the first, 2 the
    second, 3 both.

    Args:
        squared: (m, 2) squared distances of observations to the objects, infinite where it is not asked.
        look: (m,) the frame of each, in order.
        log_coming: of ``Persistence``, of an object that was not seen in the frame before.
        alone: how improbable it is, -log, that an observation is of neither.

    Returns:
        (m,) 0, 1, or -1 for neither.
    """
    frames, frame, counts = np.unique(look, return_inverse=True, return_counts=True)
    place = np.arange(len(look)) - np.searchsorted(frame, frame)
    cost = np.full((len(frames), counts.max(), 2), np.inf)  # instead of being alone
    cost[frame, place] = squared / 2 - alone
    both = cost[:, :, None, 0] + cost[:, None, :, 1]
    both[:, np.arange(counts.max()), np.arange(counts.max())] = np.inf
    both = both.reshape(len(frames), -1)
    seen = np.column_stack([np.zeros(len(frames)), cost.min(axis=1), both.min(axis=1)])
    state = _viterbi(seen, -log_coming * _comings(np.diff(frames) == 1))
    answer = np.full((len(frames), counts.max()), -1)
    rows = np.arange(len(frames))
    which = [cost[:, :, 0].argmin(axis=1), cost[:, :, 1].argmin(axis=1)]
    pair = both.argmin(axis=1)
    which = [np.where(state == 3, pair // counts.max(), which[0]), np.where(state == 3, pair % counts.max(), which[1])]
    for each, states in enumerate(((1, 3), (2, 3))):
        present = np.isin(state, states)
        answer[rows[present], which[each][present]] = each
    return answer[frame, place]


def _comings(adjacent: np.ndarray) -> np.ndarray:
    """How many of two objects come into view from one frame to the next: (F - 1, 4, 4), states before and now."""
    bits = (np.arange(4)[:, None] >> [0, 1]) & 1
    came = (bits[None] > bits[:, None]).sum(axis=-1)
    return np.where(adjacent[:, None, None], came, bits.sum(axis=-1)[None, None])


def _viterbi(cost: np.ndarray, step: np.ndarray) -> np.ndarray:
    """The states (F,) of the least sum of costs (F, S) and of the steps between them (F - 1, S, S)."""
    best, back = cost[0], []
    for k in range(len(step)):
        total = best[:, None] + step[k]
        back.append(total.argmin(axis=0))
        best = total.min(axis=0) + cost[k + 1]
    state = [int(best.argmin())]
    for each in reversed(back):
        state.append(int(each[state[-1]]))
    return np.array(state[::-1])
