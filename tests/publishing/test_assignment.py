"""Assignments are made from the lessons alone, nbgrader accepts them, and marks what the checks say.

nbgrader is for instructors, and not in environment.txt: ``pip install -r tests/requirements-classroom.txt``. Grading
runs whole lessons, so one is graded here; ``NPSLAM_TEACH_GRADE=01,02,03,04,05,06,07,08,09`` grades those instead.
"""

import ast
import copy
import html
import itertools
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import nbformat
import pytest
from slices import needed_statements

from npslam_teach.cli import parser
from npslam_teach.course import checking
from npslam_teach.publishing import assignments, solution_cells
from npslam_teach.publishing.colab import own_source

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]
NOTEBOOKS = ROOT / "notebooks"
LESSONS = sorted(assignments.lessons_with_exercises(NOTEBOOKS))
GRADED = os.environ.get("NPSLAM_TEACH_GRADE", "02").split(",")
NO_NBGRADER = "nbgrader is not installed: pip install -r tests/requirements-classroom.txt"


def run(*arguments) -> int:
    return parser.main(["assignment", *map(str, arguments)])


def code(notebook):
    return [cell for cell in notebook.cells if cell.cell_type == "code"]


def graded(notebook, kind):
    """The cells of nbgrader by their grade_id: kind is "solution" or "grade"."""
    cells = [cell for cell in notebook.cells if cell.metadata.get("nbgrader", {}).get(kind)]
    return {cell.metadata["nbgrader"]["grade_id"]: cell for cell in cells}


@pytest.fixture(params=LESSONS)
def source(request):
    return assignments.assignment_source(NOTEBOOKS, request.param)[1]


def test_every_lesson_but_the_first_has_an_assignment():
    lessons = sorted(path.stem[:2] for path in NOTEBOOKS.glob("[0-9][0-9]_*.ipynb"))
    assert LESSONS == lessons[1:] and len(LESSONS) >= 9


def test_the_source_is_the_lesson_with_its_solutions(source):
    nbformat.validate(source)
    exercises, tests = graded(source, "solution"), graded(source, "grade")
    assert 3 <= len(exercises) == len(tests) <= 5
    assert len(exercises.keys() | tests.keys()) == len(exercises) + len(tests), "each grade_id once"
    for cell in exercises.values():
        assert cell.source.count("### BEGIN SOLUTION") == cell.source.count("### END SOLUTION") == 1
        ast.parse(cell.source)
    assert all(cell.outputs == [] and cell.execution_count is None for cell in code(source))


def test_points_are_stars(source):
    """Every exercise has as many points as stars, counted here independently of the module."""
    points = [cell.metadata["nbgrader"]["points"] for cell in graded(source, "grade").values()]
    text = "\n".join(cell.source for cell in source.cells)
    for number, stars in enumerate(points, start=1):
        marks = "★" * stars
        assert any(
            f"{name}{mark}" in text
            for name in (f"Exercise {number} ", f"\n{number}. ")
            for mark in (f"{marks}**", f"({marks})", f"{marks} ")
        )
    assert set(points) >= {1, 2, 3}


def test_the_students_copy_holds_no_answer_and_no_hidden_test(source):
    student = assignments.student_version(source)
    text = nbformat.writes(student)
    assert not any(mark in text for mark in ("SOLUTION", "HIDDEN", "checks.require"))
    for grade_id, cell in graded(student, "solution").items():
        (function,) = ast.parse(cell.source).body
        assert cell.source.endswith("\n    ...")
        answer = graded(source, "solution")[grade_id].source
        body = answer.split("### BEGIN SOLUTION\n")[1].split("\n    ### END")[0].splitlines()
        assert not set(body) & set(cell.source.splitlines()), function.name


def test_copies_lie_anywhere(source):
    """Pictures travel with the notebook, and no link leads to a file beside the lesson."""
    pictures = 0
    for cell in source.cells:
        if cell.cell_type == "markdown":
            assert ".ipynb" not in cell.source and "../" not in cell.source and "Colab" not in cell.source
            for name, data in cell.get("attachments", {}).items():
                pictures += 1
                assert f"](attachment:{name})" in cell.source
                assert data["image/png"].startswith("iVBOR"), "a PNG"
    assert pictures >= 1


def test_graded_cells_hide_no_name_of_the_lesson(source):
    """A cell that only nbgrader sees must not change what the lesson's own cells mean."""
    for cell in graded(source, "grade").values():
        (function, *calls) = ast.parse(cell.source).body
        assert isinstance(function, ast.FunctionDef) and function.name == "_graded"
        assert len(calls) == 2 and all(isinstance(call, ast.Expr) for call in calls)
    assert not any(
        isinstance(node, ast.Name) and node.id == "_graded"
        for cell in code(source)
        if not cell.metadata.get("nbgrader", {}).get("grade")
        for node in ast.walk(ast.parse(cell.source))
    )


CHEATS = {
    "the check is replaced": "checks.check_compose = lambda answer: checking.right('done')",
    "what fails is replaced": "checking.require = lambda check, answer: None",
    "the verdict is replaced": "checking.Verdict.passed = True",
    "the right answer is replaced": "se2.compose = compose",
    "the engine is replaced": "trials.check_function = lambda *a: checking.right('done')",
}


@pytest.mark.parametrize("cheat", CHEATS.values(), ids=list(CHEATS))
def test_a_submission_that_changes_the_library_has_no_marks(cheat):
    """In the cells of a student, where nobody stops it; the graded cell reads the library anew."""
    source = assignments.assignment_source(NOTEBOOKS, "02")[1]
    cell = graded(source, "grade")["lesson-02-grade-1"].source
    wrong = "def compose(pose, step):\n    return [0.0, 0.0, 0.0]"
    imports = "from npslam_teach import se2\nfrom npslam_teach.course import checking, trials\n"
    imports += "from npslam_teach.course.drift import checks"
    with pytest.raises(AssertionError, match="AssertionError: Not yet"):
        in_a_process(f"{imports}\n{wrong}\n{cheat}\n{cell}")


def test_right_answers_keep_their_marks_and_the_lesson_its_modules():
    """Also where an answer is an object of the library's as the lesson has imported it, a graph."""
    source = assignments.assignment_source(NOTEBOOKS, "06")[1]
    exercises, tests = graded(source, "solution").values(), graded(source, "grade").values()
    setup = "import numpy as np\nfrom math import lgamma, log\nimport npslam_teach\nbefore = npslam_teach.PoseGraph"
    setup += "\nfrom npslam_teach import optimize, se2, sweep\nfrom npslam_teach.pose_graph import with_associations"
    cells = "\n".join(cell.source for cell in (*exercises, *tests))
    in_a_process(f"{setup}\n{cells}\nassert npslam_teach.PoseGraph is before\nimport npslam_teach.course as c")


def in_a_process(text):
    done = subprocess.run([sys.executable, "-c", text], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_imports_of_a_solution_stay_within_it():
    """Lesson 06 has a variable ``log``; the solution needs ``math.log``."""
    exercise = "def f(x):\n    # a number\n    ..."
    solution = "def f(x):\n    return log(x) + np.pi"
    made = solution_cells.with_solution(
        exercise, solution, {"log": "from math import log", "lgamma": "from math import lgamma"}
    )
    assert made.splitlines() == [
        "def f(x):",
        "    # a number",
        "    ### BEGIN SOLUTION",
        "    from math import log",
        "    return log(x) + np.pi",
        "    ### END SOLUTION",
    ]


def test_an_argument_is_not_imported():
    """In lesson 06 ``log`` is also the name of an argument."""
    made = solution_cells.with_solution(
        "def f(log):\n    ...",
        "def f(log):\n    area = log.area\n    return area",
        {"log": "from math import log", "area": "from rooms import area"},
    )
    assert "import" not in made


@pytest.mark.parametrize("exercise", ["def g(x):\n    ...", "def f(y):\n    ...", "def f(x):\n    return x"])
def test_a_lesson_that_does_not_match_its_solutions_is_refused(exercise):
    with pytest.raises(ValueError, match="expected the lesson to have f of its solutions, ending in dots"):
        solution_cells.with_solution(exercise, "def f(x):\n    return 2 * x", {})


@pytest.mark.parametrize(
    ("what", "change"),
    [
        ("checks", lambda lesson, solutions: by_tag(lesson, "check-2").metadata.clear()),
        ("solutions", lambda lesson, solutions: by_tag(solutions, "exercise-2").metadata.clear()),
        ("stars", lambda lesson, solutions: by_tag(lesson, "exercise-2").update(source="def f(x):\n    ...")),
    ],
)
def test_a_lesson_that_lacks_a_part_is_named(what, change, tmp_path):
    paths = [tmp_path / "03_pose_graph.ipynb", tmp_path / "solutions" / "03_solutions.ipynb"]
    paths[1].parent.mkdir()
    notebooks = [nbformat.read(NOTEBOOKS / path.relative_to(tmp_path), as_version=4) for path in paths]
    change(*notebooks)
    if what == "stars":
        notebooks[0].cells = [cell for cell in notebooks[0].cells if cell.cell_type == "code"]
    for path, notebook in zip(paths, notebooks, strict=True):
        nbformat.write(notebook, path)
    with pytest.raises(ValueError, match=rf"03_pose_graph.ipynb: expected {what} for exercises \[1, 2, 3, 4, 5\], got"):
        assignments.assignment_source(tmp_path, "03")


def by_tag(notebook, tag):
    return next(cell for cell in notebook.cells if tag in cell.metadata.get("tags", []))


def test_pictures_of_the_web_stay_where_they_are():
    from nbformat.v4 import new_markdown_cell

    badge = "[![Open](https://example.org/badge.svg)](https://example.org/lesson)"
    cell = assignments._self_contained(new_markdown_cell(badge), NOTEBOOKS)
    assert cell.source == badge and "attachments" not in cell


def test_require_fails_with_the_sentence_of_the_check():
    checking.require(lambda answer: checking.right("well done"), 1)
    with pytest.raises(AssertionError, match=r"^Not yet: the angle is not wrapped\.$"):
        checking.require(lambda answer: checking.wrong("the angle is not wrapped"), 1)


def test_a_right_answer_that_warns_is_right(capsys):
    """nbgrader takes anything on standard error for a failure."""

    def check(function):
        function()
        return checking.right("done")

    def noisy():
        import warnings

        warnings.warn("divide by zero", RuntimeWarning, stacklevel=1)
        print("half way", file=sys.stderr)

    checking.require(check, noisy)
    assert capsys.readouterr().err == ""


def test_the_command_writes_and_never_overwrites(tmp_path, capsys):
    out = tmp_path / "course"
    assert run("04", "05", "--out", out) == 0
    written = {path.relative_to(out).as_posix() for path in out.rglob("*") if path.is_file()}
    assert written == {
        "nbgrader_config.py",
        "source/04/04_dirichlet_process.ipynb",
        "source/05/05_class_votes.ipynb",
        "student/04/04_dirichlet_process.ipynb",
        "student/05/05_class_votes.ipynb",
    }
    assert len(capsys.readouterr().out.splitlines()) == 5
    work = out / "student" / "05" / "05_class_votes.ipynb"
    work.write_text("my work", encoding="utf-8")
    assert run("05", "06", "--out", out) == 2
    message = capsys.readouterr().err
    assert "05_class_votes.ipynb: expected no file of that name" in message and message.count("\n") == 1
    assert work.read_text(encoding="utf-8") == "my work"
    assert not (out / "student" / "06").exists(), "refused before anything is written"


def test_settings_of_the_instructor_are_kept(tmp_path):
    (tmp_path / "nbgrader_config.py").write_text("c = get_config()\n", encoding="utf-8")
    assert run("04", "--out", tmp_path) == 0
    assert (tmp_path / "nbgrader_config.py").read_text(encoding="utf-8") == "c = get_config()\n"


def test_a_students_own_copy_comes_without_solutions(tmp_path):
    assert run("07", "--student", "--out", tmp_path) == 0
    assert [path.name for path in tmp_path.rglob("*.*")] == ["07_fifteen_objects.ipynb"]


@pytest.mark.parametrize("number", ["00", "4", "99", "../04"])
def test_a_lesson_without_exercises_is_refused(number, tmp_path, capsys):
    assert run(number, "--out", tmp_path / "new") == 2
    assert f"LESSON: expected one of {', '.join(LESSONS)}, got '{number}'" in capsys.readouterr().err
    assert not (tmp_path / "new").exists()


def test_no_lesson_and_no_course_is_refused(tmp_path, capsys):
    assert run("--out", tmp_path / "new") == 2
    assert "LESSON: expected numbers of lessons, such as 04, or --course, got neither" in capsys.readouterr().err
    assert not (tmp_path / "new").exists()


def test_making_assignments_needs_no_nbgrader(tmp_path):
    code = (
        "import sys; sys.modules['nbgrader'] = None\n"
        f"from npslam_teach import cli; sys.exit(cli.main(['assignment', '01', '--out', {str(tmp_path)!r}]))"
    )
    subprocess.run([sys.executable, "-c", code], check=True, capture_output=True)


def test_nbgrader_accepts_the_metadata_of_every_lesson(source):
    nbgraderformat = pytest.importorskip("nbgrader.nbgraderformat", reason=NO_NBGRADER)
    for notebook in (source, assignments.student_version(source)):
        nbgraderformat.MetadataValidator().validate_nb(copy.deepcopy(notebook))
        for cell in notebook.cells:
            assert cell.metadata.get("nbgrader", {}).get("schema_version", 3) == nbgraderformat.SCHEMA_VERSION


# A typical mistake in the last exercise: the line of the solution, that of the student, and the check's message.
TYPICAL = {
    "02": (
        "R @ np.diag(np.square(observation_std)) @ R.T",
        "np.diag(np.square(observation_std))",
        "Not yet: the camera's error is not turned into the room.",
    )
}


def answered(source, lesson, who):
    """A student's submission: "solved"; "blank"; or "partly": the last is wrong, the one before it left out."""
    handed_in = assignments.student_version(source)
    exercises, solved = graded(handed_in, "solution"), graded(source, "solution")
    *others, left_out, last = exercises
    for grade_id, cell in exercises.items() if who != "blank" else ():
        if who == "solved" or grade_id in others:
            cell.source = solved[grade_id].source
        elif grade_id == last:
            right, wrong, _ = TYPICAL.get(lesson, (solved[last].source, cell.source.replace("...", "return 0.123"), ""))
            assert right in solved[last].source
            cell.source = solved[last].source.replace(right, wrong)
    return handed_in if who == "solved" else shortened(handed_in)


def shortened(handed_in):
    """A submission whose other cells do only what the exercises need: the solved copy runs as a whole."""
    cells = code(handed_in)
    asked = {k for k, cell in enumerate(cells) if "nbgrader" in cell.metadata}
    needed = needed_statements([own_source(cell.source) for cell in cells], asked)
    for k, (cell, source) in enumerate(itertools.zip_longest(cells, needed, fillvalue="")):
        cell.source = cell.source if k in asked else source
    return handed_in


def nbgrader(command, lesson, course, *options, **settings):
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])  # it calls alembic by its name
    arguments = [sys.executable, "-m", "nbgrader", command, lesson, *options]
    environment = os.environ | {"PATH": path} | settings
    done = subprocess.run(arguments, cwd=course, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


@pytest.fixture(scope="module", params=GRADED)
def course(request, tmp_path_factory):
    """A course folder in which nbgrader has released, collected and graded one lesson of three students."""
    pytest.importorskip("nbgrader", reason=NO_NBGRADER)
    folder, lesson = tmp_path_factory.mktemp("course"), request.param
    assert run(lesson, "--out", folder) == 0
    (name,) = (path.name for path in (folder / "source" / lesson).iterdir())
    source = nbformat.read(folder / "source" / lesson / name, as_version=4)
    nbgrader("generate_assignment", lesson, folder)
    for who in ("solved", "blank", "partly"):
        path = folder / "submitted" / who / lesson / name
        path.parent.mkdir(parents=True)
        nbformat.write(answered(source, lesson, who), path)
    nbgrader("autograde", lesson, folder)
    nbgrader("generate_feedback", lesson, folder)
    return folder, lesson, name


def handed_back(course, who):
    folder, lesson, name = course
    return nbformat.read(folder / "autograded" / who / lesson / name, as_version=4)


def marks(course, who):
    from nbgrader.api import Gradebook

    folder, lesson, _ = course
    with Gradebook(f"sqlite:///{folder / 'gradebook.db'}") as gradebook:
        (notebook,) = gradebook.find_submission(lesson, who).notebooks
        return {grade.name: (grade.auto_score, grade.max_score_gradecell) for grade in notebook.grades}


def errors(notebook):
    return {
        cell.metadata.get("nbgrader", {}).get("grade_id", cell.source): output.evalue
        for cell in code(notebook)
        for output in cell.outputs
        if output.output_type == "error"
    }


def test_validating_a_blank_release_does_not_say_success(course):
    folder, lesson, name = course
    done = subprocess.run(
        [sys.executable, "-m", "nbgrader", "validate", f"release/{lesson}/{name}"],
        cwd=folder,
        capture_output=True,
        text=True,
    )
    assert "Success" not in done.stdout and f"Not yet: {checking.BLANK}" in done.stdout


def test_the_students_copy_is_what_nbgrader_releases(course):
    folder, lesson, name = course
    ours, theirs = (nbformat.read(folder / kind / lesson / name, as_version=4) for kind in ("student", "release"))
    for cell in theirs.cells:
        for key in ("checksum", "cell_type"):  # what it adds to recognise its cells
            cell.metadata.get("nbgrader", {}).pop(key, None)
    assert ours.cells == theirs.cells


def test_a_solved_copy_has_full_marks_and_runs_through(course):
    assert errors(handed_back(course, "solved")) == {}
    assert all(score == most > 0 for score, most in marks(course, "solved").values())


def test_a_blank_copy_has_none(course):
    assert all(score == 0 for score, _ in marks(course, "blank").values())
    assert set(errors(handed_back(course, "blank")).values()) == {f"Not yet: {checking.BLANK}."}


def test_a_partly_wrong_copy_is_told_by_the_check_what_is_wrong(course):
    folder, lesson, name = course
    got, messages = marks(course, "partly"), errors(handed_back(course, "partly"))
    *others, left_out, last = sorted(got)
    assert [got[grade_id][0] for grade_id in (left_out, last)] == [0, 0]
    assert others and all(got[grade_id][0] == got[grade_id][1] > 0 for grade_id in others)
    assert set(messages) == {left_out, last}
    assert messages[left_out] == f"Not yet: {checking.BLANK}."
    *_, expected = TYPICAL.get(lesson, (messages[last],))
    assert messages[last] == expected and messages[last].startswith("Not yet: ")
    assert checking.BLANK not in messages[last]
    feedback = (folder / "feedback" / "partly" / lesson / f"{Path(name).stem}.html").read_text(encoding="utf-8")
    assert messages[last] in html.unescape(feedback)


# ---- grading as somebody who can read neither solutions nor marks ----

NOBODY = ("setpriv", "--reuid=65534", "--regid=65534", "--clear-groups")
SPY = """
import os
from pathlib import Path
for path in ({course!r}, {course!r} + "/source", {course!r} + "/gradebook.db"):
    try:
        print("open", os.listdir(path) if Path(path).is_dir() else len(Path(path).read_bytes()))
    except PermissionError:
        print("closed")
print("user", os.getuid())
"""


@pytest.fixture
def open_folder():
    """A folder that every user can read, with the library in it, as a student's course has it."""
    with tempfile.TemporaryDirectory() as folder:
        os.chmod(folder, 0o755)
        shutil.copytree(ROOT / "npslam_teach", Path(folder) / "npslam_teach")
        if not hasattr(os, "geteuid") or os.geteuid() != 0 or shutil.which(NOBODY[0]) is None:
            pytest.skip("only root can start a kernel as another user without a password, by setpriv")
        trial = [*NOBODY, sys.executable, "-c", "import ipykernel, numpy, npslam_teach"]
        if subprocess.run(trial, cwd=folder, env=os.environ | {"PYTHONPATH": folder}, capture_output=True).returncode:
            pytest.skip("another user cannot read this Python's packages")
        yield Path(folder)


def test_a_kernel_of_another_user_grades_and_cannot_read_solutions_or_marks(course, open_folder):
    """The kernel specification of the guide, with setpriv in the place of sudo, which would ask for a password."""
    folder, lesson, name = course
    guide = (NOTEBOOKS / "teaching_guide.md").read_text(encoding="utf-8")
    spec = json.loads(re.search(r"```json\n(.+?)```", guide, re.DOTALL).group(1))
    command = spec["argv"][-1]
    assert "sudo -n -u sandbox /srv/env/bin/python" in command
    spec["argv"][-1] = command.replace("sudo -n -u sandbox /srv/env/bin/python", " ".join((*NOBODY, sys.executable)))
    kernel = open_folder / "jupyter" / "kernels" / "python3" / "kernel.json"
    kernel.parent.mkdir(parents=True)
    kernel.write_text(json.dumps(spec), encoding="utf-8")
    handed_in = shortened(answered(nbformat.read(folder / "source" / lesson / name, as_version=4), lesson, "solved"))
    handed_in.cells.insert(1, nbformat.v4.new_code_cell(SPY.format(course=str(folder))))
    path = folder / "submitted" / "curious" / lesson / name
    path.parent.mkdir(parents=True)
    nbformat.write(handed_in, path)
    folder.chmod(0o700)
    settings = {"JUPYTER_PATH": str(open_folder / "jupyter"), "PYTHONPATH": str(open_folder)}
    settings |= {"JUPYTER_PREFER_ENV_PATH": "0"}
    nbgrader("autograde", lesson, folder, "--student", "curious", **settings)
    assert errors(handed_back(course, "curious")) == {}
    assert all(score == most > 0 for score, most in marks(course, "curious").values())
    seen = code(handed_back(course, "curious"))[0].outputs[0].text
    assert seen.splitlines() == ["closed", "closed", "closed", "user 65534"]
