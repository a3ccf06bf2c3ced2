"""What all checks share, and that every exercise of every lesson has a check that works."""

import numpy as np
import pytest
from exercises import assert_accepts_the_solution_and_no_blank, assert_no_answer_breaks, exercises

from npslam_teach.course import checking
from npslam_teach.course.checking import BLANK

EXERCISES = exercises()
WRONG_ANSWERS = [
    *("text", "1", {}, {"a": 1}, [], object(), True, 3, 3.0, -1, 1j, np.nan, -np.inf, (1, 2), ([1], [2]), ("a", "b")),
    *([[1], [1, 2]], [[1, 2], [3, 4]], [1, 2, 3, 4], ({}, [[1], [2, 3]]), np.zeros(3), np.full(3, np.inf)),
    *(np.full(5, np.inf), np.zeros((2, 2)), np.full((2, 2), np.inf), np.zeros((2, 2, 2)), np.zeros((7, 7))),
]
HALF_BLANK = [(..., ...), (None, None), (None, [1]), (np.zeros(5), ...), (np.zeros(24), None)]


def test_every_lesson_with_exercises_is_checked():
    assert len({exercise.lesson for exercise in EXERCISES}) == 15
    assert len(EXERCISES) == 66


@pytest.mark.parametrize("exercise", EXERCISES, ids=str)
def test_solutions_are_accepted_and_blanks_are_not(exercise):
    assert_accepts_the_solution_and_no_blank(exercise.checked, exercise.solution)


@pytest.mark.parametrize("exercise", EXERCISES, ids=str)
def test_no_answer_breaks_a_check(exercise):
    check = exercise.checked
    assert not check(lambda *a: 1 / 0).passed
    for wrong in WRONG_ANSWERS + HALF_BLANK:
        assert_no_answer_breaks(check, wrong)
    for wrong in WRONG_ANSWERS:
        assert check(lambda *a, wrong=wrong: wrong).message != BLANK


def test_a_verdict_reads_as_a_sentence():
    assert repr(checking.right("the angle is wrapped")) == "Right: the angle is wrapped."
    assert repr(checking.wrong("the angle is not wrapped")) == "Not yet: the angle is not wrapped."


@pytest.mark.parametrize("blank", [..., None, lambda x: ..., lambda x: None])
def test_blanks_are_recognised(blank):
    answer, verdict = checking.answer_of(blank, 1.0)
    assert answer is None
    assert verdict == checking.wrong(checking.BLANK)


def test_errors_of_the_student_become_a_verdict():
    answer, verdict = checking.answer_of(lambda x: x / 0, 1.0)
    assert answer is None
    assert not verdict.passed
    assert "ZeroDivisionError" in verdict.message


def test_as_array_names_the_difference():
    assert checking.as_array("H", [[1, 2]], (1, 2))[1] is None
    assert "shape (2,), yours has (3,)" in checking.as_array("b", [1, 2, 3], (2,))[1].message
    assert "yours is str" in checking.as_array("b", "hello", (2,))[1].message
    assert "nan" in checking.as_array("b", [1, np.nan], (2,))[1].message


def test_numerical_jacobian_of_a_known_function():
    jacobian = checking.numerical_jacobian(
        lambda v: np.array([v[0] * v[1], np.sin(v[0]), v[1] ** 3]), np.array([0.3, 2.0])
    )
    np.testing.assert_allclose(jacobian, [[2.0, 0.3], [np.cos(0.3), 0.0], [0.0, 12.0]], atol=1e-8)
