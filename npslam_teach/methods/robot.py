"""A robot under way, frame by frame: what ``online`` runs over a log. That module says what it does."""

from typing import NamedTuple

import numpy as np

from npslam_teach import se2
from npslam_teach.association import first_observations, require_alpha
from npslam_teach.association.semantics import class_distances, log_likelihoods
from npslam_teach.methods.gating import GATE, NEW, NEW_GATE, assign, squared_gates
from npslam_teach.methods.posterior import area_around
from npslam_teach.methods.recent import Front, asked_again, greedily, sampler_of, without_doubtful
from npslam_teach.methods.sightings import Sightings
from npslam_teach.methods.tracklets import LONGEST_GAP, Surroundings
from npslam_teach.pose_graph import SubmapTree

WINDOW = 100  # poses out of sight after which a tracklet keeps its object
MOST_RECENT = 30  # tracklets in the window
MOST_NEAR = 40  # old objects at hand
MOST_LIFTED = 4  # of these fetched per frame
ASK_AGAIN = 8  # frames with observations from one revision to the next
REACH = 1.5  # times the farthest observation: how far objects are fetched from


class Estimate(NamedTuple):
    """What is believed right after a frame."""

    time: int  # index of the pose
    pose: np.ndarray  # (3,) W
    pose_cov: np.ndarray  # (3, 3)
    objects: np.ndarray  # (m,) the object of each observation of the frame, by its oldest tracklet; -1 = left out


class Online:
    """A robot under way: give it frames, it says where it is and who is who.

    >>> robot = Online(num_classes=2, odometry_std=(0.02, 0.02, 0.01), observation_std=(0.1, 0.1))
    >>> robot.add_frame(None, [[2.0, 0.5]], [1]).objects
    array([0])
    >>> robot.add_frame([0.5, 0.0, 0.0], [[1.5, 0.5]], [1]).objects
    array([0])
    """

    def __init__(self, num_classes: int, odometry_std, observation_std, alpha: float = 0.1, seed: int = 0, **settings):
        """At the origin.

        Args:
            num_classes: C.
            odometry_std: (3,) m, m, rad per step, of steps that bring no covariance of their own.
            observation_std: (2,) m, likewise.
            alpha: how many objects are expected where none was seen, per object where some were.
            seed: of the random numbers.
            settings: ``window`` in poses, ``area`` in m^2 (None: the box around all that was seen so far).
        """
        self._noise = np.diag(np.square(odometry_std)), np.diag(np.square(observation_std))
        self._alpha, self._rng = require_alpha(alpha), np.random.default_rng(seed)
        self._window, self._area = settings.get("window", WINDOW), settings.get("area")
        self.tree, self.books = SubmapTree(), Sightings(num_classes)
        self._nearby, self._gates = Surroundings.empty(num_classes), squared_gates(GATE, NEW_GATE)
        self.time, self._seen_frames, self._reach = -1, 0, 0.0
        self.tracklet_of, self._box = [], np.zeros((2, 2))
        self._recent, self._labels, self._cov = np.zeros(0, dtype=int), {}, np.zeros((3, 3))

    def add_frame(self, step, xy, classes, probabilities=None, step_cov=None, cov=None) -> Estimate:
        """Drive a step, see what is there, and think again.

        Args:
            step: (3,) m, m, rad: the pose in the frame of the one before; None for the first frame.
            xy: (m, 2) m, in the frame of the robot.
            classes: (m,) what was reported.
            probabilities: (m, C) of the classes; None: the reports are certain.
            step_cov: (3, 3) of the step, and
            cov: (m, 2, 2) of the observations; None: as the standard deviations say.
        """
        self._drive(step, self._noise[0] if step_cov is None else step_cov)
        xy = np.reshape(np.asarray(xy, dtype=float), (-1, 2))
        if len(xy) == 0:
            return Estimate(self.time, self.tree.pose, self._cov, np.zeros(0, dtype=int))
        noise = np.broadcast_to(self._noise[1], (len(xy), 2, 2)) if cov is None else cov
        seen = log_likelihoods(np.asarray(classes, dtype=int), self.books.seen.shape[1], probabilities)
        self.books.uncertain |= probabilities is not None
        tracklets, new = self._tied(xy, seen, noise)
        self._fetch(xy)
        self._think(new)
        return Estimate(self.time, self.tree.pose, self._cov, self._objects(tracklets))

    @property
    def labels(self) -> np.ndarray:
        """(M,) the object of each observation so far, in the order in which they came; -1 = left out."""
        return self._objects(np.array(self.tracklet_of, dtype=int))

    def landmarks(self) -> tuple[np.ndarray, np.ndarray]:
        """The objects so far, (K,) their oldest tracklets; and where each is believed to be, (K, 2) m, W."""
        objects = np.unique(self.labels)
        objects = objects[objects >= 0]
        return objects, self.tree.landmarks()[objects]

    def settle_all(self) -> None:
        """The drive is over: no tracklet will change its object any more."""
        self._recent = self._recent[:0]
        self._keep_for_good()

    def _drive(self, step, cov: np.ndarray) -> None:
        self.time += 1
        if (step is None) != (self.time == 0):
            raise ValueError(f"step: expected None for the first frame and only there, got {step} at {self.time}")
        if step is not None:
            self.tree.add_pose(step, np.linalg.inv(cov))
            nearby = self._nearby.after_step(np.asarray(step, dtype=float), cov)
            self._nearby = nearby.seen_since(self.time - LONGEST_GAP)

    def _tied(self, xy: np.ndarray, seen: np.ndarray, noise: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The tracklet of each observation (m,), -1 = none; and those that are new."""
        nearby = self._nearby
        distance = nearby.squared_distances(xy, noise) + class_distances(seen, nearby.classes)
        decision = assign(distance, *self._gates)
        matched, is_new = decision >= 0, decision == NEW
        tracklets = np.full(len(xy), -1)
        tracklets[matched] = nearby.tracklet[decision[matched]]
        tracklets[is_new] = [self._begun(place) for place in se2.apply(self.tree.pose, xy[is_new])]
        used = np.flatnonzero(tracklets >= 0)
        for k in used:
            self.tree.add_observation(tracklets[k], xy[k], np.linalg.inv(noise[k]))
        self.books.see(self.time, tracklets[used].tolist(), seen[used])
        nearby = nearby.updated(decision[matched], xy[matched], seen[matched], noise[matched], self.time)
        self._nearby = nearby.joined_by(tracklets[is_new], xy[is_new], seen[is_new], noise[is_new], self.time)
        self._recent = np.append(self._recent, tracklets[is_new])
        self.tracklet_of += tracklets.tolist()
        return tracklets, tracklets[is_new]

    def _begun(self, place: np.ndarray) -> int:
        """A new tracklet at (2,) m, W."""
        self.books.begin()
        return self.tree.add_landmark(place)

    def _fetch(self, xy: np.ndarray) -> None:
        """Have the old objects around the robot at hand, and let go of those left behind."""
        self._reach = max(self._reach, float(np.sqrt((xy**2).sum(axis=1).max())))
        far = REACH * self._reach + 3.0 * float(np.sqrt(max(self._cov[0, 0], self._cov[1, 1])))
        old = np.flatnonzero(self.books.alive)
        old = old[~np.isin(old, self._recent)]
        distance = np.hypot(*(self.tree.landmarks()[old] - self.tree.pose[:2]).T)
        order = np.argsort(distance, kind="stable")
        near, active = old[order[:MOST_NEAR]], self.tree.is_active()
        near = near[distance[order[:MOST_NEAR]] < far]
        self.tree.activate(near[~active[near]][:MOST_LIFTED])
        left_behind = old[active[old] & ~np.isin(old, near)]
        sizes = np.bincount(self.books.object[self.books.alive], minlength=len(active))
        alone = sizes[self.books.object[left_behind]] == 1  # none of the window may become it
        self.tree.activate(left_behind[alone], False)

    def _think(self, new: np.ndarray) -> None:
        """Where does the new go, does anything else go elsewhere, and where is the robot?"""
        front = Front.of(self.tree.front())
        labels = np.unique(self.books.object[front.ids], return_inverse=True)[1]
        self._seen_frames += 1
        ask_all = self._seen_frames % ASK_AGAIN == 0
        if len(new) or ask_all:
            labels = self._asked(front, labels, new, ask_all)
            self.books.object[front.ids] = front.ids[first_observations(labels)[labels]]
        values, _, cov = front.together(labels)
        self.tree.tell(values)
        self._cov = cov[:3, :3]
        seen = np.vstack([values[:2], values[3:].reshape(-1, 2)])
        self._box = np.array([np.minimum(self._box[0], seen.min(axis=0)), np.maximum(self._box[1], seen.max(axis=0))])
        if ask_all:
            self._keep_for_good()

    def _asked(self, front: Front, labels: np.ndarray, new: np.ndarray, ask_all: bool) -> np.ndarray:
        """Labels (N,) of the tracklets at hand, after those that are new, or all of the window, were asked."""
        alpha = self._alpha * max(np.count_nonzero(self.books.alive), 1)
        sampler = sampler_of(front, labels, self.books, alpha, self._area or area_around(self._box), self._rng)
        greedily(sampler, np.searchsorted(front.ids, new))
        if ask_all:
            asked_again(sampler, np.flatnonzero(np.isin(front.ids, self._recent)))
            self._recent = self._recent[~self._due()]
            kept = ~np.isin(front.ids, self._recent)
            kept[first_observations(sampler.labels)] = False
            without_doubtful(sampler, np.flatnonzero(kept))
        return sampler.labels

    def _due(self) -> np.ndarray:
        """Which of the recent tracklets leave the window, (n,) bool."""
        seen = self.books.last_seen[self._recent]
        due = seen < self.time - self._window
        out_of_sight = np.flatnonzero(seen < self.time - LONGEST_GAP)
        due[out_of_sight[np.argsort(seen[out_of_sight], kind="stable")][: max(len(seen) - MOST_RECENT, 0)]] = True
        return due

    def _keep_for_good(self) -> None:
        """What has left the window becomes its object."""
        alive = np.flatnonzero(self.books.alive & self.tree.is_active())
        gone = alive[(self.books.object[alive] != alive) & ~np.isin(alive, self._recent)]
        for tracklet in gone.tolist():
            stays = int(self.books.object[tracklet])
            self.tree.merge(tracklet, stays)
            self.books.merge(tracklet, stays)

    def _objects(self, tracklets: np.ndarray) -> np.ndarray:
        """The objects of tracklets (m,), as they are now; -1 stays."""
        return np.append(self.books.object[self.tree.became()], -1)[tracklets]
