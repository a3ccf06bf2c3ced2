"""Makes the course's environment and starts over in it, with nothing but the standard library.

The environment is the folder ``.venv`` beside this package. It counts as ready only while its stamp holds the
sha256 of ``environment.txt``. The stamp is removed before anything is touched and written last, so whatever
interrupts a set-up leaves no stamp, and the next call makes the environment anew. An interpreter that already
satisfies ``environment.txt`` (a hub's image, conda, another virtual environment) is used as it is.

This file must parse on Python 3.6, so that an old interpreter can say so: hence the quoted annotations.
"""

import contextlib
import hashlib
import os
import subprocess
import sys
from pathlib import Path

from npslam_teach.system.interruption import critical_section
from npslam_teach.system.locking import PACKAGE, hold_lock, say

OLDEST_PYTHON = (3, 11)
REPAIR = "on Debian or Ubuntu run `sudo apt install python3-venv`, elsewhere reinstall Python, and try again."
STANDARD_ERROR = 2  # the descriptor, not sys.stderr: only a descriptor can be handed to another process


class SetupError(Exception):
    """The environment cannot be made; the message is one sentence that says what to do about it."""


class Environment:
    """What belongs to the environment of the course in ``root``, the folder that holds the package."""

    def __init__(self, root: Path) -> None:
        self.root = root
        self.requirements = root / "environment.txt"
        self.folder = root / ".venv"
        self.lock = root / ".venv.lock"
        self.stamp = self.folder / "environment.sha256"
        self.python = self.folder / ("Scripts/python.exe" if os.name == "nt" else "bin/python")

    def digest(self) -> str:
        """Return what the stamp holds once everything in ``environment.txt`` is installed."""
        return hashlib.sha256(self.requirements.read_bytes()).hexdigest()

    def is_stamped(self) -> bool:
        """Tell whether the last set-up was completed, and for the present ``environment.txt``."""
        try:
            return self.stamp.read_text() == self.digest()
        except (OSError, ValueError):  # not there, or not text
            return False

    def is_current(self) -> bool:
        """Tell whether this process runs on the environment's own interpreter."""
        return self.folder.exists() and os.path.samefile(sys.prefix, str(self.folder))

    def is_intact(self) -> bool:
        """Tell whether the interpreter runs and finds the packages (not so after an upgrade of Python)."""
        site_packages = self.site_packages()
        return site_packages is not None and (site_packages / f"{PACKAGE}.pth").exists()

    def is_foreign(self) -> bool:
        """Tell whether somebody else made the folder: an editor, or a person by hand."""
        settings = self.folder / "pyvenv.cfg"
        own_line = f"prompt = {PACKAGE!r}"
        return settings.exists() and own_line not in settings.read_text(errors="replace").splitlines()

    def site_packages(self) -> "Path | None":
        """Ask the interpreter for its ``site-packages``; None if it is missing or does not run."""
        code = "import os, sys, sysconfig as s; sys.stdout.buffer.write(os.fsencode(s.get_path('purelib')))"
        try:
            answer = subprocess.check_output([str(self.python), "-I", "-c", code], stderr=subprocess.DEVNULL)
        except (OSError, subprocess.CalledProcessError):
            return None
        return Path(os.fsdecode(answer))


def enter_environment(arguments: "list[str]", root: "Path | None" = None) -> None:
    """Return in an interpreter that has all of ``environment.txt``, or start the command over in one.

    Args:
        arguments: what follows ``python3 -m npslam_teach`` on the command line.
        root: the folder that holds ``environment.txt``; by default the parent of this package.

    Raises:
        SystemExit: 2 after one sentence on standard error if there can be none, 130 after Ctrl-C.
    """
    try:
        check_python(sys.version_info[:3])
        python = find_interpreter(Environment(root or Path(__file__).absolute().parent.parent.parent))
    except SetupError as error:
        say(str(error))
        raise SystemExit(2) from None
    except KeyboardInterrupt:
        say("interrupted; a set-up that was under way is done again by the next call.")
        raise SystemExit(130) from None
    if python is not None:
        start_over(python, arguments)


def check_python(version: "tuple[int, ...]") -> None:
    """Raise SetupError if a version of Python, such as ``(3, 9, 2)``, is too old for the course."""
    if version < OLDEST_PYTHON:
        found = ".".join(map(str, version))
        remedy = "install it, for example from https://www.python.org, and start this command with it."
        raise SetupError(f"Python 3.11 or newer is needed and this is {found}: {remedy}")


def find_interpreter(environment: Environment) -> "Path | None":
    """Return the interpreter to start over in, made if need be; None if the current one will do."""
    if not environment.requirements.exists():
        return None  # installed from a wheel, which brought its dependencies along
    if environment.is_current():
        if environment.is_stamped():
            # A terminal of ROS, for one, puts its own packages before those of any environment.
            return environment.python if foreign_packages(environment.root) else None
    elif satisfies(environment.requirements):
        _show_to_children(environment.root)
        return None
    if not (environment.is_stamped() and environment.is_intact()):
        set_up(environment)
    return environment.python


def satisfies(requirements: Path) -> bool:
    """Tell whether the current interpreter has everything that the requirements file asks for."""
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
        return False  # not there, or half removed, or a line that is not a plain requirement


def set_up(environment: Environment) -> None:
    """Make the environment or bring it up to date, unless another process just did."""
    try:
        with hold_lock(environment.lock) as lock:
            intact = environment.stamp.exists() and environment.is_intact()
            if intact and environment.is_stamped():
                return
            if environment.is_foreign():
                remedy = "activate it and run `pip install -r environment.txt`, or give it another name, and try again."
                raise SetupError(f"{environment.folder} was not made by this command: {remedy}")
            digest = environment.digest()  # before pip reads the file: a later edit must not be stamped
            with contextlib.suppress(FileNotFoundError):
                environment.stamp.unlink()
            if intact:
                say("environment.txt has changed: updating .venv.")
            else:
                say("setting up .venv for this course, which takes about a minute.")
                create(environment, lock)
            install(environment, lock)
            write_stamp(environment, digest)
    except (OSError, ValueError) as error:  # venv raises ValueError for a folder whose name it cannot use
        remedy = "move the course to a folder that you may write to, with 1 GB free, and try again."
        raise SetupError(f"cannot write {environment.folder} ({error}): {remedy}") from error


def create(environment: Environment, lock: int) -> None:
    """Make an empty virtual environment with pip in it, in place of whatever stood there."""
    try:
        import ensurepip  # noqa: F401 - Debian keeps it in a package of its own
        import venv
    except ImportError as error:
        raise SetupError(f"this Python lacks its modules venv and ensurepip: {REPAIR}") from error
    venv.EnvBuilder(clear=True, symlinks=os.name != "nt", prompt=PACKAGE).create(str(environment.folder))
    # EnvBuilder's own with_pip does the same, but without our lock and without showing why it failed.
    if run_python(environment, ["-m", "ensurepip", "--upgrade", "--default-pip"], lock) != 0:
        raise SetupError(f"pip could not be put into .venv for the reason above: {REPAIR}")


def install(environment: Environment, lock: int) -> None:
    """Install ``environment.txt`` and make the package importable from every kernel of the environment."""
    site_packages = environment.site_packages()
    if site_packages is None:
        raise SetupError(f"{environment.python} does not run: {REPAIR}")
    # Relative to site-packages, so that it still holds after the whole folder has moved.
    path = os.path.relpath(str(environment.root), str(site_packages))
    (site_packages / f"{PACKAGE}.pth").write_text(path + "\n", encoding="utf-8")
    # A pip.conf that asks for --user would stop pip in any virtual environment; --no-user overrules it.
    options = ["--no-user", "--no-input", "--disable-pip-version-check", "--prefer-binary"]
    command = ["-m", "pip", "install", *options, "-r", str(environment.requirements)]
    if run_python(environment, command, lock) != 0:
        remedy = "check the network (behind a proxy, set HTTPS_PROXY) and the free space, and try again."
        raise SetupError(f"pip could not install environment.txt for the reason above: {remedy}")


def run_python(environment: Environment, arguments: "list[str]", lock: int) -> int:
    """Run the environment's interpreter on its own packages alone and return its exit code.

    All that it prints goes to standard error, because the command's ``--json`` must stand alone on standard
    output. It inherits the lock, so that a pip that outlives its killed parent still keeps others away.
    """
    inherited = () if os.name == "nt" else (lock,)
    command = [str(environment.python), "-I", *arguments]
    return subprocess.call(command, stdin=subprocess.DEVNULL, stdout=STANDARD_ERROR, pass_fds=inherited)


def write_stamp(environment: Environment, digest: str) -> None:
    """Declare the environment complete, in one step that happens or does not."""
    temporary = environment.stamp.with_suffix(".new")
    temporary.write_text(digest)
    os.replace(str(temporary), str(environment.stamp))


def start_over(python: Path, arguments: "list[str]") -> None:
    """Run the course's command on another interpreter in place of this process, with its own packages alone."""
    for name in ("PYTHONPATH", "PYTHONHOME"):
        os.environ.pop(name, None)
    replace_process([str(python), "-m", PACKAGE, *arguments])


def replace_process(command: "list[str]") -> None:
    """Run a command in place of this process, with its exit code and its signals; does not return."""
    if os.name != "nt":
        os.execv(command[0], command)
    # On Windows, exec would leave the command running behind the prompt. Ctrl-C is the child's to answer.
    with critical_section(), subprocess.Popen(command) as child:
        while True:
            with contextlib.suppress(KeyboardInterrupt):
                raise SystemExit(child.wait())


def foreign_packages(root: Path) -> "list[str]":
    """Name the folders beside this one in which PYTHONPATH looks for packages."""
    paths = os.environ.get("PYTHONPATH", "").split(os.pathsep)
    return [path for path in paths if path and not (os.path.isdir(path) and os.path.samefile(path, str(root)))]


def _show_to_children(root: Path) -> None:
    """Let kernels and workers, which start in other folders, import the package that nobody installed."""
    paths = os.environ.get("PYTHONPATH", "").split(os.pathsep)
    os.environ["PYTHONPATH"] = os.pathsep.join([str(root)] + [p for p in paths if p not in ("", str(root))])
