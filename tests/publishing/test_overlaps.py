"""No lesson shows what it asks for in another cell."""

from pathlib import Path

import nbformat
import pytest

from npslam_teach.publishing import assignments, overlaps

NOTEBOOKS = Path(__file__).parents[2] / "notebooks"
LESSONS = assignments.lessons_with_exercises(NOTEBOOKS)
# Exercise and cell: where a lesson works out by hand, before it asks, what the exercise then asks for in another form.
BY_HAND = {
    "02": {(1, "cell-02"), (4, "cell-02")},  # the formula of the text, with numbers
    "06": {(3, "cell-06")},  # the loop that the lesson is about; asked with the library's functions
    "11": {(2, "posterior-17")},  # how gaps are closed, which the exercise itself says
}


@pytest.mark.parametrize("number", LESSONS)
def test_no_cell_gives_an_exercise_away(number):
    lesson, solutions = (nbformat.read(path, as_version=4) for path in LESSONS[number])
    found = {(exercise, cell) for exercise, cell, _ in overlaps.overlaps(lesson, solutions)}
    assert found <= BY_HAND.get(number, set())


def test_a_solution_under_other_names_is_found():
    solution = "def f(depth):\n    near = np.abs(depth - np.quantile(depth, 0.4)) < 0.3\n    return near"
    assert overlaps.share(solution, "front = np.abs(x - np.quantile(x, 0.4)) < 0.3\nprint(front)") == 1.0
    assert overlaps.share(solution, "front = np.abs(x - np.quantile(y, 0.4)) < 0.3") < overlaps.ENOUGH
    assert overlaps.share(solution, "front = foreground(points)") == 0.0
