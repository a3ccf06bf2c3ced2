"""Makes the course's environment, with nothing but the standard library.

The environment is the folder ``.venv`` beside this package. It counts as ready only while its stamp holds the
sha256 of ``environment.txt``. The stamp is removed before anything is touched and written last, so an interrupted
set-up leaves no stamp, and the next call makes the environment anew. ``interpreter`` decides when it is needed.

This file must parse on Python 3.6, so that an old interpreter can report its age: hence the quoted annotations.
"""

import contextlib
import hashlib
import os
import subprocess
import sys
from pathlib import Path

from npslam_teach.system.locking import PACKAGE, hold_lock, say

REPAIR = "on Debian or Ubuntu run `sudo apt install python3-venv`, elsewhere reinstall Python, and try again."
STANDARD_ERROR = 2  # the descriptor, not sys.stderr: only a descriptor can be handed to another process


class SetupError(Exception):
    """The environment cannot be made; the message is one sentence that says what to do about it."""


class Environment:
    """The files of the environment of the course in ``root``, the folder that holds the package."""

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
        """Return whether the last set-up was completed, and for the present ``environment.txt``."""
        try:
            return self.stamp.read_text() == self.digest()
        except (OSError, ValueError):  # missing, or not text
            return False

    def is_current(self) -> bool:
        """Return whether this process runs on the environment's own interpreter."""
        return self.folder.exists() and os.path.samefile(sys.prefix, str(self.folder))

    def is_intact(self) -> bool:
        """Return whether the interpreter runs and finds the packages (after an upgrade of Python it may not)."""
        site_packages = self.site_packages()
        return site_packages is not None and (site_packages / f"{PACKAGE}.pth").exists()

    def is_foreign(self) -> bool:
        """Return whether something else made the folder: an editor, or a person by hand."""
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
    """Make an empty virtual environment with pip in it, in place of what was there."""
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
    # A pip.conf that names another folder to install into would leave this one empty.
    folder = environment.folder.absolute()
    options += ["--target=", "--prefix=" + str(folder), "--root=" + folder.anchor]
    command = ["-m", "pip", "install", *options, "-r", str(environment.requirements)]
    if run_python(environment, command, lock) != 0:
        remedy = "check the network (behind a proxy, set HTTPS_PROXY) and the free space, and try again."
        raise SetupError(f"pip could not install environment.txt for the reason above: {remedy}")
    if run_python(environment, ["-m", f"{PACKAGE}.system.verification", str(environment.requirements)], lock) != 0:
        remedy = "see what `pip config list` says, and try again."
        raise SetupError(f"pip has installed environment.txt, and it cannot be used for the reason above: {remedy}")


def run_python(environment: Environment, arguments: "list[str]", lock: int) -> int:
    """Run the environment's interpreter on its own packages alone and return its exit code.

    Its output goes to standard error, because the JSON of ``--json`` must be all that is on standard output. It
    inherits the lock, so that a pip that outlives its killed parent still keeps other set-ups waiting.
    """
    inherited = () if os.name == "nt" else (lock,)
    command = [str(environment.python), "-I", *arguments]
    return subprocess.call(command, stdin=subprocess.DEVNULL, stdout=STANDARD_ERROR, pass_fds=inherited)


def write_stamp(environment: Environment, digest: str) -> None:
    """Declare the environment complete, in one atomic step."""
    temporary = environment.stamp.with_suffix(".new")
    temporary.write_text(digest)
    os.replace(str(temporary), str(environment.stamp))
