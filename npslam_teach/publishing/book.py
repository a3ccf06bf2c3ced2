"""The course book: all lessons in one HTML file that needs nothing else, or that file printed to PDF."""

import os
import re
import shutil
import subprocess
import tempfile
from collections.abc import Callable
from pathlib import Path

import nbformat

from npslam_teach.publishing import book_page, lessons
from npslam_teach.publishing.book_markdown import Chapter, render
from npslam_teach.publishing.colab import TAG as INSTALL
from npslam_teach.publishing.colab import own_source
from npslam_teach.system.files import atomic_write

_WIDGET = "application/vnd.jupyter.widget-view+json"
_SLIDERS = '<p class="sliders">Here the notebook has sliders. Below, they are moved.</p>'
# Of a question what a reader with a pencil does not need: its scripts and styles, and where an answer would be entered.
_QUESTION, _PICTURE = '<div class="np-box np-predict"', '<img class="np-figure"'
_FORM = re.compile(r'<(script|style|svg)\b.*?</\1>|<input\b[^>]*>|<span class="np-progress".*?</span>', re.DOTALL)
_NUMBER = re.compile(r"<label>Your number: .*?</label> ", re.DOTALL)
_BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome", "msedge")
_INSTALLED = (
    "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome",
    "/Applications/Microsoft Edge.app/Contents/MacOS/Microsoft Edge",
    "C:/Program Files/Google/Chrome/Application/chrome.exe",
    "C:/Program Files (x86)/Microsoft/Edge/Application/msedge.exe",
)


def write_book(make: Callable[[], str], out: Path, browser: str | None = None) -> None:
    """Write a book, as HTML or as PDF by the ending of the name.

    Args:
        make: its page of HTML, ``book_html`` of a folder or ``api_page.api_html``; called when the name is right.
        out: the file to write, which ends in .html or .pdf.
        browser: the program that prints a PDF; by default the first Chromium, Chrome or Edge that is found.

    Raises:
        FileNotFoundError: there is no such folder to write into, or no browser.
        ValueError: the name ends otherwise, or the browser printed nothing.
    """
    if out.suffix.lower() not in (".html", ".pdf"):
        raise ValueError(f"--out {out}: expected a name that ends in .html or .pdf, got {out.suffix!r}")
    if not out.absolute().parent.is_dir():
        raise FileNotFoundError(f"--out {out}: expected a folder to write into, found none")
    if out.suffix.lower() == ".html":
        with atomic_write(out) as stream:
            stream.write(make())
        return
    printer = find_browser(browser)
    content = print_to_pdf(unfolded(make()), printer)
    with atomic_write(out, "wb") as stream:
        stream.write(content)


def book_html(folder: Path) -> str:
    """All lessons of a folder as one page of HTML."""
    return book_page.page([_chapter(path) for path in lessons.lesson_paths(folder)])


def _chapter(path: Path) -> tuple[Chapter, str]:
    from nbconvert import HTMLExporter

    chapter = Chapter(lessons.number(path), path.parent)
    exporter = HTMLExporter(template_name="basic", exclude_input_prompt=True, exclude_output_prompt=True)
    exporter.register_filter("markdown2html", lambda source: render(source, chapter))
    notebook = for_paper(lessons.read(path))
    for cell in notebook.cells:
        # Ids of cells become anchors of the one page, and recur from lesson to lesson.
        cell.id = f"{chapter.number}-{cell.id}"
    body, _ = exporter.from_notebook_node(notebook)
    return chapter, body


def for_paper(notebook: nbformat.NotebookNode) -> nbformat.NotebookNode:
    """The lesson without what only a running notebook has: its first cell's installation, widgets and forms.

    Args:
        notebook: the lesson, which is changed.
    """
    for cell in notebook.cells:
        if INSTALL in cell.metadata.get("tags", []):
            cell.source = own_source(cell.source)
    notebook.cells = [cell for cell in notebook.cells if cell.source]
    for cell in notebook.cells:
        for output in cell.get("outputs", []):
            if _WIDGET in output.get("data", {}):
                output.data = {"text/html": _SLIDERS}
            elif output.get("data", {}).get("text/html", "").startswith((_QUESTION, _PICTURE)):
                output.data["text/html"] = _NUMBER.sub("", _FORM.sub("", output.data["text/html"]))
    return notebook


def unfolded(page: str) -> str:
    """The page with every result and every hint in sight: paper cannot be clicked."""
    return page.replace("<details>", "<details open>")


def find_browser(name: str | None = None) -> str:
    """A browser that prints to PDF.

    Args:
        name: a program or its path; by default those with the usual names in the usual places.

    Raises:
        FileNotFoundError: there is none.
    """
    for each in _BROWSERS + _INSTALLED if name is None else (name,):
        if found := shutil.which(each):
            return found
    remedy = "name one with --browser, or write the book as .html and print that from any browser"
    raise FileNotFoundError(f"{name or 'PDF'}: expected Chromium, Chrome or Edge to print it, found none: {remedy}")


def print_to_pdf(page: str, browser: str) -> bytes:
    """Print a page that needs no network.

    Args:
        page: HTML.
        browser: as from ``find_browser``.

    Raises:
        ValueError: the browser failed.
    """
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as temporary:
        source, target = Path(temporary) / "book.html", Path(temporary) / "book.pdf"
        source.write_text(page, encoding="utf-8")
        options = ["--headless", "--disable-gpu", "--no-first-run", "--disable-background-networking", "--disable-sync"]
        options += [f"--user-data-dir={temporary}/profile", "--no-pdf-header-footer"]
        options += ["--generate-pdf-document-outline", f"--print-to-pdf={target}"]
        if hasattr(os, "geteuid") and os.geteuid() == 0:
            options += ["--no-sandbox"]  # the sandbox does not work for root, the user of most containers
        done = subprocess.run([browser, *options, source.as_uri()], capture_output=True, stdin=subprocess.DEVNULL)
        if done.returncode != 0 or not target.is_file():
            raise ValueError(f"{browser}: expected a PDF, got none (exit code {done.returncode})")
        return target.read_bytes()
