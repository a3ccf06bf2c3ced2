"""Every lesson in a real JupyterLab and a real browser, as a student meets it.

A lesson is opened and run once, and all tests of it look at that page. Screenshots of what cannot be read, or of all
where ``NPSLAM_TEACH_SCREENSHOTS`` is set, are left in ``build/screenshots``, and the times from key press to changed
pixels in ``build/latency.md``; times are reported here and asserted nowhere, because they are those of a machine that
runs other tests too (``python tests/browser/latency.py`` measures alone).
"""

import os

import nbformat
import pytest
from axe import violations
from explorers import EXPLORER, Shown, explorers_of, lessons_with_explorers
from lab_server import ROOT, new_context, open_notebook, run_all_cells, saved
from latency import Row, table
from window import Window

from npslam_teach.system.files import atomic_write

# Those with explorers first, so that a lesson has the same number in both lists of parameters: pytest goes by it when
# it puts the tests of a lesson together, and would otherwise open and run most lessons twice.
WITH_EXPLORERS = lessons_with_explorers()
LESSONS = [
    *WITH_EXPLORERS,
    *sorted({path.name for path in (ROOT / "notebooks").glob("[0-9]*.ipynb")} - set(WITH_EXPLORERS)),
]
BUILD = ROOT / "build"
NARROW, LAPTOP, PROJECTOR = 800, 1400, 1920
MOST_PRESSES = 6  # of a key, in each direction


@pytest.fixture(scope="module")
def window(chromium):
    """What all lessons are opened in, so that JupyterLab itself is fetched and compiled once."""
    context = new_context(chromium, viewport={"width": LAPTOP, "height": 1000}, reduced_motion="reduce")
    yield context
    context.close()


@pytest.fixture(scope="module")
def lesson(request, window, lab):
    """(name, page): a lesson that has run, in a page of its own."""
    page = window.new_page()
    open_notebook(page, lab, request.param)
    run_all_cells(page)
    yield request.param, page
    page.close()


@pytest.fixture(scope="module")
def explorers(lesson):
    """The explorers in the page of a lesson, each with its twin."""
    name, page = lesson
    twins = explorers_of(name)
    assert page.locator(EXPLORER).count() == len(twins) > 0
    return [Shown(page, number, twin) for number, twin in enumerate(twins)]


@pytest.fixture(scope="module")
def latencies():
    """Rows of the table of latencies, written when all lessons are done."""
    rows = []
    yield rows
    BUILD.mkdir(exist_ok=True)
    with atomic_write(BUILD / "latency.md") as stream:
        stream.write(table(rows))


every_lesson = pytest.mark.parametrize("lesson", LESSONS, indirect=True, scope="module")
every_lesson_with_explorers = pytest.mark.parametrize("lesson", WITH_EXPLORERS, indirect=True, scope="module")


@every_lesson
def test_it_runs_from_top_to_bottom_without_an_error(lesson, lab):
    name, page = lesson
    cells = [cell for cell in saved(page, lab, name).cells if cell.cell_type == "code"]
    assert [cell.execution_count for cell in cells] == list(range(1, len(cells) + 1))
    outputs = [output for cell in cells for output in cell.outputs]
    assert len(outputs) > 5
    assert not [output for output in outputs if output.output_type == "error" or output.get("name") == "stderr"]
    assert not page.locator(".jp-Notebook [data-mime-type='application/vnd.jupyter.stderr']").count()


@every_lesson
def test_the_committed_notebook_is_not_touched(lesson, lab):
    name, _ = lesson
    committed = nbformat.read(ROOT / "notebooks" / name, as_version=4)
    run = nbformat.read(lab.folder / "notebooks" / name, as_version=4)
    assert [cell.source for cell in committed.cells] == [cell.source for cell in run.cells]
    assert committed.metadata.keys() == {"kernelspec", "language_info"}


@every_lesson
@pytest.mark.parametrize("width", [LAPTOP, NARROW, PROJECTOR])
def test_nothing_is_cut_off(lesson, width):
    name, page = lesson
    with Window(page, width) as window:
        complaints = window.complaints()
        if complaints or "NPSLAM_TEACH_SCREENSHOTS" in os.environ:
            window.screenshot(BUILD / "screenshots" / f"{name.split('.')[0]}_{width}.png")
        assert complaints == []


@every_lesson
def test_every_picture_has_an_alternative_text(lesson):
    _, page = lesson
    alts = page.locator(".jp-Notebook .jp-Cell img").evaluate_all("images => images.map(each => each.alt)")
    assert len(alts) >= 2
    assert min(len(alt) for alt in alts) > 20


@every_lesson_with_explorers
def test_explorers_follow_the_keys_and_tell_what_the_library_tells(lesson, explorers, latencies):
    name, _ = lesson
    for explorer in explorers:
        for control in explorer.controls:
            shown = explorer.walk(control, MOST_PRESSES)
            assert len({each["words"] for each in shown}) >= 2
            assert len({str(each["source"]) for each in shown}) >= 2
            latencies.append(Row(name, control.twin.description, tuple(explorer.latencies())))


@every_lesson_with_explorers
def test_play_buttons_play_and_pause(explorers):
    for explorer in explorers:
        for button in explorer.root.get_by_role("button", name="play").all():
            position = next(control for control in explorer.controls if not control.is_list)
            if position.index() == len(position.values()) - 1:  # from the end it would play from the beginning
                position.locator.press("Home")
                explorer.wait_for_answer()
            before = position.index()
            button.press("Enter")
            explorer.wait("root.querySelector('input[type=range]').value != known", str(before), "nothing plays")
            explorer.root.get_by_role("button", name="pause").press("Enter")
            explorer.root.get_by_role("button", name="play").wait_for()
            explorer.wait_for_answer()
            assert position.index() > before
            assert explorer.picture() == explorer.expected()


@every_lesson_with_explorers
def test_a_screen_reader_finds_the_name_of_every_control(explorers):
    """In the accessibility tree of the browser, not in our attributes."""
    for explorer in explorers:
        names = explorer.names_in_the_accessibility_tree()
        for control in explorer.controls:
            assert ("combobox" if control.is_list else "slider", control.twin.description) in names
        if explorer.twin.figure is not None:
            assert ("image", explorer.picture()["words"]) in names
        assert not [role for role, name in names if role in ("slider", "combobox", "button", "textbox") and not name]


@every_lesson_with_explorers
def test_controls_are_reached_one_after_the_other_by_tab(lesson, explorers):
    _, page = lesson
    for explorer in explorers:
        handles = [control.locator.element_handle() for control in explorer.controls]
        handles[0].focus()
        for handle in handles[1:]:
            for _ in range(5):  # from a slider to its number and its buttons, from there to the next control
                page.keyboard.press("Tab")
                if handle.evaluate("each => each === document.activeElement"):
                    break
            assert handle.evaluate("each => each === document.activeElement")


@every_lesson_with_explorers
def test_axe_finds_nothing_serious_in_a_running_explorer(lesson, explorers):
    _, page = lesson
    explorers[0].root.scroll_into_view_if_needed()
    assert violations(page, EXPLORER) == []
