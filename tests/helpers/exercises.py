"""What the tests of every lesson's exercises share."""

from collections.abc import Callable
from pathlib import Path

import nbformat

from npslam_teach.course.checking import BLANK

SOLUTIONS = Path(__file__).parents[2] / "notebooks" / "solutions"


def solved_names(lesson: str) -> dict:
    """What the solutions notebook of a lesson ("04") defines, by name."""
    scope = {}
    for cell in nbformat.read(SOLUTIONS / f"{lesson}_solutions.ipynb", as_version=4).cells:
        if any(tag == "setup" or tag.startswith("exercise-") for tag in cell.metadata.get("tags", [])):
            exec(cell.source, scope)  # the file is our own
    return scope


def assert_accepts_the_solution_and_no_blank(check: Callable, solution: Callable) -> None:
    """The solution passes; every kind of blank is told that it is one."""
    assert check(solution).passed
    for blank in (..., None, lambda *a: ..., lambda *a: None):
        verdict = check(blank)
        assert not verdict.passed and verdict.message == BLANK


def assert_no_answer_breaks(check: Callable, answer) -> None:
    """A wrong answer of any type is refused and never raises, whether returned, handed over, or of a wrong arity."""
    assert not check(lambda *a: answer).passed
    assert not check(answer).passed
    assert not check(lambda: answer).passed
