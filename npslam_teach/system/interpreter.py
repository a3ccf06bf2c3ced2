"""Choose the interpreter of a command and start the command over on it, with nothing but the standard library.

An interpreter that already satisfies ``environment.txt`` (a hub's image, conda, another virtual environment) is used as
it is; otherwise the course's own environment is used, and made if it is missing. Packages that ``PYTHONPATH`` puts
before those of the interpreter, as a terminal of ROS does, are left out wherever the others are enough.

This file must parse on Python 3.6, so that an old interpreter can report its age: hence the quoted annotations.
"""

import contextlib
import os
import subprocess
import sys
from pathlib import Path

from npslam_teach.system.environment import Environment, SetupError, set_up
from npslam_teach.system.interruption import critical_section
from npslam_teach.system.locking import PACKAGE, say

OLDEST_PYTHON = (3, 11)


def enter_environment(arguments: "list[str]", root: "Path | None" = None) -> None:
    """Return if this interpreter has all of ``environment.txt``; otherwise start the command over on one that has.

    Args:
        arguments: what follows ``python3 -m npslam_teach`` on the command line.
        root: the folder that holds ``environment.txt``; by default the parent of this package.

    Raises:
        SystemExit: 2 after one sentence on standard error if no such interpreter is found or can be made; 130 after
            Ctrl-C.
    """
    root = root or Path(__file__).absolute().parent.parent.parent
    try:
        check_python(sys.version_info[:3])
        python = find_interpreter(Environment(root))
    except SetupError as error:
        say(str(error))
        raise SystemExit(2) from None
    except KeyboardInterrupt:
        say("interrupted; a set-up that was under way is done again by the next call.")
        raise SystemExit(130) from None
    if python is not None:
        start_over(python, arguments, root)


def check_python(version: "tuple[int, ...]") -> None:
    """Raise SetupError if a version of Python, such as ``(3, 9, 2)``, is too old for the course."""
    if version < OLDEST_PYTHON:
        found = ".".join(map(str, version))
        remedy = "install it, for example from https://www.python.org, and start this command with it."
        raise SetupError(f"Python 3.11 or newer is needed and this is {found}: {remedy}")


def find_interpreter(environment: Environment) -> "Path | None":
    """Return the interpreter to start over on, made if necessary; None if the current one can be used."""
    if not environment.requirements.exists():
        return None  # installed from a wheel, which brought its dependencies along
    foreign = foreign_packages(environment.root)
    if environment.is_current():
        if environment.is_stamped():
            return environment.python if foreign else None
    elif satisfies(environment.requirements, foreign):
        _show_to_children(environment.root)
        return Path(sys.executable) if foreign else None
    elif foreign and satisfies(environment.requirements):
        _show_to_children(environment.root)  # some clusters provide even NumPy in this way
        return None
    if not (environment.is_stamped() and environment.is_intact()):
        set_up(environment)
    return environment.python


def satisfies(requirements: Path, without: "list[str]" = ()) -> bool:
    """Return whether the current interpreter has everything that the requirements file asks for.

    Args:
        requirements: the file.
        without: folders that do not count.
    """
    whole_path = sys.path[:]
    sys.path[:] = [entry for entry in whole_path if entry not in without]
    try:
        return _has_all(requirements)
    finally:
        sys.path[:] = whole_path


def _has_all(requirements: Path) -> bool:
    try:
        from importlib.metadata import PackageNotFoundError, version

        from packaging.requirements import Requirement
        from packaging.version import Version
    except ImportError:
        return False  # JupyterLab depends on packaging: without it there is no JupyterLab either
    lines = (line.split("#")[0].strip() for line in requirements.read_text(encoding="utf-8").splitlines())
    try:
        wanted = [Requirement(line) for line in lines if line]
        wanted = [each for each in wanted if each.marker is None or each.marker.evaluate()]
        return all(each.specifier.contains(Version(version(each.name)), prereleases=True) for each in wanted)
    except (PackageNotFoundError, KeyError, TypeError, ValueError):
        return False  # missing, or half removed, or a line that is not a plain requirement


def start_over(python: Path, arguments: "list[str]", root: Path) -> None:
    """Run the course's command on an interpreter in place of this process, with its own packages and the course's."""
    os.environ["PYTHONPATH"] = str(root)
    os.environ.pop("PYTHONHOME", None)
    replace_process([str(python), "-m", PACKAGE, *arguments])


def replace_process(command: "list[str]") -> None:
    """Run a command in place of this process, with its exit code and its signals; does not return."""
    if os.name != "nt":
        os.execv(command[0], command)
    # On Windows, exec would leave the command running behind the prompt. The child handles Ctrl-C.
    with critical_section(), subprocess.Popen(command) as child:
        while True:
            with contextlib.suppress(KeyboardInterrupt):
                raise SystemExit(child.wait())


def foreign_packages(root: Path) -> "list[str]":
    """Return the folders of PYTHONPATH other than the course's own."""
    paths = os.environ.get("PYTHONPATH", "").split(os.pathsep)
    return [path for path in paths if path and not (os.path.isdir(path) and os.path.samefile(path, str(root)))]


def _show_to_children(root: Path) -> None:
    """Let kernels and workers, which start in other folders, import the package, which is not installed."""
    paths = os.environ.get("PYTHONPATH", "").split(os.pathsep)
    os.environ["PYTHONPATH"] = os.pathsep.join([str(root)] + [p for p in paths if p not in ("", str(root))])
