"""A verdict on the page: the student's result over the library's, and the mark of the exercise."""

import re
from pathlib import Path

import nbformat
import numpy as np
import pytest
from exercises import NOTEBOOKS, exercises

from npslam_teach.course import checking, drawn
from npslam_teach.course.trials import Part, check_function
from npslam_teach.course.verdict_page import exercise

SQUARES = drawn.curve([(x,) for x in (1.0, 2.0, 3.0)], [1, 2, 3], "x (m)", "square (m^2)")
EXERCISES = exercises()
LESSONS = sorted({each.lesson for each in EXERCISES})


def square(x):
    return x**2


@exercise("99", 2, of=3)
def check(function):
    """A check of an exercise that asks for the square."""
    trials = [(1.0,), (2.5,)]
    return check_function(function, square, Part("your square", {}), trials, {}, "it grows faster than x", SQUARES)


def test_a_right_answer_is_drawn_over_the_librarys_and_marked():
    verdict = check(lambda x: x * x)
    page = verdict._repr_html_()
    assert verdict.passed and repr(verdict) == "Right: it grows faster than x."
    assert 'data-lesson="99" data-number="2"' in page and 'data-exercises="3"' in page
    assert "Right: it grows faster than x." in page and page.count("<img") == 1
    assert "broad grey line: lies on the library&#x27;s." in page


def test_a_wrong_answer_is_drawn_and_not_marked():
    verdict = check(lambda x: x * x + 1)
    page = verdict._repr_html_()
    assert not verdict.passed and "Not yet: " in page
    assert "leaves the library&#x27;s, by up to 1." in page and "np-done" not in page and "<script" not in page


@pytest.mark.parametrize("blank", [..., None, lambda x: ...])
def test_a_blank_stays_one_sentence(blank):
    """So a committed lesson, whose exercises are blank, has no output but words."""
    verdict = check(blank)
    assert verdict.message == checking.BLANK and verdict._repr_html_() is None


@pytest.mark.parametrize(
    "answer", [lambda x: "nine", lambda x: 1 / 0, lambda x: float("nan"), lambda x: [x, x], lambda: 1, 3.0]
)
def test_what_cannot_be_drawn_stays_one_sentence(answer):
    verdict = check(answer)
    assert not verdict.passed and verdict._repr_html_() is None


def test_the_students_function_gets_arguments_of_its_own():
    """What a function does to its arguments changes neither the picture nor the next call."""
    given = np.ones(3)
    drawing = drawn.curve([(given,), (given,)], [0, 1], "x", "y")

    def spoils(x):
        x += 1
        return x.sum()

    _, words = drawn.drawn_over(drawing, spoils, lambda x: (x + 1).sum())
    assert given.tolist() == [1, 1, 1] and "lies on" in words


def test_places_and_paths_are_maps():
    one = drawn.floor_map([(0.0,), (1.0,)], lambda xy, _: xy, is_one=True)
    figure, words = drawn.drawn_over(one, lambda x: [x, x + 0.5], lambda x: [x, x])
    (ax,) = figure.axes
    assert ax.get_aspect() == 1.0 and ax.get_xlabel() == "x (m)"
    assert [line.get_xydata().tolist() for line in ax.lines] == [[[0, 0], [1, 1]], [[0, 0.5], [1, 1.5]]]
    assert "by up to 0.5" in words


@pytest.mark.parametrize("lesson", LESSONS)
def test_every_check_knows_its_exercise_and_every_question_how_many_there_are(lesson):
    own = [each for each in EXERCISES if each.lesson == lesson]
    assert [each.checked.place for each in own] == [(lesson[:2], each.number, len(own)) for each in own]
    pages = "".join(
        output.get("data", {}).get("text/html", "")
        for cell in nbformat.read(Path(NOTEBOOKS) / f"{lesson}.ipynb", as_version=4).cells
        for output in cell.get("outputs", [])
    )
    assert set(re.findall(r'data-exercises="(\d+)"', pages)) == {str(len(own))}


@pytest.mark.parametrize("lesson", LESSONS)
def test_an_exercise_of_every_lesson_shows_its_result(lesson):
    pictures = (each.checked(each.solution).picture for each in EXERCISES if each.lesson == lesson)
    figure, words = next(filter(None, pictures))()
    assert "lies on the library's" in words
    assert len(figure.axes[0].lines) >= 2 and figure.axes[0].get_xlabel() and figure.axes[0].get_ylabel()
