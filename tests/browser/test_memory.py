"""A class plays with a slider for an hour: neither the page nor the kernel may grow with every step.

Whether a page shows what the library says is the business of ``test_lessons``.
"""

import gc
import itertools
import os
import sys
import tracemalloc
from pathlib import Path

import psutil
import pytest
from explorers import explorers_of, lessons_with_explorers, open_explorers
from matplotlib import pyplot

from npslam_teach.course.controls import Places
from npslam_teach.pose_graph import factorization

# A few steps show that nothing stays. Only where something has grown, which may be a store that fills, more decide.
WARM_UP, ROUNDS = 20, (12, 60, 200)
TRACED_WARM_UP = 4  # after so many the present picture is one that was made while memory was traced
# qdldl frees arrays behind tracemalloc's back, which goes on listing some of them; a process that updates a factor a
# hundred thousand times does not grow by a kilobyte.
NOT_QDLDL = tracemalloc.Filter(False, factorization.__file__)
BYTES_PER_STEP = 10_000  # a picture is about 60 kB
# In a page a picture is text, and a third more; two nodes and one listener a step are hundreds after an hour.
LIMITS = {"heap": 20_000, "kernel": 40_000, "nodes": 2, "listeners": 1}
LESSONS_IN_A_PAGE = ("04_dirichlet_process.ipynb", "07_fifteen_objects.ipynb")  # a toy; the whole method at every step


def number_of_artists(explorer) -> int:
    return len(explorer.figure.findobj() if explorer.figure else explorer.scene.parts)


def to_and_fro(explorer):
    """Moves of every control in turn, through its whole range and back, for ever."""
    controls = {name: each for name, each in explorer.sliders.items() if not isinstance(each, Places)}
    for name, control in itertools.cycle(controls.items()):
        values = control.grid()
        values = values[:: 1 + len(values) // 10]
        for value in values + values[-2::-1]:
            yield {name: value}


def growth_in_python(moves, explorer) -> float:
    """How many bytes a step leaves behind."""
    for steps in ROUNDS:
        tracemalloc.start()
        try:
            before = traced_after(itertools.islice(moves, TRACED_WARM_UP), explorer)
            growth = (traced_after(itertools.islice(moves, steps), explorer) - before) / steps
        finally:
            tracemalloc.stop()
        if growth < BYTES_PER_STEP:
            break
    return growth


def traced_after(moves, explorer) -> int:
    """How many bytes that were taken since tracing began are still held after some moves."""
    for move in moves:
        explorer.move(**move)
    gc.collect()
    return sum(trace.size for trace in tracemalloc.take_snapshot().filter_traces([NOT_QDLDL]).traces)


@pytest.mark.parametrize("lesson", lessons_with_explorers())
def test_steps_leave_nothing_behind_in_python(lesson):
    for explorer in explorers_of(lesson):
        moves = to_and_fro(explorer)
        for move in itertools.islice(moves, WARM_UP):
            explorer.move(**move)
        before, figures = number_of_artists(explorer), pyplot.get_fignums()
        growth = growth_in_python(moves, explorer)
        assert pyplot.get_fignums() == figures == []
        assert abs(number_of_artists(explorer) - before) < 100  # another value may need another few
        assert growth < BYTES_PER_STEP, f"{growth / 1e3:.1f} kB a step"


def test_a_leak_is_noticed(monkeypatch):
    """One picture a step that somebody keeps."""
    monkeypatch.setattr(sys.modules[__name__], "ROUNDS", (12, 30))
    explorer, kept = explorers_of("04_dirichlet_process.ipynb")[0], []
    move = explorer.move

    class Leaking:
        def move(self, **values):
            move(**values)
            kept.append(bytes(60_000))

    assert growth_in_python(to_and_fro(explorer), Leaking()) > BYTES_PER_STEP


def kernels_of(folder: Path) -> list[psutil.Process]:
    """The kernels that a JupyterLab has started in a folder."""
    found = []
    for process in psutil.process_iter(["cmdline", "cwd"]):
        command, cwd = process.info["cmdline"] or [], process.info["cwd"] or ""
        if any("ipykernel" in word for word in command) and Path(cwd).is_relative_to(os.path.realpath(folder)):
            found.append(process)
    return found


class Footprint:
    """What a page and its kernel hold."""

    def __init__(self, page, kernel: psutil.Process):
        session = page.context.new_cdp_session(page)
        for _ in range(2):  # what the first collection finalises the second one frees
            session.send("HeapProfiler.collectGarbage")
        self.heap = session.send("Runtime.getHeapUsage")["usedSize"]
        self.nodes = session.send("Memory.getDOMCounters")["nodes"]
        self.listeners = session.send("Memory.getDOMCounters")["jsEventListeners"]
        self.kernel = kernel.memory_info().rss
        session.detach()


@pytest.mark.parametrize("lesson", LESSONS_IN_A_PAGE)
def test_key_presses_leave_nothing_behind_in_a_page(lesson, page, lab, record_property):
    known = {kernel.pid for kernel in kernels_of(lab.folder)}
    explorer = open_explorers(page, lab, f"memory_{lesson}", [lesson])[lesson][0]
    (kernel,) = (each for each in kernels_of(lab.folder) if each.pid not in known)
    slider = next(control for control in explorer.controls if not control.is_list)

    def press(times: int) -> None:
        """Step by step, from one end of the slider to the other and back."""
        forward = slider.index() < len(slider.values()) - 1
        for _ in range(times):
            if slider.index() in (0, len(slider.values()) - 1):
                forward = slider.index() == 0
            explorer.press(slider, forward)

    press(WARM_UP)
    for steps in ROUNDS:
        before = Footprint(page, kernel)
        press(steps)
        after = Footprint(page, kernel)
        growth = {name: (value - vars(before)[name]) / steps for name, value in vars(after).items()}
        too_much = {name: value for name, value in growth.items() if value >= LIMITS[name]}
        if not too_much:
            break
    record_property("growth", growth)
    assert not too_much, growth
    assert page.locator(".npslam-explorer figure").count() == len(explorers_of(lesson))
