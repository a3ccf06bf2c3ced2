"""The engine of every check: a student's function beside the right one, on inputs that are drawn anew each time.

A check is a generator of inputs, the right function, and the mistakes that are known by name. What holds for all of
them is here: arguments must come back as they went in, any type of real number is accepted and text is not, a mistake
is named only if it gives exactly the student's answers, and any other failure is shown by an example.
"""

import copy
import inspect
import warnings
from collections.abc import Callable
from dataclasses import dataclass, fields, is_dataclass, replace
from functools import partial

import numpy as np

from npslam_teach.course.checking import BLANK, Verdict, answer_of, as_array, is_blank, right, wrong
from npslam_teach.course.comparing import CLOSE, SINGLE, close
from npslam_teach.course.drawn import Drawing, drawn_over

Mistakes = dict[str, Callable]


def fresh() -> np.random.Generator:
    """A generator that nobody can foresee: a table of the right answers must not pass."""
    return np.random.default_rng()


@dataclass(frozen=True)
class Part:
    """What a function returns, or one of several things that it returns.

    Attributes:
        name: what it is called in a verdict, such as "your path".
        mistakes: by message, a function of the arguments that makes the mistake. Its answer may have another shape.
        same: ``same(answer, truth, tolerance)``, whether an answer is right.
        like: the same for whether it is the answer of a mistake; None: as ``same``.
        hint: what a verdict says before its example, when the mistake is unknown.
        read: ``read(name, answer, shape)``, the answer as an array, or a verdict.
    """

    name: str
    mistakes: Mistakes
    same: Callable = close
    like: Callable | None = None
    hint: str | Callable[[list, list], str] = ""
    read: Callable = as_array


def check_function(
    function: Callable,
    truth: Callable,
    parts: Part | tuple[Part, ...],
    trials: list[tuple],
    edges: dict[str, list[tuple]],
    praise: str,
    drawing: Drawing | None = None,
) -> Verdict:
    """Judge a student's function.

    Args:
        function: the student's.
        truth: the right one. Its parameters name the arguments in an example.
        parts: of what it returns; a tuple if it returns a tuple.
        trials: arguments; the mistakes are looked for here.
        edges: by the situation, as in "with no votes at all", arguments that are tried afterwards.
        praise: for a right answer.
        drawing: what the verdict shows of the answers, over those of ``truth``.
    """
    if is_blank(function):
        return wrong(BLANK)
    parts = (parts,) if (single := isinstance(parts, Part)) else parts
    run = partial(_run, function, truth, parts, single)
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        verdict = _judged_trials(run, truth, parts, trials, single)
        for situation, some in edges.items():
            for arguments in some:
                verdict = verdict or _judged_edge(run, truth, parts, situation, arguments)
    verdict = verdict or right(praise)
    if drawing is None or verdict.message == BLANK:
        return verdict
    return replace(verdict, picture=partial(drawn_over, drawing, function, truth))


@dataclass(frozen=True)
class _Answer:
    """One part of one answer beside the right one; ``tolerance`` is that of the answer's precision."""

    value: np.ndarray
    truth: np.ndarray
    tolerance: float


def _judged_trials(run: Callable, truth: Callable, parts: tuple, trials: list, single: bool) -> Verdict | None:
    answers = []
    for arguments in trials:
        answer, verdict = run(arguments)
        if verdict is not None:
            return verdict
        answers.append(answer)
    for k, part in enumerate(parts):
        found = [answer[k] for answer in answers]
        off = next((i for i, each in enumerate(found) if not _right(part, each)), None)
        if off is None:
            continue
        for message, mistake in part.mistakes.items():
            if all(_made(part, mistake, each, arguments) for each, arguments in zip(found, trials, strict=True)):
                return wrong(message)
        hint = (
            part.hint([each.value for each in found], [each.truth for each in found])
            if callable(part.hint)
            else part.hint
        )
        return wrong((f"{hint}; " if hint else "") + _example(part, found[off], truth, trials[off]))
    return None


def _judged_edge(run: Callable, truth: Callable, parts: tuple, situation: str, arguments: tuple) -> Verdict | None:
    answer, verdict = run(arguments)
    if verdict is not None:
        return verdict if verdict.message == BLANK else wrong(f"{situation}: {verdict.message}")
    for part, each in zip(parts, answer, strict=True):
        if not _right(part, each):
            return wrong(f"{situation}: {_example(part, each, truth, arguments)}")
    return None


def _right(part: Part, answer: _Answer) -> bool:
    return bool(part.same(answer.value, answer.truth, answer.tolerance))


def _made(part: Part, mistake: Callable, answer: _Answer, arguments: tuple) -> bool:
    """Whether the mistake gives this answer; it may fail where the student's does not."""
    value = _quietly(mistake, arguments)
    return value is not None and bool((part.like or part.same)(answer.value, value, answer.tolerance))


def _quietly(function: Callable, arguments: tuple) -> np.ndarray | None:
    try:
        return np.asarray(function(*copy.deepcopy(arguments)), dtype=float)
    except (ArithmeticError, ValueError, IndexError, np.linalg.LinAlgError):
        return None


def _run(function, truth, parts, single, arguments) -> tuple[list[_Answer] | None, Verdict | None]:
    """One call of the student's function, read part by part; or a verdict."""
    given = copy.deepcopy(arguments)
    answer, verdict = answer_of(function, *given)
    if verdict is not None:
        where = "" if verdict.message == BLANK else f"; it was called with {_shown_arguments(truth, arguments)}"
        return None, wrong(f"{verdict.message}{where}")
    for name, before, after in zip(_names(truth, arguments), arguments, given, strict=True):
        if not identical(before, after):
            return None, wrong(
                f"your code changes its argument {name}: whoever calls it still needs that; work on a copy"
            )
    verdict = None if single else _wrong_tuple(parts, answer)
    if verdict is not None:
        return None, verdict
    return _read(parts, [answer] if single else list(answer), truth, arguments, single)


def _wrong_tuple(parts: tuple[Part, ...], answer) -> Verdict | None:
    """None for as many things as there are parts, none of them blank."""
    if (
        not isinstance(answer, tuple | list | np.ndarray)
        or getattr(answer, "shape", None) == ()
        or len(answer) != len(parts)
    ):
        return wrong(f"return two things: {' and '.join(part.name for part in parts)}")
    blank = [part.name for part, each in zip(parts, answer, strict=True) if is_blank(each)]
    if not blank:
        return None
    return wrong(BLANK if len(blank) == len(parts) else f"{blank[0]} is still the dots")


def _read(parts, answer, truth, arguments, single) -> tuple[list[_Answer] | None, Verdict | None]:
    expected = truth(*copy.deepcopy(arguments))
    found = []
    for part, own, wanted in zip(parts, answer, [expected] if single else expected, strict=True):
        value, verdict = part.read(part.name, own, _shape_of(own, part, np.shape(wanted), arguments))
        if verdict is not None:
            return None, wrong(f"{verdict.message}, for {_shown_arguments(truth, arguments)}")
        found.append(_Answer(value, np.asarray(wanted, dtype=float), _tolerance(own)))
    return found, None


def _shape_of(own, part: Part, wanted: tuple, arguments: tuple) -> tuple:
    """The shape of a right answer; or the answer's own, if a mistake that is known has that one."""
    try:
        shape = np.shape(own)
    except Exception:  # rows of different lengths
        return wanted
    if shape == wanted:
        return wanted
    mistaken = (_quietly(mistake, arguments) for mistake in part.mistakes.values())
    return shape if any(each is not None and each.shape == shape for each in mistaken) else wanted


def _tolerance(answer) -> float:
    return SINGLE if np.asarray(answer).dtype in (np.float32, np.float16) else CLOSE


def identical(one, other) -> bool:
    """Whether two arguments are the same, number by number, within dataclasses, lists and sparse matrices too."""
    if is_dataclass(one):
        return all(identical(getattr(one, each.name), getattr(other, each.name)) for each in fields(one))
    if isinstance(one, list | tuple):
        return len(one) == len(other) and all(map(identical, one, other))
    if hasattr(one, "toarray"):
        return identical(one.toarray(), other.toarray())
    if isinstance(one, np.ndarray):
        return np.array_equal(one, other, equal_nan=one.dtype.kind == "f")
    return callable(one) or one == other


def _example(part: Part, answer: _Answer, truth: Callable, arguments: tuple) -> str:
    came, wanted = shown(answer.value), shown(answer.truth)
    given = _shown_arguments(truth, arguments)
    return f"{part.name} should be {wanted}, not {came}, for {given}"


def _names(truth: Callable, arguments: tuple) -> list[str]:
    return list(inspect.signature(truth).parameters)[: len(arguments)]


def _shown_arguments(truth: Callable, arguments: tuple) -> str:
    named = zip(_names(truth, arguments), arguments, strict=True)
    return ", ".join(f"{name} = {shown(each)}" for name, each in named if not callable(each))


def shown(value) -> str:
    """A number, or the beginning of an array, on one line."""
    if hasattr(value, "toarray"):
        return f"a sparse matrix {value.shape}"
    if is_dataclass(value) or value is None or isinstance(value, str):
        return type(value).__name__ if is_dataclass(value) else repr(value)
    array = np.asarray(value)
    if array.ndim == 0:
        return f"{float(array):.6g}" if array.dtype.kind == "f" else str(array)
    text = " ".join(np.array2string(array, separator=", ", precision=3, threshold=24, edgeitems=3).split())
    return text if len(text) <= 160 else f"an array {array.shape}, beginning {text[:100]} ..."
