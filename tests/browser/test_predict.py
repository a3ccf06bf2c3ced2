"""Questions with folded results in a real JupyterLab: as a lesson is opened, and after it has run."""

import shutil

import pytest
from axe import violations
from lab_server import LARGE_WINDOW, ROOT, new_context, open_notebook, run_all_cells

LESSON = "02_drift.ipynb"
RUN, KEY = "00_start_here.ipynb", "npslam/00/predict/cliff"


@pytest.fixture(scope="module")
def page(chromium, lab):
    """The lesson, with the outputs that are committed."""
    shutil.copy(ROOT / "notebooks" / LESSON, lab.folder / "notebooks" / LESSON)
    opened = new_context(chromium, viewport=LARGE_WINDOW).new_page()
    open_notebook(opened, lab, LESSON, "predict")
    yield opened
    opened.close()


@pytest.fixture(scope="module")
def run(chromium, lab):
    """Another lesson, run from top to bottom."""
    opened = new_context(chromium, viewport=LARGE_WINDOW).new_page()
    open_notebook(opened, lab, RUN, "run")
    run_all_cells(opened)
    yield opened
    opened.close()


def test_before_anything_runs_results_are_folded_and_no_news_pops_up(page):
    box = page.locator(".jp-OutputArea details").first
    box.wait_for()
    assert box.get_attribute("open") is None
    box.locator("summary").click()
    assert box.locator("pre, p").first.is_visible()
    assert not page.get_by_text("Would you like to get notified").count()


def test_solutions_do_not_stand_above_the_lessons(page):
    page.keyboard.press("Control+b")
    listing = page.locator(".jp-DirListing-content")
    listing.get_by_text(LESSON).wait_for()
    assert not listing.get_by_text("solutions", exact=True).count()
    page.keyboard.press("Control+b")


def test_an_answer_by_keys_unfolds_the_result_and_is_kept_in_the_browser(run):
    page = run
    box = page.locator(".np-predict", has_text="What happens at")
    box.get_by_role("button", name="This is my prediction").wait_for()
    cells = page.locator(".jp-Notebook .jp-Cell").count()
    box.get_by_role("radio").first.check()
    page.keyboard.press("ArrowDown")
    page.keyboard.press("ArrowDown")
    page.keyboard.press("Tab")
    page.keyboard.press("Enter")
    assert box.locator("details").get_attribute("open") is not None
    assert "and so it is" in box.inner_text()
    assert page.evaluate(f"localStorage.getItem('{KEY}')") == "2"
    assert page.locator(".jp-Notebook .jp-Cell").count() == cells, "no key was a command of the notebook"


@pytest.mark.parametrize("theme", ["JupyterLab Light", "JupyterLab Dark"])
def test_nothing_in_a_question_keeps_anybody_out(run, theme):
    page = run
    page.evaluate("light => document.body.dataset.jpThemeLight = light", str(theme.endswith("Light")).lower())
    assert violations(page, ".np-predict") == []


def test_the_question_can_be_asked_again(run):
    page = run
    box = page.locator(".np-predict", has_text="What happens at")
    box.get_by_role("button", name="Ask me again").click()
    assert page.evaluate(f"localStorage.getItem('{KEY}')") is None
    assert box.locator("details").get_attribute("open") is None
