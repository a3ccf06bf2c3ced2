"""The JupyterLite site: its build, its contents, our wheel, and as much of its start as needs no network.

NumPy, SciPy and matplotlib come from Pyodide's distribution when a page runs, so no lesson is run here. What is tested
is that their versions there (``pyodide.json``, an extract of Pyodide's lock) are within our bounds, that whatever else
we depend on is pure Python, that the page opens the lessons, and that the kernel starts and imports our wheel where
``NPSLAM_TEACH_PYODIDE`` names a folder made by ``pyodide_offline.py``.
"""

import ast
import functools
import http.server
import json
import os
import re
import shutil
import sys
import threading
import zipfile
from importlib import metadata
from pathlib import Path

import pytest
from packaging.requirements import Requirement

from npslam_teach.cli import parser
from npslam_teach.publishing import jupyterlite, lessons

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]
PACKAGE = ROOT / "npslam_teach"
PYODIDE = json.loads((Path(__file__).parents[1] / "pyodide.json").read_text(encoding="utf-8"))
SWEEPS = tuple(f"experiments/{name}.py" for name in ("executors", "sweep_files", "method_table"))  # many processes
# Commands that make or serve files on a person's own machine; no lesson imports them.
AT_HOME = ("__main__.py", "cli", "publishing", "system", "datasets/download.py", *SWEEPS)
# Modules that Python in a browser lacks, or that do not work there.
NOT_IN_A_BROWSER = {"multiprocessing", "subprocess", "threading", "socket", "fcntl", "msvcrt", "ctypes", "venv"}


def at_home(path):
    """Whether a module is for the command line only, so that no lesson imports it."""
    place = path.relative_to(PACKAGE)
    return place.parts[0] in AT_HOME or place.as_posix() in AT_HOME


@pytest.fixture(scope="session")
def ready():
    """Skip where the packages that build a site are not installed."""
    try:
        jupyterlite.require_packages(ROOT / "pyproject.toml")
    except ValueError as error:
        pytest.skip(str(error))


@pytest.fixture(scope="session")
def pyodide_folder():
    """Enough of Pyodide to start a kernel, None where there is none."""
    folder = os.environ.get("NPSLAM_TEACH_PYODIDE")
    return Path(folder) if folder else None


@pytest.fixture(scope="session")
def site(ready, pyodide_folder, tmp_path_factory):
    out = tmp_path_factory.mktemp("site") / "course"
    assert jupyterlite.build_site(ROOT, out, pyodide_folder) == out.resolve()
    return out


@pytest.fixture(scope="module")
def wheel(ready, tmp_path_factory):
    return jupyterlite.build_wheel(ROOT, tmp_path_factory.mktemp("wheel") / "wheels")


def load(path):
    return json.loads(path.read_text(encoding="utf-8"))


def test_the_wheel_is_pure_and_whole(wheel):
    assert wheel.name.endswith("-py3-none-any.whl")
    with zipfile.ZipFile(wheel) as opened:
        names = set(opened.namelist())
        about = next(name for name in names if name.endswith(".dist-info/WHEEL"))
        assert "Root-Is-Purelib: true" in opened.read(about).decode()
    modules = {path.relative_to(ROOT).as_posix() for path in PACKAGE.rglob("*.py")}
    assert {name for name in names if name.startswith("npslam_teach/") and name.endswith(".py")} == modules
    assert not [name for name in names if name.endswith((".so", ".pyd", ".dll", ".dylib"))]


def test_building_a_wheel_leaves_nothing_in_the_course(wheel):
    assert not (ROOT / "build" / "lib").exists() and not list(ROOT.glob("*.egg-info"))


def needed():
    """Every package that the wheel depends on in a browser, directly or not: name, and bounds on the version."""
    environment = {"sys_platform": "emscripten", "platform_system": "Emscripten", "python_version": "3.14", "extra": ""}
    project = jupyterlite.tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    to_do, found = list(map(Requirement, project["dependencies"])), []
    while to_do:
        each = to_do.pop()
        if each.marker is None or each.marker.evaluate(environment):
            if each.name not in {other.name for other in found} and each.name not in PYODIDE["packages"]:
                to_do += map(Requirement, metadata.requires(each.name) or [])
            found.append(each)
    return found


def test_pyodide_has_our_dependencies_or_they_are_pure():
    in_pyodide, pure = set(), set()
    for each in needed():
        if each.name in PYODIDE["packages"]:
            assert each.specifier.contains(PYODIDE["packages"][each.name]), each
            in_pyodide.add(each.name)
        else:
            about = metadata.distribution(each.name).read_text("WHEEL")
            is_pure = "Root-Is-Purelib: true" in about and re.search(r"^Tag: py3-none-any$", about, re.MULTILINE)
            # Some packages have a pure wheel besides a faster one for this machine, which is the one installed here.
            other = PYODIDE["pure_on_pypi"].get(each.name)
            assert is_pure or (other is not None and each.specifier.contains(other)), each
            pure.add(each.name)
    assert in_pyodide >= {"numpy", "scipy", "matplotlib", "pillow"}
    assert pure >= {"filterpy", "ipywidgets", "pooch"}


def test_pyodides_python_is_new_enough():
    project = jupyterlite.tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert Requirement(f"python{project['requires-python']}").specifier.contains(PYODIDE["python"])


def test_the_extract_is_of_the_pyodide_that_the_kernel_asks_for(ready):
    from jupyterlite_pyodide_kernel import constants

    assert PYODIDE["pyodide"] == constants.PYODIDE_VERSION
    assert PYODIDE["python"].startswith(constants.PYODIDE_PYTHON_VERSION + ".")


def test_the_extract_is_what_the_lock_says(pyodide_folder):
    if pyodide_folder is None:
        pytest.skip("NPSLAM_TEACH_PYODIDE is not set")
    lock = load(pyodide_folder / "pyodide-lock.json")
    assert lock["info"]["python"] == PYODIDE["python"]
    assert {name: lock["packages"][name]["version"] for name in PYODIDE["packages"]} == PYODIDE["packages"]


def imports(source):
    """The top-level packages that Python code imports."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            yield from (alias.name.split(".")[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield node.module.split(".")[0]


def test_lessons_and_what_they_import_need_no_more_than_a_browser_has():
    sources = [path.read_text(encoding="utf-8") for path in PACKAGE.rglob("*.py") if not at_home(path)]
    sources += [
        cell.source
        for path in lessons.lesson_paths(ROOT / "notebooks")
        for cell in lessons.read(path).cells
        if cell.cell_type == "code"
    ]
    found = {name for source in sources for name in imports(source)}
    assert not found & NOT_IN_A_BROWSER
    modules_of = {"pillow": ["PIL"], "matplotlib": ["matplotlib", "mpl_toolkits"], "ipython": ["IPython"]}
    offered = {module for each in needed() for module in modules_of.get(each.name, [each.name])}
    # Only the command line reads and writes notebooks (nbformat) and reads recordings of robots (rosbags); qdldl is
    # used where it is installed, and needed nowhere.
    assert found - set(sys.stdlib_module_names) - {"npslam_teach", "nbformat", "qdldl", "rosbags"} <= offered
    for path in lessons.lesson_paths(ROOT / "notebooks"):
        text = "\n".join(cell.source for cell in lessons.read(path).cells if cell.cell_type == "code")
        assert not re.search(r"npslam_teach(\.| import )(lessons|badges|commands|book|lite_site)\b", text)


def test_the_site_holds_every_lesson_and_its_pictures(site):
    for path in lessons.lesson_paths(ROOT / "notebooks"):
        for file in [path, *lessons.picture_files(path)]:
            name = file.relative_to(ROOT)
            assert (site / "files" / name).read_bytes() == file.read_bytes(), name
    listed = {each["path"] for folder in ("notebooks", "figures") for each in listing(site, folder)}
    files = {path.relative_to(site / "files").as_posix() for path in (site / "files").rglob("*") if path.is_file()}
    assert listed == files, "the page lists what the server has"
    assert not [name for name in files if "solution" in name]


def listing(site, folder):
    return load(site / "api" / "contents" / folder / "all.json")["content"]


def test_the_site_holds_our_wheel_and_looks_there_first(site):
    settings = load(site / "jupyter-lite.json")["jupyter-config-data"]
    urls = settings["litePluginSettings"]["@jupyterlite/pyodide-kernel-extension:kernel"]["pipliteUrls"]
    assert urls[0].startswith("./pypi/all.json")
    ((release,),) = load(site / "pypi" / "all.json")["npslam-teach"]["releases"].values()
    assert (site / "pypi" / release["filename"]).is_file()
    assert load(site / jupyterlite.MARKER) == {"wheel": release["filename"]}


def test_the_site_has_the_kernel_and_the_sliders_and_no_other_extension(site):
    found = {each["name"] for each in load(site / "jupyter-lite.json")["jupyter-config-data"]["federated_extensions"]}
    assert {"@jupyterlite/pyodide-kernel-extension", "@jupyter-widgets/jupyterlab-manager"} <= found
    assert found <= set(jupyterlite._EXTENSIONS)


@pytest.fixture
def quick(wheel, monkeypatch):
    """A build whose longest step writes one file instead, and whose wheel is the one that was built before."""

    def copy(root, folder):
        folder.mkdir(parents=True)
        return Path(shutil.copy2(wheel, folder))

    def write(source, site):
        site.mkdir()
        (site / "index.html").write_text("new", encoding="utf-8")

    monkeypatch.setattr(jupyterlite, "build_wheel", copy)
    monkeypatch.setattr(jupyterlite, "_run_jupyterlite", write)


def test_an_earlier_site_is_replaced_whole(quick, tmp_path, capsys):
    out = tmp_path / "course"
    out.mkdir()
    assert parser.main(["site", "--out", str(out)]) == 0, "an empty folder will do"
    (out / "left over.html").write_text("old", encoding="utf-8")
    assert parser.main(["site", "--out", str(out)]) == 0
    assert {path.name for path in out.iterdir()} == {"index.html", jupyterlite.MARKER}
    assert list(tmp_path.iterdir()) == [out]
    assert "lab/index.html?path=notebooks/00_start_here.ipynb" in capsys.readouterr().out


@pytest.mark.parametrize("stop", [KeyboardInterrupt, OSError("disk full")])
def test_an_interrupted_build_leaves_everything_as_it_was(quick, tmp_path, monkeypatch, stop):
    out = tmp_path / "course"
    jupyterlite.build_site(ROOT, out)
    (out / "index.html").write_text("old", encoding="utf-8")

    def interrupt(source, site):
        site.mkdir()
        (site / "half.html").write_text("half", encoding="utf-8")
        raise stop

    monkeypatch.setattr(jupyterlite, "_run_jupyterlite", interrupt)
    with pytest.raises((KeyboardInterrupt, OSError)):
        jupyterlite.build_site(ROOT, out)
    with pytest.raises((KeyboardInterrupt, OSError)):
        jupyterlite.build_site(ROOT, tmp_path / "another")
    assert list(tmp_path.iterdir()) == [out]
    assert (out / "index.html").read_text(encoding="utf-8") == "old"


def test_a_site_that_cannot_be_put_in_place_gives_the_old_one_back(quick, tmp_path, monkeypatch):
    out = tmp_path / "course"
    jupyterlite.build_site(ROOT, out)
    rename = Path.rename

    def fail(self, target):
        if self.name == "site":
            raise PermissionError(13, "denied", str(self))
        return rename(self, target)

    monkeypatch.setattr(Path, "rename", fail)
    with pytest.raises(PermissionError):
        jupyterlite.build_site(ROOT, out)
    assert (out / jupyterlite.MARKER).is_file() and list(tmp_path.iterdir()) == [out]


def test_other_peoples_files_are_not_touched(quick, tmp_path, refused):
    (tmp_path / "thesis.txt").write_text("years of work", encoding="utf-8")
    assert "expected no folder, an empty one or an earlier site" in refused("site", "--out", tmp_path)
    assert "got that of a file" in refused("site", "--out", tmp_path / "thesis.txt")
    assert "found no folder" in refused("site", "--out", tmp_path / "no" / "course")
    assert "found no pyodide.mjs" in refused("site", "--out", tmp_path / "course", "--pyodide", tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.txt"]


@pytest.mark.parametrize(("found", "said"), [(None, "nothing of that name"), ("0.1.0", "0.1.0")])
def test_a_missing_package_is_named_with_the_remedy(tmp_path, monkeypatch, refused, found, said):
    def version(name):
        if found is None:
            raise metadata.PackageNotFoundError(name)
        return found

    monkeypatch.setattr(metadata, "version", version)
    sentence = refused("site", "--out", tmp_path / "course")
    assert f"a site needs jupyterlite-core==0.8.6, got {said}: run " in sentence
    assert '-m pip install "jupyterlite-core==0.8.6" "jupyterlite-pyodide-kernel==' in sentence


def test_what_a_failed_step_said_is_handed_on(tmp_path):
    with pytest.raises(ValueError, match="^pip could not build its part of the site and said: .*no such option"):
        jupyterlite._run(["pip", "wheel", "--no-such-option"], tmp_path)


@pytest.fixture(scope="module")
def server(site):
    """The site on a port of this machine."""
    handler = functools.partial(QuietHandler, directory=str(site))
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as running:
        threading.Thread(target=running.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{running.server_port}"
        running.shutdown()


class QuietHandler(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *arguments):
        """Say nothing."""


@pytest.fixture(scope="module")
def tab(server):
    """A browser's tab on the first lesson, cut off from other machines; ``tab.elsewhere`` is what it asked them for.

    One for both tests that need it: Python in the browser takes ten seconds of the processor to start.
    """
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    program = next(filter(None, map(shutil.which, ("chromium-headless-shell", "chromium", "google-chrome"))), None)
    if program is None:
        pytest.skip("there is no chromium")
    with playwright.sync_playwright() as started:
        chromium = started.chromium.launch(executable_path=program, args=["--no-sandbox", "--disable-gpu"])
        tab = chromium.new_page(viewport={"width": 1400, "height": 1000})
        tab.elsewhere = []

        def here_alone(route):
            if route.request.url.startswith(server):
                route.continue_()
            else:
                tab.elsewhere.append(route.request.url)
                route.abort()

        tab.context.route(re.compile("^https?:"), here_alone)
        tab.goto(f"{server}/lab/index.html?path=notebooks/{lessons.FIRST}")
        tab.wait_for_selector(".jp-RenderedMarkdown h1", timeout=60_000)
        yield tab
        chromium.close()


def test_the_page_lists_the_lessons_and_opens_the_first(tab, pyodide_folder):
    names = {path.name for path in lessons.lesson_paths(ROOT / "notebooks")}
    tab.wait_for_function(f"document.querySelectorAll('.jp-DirListing-itemText').length >= {len(names)}")
    assert names <= {each.inner_text() for each in tab.query_selector_all(".jp-DirListing-itemText")}
    first = lessons.read(ROOT / "notebooks" / lessons.FIRST)
    assert tab.inner_text(".jp-RenderedMarkdown h1") == lessons.title(first)
    tab.wait_for_function(
        "[...document.querySelectorAll('.jp-RenderedMarkdown img')].some(each => each.naturalWidth > 500)"
    )
    assert tab.locator(".jp-RenderedMarkdown li", has_text="What you'll learn").count() == 1
    assert all(url.startswith("https://cdn.jsdelivr.net/pyodide/") for url in tab.elsewhere), tab.elsewhere


def test_the_kernel_starts_and_imports_our_wheel_from_the_site(tab, pyodide_folder):
    if pyodide_folder is None:
        pytest.skip("NPSLAM_TEACH_PYODIDE is not set")
    tab.wait_for_selector(".jp-Notebook-ExecutionIndicator[data-status=idle]", timeout=120_000)
    # Without its dependencies: NumPy's wheel is not in the folder.
    code = "import piplite\nawait piplite.install('npslam_teach', deps=False)\nfrom npslam_teach.cli import parser\n"
    code += "import sys\nprint(sys.platform, parser.build_parser().prog)"
    cell = tab.locator(".jp-CodeCell:has(.cm-content:visible)").first  # what installs the course is folded
    cell.locator(".cm-content").click()
    tab.keyboard.press("Control+a")
    tab.keyboard.insert_text(code)
    tab.keyboard.press("Shift+Enter")
    output = cell.locator(".jp-OutputArea-output", has_text="emscripten")
    output.wait_for(timeout=60_000)
    assert output.inner_text().strip() == "emscripten npslam_teach"
    assert tab.elsewhere == []
