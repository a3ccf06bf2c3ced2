"""How long from ``python3 -m npslam_teach lab`` to the first picture of the first lesson in a browser, as a table.

``python tests/browser/first_picture.py`` clones the course as it is committed and starts it twice: cold, as after an
installation, with nothing in the browser's store and nothing compiled of the course; and warm, in the same folders
again. It exits with 1 where a start takes longer than its budget, which holds for two cores that do nothing else;
processor seconds are printed beside it, because they say most of the same where a machine is shared.
"""

import contextlib
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

TESTS = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TESTS.parent), str(TESTS / "helpers")]  # as in tests; the package, where only the checkout has it

import psutil  # noqa: E402
from explorers import EXPLORER  # noqa: E402
from lab_process import running_lab  # noqa: E402
from lab_server import LARGE_WINDOW, ROOT, how_chromium_starts, wait_until_idle  # noqa: E402

BUDGET = 10.0  # s, of the wall clock
PICTURE = f"""() => [...document.querySelectorAll(".jp-Notebook {EXPLORER} figure :is(img, svg)")].some(
    (each) => each.getBoundingClientRect().height > 100)"""


@dataclass(frozen=True)
class Row:
    """A line of the table, in s: of the wall clock and of the processors, for the server and then for the page."""

    start: str
    server: float
    page: float
    server_processor: float
    page_processor: float

    @property
    def together(self) -> float:
        return self.server + self.page

    def __str__(self) -> str:
        times = (self.server, self.page, self.together, self.server_processor, self.page_processor)
        return f"| {self.start} | " + " | ".join(f"{each:.1f}" for each in times) + " |"


def table(rows: list[Row]) -> str:
    """Markdown."""
    head = "| start | until it listens (s) | until the picture (s) | together (s) | processor: server (s) | page (s) |"
    return "\n".join([head, "|---|---|---|---|---|---|", *map(str, rows), ""])


def processor_seconds(processes: list[psutil.Process]) -> float:
    """Of these and of their children that have ended."""
    total = 0.0
    for process in processes:
        with contextlib.suppress(psutil.NoSuchProcess):
            total += sum(process.cpu_times()[:4])
    return total


def tree(process: psutil.Process) -> list[psutil.Process]:
    """A process and all below it."""
    return [process, *process.children(recursive=True)]


@contextlib.contextmanager
def running_browser(profile: Path) -> Iterator:
    """A page of a Chromium that keeps what it fetches in a folder."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        context = playwright.chromium.launch_persistent_context(profile, viewport=LARGE_WINDOW, **how_chromium_starts())
        yield context.pages[0]
        context.close()


def measure(start: str, course: Path, folder: Path) -> Row:
    """Start the course, open the address that it prints, and wait for a picture.

    Args:
        start: what this start is called.
        course: a clone.
        folder: of Jupyter's own files and of the browser's.
    """
    own = {f"JUPYTER_{name}_DIR": str(folder / name.lower()) for name in ("CONFIG", "DATA", "RUNTIME")}
    begin = time.monotonic()
    with running_lab(course, folder / "lab.log", own | {"IPYTHONDIR": str(folder / "ipython")}) as lab:
        listens = time.monotonic()
        server = psutil.Process(lab.process.pid)
        with running_browser(folder / "browser") as page:
            opened = time.monotonic()
            page.goto(lab.address, wait_until="commit")
            page.wait_for_function(PICTURE, polling=50, timeout=120_000)
            shown = time.monotonic()
            below = tree(server)
            page_processes = [each for each in tree(psutil.Process()) if each not in below]
            used = processor_seconds(below), processor_seconds(page_processes[1:])
            wait_until_idle(page)  # a server whose kernel is just being made does not end when it is asked to
    return Row(start, listens - begin, shown - opened, *used)


def main() -> int:
    """Measure both starts; the exit code says whether they keep to the budget."""
    os.environ.pop("PYTHONPATH", None)
    with tempfile.TemporaryDirectory() as temporary:
        course, folder = Path(temporary, "course"), Path(temporary, "own")
        folder.mkdir()
        subprocess.run(["git", "clone", "--quiet", str(ROOT), str(course)], check=True)
        rows = [measure(start, course, folder) for start in ("cold", "warm")]
    print(table(rows))
    return 0 if all(row.together <= BUDGET for row in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
