"""Explorers without a kernel, in a page with nothing but what is committed of them, as in the book.

That the words of frames are the library's is compared by nbval, which makes them anew; here the page has to show them.
"""

import json
import re

import nbformat
import pytest
from axe import violations
from explorers import EXPLORER, PICTURE, attributes_of, led, lessons_with_explorers
from lab_server import POLLING, ROOT, new_context
from rings import ring_of
from window import ALL_ARE_KEPT, take_screenshot

SHOTS = ROOT / "build" / "screenshots"
FROZEN = re.compile(r"frozen\((.*)\), el: place")
KEYS = {"slider": ("ArrowRight", "ArrowLeft"), "choice": ("ArrowDown", "ArrowUp")}  # forward and back
PLACES = """(root, names) => {
    const place = (each) => Number(each.selectedIndex ?? each.value);
    return Object.fromEntries(names.map((name) => [name, place(root.querySelector(`[data-control=${name}]`))]));
}"""
SHOWN = f"(root, names) => [({PICTURE})(root), ({PLACES})(root, names)]"
BUDGET = 1_500_000  # bytes of a lesson
PHONE, NARROW, LAPTOP = 390, 800, 1280  # px


def committed(lesson: str) -> list[str]:
    """The HTML of each explorer of a lesson that has frames."""
    cells = nbformat.read(ROOT / "notebooks" / lesson, as_version=4).cells
    pieces = [output.get("data", {}).get("text/html", "") for cell in cells for output in cell.get("outputs", [])]
    return [piece for piece in pieces if FROZEN.search(piece)]


class Framed:
    """An explorer in a page without a kernel, and the frames that it is made of."""

    def __init__(self, page, number: int, source: str):
        data = json.loads(FROZEN.search(source).group(1))
        self.page, self.controls, self.frames = page, data["controls"], data["frames"]
        self.first = next(each for each in self.frames if "first" in each)
        self.root = page.locator(EXPLORER).nth(number)
        self.handle = self.root.element_handle()

    def locator(self, control: dict):
        return self.root.locator(f"[data-control={control['name']}]")

    def index(self, control: dict) -> int:
        """Which of its values a control shows."""
        return int(self.locator(control).evaluate("each => each.selectedIndex ?? each.value"))

    def size(self, control: dict) -> int:
        return len(control.get("grid") or control["options"])

    def expected(self, named: dict) -> dict:
        """The frame for what the controls are set to; the last control is the fastest."""
        place = 0
        for control in self.controls:
            place = place * self.size(control) + named[control["name"]]
        frame = self.frames[place]
        grids = {each["name"]: each.get("grid") or range(self.size(each)) for each in self.controls}
        assert frame["values"] == {name: grids[name][k] for name, k in named.items()}
        return frame

    def source(self, frame: dict):
        """The picture of a frame, or the parts of its scene that need no kernel, in any order."""
        if "src" in frame:
            return frame["src"]
        parts = self.first["scene"]["parts"] | frame["scene"]["parts"]
        shown = [part for name, part in parts.items() if name not in frame.get("without", [])]
        seen = [[tag, named, *(text or [""])] for tag, named, *text in shown if "data-places" not in named]
        return sorted(seen, key=str)

    def compare(self) -> str:
        """See that words and picture are those of the frame; returns the words."""
        return self.compared()[0]

    def compared(self) -> tuple[str, dict]:
        """The same; and what the controls are set to, which the same question to the page tells."""
        shown, named = self.handle.evaluate(SHOWN, [each["name"] for each in self.controls])
        frame = self.expected(named)
        assert shown["words"] == shown["alt"] == frame["words"]
        source = shown["source"] if isinstance(shown["source"], str) else sorted(shown["source"], key=str)
        assert source == self.source(frame), f"not the picture of {frame['words']}"
        return frame["words"], named

    def walk(self, control: dict) -> set[str]:
        """Press arrow keys through all values, and back to where it stood; the words that are shown."""
        here, keys = self.locator(control), KEYS[control["kind"]]
        start, last = self.index(control), self.size(control) - 1
        here.press("Home")
        told, before = {self.compare()}, 0
        for k in [*range(1, last + 1), *range(last - 1, start - 1, -1)]:
            self.page.keyboard.press(keys[k < before])
            words, named = self.compared()
            assert named[control["name"]] == k
            told.add(words)
            before = k
        return told

    def ring(self, locator):
        """What a ring is now, and its stops that lead to values with frames: (x, y, place in the grid by control)."""
        ring = ring_of(attributes_of(locator))
        return ring, [(x, y, wanted) for x, y, *values in ring.stops if (wanted := self.wanted(ring.moves, values))]

    def wanted(self, names, values) -> dict | None:
        """By name the place in the grid of each control; None if a value has none."""
        controls, places = {each["name"]: each for each in self.controls}, {}
        for name, value in zip(names, values, strict=True):
            control = controls.get(name)
            if control is None:
                return None
            last = self.size(control) - 1
            grid = control.get("grid") or list(range(last + 1))
            if value in "<>":
                places[name] = self.index(control) + (1 if value == ">" else -1)
                if not 0 <= places[name] <= last:
                    return None
            elif float(value) in grid:
                places[name] = grid.index(float(value))
            else:
                return None
        return places

    def set_to(self) -> dict:
        """By name the place of each control, which a single question to the page tells."""
        return self.handle.evaluate(PLACES, [each["name"] for each in self.controls])


@pytest.fixture(scope="module")
def framed(request, chromium, tmp_path_factory):
    """A page with the explorers of a lesson, and they; nothing in it may fail."""
    pieces = committed(request.param)
    path = tmp_path_factory.mktemp("frames") / "lesson.html"
    head = "<!doctype html><html lang='en'><meta charset='utf-8'><meta name='viewport' content='width=device-width'>"
    path.write_text(f"{head}<title>lesson</title><main><h1>lesson</h1>{''.join(pieces)}</main></html>", "utf-8")
    context = new_context(chromium, viewport={"width": LAPTOP, "height": 900}, reduced_motion="reduce", has_touch=True)
    page, failures = context.new_page(), []
    page.on("pageerror", lambda error: failures.append(str(error)))
    page.goto(path.as_uri())
    assert page.locator(EXPLORER).count() == len(pieces) > 0
    yield page, [Framed(page, number, piece) for number, piece in enumerate(pieces)]
    context.close()
    assert failures == []


every_lesson = pytest.mark.parametrize("framed", lessons_with_explorers(), indirect=True, scope="module")


@every_lesson
def test_the_first_frame_is_shown_first(framed):
    for explorer in framed[1]:
        assert explorer.compare() == explorer.first["words"]


@every_lesson
def test_arrow_keys_lead_through_every_value(framed):
    for explorer in framed[1]:
        for control in explorer.controls:
            assert len(explorer.walk(control)) >= 2


@every_lesson
def test_every_slider_follows_mouse_and_finger(framed):
    page, explorers = framed
    for explorer in explorers:
        for control in explorer.controls:
            if control["kind"] == "slider":
                explorer.locator(control).scroll_into_view_if_needed()
                box = explorer.locator(control).bounding_box()
                middle = box["y"] + box["height"] / 2
                page.mouse.click(box["x"] + box["width"] - 3, middle)
                explorer.compare()
                assert explorer.index(control) == explorer.size(control) - 1
                page.touchscreen.tap(box["x"] + 3, middle)
                page.wait_for_function(
                    "each => each.value === '0'", arg=explorer.locator(control).element_handle(), polling=POLLING
                )
                explorer.compare()


with_rings = pytest.mark.parametrize(
    "framed", ["02_drift.ipynb", "05_class_votes.ipynb", "09_filtering.ipynb"], indirect=True, scope="module"
)


@with_rings
@pytest.mark.parametrize("hand", ["mouse", "finger"])
def test_a_ring_goes_where_a_hand_leads_it(framed, hand):
    page, explorers = framed
    some = 0
    for explorer in explorers:
        for locator in explorer.root.locator("[data-stops]").all():
            ring, stops = explorer.ring(locator)
            if not stops:
                continue
            locator.scroll_into_view_if_needed()
            x, y, wanted = max(stops, key=lambda each: abs(each[0] - ring.xy[0]) + abs(each[1] - ring.xy[1]))
            led(page, locator, [(0.5 * (x + ring.xy[0]), 0.5 * (y + ring.xy[1])), (x, y)], hand)
            page.wait_for_function("() => new Promise((done) => setTimeout(() => done(true), 50))", polling=POLLING)
            assert explorer.set_to().items() >= wanted.items()
            explorer.compare()
            some += 1
    assert some > 0


@with_rings
def test_a_ring_follows_the_arrow_keys(framed):
    """From stop to stop in their order, or to the one that lies where an arrow points; Enter where there is one."""
    for explorer in framed[1]:
        for locator in explorer.root.locator("[data-stops]").all():
            ring, stops = explorer.ring(locator)
            told, order = {explorer.compare()}, [wanted for _, _, wanted in stops]
            for key, by in {"ArrowRight": 1, "ArrowUp": 1, "ArrowDown": -1, "ArrowLeft": -1, "Enter": 0}.items():
                now = {name: explorer.set_to()[name] for name in ring.moves}
                locator.press(key)
                told.add(explorer.compare())
                if ring.follows:
                    place = min(max(order.index(now) + by, 0), len(order) - 1)
                    assert explorer.set_to().items() >= order[place].items()
            assert len(told) > 1 or not stops


# A player's step, watched from frame to frame: what a part of the picture is, or how much runs on it.
WATCH = """async ([root, selector, attribute]) => {
    const seen = [], read = () => {
        const part = root.querySelector(selector);
        seen.push(String(attribute ? part.getAttribute(attribute) : part.getAnimations().length));
    };
    read();
    root.querySelector("button[aria-label='step on']").click();
    for (const begin = performance.now(); performance.now() - begin < 700; ) {
        await new Promise(requestAnimationFrame);
        read();
    }
    return seen;
}"""
PLAYERS = [  # a scene, whose path glides; a picture, which appears over the one before
    ("06_alternation.ipynb", "svg polyline.estimate", "points"),
    ("03_pose_graph.ipynb", ".picture img", None),
]


@pytest.mark.parametrize("motion", ["no-preference", "reduce"])
@pytest.mark.parametrize(("lesson", "selector", "attribute"), PLAYERS)
def test_a_player_glides_unless_motion_is_unwelcome(chromium, tmp_path, lesson, selector, attribute, motion):
    path = tmp_path / "lesson.html"
    path.write_text(f"<!doctype html><meta charset='utf-8'>{committed(lesson)[0]}", "utf-8")
    context = new_context(chromium, viewport={"width": LAPTOP, "height": 900}, reduced_motion=motion)
    page = context.new_page()
    page.goto(path.as_uri())
    root = page.locator(EXPLORER).first
    root.get_by_role("button", name="step on").click()  # to a step after which the path moves
    page.wait_for_timeout(700)
    seen = page.evaluate(WATCH, [root.element_handle(), selector, attribute])
    context.close()
    passing = {each for each in seen if each not in (seen[0], seen[-1])}
    assert bool(passing) == (motion == "no-preference"), passing
    assert attribute is None or seen[0] != seen[-1]


@every_lesson
def test_the_page_can_be_read_on_a_phone_and_on_a_laptop(framed, request):
    page, explorers = framed
    for width in (PHONE, NARROW, LAPTOP):
        page.set_viewport_size({"width": width, "height": 900})
        assert page.evaluate("() => document.documentElement.scrollWidth <= innerWidth"), width
        assert page.locator("[data-index]").count() == 0, "nothing to drag where nothing answers"
        for explorer in explorers:
            picture = explorer.root.locator("figure :is(img, svg)")
            assert picture.bounding_box()["width"] > 0.6 * min(width, 600)
        if ALL_ARE_KEPT:
            number = request.node.callspec.params["framed"][:2]
            take_screenshot(page, SHOTS / f"frames_{number}_{width}.png")


@every_lesson
def test_axe_finds_nothing_serious_without_a_kernel(framed):
    assert violations(framed[0]) == []


@pytest.mark.parametrize("lesson", lessons_with_explorers())
def test_where_scripts_are_stripped_the_picture_stands(chromium, lesson):
    context = new_context(chromium, java_script_enabled=False)
    page = context.new_page()
    for piece in committed(lesson):
        page.set_content(f"<main>{piece}</main>")
        image, words = page.locator("main img"), page.locator("main p")
        assert image.get_attribute("alt") == words.text_content() != ""
        assert image.bounding_box()["height"] > 200
    context.close()


@pytest.mark.parametrize("lesson", sorted(path.name for path in (ROOT / "notebooks").glob("[0-9]*.ipynb")))
def test_no_lesson_is_heavier_than_its_budget(lesson):
    path = ROOT / "notebooks" / lesson
    assert path.stat().st_size < BUDGET
    for cell in nbformat.read(path, as_version=4).cells:
        for output in cell.get("outputs", []):
            data = output.get("data", {})
            assert not ("text/html" in data and any("widget-view" in kind for kind in data)), "two for one"
