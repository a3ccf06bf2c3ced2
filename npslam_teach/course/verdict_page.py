"""A verdict as a piece of HTML: its sentence, the student's result over the library's, and the mark of the exercise."""

import functools
import html
from collections.abc import Callable
from dataclasses import replace

from npslam_teach.course.checking import Verdict
from npslam_teach.course.predict_page import inlined
from npslam_teach.plotting.export import show


def exercise(lesson: str, number: int, of: int) -> Callable:
    """Decorate a check: where it passes, the exercise is marked as done in the student's browser.

    Args:
        lesson: its short name, "04" for example.
        number: of the exercise.
        of: how many exercises the lesson has.
    """

    def decorate(check: Callable) -> Callable:
        @functools.wraps(check)
        def checked(answer) -> Verdict:
            return replace(check(answer), page=functools.partial(page, place=(lesson, number, of)))

        checked.place = (lesson, number, of)
        return checked

    return decorate


def page(verdict: Verdict, place: tuple[str, int, int]) -> str | None:
    """The verdict as HTML; None where its sentence says everything.

    Args:
        verdict: of a check.
        place: the lesson, the number of the exercise, and how many the lesson has.
    """
    drawn = verdict.picture() if verdict.picture else None
    picture = "" if drawn is None else show(*drawn).data
    sentence = f"<p>{html.escape(repr(verdict))}</p>"
    if not verdict.passed:
        return f'<div class="np-verdict">{sentence}{picture}</div>' if picture else None
    lesson, number, of = place
    style, script = inlined("predict.css"), inlined("progress.js") + inlined("verdict.js")
    progress = f'<span class="np-progress" data-lesson="{lesson}" data-exercises="{of}"></span>'
    return (
        f'<div class="np-box np-done" data-lesson="{lesson}" data-number="{number}"><style>{style}</style>'
        f"{progress}{sentence}{picture}<script>{script}</script></div>"
    )
