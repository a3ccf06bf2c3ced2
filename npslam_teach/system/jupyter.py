"""Jupyter as this course needs it, whatever else is installed: our own kernel, and folders that can be written.

This changes the environment of the processes that a command starts, and nothing on the disk of the user.
"""

import contextlib
import os
import sys
import tempfile
from pathlib import Path

from npslam_teach.system.locking import say

WRITTEN = ("JUPYTER_CONFIG_DIR", "JUPYTER_DATA_DIR", "JUPYTER_RUNTIME_DIR", "IPYTHONDIR", "MPLCONFIGDIR")


def own_jupyter() -> dict[str, str]:
    """Variables under which Jupyter finds the kernel of this interpreter first.

    Otherwise a kernel ``python3`` of the user's, for another Python, would run the lessons wherever it is found first.
    """
    known = os.environ.get("JUPYTER_PATH", "").split(os.pathsep)
    ours = str(Path(sys.prefix, "share", "jupyter"))
    return {"JUPYTER_PREFER_ENV_PATH": "1", "JUPYTER_PATH": os.pathsep.join([ours, *filter(None, known)])}


def writable_folders() -> dict[str, str]:
    """Variables that send Jupyter, IPython and matplotlib to a temporary folder if one of theirs is not writable."""
    if all(_is_writable(Path(folder)) for folder in _usual_folders()):
        return {}
    folder = tempfile.mkdtemp(prefix="npslam_teach-")
    say(f"the home folder cannot be written to; Jupyter's own files are in the temporary folder {folder}.")
    return {name: str(Path(folder, name.lower())) for name in WRITTEN}


def _usual_folders() -> list[str]:
    from jupyter_core.paths import jupyter_config_dir, jupyter_data_dir, jupyter_runtime_dir

    ipython = os.environ.get("IPYTHONDIR") or os.path.expanduser(os.path.join("~", ".ipython"))
    return [jupyter_config_dir(), jupyter_data_dir(), jupyter_runtime_dir(), ipython]


@contextlib.contextmanager
def matplotlib_folder():
    """Meanwhile matplotlib's own files are in a temporary folder if the home folder, where it keeps them, is read-only.

    Otherwise it says so in two lines, after the answer.
    """
    home = os.path.expanduser("~")
    usual = Path(os.environ.get("XDG_CONFIG_HOME") or Path(home, ".config"), "matplotlib")
    if "MPLCONFIGDIR" in os.environ or _is_writable(usual) or _is_writable(Path(home, ".matplotlib")):
        yield
        return
    with tempfile.TemporaryDirectory(prefix="npslam_teach-") as folder:
        os.environ["MPLCONFIGDIR"] = folder
        try:
            yield
        finally:
            del os.environ["MPLCONFIGDIR"]


def _is_writable(folder: Path) -> bool:
    """Whether a file can be made in a folder, which need not exist; what was made for the test is removed."""
    missing = [each for each in (folder, *folder.parents) if not each.exists()]
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return True
    except OSError:
        return False
    finally:
        for each in missing:
            with contextlib.suppress(OSError):
                each.rmdir()
