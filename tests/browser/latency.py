"""How long from a key press to changed pixels, for every control of every explorer, as a table.

``python tests/browser/latency.py`` measures on a machine that does nothing else, prints the table, and exits with 1
where a median is above its budget: 100 ms, or 250 ms where a slider runs the whole method on fifteen objects anew.
"""

import math
import statistics
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

TESTS = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TESTS.parent), str(TESTS / "helpers")]  # as in tests; the package, where only the checkout has it

from explorers import Shown, ShownControl, lessons_with_explorers, open_explorers  # noqa: E402
from lab_server import (  # noqa: E402
    LARGE_WINDOW,
    copy_of_the_course,
    running_chromium,
    running_lab,
)

BUDGET, BUDGET_OF_A_RUN = 100, 250  # ms, of the median
KEYS_PER_SECOND = 30  # of a key that is held
RUNS_THE_METHOD = ("07_fifteen_objects.ipynb",)


@dataclass(frozen=True)
class Row:
    """A line of the table: times of one control, in ms."""

    lesson: str
    control: str
    milliseconds: tuple[float, ...]
    held: float = math.nan  # ms from the last of many keys to the last picture

    @property
    def budget(self) -> int:
        return BUDGET_OF_A_RUN if self.lesson in RUNS_THE_METHOD else BUDGET

    @property
    def median(self) -> float:
        return statistics.median(self.milliseconds)

    def __str__(self) -> str:
        times = f"{len(self.milliseconds)} | {self.median:.0f} | {max(self.milliseconds):.0f} | {self.held:.0f}"
        return f"| {self.lesson.split('.')[0]} | {self.control} | {times} | {self.budget} |"


def table(rows: list[Row]) -> str:
    """Markdown."""
    head = ["| lesson | control | key presses | median (ms) | worst (ms) | held (ms) | budget of the median (ms) |"]
    return "\n".join([*head, "|---|---|---|---|---|---|---|", *map(str, rows), ""])


def measure(page, lab, presses: int) -> list[Row]:
    """Press the arrow keys of every control of every explorer, at most so often each way."""
    rows = []
    for lesson, explorers in open_explorers(page, lab, "latency.ipynb", lessons_with_explorers()).items():
        for explorer in explorers:
            for control in explorer.controls:
                times = []
                while len(times) < presses:  # a list of two has a single step each way
                    explorer.walk(control, presses, presses)
                    times += explorer.latencies()
                rows.append(Row(lesson, control.twin.description, tuple(times), held(explorer, control)))
    return rows


def held(explorer: Shown, control: ShownControl) -> float:
    """Hold an arrow key down for a second; milliseconds from its last repetition to the picture of where it ends.

    The control is put back, because the next one may do nothing at the end of this one.
    """
    before, last = control.index(), len(control.values()) - 1
    forward = before < last / 2
    control.locator.focus()
    for _ in range(KEYS_PER_SECOND):
        explorer.page.keyboard.press(control.key(forward))
        explorer.page.wait_for_timeout(1000 / KEYS_PER_SECOND)
    explorer.wait_for_answer()
    lag = explorer.latencies()[-1]
    for _ in range(abs(control.index() - before)):
        control.locator.press(control.key(not forward))
    explorer.wait_for_answer()
    explorer.latencies()
    return lag


def main(presses: int = 12) -> int:
    """Measure every lesson; the exit code says whether all keep to their budgets."""
    with tempfile.TemporaryDirectory() as folder:
        course, settings = Path(folder, "course"), Path(folder, "jupyter")
        settings.mkdir()
        with running_lab(copy_of_the_course(course), settings) as lab, running_chromium() as browser:
            context = browser.new_context(viewport=LARGE_WINDOW, reduced_motion="reduce")
            rows = measure(context.new_page(), lab, presses)
            context.close()
    print(table(rows))
    return 0 if all(row.median <= row.budget for row in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
