"""How a lesson begins: a badge that opens it in Colab, and a cell that installs the course where it is missing.

Of a lesson that opens with a picture, the cell makes that, too, so that nothing stands between title and picture.

Both depend on where the course is published, which is written in one place: ``Repository`` under ``[project.urls]`` in
``pyproject.toml``. A copy that is not published has no such line; its badges open the page on which Colab asks for a
repository, and its cell says what is missing.
"""

import re
import tomllib
from pathlib import Path

import nbformat

from npslam_teach.publishing import lessons
from npslam_teach.system.files import atomic_write

TAG = "install"
BRANCH = "main"
_COLAB = "https://colab.research.google.com/github"
_ALT = "Open this lesson in Google Colab"
_PICTURE = "open_in_colab.svg"
_BADGE = re.compile(rf"\n\[!\[{_ALT}\]\([^)]*\)\]\([^)]*\)\n")
_REPOSITORY = re.compile(r"https://github\.com/[A-Za-z0-9-]+/[A-Za-z0-9._-]+")
# JupyterLite installs from its own site with piplite; everything else from the repository with pip.
_INSTALL = """\
import importlib.util

if importlib.util.find_spec("npslam_teach") is None:  # so it is in a browser and in Colab
    if importlib.util.find_spec("piplite"):
        await importlib.import_module("piplite").install("npslam_teach")
    else:
        {elsewhere}"""
_INSTALLS = re.compile(r"import importlib\.util\n\nif [^\n]*\n(?: {4}[^\n]*\n?)*\n*")
_GET = 'get_ipython().run_line_magic("pip", "install -q git+{repository}")'
_SAY = 'raise ModuleNotFoundError("run %pip install git+ADDRESS, the course\'s own, in a cell above")'


def repository(pyproject: Path) -> str | None:
    """Where the course is published, None if nowhere.

    Args:
        pyproject: the file ``pyproject.toml``.

    Raises:
        ValueError: the address is not that of a repository on GitHub, which is where Colab looks.
    """
    project = tomllib.loads(pyproject.read_text(encoding="utf-8"))["project"]
    address = project.get("urls", {}).get("Repository")
    if address is not None and not _REPOSITORY.fullmatch(address):
        expected = "https://github.com/OWNER/NAME"
        raise ValueError(f"{pyproject}: Repository: expected {expected}, got {address!r}")
    return address


def without_badge(text: str) -> str:
    """The Markdown of a lesson's first cell without its badge, which would open the lesson instead of a copy of it."""
    return _BADGE.sub("\n", text)


def badge(name: str, address: str | None) -> str:
    """The badge of a lesson in Markdown.

    Args:
        name: of the lesson's file.
        address: as from ``repository``.
    """
    target = f"{_COLAB}/"
    if address is not None:
        target += f"{address.removeprefix('https://github.com/')}/blob/{BRANCH}/notebooks/{name}"
    return f"[![{_ALT}]({_PICTURE})]({target})"


def install_source(address: str | None) -> str:
    """The cell that installs the course where it is missing, and does nothing where it is not.

    Args:
        address: as from ``repository``.
    """
    return _INSTALL.format(elsewhere=_SAY if address is None else _GET.format(repository=address))


def own_source(source: str) -> str:
    """What a lesson's first code cell does beside the installation: nothing, or the picture that it opens with."""
    return _INSTALLS.sub("", source, count=1)


def with_beginning(notebook: nbformat.NotebookNode, name: str, address: str | None) -> nbformat.NotebookNode:
    """The lesson with its badge and its first code cell as they should be; the rest is untouched.

    Args:
        notebook: the lesson.
        name: of its file.
        address: as from ``repository``.
    """
    first = notebook.cells[0]
    heading, rest = _BADGE.sub("", first.source, count=1).split("\n", 1)
    first.source = f"{heading}\n\n{badge(name, address)}\n{rest}"
    for cell in notebook.cells:
        if TAG in cell.metadata.get("tags", []):
            own = own_source(cell.source)
            cell.source = install_source(address) + (f"\n\n{own}" if own else "")
            cell.metadata["jupyter"] = {"source_hidden": True}  # JupyterLab folds it
            if own:
                cell.metadata["cellView"] = "form"  # and so does Colab, where the picture must come first as well
    return notebook


def write_badges(root: Path) -> list[Path]:
    """Bring the beginning of every lesson up to date with ``pyproject.toml``.

    Args:
        root: the course's folder.

    Returns:
        the lessons that changed.
    """
    address, changed = repository(root / "pyproject.toml"), []
    for path in lessons.lesson_paths(root / "notebooks"):
        before = path.read_text(encoding="utf-8")
        after = nbformat.writes(with_beginning(lessons.read(path), path.name, address)) + "\n"
        if after != before:
            with atomic_write(path) as stream:
                stream.write(after)
            changed.append(path)
    return changed
