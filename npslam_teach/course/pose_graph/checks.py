"""Checks of lesson 03: residuals, a Jacobian, one step of the solver, and a covariance, each on random inputs."""

from collections.abc import Callable
from functools import partial

import numpy as np

from npslam_teach import se2
from npslam_teach.course import drawings
from npslam_teach.course.checking import Verdict, wrong
from npslam_teach.course.pose_graph.check_inputs import between_residual_inputs
from npslam_teach.course.pose_graph.random_system import random_system
from npslam_teach.course.trials import Part, check_function, fresh
from npslam_teach.course.verdict_page import exercise
from npslam_teach.pose_graph import between_residual, observation_jacobians, observation_residual


@exercise("03", 1, of=5)
def check_observation_residual(student: Callable) -> Verdict:
    """Exercise 1: ``(pose, landmark, measured)`` to (2,) m, in the frame of the pose."""

    def truth(pose, landmark, measured):
        return observation_residual(pose, landmark, measured)

    seen = se2.apply_inverse
    mistakes = {
        "the sign is turned round: the prediction comes first, then what was measured": lambda p, x, z: z - seen(p, x),
        "this is where the object should be seen; what was measured has not been subtracted": lambda p, x, z: seen(
            p, x
        ),
        "the difference is still in the room's frame: it is not turned": lambda p, x, z: x - p[:2] - z,
        "you turned by +theta; from the room into the robot's frame it is the other way": lambda p, x, z: (
            se2.rotate(p[2], x - p[:2]) - z
        ),
        "the robot's own position is missing": lambda p, x, z: se2.rotate(-p[2], x) - z,
        "this is the residual in the room, not in the robot's frame": lambda p, x, z: x - se2.apply(p, z),
    }
    rng = fresh()
    trials = [(_pose(rng), rng.uniform(-3, 3, 2), rng.uniform(-3, 3, 2)) for _ in range(12)]
    pose, landmark, measured = trials[0]
    edges = {
        "with the object at the robot": [(pose, pose[:2].copy(), measured)],
        "with a measurement that is right": [(pose, landmark, seen(pose, landmark))],
    }
    praise = "that is the spring between a pose and an object"
    return _check("the residual", student, truth, mistakes, trials, edges, praise)


@exercise("03", 2, of=5)
def check_observation_jacobian(student: Callable) -> Verdict:
    """Exercise 2: ``(pose, landmark)`` to (2, 3), the derivative of exercise 1 by the pose."""

    def truth(pose, landmark):
        return observation_jacobians(pose, landmark)[0]

    def third(pose, landmark, column):
        return np.column_stack([truth(pose, landmark)[:, :2], column])

    mistakes = {
        "the third column has the wrong sign: turn left, and what you see turns right": lambda p, x: (
            truth(p, x) * [1, 1, -1]
        ),
        "the first two columns have the wrong sign: drive ahead, and things come nearer": lambda p, x: (
            truth(p, x) * [-1, -1, 1]
        ),
        "every sign is turned round": lambda p, x: -truth(p, x),
        "the first two columns hold R where R transposed belongs": lambda p, x: np.column_stack(
            [-observation_jacobians(p, x)[1].T, truth(p, x)[:, 2]]
        ),
        "the third column is in the room's frame": lambda p, x: third(p, x, [x[1] - p[1], p[0] - x[0]]),
        "the third column is zero: turning moves what you see": lambda p, x: third(p, x, np.zeros(2)),
    }
    rng = fresh()
    trials = [(_pose(rng), rng.uniform(-3, 3, 2)) for _ in range(12)]
    edges = {"with the object at the robot": [(trials[0][0], trials[0][0][:2].copy())]}
    praise = "central differences agree, and yours needs a single evaluation"
    hint = "your own central differences would tell: column "
    return _check("the Jacobian", student, truth, mistakes, trials, edges, praise, hint)


@exercise("03", 3, of=5)
def check_between_residual(student: Callable) -> Verdict:
    """Exercise 3: ``(pose_i, pose_j, measured)`` to (3,) m, m, rad, in the frame of pose i, the angle wrapped."""

    def truth(pose_i, pose_j, measured):
        return between_residual(pose_i, pose_j, measured)

    def other(pose_i, pose_j, measured, turn=None, heading=None):
        expected, apart = truth(pose_i, pose_j, measured), pose_j[:2] - pose_i[:2]
        xy = expected[:2] if turn is None else se2.rotate(turn(pose_i, pose_j), apart) - measured[:2]
        return np.append(xy, expected[2] if heading is None else heading(pose_i, pose_j, measured))

    mistakes = {
        "the angle is wrapped before the subtraction, and the subtraction can leave the range again": partial(
            other, heading=lambda i, j, z: se2.wrap(j[2] - i[2]) - z[2]
        ),
        "the angle is not wrapped: it may be off by a full turn": partial(
            other, heading=lambda i, j, z: j[2] - i[2] - z[2]
        ),
        "the sign is turned round: the prediction comes first, then what was measured": lambda *t: -truth(*t),
        "the step is still in the room's frame: turn it into pose i's": partial(other, turn=lambda i, j: 0.0),
        "you turned by +theta_i; from the room into the frame of pose i it is the other way": partial(
            other, turn=lambda i, j: i[2]
        ),
        "you turned by pose j's heading; the wheels measure in the frame of pose i": partial(
            other, turn=lambda i, j: -j[2]
        ),
        "the positions of the two poses are swapped": lambda i, j, z: np.append(
            -2 * z[:2] - truth(i, j, z)[:2], truth(i, j, z)[2]
        ),
    }
    praise = "also where the heading jumps from +180 to -180 degrees"
    return _check("the residual", student, truth, mistakes, *between_residual_inputs(), praise)


@exercise("03", 4, of=5)
def check_gauss_newton_step(student: Callable) -> Verdict:
    """Exercise 4: the whole ``H`` (n, n) with pose 0 in its first three rows, ``b`` (n,), to the step (n,)."""

    def truth(H, b):
        return _held(H, b, slice(3, None))

    mistakes = {
        "the sign is turned round: this step climbs": lambda H, b: -truth(H, b),
        "you added the identity: pose 0 moves, and every step is short": lambda H, b: (
            -np.linalg.solve(H + np.eye(len(b)), b)
        ),
        "this is the shortest of all steps; it moves pose 0, which should stand still": lambda H, b: (
            -np.linalg.pinv(H) @ b
        ),
        "you held the last three unknowns still; pose 0 is the first three": lambda H, b: _held(H, b, slice(0, -3)),
        "only the diagonal of H was used: the unknowns pull on each other": lambda H, b: -b / np.diag(H),
    }
    rng = fresh()
    trials = [random_system(rng, num_landmarks) for num_landmarks in (2, 2, 1, 3, 2)]
    edges = {"at the minimum, where b is zero": [(trials[0][0], np.zeros(len(trials[0][1])))]}
    moves = "pose 0 moves; hold it still, because H alone has no inverse"
    part = Part("the step", mistakes, _close, hint=lambda answers, _: moves if _moved(answers) else "")
    praise = "a singular system, solved by deciding where the map begins"
    return _about_the_gauge(check_function(student, truth, part, trials, edges, praise))


def _moved(steps: list) -> bool:
    return any(not np.allclose(step[:3], 0.0, atol=1e-6) for step in steps)


def _about_the_gauge(verdict: Verdict) -> Verdict:
    if "LinAlgError" in verdict.message:
        return wrong(f"{verdict.message}; H alone has no inverse, because the whole map may still be moved")
    for size in (13, 11, 15):
        if f"shape ({size},), yours has ({size - 3},)" in verdict.message:
            return wrong(f"{verdict.message}: put three zeros in front, for pose 0")
    return verdict


def _held(H: np.ndarray, b: np.ndarray, free: slice) -> np.ndarray:
    """The step when all unknowns but ``free`` are held fixed."""
    step = np.zeros(len(b))
    step[free] = -np.linalg.solve(H[free, free], b[free])
    return step


@exercise("03", 5, of=5)
def check_landmark_covariance(student: Callable) -> Verdict:
    """Exercise 5: ``(H, num_poses, k)``, H without pose 0, to the covariance (2, 2) m^2 of landmark k.

    ``linearize`` returns a sparse H, and the cells before have dense ones: what is right for either of them passes.
    """
    from scipy.sparse import csc_array, csc_matrix

    verdicts = [_landmark_covariance(student, kind) for kind in (np.array, csc_array, csc_matrix)]
    return next((each for each in verdicts if each.passed), verdicts[0])


def _landmark_covariance(student: Callable, kind: Callable) -> Verdict:
    def truth(H, num_poses, k):
        return _block(np.linalg.inv(_dense(H)), _at(num_poses, k))

    def root(H, n, k):
        return np.sqrt(np.abs(truth(H, n, k)))

    mistakes = {
        "this is a block of H: it tells how much is known, not how much is uncertain": lambda H, n, k: _block(
            _dense(H), _at(n, k)
        ),
        "you inverted the block alone, as if all poses were known exactly": lambda H, n, k: np.linalg.inv(
            _block(_dense(H), _at(n, k))
        ),
        "three places too late: pose 0 is not in H": lambda H, n, k: _block(np.linalg.inv(_dense(H)), _at(n, k) + 3),
        "this is a piece of a pose: the landmarks come after the poses": lambda H, n, k: _block(
            np.linalg.inv(_dense(H)), 2 * k
        ),
        "these are square roots; a covariance is in square metres": root,
    }
    rng, trials = fresh(), []
    for num_poses, num_landmarks, k in ((3, 4, 0), (4, 4, 1), (5, 5, 2), (3, 5, 1), (6, 3, 0)):
        size = 3 * (num_poses - 1) + 2 * num_landmarks
        factor = rng.normal(size=(size, size + 5))
        trials.append((kind(factor @ factor.T), num_poses, k))
    whole = trials[-1][0]
    edges = {
        "for the last landmark": [(whole, 6, 2)],
        "with pose 0 alone, which is not in H": [(kind(np.eye(4)), 1, 1)],
    }
    praise = "the uncertainty of all poses is in it, without having asked for it"
    drawing = drawings.landmark_covariance(kind)
    return _check("the covariance", student, truth, mistakes, trials, edges, praise, drawing=drawing)


def _dense(H) -> np.ndarray:
    return H.toarray() if hasattr(H, "toarray") else H


def _at(num_poses: int, k: int) -> int:
    return 3 * (num_poses - 1) + 2 * k


def _block(matrix: np.ndarray, at: int) -> np.ndarray:
    return matrix[at : at + 2, at : at + 2]


def _pose(rng: np.random.Generator) -> np.ndarray:
    return np.append(rng.uniform(-3, 3, 2), rng.uniform(-np.pi, np.pi))


def _check(name, student, truth, mistakes, trials, edges, praise, column: str = "", drawing=None) -> Verdict:
    """Judge with the tolerance of a derivative by differences; say which entry is off, or which column."""

    def where(answers, expected):
        answer, wanted = next((a, e) for a, e in zip(answers, expected, strict=True) if not _close(a, e, 1e-6))
        off = np.unravel_index(np.abs(answer - wanted).argmax(), answer.shape)
        place = f"{column}{off[-1]}" if column else f"entry {', '.join(str(int(k)) for k in off)}"
        return f"{place} is off by {np.abs(answer - wanted).max():.3g}"

    return check_function(student, truth, Part(name, mistakes, _close, hint=where), trials, edges, praise, drawing)


def _close(answer: np.ndarray, other, tolerance: float) -> bool:
    return answer.shape == np.shape(other) and np.allclose(answer, other, rtol=tolerance, atol=3 * tolerance)
