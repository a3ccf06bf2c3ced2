"""An explorer in a real JupyterLab: who owns the state, and what the hand does."""

import re

import numpy as np
import pytest
from axe import violations
from explorers import EXPLORER, Shown
from lab_server import POLLING, new_context, open_notebook, run_all_cells, saved, timeout_error, write_notebook

from npslam_teach.course.dirichlet_process.explorer import explore_association

MAKE = "from npslam_teach.course.dirichlet_process.explorer import explore_association\n"
MAKE += "explorer = explore_association()\nexplorer"
LOOP = "for width in (0.9, 0.3, 0.6, 0.354):\n    explorer.move(kernel_std=width)\n"
LOOP += "for alpha in (1.2, 0.8, 0.2):\n    explorer.sliders['alpha'].value = alpha\nprint(explorer.words)"
KEYS_PER_SECOND, KEYS = 30, 24


@pytest.fixture(scope="module")
def window(chromium):
    context = new_context(chromium, viewport={"width": 1280, "height": 1000}, reduced_motion="reduce", has_touch=True)
    yield context
    context.close()


@pytest.fixture(scope="module")
def live(window, lab):
    """(page, explorer): made, and moved by a loop of code, in one Run All."""
    write_notebook(lab.folder / "notebooks" / "loop.ipynb", MAKE, LOOP)
    page = window.new_page()
    open_notebook(page, lab, "loop.ipynb")
    run_all_cells(page)
    yield page, Shown(page, 0, explore_association())
    page.close()


def shown_words(page, number=0) -> str:
    return page.locator(f"{EXPLORER} figcaption").nth(number).text_content()


def fields(shown: Shown) -> dict:
    return {each.name: each.readout.input_value() for each in shown.controls if not each.is_list}


def test_a_loop_of_moves_ends_where_its_last_one_ends(live, lab):
    page, shown = live
    printed = saved(page, lab, "loop.ipynb").cells[1].outputs[0].text.strip()
    page.wait_for_function(
        "words => document.querySelector('figcaption').textContent === words", arg=printed, polling=POLLING
    )
    assert fields(shown) == {"alpha": "0.20", "threshold": "0.00", "kernel_std": "0.354"}
    twin = explore_association()
    assert twin.move(alpha=0.2, kernel_std=0.354) == printed
    page.wait_for_timeout(1500)  # an echo that comes late would come now
    assert shown_words(page) == printed and fields(shown)["kernel_std"] == "0.354"


def test_held_keys_end_at_the_last_one(live):
    page, shown = live
    alpha = next(each for each in shown.controls if each.name == "alpha")
    alpha.locator.focus()
    before = alpha.index()
    for key, by in (("ArrowRight", 1), ("ArrowLeft", -1)):
        for _ in range(KEYS):
            page.keyboard.press(key)
            page.wait_for_timeout(1000 / KEYS_PER_SECOND)
        place = min(before + by * KEYS, len(alpha.values()) - 1)
        value = alpha.values()[place]
        page.wait_for_function(
            "([field, value]) => document.querySelector('figcaption').textContent.includes(`alpha ${value} `)",
            arg=[None, f"{value:.2f}"],
            polling=POLLING,
        )
        assert alpha.index() == place and float(alpha.readout.input_value()) == value
        before = place


def test_a_typed_number_is_taken_as_it_is(live):
    page, shown = live
    width = next(each for each in shown.controls if each.name == "kernel_std")
    width.readout.fill("0.333")
    width.readout.press("Enter")
    twin = shown.twin
    words = twin.move(alpha=float(fields(shown)["alpha"]), kernel_std=0.333)
    page.wait_for_function(
        "words => document.querySelector('figcaption').textContent === words", arg=words, polling=POLLING
    )
    assert width.readout.input_value() == "0.333"
    width.readout.fill("far")
    width.readout.press("Enter")
    assert width.readout.input_value() == "0.333"


def place_of(page, number: int) -> np.ndarray:
    """The centre of a handle on the screen, px."""
    box = page.locator(f"{EXPLORER} [data-index='{number}']").bounding_box()
    return np.array([box["x"] + box["width"] / 2, box["y"] + box["height"] / 2])


def xy_of(page, number: int) -> np.ndarray:
    """Where the accessible name says that a sighting is, m."""
    label = page.locator(f"{EXPLORER} [data-index='{number}']").get_attribute("aria-label")
    return np.array(re.findall(r"(-?\d+\.\d+) m", label), dtype=float)


def wait_until_at(page, number: int, xy, within: float = 0.015) -> None:
    """Wait until the kernel says that a sighting is there, m; a pixel is a hundredth of a metre."""
    try:
        page.wait_for_function(
            """([number, xy, within]) => {
                const label = document.querySelector(`[data-index="${number}"]`).getAttribute("aria-label");
                return [...label.matchAll(/(-?[\\d.]+) m/g)].every((each, k) => Math.abs(each[1] - xy[k]) <= within);
            }""",
            arg=[number, list(xy), within],
            timeout=30_000,
            polling=POLLING,
        )
    except timeout_error():
        raise AssertionError(f"expected {xy}, got {xy_of(page, number)}: {shown_words(page)}") from None


def px_per_metre(page) -> float:
    """Along x, on the screen."""
    between = place_of(page, 5) - place_of(page, 4), xy_of(page, 5) - xy_of(page, 4)
    return between[0][0] / between[1][0]


def test_a_sighting_is_dragged_with_the_mouse(live):
    page, _ = live
    page.locator(EXPLORER).scroll_into_view_if_needed()
    begin, start, scale = place_of(page, 4), xy_of(page, 4), px_per_metre(page)
    page.mouse.move(*begin)
    page.mouse.down()
    for share in (0.25, 0.5, 0.75, 1.0):
        page.mouse.move(*(begin + share * scale * np.array([1.0, -0.5])))
    page.mouse.up()
    wait_until_at(page, 4, start + (1.0, 0.5))
    assert np.allclose(place_of(page, 4), begin + scale * np.array([1.0, -0.5]), atol=2)
    weights = re.search(r"Obj_2 ([\d.]+)", shown_words(page))
    assert weights is None or float(weights.group(1)) < 0.05


def test_a_sighting_is_moved_with_the_arrow_keys_and_the_notebook_is_not(live):
    page, _ = live
    start = xy_of(page, 4)
    page.locator(f"{EXPLORER} [data-index='4']").focus()
    selected = "() => [...document.querySelectorAll('.jp-Cell')].findIndex((each) => each.matches('.jp-mod-active'))"
    before = page.evaluate(selected)
    for key in ("ArrowLeft", "ArrowLeft", "ArrowDown", "Shift+ArrowUp"):
        page.keyboard.press(key)
    wait_until_at(page, 4, start + (-0.1, 0.2))
    assert page.evaluate(selected) == before
    assert page.evaluate("() => document.activeElement.dataset.index") == "4", "the focus stays on it"


def test_a_sighting_is_dragged_with_a_finger(live, window):
    page, _ = live
    begin, start, scale = place_of(page, 6), xy_of(page, 6), px_per_metre(page)
    session = window.new_cdp_session(page)
    for kind, share in (("touchStart", 0.0), ("touchMove", 0.5), ("touchMove", 1.0), ("touchEnd", None)):
        points = [] if share is None else [{"x": begin[0] + share * scale * 0.5, "y": begin[1]}]
        session.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
    wait_until_at(page, 6, start + (0.5, 0.0))


def test_axe_finds_nothing_serious_in_a_scene(live):
    assert violations(live[0], EXPLORER) == []
