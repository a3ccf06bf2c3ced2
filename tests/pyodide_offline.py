"""Make a folder with enough of Pyodide to start a kernel offline: ``python tests/pyodide_offline.py FOLDER``.

The runtime is npm's package of the version that the installed kernel asks for. The wheels that a kernel loads when it
starts are those of the same versions on PyPI; they are not byte for byte what Pyodide hands out, so the lock gets their
checksums. NumPy, SciPy and matplotlib for Pyodide are in neither place, and so not in the folder.
"""

import hashlib
import json
import shutil
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

STARTS_WITH = ("micropip", "ipython", "jedi")
COMM = "0.2.3"  # the kernel takes it from PyPI: it is not in Pyodide's lock


def version() -> str:
    """The version of Pyodide that the installed kernel asks for."""
    from jupyterlite_pyodide_kernel.constants import PYODIDE_VERSION

    return PYODIDE_VERSION


def unpack_runtime(folder: Path) -> None:
    """npm's package of Pyodide into ``folder``."""
    with tempfile.TemporaryDirectory() as temporary:
        command = [shutil.which("npm"), "pack", "--silent", f"pyodide@{version()}", "--pack-destination", temporary]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        (archive,) = Path(temporary).glob("*.tgz")
        with tarfile.open(archive) as packed:
            packed.extractall(temporary, filter="data")
        shutil.copytree(Path(temporary) / "package", folder)


def with_dependencies(packages: dict, names) -> set[str]:
    """The names, and all that they depend on."""
    found, to_do = set(), list(names)
    while to_do:
        name = to_do.pop().replace("_", "-")
        if name not in found:
            found.add(name)
            to_do += packages[name]["depends"]
    return found


def download(name: str, exact: str, folder: Path) -> Path:
    """The pure wheel of one package from PyPI."""
    with tempfile.TemporaryDirectory() as temporary:
        options = ["--quiet", "--no-deps", "--only-binary", ":all:", "--python-version", "3.14", "--dest", temporary]
        subprocess.run([sys.executable, "-m", "pip", "download", *options, f"{name}=={exact}"], check=True)
        (wheel,) = Path(temporary).glob("*-none-any.whl")
        return Path(shutil.move(wheel, folder / wheel.name))


def main(folder: Path) -> None:
    unpack_runtime(folder)
    lock = json.loads((folder / "pyodide-lock.json").read_text(encoding="utf-8"))
    packages = lock["packages"]
    packages["comm"] = {**packages["micropip"], "name": "comm", "version": COMM, "imports": ["comm"], "depends": []}
    for name in sorted(with_dependencies(packages, [*STARTS_WITH, "comm"])):
        wheel = download(name, packages[name]["version"], folder)
        packages[name]["file_name"] = wheel.name
        packages[name]["sha256"] = hashlib.sha256(wheel.read_bytes()).hexdigest()
    (folder / "pyodide-lock.json").write_text(json.dumps(lock), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
