"""What nbval does not test: lessons are executed, readable, as short as they should be, and run on real data.

nbval compares the committed outputs, but it accepts a stripped notebook and a changed picture.
"""

import ast
import re
from pathlib import Path

import nbformat
import pytest
from execute_notebooks import execute, tidy
from slices import needed_statements

ROOT = Path(__file__).parents[2]
NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.ipynb"))
SOLUTIONS = sorted((ROOT / "notebooks" / "solutions").glob("*.ipynb"))
IMAGE = re.compile(r"!\[([^\]]*)\]\(([^)]+)\)")
LINK = re.compile(r"(?<!!)\[[^\]]+\]\(([^)]+)\)")


@pytest.fixture(params=NOTEBOOKS, ids=lambda path: path.stem)
def path(request):
    return request.param


@pytest.fixture(params=NOTEBOOKS + SOLUTIONS, ids=lambda path: path.stem)
def any_path(request):
    return request.param


@pytest.fixture
def any_notebook(any_path):
    return nbformat.read(any_path, as_version=4)


def code_cells(notebook):
    return [cell for cell in notebook.cells if cell.cell_type == "code"]


def text_cells(notebook):
    return [cell for cell in notebook.cells if cell.cell_type == "markdown"]


def test_there_are_lessons():
    assert {path.stem for path in NOTEBOOKS} >= {"00_start_here", "07_fifteen_objects"}


def test_every_code_cell_was_executed_once_from_top_to_bottom(any_notebook):
    counts = [cell.execution_count for cell in code_cells(any_notebook)]
    assert counts == list(range(1, len(counts) + 1))


def test_no_output_is_an_error_or_a_warning(any_notebook):
    for cell in code_cells(any_notebook):
        for output in cell.outputs:
            assert output.output_type != "error"
            assert output.get("name") != "stderr"


def test_the_committed_file_is_tidy(any_path, any_notebook):
    """No widget state, time stamps or editor's metadata: they change from run to run."""
    nbformat.validate(any_notebook)
    tidied = tidy(nbformat.read(any_path, as_version=4))
    assert any_notebook == tidied


def opening(notebook) -> str:
    """What is read before the first section."""
    return "\n".join(cell.source for cell in text_cells(notebook)).split("\n## ")[0]


def test_the_opening_asks_and_promises(notebook):
    first = opening(notebook)
    assert re.match(r"# .+\?\n", notebook.cells[0].source), "the title asks a question"
    assert IMAGE.search(first), "one picture"
    for promise in ("What you'll do:", "What you'll learn:", "What you need:", "Time:"):
        assert promise in first


def test_the_course_opens_with_the_drive_itself():
    """Nothing stands between the title and the picture that moves: no text, no code, no cell."""
    title, drive, text = nbformat.read(NOTEBOOKS[0], as_version=4).cells[:3]
    _, badge, links, *more = filter(None, title.source.splitlines())
    assert badge.startswith("[![") and "→](" in links and more == []
    assert drive.metadata["jupyter"] == {"source_hidden": True} and drive.metadata["cellView"] == "form"
    (output,) = drive.outputs
    assert "frozen({" in output.data["text/html"] and output.data["text/plain"].startswith("Explorer: ")
    assert text.cell_type == "markdown"


def test_the_last_cell_sums_up(notebook):
    last = notebook.cells[-1].source
    summary = last.split("## Summary")[1]
    assert len(re.findall(r"^- ", summary, re.MULTILINE)) == 3
    assert "**Assumed here:**" in summary
    assert "**Next question:**" in summary


def test_size(notebook):
    assert 20 <= len(notebook.cells) <= 50
    # The line that asks for a prediction is not part of the idea.
    lengths = [sum("with predict(" not in line for line in cell.source.splitlines()) for cell in code_cells(notebook)]
    assert max(lengths) <= 15
    assert sum(length <= 8 for length in lengths) >= 0.6 * len(lengths)


def test_predictions_are_asked_for(notebook):
    assert sum("**Predict" in cell.source for cell in text_cells(notebook)) >= 3


def test_every_picture_has_a_text_for_those_who_cannot_see_it(notebook):
    pictures = 0
    for cell in notebook.cells:
        for alt, _ in IMAGE.findall(cell.source) if cell.cell_type == "markdown" else []:
            pictures += 1
            assert len(alt) > 20
        for output in cell.get("outputs", []):
            assert not any(kind.startswith("image/") for kind in output.get("data", {})), "show it with plotting.show"
            for tag in re.findall(r"<img [^>]*", output.get("data", {}).get("text/html", "")):
                pictures += 1
                assert len(re.search(r'alt="([^"]*)"', tag).group(1)) > 20
    assert pictures >= 2


def by_tag(notebook, kind):
    """Cells tagged ``kind-1``, ``kind-2``, ... by their number."""
    found = {}
    for cell in code_cells(notebook):
        for tag in cell.metadata.get("tags", []):
            if match := re.fullmatch(rf"{kind}-(\d+)", tag):
                assert int(match.group(1)) not in found, tag
                found[int(match.group(1))] = cell
    return found


def shown(cell):
    return "".join(
        output.get("text", "") + output.get("data", {}).get("text/plain", "") for output in cell.get("outputs", [])
    )


def solutions_of(path):
    file = ROOT / "notebooks" / "solutions" / f"{path.stem[:2]}_solutions.ipynb"
    assert file.exists(), file
    return nbformat.read(file, as_version=4)


HINTS = re.compile(
    r"<details><summary>Hints for exercise (\d)</summary>\n\n(.+?)\n\n"
    r"<details><summary>The solution</summary>\n\n(.+?)\n\n</details>\n</details>",
    re.DOTALL,
)
OTHER_FOLDS = re.compile(r"<summary>(What it shows|Letters that mean something else here)</summary>")
LESSONS_WITHOUT_EXERCISES = {"00_start_here", "draw_your_own_world"}


def test_every_lesson_has_three_to_five_exercises_with_stars(notebook, path):
    exercises = by_tag(notebook, "exercise")
    if path.stem in LESSONS_WITHOUT_EXERCISES:
        assert not exercises
        return
    assert 3 <= len(exercises) <= 5
    assert set(exercises) == set(by_tag(notebook, "check")) == set(range(1, len(exercises) + 1))
    text = "".join(cell.source for cell in text_cells(notebook))
    assert "★" in text


def test_every_exercise_has_hints_and_then_the_solution_folded_where_it_is_stated(notebook, path):
    """A hint is words: nothing of the solution's code stands in it."""
    hints, waiting = {}, {}
    for cell in notebook.cells:
        for number, words, solution in HINTS.findall(cell.source) if cell.cell_type == "markdown" else []:
            hints[int(number)] = waiting[int(number)] = words
            assert f"](solutions/{path.stem[:2]}_solutions.ipynb)" in solution
        for tag in cell.metadata.get("tags", []):
            if tag.startswith("exercise-"):
                waiting.pop(int(tag.removeprefix("exercise-")))  # a KeyError: no hints before this exercise
        folds = 2 * len(HINTS.findall(cell.source)) + len(OTHER_FOLDS.findall(cell.source))
        assert cell.source.count("<details>") == folds == cell.source.count("</details>")
    assert set(hints) == set(by_tag(notebook, "exercise")) and not waiting
    for number, words in hints.items():
        assert re.findall(r"^(\d)\. .{20}", words, re.MULTILINE) == ["1", "2"]
        lines = by_tag(solutions_of(path), "exercise")[number].source.splitlines()
        assert not [line for line in lines if len(line.strip()) > 12 and line.strip() in words]


def test_blanks_are_reported(notebook):
    """The committed lesson is the student's: nothing filled in, and every check says so."""
    for number, cell in by_tag(notebook, "check").items():
        assert shown(cell).startswith("Not yet: "), number
        assert "..." in by_tag(notebook, "exercise")[number].source


def test_solutions_pass_the_same_checks(notebook, path):
    checks = by_tag(notebook, "check")
    if not checks:
        return
    solutions = solutions_of(path)
    solved = by_tag(solutions, "check")
    assert set(solved) == set(checks) == set(by_tag(solutions, "exercise"))
    for number, cell in solved.items():
        assert shown(cell).startswith("Right: "), number
        assert cell.source.splitlines()[-1] == checks[number].source.splitlines()[-1], "the same check"


def test_solutions_live_once(notebook, path):
    """No line of a solution of any substance stands in the lesson's own exercise cell."""
    if not (exercises := by_tag(notebook, "exercise")):
        return
    for number, cell in by_tag(solutions_of(path), "exercise").items():
        blank = set(exercises[number].source.splitlines())
        own = [line for line in cell.source.splitlines() if len(line.strip()) > 12 and line not in blank]
        assert own, f"exercise {number} has nothing left to fill in"


def test_explorers_work_without_a_kernel(notebook):
    """What is committed of an explorer is HTML: a picture, and frames where its values are few enough."""
    for cell in code_cells(notebook):
        for output in cell.outputs:
            data = output.get("data", {})
            if data.get("text/plain", "").startswith("Explorer: "):
                assert "<img alt=" in data["text/html"]
                assert "frozen({" in data["text/html"] or "springs" in cell.source


def test_links_and_pictures_lead_somewhere(notebook, path):
    for cell in text_cells(notebook):
        targets = LINK.findall(cell.source) + [target for _, target in IMAGE.findall(cell.source)]
        for target in targets:
            if not re.match(r"https?://|#", target):
                assert (path.parent / target).exists(), target


def test_plain_words(notebook):
    for cell in text_cells(notebook):
        assert not re.search(r"\b(simply|obviously|trivial(ly)?|of course)\b", cell.source, re.IGNORECASE)


def test_no_cell_switches_backends_or_hides_errors(notebook):
    for cell in code_cells(notebook):
        assert "%" not in [line[:1] for line in cell.source.splitlines()], "magic commands differ between front ends"
        for node in ast.walk(ast.parse(cell.source)):
            assert not isinstance(node, ast.Try)


def test_committed_outputs_do_not_show_the_authors_data(notebook):
    for cell in code_cells(notebook):
        if "authors-data" in cell.metadata.get("tags", []):
            assert cell.outputs == []


# What the tagged cells print when the file is there: the lesson, the file, and patterns of the text.
ON_THE_AUTHORS_DATA = {
    "03_pose_graph": (
        "mu2016_simulation.mat",
        [r"step 0 dropped: chi2 2167\.8 for 2166", r"step 0 kept: chi2 2425\.9 for 2166"],
    ),
    "07_fifteen_objects": (
        "mu2016_simulation.mat",
        ["766 poses, 1098 sightings", r"chi2 per dof 1\.001", r"noise 0\.0: objects \[1098, .*15\]"],
    ),
    "08_office": (
        "mu2016_stata_office.mat",
        ["696 poses, 1591 sightings", r"np-graph +\d+ +1[34]\d\d", r"frame-by-frame +0 +0 +nan m2"],
    ),
}


@pytest.mark.slow
def test_every_lesson_on_the_authors_data(notebook, path, data_folder):
    """Run with the file in place of None, as a reader does who has fetched it.

    All cells from there on run; of the cells before, which nbval runs, only what these depend on.
    """
    tagged = [cell for cell in code_cells(notebook) if "authors-file" in cell.metadata.get("tags", [])]
    assert bool(tagged) == (path.stem in ON_THE_AUTHORS_DATA)
    if not tagged:
        return
    file, patterns = ON_THE_AUTHORS_DATA[path.stem]
    for cell in tagged:
        assert "authors_file = None" in cell.source
        cell.source = cell.source.replace("authors_file = None", f"authors_file = {str(data_folder / file)!r}")
    cells = code_cells(notebook)
    sources = [cell.source if "install" not in cell.metadata.get("tags", []) else "" for cell in cells]
    from_there = set(range(cells.index(tagged[0]), len(cells)))
    for cell, needed in zip(cells, needed_statements(sources, from_there), strict=True):
        cell.source = needed
    done = execute(notebook, path.parent)
    data_cells = [cell for cell in code_cells(done) if "authors-data" in cell.metadata.get("tags", [])]
    assert all(cell.outputs for cell in data_cells), "every tagged cell shows something"
    text = "".join(shown(cell) for cell in data_cells)
    for pattern in patterns:
        assert re.search(pattern, text), pattern


def test_the_map_of_the_course_gives_every_lessons_own_minutes():
    table = "".join(cell.source for cell in text_cells(nbformat.read(NOTEBOOKS[0], as_version=4)))
    for path in NOTEBOOKS[1:]:
        minutes = re.search(r"\*\*Time:\*\* (\d+)\sminutes", opening(nbformat.read(path, as_version=4))).group(1)
        assert re.search(rf"\({path.name}\) \| .* \| {minutes} \|", table), path.stem
