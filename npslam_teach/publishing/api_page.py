"""The library on one page: every public name with its signature and its docstring, to look up offline and to print."""

import html
import importlib
import inspect
import re
from pathlib import Path
from types import ModuleType

from npslam_teach import __version__
from npslam_teach.publishing import book_page
from npslam_teach.publishing.book_markdown import Chapter

PARTS = "types se2 camera pose_graph association methods evaluation simulate datasets experiments plotting".split()
TITLE = "The library npslam_teach"
_INTRODUCTION = f"""\
<p>Every public name of version {__version__}, as its docstring has it: shapes, units, frames, errors and sources. For
the ideas behind them read the lessons; <code>help(name)</code> in a notebook shows the same.</p>"""
_CODE = re.compile(r"``(.+?)``", re.DOTALL)


def api_html() -> str:
    """All public names of the library as one page of HTML."""
    return book_page.page([_chapter(name) for name in PARTS], TITLE, _INTRODUCTION)


def public_names(module: ModuleType) -> list[str]:
    """What a folder or a module offers: what it lists, or the functions and classes that are defined in it."""
    if hasattr(module, "__all__"):
        return sorted(module.__all__, key=str.casefold)
    own = [name for name, value in vars(module).items() if getattr(value, "__module__", None) == module.__name__]
    return [name for name in own if not name.startswith("_")]


def _chapter(name: str) -> tuple[Chapter, str]:
    module = importlib.import_module(f"npslam_teach.{name}")
    chapter = Chapter("", Path())
    parts = [_heading(chapter, 1, name, name), _words(inspect.getdoc(module))]
    for public in public_names(module):
        parts += [_heading(chapter, 2, f"{name}.{public}", public), _entry(public, getattr(module, public))]
    return chapter, "\n".join(parts)


def _heading(chapter: Chapter, level: int, anchor: str, text: str) -> str:
    chapter.headings.append((level, f"api-{anchor}", f"<code>{html.escape(text)}</code>"))
    return f'<h{level + 1} id="api-{anchor}"><code>{html.escape(text)}</code></h{level + 1}>'


def _entry(name: str, value: object) -> str:
    """One function, class or constant."""
    if not callable(value):
        return f"<p>A constant: <code>{html.escape(repr(value))}</code></p>"
    parts = [_signature(name, value), _words(inspect.getdoc(value))]
    if inspect.isclass(value):
        parts.append(_fields(value))
        for method, member in vars(value).items():
            plain = member.__func__ if isinstance(member, classmethod | staticmethod) else member
            function = plain.fget if isinstance(plain, property) else plain
            if not method.startswith("_") and inspect.isfunction(function) and function.__doc__:
                head = f"<p><code>.{method}</code></p>" if isinstance(plain, property) else _signature(method, function)
                parts.append(f"<blockquote>{head}{_words(inspect.getdoc(function))}</blockquote>")
    return "\n".join(parts)


def _signature(name: str, value: object) -> str:
    """With the names and defaults of its arguments; types are in the words below."""
    shown = inspect.signature(value)
    bare = [each.replace(annotation=inspect.Parameter.empty) for each in shown.parameters.values()]
    text = f"{name}{shown.replace(parameters=bare, return_annotation=inspect.Signature.empty)}"
    return f'<div class="highlight"><pre>{html.escape(text)}</pre></div>'


def _fields(record: type) -> str:
    """The fields of a record with their comments, which say shapes and units, as the source has them."""
    own = inspect.get_annotations(record)
    lines = [line[4:] for line in inspect.getsource(record).splitlines() if line.startswith("    ")]
    found = [line for line in lines if line.split(":")[0] in own]
    return f"<pre>{html.escape(chr(10).join(found))}</pre>" if found else ""


def _words(docstring: str | None) -> str:
    """A docstring: its paragraphs as text, what is indented as it stands."""
    parts = []
    for paragraph in (docstring or "").split("\n\n"):
        text = _CODE.sub(r"<code>\1</code>", html.escape(paragraph))
        indented = any(line.startswith("  ") for line in paragraph.splitlines())
        parts.append(f"<pre>{text}</pre>" if indented else f"<p>{text}</p>")
    return "\n".join(parts)
