"""What an exercise is checked with: a verdict that says what is wrong, and the tools the checks share.

Every lesson has a module of its own, such as ``course.pose_graph.checks``, with one ``check_*`` for each exercise. A
check never raises on a wrong answer: it returns a ``Verdict``, whose text is the last value of the cell.
"""

import contextlib
import io
import warnings
from collections.abc import Callable
from dataclasses import dataclass

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
    """The exercise is solved; the message says what that is good for."""
    return Verdict(True, message)


def wrong(message: str) -> Verdict:
    """It is not; the message names the mistake, and never gives the answer away."""
    return Verdict(False, message)


def is_blank(answer) -> bool:
    """Whether the student's answer is still the dots, or a function that returns nothing."""
    return answer is ... or answer is None


def answer_of(function: Callable, *arguments) -> tuple[object, Verdict | None]:
    """Call the student's function, and turn whatever it raises into a verdict.

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
    """What a graded cell runs: nothing happens where the check passes.

    Warnings and other words on standard error are kept to ourselves: nbgrader takes them for a failure, and a right
    answer that divides by zero on its way would lose its marks.

    Raises:
        AssertionError: it does not pass; the message is the verdict.
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


def numerical_jacobian(function: Callable, at: np.ndarray, step: float = 1e-6) -> np.ndarray:
    """The derivative of a function by central differences: nudge each input both ways and see.

    Args:
        function: (n,) to (m,).
        at: (n,) where.
        step: how far to nudge.

    Returns:
        (m, n).
    """
    at = np.asarray(at, dtype=float)
    columns = [(function(at + nudge) - function(at - nudge)) / (2 * step) for nudge in step * np.eye(len(at))]
    return np.stack(columns, axis=-1)
