"""Never five cells without a picture: what is read, counted in every lesson as it is committed.

A picture is one in the text, one in an output, an explorer, or an area to draw in. Cells that a reader fills in or runs
without reading (exercises, their checks, the installation, the authors' data) are not counted.
"""

import re
from pathlib import Path

import nbformat
import pytest

LESSONS = sorted((Path(__file__).parents[2] / "notebooks").glob("*.ipynb"))
MOST = 4
BADGE = re.compile(r"\[!\[[^\]]*\]\([^)]*\)\]\([^)]*\)")
DRAWING_AREA = 'data-kind="sketch"'


@pytest.fixture(params=LESSONS, ids=lambda path: path.stem)
def path(request):
    return request.param


def has_picture(cell) -> bool:
    if cell.cell_type == "markdown":
        return "![" in BADGE.sub("", cell.source)
    pages = [output.get("data", {}).get("text/html", "") for output in cell.outputs]
    return any("<img" in page or DRAWING_AREA in page for page in pages)


def longest_stretch(cells) -> list[str]:
    """The ids of the longest run of cells without a picture."""
    longest, run = [], []
    for cell in cells:
        if has_picture(cell):
            run = []
        elif not cell.metadata.get("tags"):
            run = [*run, cell.id]
        longest = max(longest, run, key=len)
    return longest


def test_never_five_cells_without_a_picture(notebook):
    stretch = longest_stretch(notebook.cells)
    assert len(stretch) <= MOST, stretch


def test_a_stretch_of_five_is_noticed_and_a_badge_is_no_picture():
    text = [nbformat.v4.new_markdown_cell("words [![badge](open.svg)](https://example.org)") for _ in range(5)]
    assert len(longest_stretch(text)) == 5
    text[2].source += " ![a picture](one.png)"
    assert len(longest_stretch(text)) == 2


def test_no_lesson_begins_with_a_table(notebook):
    """A table of symbols before the second picture is folded."""
    seen = 0
    for cell in notebook.cells:
        text = re.sub(r"<details>.*?</details>", "", cell.source, flags=re.DOTALL)
        if cell.cell_type == "markdown":
            assert not re.search(r"^\|", text, re.MULTILINE), cell.id
        seen += has_picture(cell)
        if seen == 2:
            return
