"""A question of a lesson as a piece of HTML: its text, where the answer goes, and the result folded below."""

import html
import json
import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

# A number and its unit stay on one line.
_UNIT = re.compile(r"(?<=\d) (?=(?:m|cm|mm|km|s|rad|kB|degrees|metres|minutes|seconds)\b|%)")
_SKETCH_WIDTH = 640  # of the drawing area, in its own units; the page scales it


@dataclass(frozen=True)
class Question:
    """What a reader is asked.

    Attributes:
        kind: "choice", "number" or "sketch".
        text: the question, in one sentence.
        mistake: shown with the result: what the class usually gets wrong, and what comes of it.
        alts: what the picture in each part of the result shows; "" for a part without one.
        options: of a choice.
        right: the index of the right one among them.
        unit: of a number, with the space before it.
        box: of a sketch: left, bottom, right and top, in m.
    """

    kind: str
    text: str
    mistake: str
    alts: tuple[str, ...] = ()
    options: tuple[str, ...] = ()
    right: int = -1
    unit: str = ""
    box: tuple[float, ...] = ()


def page(
    asked: Question, place: tuple[str, str, tuple[int, int]], result: str, answer=None, known=(), is_first: bool = True
) -> str:
    """The question and its folded result.

    Args:
        asked: the question.
        place: the lesson, the name of the question, and how many questions and exercises the lesson has.
        result: HTML.
        answer: of a number or a sketch.
        known: lines that a sketch begins with, each (N, 2) m.
        is_first: False for more of the result of a question that stands above.
    """
    lesson, name, (total, exercises) = place
    right = f"{answer:.4g}" if isinstance(answer, float) else ""
    attributes = f'data-lesson="{lesson}" data-name="{name}" data-kind="{asked.kind if is_first else "more"}"'
    attributes += f' data-right="{asked.right}" data-answer="{right}" data-unit="{asked.unit}"'
    if is_first:
        totals = f'data-total="{total}"' + (f' data-exercises="{exercises}"' if exercises else "")
        progress = f'<span class="np-progress" data-lesson="{lesson}" {totals}></span>'
        legend = f"<legend>Predict: {_words(asked.text)}</legend>"
        question = f"{progress}<fieldset>{legend}{_controls(asked, f'{lesson}-{name}', answer, known)}</fieldset>"
        folded = f"{_verdict(asked, right)}{result}<p><em>The usual mistake:</em> {_words(asked.mistake)}</p>"
        sketch = inlined("predict_sketch.js") if asked.kind == "sketch" else ""
        summary, script = "Show me", sketch + inlined("progress.js") + inlined("predict.js")
    else:
        question, folded, script = "", result, inlined("predict_more.js")
        summary = f"More of the answer to: {_words(asked.text)}"
    return (
        f'<div class="np-box np-predict" {attributes}><style>{inlined("predict.css")}</style>{question}'
        f"<details><summary>{summary}</summary>{folded}</details><script>{script}</script></div>"
    )


def _words(text: str) -> str:
    return html.escape(_UNIT.sub("\u00a0", text))


def _verdict(asked: Question, right: str) -> str:
    said = asked.options[asked.right] if asked.options else f"{right}{asked.unit}".strip()
    return f"<p><strong>It is: {_words(said)}</strong></p>" if said else ""


def _controls(asked: Question, name: str, answer, known) -> str:
    if asked.kind == "choice":
        inputs = (f'<li><label><input type="radio" name="{name}">{_words(each)}</label></li>' for each in asked.options)
        return f"<ul>{''.join(inputs)}</ul>"
    if asked.kind == "number":
        return f'<label>Your number: <input type="number" step="any">{asked.unit}</label> '
    return _drawing_area(asked.box, answer, known)


def _drawing_area(box: tuple[float, ...], answer, known) -> str:
    left, bottom, right, top = box
    scale = _SKETCH_WIDTH / (right - left)
    lines = "".join(
        f'<polyline points="{_points((line - [left, top]) * [scale, -scale])}" fill="none" stroke="#757575" '
        'stroke-width="3" stroke-dasharray="9 6"/>'
        for line in known
    )
    start = np.round(known[0][0], 2).tolist() if len(known) else [left, bottom]
    line = [] if answer is None else np.round(answer, 2).tolist()
    data = {"box": box, "start": start, "answer": line}
    attributes = " ".join(f'data-{key}="{json.dumps(value)}"' for key, value in data.items())
    label = "Drawing area. Draw with the mouse or a finger; or move with the arrow keys, and set a point with Enter."
    view = f"0 0 {_SKETCH_WIDTH} {round((top - bottom) * scale)}"
    frame = f'<rect width="100%" height="100%" fill="#fff" stroke="#757575"/>{lines}{_corners(box, scale)}'
    return f'<svg viewBox="{view}" tabindex="0" role="application" aria-label="{label}" {attributes}>{frame}</svg>'


def _corners(box: tuple[float, ...], scale: float) -> str:
    """The scale of a drawing area: its lower left and upper right corner in metres."""
    left, bottom, right, top = box
    style = 'font-size="16" fill="#555"'
    return (
        f'<text x="6" y="{(top - bottom) * scale - 8:.0f}" {style}>from ({left:g}, {bottom:g}) m</text> '
        f'<text x="{_SKETCH_WIDTH - 6}" y="20" text-anchor="end" {style}>to ({right:g}, {top:g}) m</text>'
    )


def _points(pixels: np.ndarray) -> str:
    rounded = np.round(pixels, 1) + 0.0  # not -0.0
    return " ".join(f"{x:.1f},{y:.1f}" for x, y in rounded)


@cache
def inlined(name: str) -> str:
    """A file beside this one on one line, without its comments: it is in every question of every lesson."""
    lines = (Path(__file__).parent / name).read_text(encoding="utf-8").splitlines()
    return " ".join(line.strip() for line in lines if line.strip() and not line.strip().startswith("//"))
