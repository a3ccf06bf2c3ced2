"""Predict, then see: a question whose result lies folded below it until the reader has answered.

A lesson keeps its questions in a module of its own, ``course.drift.predictions`` for example, so that the code that a
student reads before answering does not give the answer away. The result is what the cell prints and shows::

    with predict("twenty_rooms") as see:
        print(counts)
        see.show(figure)

The answer stays in the reader's browser, never in the notebook: ``predict.js`` puts it there. Where scripts are
stripped the choices are a list, and the result is folded all the same.
"""

import html
from collections.abc import Callable, Sequence

import numpy as np

from npslam_teach.course.predict_page import Question, page
from npslam_teach.plotting.export import show

__all__ = ["Asked", "Question", "choice", "number", "questions", "sketch"]

_WIDGET = "application/vnd.jupyter.widget-view+json"


def choice(text: str, options: Sequence[str], right: int, mistake: str, alts: Sequence[str] = ()) -> Question:
    """A question with answers to choose from.

    Args:
        text: the question.
        options: the answers.
        right: the index of the right one.
        mistake: what the class usually gets wrong, and what comes of it.
        alts: the words for the picture of each part of the result, "" where a part has none.

    Raises:
        ValueError: ``right`` is no index of ``options``.
    """
    if not 0 <= right < len(options):
        raise ValueError(f"right: expected an index below {len(options)}, got {right}")
    return Question("choice", text, mistake, tuple(alts), options=tuple(options), right=right)


def number(text: str, mistake: str, unit: str = "", alts: Sequence[str] = ()) -> Question:
    """A question that a number answers; the cell computes the right one and hands it over.

    Args:
        text: the question.
        mistake: what the class usually gets wrong, and what comes of it.
        unit: "m" for example.
        alts: the words for the picture of each part of the result, "" where a part has none.
    """
    return Question("number", text, mistake, tuple(alts), unit=f"\u00a0{unit}" if unit else "")


def sketch(text: str, mistake: str, box: Sequence[float], alts: Sequence[str] = ()) -> Question:
    """A question that a drawn line answers; the cell computes the right line and hands it over.

    Args:
        text: the question.
        mistake: what the class usually gets wrong, and what comes of it.
        box: left, bottom, right and top of the drawing area, in m.
        alts: the words for the picture of each part of the result, "" where a part has none.
    """
    return Question("sketch", text, mistake, tuple(alts), box=tuple(map(float, box)))


def questions(lesson: str, exercises: int = 0, **asked: Question) -> Callable[..., "Asked"]:
    """All questions of a lesson, as the function ``predict`` that the lesson calls with a name.

    Args:
        lesson: its short name, "04" for example.
        exercises: how many exercises it has; each question says how many of them are done.
        asked: by name, in their order.
    """

    def predict(name: str, part: int = 1) -> Asked:
        """Ask one question of this lesson.

        Args:
            name: of the question.
            part: 2 for a cell with more of the result of the same question, and so on.

        Raises:
            ValueError: there is no such question.
        """
        if name not in asked:
            raise ValueError(f"name: expected one of {', '.join(asked)}, got {name!r}")
        return Asked(lesson, name, asked[name], (len(asked), exercises), part)

    predict.questions = dict(asked)
    return predict


class Asked:
    """One question on the page: a ``with`` block around its result, or the last value of a cell without one."""

    def __init__(self, lesson: str, name: str, question: Question, totals: tuple[int, int], part: int):
        """Ask a question of a lesson that has so many questions and exercises."""
        self._lesson, self._name, self._question, self._totals, self._part = lesson, name, question, totals, part
        self._answer: float | np.ndarray | None = None
        self._known: list[np.ndarray] = []

    def __enter__(self) -> "Asked":
        # Imported here: lessons' questions are also read where there is no notebook.
        from IPython.utils.capture import capture_output

        self._capturing = capture_output()
        self._captured = self._capturing.__enter__()
        return self

    def __exit__(self, kind, error, traceback) -> None:
        self._capturing.__exit__(kind, error, traceback)
        if kind is not None or self._captured.stderr:  # neither errors nor warnings are ever folded away
            self._captured.show()
        if kind is None:
            self._display()

    def show(self, figure, alt: str | None = None) -> None:
        """Show a picture of the result.

        Args:
            figure: a figure of matplotlib, or the bytes of an animated GIF.
            alt: its words; by default those that the question has for this part.
        """
        from IPython.display import display

        display(show(figure, self._question.alts[self._part - 1] if alt is None else alt))

    def answer(self, value) -> None:
        """Hand over what is right, as the cell has computed it.

        Args:
            value: a number; for a sketch the line, (N, 2) or, as poses, (N, 3), m.

        Raises:
            ValueError: the question is a choice.
        """
        kind = self._question.kind
        if kind == "choice":
            raise ValueError(f"answer: expected a question for a number or a sketch, got the choice {self._name!r}")
        self._answer = float(value) if kind == "number" else np.asarray(value, dtype=float)[:, :2]

    def known(self, line) -> None:
        """A line that the drawing area shows from the beginning, dashed.

        Args:
            line: (N, 2) or, as poses, (N, 3), m.
        """
        self._known.append(np.asarray(line, dtype=float)[:, :2])

    def __repr__(self) -> str:
        """What stands in place of the question where no HTML is shown."""
        return f"Predict: {self._question.text}"

    def _repr_html_(self) -> str:
        return self._page("")

    def _display(self) -> None:
        from IPython.display import HTML, display

        outputs = self._captured.outputs
        folded = [_as_html(each.data) for each in outputs if _WIDGET not in each.data]
        text = f"<pre>{html.escape(self._captured.stdout)}</pre>" if self._captured.stdout else ""
        display(HTML(self._page(text + "".join(folded))))
        for each in outputs:
            if _WIDGET in each.data:  # a widget is alive only as an output of its own
                each.display()

    def _page(self, result: str) -> str:
        place = (self._lesson, self._name, self._totals)
        return page(self._question, place, result, self._answer, self._known, is_first=self._part == 1)


def _as_html(data) -> str:
    return data.get("text/html") or f"<pre>{html.escape(data.get('text/plain', ''))}</pre>"
