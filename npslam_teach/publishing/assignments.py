"""Assignments: from a lesson and its solutions the student's copy, and the source that nbgrader grades.

An exercise of a lesson is a cell tagged ``exercise-N`` that ends in dots, and a cell tagged ``check-N``; the lesson's
solutions notebook has the same cells, filled in. Both versions are made from these two files, so nothing is written
twice:

- the source has the solution where the dots were, between marks, and after each check a locked cell with a hidden
  test, which fails with the check's own message; ``nbgrader validate`` runs it in the student's copy, too;
- the student's copy is the source without solutions and hidden tests, as nbgrader itself would release it.

Making them needs no nbgrader. The folder that holds them is laid out as nbgrader expects a course to be.
"""

import base64
import re
from pathlib import Path

from npslam_teach.publishing.colab import without_badge
from npslam_teach.publishing.solution_cells import HIDDEN_TESTS, SOLUTION, STUB, cut, imports, with_solution
from npslam_teach.system.files import atomic_write

# Whatever the cells of a submission have done to the library or to its checks, this reads it from its files again. A
# function, so that no variable of the lesson changes its meaning; the lesson goes on with the modules that it had.
FRESH_CHECK = """\
def _graded(answer, always=False):
    import importlib
    import os
    import sys

    if not always and "NBGRADER_VALIDATING" not in os.environ:
        return  # a lesson runs on when an exercise is left out
    own = {{name: sys.modules.pop(name) for name in [*sys.modules] if name.split(".")[0] == "npslam_teach"}}
    try:
        checks = importlib.import_module("{module}")
        importlib.import_module("npslam_teach.course.checking").require(checks.{check}, answer)
    finally:
        for name in [*sys.modules]:
            if name.split(".")[0] == "npslam_teach":
                del sys.modules[name]
        sys.modules.update(own)


_graded({answer})
### BEGIN HIDDEN TESTS
_graded({answer}, always=True)
### END HIDDEN TESTS"""

IGNORED = (("work",), ("COURSE",))

NBGRADER_CONFIG = f'''"""Settings of nbgrader for the assignments in this folder; run its commands from here."""

c = get_config()  # noqa: F821 - nbgrader provides it

# What stands for a blank in the lessons: the checks recognise it, and a lesson runs on when one is left.
c.ClearSolutions.code_stub = {{"python": "{STUB}"}}
# A cell of a lesson takes seconds; an endless loop of a student's is stopped after so many.
c.Execute.timeout = 120
# How nbgrader and the hub call this course; students' copies are exchanged under the name.
c.CourseDirectory.course_id = "npslam_teach"
'''


def write_assignments(notebooks: Path, numbers: list[str], out: Path, only_student: bool = False) -> list[Path]:
    """Write the assignments of some lessons; fails before anything is written if one of the files exists.

    Args:
        notebooks: the folder of the lessons, with ``solutions`` in it.
        numbers: of the lessons, such as "04".
        out: the folder to write into, made if it is not there.
        only_student: leave out every file that holds solutions.

    Returns:
        the files written.

    Raises:
        ValueError: there is no such lesson, or a file that would be written exists already, or git would see it.
    """
    import nbformat

    _require_a_place(notebooks.resolve().parent, out)
    files = {}
    for number in numbers:
        path, source = assignment_source(notebooks, number)
        files[out / "student" / number / path.name] = student_version(source)
        if not only_student:
            files[out / "source" / number / path.name] = source
    texts = {path: nbformat.writes(notebook) + "\n" for path, notebook in files.items()}
    config = out / "nbgrader_config.py"
    if not only_student and not config.exists():
        texts[config] = NBGRADER_CONFIG
    for path in filter(Path.exists, texts):
        raise ValueError(
            f"{path}: expected no file of that name, found one that may hold somebody's work: "
            "move it away or choose another --out"
        )
    for path, text in texts.items():
        path.parent.mkdir(parents=True, exist_ok=True)
        with atomic_write(path) as stream:
            stream.write(text)
    return list(texts)


def _require_a_place(root: Path, out: Path) -> None:
    """Raise ValueError for a folder in the course that git does not ignore: solutions must not be committed."""
    if out.resolve().is_relative_to(root) and out.resolve().relative_to(root).parts[:1] not in IGNORED:
        raise ValueError(
            f"--out {out}: expected a folder outside the course, or work or COURSE in it, which git ignores; "
            "answers and students' work there would be committed with it"
        )


def lessons_with_exercises(notebooks: Path) -> dict[str, tuple[Path, Path]]:
    """The lesson and its solutions by the lesson's number, for every lesson that has both."""
    solutions = {path.stem[:2]: path for path in sorted((notebooks / "solutions").glob("[0-9][0-9]_*.ipynb"))}
    lessons = {path.stem[:2]: path for path in sorted(notebooks.glob("[0-9][0-9]_*.ipynb"))}
    return {number: (lessons[number], solutions[number]) for number in lessons if number in solutions}


def assignment_source(notebooks: Path, number: str):
    """The notebook with solutions and hidden tests that nbgrader calls the source version.

    Args:
        notebooks: the folder of the lessons, with ``solutions`` in it.
        number: of the lesson, such as "04".

    Returns:
        the lesson's path, and the ``nbformat.NotebookNode``.

    Raises:
        ValueError: no lesson with exercises has this number, or the lesson and its solutions do not match.
    """
    import nbformat

    known = lessons_with_exercises(notebooks)
    if number not in known:
        raise ValueError(f"LESSON: expected one of {', '.join(known)}, got {number!r}")
    lesson, solutions = (nbformat.read(path, as_version=4) for path in known[number])
    solved, setup, cells, earlier = _tagged(solutions), _setup_imports(solutions), [], set()
    stars = exercise_stars(lesson)
    _require_all(known[number][0], lesson, solved, stars)
    for cell in lesson.cells:
        kind, exercise = _kind_of(cell)
        cells.append(_without_outputs(cell) if cell.cell_type == "code" else _self_contained(cell, notebooks))
        if kind == "exercise":
            missing = {name: text for name, text in setup.items() if text not in earlier}
            cell.source = with_solution(cell.source, solved[kind, exercise].source, missing)
            cell.metadata["nbgrader"] = _metadata(f"lesson-{number}-exercise-{exercise}", solution=True)
        elif kind == "check":
            cells.append(_graded_cell(cell.source, known[number][0].stem, exercise, stars[exercise]))
        if cell.cell_type == "code":
            earlier |= set(imports(cell.source).values())
    lesson.cells = cells
    return known[number][0], lesson


def _require_all(path: Path, lesson, solved: dict, stars: dict[int, int]) -> None:
    """Raise ValueError with the lesson's name unless every exercise has a check, a solution and stars."""
    tagged = _tagged(lesson)
    exercises = {number for kind, number in tagged if kind == "exercise"}
    checks = {number for kind, number in tagged if kind == "check"}
    solutions = {number for kind, number in solved if kind == "exercise"}
    for what, found in {"checks": checks, "solutions": solutions, "stars": set(stars)}.items():
        if found != exercises:
            raise ValueError(f"{path}: expected {what} for exercises {sorted(exercises)}, got {sorted(found)}")


def student_version(source):
    """The source version without solutions and hidden tests, its graded cells locked: what nbgrader would release."""
    import copy

    notebook = copy.deepcopy(source)
    for cell in notebook.cells:
        grading = cell.metadata.get("nbgrader")
        if grading:
            cell.source = cut(cut(cell.source, SOLUTION, [STUB]), HIDDEN_TESTS, [])
            cell.metadata["deletable"] = False
            if grading["locked"]:
                cell.metadata["editable"] = False
    return notebook


def exercise_stars(lesson) -> dict[int, int]:
    """The stars of each exercise of a lesson, by its number; an exercise is worth as many points."""
    text = "\n".join(cell.source for cell in lesson.cells)
    named = re.findall(r"Exercise (\d+) \(?(★+)", text)
    listed = re.findall(r"^(\d+)\. (★+)", text, re.MULTILINE)
    return {int(number): len(stars) for number, stars in named + listed}


def _graded_cell(check: str, lesson: str, exercise: int, points: int):
    """A locked cell whose hidden tests run the check of the cell before it, and fail with its sentence."""
    number, subject = lesson.split("_", 1)
    from nbformat.v4 import new_code_cell

    call = re.fullmatch(r"checks\.(check_\w+)\((\w+)\)", check.splitlines()[-1])
    if call is None:
        raise ValueError(f"expected a check of one answer, checks.check_...(...), got {check.splitlines()[-1]!r}")
    lines = [
        f"# Exercise {exercise} is graded here, by the check above: {points} point{'s' * (points > 1)}.",
        *FRESH_CHECK.format(module=f"npslam_teach.course.{subject}.checks", check=call[1], answer=call[2]).splitlines(),
    ]
    grading = _metadata(f"lesson-{number}-grade-{exercise}", grade=True, locked=True, points=points)
    return new_code_cell("\n".join(lines), id=f"grade-{exercise}", metadata={"nbgrader": grading})


def _metadata(grade_id: str, solution=False, grade=False, locked=False, **points) -> dict:
    """The metadata of a cell by version 3 of nbgrader's schema."""
    kind = {"solution": solution, "grade": grade, "locked": locked, "task": False}
    return {"schema_version": 3, "grade_id": grade_id, **kind, **points}


def _kind_of(cell) -> tuple[str, int]:
    """("exercise", 3) or ("check", 3) for a cell with such a tag, ("", 0) for others."""
    for tag in cell.metadata.get("tags", []):
        if match := re.fullmatch(r"(exercise|check)-(\d+)", tag):
            return match[1], int(match[2])
    return "", 0


def _tagged(notebook) -> dict:
    return {_kind_of(cell): cell for cell in notebook.cells}


def _setup_imports(solutions) -> dict[str, str]:
    """What the solutions' first cell of code imports."""
    setup = next(cell for cell in solutions.cells if "setup" in cell.metadata.get("tags", []))
    return imports(setup.source)


def _without_outputs(cell):
    cell.outputs, cell.execution_count = [], None
    return cell


def _self_contained(cell, folder: Path):
    """Pictures go into the cell, links to other files become plain text, so that the notebook works in any folder."""
    cell.source = without_badge(cell.source)
    for alt, target in re.findall(r"!\[([^\]]*)\]\(([^)]+)\)", cell.source):
        if re.match(r"https?://", target):
            continue
        picture = folder / target
        data = base64.b64encode(picture.read_bytes()).decode("ascii")
        cell.setdefault("attachments", {})[picture.name] = {"image/png": data}
        cell.source = cell.source.replace(f"![{alt}]({target})", f"![{alt}](attachment:{picture.name})")
    for words, target in re.findall(r"(?<!!)\[([^\]]+)\]\(([^)]+)\)", cell.source):
        if (folder / target).exists():
            cell.source = cell.source.replace(f"[{words}]({target})", words)
    return cell
