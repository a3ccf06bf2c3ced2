"""What the tests of every lesson's exercises share."""

import importlib
import re
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import NamedTuple

import nbformat

from npslam_teach.course.checking import BLANK

NOTEBOOKS = Path(__file__).parents[2] / "notebooks"
SOLUTIONS = NOTEBOOKS / "solutions"


class Exercise(NamedTuple):
    """One exercise of a lesson, as the cells say that students run."""

    lesson: str  # such as "03_pose_graph"
    number: int
    check: str  # name of the function in the lesson's checks
    answer: str  # what the student's answer is called

    def __str__(self) -> str:
        return f"{self.lesson}-{self.number}"

    @property
    def checked(self) -> Callable:
        """The check itself."""
        return getattr(importlib.import_module(f"npslam_teach.course.{self.lesson[3:]}.checks"), self.check)

    @property
    def solution(self) -> Callable:
        """The answer of the solutions notebook."""
        return solved_names(self.lesson[:2])[self.answer]


def exercises(lesson: str = "[0-9][0-9]_*") -> list[Exercise]:
    """All exercises of the lessons with such a name, in their order."""
    found = []
    for path in sorted(NOTEBOOKS.glob(f"{lesson}.ipynb")):
        for cell in nbformat.read(path, as_version=4).cells:
            for tag in cell.metadata.get("tags", []):
                if tag.startswith("check-"):
                    words = re.search(r"checks\.(check_\w+)\((\w+)\)", cell.source).groups()
                    found.append(Exercise(path.stem, int(tag.removeprefix("check-")), *words))
    return found


def checks_and_solutions(lesson: str) -> tuple[dict, Callable]:
    """The checks of a lesson by number, and a function from number to solution."""
    by_number = {exercise.number: exercise for exercise in exercises(lesson)}
    return {number: each.checked for number, each in by_number.items()}, lambda number: by_number[number].solution


@cache
def solved_names(lesson: str) -> dict:
    """What the solutions notebook of a lesson ("04") defines, by name."""
    scope = {}
    for cell in nbformat.read(SOLUTIONS / f"{lesson}_solutions.ipynb", as_version=4).cells:
        if any(tag == "setup" or tag.startswith("exercise-") for tag in cell.metadata.get("tags", [])):
            exec(cell.source, scope)  # the file is our own
    return scope


def assert_accepts_the_solution_and_no_blank(check: Callable, solution: Callable) -> None:
    """The solution passes; every kind of blank is reported as blank."""
    assert check(solution).passed
    for blank in (..., None, lambda *a: ..., lambda *a: None):
        verdict = check(blank)
        assert not verdict.passed and verdict.message == BLANK


def assert_names_the_mistake(check: Callable, answer, message: str) -> None:
    """The answer does not pass, and the verdict holds these words."""
    verdict = check(answer)
    assert not verdict.passed
    assert message in verdict.message


def assert_no_answer_breaks(check: Callable, answer) -> None:
    """A wrong answer of any type is refused and never raises, whether returned, handed over, or of a wrong arity."""
    assert not check(lambda *a: answer).passed
    assert not check(answer).passed
    assert not check(lambda: answer).passed
