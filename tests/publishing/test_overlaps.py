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
    "04": {(2, "cell-07")},  # the shares without room for something new, which the exercise adds
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


def test_a_solution_with_numbers_and_parts_for_its_names_is_found():
    bounds = "def f(n, p):\n    tail = (1 - p) / 2\n    return chi2.ppf([tail, 1 - tail], 2 * n) / n"
    assert overlaps.share(bounds, "low, high = chi2.ppf([0.005, 0.995], 2 * matched) / matched") > overlaps.ENOUGH
    assert overlaps.share(bounds, "bound = chi2.ppf(0.99, 2 * matched) / matched") < overlaps.ENOUGH
    scaled = "def f(std, paper_std, paper_width):\n    return paper_width * std / paper_std"
    assert overlaps.share(scaled, "assert np.isclose(own, 8**-0.5 * camera / np.hypot(0.1, 0.1))") == 1.0
    assert overlaps.share(scaled, "assert np.isclose(own, 8**-0.5 * camera * np.hypot(0.1, 0.1))") == 0.0
    squared = "def f(y, cov):\n    return y @ np.linalg.solve(cov, y)"
    assert overlaps.share(squared, "off[part] @ np.linalg.solve(S[part, part], off[part])") == 1.0
    assert overlaps.share(squared, "off[part] @ np.linalg.solve(S[part, part], off[rest])") == 0.0


def test_a_short_solution_is_found():
    solution = "def f(weights, alpha):\n    both = np.append(weights, alpha)\n    return both / both.sum()"
    assert overlaps.share(solution, "w = np.append(v, 0.5)\np = w / w.sum()") == 1.0
    assert overlaps.share(solution, "p = association_probabilities(votes, distance, 0.5)") == 0.0
