"""Questions with folded results in a real JupyterLab: a notebook with one of each kind, opened and then run."""

import json

import nbformat
import pytest
from axe import violations
from lab_server import LARGE_WINDOW, ROOT, new_context, open_notebook, run_all_cells, write_notebook

NAME, LESSON = "questions.ipynb", "00_start_here.ipynb"
QUESTIONS = """
import numpy as np
from npslam_teach.course.predict import choice, number, questions, sketch

predict = questions(
    "99",
    exercises=2,
    pick=choice("Which one?", ["left", "middle", "right"], right=2, mistake="To look away."),
    count=number("How many metres?", mistake="To guess.", unit="m"),
    line=sketch("Where does it go?", mistake="To stop half-way.", box=(0, 0, 4, 2)),
)
with predict("pick"):
    print("it was the right one")
"""
MORE = 'with predict("pick", part=2):\n    print("and more of it")'
EXPLAINED = "<details><summary>What it shows</summary>\n\nRight is where the heart is not.\n\n</details>"
CHECK = """
from npslam_teach.course.checking import right
from npslam_teach.course.verdict_page import exercise

exercise("99", 2, of=2)(lambda answer: right("so it is"))(1)
"""
COUNT = 'with predict("count") as see:\n    print("counted")\n    see.answer(2.5)'
LINE = """
with predict("line") as see:
    see.known(np.array([[0.0, 1.0], [4.0, 1.0]]))
    see.answer([[0.0, 1.0], [4.0, 2.0]])
"""


def hints_of(lesson):
    """The first hints of a lesson, as they stand in it."""
    cells = nbformat.read(ROOT / "notebooks" / lesson, as_version=4).cells
    source = next(cell.source for cell in cells if "<details>" in cell.source)
    return source[source.index("<details>") :]


@pytest.fixture(scope="module")
def page(chromium, lab):
    """The notebook as it is opened: its first cell has the output that a lesson is committed with, the others none."""
    path = lab.folder / "notebooks" / NAME
    write_notebook(path, QUESTIONS, MORE, COUNT, LINE, CHECK)
    notebook = nbformat.read(path, as_version=4)
    committed = nbformat.read(ROOT / "notebooks" / LESSON, as_version=4).cells
    notebook.cells[0].outputs = next(cell.outputs for cell in committed if 'predict("cliff")' in cell.source)
    notebook.cells.insert(2, nbformat.v4.new_markdown_cell(EXPLAINED))
    notebook.cells.append(nbformat.v4.new_markdown_cell(hints_of("04_dirichlet_process.ipynb")))
    nbformat.write(notebook, path)
    opened = new_context(chromium, viewport=LARGE_WINDOW, has_touch=True).new_page()
    open_notebook(opened, lab, NAME, "predict")
    yield opened
    opened.context.close()


@pytest.fixture(scope="module")
def run(page):
    """The same page after its cells have run."""
    run_all_cells(page)
    page.locator(".np-predict[data-ready]").nth(3).wait_for()
    return page


@pytest.fixture
def asked(run):
    """The page with no question answered; an error in it fails the test that is running."""
    errors = []
    run.on("pageerror", lambda error: errors.append(error.stack))
    yield run
    for again in run.get_by_role("button", name="Ask me again").all():
        if again.is_visible():
            again.click()
    assert not errors


def box(page, words):
    return page.locator(".np-predict", has_text=words).first


def is_open(question) -> bool:
    return question.locator("details").get_attribute("open") is not None


def kept(page, name):
    return json.loads(page.evaluate(f"localStorage.getItem('npslam/99/predict/{name}')") or "null")


def test_before_anything_runs_results_are_folded_and_no_news_pops_up(page):
    folded = page.locator(".jp-OutputArea details").first
    folded.wait_for()
    assert folded.get_attribute("open") is None and not folded.locator("pre").is_visible()
    folded.locator("summary").click()
    assert folded.locator("pre").is_visible()
    assert not page.get_by_text("Would you like to get notified").count()


def test_solutions_do_not_stand_above_the_lessons(page):
    page.keyboard.press("Control+b")
    listing = page.locator(".jp-DirListing-content")
    listing.get_by_text(NAME).wait_for()
    assert not listing.get_by_text("solutions", exact=True).count()
    page.keyboard.press("Control+b")


def test_hints_are_folded_and_then_the_solution_which_opens_though_it_is_not_listed(page):
    hints = page.locator(".jp-MarkdownOutput > details", has_text="Hints for exercise")
    link = hints.get_by_role("link", name="solutions of this lesson")
    assert not hints.locator("li").first.is_visible()
    hints.locator("summary").first.click()
    assert hints.locator("li").first.is_visible() and not link.is_visible()
    hints.locator("summary").nth(1).click()
    link.click()
    page.locator(".lm-TabBar-tabLabel", has_text="04_solutions.ipynb").wait_for()
    page.locator(".lm-TabBar-tabLabel", has_text=NAME).click()


def test_a_choice_by_keys_unfolds_all_of_its_result_and_is_kept_in_the_browser(asked):
    page, question = asked, box(asked, "Which one?")
    cells = page.locator(".jp-Notebook .jp-Cell").count()
    more = page.locator(".np-predict[data-kind=more]")
    assert not is_open(question) and not is_open(more)
    question.get_by_role("radio").first.check()
    for key in ("ArrowDown", "ArrowDown", "Tab", "Enter"):
        page.keyboard.press(key)
    assert is_open(question) and is_open(more)
    assert "You said “right”, and so it is." in question.inner_text()
    assert kept(page, "pick") == 2
    assert "1 of 3 predicted" in question.inner_text()
    assert page.locator(".jp-Notebook .jp-Cell").count() == cells, "no key was a command of the notebook"


def test_what_the_text_says_about_a_result_unfolds_with_it_and_folds_again(asked):
    explained = asked.locator(".jp-MarkdownOutput > details", has_text="What it shows")
    words = explained.get_by_text("where the heart is not")
    question = box(asked, "Which one?")
    assert not words.is_visible()
    box(asked, "How many metres?").locator("summary").click()
    assert not words.is_visible(), "it is the other question's"
    question.get_by_role("radio").first.check()
    question.get_by_role("button", name="This is my prediction").click()
    words.wait_for()
    question.get_by_role("button", name="Ask me again").click()
    words.wait_for(state="hidden")
    box(asked, "How many metres?").locator("summary").click()


def test_a_check_that_passes_marks_its_exercise_and_the_mark_can_be_taken_away(asked):
    done, question = asked.locator(".np-done[data-lesson='99']"), box(asked, "Which one?")
    assert "Right: so it is." in done.inner_text() and "1 of 2 exercises done" in done.inner_text()
    assert "0 of 3 predicted, 1 of 2 exercises done" in question.inner_text()
    stored = "localStorage.getItem('npslam/99/exercise/2')"
    assert asked.evaluate(stored) == "true"
    done.get_by_role("button", name="Take the mark away").click()
    assert asked.evaluate(stored) is None
    assert "0 of 2 exercises done" in done.inner_text() and "0 of 2 exercises done" in question.inner_text()
    done.get_by_role("button", name="Mark as done").click()
    assert asked.evaluate(stored) == "true"
    marked = "Object.keys(localStorage).filter((key) => key.includes('/exercise/'))"
    assert asked.evaluate(marked) == ["npslam/99/exercise/2"], "the solutions, open behind it, are not the reader's"


def test_a_number_is_compared_with_the_one_that_the_cell_has_computed(asked):
    question = box(asked, "How many metres?")
    question.get_by_role("button", name="This is my prediction").click()
    assert "First answer, or open “Show me”." in question.inner_text() and not is_open(question)
    question.get_by_role("spinbutton").fill("4")
    question.get_by_role("button", name="This is my prediction").click()
    assert "You said 4\u00a0m. It is 2.5\u00a0m." in question.inner_text()
    assert is_open(question) and kept(asked, "count") == 4


def drawn(page):
    return np_points(box(page, "Where does it go?").locator("polyline").nth(1).get_attribute("points"))


def np_points(text):
    return [tuple(map(float, each.split(","))) for each in (text or "").split()]


def end_of(question, how, page):
    """Draw from the left to the right, a quarter below the top, with a mouse, a finger or keys."""
    question.scroll_into_view_if_needed()
    area = question.bounding_box()
    xs = [area["x"] + share * area["width"] for share in (0.1, 0.4, 0.75)]
    y = area["y"] + 0.25 * area["height"]
    if how == "mouse":
        page.mouse.move(xs[0], y)
        page.mouse.down()
        for x in xs[1:]:
            page.mouse.move(x, y)
        page.mouse.up()
    elif how == "finger":
        session = page.context.new_cdp_session(page)
        for kind, x in zip(("touchStart", "touchMove", "touchMove"), xs, strict=True):
            session.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": [{"x": x, "y": y}]})
        session.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})
    else:
        question.focus()
        for key in ["Enter", *["ArrowRight"] * 30, *["ArrowUp"] * 5, "Enter"]:
            page.keyboard.press(key)


@pytest.mark.parametrize("how", ["mouse", "finger", "keys"])
def test_a_sketch_is_drawn_and_the_right_line_appears_with_the_answer(asked, how):
    question = box(asked, "Where does it go?")
    truth = question.locator("polyline").nth(2)
    assert not truth.get_attribute("points")
    end_of(question.locator("svg"), how, asked)
    line = drawn(asked)
    assert line[-1] == pytest.approx((480, 80), abs=4), "in the units of the drawing area"
    question.get_by_role("button", name="This is my prediction").click()
    assert "ends 1.1 m from where it ends" in question.inner_text()
    assert np_points(truth.get_attribute("points")) == [(0, 160), (640, 0)]
    assert is_open(question) and kept(asked, "line")[-1] == pytest.approx((3, 1.5), abs=0.03)


def test_show_me_unfolds_without_an_answer_and_a_question_can_be_asked_again(asked):
    question = box(asked, "Which one?")
    question.locator("summary").click()
    assert is_open(question) and kept(asked, "pick") is None
    question.get_by_role("radio").nth(1).check()
    question.get_by_role("button", name="This is my prediction").click()
    assert "You said “middle”. It is: “right”." in question.inner_text()
    question.get_by_role("button", name="Ask me again").click()
    assert kept(asked, "pick") is None and not is_open(question)
    assert not question.get_by_role("radio").nth(1).is_checked()


@pytest.mark.parametrize("theme", ["JupyterLab Light", "JupyterLab Dark"])
def test_nothing_in_a_question_keeps_anybody_out(asked, theme):
    """Of all kinds, unfolded."""
    asked.evaluate("light => document.body.dataset.jpThemeLight = light", str(theme.endswith("Light")).lower())
    asked.evaluate("document.querySelectorAll('.np-predict details').forEach((each) => { each.open = true; })")
    assert violations(asked, ".np-predict") == []
    asked.evaluate("document.querySelectorAll('.np-predict details').forEach((each) => { each.open = false; })")
    asked.evaluate("document.body.dataset.jpThemeLight = 'true'")
