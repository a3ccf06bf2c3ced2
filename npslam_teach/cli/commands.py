"""What each command of the command line does. Every function takes the parsed options and returns an exit code."""

import json
import os
import sys
import time
from contextlib import nullcontext
from pathlib import Path

from npslam_teach import experiments
from npslam_teach.cli import reports
from npslam_teach.system.environment import replace_process

ROOT = Path(__file__).absolute().parent.parent.parent
# Of the tests: the mathematics, the files and the command line.
QUICK_FOLDERS = "pose_graph association methods evaluation simulate datasets experiments cli".split()


def lab(options) -> int:
    """Open JupyterLab on the first notebook: on the loopback address, with Jupyter's own token."""
    first = "notebooks/00_start_here.ipynb"
    _require_checkout(ROOT / first)
    # The root is the whole course: lessons show pictures from the folder beside theirs.
    arguments = ["jupyterlab", "--ServerApp.ip=127.0.0.1", f"--ServerApp.root_dir={ROOT}"]
    arguments += [f"--LabApp.default_url=/lab/tree/{first}"]
    if options.port is not None:
        arguments += [f"--ServerApp.port={options.port}", "--ServerApp.port_retries=0"]
    if options.no_browser:
        arguments += ["--no-browser"]
    if hasattr(os, "geteuid") and os.geteuid() == 0:
        # In a container everybody is root, and Jupyter would refuse; it still listens on this machine only.
        arguments += ["--allow-root"]
    return _run_module(arguments)


def fetch(options) -> int:
    """Fetch one of the authors' files and print its path."""
    from npslam_teach import datasets

    fetchers = {"simulation": datasets.fetch_mu2016_simulation, "office": datasets.fetch_stata_office}
    print(fetchers[options.name]())
    return 0


def test(options) -> int:
    """Run pytest on the library's tests and, with nbval, on every notebook; with ``--quick`` on the core alone."""
    _require_checkout(ROOT / "tests")
    if options.quick:
        how = ["-m", "not slow and not browser"]
        what = [f"tests/{folder}" for folder in QUICK_FOLDERS]
        what += sorted(path.relative_to(ROOT).as_posix() for path in ROOT.glob("tests/test_*.py"))
    else:
        sanitize = f"--nbval-sanitize-with={ROOT / 'tests' / 'nbval_sanitize.cfg'}"
        how = ["--nbval", "--nbval-current-env", "--nbval-cell-timeout=120", sanitize]
        what = ["tests", "notebooks"]
    if any((ROOT / word.split("::")[0]).exists() for word in options.extra):
        what = []  # the further arguments say it
    workers = ["-n", str(min(os.cpu_count() or 1, 8)), "--dist", "loadscope"]
    return _run_module(["pytest", *workers, *how, *what, *options.extra])


def bench(options) -> int:
    """Measure ours beside other solvers, those that are installed."""
    program = ROOT / "tests" / "benchmarks" / "run.py"
    _require_checkout(program)
    return _run_python([str(program), *options.extra])


def solve(options) -> int:
    """Run one method on a log and tell what it found."""
    import numpy as np

    from npslam_teach import datasets, simulate
    from npslam_teach.system import files

    settings = _settings(options.method, alpha=options.alpha, threshold=options.threshold)
    write = _writer(options.out, (".json", ".g2o"))
    log, truth = datasets.load_log(options.log)
    with files.prefix_errors(options.log):
        if options.noise != 0:
            log = simulate.add_noise(log, options.noise, np.random.default_rng(options.seed))
        run = experiments.run_method(options.method, log, settings)
        result = reports.solve_result(run, truth)
    write(result, run.snapshots[-1].graph)
    _print(result if options.json else reports.solve_text(result), options.json)
    return 0


def reproduce(options) -> int:
    """Run the paper's simulation once or over many seeds, with every method."""
    from npslam_teach.cli import reports
    from npslam_teach.experiments import paper_simulation
    from npslam_teach.system import files

    folder = _folder(options.figures)
    first_seed = options.first_seed
    if first_seed is None:
        first_seed = 2016 if options.data is None and options.seeds == 1 else 0
    seeds = range(first_seed, first_seed + options.seeds)
    scenes = paper_simulation.scenes(options.data, options.noise, seeds)
    with nullcontext() if options.data is None else files.prefix_errors(options.data):
        result, first, runs = paper_simulation.run_all(scenes, options.methods, options.iterations, options.seeds)
    _print(result if options.json else reports.reproduce_text(result), options.json)
    if folder is not None:
        from npslam_teach.course.fifteen_objects import figures as drawing

        folder.mkdir(parents=True, exist_ok=True)
        snapshots = {method: run.snapshots for method, run in runs.items()}
        drawing.draw_simulation(drawing.Comparison(first.log, first.truth, snapshots), folder)
    return 0


def optimize(options) -> int:
    """Solve a pose graph read from a file; the seconds are those from arrays to solution."""
    from tqdm import tqdm

    from npslam_teach import datasets, pose_graph
    from npslam_teach.system import files

    write = _writer(options.out, (".g2o",))
    graph = datasets.load_g2o(options.graph)
    seconds = []
    for _ in tqdm(range(options.repeat or 1), desc="optimize", unit="run", delay=2, leave=False):
        begin = time.perf_counter()
        with files.prefix_errors(options.graph):
            steps = pose_graph.minimize(graph, options.tolerance)
        seconds.append(time.perf_counter() - begin)
    result = reports.optimize_result(steps, pose_graph.chi2(graph), seconds if options.repeat else seconds[0])
    write(result, steps[-1].graph)
    _print(result if options.json else reports.optimize_text(result), options.json)
    return 0


def figures(options) -> int:
    """Draw every figure of the course anew."""
    from npslam_teach.course import all_figures

    folder = _folder(str(ROOT / "figures") if options.out is None else options.out)
    folder.mkdir(parents=True, exist_ok=True)
    all_figures.draw_all(folder)
    print(f"figures: {folder}")
    return 0


def site(options) -> int:
    """Build the course as a JupyterLite site."""
    from npslam_teach.publishing import jupyterlite, lessons

    _require_checkout(ROOT / "notebooks")
    pyodide = None if options.pyodide is None else Path(options.pyodide)
    folder = jupyterlite.build_site(ROOT, Path(options.out), pyodide)
    print(f"site: {folder}\nfirst page, on its web server: lab/index.html?path=notebooks/{lessons.FIRST}")
    return 0


def book(options) -> int:
    """Write all lessons as one HTML file, or print that to PDF."""
    from npslam_teach.publishing import book as making

    _require_checkout(ROOT / "notebooks")
    making.write_book(ROOT / "notebooks", Path(options.out), options.browser)
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
    """Write the student's copy of some lessons and the source that nbgrader grades."""
    from npslam_teach.publishing import assignments as making

    _require_checkout(ROOT / "notebooks")
    lessons = list(dict.fromkeys(options.lessons))
    for path in making.write_assignments(ROOT / "notebooks", lessons, _folder(options.out), options.student):
        print(path)
    return 0


def _settings(method: str, **wanted) -> dict:
    """The settings that were given; fails in one sentence where the method has no such thing."""
    from npslam_teach.methods import METHODS

    known = METHODS[method].settings
    given = {name: value for name, value in wanted.items() if value is not None}
    for name, value in given.items():
        if name not in known:
            raise ValueError(f"--{name}: expected a method that has it, got {method} (and --{name} {value:g})")
    return given


def _writer(out: str | None, suffixes: tuple):
    """A function that writes the result where ``--out`` says; a bad name is refused before any work is done."""
    from npslam_teach import datasets
    from npslam_teach.system import files

    if out is None:
        return lambda result, graph: None
    suffix = Path(out).suffix.lower()
    if suffix not in suffixes:
        raise ValueError(f"--out {out}: expected a name that ends in {' or '.join(suffixes)}, got {suffix!r}")
    if not Path(out).absolute().parent.is_dir():
        raise FileNotFoundError(f"--out {out}: expected a folder to write into, found none")

    def write(result: dict, graph) -> None:
        if suffix == ".g2o":
            datasets.save_g2o(out, graph)
        else:
            with files.atomic_write(out) as stream:
                stream.write(json.dumps(reports.plain(result), allow_nan=False))

    return write


def _folder(name: str | None) -> Path | None:
    """The folder to draw into; it is made only when there is something to draw."""
    if name is None:
        return None
    if not name.strip() or (Path(name).exists() and not Path(name).is_dir()):
        raise ValueError(f"expected the name of a folder to draw into, got {name!r}")
    return Path(name)


def _print(result, as_json: bool) -> None:
    print(json.dumps(reports.plain(result), allow_nan=False) if as_json else result)


def _require_checkout(path: Path) -> None:
    if not path.exists():
        raise FileNotFoundError(
            f"{path}: expected the course's folder; this command works from a copy of the repository"
        )


def _run_module(arguments: list[str]) -> int:
    """Run ``python -m`` on this interpreter, in the course's folder, in place of this process."""
    os.chdir(ROOT)
    return _run_python(["-m", *arguments])


def _run_python(arguments: list[str]) -> int:
    """Run this interpreter in place of this process."""
    # Kernels and workers start in folders of their own and must find the package from there.
    os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, [str(ROOT), os.environ.get("PYTHONPATH")]))
    return replace_process([sys.executable, *arguments])
