"""What all checks share, and that every exercise of every lesson is checked as it should be."""

import numpy as np
import pytest

from npslam_teach.course import checking


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
