"""The types that travel between the modules: frozen dataclasses of plain arrays, checked when they are made.

Frames: W is the world, R_t the robot at time t. Metres and radians. A pose is ``[x, y, theta]`` of R_t in W.
Arrays are copied to float64 (or int64) and made read-only, so nothing changes behind anybody's back.
"""

from dataclasses import dataclass

import numpy as np

from npslam_teach.factors import NO_HEADINGS, BetweenFactors, HeadingFactors, ObservationFactors
from npslam_teach.validation import (
    require_definite,
    require_distributions,
    require_positive,
    require_range,
    set_checked,
    set_headings,
)

__all__ = [
    "CLUTTER",
    "NO_HEADINGS",
    "UNKNOWN",
    "BetweenFactors",
    "GroundTruth",
    "HeadingFactors",
    "ObservationFactors",
    "PoseGraph",
    "RobotLog",
    "SensorModel",
    "Snapshot",
    "World",
]

CLUTTER, UNKNOWN = -1, -2  # what the true object of an observation can be, besides an index


@dataclass(frozen=True, eq=False)
class World:
    """What is really out there: object centres in W and their classes."""

    object_xy: np.ndarray  # (K, 2) m, W; NaN where nobody measured
    object_class: np.ndarray  # (K,) in [0, C)
    class_names: tuple  # C names
    object_theta: np.ndarray | None = None  # (K,) rad, W: which way each faces; NaN where nobody measured

    def __post_init__(self):
        object.__setattr__(self, "class_names", tuple(str(name) for name in self.class_names))
        set_checked(self, "object_xy", (None, 2), gaps=True)
        set_checked(self, "object_class", (len(self.object_xy),), int)
        require_range("object_class", self.object_class, 0, len(self.class_names), "a class index")
        if self.object_theta is not None:
            set_checked(self, "object_theta", (len(self.object_xy),), gaps=True)


@dataclass(frozen=True, eq=False)
class SensorModel:
    """How odometry and the object detector err; the simulator draws from it.

    ``class_confusion[c]`` is the distribution of the reported class when the true class is c (identity when None is
    given to ``simulate``). ``clutter_rate`` is the expected number of false detections per pose.
    """

    odometry_std: np.ndarray  # (3,) m, m, rad per step
    observation_std: np.ndarray  # (2,) m
    max_range: float  # m
    field_of_view: float  # rad, full opening angle
    class_confusion: np.ndarray | None = None  # (C, C), rows sum to one
    detection_probability: float = 1.0
    clutter_rate: float = 0.0
    observation_theta_std: float | None = None  # rad, of the heading of an object; None: headings are not seen
    class_symmetry: np.ndarray | None = None  # (C,) as in ``RobotLog``

    def __post_init__(self):
        for name, size in (("odometry_std", 3), ("observation_std", 2)):
            set_checked(self, name, (size,))
            if (getattr(self, name) < 0).any():
                raise ValueError(f"{name}: expected non-negative numbers, got {getattr(self, name).tolist()}")
        for name in ("max_range", "field_of_view", "clutter_rate"):
            if not (np.isfinite(getattr(self, name)) and getattr(self, name) >= 0):
                raise ValueError(f"{name}: expected a non-negative number, got {getattr(self, name)}")
        if not 0 <= self.detection_probability <= 1:
            raise ValueError(f"detection_probability: expected a number in [0, 1], got {self.detection_probability}")
        if self.class_confusion is not None:
            set_checked(self, "class_confusion", (len(self.class_confusion), len(self.class_confusion)))
            require_distributions("class_confusion", self.class_confusion)
        if self.observation_theta_std is not None:
            require_positive("observation_theta_std", np.asarray(self.observation_theta_std, dtype=float))
        if self.class_symmetry is not None:
            set_checked(self, "class_symmetry", (len(self.class_symmetry),), int)


@dataclass(frozen=True, eq=False)
class RobotLog:
    """All that an estimator may see. It holds no identity and no truth.

    Where steps or observations carry covariances of their own, the standard deviations are the typical ones.
    """

    odometry: np.ndarray  # (T-1, 3), R_{t+1} in R_t: m, m, rad
    obs_time: np.ndarray  # (M,) index of the pose that saw it, in [0, T)
    obs_xy: np.ndarray  # (M, 2) m, the object's centre in R_t
    obs_class: np.ndarray  # (M,) the detector's most likely class, in [0, num_classes)
    num_classes: int
    odometry_std: np.ndarray  # (3,) m, m, rad
    observation_std: np.ndarray  # (2,) m
    class_names: tuple | None = None  # num_classes names, for people only
    odometry_cov: np.ndarray | None = None  # (T-1, 3, 3) m, m, rad: of each step, in the order of its numbers
    observation_cov: np.ndarray | None = None  # (M, 2, 2) m^2: of each observation, in R_t
    class_probabilities: np.ndarray | None = None  # (M, C) what each observation says of its class, all alike before
    obs_theta: np.ndarray | None = None  # (M,) rad, which way the object faces, in R_t
    observation_theta_std: float | None = None  # rad, beside obs_theta
    class_symmetry: np.ndarray | None = None  # (C,) how many headings look alike: 1 one, 2 half-turn, 0 all (round)

    def __post_init__(self):
        set_checked(self, "odometry", (None, 3))
        set_checked(self, "obs_time", (None,), int)
        set_checked(self, "obs_xy", (len(self.obs_time), 2))
        set_checked(self, "obs_class", (len(self.obs_time),), int)
        set_checked(self, "odometry_std", (3,))
        set_checked(self, "observation_std", (2,))
        if int(self.num_classes) != self.num_classes or self.num_classes < 1:
            raise ValueError(f"num_classes: expected a positive integer, got {self.num_classes}")
        object.__setattr__(self, "num_classes", int(self.num_classes))
        require_range("obs_time", self.obs_time, 0, self.num_poses, "the index of a pose")
        require_range("obs_class", self.obs_class, 0, self.num_classes, "a class index")
        require_positive("odometry_std", self.odometry_std)
        require_positive("observation_std", self.observation_std)
        for name, count, size in (("odometry_cov", len(self.odometry), 3), ("observation_cov", len(self.obs_time), 2)):
            if getattr(self, name) is not None:
                set_checked(self, name, (count, size, size))
                require_definite(name, getattr(self, name))
        if self.class_probabilities is not None:
            set_checked(self, "class_probabilities", (self.num_observations, self.num_classes))
            require_distributions("class_probabilities", self.class_probabilities)
        set_headings(self)
        if self.class_names is not None and len(self.class_names) != self.num_classes:
            raise ValueError(f"class_names: expected {self.num_classes} names, got {len(self.class_names)}")

    @property
    def num_poses(self) -> int:
        """T, one more than there are odometry steps."""
        return len(self.odometry) + 1

    @property
    def num_observations(self) -> int:
        """M."""
        return len(self.obs_time)


@dataclass(frozen=True, eq=False)
class GroundTruth:
    """What really happened, as far as it is known. Only ``evaluate`` and ``plotting`` may look at it."""

    world: World
    poses: np.ndarray  # (T, 3) W; NaN where nobody measured, be it a whole pose or its heading
    obs_object: np.ndarray  # (M,) index into the world's objects, CLUTTER or UNKNOWN

    def __post_init__(self):
        set_checked(self, "poses", (None, 3), gaps=True)
        set_checked(self, "obs_object", (None,), int)
        what = "an object index (-1 = clutter, -2 = unknown)"
        require_range("obs_object", self.obs_object, UNKNOWN, len(self.world.object_xy), what)

    @property
    def is_complete(self) -> bool:
        """Whether nothing is unknown."""
        numbers = np.concatenate([self.poses.ravel(), self.world.object_xy.ravel()])
        return not np.isnan(numbers).any() and not (self.obs_object == UNKNOWN).any()


@dataclass(frozen=True, eq=False)
class PoseGraph:
    """Estimates of poses and landmarks, and the factors that tie them together.

    What is fixed stays where it is when the graph is solved: pose 0, unless something else is asked for.
    """

    poses: np.ndarray  # (T, 3) W
    landmarks: np.ndarray  # (K, 2) m, W; or (K, 3) with headings, rad
    between: BetweenFactors
    observations: ObservationFactors
    fixed_poses: np.ndarray = (0,)  # indices, each once
    fixed_landmarks: np.ndarray = ()  # indices, each once
    pose_ids: tuple[int, ...] | None = None  # what a file calls them; None: by their index
    landmark_ids: tuple[int, ...] | None = None
    headings: HeadingFactors = NO_HEADINGS  # of landmarks, where these have any

    def __post_init__(self):
        set_checked(self, "poses", (None, 3))
        set_checked(self, "landmarks", (None, 3 if np.shape(self.landmarks)[1:] == (3,) else 2))
        set_checked(self, "fixed_poses", (None,), int)
        set_checked(self, "fixed_landmarks", (None,), int)
        if len(self.poses) == 0:
            raise ValueError("poses: expected at least one pose, got none")
        if len(self.fixed_poses) + len(self.fixed_landmarks) == 0:
            raise ValueError("fixed_poses: expected at least one fixed pose or landmark, got none")
        for name, variables in (("pose_ids", self.poses), ("landmark_ids", self.landmarks)):
            ids = getattr(self, name)
            if ids is not None and len(ids) != len(variables):
                raise ValueError(f"{name}: expected {len(variables)} ids, got {len(ids)}")
        if len(self.headings.pose) and self.landmarks.shape[1] != 3:
            raise ValueError(f"landmarks: expected shape (any, 3) with headings, got {self.landmarks.shape}")
        self._require_indices()

    @property
    def landmark_xy(self) -> np.ndarray:
        """(K, 2) m, W: where the landmarks are, whichever way they face."""
        return self.landmarks[:, :2]

    def _require_indices(self) -> None:
        pose, landmark = (len(self.poses), "the index of a pose"), (len(self.landmarks), "the index of a landmark")
        for name, index, (high, what) in (
            ("between.i", self.between.i, pose),
            ("between.j", self.between.j, pose),
            ("observations.pose", self.observations.pose, pose),
            ("observations.landmark", self.observations.landmark, landmark),
            ("headings.pose", self.headings.pose, pose),
            ("headings.landmark", self.headings.landmark, landmark),
            ("fixed_poses", self.fixed_poses, pose),
            ("fixed_landmarks", self.fixed_landmarks, landmark),
        ):
            require_range(name, index, 0, high, what)


@dataclass(frozen=True, eq=False)
class Snapshot:
    """One iteration of a method: who is who, and where everything is."""

    iteration: int
    labels: np.ndarray  # (M,) index of the object; -1 = used by no object
    votes: np.ndarray  # (K, C+1); column 0 is the false-positive vote
    graph: PoseGraph
    chi2: float
    objective: float | None  # None where the method lowers no such number

    def __post_init__(self):
        set_checked(self, "labels", (None,), int)
        set_checked(self, "votes", (len(self.graph.landmarks), None))
        require_range("labels", self.labels, -1, len(self.votes), "an object index (-1 = none)")

    @property
    def num_objects(self) -> int:
        """K."""
        return len(self.votes)
