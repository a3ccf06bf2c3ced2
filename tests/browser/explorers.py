"""Explorers as they stand in a page, and the same ones made here: what a page shows is compared with the library."""

import atexit
import contextlib
import functools
import io
import re
import tempfile
from dataclasses import dataclass
from pathlib import Path

import nbformat
import pytest
from computed_once import compute_once
from lab_server import POLLING, ROOT, open_notebook, run_all_cells, timeout_error, write_notebook
from slices import needed_statements

from npslam_teach.course.controls import Choice, Control, Places
from npslam_teach.course.explorers import Explorer
from npslam_teach.publishing.colab import own_source

MEASURE = (Path(__file__).parent / "latency.js").read_text(encoding="utf-8")
# Of a scene: every part with its attributes and its text, in order; a pressed key leaves an attribute of its own.
PICTURE = """root => {
    const [image, words] = [root.querySelector("figure img"), root.querySelector("figcaption").textContent];
    const own = ({ name }) => name !== "data-lm-suppress-shortcuts";
    const pairs = (each) => [...each.attributes].filter(own).map(({ name, value }) => [name, value]);
    const named = (each) => Object.fromEntries(pairs(each));
    const part = (each) => [each.tagName, named(each), each.textContent];
    const parts = [...root.querySelectorAll("figure svg > *")].map(part);
    return { source: image?.src ?? parts, alt: image?.alt ?? words, words };
}"""
# Of controls by their names: which entry of a list is selected, and the number in the field of a slider.
FIELDS = """(root, names) => names.map((name) => {
    const control = root.querySelector(`[data-control=${name}]`);
    return [control.selectedIndex ?? null, control.parentElement.querySelector("input[type=text]")?.value ?? null];
})"""
# How many pictures were painted, which value a control shows, whether it has the focus: now, or with the next picture.
STATE = """(root, [name]) => {
    const control = root.querySelector(`[data-control=${name}]`);
    return [root.latencies.length, Number(control.selectedIndex ?? control.value), document.activeElement === control];
}"""
PAINTED = f"""async (root, [name, known, milliseconds]) => {{
    const end = performance.now() + milliseconds;
    while (root.latencies.length <= known && performance.now() < end) await new Promise((done) => setTimeout(done, 5));
    return ({STATE})(root, [name]);
}}"""
EXPLORE = re.compile(r"\bexplore_\w+\(")
EXPLORER = ".npslam-explorer"
ANSWER_SECONDS = 120
COMPUTED = tempfile.TemporaryDirectory(prefix="computed_once_")
atexit.register(COMPUTED.cleanup)
# The first cell of the page: what takes an explorer seconds is computed by its kernel, and read by this process.
COMPUTED_ONCE = f"""import sys
sys.path.append({str(ROOT / "tests" / "helpers")!r})
from computed_once import compute_once
compute_once({COMPUTED.name!r})"""


def lessons_with_explorers() -> list[str]:
    """The names of their notebooks."""
    paths = sorted((ROOT / "notebooks").glob("[0-9]*.ipynb"))
    return [path.name for path in paths if EXPLORE.search(path.read_text(encoding="utf-8"))]


def sources_of(lesson: str) -> list[str]:
    """Code cells that make and show the explorers of a lesson: of its own cells, what they depend on."""
    cells = nbformat.read(ROOT / "notebooks" / lesson, as_version=4).cells
    # What gets the course where it is missing awaits, as only a notebook can.
    sources = [own_source(cell.source) for cell in cells if cell.cell_type == "code"]
    with_explorers = {k for k, source in enumerate(sources) if EXPLORE.search(source)}
    return [source for source in needed_statements(sources, with_explorers) if source]


def explorers_of(lesson: str) -> list[Explorer]:
    """The explorers of a lesson, in the order of their cells, made in this process of the cells that they depend on.

    They are made once in a process; whatever the last test has moved is put back.
    """
    for explorer, values in _made(lesson):
        explorer.move(**values)
    return [explorer for explorer, _ in _made(lesson)]


@functools.cache
def _made(lesson: str) -> list[tuple[Explorer, dict]]:
    """Explorers and the values that they begin with."""
    namespace = {"__name__": lesson}
    with contextlib.redirect_stdout(io.StringIO()), pytest.MonkeyPatch.context() as patch:
        compute_once(COMPUTED.name, patch.setattr)
        for k, source in enumerate(sources_of(lesson)):
            exec(compile(source, f"{lesson}, code cell {k}", "exec"), namespace)
    return [(each, each.values()) for each in namespace.values() if isinstance(each, Explorer)]


def open_explorers(page, lab, name: str, lessons: list[str]) -> dict[str, list["Shown"]]:
    """The explorers of some lessons in one notebook that has run on a kernel of its own; by lesson, with their twins.

    Args:
        page: an empty one.
        lab: ``lab_server.Lab``.
        name: of the notebook that is written.
        lessons: the names of their notebooks.
    """
    sources = [source for each in lessons for source in sources_of(each)]
    write_notebook(lab.folder / "notebooks" / name, COMPUTED_ONCE, *sources)
    open_notebook(page, lab, name)
    run_all_cells(page)
    twins = [(each, twin) for each in lessons for twin in explorers_of(each)]
    assert page.locator(EXPLORER).count() == len(twins)
    shown = {each: [] for each in lessons}
    for number, (each, twin) in enumerate(twins):
        shown[each].append(Shown(page, number, twin))
    return shown


@dataclass
class ShownControl:
    """A slider or a list of an explorer in the page."""

    name: str  # of the argument of the explorer's update
    twin: Control  # the same control of the explorer in this process
    start: object  # its value when the page was opened, which may lie beside the grid
    locator: object  # what has the focus when it is used
    readout: object  # the field with the number of a slider

    @property
    def is_list(self) -> bool:
        return isinstance(self.twin, Choice)

    def values(self) -> list:
        """All that the arrow keys lead to, in order."""
        return self.twin.grid()

    def index(self) -> int:
        """Which of them the page shows."""
        return int(self.locator.evaluate("each => each.selectedIndex ?? each.value"))

    def value(self, place: int, number: str | None):
        """What the page shows: of a list the entry at a place, of a slider the number in its field."""
        if self.is_list:
            return self.values()[place]
        return min([*self.values(), self.start], key=lambda each: abs(each - float(number)))

    def key(self, forward: bool) -> str:
        return {True: ("ArrowRight", "ArrowDown"), False: ("ArrowLeft", "ArrowUp")}[forward][self.is_list]


class Shown:
    """An explorer in the page, and its twin in this process."""

    def __init__(self, page, number: int, twin: Explorer):
        self.page, self.number, self.twin, self._answers, self._handle = page, number, twin, {}, None
        self.root = root = page.locator(EXPLORER).nth(number)
        root.scroll_into_view_if_needed()
        self.controls = []
        for name, control in twin.sliders.items():
            if not isinstance(control, Places):
                here = root.locator(f"[data-control={name}]")
                self.controls.append(
                    ShownControl(name, control, control.value, here, here.locator("xpath=../input[@type='text']"))
                )
        root.evaluate(MEASURE)

    def values(self) -> dict:
        """What the page's controls are set to, which a single question to the page tells."""
        shown = self._evaluate(FIELDS, *(control.name for control in self.controls))
        return {control.name: control.value(*each) for control, each in zip(self.controls, shown, strict=True)}

    def picture(self) -> dict:
        """The picture, its alternative text and the words under it."""
        return self._evaluate(PICTURE)

    def expected(self) -> dict:
        """The library's answer for what the page's controls are set to, which it is asked for once."""
        values = self.values()
        place = tuple(values.values())
        if place not in self._answers:
            words = self.twin.move(**values)
            parts = self.twin.shown.get("scene", {}).get("parts", {}).values()
            source = self.twin.shown.get("src") or [
                [tag, attributes, *(text or [""])] for tag, attributes, *text in parts
            ]
            self._answers[place] = {"source": source, "alt": words, "words": words}
        return self._answers[place]

    def press(self, control: ShownControl, forward: bool) -> None:
        """Press an arrow key, and wait until another picture, or other words, are painted."""
        known, before, has_focus = self._evaluate(STATE, control.name)
        if not has_focus:
            control.locator.focus()
        self.page.keyboard.press(control.key(forward))
        now, after, _ = self._evaluate(PAINTED, control.name, known, 1000 * ANSWER_SECONDS)
        if now <= known:
            raise self._complaint(f"{control.name}: the picture did not change")
        assert after == before + (1 if forward else -1)

    def _evaluate(self, expression: str, *arguments):
        """Ask the page for a value of the explorer, which is looked for once: it costs more than most questions."""
        if self._handle is None:
            self._handle = self.root.element_handle()
        return self._handle.evaluate(expression, list(arguments))

    def _complaint(self, what: str) -> AssertionError:
        return AssertionError(f"{what} ({self.values()}; {self.picture()['words']})")

    def press_and_compare(self, control: Control, forward: bool) -> dict:
        """Press an arrow key and check all of the answer; returns what is shown then."""
        self.press(control, forward)
        shown, expected = self.picture(), self.expected()
        for what in ("words", "alt"):
            assert shown[what] == expected[what], f"{shown[what]!r} for {expected[what]!r}"
        assert shown["source"] == expected["source"], f"not the picture of {self.values()}: {shown['words']}"
        return shown

    def wait(self, condition: str, known, what: str) -> None:
        """Wait for a condition in JavaScript on ``root`` and ``known``; say what was waited for if it never comes."""
        try:
            self.page.wait_for_function(
                f"([root, known]) => {condition}",
                arg=[self.root.element_handle(), known],
                timeout=1000 * ANSWER_SECONDS,
                polling=POLLING,
            )
        except timeout_error():
            raise self._complaint(what) from None

    def wait_for_answer(self) -> None:
        """Wait until the words are those of what the controls are set to."""
        words = "root.querySelector('figcaption').textContent"
        self.wait(f"{words} === known", self.expected()["words"], "the words do not follow")

    def walk(self, control: Control, least: int, most: int) -> list[dict]:
        """Press arrow keys towards the farther end and back to where it stood; what is shown after each of them.

        Args:
            control: that has the focus.
            least: so often, or to the end.
            most: further, until there is another picture, but no more than so often.
        """
        last = len(control.values()) - 1 - control.index()
        before, forward, there = self.picture(), last >= control.index(), []
        for k in range(min(max(last, control.index()), most)):
            if k >= least and len(pictures([before, *there])) >= 2:
                break
            there.append(self.press_and_compare(control, forward))
        return there + [self.press_and_compare(control, not forward) for _ in there]

    def names_in_the_accessibility_tree(self) -> list[tuple[str, str]]:
        """(role, name) of all in this explorer that a screen reader can come to."""
        self.controls[
            0
        ].locator.focus()  # what was never in sight is not in the tree, and comes into it some frames later
        session = self.page.context.new_cdp_session(self.page)
        place = f"document.querySelectorAll({EXPLORER!r})[{self.number}]"
        element = session.send("Runtime.evaluate", {"expression": place})["result"]["objectId"]
        for _ in range(100):
            nodes = session.send("Accessibility.queryAXTree", {"objectId": element})["nodes"]
            names = [(node["role"]["value"], node["name"]["value"]) for node in nodes if not node["ignored"]]
            if any(role in ("image", "group") for role, _ in names):
                break
            self.page.evaluate("() => new Promise(requestAnimationFrame)")
        return names

    def latencies(self) -> list[float]:
        """Milliseconds from each key press to changed pixels since the last call."""
        return self.root.evaluate("root => root.latencies.splice(0)")


def pictures(shown: list[dict]) -> set[str]:
    """The different ones among those that ``Shown.picture`` returns."""
    return {str(each["source"]) for each in shown}


def attributes_of(locator) -> dict:
    """By their names."""
    return locator.evaluate(
        "(each) => Object.fromEntries([...each.attributes].map(({ name, value }) => [name, value]))"
    )


def place_on_screen(ring, xy) -> tuple[float, float]:
    """Where a point of a scene is in the window, px.

    Args:
        ring: a locator of any part of the scene.
        xy: (2,) as the scene counts.
    """
    to_screen = "(each, [x, y]) => new DOMPoint(x, y).matrixTransform(each.ownerSVGElement.getScreenCTM()).toJSON()"
    point = ring.evaluate(to_screen, list(xy))
    return point["x"], point["y"]


def led(page, ring, places, hand: str) -> None:
    """Take hold of a ring with mouse or finger, lead it through places of its scene, and let go.

    Args:
        page: that it is in.
        ring: its locator.
        places: (2,) each, as the scene counts; it begins where the ring lies.
        hand: "mouse" or "finger".
    """
    begin = [float(ring.get_attribute(each)) for each in ("cx", "cy")]
    way = [place_on_screen(ring, xy) for xy in (begin, *places)]
    if hand == "mouse":
        page.mouse.move(*way[0])
        page.mouse.down()
        for at in way[1:]:
            page.mouse.move(*at, steps=3)
        page.mouse.up()
        return
    session = page.context.new_cdp_session(page)
    touches = [("touchStart", way[0]), *(("touchMove", at) for at in way[1:]), ("touchEnd", None)]
    for kind, at in touches:
        points = [{"x": at[0], "y": at[1]}] if at else []
        session.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
    session.detach()
