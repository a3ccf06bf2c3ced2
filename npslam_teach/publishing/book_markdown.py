"""The lessons' Markdown as HTML that needs no network: formulas as MathML, pictures inside, links within the book."""

import base64
import re
from dataclasses import dataclass, field
from pathlib import Path

from latex2mathml.converter import convert
from nbconvert.filters.markdown_mistune import IPythonRenderer, MarkdownWithMath

from npslam_teach.system.files import read_bytes

_LESSON = re.compile(r"(?:\./)?((\d\d|draw)_\w+\.ipynb)(?:#.*)?")
# Not from the operating system's table, which differs from machine to machine.
_KINDS = {".png": "image/png", ".svg": "image/svg+xml", ".gif": "image/gif", ".jpg": "image/jpeg"}


@dataclass
class Chapter:
    """One lesson that is being rendered for the book; rendering adds its headings.

    Attributes:
        number: of the lesson, as from ``lessons.number``.
        folder: against which the names of pictures are resolved.
        headings: level in the lesson (1 is its title), anchor, and HTML of each heading so far.
    """

    number: str
    folder: Path
    headings: list[tuple[int, str, str]] = field(default_factory=list)


def anchor(number: str) -> str:
    """Where a lesson begins in the book."""
    return f"lesson-{number}"


def render(source: str, chapter: Chapter) -> str:
    """One Markdown cell as HTML.

    Args:
        source: the Markdown.
        chapter: the lesson that the cell is part of.

    Raises:
        ValueError: a formula cannot be set.
    """
    return MarkdownWithMath(renderer=_Renderer(chapter)).render(source)


def mathml(formula: str, display: str) -> str:
    """A formula in LaTeX as MathML, which browsers set by themselves.

    Args:
        formula: without dollars.
        display: "inline" or "block".

    Raises:
        ValueError: it has a command that the converter does not know, or is incomplete.
    """
    try:
        markup = convert(formula, display=display)
    except Exception as error:  # the library raises classes of its own, one for each kind of mistake
        raise ValueError(f"formula {formula!r}: expected LaTeX, got {type(error).__name__}") from None
    if "\\" in markup:
        raise ValueError(f"formula {formula!r}: expected commands that can be set without LaTeX, got another")
    return markup


def picture_data(path: Path) -> str:
    """A picture as an address that holds all of it.

    Raises:
        FileNotFoundError: there is no such file.
        ValueError: it is of a kind that browsers do not show.
    """
    if path.suffix not in _KINDS:
        raise ValueError(f"{path}: expected a picture ({', '.join(_KINDS)}), got {path.suffix or 'no suffix'}")
    return f"data:{_KINDS[path.suffix]};base64,{base64.b64encode(read_bytes(path)).decode('ascii')}"


class _Renderer(IPythonRenderer):
    """nbconvert's renderer, changed for lessons that share one page."""

    def __init__(self, chapter: Chapter):
        super().__init__(escape=False)
        self._chapter = chapter

    def heading(self, text: str, level: int, **attrs) -> str:
        """A heading one level down, since the book has a title above those of the lessons."""
        chapter = self._chapter
        name = anchor(chapter.number)
        if level > 1 or chapter.headings:
            name += f"-{len(chapter.headings)}"
        chapter.headings.append((level, name, text))
        return f'<h{level + 1} id="{name}">{text}</h{level + 1}>\n'

    def link(self, text: str, url: str, title: str | None = None) -> str:
        """A link to another lesson stays within the book; the solutions are no part of it."""
        if url.startswith("solutions/"):
            return text
        match = _LESSON.fullmatch(url)
        return super().link(text, f"#{anchor(match.group(2))}" if match else url, title)

    def image(self, text: str, url: str, title: str | None = None) -> str:
        """A picture of the course, and its alternative text; nbconvert itself embeds none from another folder."""
        return super().image(text, picture_data(self._chapter.folder / url), title)

    def block_math(self, body: str) -> str:
        """A formula on a line of its own."""
        # A long formula scrolls, so it must be reachable by the keyboard.
        return f'<div class="formula" tabindex="0">{mathml(body, "block")}</div>\n'

    def inline_math(self, body: str) -> str:
        """A formula in a sentence."""
        return mathml(body, "inline")

    def latex_environment(self, name: str, body: str) -> str:
        """A formula that begins with its environment."""
        return self.block_math(f"\\begin{{{name}}}{body}\\end{{{name}}}")
