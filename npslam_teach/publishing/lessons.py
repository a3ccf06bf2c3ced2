"""The lessons as files: which there are, what they are called, and which pictures they show."""

import re
from pathlib import Path

import nbformat

FIRST = "00_start_here.ipynb"
DRAWN = "draw_your_own_world.ipynb"  # comes after the numbered ones
_NUMBERED = "[0-9][0-9]_*.ipynb"
_PICTURE = re.compile(r"!\[[^\]]*\]\(([^)\s]+)\)")
_ADDRESS = re.compile(r"[a-z][a-z0-9+.-]*:", re.IGNORECASE)


def lesson_paths(folder: Path) -> list[Path]:
    """The lessons in their order.

    Args:
        folder: the course's ``notebooks``.

    Raises:
        FileNotFoundError: there is none.
    """
    paths = sorted(folder.glob(_NUMBERED))
    if not paths:
        raise FileNotFoundError(f"{folder}: expected lessons such as {FIRST}, found none")
    return paths + [path for path in [folder / DRAWN] if path.exists()]


def number(path: Path) -> str:
    """The short name of a lesson: "04", or "draw" for the one without a number."""
    return path.stem.split("_")[0]


def navigation(name: str, names: list[str]) -> str:
    """The links of a lesson to the one before, to the map of the course and to the one after, in Markdown.

    Args:
        name: of the lesson's file.
        names: of all of them, in their order.
    """
    at = names.index(name)
    links = [f"[← {_words(each)}]({each})" for each in names[max(at - 1, 0) : at]]
    links += [f"[all lessons]({FIRST})"] if name != FIRST else []
    links += [f"[{_words(each)} →]({each})" for each in names[at + 1 : at + 2]]
    return " · ".join(links)


def _words(name: str) -> str:
    return Path(name).stem.replace("_", " ")


def read(path: Path) -> nbformat.NotebookNode:
    """One notebook.

    Raises:
        ValueError: the file is not a notebook.
    """
    try:
        return nbformat.read(path, as_version=4)
    except (nbformat.reader.NotJSONError, nbformat.ValidationError, UnicodeDecodeError):
        raise ValueError(f"{path}: expected a notebook, got something else") from None


def title(notebook: nbformat.NotebookNode) -> str:
    """The question that a lesson asks in its first line."""
    return notebook.cells[0].source.splitlines()[0].removeprefix("#").strip()


def picture_files(path: Path) -> list[Path]:
    """The files that a lesson shows as pictures, each once.

    Raises:
        FileNotFoundError: one of them is missing.
    """
    text = "\n".join(cell.source for cell in read(path).cells if cell.cell_type == "markdown")
    names = [name for name in dict.fromkeys(_PICTURE.findall(text)) if not _ADDRESS.match(name)]
    files = [(path.parent / name).resolve() for name in names]
    for name, file in zip(names, files, strict=True):
        if not file.is_file():
            raise FileNotFoundError(f"{path}: expected the picture {name}, found none")
    return files
