"""A student's result drawn over the library's: the same inputs for both, where the answer is a curve, a path or a map.

A check hands a ``Drawing`` to ``trials.check_function``, and the verdict shows the picture below its sentence, also
where the answer is wrong: how far off it is, and where.
"""

import copy
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from npslam_teach import plotting
from npslam_teach.course.checking import answer_of

Lines = list[np.ndarray]  # each (N, 2)


@dataclass(frozen=True)
class Drawing:
    """What to draw of an answer.

    Attributes:
        inputs: the arguments of each call.
        lines: from the answers to all of them, the lines (N, 2) of the picture.
        xlabel: of the axis, with its unit.
        ylabel: of the axis, with its unit.
        is_map: whether both axes are metres of one floor.
        style: of matplotlib, for the student's: "-" is a line, "o" are places.
    """

    inputs: Sequence[tuple]
    lines: Callable[[list], Lines]
    xlabel: str
    ylabel: str
    is_map: bool = False
    style: str = "-"


def curve(inputs: Sequence[tuple], x, xlabel: str, ylabel: str, read: Callable = np.asarray) -> Drawing:
    """A number for each input, or several, each of which is a curve.

    Args:
        inputs: the arguments of each call.
        x: (N,) where each stands on the axis.
        xlabel: of the axis.
        ylabel: of the axis.
        read: from an answer to its number or numbers.
    """

    def lines(answers: list) -> Lines:
        numbers = np.array([np.atleast_1d(read(each)) for each in answers], dtype=float)
        return [np.column_stack([x, column]) for column in numbers.T]

    return Drawing(inputs, lines, xlabel, ylabel)


def floor_map(inputs: Sequence[tuple], read: Callable, style: str = "-", is_one: bool = False) -> Drawing:
    """A path, an outline or places on the floor.

    Args:
        inputs: the arguments of each call.
        read: ``read(answer, *arguments)``, the (N, 2) m of one call.
        style: as in ``Drawing``.
        is_one: whether all calls together make one line.
    """

    def lines(answers: list) -> Lines:
        found = [np.atleast_2d(read(a, *b)).astype(float) for a, b in zip(answers, inputs, strict=True)]
        return [np.concatenate(found)] if is_one else found

    return Drawing(inputs, lines, "x (m)", "y (m)", is_map=True, style=style)


def drawn_over(drawing: Drawing, own: Callable, truth: Callable) -> tuple[Figure, str] | None:
    """The picture and its words; None where the student's answers are nothing that could be drawn.

    Args:
        drawing: what to draw.
        own: the student's function.
        truth: the library's.
    """
    answers = []
    for arguments in drawing.inputs:
        answer, verdict = answer_of(own, *copy.deepcopy(arguments))
        if verdict is not None:
            return None
        answers.append(answer)
    expected = drawing.lines([truth(*arguments) for arguments in drawing.inputs])
    try:
        mine = drawing.lines(answers)
    except Exception:  # a wrong answer may be of any kind and shape
        return None
    shapes = [[each.shape for each in lines] for lines in (mine, expected)]
    if shapes[0] != shapes[1] or not all(np.isfinite(each).all() for each in mine):
        return None
    return _figure(drawing, mine, expected)


def _figure(drawing: Drawing, mine: Lines, expected: Lines) -> tuple[Figure, str]:
    off = max(np.abs(a - b).max() for a, b in zip(mine, expected, strict=True))
    size = max(np.abs(each).max() for each in expected)
    words = "lies on the library's" if off < 1e-3 * size else f"leaves the library's, by up to {off:.2g}"
    figure, ax = plotting.new_figure(size=(7, 5 if drawing.is_map else 3.6))
    under = {"o": {"ms": 13}, "-": {"lw": 7}}[drawing.style]
    over = {"o": {"ms": 5}, "-": {"lw": 1.6}}[drawing.style]
    for k, (own, its) in enumerate(zip(mine, expected, strict=True)):
        labels = ("the library's", "yours") if k == 0 else (None, None)
        ax.plot(*its.T, drawing.style, color="#bdbdbd", solid_capstyle="round", label=labels[0], **under)
        ax.plot(*own.T, drawing.style, color="#b2182b", label=labels[1], **over)
    ax.set(xlabel=drawing.xlabel, ylabel=drawing.ylabel, title=f"yours {words}")
    if drawing.is_map:
        ax.set_aspect("equal", adjustable="datalim")
    ax.legend(loc="best", fontsize="small")
    return (
        figure,
        f"Your result over the library's, a broad grey {'line' if drawing.style == '-' else 'disc'}: {words}.",
    )
