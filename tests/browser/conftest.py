"""One JupyterLab for all browser tests of a process, and one Chromium for each file of them.

Both are slow to start, so tests share them; a page is each test's own. Whatever is missing skips these tests in words.
"""

from pathlib import Path

import pytest
from lab_server import LARGE_WINDOW, copy_of_the_course, new_context, running_chromium, running_lab


def pytest_collection_modifyitems(items):
    """All tests of this folder need a browser, and most take their time."""
    for item in items:
        if Path(__file__).parent in item.path.parents:
            item.add_marker("browser")
            item.add_marker("slow")


@pytest.fixture(scope="module")
def chromium():
    """A headless browser. It ends with its file: other tests cannot start a loop of events beside Playwright's."""
    with running_chromium() as browser:
        yield browser


@pytest.fixture(scope="session")
def lab(tmp_path_factory):
    """``lab_server.Lab``: our own ``lab`` command, serving a copy of the course that tests may change."""
    folder = copy_of_the_course(tmp_path_factory.mktemp("course"))
    with running_lab(folder, tmp_path_factory.mktemp("jupyter")) as running:
        yield running


@pytest.fixture
def page(chromium):
    """An empty page in a window of its own, with neither cookies nor storage."""
    context = new_context(chromium, viewport=LARGE_WINDOW)
    yield context.new_page()
    context.close()
