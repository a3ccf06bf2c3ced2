"""Questions with folded results: what is captured, what is never folded away, and that every Predict has its answer."""

import html
import re
import sys
from importlib import import_module
from pathlib import Path

import nbformat
import numpy as np
import pytest
from IPython.core.interactiveshell import InteractiveShell
from IPython.utils.capture import capture_output
from test_reading_online import Tags

from npslam_teach import plotting
from npslam_teach.course import predict as asking

ROOT = Path(__file__).parents[2]
LESSONS = sorted((ROOT / "notebooks").glob("*.ipynb"))
CALL = re.compile(r'predict\("(\w+)"(?:, part=(\d))?\)')


@pytest.fixture(autouse=True)
def shell():
    """``display`` needs one; it belongs to this test and is gone afterwards."""
    yield InteractiveShell.instance()
    InteractiveShell.clear_instance()


@pytest.fixture
def predict():
    return asking.questions(
        "99",
        pick=asking.choice("Which <one>?", ["left", "right"], right=1, mistake="To look away.", alts=["Two dots."]),
        count=asking.number("How many?", mistake="To guess.", unit="m"),
        line=asking.sketch("Where to?", mistake="To stop.", box=(0, 0, 4, 2)),
    )


def displayed(body) -> tuple[str, str, str]:
    """The HTML that ``body`` displays, and what it prints on both streams."""
    with capture_output() as captured:
        body()
    return "".join(each.data.get("text/html", "") for each in captured.outputs), captured.stdout, captured.stderr


def test_what_is_printed_and_shown_is_folded_below_the_question(predict):
    def body():
        with predict("pick") as see:
            print("1234 < 5678")
            figure, ax = plotting.new_figure()
            see.show(figure)

    page, printed, _ = displayed(body)
    question, folded = page.split("<details>")
    assert "Which &lt;one&gt;?" in question and "left" in question
    assert "1234" not in question and "<img" not in question
    assert "<pre>1234 &lt; 5678\n</pre>" in folded and 'alt="Two dots."' in folded and "To look away." in folded
    assert "It is: right" in folded
    assert printed == ""


def test_the_number_is_the_one_that_the_cell_has_computed(predict):
    def body():
        with predict("count") as see:
            see.answer(0.1 + 0.2)

    page, _, _ = displayed(body)
    assert 'data-answer="0.3"' in page and "It is: 0.3\u00a0m" in page


def test_a_sketch_shows_what_is_known_and_keeps_what_is_right_for_later(predict):
    def body():
        with predict("line") as see:
            see.known(np.array([[0.0, 0.0, 0.0], [4.0, 2.0, 0.0]]))
            see.answer([[0.0, 0.0], [4.0, 0.0]])

    page, _, _ = displayed(body)
    assert 'points="0.0,320.0 640.0,0.0"' in page
    assert 'data-answer="[[0.0, 0.0], [4.0, 0.0]]"' in page
    assert page.count("<polyline") == 1, "the answer is not drawn before it is asked for"


def test_errors_and_warnings_are_never_folded_away(predict):
    def fails():
        with predict("pick"):
            print("so far")
            raise ZeroDivisionError("here")

    with capture_output() as captured, pytest.raises(ZeroDivisionError):
        fails()
    assert captured.stdout == "so far\n" and not captured.outputs

    def warns():
        with predict("pick"):
            print("careful", file=sys.stderr)

    assert displayed(warns)[2] == "careful\n"


def test_more_of_a_result_is_folded_without_a_second_question(predict):
    def body():
        with predict("pick", part=2):
            print("more")

    page, _, _ = displayed(body)
    assert "<fieldset>" not in page and page.index("<details>") < page.index("more\n")
    assert 'data-kind="more"' in page


def test_without_scripts_and_styles_the_choices_are_a_list_and_the_result_is_folded(predict):
    page, _, _ = displayed(lambda: __import__("IPython.display").display.display(predict("pick")))
    page = re.sub(r"<(script|style)>.*?</\1>", "", page, flags=re.DOTALL)
    tags = [tag for tag, _ in Tags(page).tags]
    assert tags == "div span fieldset legend ul li label input li label input details summary p strong p em".split()


def test_wrong_use_is_told(predict):
    with pytest.raises(ValueError, match=r"name: expected one of pick, count, line, got 'pack'"):
        predict("pack")
    with pytest.raises(ValueError, match="right: expected an index below 2, got 2"):
        asking.choice("?", ["a", "b"], right=2, mistake="")
    with pytest.raises(ValueError, match="expected a question for a number or a sketch, got the choice 'pick'"):
        predict("pick").answer(1)


@pytest.fixture(params=LESSONS, ids=lambda path: path.stem)
def lesson(request):
    """The cells of a lesson, and its questions by name."""
    cells = nbformat.read(request.param, as_version=4).cells
    (module,) = {
        match for cell in cells for match in re.findall(r"from (npslam_teach\.\S+\.predictions) import", cell.source)
    }
    return cells, import_module(module).predict.questions


def test_every_predict_has_its_answer(lesson):
    """A question comes before the next cell that asks, and none of the module is left over."""
    cells, questions = lesson
    waiting, asked = None, []
    for cell in cells:
        if cell.cell_type == "markdown" and "**Predict" in cell.source:
            assert waiting is None, f"no answer to: {waiting}"
            waiting = cell.source[cell.source.index("**Predict") :][:80]
        elif cell.cell_type == "code":
            for name, part in CALL.findall(cell.source):
                if part in ("", "1"):
                    asked.append(name)
                    waiting = None
    assert waiting is None, f"no answer to: {waiting}"
    assert sorted(asked) == sorted(questions), "each once"


def test_the_code_before_an_answer_holds_no_words_of_the_picture(lesson):
    cells, questions = lesson
    code = " ".join(" ".join(cell.source.split()) for cell in cells if cell.cell_type == "code")
    for question in questions.values():
        assert question.mistake not in code
        assert not [alt for alt in question.alts if alt and alt in code]


def test_the_committed_result_is_folded_and_nothing_else_of_the_cell_is_shown(lesson):
    cells, questions = lesson
    for cell in cells:
        found = CALL.findall(cell.source) if cell.cell_type == "code" else []
        if not found:
            continue
        shown = [output.data for output in cell.outputs if "text/html" in output.get("data", {})]
        pages = [data["text/html"] for data in shown if not data["text/plain"].startswith("Explorer: ")]
        assert len(pages) == 1 and not [output for output in cell.outputs if output.output_type == "stream"]
        ((name, part),) = found
        question, folded = pages[0].split("<details>")
        words = question.replace("\u00a0", " ")  # between a number and its unit
        assert (f"Predict: {html.escape(questions[name].text)}" in words) == (part in ("", "1"))
        assert "<img" not in question and "<pre" not in question
        if "answer(" in cell.source and questions[name].kind == "number":
            assert re.search(r'data-answer="-?[\d.]+"', question)
