"""Tracklets: the observations of one pass over one object, tied together before anything is known of the map.

While an object stays in view the robot has hardly moved, so that who is who needs no map and no trajectory. The present
surroundings are kept in the frame of the robot itself: there the odometry moves the objects, an observation measures
one directly, and the Kalman filter has nothing to linearize but the turn of a single step (a robocentric map;
Castellanos, Martinez-Cantin, Tardos and Neira, "Robocentric map joining", 2007). What was not seen for a while is
forgotten; seen again it begins another tracklet. Which tracklets are of one object is for ``association.gibbs`` to say.
"""

from dataclasses import dataclass, replace

import numpy as np

from npslam_teach import se2
from npslam_teach.association import in_order_of_sight
from npslam_teach.association.semantics import class_distances, normalised, reports, updated_belief
from npslam_teach.methods.gating import (
    GATE,
    NEW,
    NEW_GATE,
    UNASSIGNED,
    assign,
    frames_of,
    squared_gates,
    squared_mahalanobis,
)
from npslam_teach.methods.noise import block_diagonal, observation_covariances, step_covariances
from npslam_teach.methods.oriented import Headings
from npslam_teach.types import RobotLog

LONGEST_GAP = 10  # poses out of sight after which an object is forgotten


def tracklets(
    log: RobotLog, gate: float = GATE, new_gate: float = NEW_GATE, longest_gap: int = LONGEST_GAP
) -> np.ndarray:
    """Tie observations to those shortly before them.

    Args:
        log: what the robot measured; its noise counts, that of each step and observation if it says so.
        gate: the share of right matches that is let through, see ``ekf_slam``.
        new_gate: an observation beyond this of everything in view begins a tracklet; one between the two gates is left
            out.
        longest_gap: poses.

    Returns:
        (M,) index of the tracklet, in the order of first sight; -1 = left out.
    """
    gates, step_cov = squared_gates(gate, new_gate), step_covariances(log)
    sight_cov = observation_covariances(log)
    seen_all, facing_all = reports(log), Headings.of_log(log)
    labels, count = np.full(log.num_observations, UNASSIGNED), 0
    nearby = Surroundings.empty(log.num_classes)
    for time, observations in enumerate(frames_of(log)):
        if time > 0:
            nearby = nearby.after_step(log.odometry[time - 1], step_cov[time - 1]).seen_since(time - longest_gap)
        if len(observations) == 0:
            continue
        xy, seen, noise = log.obs_xy[observations], seen_all[observations], sight_cov[observations]
        facing = facing_all.of(observations)
        squared = nearby.facing.with_positions(nearby.squared_distances(xy, noise), facing)
        decision = assign(squared + class_distances(seen, nearby.classes), *gates)
        matched, is_new = decision >= 0, decision == NEW
        labels[observations[matched]] = nearby.tracklet[decision[matched]]
        labels[observations[is_new]] = count + np.arange(np.count_nonzero(is_new))
        count += np.count_nonzero(is_new)
        nearby = nearby.updated(decision[matched], xy[matched], seen[matched], noise[matched], time)
        nearby = replace(nearby, facing=nearby.facing.updated(decision[matched], facing.of(matched)))
        new = labels[observations[is_new]], xy[is_new], seen[is_new], noise[is_new], time, facing.of(is_new)
        nearby = nearby.joined_by(*new)
    return labels


def tied_both_ways(log: RobotLog, **settings) -> np.ndarray:
    """Tie only what is tied forwards and backwards in time.

    Where one object comes into view as another leaves it, the first of the one may be taken for the other; but seldom
    is the last of the other, backwards in time, taken for the one as well.

    Args:
        log: what the robot measured.
        settings: of ``tracklets``.

    Returns:
        (M,) index of the tracklet; -1 = left out in one direction or both.
    """
    forwards = tracklets(log, **settings)
    steps, times = se2.inverse(log.odometry[::-1]), log.num_poses - 1 - log.obs_time
    cov = None if log.odometry_cov is None else log.odometry_cov[::-1]  # of the step there, about that of the way back
    backwards = tracklets(replace(log, odometry=steps, obs_time=times, odometry_cov=cov), **settings)
    return in_order_of_sight(np.column_stack([forwards, backwards]), (forwards >= 0) & (backwards >= 0))


def in_passes(labels: np.ndarray, times: np.ndarray, gap: int = LONGEST_GAP) -> tuple[np.ndarray, np.ndarray]:
    """Observations pass by pass.

    Args:
        labels: (M,) the object of each; -1 leaves it out.
        times: (M,) index of the pose.
        gap: poses; an object that was not seen for longer begins another pass.

    Returns:
        (U,) indices, the observations of each pass together and in order of time; (U,) the number of the pass of each.
    """
    used = np.flatnonzero(labels >= 0)
    order = used[np.lexsort((times[used], labels[used]))]
    begins = (np.diff(labels[order], prepend=-2) != 0) | (np.diff(times[order], prepend=0) > gap)
    return order, np.cumsum(begins) - 1


@dataclass(frozen=True, eq=False)
class Surroundings:
    """What is in view: where each tracklet's object stands in the frame of the robot, and how sure that is."""

    tracklet: np.ndarray  # (K,)
    classes: np.ndarray  # (K, C) what each may be, logarithms of probabilities
    last_seen: np.ndarray  # (K,) pose
    xy: np.ndarray  # (K, 2) m
    cov: np.ndarray  # (2K, 2K) m^2
    facing: Headings  # of the K objects

    @classmethod
    def empty(cls, num_classes: int):
        """Nothing in view."""
        nothing = np.zeros(0, dtype=int)
        return cls(nothing, np.zeros((0, num_classes)), nothing, np.zeros((0, 2)), np.zeros((0, 0)), Headings.silent(0))

    def after_step(self, step: np.ndarray, step_cov: np.ndarray) -> "Surroundings":
        """The same objects from the next pose; the error of the step is common to them all."""
        if len(self.xy) == 0:
            return self
        xy = se2.apply_inverse(step, self.xy)
        turn = se2.rotate(-step[2], np.eye(2)).T
        turned = (turn @ self.cov.reshape(len(xy), 2, -1)).reshape(self.cov.shape)  # rows, and then columns
        turned = (turn @ turned.T.reshape(len(xy), 2, -1)).reshape(self.cov.shape)
        # A step that is off by (dx, dy, dtheta) shifts and turns all that is seen the other way.
        by_step = np.zeros((len(xy), 2, 3))
        by_step[:, :, :2] = -turn
        by_step[:, :, 2] = np.column_stack([xy[:, 1], -xy[:, 0]])
        by_step = by_step.reshape(-1, 3)
        cov = turned + by_step @ step_cov @ by_step.T
        return replace(self, xy=xy, cov=cov, facing=self.facing.after_turn(step[2], step_cov[2, 2]))

    def seen_since(self, time: int) -> "Surroundings":
        """Without those that were seen last before a pose."""
        kept = np.flatnonzero(self.last_seen >= time)
        if len(kept) == len(self.tracklet):
            return self
        both = (2 * kept[:, None] + [0, 1]).ravel()
        fields = self.tracklet[kept], self.classes[kept], self.last_seen[kept]
        return Surroundings(*fields, self.xy[kept], self.cov[np.ix_(both, both)], self.facing.of(kept))

    def squared_distances(self, xy: np.ndarray, noise: np.ndarray) -> np.ndarray:
        """Squared Mahalanobis distance of observations (m, 2), noise (m, 2, 2), to the objects, (m, K)."""
        count = len(self.xy)
        own = self.cov.reshape(count, 2, count, 2)[np.arange(count), :, np.arange(count)]
        return squared_mahalanobis(xy[:, None] - self.xy, own + noise[:, None])

    def updated(self, which: np.ndarray, xy: np.ndarray, seen: np.ndarray, noise: np.ndarray, time: int):
        """After observations (m, 2), reports (m, C), of some of the objects (m,): a Kalman update, all of it linear."""
        if len(which) == 0:
            return self
        both = (2 * which[:, None] + [0, 1]).ravel()
        gain = np.linalg.solve(self.cov[np.ix_(both, both)] + block_diagonal(noise), self.cov[both]).T
        state = self.xy.ravel() + gain @ (xy - self.xy[which]).ravel()
        cov, last_seen = self.cov - gain @ self.cov[both], self.last_seen.copy()
        last_seen[which] = time
        classes = self.classes.copy()
        classes[which] = updated_belief(classes[which], seen)
        return replace(self, classes=classes, last_seen=last_seen, xy=state.reshape(-1, 2), cov=(cov + cov.T) / 2)

    def joined_by(self, tracklet, xy, seen, noise: np.ndarray, time: int, facing=None) -> "Surroundings":
        """With new objects, which stand where they are seen, and face where they are seen to, if anybody says."""
        if len(tracklet) == 0:
            return self
        old, new = len(self.cov), 2 * len(tracklet)
        cov = np.zeros((old + new, old + new))
        cov[:old, :old], cov[old:, old:] = self.cov, block_diagonal(noise)
        last_seen = np.append(self.last_seen, np.full(len(tracklet), time))
        ids, classes = np.append(self.tracklet, tracklet), np.concatenate([self.classes, normalised(seen)])
        facing = self.facing.joined_by(Headings.silent(len(tracklet)) if facing is None else facing)
        return Surroundings(ids, classes, last_seen, np.concatenate([self.xy, xy]), cov, facing)
