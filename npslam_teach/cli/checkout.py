"""Commands that need the course itself, a copy of the repository: its notebooks, tests and what is made of them."""

import os
import sys
from pathlib import Path

from npslam_teach.cli.output_files import announce, folder_named
from npslam_teach.system.interpreter import replace_process

ROOT = Path(__file__).absolute().parent.parent.parent
# A student's list of files begins with lessons, not with their solutions, which links still open.
HIDDEN = "__pycache__ *.py[co] *~ solutions conftest.py ruff.toml".split()
# Of the tests: the mathematics, the files and the command line.
QUICK_FOLDERS = "pose_graph association methods evaluation simulate datasets experiments cli".split()


def lab(options) -> int:
    """Open JupyterLab on the first notebook: on the loopback address, with Jupyter's own token."""
    first = "notebooks/00_start_here.ipynb"
    _require_checkout(ROOT / first)
    # The root is the whole course: lessons show pictures from the folder beside theirs.
    arguments = ["npslam_teach.system.trust", "--ServerApp.ip=127.0.0.1", f"--ServerApp.root_dir={ROOT}"]
    # A preferred folder of the user's own lies outside of this one, and Jupyter would refuse to start.
    arguments += [f"--ServerApp.preferred_dir={ROOT}", f"--ContentsManager.preferred_dir={ROOT}"]
    arguments += [f"--LabApp.default_url=/lab/tree/{first}"]
    if options.port is not None:
        arguments += [f"--ServerApp.port={options.port}", "--ServerApp.port_retries=0"]
    if options.no_browser:
        arguments += ["--no-browser"]
    if hasattr(os, "geteuid") and os.geteuid() == 0:
        # In a container everybody is root, and Jupyter would refuse; it still listens on this machine only.
        arguments += ["--allow-root"]
    arguments += [f"--ContentsManager.hide_globs={name}" for name in HIDDEN]
    arguments += ["--FileContentsManager.pre_save_hook=npslam_teach.system.saving.keep_what_was_there"]
    return _run_module(arguments, {"JUPYTER_CONFIG_PATH": _config_path()})


def _config_path() -> str:
    """Where Jupyter looks for settings: those of the course, which ask no question about news, and the user's own."""
    own = os.environ.get("JUPYTER_CONFIG_PATH")
    return os.pathsep.join([str(Path(__file__).parent / "jupyter")] + ([own] if own else []))


def test(options) -> int:
    """Run pytest on the library's tests and, with nbval, on every notebook; with ``--quick`` on the core alone."""
    _require_checkout(ROOT / "tests")
    if options.quick:
        # Without nbval, which every worker would import for a second.
        how, plugins = ["-m", "not slow and not browser"], []
        what = [f"tests/{folder}" for folder in QUICK_FOLDERS]
        what += sorted(path.relative_to(ROOT).as_posix() for path in ROOT.glob("tests/test_*.py"))
    else:
        sanitize = f"--nbval-sanitize-with={ROOT / 'tests' / 'nbval_sanitize.cfg'}"
        how, plugins = ["--nbval", "--nbval-current-env", "--nbval-cell-timeout=120", sanitize], ["-p", "nbval.plugin"]
        what = ["notebooks", "tests"]
    if any((ROOT / word.split("::")[0]).exists() for word in options.extra):
        what = []  # the further arguments say it
    # One more than there are processors: much of the time a test waits for a browser or a kernel.
    count = min((os.cpu_count() or 1) + 1, 8)
    workers = ["-n", str(count), "--dist", "loadscope", "--no-loadscope-reorder"]
    # Plugins that somebody else has installed here are not asked.
    # Workers and kernels of one thread each: several, that wait for each other, take several times as long.
    alone = {"PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1", "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    return _run_module(["pytest", "-p", "xdist.plugin", *plugins, *workers, *how, *what, *options.extra], alone)


def bench(options) -> int:
    """Measure ours beside other solvers, those that are installed."""
    program = ROOT / "tests" / "benchmarks" / "run.py"
    _require_checkout(program)
    return _run_python([str(program), *options.extra])


def site(options) -> int:
    """Build the course as a JupyterLite site."""
    from npslam_teach.publishing import jupyterlite, lessons

    _require_checkout(ROOT / "notebooks")
    pyodide = None if options.pyodide is None else Path(options.pyodide)
    folder = jupyterlite.build_site(ROOT, Path(options.out), pyodide)
    print(f"site: {folder}\nfirst page, on its web server: lab/index.html?path=notebooks/{lessons.FIRST}")
    return 0


def book(options) -> int:
    """Write all lessons, or the library's names with their docstrings, as one HTML file, or print that to PDF."""
    from npslam_teach.publishing import api_page
    from npslam_teach.publishing import book as making

    if not options.api:
        _require_checkout(ROOT / "notebooks")
    announce(options.out)
    make = api_page.api_html if options.api else lambda: making.book_html(ROOT / "notebooks")
    making.write_book(make, Path(options.out), options.browser)
    print(f"book: {options.out}")
    return 0


def badges(options) -> int:
    """Bring the beginning of every lesson up to date with the address in pyproject.toml."""
    from npslam_teach.publishing import colab as writing

    _require_checkout(ROOT / "notebooks")
    changed = writing.write_badges(ROOT)
    address = writing.repository(ROOT / "pyproject.toml") or "nowhere: pyproject.toml names no Repository"
    print(f"badges: {len(changed)} lessons changed; the course is at {address}")


def assignment(options) -> int:
    """Write the student's copy of lessons and the source that nbgrader grades; or the whole course for students."""
    from npslam_teach.publishing import assignments as making
    from npslam_teach.publishing import student_course

    _require_checkout(ROOT / "notebooks")
    if options.course:
        print(student_course.write_student_course(ROOT, folder_named(options.out)))
        return 0
    lessons = list(dict.fromkeys(options.lessons))
    if not lessons:
        raise ValueError("LESSON: expected numbers of lessons, such as 04, or --course, got neither")
    folder = folder_named(options.out, is_new=True)
    for path in making.write_assignments(ROOT / "notebooks", lessons, folder, options.student):
        print(path)
    return 0


def _require_checkout(path: Path) -> None:
    if not path.exists():
        raise FileNotFoundError(
            f"{path}: expected the course's folder; this command works from a copy of the repository"
        )


def _run_module(arguments: list[str], variables: dict[str, str] | None = None) -> int:
    """Run ``python -m`` on this interpreter, in the course's folder, in place of this process.

    Args:
        arguments: the module and what it is given.
        variables: of its environment, beside those that Jupyter needs.
    """
    from npslam_teach.system.jupyter import own_jupyter, writable_folders

    os.environ.update(own_jupyter() | writable_folders() | (variables or {}))
    os.environ.pop("MPLBACKEND", None)  # a kernel chooses its own, and another may not be installed here
    os.chdir(ROOT)
    return _run_python(["-m", *arguments])


def _run_python(arguments: list[str]) -> int:
    """Run this interpreter in place of this process."""
    # Kernels and workers start in folders of their own and must find the package from there.
    os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, [str(ROOT), os.environ.get("PYTHONPATH")]))
    return replace_process([sys.executable, *arguments])
