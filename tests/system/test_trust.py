"""Which notebooks ``lab`` signs for Jupyter: those of the commit that its own code is from, and no others."""

import shutil
import subprocess
import sys

import nbformat
import pytest
from nbformat.sign import NotebookNotary

from npslam_teach.system import trust
from npslam_teach.system.trust import trust_committed

pytestmark = pytest.mark.skipif(shutil.which("git") is None, reason="git is not installed")


def git(folder, *arguments):
    who = ["-c", "user.name=a", "-c", "user.email=a@b", "-c", "init.defaultBranch=main"]
    subprocess.run(["git", *who, *arguments], cwd=folder, check=True, capture_output=True)


def write(path, source):
    path.parent.mkdir(parents=True, exist_ok=True)
    nbformat.write(nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(source, id="one")]), path)


@pytest.fixture
def course(tmp_path, monkeypatch):
    """A clone of three lessons, and a folder of Jupyter's own that only this test uses."""
    monkeypatch.setenv("JUPYTER_DATA_DIR", str(tmp_path / "jupyter"))
    root = tmp_path / "course"
    for name in ("00", "01", "solutions/00"):
        write(root / "notebooks" / f"{name}.ipynb", f"lesson = {name[-2:]!r}")
    git(root, "init")
    git(root, "add", ".")
    git(root, "commit", "-m", "lessons")
    return root


def is_trusted(path) -> bool:
    notary = NotebookNotary()
    try:
        return notary.check_signature(nbformat.read(path, as_version=4))
    finally:
        notary.store.close()


def test_lessons_as_they_were_committed_are_trusted(course):
    paths = [course / "notebooks" / f"{name}.ipynb" for name in ("00", "01", "solutions/00")]
    assert not any(map(is_trusted, paths))
    assert sorted(trust_committed(course)) == [
        "notebooks/00.ipynb",
        "notebooks/01.ipynb",
        "notebooks/solutions/00.ipynb",
    ]
    assert all(map(is_trusted, paths))


def test_what_was_changed_staged_or_brought_in_is_not(course):
    write(course / "notebooks" / "00.ipynb", "changed = True")
    write(course / "notebooks" / "01.ipynb", "staged = True")
    git(course, "add", "notebooks/01.ipynb")
    write(course / "notebooks" / "friend.ipynb", "whose = 'a friend'")
    assert trust_committed(course) == ["notebooks/solutions/00.ipynb"]
    assert not any(is_trusted(course / "notebooks" / f"{name}.ipynb") for name in ("00", "01", "friend"))


def test_a_lesson_that_was_deleted_is_passed_over(course):
    (course / "notebooks" / "00.ipynb").unlink()
    assert "notebooks/00.ipynb" not in trust_committed(course)


def test_a_course_within_a_larger_repository_is_known_by_its_own_names(course):
    (course / "deeper").mkdir()
    git(course, "mv", "notebooks", "deeper/notebooks")
    git(course, "commit", "-m", "deeper")
    write(course / "deeper" / "notebooks" / "01.ipynb", "changed = True")
    assert sorted(trust_committed(course / "deeper")) == ["notebooks/00.ipynb", "notebooks/solutions/00.ipynb"]


def test_without_a_clone_nothing_is_trusted(course):
    shutil.rmtree(course / ".git")
    assert trust_committed(course) == []
    assert not is_trusted(course / "notebooks" / "00.ipynb")


def test_without_git_nothing_is_trusted(course, monkeypatch):
    monkeypatch.setattr(shutil, "which", lambda name: None)
    assert trust_committed(course) == []


def test_jupyterlab_starts_when_the_lessons_are_signed(course, monkeypatch):
    seen = []
    lesson = course / "notebooks" / "00.ipynb"
    monkeypatch.setattr("jupyterlab.labapp.main", lambda: seen.append(is_trusted(lesson)) or 5)
    monkeypatch.chdir(course)
    assert trust.main() == 5 and seen == [True]


def test_jupyterlab_starts_without_a_grammar_that_nobody_asks_for(tmp_path):
    """A process of its own: here jsonschema has looked for it long ago."""
    program = "import sys\nfrom npslam_teach.system import trust\ntrust.trust_committed = lambda root: None\n"
    program += "class Lab: main = staticmethod(lambda: __import__('jsonschema') and 0)\n"
    program += "import types; sys.modules['jupyterlab'] = types.SimpleNamespace(labapp=Lab)\n"
    program += "sys.exit(trust.main() or bool(sys.modules.get('rfc3987_syntax')))"
    subprocess.run([sys.executable, "-c", program], cwd=tmp_path, check=True)
