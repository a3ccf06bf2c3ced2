"""Checking exercises: a verdict that says what is wrong, and the tools that the checks share.

Every lesson has a module of its own, such as ``course.pose_graph.checks``, with one ``check_*`` for each exercise. A
check never raises on a wrong answer: it returns a ``Verdict``, whose text is the last value of the cell.
"""

import contextlib
import io
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

BLANK = "nothing has been filled in yet: replace the dots"


@dataclass(frozen=True)
class Verdict:
    """The outcome of a check; it displays itself as one sentence."""

    passed: bool
    message: str

    def __repr__(self) -> str:
        return f"{'Right' if self.passed else 'Not yet'}: {self.message}."


def right(message: str) -> Verdict:
    """The exercise is solved; the message says what the answer is good for."""
    return Verdict(True, message)


def wrong(message: str) -> Verdict:
    """The exercise is not solved; the message names the mistake and does not give the answer away."""
    return Verdict(False, message)


def is_blank(answer) -> bool:
    """Whether the student's answer is still the dots, or a function that returns nothing."""
    return answer is ... or answer is None


def answer_of(function: Callable, *arguments) -> tuple[object, Verdict | None]:
    """Call the student's function, and turn any exception into a verdict.

    Returns:
        what it returned, and None; or None and the verdict.
    """
    if is_blank(function):
        return None, wrong(BLANK)
    try:
        answer = function(*arguments)
    except Exception as error:  # a student's code may raise anything, and the lesson must go on
        return None, wrong(f"your code stops with {type(error).__name__}: {error}")
    return (None, wrong(BLANK)) if is_blank(answer) else (answer, None)


def require(check: Callable, answer) -> None:
    """What a graded cell runs: nothing happens if the check passes.

    Warnings and other output on standard error are suppressed: nbgrader takes them for a failure, and a right answer
    that divides by zero in between would lose its marks.

    Raises:
        AssertionError: the check does not pass; the message is the verdict.
    """
    with warnings.catch_warnings(), contextlib.redirect_stderr(io.StringIO()):
        warnings.simplefilter("ignore")
        verdict = check(answer)
    if not verdict.passed:
        raise AssertionError(repr(verdict))


def as_array(name: str, answer, shape: tuple) -> tuple[np.ndarray | None, Verdict | None]:
    """The answer as an array of the expected shape; or None and a verdict that names the difference."""
    try:
        array = np.asarray(answer, dtype=float)
    except (TypeError, ValueError, OverflowError):
        return None, wrong(f"{name} should be numbers, yours is {type(answer).__name__}")
    if array.shape != shape:
        return None, wrong(f"{name} should have shape {shape}, yours has {array.shape}")
    if not np.isfinite(array).all():
        return None, wrong(f"{name} holds {array[~np.isfinite(array)][0]}: some division or logarithm went wrong")
    return array, None


def array_from(name: str, function: Callable, shape: tuple, *arguments) -> tuple[np.ndarray | None, Verdict | None]:
    """What the student's function returns, as a new array of the expected shape; or None and a verdict.

    Args:
        name: what the answer is called in the verdict.
        function: the student's.
        shape: of a right answer.
        arguments: of the function.
    """
    answer, verdict = answer_of(function, *arguments)
    array, verdict = (None, verdict) if verdict else as_array(name, answer, shape)
    return (None, verdict) if verdict else (array.copy(), None)


def alike(answer, other) -> bool:
    """Whether two answers, arrays or lists of arrays, have one shape and the same numbers."""
    if isinstance(answer, list):
        return all(alike(each, others) for each, others in zip(answer, other, strict=True))
    return np.shape(answer) == np.shape(other) and np.allclose(answer, other)


def judge(
    answer, truth, mistakes: dict, otherwise: str | Callable[[], str], same: Callable = alike, like: Callable = alike
) -> Verdict | None:
    """None if the answer is right; else a verdict that names the mistake which gives exactly this answer.

    Args:
        answer: an array, or a list of them.
        truth: what it should be.
        mistakes: by message, the answer that the mistake gives, or a function that computes it.
        otherwise: the message for any other mistake, or a function that returns it.
        same: ``same(answer, truth)``, whether the answer is right.
        like: ``like(answer, other)``, whether it is the answer that a mistake gives.
    """
    if same(answer, truth):
        return None
    for message, mistaken in mistakes.items():
        if like(answer, mistaken() if callable(mistaken) else mistaken):
            return wrong(message)
    return wrong(otherwise() if callable(otherwise) else otherwise)


def judge_function(
    name: str,
    function: Callable,
    trials: list[tuple],
    truth: Callable,
    mistakes: dict[str, Callable],
    praise: str,
    otherwise: Callable[[list, list], str],
    **how,
) -> Verdict:
    """Run all trials, and name the mistake that explains every answer.

    Args:
        name: what an answer is called.
        function: the student's.
        trials: arguments of the function.
        truth: the right function.
        mistakes: by message, a function that makes the mistake; its answer may have another shape.
        praise: for a right one.
        otherwise: a function of the answers and the right ones that returns the message for any other mistake.
        how: ``same`` and ``like`` of ``judge``.
    """
    answers, expected = [], _answers(truth, trials)
    for trial, wanted in zip(trials, expected, strict=True):
        answer, verdict = answer_of(function, *(np.array(each) if np.ndim(each) else each for each in trial))
        if verdict is None:
            shapes = [np.shape(mistake(*trial)) for mistake in mistakes.values()]
            shape = np.shape(answer) if _is_one_of(answer, shapes) else np.shape(wanted)
            answer, verdict = as_array(name, answer, shape)
        if verdict is not None:
            return verdict
        answers.append(answer)
    made = {message: partial(_answers, mistake, trials) for message, mistake in mistakes.items()}
    return judge(answers, expected, made, lambda: otherwise(answers, expected), **how) or right(praise)


def _answers(function: Callable, trials: list[tuple]) -> list:
    return [function(*trial) for trial in trials]


def _is_one_of(answer, shapes: list) -> bool:
    try:
        return np.shape(answer) in shapes
    except ValueError:  # rows of different lengths
        return False


def numerical_jacobian(function: Callable, at: np.ndarray, step: float = 1e-6) -> np.ndarray:
    """The derivative of a function by central differences.

    Args:
        function: (n,) to (m,).
        at: (n,) where.
        step: by which each input is moved both ways.

    Returns:
        (m, n).
    """
    at = np.asarray(at, dtype=float)
    columns = [(function(at + nudge) - function(at - nudge)) / (2 * step) for nudge in step * np.eye(len(at))]
    return np.stack(columns, axis=-1)
