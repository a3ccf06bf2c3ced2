"""What students pull from holds no answer, and what teachers make beside it is not committed by accident."""

import re
from pathlib import Path

import nbformat
import pytest

from npslam_teach.cli import parser
from npslam_teach.publishing import student_course

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def course(tmp_path_factory):
    folder = tmp_path_factory.mktemp("students") / "course"
    assert parser.main(["assignment", "--course", "--out", str(folder)]) == 0
    return folder


def test_no_solution_is_in_it(course):
    names = {path.relative_to(course).as_posix() for path in course.rglob("*") if path.is_file()}
    assert not [
        name for name in names if "solution" in name and name.startswith("notebooks") or "teaching_guide" in name
    ]
    assert not [name for name in names if name.startswith("tests/") or "/answers" in name]
    lessons = {path.name for path in (ROOT / "notebooks").glob("*.ipynb")}
    assert {path.name for path in (course / "notebooks").glob("*.ipynb")} == lessons
    assert {"pyproject.toml", "environment.txt", ".binder/runtime.txt", "npslam_teach/__main__.py"} <= names


def test_no_solution_is_in_the_text_either(course):
    text = "\n".join(path.read_text(encoding="utf-8") for path in (course / "notebooks").glob("*.ipynb"))
    for path in (ROOT / "notebooks" / "solutions").glob("*.ipynb"):
        for cell in nbformat.read(path, as_version=4).cells:
            if any(tag.startswith("exercise-") for tag in cell.metadata.get("tags", [])):
                body = cell.source.split(":\n", 1)[1]
                assert body.replace("\n", "\\n") not in text and body not in text


def test_links_lead_somewhere(course):
    for path in (course / "README.md", *(course / "notebooks").glob("*.md")):
        for target in re.findall(r"\]\(([^)#]+)[^)]*\)", path.read_text(encoding="utf-8")):
            assert target.startswith("https://") or (path.parent / target).exists(), (path.name, target)


def test_it_is_never_written_over(course, capsys):
    assert parser.main(["assignment", "--course", "--out", str(course)]) == 2
    assert "expected a new folder or an empty one" in capsys.readouterr().err


def test_answers_are_not_written_where_git_would_see_them(capsys):
    assert parser.main(["assignment", "04", "--out", str(ROOT / "marks")]) == 2
    assert "expected a folder outside the course, or work or COURSE in it" in capsys.readouterr().err
    assert not (ROOT / "marks").exists()
    ignored = (ROOT / ".gitignore").read_text(encoding="utf-8").splitlines()
    assert "/COURSE/" in ignored and "/work/" in ignored


def test_links_to_answers_become_words():
    text = (
        "[solutions](solutions/01_solutions.ipynb), [guide](notebooks/teaching_guide.md#x), [03](03_pose_graph.ipynb)"
    )
    assert student_course.without_answers(text) == "solutions, guide, [03](03_pose_graph.ipynb)"
