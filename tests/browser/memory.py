"""How much a step of an explorer leaves behind, in a process and in a page: a class plays with a slider for an hour."""

import contextlib
import ctypes
import gc
import itertools
import json
import sys
import tracemalloc
import urllib.request

import psutil
from explorers import Shown, ShownControl
from lab_server import Lab

from npslam_teach.course.controls import Places
from npslam_teach.pose_graph import factorization

# A few steps show that nothing stays. Only where something has grown, which may be a store that fills, more decide.
WARM_UP, PRESSED_WARM_UP, ROUNDS = 20, 10, (12, 60, 200)
TRACED_WARM_UP = 4  # after so many the present picture is one that was made while memory was counted
# qdldl frees arrays behind tracemalloc's back, which goes on listing some of them; a process that updates a factor a
# hundred thousand times does not grow by a kilobyte.
NOT_QDLDL = tracemalloc.Filter(False, factorization.__file__)
BYTES_PER_STEP = 10_000  # a picture is about 60 kB
# In a page a picture is text, and a third more; two nodes and one listener a step are hundreds after an hour.
LIMITS = {"heap": 20_000, "kernel": 40_000, "nodes": 2, "listeners": 1}


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
    """How many bytes a step leaves behind, in that half of some steps that leaves more: what is freed once hides none.

    Counting is the system's own where it can say what is allocated, because tracing takes four times as long.
    """
    count, counting = (_allocated, contextlib.nullcontext) if hasattr(LIBC, "mallinfo2") else (_traced, tracing)
    for steps in ROUNDS:
        with counting(), _only_what_comes_is_collected():
            held = [_held_after(itertools.islice(moves, few), explorer, count) for few in (TRACED_WARM_UP, steps // 2)]
            held.append(_held_after(itertools.islice(moves, steps // 2), explorer, count))
        growth = max(after - before for before, after in itertools.pairwise(held)) / (steps // 2)
        if growth < BYTES_PER_STEP:
            break
    return growth


def _held_after(moves, explorer, count) -> int:
    """How many bytes are held after some moves."""
    for move in moves:
        explorer.move(**move)
    gc.collect()
    return count()


@contextlib.contextmanager
def _only_what_comes_is_collected():
    """Within this block: to look through all that a process of tests holds takes longer than some steps."""
    gc.collect()
    gc.freeze()
    try:
        yield
    finally:
        gc.unfreeze()


LIBC = ctypes.CDLL(None) if sys.platform.startswith("linux") else None
LARGEST_BLOCK = 512  # bytes, of what Python's own allocator hands out; what is larger comes from malloc


class _Malloc(ctypes.Structure):
    """``struct mallinfo2`` of glibc."""

    _fields_ = [
        (name, ctypes.c_size_t)
        for name in "arena ordblks smblks hblks hblkhd usmblks fsmblks uordblks fordblks keepcost".split()
    ]


def _allocated() -> int:
    """Bytes that are allocated now, a small object counted as a large one."""
    LIBC.mallinfo2.restype = _Malloc
    malloc = LIBC.mallinfo2()
    return malloc.uordblks + malloc.hblkhd + LARGEST_BLOCK * sys.getallocatedblocks()


@contextlib.contextmanager
def tracing():
    """Within this block memory is traced."""
    tracemalloc.start()
    try:
        yield
    finally:
        tracemalloc.stop()


def _traced() -> int:
    """Bytes that were taken since tracing began and are still held."""
    return sum(trace.size for trace in tracemalloc.take_snapshot().filter_traces([NOT_QDLDL]).traces)


def kernel_of(lab: Lab, name: str) -> psutil.Process:
    """The kernel of an open notebook; other notebooks of the same JupyterLab may have theirs."""
    with urllib.request.urlopen(f"{lab.address}/api/sessions?token={lab.token}", timeout=20) as answer:
        (own,) = [each["kernel"]["id"] for each in json.load(answer) if each["name"] == name]
    processes = psutil.process_iter(["cmdline"])
    (kernel,) = [each for each in processes if any(own in word for word in each.info["cmdline"] or [])]
    return kernel


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


def press(explorer: Shown, slider: ShownControl, times: int) -> None:
    """Step by step, from one end of the slider to the other and back."""
    last = len(slider.values()) - 1
    forward = slider.index() < last
    for _ in range(times):
        if slider.index() in (0, last):
            forward = slider.index() == 0
        explorer.press(slider, forward)


def growth_in_a_page(explorer: Shown, kernel: psutil.Process) -> dict[str, float]:
    """By what a page and its kernel grow with a step of the first slider, which begins to warm up."""
    slider = next(control for control in explorer.controls if not control.is_list)
    press(explorer, slider, PRESSED_WARM_UP)
    for steps in ROUNDS:
        before = Footprint(explorer.page, kernel)
        press(explorer, slider, steps)
        after = Footprint(explorer.page, kernel)
        growth = {name: (value - vars(before)[name]) / steps for name, value in vars(after).items()}
        if all(value < LIMITS[name] for name, value in growth.items()):
            break
    return growth
