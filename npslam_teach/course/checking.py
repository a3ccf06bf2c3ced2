"""Checking exercises: a verdict that says what is wrong, and how a student's answer is read.

Every lesson has a module of its own, such as ``course.pose_graph.checks``, with one ``check_*`` for each exercise;
``course.trials`` is the engine of all. A check never raises on a wrong answer: it returns a ``Verdict``, whose text is
the last value of the cell.
"""

import contextlib
import io
import warnings
from collections.abc import Callable
from dataclasses import dataclass, field
from decimal import Decimal
from numbers import Real

import numpy as np

BLANK = "nothing has been filled in yet: replace the dots"


@dataclass(frozen=True)
class Verdict:
    """The outcome of a check; it displays itself as one sentence, in a notebook perhaps with a picture.

    Attributes:
        passed: whether the exercise is solved.
        message: what is wrong, or what the answer is good for.
        picture: draws the answer over the library's, as a figure and its words; None if it cannot be drawn.
        page: makes HTML of the verdict, or None where the sentence says everything.
    """

    passed: bool
    message: str
    picture: Callable | None = field(default=None, compare=False)
    page: Callable | None = field(default=None, compare=False)

    def __repr__(self) -> str:
        return f"{'Right' if self.passed else 'Not yet'}: {self.message}."

    def _repr_html_(self) -> str | None:
        return self.page(self) if self.page else None


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
    except (Exception, SystemExit) as error:  # a student's code may raise anything, and the lesson must go on
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
    """The answer as a new array of float64 of the expected shape; or None and a verdict that names the difference.

    Real numbers of every type are taken: lists, float32, fractions, decimals, integers of any size. Text and complex
    numbers are not, even where NumPy would convert them.
    """
    no_numbers = wrong(f"{name} should be real numbers, yours is {type(answer).__name__}")
    try:
        array = np.asarray(answer)
        if array.dtype.kind not in "biufO" or not all(isinstance(each, Real | Decimal) for each in _objects(array)):
            kind = f" of {array.dtype.name}" if array.ndim and array.dtype.kind in "cSU" else ""
            return None, wrong(f"{no_numbers.message}{kind}")
        array = np.array(array, dtype=float)
    except Exception:  # rows of different lengths, numbers beyond floats, a class with an __array__ of its own
        return None, no_numbers
    if array.size == 0 == np.prod(shape):  # a list of no rows cannot say how long they are
        return np.empty(shape), None
    if array.shape != shape:
        return None, wrong(f"{name} should have shape {shape}, yours has {array.shape}")
    if not np.isfinite(array).all():
        return None, wrong(f"{name} holds {array[~np.isfinite(array)][0]}: some division or logarithm went wrong")
    return array, None


def _objects(array: np.ndarray) -> list:
    return array.ravel().tolist() if array.dtype.kind == "O" else []


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
