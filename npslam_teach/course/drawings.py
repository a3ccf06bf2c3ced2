"""What a verdict draws of an answer over the library's: one exercise of each lesson, whose answer is a curve or a map.

The inputs are the same each time, so that a picture changes only when the student's function does.
"""

import numpy as np

from npslam_teach import linearize, simulate
from npslam_teach.course.drawn import Drawing, curve, floor_map
from npslam_teach.evaluation import true_association_fit
from npslam_teach.methods.snapshots import PAPER_ODOMETRY_STD, initial_snapshot
from npslam_teach.types import RobotLog

_CIRCLE = np.column_stack([np.cos(turn := np.linspace(0, 2 * np.pi, 60)), np.sin(turn)])


def front_end() -> Drawing:
    """Lesson 01: how many objects the rule finds, by its reach."""
    rng = np.random.default_rng(0)
    objects = np.array([[0.0, 0.0], [2.5, 0.0], [0.0, 2.5], [2.5, 2.5]])
    xy, obs_class = np.repeat(objects, 12, axis=0) + rng.normal(0, 0.3, (48, 2)), np.repeat([0, 1, 0, 1], 12)
    reach = np.linspace(0.05, 3, 40)
    inputs = [(xy, obs_class, each) for each in reach]
    return curve(inputs, reach, "reach (m)", "objects found", lambda labels: len(np.unique(labels)))


def dead_reckoning() -> Drawing:
    """Lesson 02: the path that the wheels report."""
    log, truth = simulate.fifteen_objects()
    return floor_map([(log.odometry[:300], truth.poses[0])], lambda path, *_: np.asarray(path)[:, :2])


def landmark_covariance(kind=np.array) -> Drawing:
    """Lesson 03: the ellipse of each object of the toy scene, two standard deviations wide.

    Args:
        kind: of matrix that the exercise is given.
    """
    graph = true_association_fit(*simulate.toy_objects())
    H, _, _ = linearize(graph)

    def outline(cov, _, __, k):
        return graph.landmarks[k] + 2 * _CIRCLE @ np.linalg.cholesky(np.asarray(cov, dtype=float)).T

    return floor_map([(kind(H.toarray()), len(graph.poses), k) for k in range(len(graph.landmarks))], outline)


def expected_tables() -> Drawing:
    """Lesson 04: the expected number of tables, by the number of guests."""
    guests = np.arange(1, 61)
    inputs = [(int(n), 0.9) for n in guests]
    return curve(inputs, guests, "guests", "expected tables at alpha = 0.9")


def log_density() -> Drawing:
    """Lesson 05: the density of a Dirichlet along a line through the triangle."""
    share = np.linspace(0.02, 0.88, 44)
    inputs = [(np.array([each, 0.9 - each, 0.1]), np.array([8.0, 4.0, 2.0])) for each in share]
    return curve(inputs, share, "probability of the first class, that of the third is 0.1", "log density")


def one_alternation() -> Drawing:
    """Lesson 06: the path of the toy scene after one round."""
    log, _ = simulate.toy_objects()
    begun = initial_snapshot(log, PAPER_ODOMETRY_STD, log.observation_std, alpha=0.5)
    return floor_map([(log, begun.graph, begun.labels, 0.5, log.observation_std)], _path_of_round)


def adjusted_rand() -> Drawing:
    """Lesson 07: the index while more and more sightings are given at random."""
    rng = np.random.default_rng(0)
    true_labels, others = rng.integers(0, 5, 60), rng.integers(0, 5, 60)
    counts = np.arange(0, 61, 3)
    inputs = [(true_labels, np.where(np.arange(60) < n, others, true_labels)) for n in counts]
    return curve(inputs, counts, "sightings of 60 whose object is drawn by lot", "adjusted Rand index")


def floor_pose() -> Drawing:
    """Lesson 08: where a camera has been on the floor, from its poses in three dimensions."""
    cameras = []
    for t in np.linspace(0, 1.7 * np.pi, 40):
        camera = np.eye(4)
        camera[:3, :3] = [[np.cos(t), 0, -np.sin(t)], [0, 1, 0], [np.sin(t), 0, np.cos(t)]]
        camera[:3, 3] = 1.5 * np.sin(t), 0.0, 3 * t / np.pi + 1.5 * np.cos(t)
        cameras.append((camera,))
    return floor_map(cameras, lambda pose, _: np.asarray(pose)[:2], is_one=True)


def nis_bounds() -> Drawing:
    """Lesson 09: both bounds by the number of matches."""
    matches = np.arange(2, 201, 4)
    return curve([(int(n), 0.95) for n in matches], matches, "matches", "95 % bounds of the average NIS")


def wilson() -> Drawing:
    """Lesson 10: the interval by the number of successes of thirty."""
    successes = np.arange(31)
    inputs = [(int(k), 30, 1.96) for k in successes]
    return curve(inputs, successes, "rooms right, of 30", "95 % interval of the share")


def crp_probability() -> Drawing:
    """Lesson 11: the probability of one seating, by alpha."""
    alpha = np.linspace(0.1, 6, 50)
    inputs = [(np.array([3, 1, 1]), float(each)) for each in alpha]
    return curve(inputs, alpha, "alpha", "probability of tables of 3, 1, 1")


def growth() -> Drawing:
    """Lesson 12: the error of n steps ahead and to the left, where the errors of steps are white noise."""
    log, truth = simulate.fifteen_objects()
    steps = np.arange(1, 41, 2)
    inputs = [(log.odometry, truth.poses, int(n)) for n in steps]
    return curve(
        inputs, steps, "steps taken together", "error ahead, and to the left (m)", lambda error: np.asarray(error)[:2]
    )


def m_step() -> Drawing:
    """Lesson 13: the places of four objects, from sightings that are sure ahead and unsure sideways."""
    rng = np.random.default_rng(0)
    objects = np.array([[0.0, 0.0], [2.0, 0.5], [1.0, 2.0], [3.0, 2.0]])
    seen = np.repeat(objects, 6, axis=0) + rng.normal(0, 0.2, (24, 2))
    weights = np.exp(-np.linalg.norm(seen[:, None] - objects, axis=2))
    information = np.tile([[25.0, 8.0], [8.0, 4.0]], (24, 1, 1))
    inputs = [(seen, weights / weights.sum(axis=1, keepdims=True), information)]
    return floor_map(inputs, lambda places, *_: places, style="o")


def smallest_turn() -> Drawing:
    """Lesson 14: how far a table is turned, as far as anybody can see, by how far it was turned."""
    turn = np.linspace(-3, 3, 121)
    inputs = [(np.array([each]), 2) for each in turn]
    return curve(inputs, turn, "turn of a table (rad)", "smallest turn that looks alike (rad)")


def join_gain() -> Drawing:
    """Lesson 15: what it gains to join a pass and an old object, by how far apart they lie."""
    distance = np.linspace(0, 3, 61)
    inputs = [(np.array([each, 0.0]), np.diag([0.25, 0.25]), 0.01) for each in distance]
    return curve(inputs, distance, "pass and old object apart (m), drift 0.5 m", "gain of joining (nats)")


def _path_of_round(answer, log: RobotLog, *_) -> np.ndarray:
    """The poses of the second thing returned: a graph, or what the check makes of it, chi2 and the poses' numbers."""
    graph = answer[1]
    return (graph.poses if hasattr(graph, "poses") else graph[1:].reshape(log.num_poses, 3))[:, :2]
