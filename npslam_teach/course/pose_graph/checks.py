"""Checks of lesson 03: residuals, a Jacobian, one step of the solver, and a covariance, each on random inputs."""

from collections.abc import Callable

import numpy as np

from npslam_teach import se2
from npslam_teach.course.checking import Verdict, array_from, judge, numerical_jacobian, right, wrong
from npslam_teach.pose_graph import between_residual, observation_jacobians, observation_residual

TRIALS = 5


def check_observation_residual(student: Callable) -> Verdict:
    """Exercise 1: ``(pose, landmark, measured)`` to (2,) m, in the frame of the pose."""
    rng = np.random.default_rng(1)
    for _ in range(TRIALS):
        pose, landmark, measured = _pose(rng), rng.uniform(-3, 3, 2), rng.uniform(-3, 3, 2)
        answer, verdict = array_from("the residual", student, (2,), pose, landmark, measured)
        if verdict:
            return verdict
        seen = se2.apply_inverse(pose, landmark)
        mistakes = [
            (measured - seen, "the sign is turned round: the prediction comes first, then what was measured"),
            (seen, "this is where the object should be seen; what was measured has not been subtracted"),
            (landmark - pose[:2] - measured, "the difference is still in the room's frame: it is not turned"),
            (
                se2.rotate(pose[2], landmark - pose[:2]) - measured,
                "you turned by +theta; from the room into the robot's frame it is the other way",
            ),
            (se2.rotate(-pose[2], landmark) - measured, "the robot's own position is missing"),
            (landmark - se2.apply(pose, measured), "this is the residual in the room, not in the robot's frame"),
        ]
        verdict = _compare(answer, observation_residual(pose, landmark, measured), mistakes)
        if verdict:
            return verdict
    return right("that is the spring between a pose and an object")


def check_observation_jacobian(student: Callable) -> Verdict:
    """Exercise 2: ``(pose, landmark)`` to (2, 3), the derivative of exercise 1 by the pose."""
    rng = np.random.default_rng(2)
    for _ in range(TRIALS):
        pose, landmark = _pose(rng), rng.uniform(-3, 3, 2)
        answer, verdict = array_from("the Jacobian", student, (2, 3), pose, landmark)
        if verdict:
            return verdict
        by_pose, by_landmark = observation_jacobians(pose, landmark)
        turned_wrongly = np.column_stack([-by_landmark.T, by_pose[:, 2]])
        offset = landmark - pose[:2]
        mistakes = [
            (by_pose * [1, 1, -1], "the third column has the wrong sign: turn left, and what you see turns right"),
            (by_pose * [-1, -1, 1], "the first two columns have the wrong sign: drive ahead, and things come nearer"),
            (-by_pose, "every sign is turned round"),
            (turned_wrongly, "the first two columns hold R where R transposed belongs"),
            (np.column_stack([by_pose[:, :2], [offset[1], -offset[0]]]), "the third column is in the room's frame"),
            (np.column_stack([by_pose[:, :2], np.zeros(2)]), "the third column is zero: turning moves what you see"),
        ]
        verdict = _compare(answer, by_pose, mistakes, "your own central differences would tell: column ")
        if verdict:
            return verdict
    return right("central differences agree, and yours needs a single evaluation")


def check_between_residual(student: Callable) -> Verdict:
    """Exercise 3: ``(pose_i, pose_j, measured)`` to (3,) m, m, rad, in the frame of pose i, the angle wrapped."""
    rng = np.random.default_rng(3)
    # The last three cross 180 degrees: between the two headings, or between the turn and its measurement.
    headings = [(0.3, 0.9), (1.2, -0.4), (3.0, -3.0), (-3.1, 3.1), (-0.1, 3.0)]
    for theta_i, theta_j in headings:
        pose_i, pose_j = np.append(rng.uniform(-3, 3, 2), theta_i), np.append(rng.uniform(-3, 3, 2), theta_j)
        measured = np.append(rng.uniform(-1, 1, 2), se2.wrap(theta_j - theta_i + 0.1))
        answer, verdict = array_from("the residual", student, (3,), pose_i, pose_j, measured)
        if verdict:
            return verdict
        expected = between_residual(pose_i, pose_j, measured)
        verdict = _compare(answer, expected, _mistakes_between(pose_i, pose_j, measured, expected))
        if verdict:
            return verdict
    return right("also where the heading jumps from +180 to -180 degrees")


def _mistakes_between(pose_i, pose_j, measured, expected) -> list:
    apart = pose_j[:2] - pose_i[:2]
    unwrapped = np.append(expected[:2], pose_j[2] - pose_i[2] - measured[2])
    partly = np.append(expected[:2], se2.wrap(pose_j[2] - pose_i[2]) - measured[2])
    return [
        (partly, "the angle is wrapped before the subtraction, and the subtraction can leave the range again"),
        (unwrapped, "the angle is not wrapped: it may be off by a full turn"),
        (-expected, "the sign is turned round: the prediction comes first, then what was measured"),
        (np.append(apart - measured[:2], expected[2]), "the step is still in the room's frame: turn it into pose i's"),
        (
            np.append(se2.rotate(pose_i[2], apart) - measured[:2], expected[2]),
            "you turned by +theta_i; from the room into the frame of pose i it is the other way",
        ),
        (
            np.append(se2.rotate(-pose_j[2], apart) - measured[:2], expected[2]),
            "you turned by pose j's heading; the wheels measure in the frame of pose i",
        ),
        (np.append(-2 * measured[:2] - expected[:2], expected[2]), "the positions of the two poses are swapped"),
    ]


def check_gauss_newton_step(student: Callable) -> Verdict:
    """Exercise 4: the whole ``H`` (n, n) with pose 0 in its first three rows, ``b`` (n,), to the step (n,)."""
    rng = np.random.default_rng(4)
    for _ in range(TRIALS):
        H, b = _normal_equations(rng)
        answer, verdict = array_from("the step", student, b.shape, H.copy(), b.copy())
        if verdict:
            return _about_the_gauge(verdict, len(b))
        expected = _held(H, b, slice(3, None))
        mistakes = [
            (-expected, "the sign is turned round: this step climbs"),
            (-np.linalg.solve(H + np.eye(len(b)), b), "you added the identity: pose 0 moves, and every step is short"),
            (-np.linalg.pinv(H) @ b, "this is the shortest of all steps; it moves pose 0, which should stand still"),
            (_held(H, b, slice(0, -3)), "you held the last three unknowns still; pose 0 is the first three"),
            (-b / np.diag(H), "only the diagonal of H was used: the unknowns pull on each other"),
        ]
        verdict = _compare(answer, expected, mistakes)
        if verdict:
            moved = verdict.message.startswith("entry") and not np.allclose(answer[:3], 0.0, atol=1e-9)
            return wrong("pose 0 moves; hold it still, because H alone has no inverse") if moved else verdict
    return right("a singular system, solved by deciding where the map begins")


def _about_the_gauge(verdict: Verdict, size: int) -> Verdict:
    if "LinAlgError" in verdict.message:
        return wrong(f"{verdict.message}; H alone has no inverse, because the whole map may still be moved")
    if f"yours has ({size - 3},)" in verdict.message:
        return wrong(f"{verdict.message}: put three zeros in front, for pose 0")
    return verdict


def _held(H: np.ndarray, b: np.ndarray, free: slice) -> np.ndarray:
    """The step when all unknowns but ``free`` are held fixed."""
    step = np.zeros(len(b))
    step[free] = -np.linalg.solve(H[free, free], b[free])
    return step


def check_landmark_covariance(student: Callable) -> Verdict:
    """Exercise 5: ``(H, num_poses, k)``, H without pose 0, to the covariance (2, 2) m^2 of landmark k."""
    rng = np.random.default_rng(5)
    for _ in range(TRIALS):
        num_poses, num_landmarks = int(rng.integers(3, 6)), 4
        size = 3 * (num_poses - 1) + 2 * num_landmarks
        root = rng.normal(size=(size, size + 5))
        H, k = root @ root.T, int(rng.integers(0, 2))
        answer, verdict = array_from("the covariance", student, (2, 2), H.copy(), num_poses, k)
        if verdict:
            return verdict
        at = 3 * (num_poses - 1) + 2 * k
        expected = np.linalg.inv(H)[at : at + 2, at : at + 2]
        verdict = _compare(answer, expected, _mistakes_covariance(H, at, k))
        if verdict:
            return verdict
    return right("the uncertainty of all poses is in it, without having asked for it")


def _mistakes_covariance(H: np.ndarray, at: int, k: int) -> list:
    inverse, here = np.linalg.inv(H), slice(at, at + 2)
    late, early = slice(at + 3, at + 5), slice(2 * k, 2 * k + 2)
    return [
        (H[here, here], "this is a block of H: it tells how much is known, not how much is uncertain"),
        (np.linalg.inv(H[here, here]), "you inverted the block alone, as if all poses were known exactly"),
        (inverse[late, late], "three places too late: pose 0 is not in H"),
        (inverse[early, early], "this is a piece of a pose: the landmarks come after the poses"),
        (np.sqrt(np.abs(inverse[here, here])), "these are square roots; a covariance is in square metres"),
    ]


def _pose(rng: np.random.Generator) -> np.ndarray:
    return np.append(rng.uniform(-3, 3, 2), rng.uniform(0.4, 2.5))


def _compare(answer: np.ndarray, expected: np.ndarray, mistakes: list, hint: str = "") -> Verdict | None:
    """None if the answer is right; else a verdict that names the mistake, or the entry that differs most."""

    def where():
        off = np.unravel_index(np.abs(answer - expected).argmax(), answer.shape)
        place = f"{hint}{off[-1]}" if hint else f"entry {', '.join(str(int(k)) for k in off)}"
        return f"{place} is off by {np.abs(answer - expected).max():.3g}"

    by_message = {message: typical for typical, message in mistakes}
    return judge(answer, expected, by_message, where, same=_close, like=_close)


def _close(answer: np.ndarray, other: np.ndarray) -> bool:
    return answer.shape == other.shape and np.allclose(answer, other, rtol=1e-6, atol=1e-6)


def _normal_equations(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """H and b of one small random graph of three poses and two landmarks, pose 0 not held."""
    poses = np.column_stack([rng.uniform(-3, 3, (3, 2)), rng.uniform(-3, 3, 3)])
    landmarks = rng.uniform(-3, 3, (2, 2))

    def residuals(unknowns):
        x, points = unknowns[:9].reshape(3, 3), unknowns[9:].reshape(2, 2)
        steps = [between_residual(x[t], x[t + 1], measured_steps[t]) for t in (0, 1)]
        seen = [observation_residual(x[t], points[k], measured[t, k]) for t in range(3) for k in range(2)]
        return np.concatenate(steps + seen)

    measured_steps = se2.between(poses[:-1], poses[1:]) + rng.normal(0, 0.2, (2, 3))
    measured = se2.apply_inverse(poses[:, None], landmarks[None]) + rng.normal(0, 0.2, (3, 2, 2))
    at = np.concatenate([poses.ravel(), landmarks.ravel()])
    jacobian = numerical_jacobian(residuals, at)
    return 10 * jacobian.T @ jacobian, 10 * jacobian.T @ residuals(at)
