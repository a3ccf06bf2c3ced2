"""Progress bars: one, on a terminal, where it is wanted; otherwise no output at all."""

import contextlib
import io

import pytest

from npslam_teach import simulate
from npslam_teach.experiments import run_method
from npslam_teach.methods import METHODS
from npslam_teach.system import progress


class Terminal(io.StringIO):
    def isatty(self):
        return True


class Pipe(io.StringIO):
    pass


@pytest.fixture(autouse=True)
def at_once(monkeypatch):
    """Bars without their usual delay."""
    monkeypatch.setattr(progress, "DELAY", 0)


@contextlib.contextmanager
def written_to(stream, wanted=True):
    """What is written to standard error. Called in the test, because pytest replaces the stream after every fixture."""
    with contextlib.redirect_stderr(stream), progress.progress_shown() if wanted else contextlib.nullcontext():
        yield stream


def walk(inner=3):
    return [[*progress.track(range(inner), inner, "inner", "steps")] for _ in progress.track(range(2), 2, "outer", "x")]


def test_a_terminal_shows_the_outermost_loop():
    with written_to(Terminal()) as stderr:
        assert walk() == [[0, 1, 2]] * 2
    assert "outer" in stderr.getvalue() and "inner" not in stderr.getvalue()
    assert stderr.getvalue().endswith("\r"), "the bar is wiped away"


def test_a_loop_of_one_step_leaves_the_bar_to_the_loop_inside():
    with written_to(Terminal()) as stderr:
        for _ in progress.track(range(1), 1, "outer", "x"):
            list(progress.track(range(3), 3, "inner", "steps"))
    assert "inner" in stderr.getvalue() and "outer" not in stderr.getvalue()


def test_a_library_stays_silent():
    with written_to(Terminal(), wanted=False) as stderr:
        assert walk() == [[0, 1, 2]] * 2
    assert stderr.getvalue() == ""


def test_what_is_no_terminal_gets_nothing():
    with written_to(Pipe()) as stderr:
        walk()
    assert stderr.getvalue() == ""


def test_a_loop_that_is_left_early_gives_the_bar_back():
    with written_to(Terminal()) as stderr:
        next(progress.track(range(5), 5, "first", "steps"))
        list(progress.track(range(5), 5, "second", "steps"))
    assert "second" in stderr.getvalue()


COUNTS = {
    "np-graph": "iterations",
    "ekf": "frames",
    "open-loop": "blocks",
    "robust-slam": "observations",
    "frame-by-frame": None,
    "posterior": "searches",
    "soft-em": "iterations",
    "online": "frames",
}


@pytest.mark.parametrize("method", METHODS)
def test_a_method_counts_what_takes_its_time(method):
    log, _ = simulate.toy_objects()
    with written_to(Terminal()) as stderr:
        run_method(method, log, {})
    unit = COUNTS[method]
    assert f"{method}: " in stderr.getvalue() and f" {unit}/s" in stderr.getvalue() if unit else not stderr.getvalue()
