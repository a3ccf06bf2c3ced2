"""Lessons in a real JupyterLab and a real browser, as a student meets them: each as it is committed, some run.

That every lesson runs from top to bottom, and prints what is committed, is compared by nbval; that its explorers follow
the hand is seen in ``test_lesson_explorers`` and ``test_frames``. Screenshots of what cannot be read, or of all where
``NPSLAM_TEACH_SCREENSHOTS`` is set, are left in ``build/screenshots``.
"""

import shutil

import pytest
from explorers import EXPLORER, Shown, explorers_of, lessons_with_explorers
from lab_server import (
    ROOT,
    new_context,
    open_instead,
    open_notebook,
    run_all_cells,
    saved,
    wait_until_idle,
    wait_until_shown,
)
from window import ALL_ARE_KEPT, LAPTOP, NARROW, PROJECTOR, Window

LESSONS = sorted(path.name for path in (ROOT / "notebooks").glob("[0-9]*.ipynb"))
# The first that a student runs, and one whose code moves its explorer. The drawing page runs in ``test_draw_world``.
MOVED = "04_dirichlet_process.ipynb"
RUN = ("00_start_here.ipynb", MOVED)
SHOTS = ROOT / "build" / "screenshots"


@pytest.fixture(scope="module")
def reader(chromium, lab):
    """A page that shows a lesson, and then other lessons in its place."""
    context = new_context(chromium, viewport={"width": LAPTOP, "height": 1000}, reduced_motion="reduce")
    page = context.new_page()
    open_notebook(page, lab, LESSONS[0])
    yield page
    context.close()


@pytest.fixture(scope="module")
def committed(request, reader, lab):
    """(name, page): a lesson that was opened and not run; what is shown is what is committed.

    No cell runs, so that all have the kernel of the notebook that the page was opened with.
    """
    name = f"committed_{request.param}"
    shutil.copy(ROOT / "notebooks" / request.param, lab.folder / "notebooks" / name)
    open_instead(reader, name, shares_kernel=True)
    wait_until_shown(reader, lab, name)
    return name, reader


@pytest.fixture(scope="module")
def lesson(request, reader):
    """(name, page): a lesson that was opened without its outputs and has run."""
    open_instead(reader, request.param)
    wait_until_idle(reader)
    run_all_cells(reader)
    return request.param, reader


every_lesson = pytest.mark.parametrize("committed", LESSONS, indirect=True, scope="module")
some_lessons = pytest.mark.parametrize("lesson", RUN, indirect=True, scope="module")


def complaints(page, name: str, width: int) -> list[str]:
    """What cannot be read at this width, with a screenshot of it."""
    with Window(page, width) as window:
        found = window.complaints()
        if found or ALL_ARE_KEPT:
            window.screenshot(SHOTS / f"{name.split('.')[0]}_{width}.png")
    return found


def alternative_texts(page) -> list[str]:
    return page.locator(".jp-Notebook .jp-Cell img").evaluate_all("images => images.map(each => each.alt)")


@every_lesson
@pytest.mark.parametrize("width", [NARROW, PROJECTOR])
def test_nothing_is_cut_off_when_a_lesson_is_opened(committed, width):
    name, page = committed
    assert complaints(page, name, width) == []


@every_lesson
def test_every_picture_has_an_alternative_text(committed):
    name, page = committed
    alts = alternative_texts(page)
    assert len(alts) >= 2
    assert min(len(alt) for alt in alts) > 20


@pytest.mark.parametrize("committed", LESSONS[:1], indirect=True, scope="module")
def test_the_drive_is_seen_without_scrolling_before_anything_has_run(committed):
    _, page = committed
    title = page.locator(".jp-Notebook .jp-Cell").first.bounding_box()
    drive = page.locator(".jp-Notebook .jp-OutputArea img").first.bounding_box()
    assert drive["height"] > 300 and drive["y"] + drive["height"] - title["y"] < 900


@every_lesson
def test_a_lesson_that_is_opened_and_saved_stays_the_same_to_the_byte(committed, lab):
    """With its kernel running, whose language JupyterLab would write into the file; else ``git pull`` would refuse."""
    name, page = committed
    wait_until_idle(page)
    saved(page, lab, name)
    before = ROOT / "notebooks" / name.removeprefix("committed_")
    assert (lab.folder / "notebooks" / name).read_bytes() == before.read_bytes()


@some_lessons
def test_it_runs_from_top_to_bottom_without_an_error(lesson, lab):
    name, page = lesson
    cells = [cell for cell in saved(page, lab, name).cells if cell.cell_type == "code"]
    assert [cell.execution_count for cell in cells] == list(range(1, len(cells) + 1))
    outputs = [output for cell in cells for output in cell.outputs]
    assert len(outputs) > 5
    assert not [output for output in outputs if output.output_type == "error" or output.get("name") == "stderr"]
    assert not page.locator(".jp-Notebook [data-mime-type='application/vnd.jupyter.stderr']").count()


@some_lessons
def test_what_has_run_can_be_read(lesson):
    name, page = lesson
    assert complaints(page, name, LAPTOP) == []
    assert min(len(alt) for alt in alternative_texts(page)) > 20
    expected = len(explorers_of(name)) if name in lessons_with_explorers() else 0
    assert page.locator(EXPLORER).count() == expected


@some_lessons
def test_printed_lines_break_between_words_and_never_within_a_number(lesson):
    _, page = lesson
    printed = page.locator(".jp-OutputArea-output.jp-RenderedText pre")
    breaks = printed.evaluate_all("all => all.map((each) => getComputedStyle(each).wordBreak)")
    assert breaks and set(breaks) == {"normal"}


@pytest.mark.parametrize("lesson", [MOVED], indirect=True, scope="module")
def test_run_all_shows_what_the_lesson_sets(lesson, lab):
    """The last of the lesson's own moves is what slider, field, words and bars show."""
    name, page = lesson
    cells = saved(page, lab, name).cells
    printed = next(cell for cell in cells if "explorer.move(" in cell.source).outputs[0].text.splitlines()[-1]
    shown = Shown(page, 0, explorers_of(name)[0])
    page.wait_for_timeout(1500)  # an echo that comes late would come now
    assert shown.picture()["words"] == printed
    fields = {each.name: each.readout.input_value() for each in shown.controls if not each.is_list}
    assert fields == {"alpha": "0.90", "threshold": "0.30", "kernel_std": "0.3536"}
    assert shown.picture() == shown.expected()
    assert shown.root.locator("svg, img").count() == 1, "one picture, not a second one below"
