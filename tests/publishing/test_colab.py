"""How lessons begin: a badge that leads to Colab, and a cell that installs the course where it is missing."""

import ast
import asyncio
import importlib.machinery
import importlib.util
import inspect
import shutil
import sys
import types
from pathlib import Path

import nbformat
import pytest

from npslam_teach.cli import parser
from npslam_teach.publishing import colab, lessons

ROOT = Path(__file__).parents[2]
ADDRESS = "https://github.com/some-school/slam.course"


@pytest.fixture(params=lessons.lesson_paths(ROOT / "notebooks"), ids=lambda path: path.stem)
def path(request):
    return request.param


@pytest.fixture
def course(tmp_path):
    """A copy of two lessons and of what they depend on, to write into."""
    (tmp_path / "notebooks").mkdir()
    for name in ("00_start_here.ipynb", "01_why_association.ipynb"):
        shutil.copy(ROOT / "notebooks" / name, tmp_path / "notebooks")
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    return tmp_path


def publish(course, address):
    file = course / "pyproject.toml"
    file.write_text(
        file.read_text(encoding="utf-8") + f'\n[project.urls]\nRepository = "{address}"\n', encoding="utf-8"
    )


def run_cell(source):
    """Run a cell as a notebook does: await is allowed at its top."""
    code = compile(source, "cell", "exec", flags=ast.PyCF_ALLOW_TOP_LEVEL_AWAIT)
    scope = {}
    result = types.FunctionType(code, scope)()
    if inspect.isawaitable(result):
        asyncio.run(result)
    return scope


def test_lessons_begin_as_pyproject_says(path):
    """`python3 -m npslam_teach badges` would change nothing."""
    notebook = lessons.read(path)
    address = colab.repository(ROOT / "pyproject.toml")
    assert notebook.cells[0].source.splitlines()[2] == colab.badge(path.name, address)
    (cell,) = [cell for cell in notebook.cells if colab.TAG in cell.metadata.get("tags", [])]
    assert cell is next(cell for cell in notebook.cells if cell.cell_type == "code"), "before anything is imported"
    own = colab.own_source(cell.source)
    assert cell.source == colab.install_source(address) + (f"\n\n{own}" if own else "")
    assert bool(own) == (path.stem == "00_start_here"), "which opens with its picture; all others install and are done"
    assert colab.with_beginning(lessons.read(path), path.name, address) == notebook


def test_the_badges_picture_is_there(path):
    assert (path.parent / "open_in_colab.svg").resolve() in lessons.picture_files(path)


def test_badges_lead_to_the_lesson_in_the_repository(course, capsys):
    publish(course, ADDRESS)
    changed = colab.write_badges(course)
    assert [path.name for path in changed] == ["00_start_here.ipynb", "01_why_association.ipynb"]
    for path in changed:
        notebook = lessons.read(path)
        nbformat.validate(notebook)
        target = f"https://colab.research.google.com/github/some-school/slam.course/blob/main/notebooks/{path.name}"
        assert f"(open_in_colab.svg)]({target})" in notebook.cells[0].source.splitlines()[2]
        assert f"git+{ADDRESS}" in notebook.cells[1].source
    assert colab.write_badges(course) == []


def test_nothing_else_changes(course):
    before = {path.name: path.read_text(encoding="utf-8") for path in (course / "notebooks").iterdir()}
    publish(course, ADDRESS)
    for path in colab.write_badges(course):
        old, new = before[path.name].splitlines(), path.read_text(encoding="utf-8").splitlines()
        assert len(old) == len(new)
        assert sum(a != b for a, b in zip(old, new, strict=True)) == 2, "the badge's line and the cell's last"


@pytest.mark.parametrize("own", ["", "import numpy\n\nnumpy.zeros(3)"])
@pytest.mark.parametrize("address", [None, ADDRESS])
def test_what_a_first_cell_does_beside_the_installation_stays(own, address):
    installs = colab.install_source(address)
    assert colab.own_source(installs + (f"\n\n{own}" if own else "")) == own == colab.own_source(own)


def test_a_lost_installation_comes_back_before_what_the_cell_shows(course):
    notebook = lessons.read(course / "notebooks" / "00_start_here.ipynb")
    whole = notebook.cells[1].source
    notebook.cells[1].source = colab.own_source(whole)
    assert colab.with_beginning(notebook, "00_start_here.ipynb", None).cells[1].source == whole


def test_a_lost_badge_comes_back(course):
    path = course / "notebooks" / "00_start_here.ipynb"
    whole = path.read_text(encoding="utf-8")
    notebook = lessons.read(path)
    lines = notebook.cells[0].source.splitlines()
    notebook.cells[0].source = "\n".join(lines[:1] + lines[3:])
    nbformat.write(notebook, path)
    assert colab.write_badges(course) == [path]
    assert path.read_text(encoding="utf-8") == whole


@pytest.mark.parametrize("address", ["http://github.com/a/b", "https://example.org/a/b", "https://github.com/a", "a/b"])
def test_an_address_that_colab_cannot_open_is_refused(course, address):
    publish(course, address)
    with pytest.raises(ValueError, match="Repository: expected https://github.com/OWNER/NAME, got"):
        colab.write_badges(course)


def test_the_command_says_what_it_did(capsys):
    assert parser.main(["badges"]) == 0
    assert capsys.readouterr().out.startswith("badges: 0 lessons changed")


@pytest.mark.parametrize("address", [None, ADDRESS])
def test_the_cell_does_nothing_where_the_course_is(address, monkeypatch):
    monkeypatch.setitem(sys.modules, "piplite", None)
    names = set(run_cell(colab.install_source(address)))
    assert names <= {"importlib", "__builtins__"}


@pytest.fixture
def missing(monkeypatch):
    """As if the course were not installed, with or without ``piplite``."""
    found = importlib.util.find_spec

    def hide(with_piplite):
        def find_spec(name, *more):
            if name == "npslam_teach":
                return None
            if name == "piplite":
                return importlib.machinery.ModuleSpec("piplite", None) if with_piplite else None
            return found(name, *more)

        monkeypatch.setattr(importlib.util, "find_spec", find_spec)

    return hide


@pytest.mark.parametrize("address", [None, ADDRESS])
def test_in_a_browser_the_cell_installs_from_the_site(address, missing, monkeypatch):
    asked = []

    async def install(name):
        asked.append(name)

    piplite = types.ModuleType("piplite")
    piplite.install = install
    monkeypatch.setitem(sys.modules, "piplite", piplite)
    missing(with_piplite=True)
    run_cell(colab.install_source(address))
    assert asked == ["npslam_teach"]


def test_in_colab_the_cell_installs_from_the_repository(missing, monkeypatch):
    asked = []
    shell = types.SimpleNamespace(run_line_magic=lambda *words: asked.append(words))
    monkeypatch.setattr("builtins.get_ipython", lambda: shell, raising=False)
    missing(with_piplite=False)
    run_cell(colab.install_source(ADDRESS))
    assert asked == [("pip", f"install -q git+{ADDRESS}")]


def test_without_an_address_colab_is_told_what_to_run(missing):
    missing(with_piplite=False)
    with pytest.raises(ModuleNotFoundError, match="%pip install git"):
        run_cell(colab.install_source(None))
