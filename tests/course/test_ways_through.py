"""The ways from lesson to lesson, what is folded away, and lines that break where they may."""

import re
from pathlib import Path

import pytest

from npslam_teach.publishing import lessons

FOLDER = Path(__file__).parents[2] / "notebooks"
LESSONS = lessons.lesson_paths(FOLDER)
NAMES = [path.name for path in LESSONS]
NO_PROSE = re.compile(r"^```.*?^```|`[^`\n]*`|\$\$.*?\$\$|\$[^$\n]*\$|(?<=\])\([^)]*\)", re.MULTILINE | re.DOTALL)
UNITS = "m|cm|mm|km|s|rad|kB|MB|degrees|metres|minutes|seconds"
# A plain space that could part a number from its unit.
PARTED = re.compile(rf"\d (?:(?:{UNITS})\b|%|m²)")


@pytest.fixture(params=LESSONS, ids=lambda path: path.stem)
def path(request):
    return request.param


def test_a_lesson_leads_back_and_on_at_its_top_and_at_its_bottom(path, notebook):
    links = lessons.navigation(path.name, NAMES)
    first, last = notebook.cells[0].source.splitlines(), notebook.cells[-1].source.splitlines()
    assert links in first[:6] and links == last[-1]


def test_all_lessons_are_reached_one_after_the_other():
    on = [re.findall(r"\[[^\]]* →\]\(([^)]*)\)", lessons.navigation(name, NAMES)) for name in NAMES]
    back = [re.findall(r"\[← [^\]]*\]\(([^)]*)\)", lessons.navigation(name, NAMES)) for name in NAMES]
    assert on == [[name] for name in NAMES[1:]] + [[]]
    assert back == [[]] + [[name] for name in NAMES[:-1]]


def test_what_installs_the_course_is_folded(notebook):
    """JupyterLab shows three dots in its place."""
    cells = [cell for cell in notebook.cells if "install" in cell.metadata.get("tags", [])]
    assert [cell.metadata.get("jupyter") for cell in cells] == [{"source_hidden": True}]


def test_a_number_keeps_its_unit(notebook):
    """A line may break at a space, so there is one that does not break between a number and what it counts."""
    parted = []
    for cell in notebook.cells:
        if cell.cell_type == "markdown":
            parted += PARTED.findall(NO_PROSE.sub("", cell.source))
    assert not parted


def test_questions_keep_them_too(notebook):
    for cell in notebook.cells:
        for output in cell.get("outputs", []):
            page = output.get("data", {}).get("text/html", "")
            for words in re.findall(r"<(?:legend|label|em|strong)>([^<]*)", page):
                assert not PARTED.search(words), words


def test_a_space_that_parts_is_noticed():
    assert PARTED.search("off by 0.5 m") and PARTED.search("in 95 % of") and PARTED.search("100 m² of")
    assert not PARTED.search("off by 0.5\u00a0m") and not PARTED.search("15 more") and not PARTED.search("3 sightings")
