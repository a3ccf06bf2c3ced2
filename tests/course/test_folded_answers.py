"""No answer stands below its question in plain sight: what the text says about a result is folded as the result is."""

import re
from pathlib import Path

import pytest

LESSONS = sorted((Path(__file__).parents[2] / "notebooks").glob("*.ipynb"))
ASKS = re.compile(r'\bpredict\(\s*"(\w+)"')
FOLDED = re.compile(r"<details><summary>What it shows</summary>\n\n.{20,}?\n\n</details>", re.DOTALL)
# What may stand open after a question: a heading, the next question, an exercise.
GOES_ON = re.compile(r"#|\*\*Predict|\*\*Exercise|Now it is your")
# Text that leads on and says nothing of the result above.
LEADS_ON = {
    "00_start_here": {"The library's version does this"},
    "01_why_association": {"ARI, the **adjusted Rand index**, says"},
    "03_pose_graph": {"The authors use **iSAM**"},
    "12_a_real_robot": {"A line of `Measurement` is time, barcode"},
    "draw_your_own_world": {"Whatever you draw is a run like any other"},
}


@pytest.fixture(params=LESSONS, ids=lambda path: path.stem)
def path(request):
    return request.param


def following(cells, start: int):
    """The next cell of text after a cell of code."""
    return next((cell for cell in cells[start + 1 :] if cell.cell_type == "markdown"), None)


def test_the_text_after_a_question_is_folded(path, notebook):
    cells, seen = notebook.cells, 0
    for k, cell in enumerate(cells):
        if cell.cell_type == "code" and ASKS.search(cell.source):
            text = following(cells, k)
            if text is None or GOES_ON.match(text.source) or text.source.startswith(tuple(LEADS_ON.get(path.stem, ()))):
                continue
            assert FOLDED.match(text.source), text.source[:80]
            seen += 1
    assert seen >= 3


def test_what_leads_on_is_still_there(path, notebook):
    """An exception that no longer has its text would hide the next answer."""
    starts = [cell.source for cell in notebook.cells if cell.cell_type == "markdown"]
    for words in LEADS_ON.get(path.stem, ()):
        assert [start for start in starts if start.startswith(words)]


def test_results_between_a_question_and_its_explanation_are_folded_too(path, notebook):
    """No picture of a result stands open between a question and the text that explains it, but for explorers."""
    cells = notebook.cells
    for k, cell in enumerate(cells):
        if cell.cell_type != "code" or not ASKS.search(cell.source):
            continue
        for between in cells[k + 1 :]:
            if between.cell_type == "markdown" or set(between.metadata.get("tags", [])):
                break
            for output in between.get("outputs", []):
                data = output.get("data", {})
                is_explorer = data.get("text/plain", "").startswith("Explorer: ")
                assert is_explorer or "<img" not in data.get("text/html", "").split("<details>")[0], between.id


def test_every_fold_is_one_that_a_question_opens(notebook):
    """``predict.js`` finds an explanation by its summary, after a question and before the next."""
    asked = False
    for cell in notebook.cells:
        if cell.cell_type == "code":
            asked = asked or bool(ASKS.search(cell.source))
        elif "<summary>What it shows" in cell.source:
            assert asked and len(FOLDED.findall(cell.source)) == cell.source.count("What it shows</summary>") == 1
