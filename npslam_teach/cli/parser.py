"""The command line: ``python3 -m npslam_teach COMMAND``.

Wrong input ends with one sentence on standard error and exit code 2. ``--json`` prints one object on standard output
and nothing else. What a command does stands in ``commands``; here is only how it is asked.
"""

import argparse
import os
import sys
import warnings

from npslam_teach import __version__
from npslam_teach.cli.import_options import add_import_options
from npslam_teach.cli.method_help import methods_text, names_text
from npslam_teach.cli.option_types import Parser, count, index, method, methods, number, numbers, port
from npslam_teach.cli.output_files import Once
from npslam_teach.cli.sweep_options import add_sweep_options
from npslam_teach.system.progress import progress_shown


def main(arguments: list[str] | None = None) -> int:
    """Run one command and return its exit code: 0, 2 for wrong input, 130 after Ctrl-C, 141 for a closed pipe.

    Args:
        arguments: as on the command line, without the program's name.
    """
    parser = build_parser()
    options, extra = parser.parse_known_args(arguments)
    if extra and options.command not in ("test", "bench"):
        parser.error(f"unrecognized arguments: {' '.join(extra)}")
    options.extra = extra

    def say_warning(message, *details, **more) -> None:
        print(f"{parser.prog} {options.command}: warning: {' '.join(str(message).split())}", file=sys.stderr)

    try:
        with warnings.catch_warnings(), progress_shown():
            warnings.simplefilter("always", UserWarning)
            warnings.showwarning = say_warning
            code = _function_of(options.command)(options) or 0
        sys.stdout.flush()
        return code
    except BrokenPipeError:
        # Whoever read our output has seen enough, as `head` does; nothing more can be said to him.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 141
    except (ValueError, OSError, MemoryError) as error:
        return _explain(parser.prog, options.command, error)
    except KeyboardInterrupt:
        print(f"{parser.prog} {options.command}: interrupted", file=sys.stderr)
        return 130


def _function_of(command: str):
    from npslam_teach.cli import checkout, commands

    name = "import_recording" if command == "import" else command  # a word that Python keeps for itself
    return getattr(commands, name, None) or getattr(checkout, name)


def _explain(program: str, command: str, error: Exception) -> int:
    sentence = " ".join(str(error).split())
    if isinstance(error, OSError) and error.filename is not None and error.strerror:
        sentence = f"{error.filename}: {error.strerror.lower()}"
    if isinstance(error, MemoryError):
        sentence = "expected a problem that fits into memory, got one that does not"
    print(f"{program} {command}: {sentence}", file=sys.stderr)
    return 2


def build_parser() -> argparse.ArgumentParser:
    """The parser of all commands; each sets ``command`` to the name of its function in ``commands`` or ``checkout``."""
    parser = Parser(prog="npslam_teach", description="Object SLAM with unknown data association, taught step by step.")
    parser.add_argument("--version", action="version", version=f"npslam_teach {__version__}")
    subparsers = parser.add_subparsers(dest="command", metavar="COMMAND", required=True, parser_class=Parser)
    _add_lab(subparsers)
    _add_fetch(subparsers)
    _add_test(subparsers)
    _add_bench(subparsers)
    _add_reproduce(subparsers)
    _add_sweep(subparsers)
    _add_solve(subparsers)
    _add_import(subparsers)
    _add_optimize(subparsers)
    _add_figures(subparsers)
    _add_site(subparsers)
    _add_book(subparsers)
    _add_badges(subparsers)
    _add_assignment(subparsers)
    return parser


def _add(subparsers, name: str, text: str) -> argparse.ArgumentParser:
    return subparsers.add_parser(name, help=text, description=text[0].upper() + text[1:] + ".")


def _add_lab(subparsers) -> None:
    lab = _add(subparsers, "lab", "open the course in JupyterLab, on this machine only")
    lab.add_argument("--port", type=port, help="the port to listen on (default: the first free one from 8888)")
    lab.add_argument("--no-browser", action="store_true", help="print the address instead of opening it")


def _add_fetch(subparsers) -> None:
    fetch = _add(subparsers, "fetch", "fetch a file of the authors' once, check it, and print where it is")
    fetch.add_argument("name", choices=("simulation", "office"), metavar="NAME", help="simulation or office")


def _add_test(subparsers) -> None:
    test = _add(subparsers, "test", "run all tests, notebooks included; further arguments go to pytest")
    what = "only the mathematics, the files and the command line: less than two minutes instead of 11"
    test.add_argument("--quick", action="store_true", help=what)


def _add_bench(subparsers) -> None:
    text = "measure the speed beside other solvers; further arguments go to tests/benchmarks/run.py"
    _add(subparsers, "bench", text)


def _add_reproduce(subparsers) -> None:
    reproduce = _add(subparsers, "reproduce", "run the paper's simulation with every method and compare them")
    reproduce.add_argument("--data", metavar="FILE", help="a log with truth, such as the authors' simulation.mat")
    reproduce.add_argument("--noise", type=number, default=1.0, metavar="S", help="1 is the paper's (default)")
    reproduce.add_argument("--seeds", type=count, default=1, metavar="N", help="how many runs (default 1)")
    reproduce.add_argument("--first-seed", type=index, metavar="K", help="default 0; a single run of our scene: 2016")
    reproduce.add_argument("--methods", type=methods, metavar="A,B", help="default: all")
    reproduce.add_argument(
        "--iterations",
        type=count,
        default=8,
        metavar="N",
        help="alternations at most (default 8; the paper ran 5)",
    )
    text = "draw figures 14 to 17 of the first run into this folder"
    reproduce.add_argument("--figures", action=Once, metavar="DIR", help=text)
    reproduce.add_argument("--table", action=Once, metavar="FILE", help="write a row for each run and method (.csv)")
    _add_json(reproduce)


def _add_sweep(subparsers) -> None:
    sweep = _add(subparsers, "sweep", "run methods over noise, settings and seeds, here or on a cluster")
    sweep.more_help = names_text
    add_sweep_options(sweep)


def _add_solve(subparsers) -> None:
    solve = _add(subparsers, "solve", "run one method on a robot log")
    text = "a .npz or .csv log, a folder of .csv files, or one of the authors' .mat files"
    solve.add_argument("log", metavar="LOG", help=text)
    solve.more_help = methods_text
    solve.add_argument("--method", type=method, default="np-graph", metavar="NAME", help="see below; default np-graph")
    solve.add_argument("--alpha", type=number, metavar="A", help="concentration of the Dirichlet process (default 0.9)")
    solve.add_argument("--threshold", type=number, metavar="P", help="accept the best match above this probability")
    _add_settings(solve)
    text = "np-graph: visit observations in so many orders, keep the lowest objective (default 1)"
    solve.add_argument("--restarts", type=count, default=1, metavar="N", help=text)
    text = "posterior: at most so many searches from the beginning (default 6)"
    solve.add_argument("--starts", type=count, metavar="N", help=text)
    text = "posterior: so many samples as well, at least 16: how probable is each number of objects?"
    solve.add_argument("--samples", type=count, metavar="N", help=text)
    solve.add_argument("--filter-only", action="store_true", help="ekf: the raw filter, not smoothed at the end")
    solve.add_argument("--noise", type=number, default=0.0, metavar="S", help="noise to add first; 1 is the paper's")
    solve.add_argument("--seed", type=index, metavar="K", help="of that noise, and of the restarts (default 0)")
    text = "write the result as .json, its graph as .g2o, its path as .tum or its objects as .csv; may be repeated"
    solve.add_argument("--out", metavar="FILE", action="append", default=[], help=text)
    solve.add_argument(
        "--figures", action=Once, metavar="DIR", help="draw the map of the result and of every iteration"
    )
    _add_json(solve)


def _add_settings(solve) -> None:
    """Everything that a method can be asked for; what it does not have is refused."""
    text = "constants of the paper, or scaled to the log's own noise (default: sensor; for .mat files paper)"
    solve.add_argument("--settings", choices=("paper", "sensor"), help=text)
    solve.add_argument("--kernel-std", type=number, metavar="M", help="width of the association kernel, m")
    text = "what the solver assumes per step: m,m,rad"
    solve.add_argument("--odometry-std", type=numbers(3), metavar="X,Y,T", help=text)
    solve.add_argument("--observation-std", type=numbers(2), metavar="X,Y", help="and per observation: m,m")
    solve.add_argument("--area", type=number, metavar="A", help="of the room, m^2, for the objective")
    orders = ("last-to-first", "first-to-last")
    solve.add_argument("--order", choices=orders, help="in which observations are visited (default last-to-first)")
    solve.add_argument("--iterations", type=count, metavar="N", help="alternations at most (default 5)")
    text = "online: poses out of sight after which an association is final (default 100)"
    solve.add_argument("--window", type=count, metavar="N", help=text)
    solve.add_argument("--gate", type=number, metavar="P", help="ekf: the share of right matches to let through")
    text = "first estimate odometry-std and observation-std from the log itself, and use them instead of the log's own"
    solve.add_argument("--estimate-noise", action="store_true", help=text)
    text = "np-graph: whether two observations of one frame are always of two objects"
    solve.add_argument("--exclusive", action=argparse.BooleanOptionalAction, default=None, help=text)


def _add_import(subparsers) -> None:
    add_import_options(_add(subparsers, "import", "turn a recording of a real robot into a log"))


def _add_optimize(subparsers) -> None:
    optimize = _add(subparsers, "optimize", "solve a pose graph")
    optimize.add_argument("graph", metavar="GRAPH.g2o", help="a 2-D pose graph")
    optimize.add_argument(
        "--out", action=Once, metavar="FILE", help="write the solution as .g2o; vertices keep their ids"
    )
    optimize.add_argument("--repeat", type=count, metavar="N", help="solve N times and list the seconds")
    text = "stop when a step lowers chi2 by less than this share (default 1e-9)"
    optimize.add_argument("--tolerance", type=number, default=1e-9, metavar="R", help=text)
    _add_json(optimize)


def _add_figures(subparsers) -> None:
    figures = _add(subparsers, "figures", "draw every figure of the course anew")
    figures.add_argument("--out", action=Once, metavar="DIR", help="default: the folder figures beside the package")
    text = "draw the success of a sweep's runs instead (default folder: FILE without its ending)"
    figures.add_argument("--sweep", metavar="FILE", help=text)


def _add_site(subparsers) -> None:
    site = _add(subparsers, "site", "build the course as static web pages that run Python in the reader's browser")
    site.add_argument(
        "--out", action=Once, required=True, metavar="DIR", help="the folder to make, or an earlier site to replace"
    )
    site.add_argument("--pyodide", metavar="FOLDER", help="a distribution of Pyodide to hand out with the site")


def _add_book(subparsers) -> None:
    book = _add(subparsers, "book", "write all lessons as one book, to read offline and to print")
    book.add_argument(
        "--out", action=Once, required=True, metavar="FILE", help="FILE.html, or FILE.pdf if there is a browser"
    )
    book.add_argument(
        "--api", action="store_true", help="the library's public names with their docstrings instead of the lessons"
    )
    book.add_argument("--browser", metavar="PROGRAM", help="the Chromium, Chrome or Edge that prints the PDF")


def _add_badges(subparsers) -> None:
    _add(subparsers, "badges", "let the lessons' Colab badges point to the Repository in pyproject.toml")


def _add_assignment(subparsers) -> None:
    assignment = _add(subparsers, "assignment", "write the student's copy of lessons, and their source for nbgrader")
    assignment.add_argument("lessons", nargs="*", metavar="LESSON", help="numbers of lessons, such as 04")
    text = "folder to write into; nothing is overwritten"
    assignment.add_argument("--out", action=Once, required=True, metavar="DIR", help=text)
    assignment.add_argument("--student", action="store_true", help="the student's copy alone, without any solution")
    assignment.add_argument("--course", action="store_true", help="the whole course instead, without all answers")


def _add_json(parser) -> None:
    parser.add_argument("--json", action="store_true", help="print one JSON object and nothing else")
