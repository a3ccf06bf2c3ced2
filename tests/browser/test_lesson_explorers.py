"""The explorers of every lesson in a real JupyterLab, with the kernel that answers them.

Of each lesson runs what its explorers depend on, in a single notebook that all tests look at. The times from key press
to changed pixels are left in ``build/latency.md``; they are reported here and asserted nowhere, because they are those
of a machine that runs other tests too (``python tests/browser/latency.py`` measures alone).
"""

import itertools
import re

import memory
import pytest
from axe import violations
from explorers import EXPLORER, attributes_of, explorers_of, led, lessons_with_explorers, open_explorers, pictures
from lab_server import ROOT, new_context
from latency import Row, table
from matplotlib import pyplot
from rings import ring_of
from window import ALL_ARE_KEPT, LAPTOP, NARROW, PROJECTOR, Window

from npslam_teach.system.files import atomic_write

BUILD = ROOT / "build"
PRESSES, MORE_PRESSES = (
    2,
    20,
)  # of a key, in each direction; ``test_frames`` presses more, where no kernel has to answer


@pytest.fixture(scope="module")
def notebook(chromium, lab):
    """(page, explorers by lesson): those of all lessons, in one notebook and on one kernel."""
    context = new_context(chromium, viewport={"width": LAPTOP, "height": 1000}, reduced_motion="reduce")
    page = context.new_page()
    yield page, open_explorers(page, lab, "explorers.ipynb", lessons_with_explorers())
    context.close()


@pytest.fixture
def page(notebook):
    return notebook[0]


@pytest.fixture
def explorers(lesson, notebook):
    """The explorers of a lesson, each with its twin."""
    assert notebook[1][lesson]
    return notebook[1][lesson]


@pytest.fixture(scope="module")
def latencies():
    """Rows of the table of latencies, written when all lessons are done."""
    rows = []
    yield rows
    BUILD.mkdir(exist_ok=True)
    with atomic_write(BUILD / "latency.md") as stream:
        stream.write(table(rows))


every_lesson = pytest.mark.parametrize("lesson", lessons_with_explorers())


@every_lesson
def test_explorers_follow_the_keys_and_tell_what_the_library_tells(lesson, explorers, latencies):
    for explorer in explorers:
        for control in explorer.controls:
            shown = explorer.walk(control, PRESSES, MORE_PRESSES)  # the next values may have the same picture
            assert len({each["words"] for each in shown}) >= 2
            assert len(pictures(shown)) >= 2
            latencies.append(Row(lesson, control.twin.description, tuple(explorer.latencies())))


@every_lesson
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


@every_lesson
def test_a_screen_reader_finds_the_name_of_every_control(explorers):
    """In the accessibility tree of the browser, not in our attributes."""
    for explorer in explorers:
        names = explorer.names_in_the_accessibility_tree()
        for control in explorer.controls:
            assert ("combobox" if control.is_list else "slider", control.twin.description) in names
        if explorer.twin.figure is not None:
            assert ("image", explorer.picture()["words"]) in names
        assert not [role for role, name in names if role in ("slider", "combobox", "button", "textbox") and not name]


@every_lesson
def test_controls_are_reached_one_after_the_other_by_tab(page, explorers):
    for explorer in explorers:
        handles = [control.locator.element_handle() for control in explorer.controls]
        handles[0].focus()
        for handle in handles[1:]:
            for _ in range(5):  # from a slider to its number and its buttons, from there to the next control
                page.keyboard.press("Tab")
                if handle.evaluate("each => each === document.activeElement"):
                    break
            assert handle.evaluate("each => each === document.activeElement")


def test_axe_finds_nothing_serious_in_running_explorers(page):
    assert violations(page, EXPLORER) == []


@pytest.mark.parametrize("width", [LAPTOP, NARROW, PROJECTOR])
def test_no_explorer_is_cut_off(page, width):
    with Window(page, width) as window:
        complaints = window.complaints()
        if complaints or ALL_ARE_KEPT:
            window.screenshot(BUILD / "screenshots" / f"explorers_{width}.png")
    assert complaints == []


# --- a class plays with a slider for an hour -------------------------------------------------------------------------


@every_lesson
def test_steps_leave_nothing_behind_in_python(lesson):
    for explorer in explorers_of(lesson):
        moves = memory.to_and_fro(explorer)
        for move in itertools.islice(moves, memory.WARM_UP):
            explorer.move(**move)
        before, figures = memory.number_of_artists(explorer), pyplot.get_fignums()
        growth = memory.growth_in_python(moves, explorer)
        assert pyplot.get_fignums() == figures == []
        assert abs(memory.number_of_artists(explorer) - before) < 100  # another value may need another few
        assert growth < memory.BYTES_PER_STEP, f"{growth / 1e3:.1f} kB a step"


def test_a_leak_is_noticed(monkeypatch):
    """One picture a step that somebody keeps."""
    monkeypatch.setattr(memory, "ROUNDS", (12, 30))
    explorer, kept = explorers_of("04_dirichlet_process.ipynb")[0], []
    move = explorer.move

    class Leaking:
        def move(self, **values):
            move(**values)
            kept.append(bytes(60_000))

    assert memory.growth_in_python(memory.to_and_fro(explorer), Leaking()) > memory.BYTES_PER_STEP


@pytest.mark.parametrize("lesson", ["04_dirichlet_process.ipynb", "07_fifteen_objects.ipynb"])
def test_key_presses_leave_nothing_behind_in_a_page(explorers, notebook, lab, record_property):
    """In a toy, and where the whole method runs at every step."""
    page, all_explorers = notebook
    growth = memory.growth_in_a_page(explorers[0], memory.kernel_of(lab, "explorers.ipynb"))
    record_property("growth", growth)
    assert all(value < memory.LIMITS[name] for name, value in growth.items()), growth
    assert page.locator(f"{EXPLORER} figure").count() == sum(map(len, all_explorers.values()))


# --- rings and points ------------------------------------------------------------------------------------------------


def a_way(ring, twin):
    """Of a ring's stops one that changes something, and what its controls are set to then."""
    for x, y, *told in sorted(ring.stops, key=lambda stop: -abs(stop[0] - ring.xy[0]) - abs(stop[1] - ring.xy[1])):
        wanted = {}
        for name, value in zip(ring.moves, told, strict=True):
            control = twin.sliders[name]
            if value in "<>":
                value = control.value + control.step * (1 if value == ">" else -1)
            wanted[name] = control.from_page(int(float(value)) if hasattr(control, "options") else float(value))
        if any(twin.sliders[name].value != value for name, value in wanted.items()):
            return (x, y), wanted
    raise AssertionError("nothing can be led anywhere")


@pytest.mark.parametrize("lesson", ["01_why_association", "02_drift", "05_class_votes", "09_filtering"])
def test_rings_are_led_with_the_mouse_and_pressed_with_keys(lesson, notebook):
    """The kernel's answer is the library's for what the ring has asked for."""
    page, shown = notebook
    for explorer in shown[f"{lesson}.ipynb"]:
        for locator in explorer.root.locator("[data-stops]").all()[:2]:
            locator.scroll_into_view_if_needed()
            explorer.twin.move(**explorer.values())
            place, wanted = a_way(ring_of(attributes_of(locator)), explorer.twin)
            led(page, locator, [place], "mouse")
            explorer.wait_for_answer()
            assert explorer.values().items() >= wanted.items()
            assert explorer.picture() == explorer.expected()
            told = {explorer.picture()["words"]}
            for key in ("ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown", "Enter"):
                locator.press(key)
                explorer.wait_for_answer()
                told.add(explorer.picture()["words"])
            assert len(told) > 1
            assert explorer.picture() == explorer.expected()


def test_a_sighting_is_led_across_the_gates(notebook):
    page, (gates,) = notebook[0], notebook[1]["09_filtering.ipynb"]
    gates.root.locator("[data-control=pose]").press("Home")
    for _ in range(4):
        gates.root.locator("[data-control=pose]").press("ArrowRight")
    gates.wait_for_answer()
    handle = gates.root.locator("[data-index]").first
    handle.scroll_into_view_if_needed()
    before, begin = gates.picture()["words"], attributes_of(handle)
    led(page, handle, [(float(begin["cx"]) + 150, float(begin["cy"]) - 60)], "mouse")
    gates.wait("root.querySelector('figcaption').textContent !== known", before, "nothing follows")
    page.wait_for_timeout(300)
    xy = gates.twin.sliders["xy"].value.copy()
    label = attributes_of(handle)["aria-label"]
    xy[int(begin["data-index"])] = [float(number) for number in re.findall(r"(-?[\d.]+) m", label)]
    assert gates.picture()["words"] == gates.twin.move(**gates.values(), xy=xy) != before


# --- springs ---------------------------------------------------------------------------------------------------------


def chi2_of(words: str) -> float:
    return float(re.search(r"chi2 is ([\d.]+)\.", words).group(1))


@pytest.mark.parametrize("hand", ["mouse", "keys"])
def test_a_pose_is_pulled_by_hand_and_the_solver_takes_it_back(notebook, hand):
    """Last, because the poses are left where the hand has put them."""
    page, springs = notebook[0], notebook[1]["03_pose_graph.ipynb"][0]
    handle = springs.root.locator("[data-index='2']")
    at_rest = chi2_of(springs.twin.move(iteration=6))
    if hand == "mouse":
        handle.hover()  # waits until the page is at rest
        box = handle.bounding_box()
        page.mouse.down()
        page.mouse.move(box["x"] + 60, box["y"] + 60)
    else:
        handle.focus()
        for _ in range(4):
            page.keyboard.down("ArrowUp")
    caption = "root.querySelector('figcaption').textContent"
    chi2 = f"Number({caption}.match(/chi2 is ([\\d.]+)\\./)[1])"
    springs.wait(f"{caption}.startsWith(known) && {chi2} > 10", "As it is held", "no spring is stretched")
    held = chi2_of(springs.picture()["words"])
    page.mouse.up() if hand == "mouse" else page.keyboard.up("ArrowUp")
    springs.wait(f"{caption}.includes(known)", "After step 6", "nobody has let go")
    assert chi2_of(springs.picture()["words"]) == at_rest < held
