"""A real JupyterLab on a copy of the course, and a real browser to look at it."""

import contextlib
import os
import shutil
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import lab_process
import nbformat
import pytest

ROOT = Path(__file__).resolve().parents[2]
# The first only draws pages: it takes a sixth less of the processor than a browser that has a window to hide.
CHROMIUM = ("chromium-headless-shell", "chromium", "chromium-browser", "google-chrome")
CHROMIUM_ARGUMENTS = (
    "--disable-gpu --disable-dev-shm-usage --disable-quic --no-first-run --disable-background-networking "
    "--disable-component-update --disable-sync"
).split()
CELLS_SECONDS = 300
PAGE_SECONDS = 120
POLLING = 50  # ms from one look at what is waited for to the next; to look with every frame keeps a page drawing frames
ALL_SHOWN = """cells => {
    const images = [...document.querySelectorAll(".jp-Notebook .jp-Cell img")];
    return document.querySelectorAll(".jp-Notebook .jp-Cell").length === cells && images.length > 0
        && images.every((each) => each.complete);
}"""
OPEN = """async ([path, shared]) => {
    const running = [...jupyterapp.serviceManager.sessions.running()];
    for (const each of [...jupyterapp.shell.widgets("main")]) each.dispose();
    const kernel = shared ? { id: running[0].kernel.id } : undefined;
    await (await jupyterapp.commands.execute("docmanager:open", { path, factory: "Notebook", kernel })).context.ready;
}"""
LARGE_WINDOW = {"width": 1400, "height": 1000}


@dataclass(frozen=True)
class Lab:
    """A JupyterLab that runs: where it listens, the token that opens it, the copy of the course that it serves."""

    address: str
    token: str
    folder: Path

    def url(self, notebook: str, workspace: str) -> str:
        """Where a notebook opens alone, whatever was open before."""
        return f"{self.address}/lab/workspaces/{workspace}/tree/notebooks/{notebook}?token={self.token}&reset"


def copy_of_the_course(folder: Path) -> Path:
    """What ``lab`` needs, in a folder where JupyterLab may save over notebooks.

    The notebooks are cleared: whatever a page shows afterwards was made by this run.
    """
    for name in ("npslam_teach", "notebooks", "figures"):
        shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__", ".ipynb_checkpoints"))
    shutil.copy(ROOT / "environment.txt", folder)
    for path in (folder / "notebooks").glob("*.ipynb"):
        notebook = nbformat.read(path, as_version=4)
        for cell in notebook.cells:
            if cell.cell_type == "code":
                cell.update(outputs=[], execution_count=None)
        nbformat.write(notebook, path)
    return folder


def new_context(browser, **how):
    """A window of its own, which waits as long as a busy machine may take."""
    context = browser.new_context(**how)
    context.set_default_timeout(1000 * PAGE_SECONDS)
    return context


@contextlib.contextmanager
def running_lab(folder: Path, settings: Path) -> Iterator[Lab]:
    """Start ``python -m npslam_teach lab`` in a copy of the course, and shut it down at the end.

    Args:
        folder: from ``copy_of_the_course``.
        settings: an empty folder for Jupyter's own files, so that a user's settings change nothing here.
    """
    own = {f"JUPYTER_{name}_DIR": str(settings / name.lower()) for name in ("CONFIG", "DATA", "RUNTIME")}
    own |= {"IPYTHONDIR": str(settings / "ipython")}
    own |= {"NPSLAM_TEACH_FRAMES": ""}  # a kernel answers: frames, which take seconds, are not needed
    (settings / "config").mkdir()
    exposed = "c.LabApp.expose_app_in_browser = True  # so that a page can open one notebook after the other\n"
    (settings / "config" / "jupyter_lab_config.py").write_text(exposed, encoding="utf-8")
    with lab_process.running_lab(folder, settings / "lab.log", own) as running:
        yield Lab(running.site, running.token, folder)


def how_chromium_starts() -> dict:
    """Where it is, and its arguments, or a skipped test that says what is missing."""
    path = next(filter(None, map(shutil.which, CHROMIUM)), None)
    if path is None:
        pytest.skip("no Chromium found: install the package chromium-headless-shell or chromium")
    # A container runs everything as root, where Chromium refuses its own sandbox.
    rootless = [] if hasattr(os, "geteuid") and os.geteuid() != 0 else ["--no-sandbox"]
    return {"executable_path": path, "args": [*CHROMIUM_ARGUMENTS, *rootless]}


@contextlib.contextmanager
def running_chromium():
    """A headless Chromium, or a skipped test that says what is missing."""
    sync_api = pytest.importorskip(
        "playwright.sync_api", reason="playwright is not installed: pip install -r tests/requirements.txt"
    )
    with sync_api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(**how_chromium_starts())
        yield browser
        browser.close()


def write_notebook(path: Path, *sources: str) -> None:
    """A notebook of code cells."""
    cells = [nbformat.v4.new_code_cell(source) for source in sources]
    notebook = nbformat.v4.new_notebook(cells=cells)
    notebook.metadata["kernelspec"] = {"display_name": "Python 3 (ipykernel)", "language": "python", "name": "python3"}
    nbformat.write(notebook, path)


def open_notebook(page, lab: Lab, name: str, workspace: str = "test", runs: bool = True) -> None:
    """Open a notebook of the course and wait until its kernel is idle or, where it is only read, until all is shown."""
    page.goto(lab.url(name, workspace))
    page.locator(".jp-Notebook:visible").wait_for(timeout=60_000)
    if runs:
        wait_until_idle(page)
    else:
        wait_until_shown(page, lab, name)
    page.keyboard.press("Control+b")  # the list of files takes half of a narrow window


def open_instead(page, name: str, shares_kernel: bool = False) -> None:
    """Open a notebook in a page in the place of another one, with a kernel that runs already or with its own.

    A page that is loaded anew compiles JupyterLab anew, which takes longer than all the rest.
    """
    page.evaluate(OPEN, [f"notebooks/{name}", shares_kernel])


def wait_until_shown(page, lab: Lab, name: str) -> None:
    """Wait until all of a notebook as it was saved is in the page."""
    cells = len(nbformat.read(lab.folder / "notebooks" / name, as_version=4).cells)
    # With every frame: JupyterLab attaches cells when a page has nothing to do after a frame, and no frame, no cell.
    page.wait_for_function(ALL_SHOWN, arg=cells)


def wait_until_idle(page, milliseconds: float = 60_000) -> None:
    """Wait until the kernel of the notebook in front has nothing to do."""
    page.locator("#jp-main-statusbar", has_text="| Idle").wait_for(timeout=milliseconds)


def run_all_cells(page) -> None:
    """Run every cell of the notebook in front, and wait until the last one is done and the kernel is idle.

    The notebook must be one that has not run: with no number at any cell.
    """
    begun, done = (_every_prompt(pattern) for pattern in (r"\[(\*|\d+)\]", r"\[\d+\]"))
    for _ in range(10):
        page.keyboard.press("Escape")  # closes a menu that the last try left open
        page.locator("li.lm-MenuBar-item", has_text="Run").click()
        page.locator("[data-command='runmenu:run-all']").click()
        # A notebook that is still being wired to its kernel ignores the command without a word.
        with contextlib.suppress(timeout_error()):
            page.wait_for_function(begun, timeout=3_000)
            break
    else:
        raise AssertionError("the cells did not run")
    page.wait_for_function(done, timeout=1000 * CELLS_SECONDS, polling=4 * POLLING)
    wait_until_idle(page)


def _every_prompt(pattern: str) -> str:
    """JavaScript: whether all code cells in front have a prompt like this."""
    # A cell whose code is folded away has a placeholder for its prompt, without a number.
    prompt = ".jp-Notebook .jp-CodeCell .jp-InputPrompt:not(.jp-Placeholder-prompt)"
    return f"""() => {{
        const prompts = [...document.querySelectorAll("{prompt}")];
        return prompts.length > 0 && prompts.every((each) => /{pattern}/.test(each.textContent));
    }}"""


def saved(page, lab: Lab, name: str) -> nbformat.NotebookNode:
    """Save the notebook in front and read it back: its cells with the outputs of this run."""
    path = lab.folder / "notebooks" / name
    with page.expect_response(lambda response: response.request.method == "PUT" and name in response.url) as answer:
        page.keyboard.press("Escape")
        page.keyboard.press("Control+s")
    assert answer.value.ok, answer.value.status
    return nbformat.read(path, as_version=4)


def timeout_error() -> type[Exception]:
    """What Playwright raises when it has waited long enough; imported late, because it may be missing."""
    from playwright.sync_api import TimeoutError

    return TimeoutError
