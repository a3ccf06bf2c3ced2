"""The course as a JupyterLite site: files for any web server, and Python that runs in the reader's browser.

The site holds our wheel, the lessons and the pictures they show. Pyodide, NumPy, SciPy and matplotlib come from
Pyodide's own distribution, and what that lacks from PyPI, when a reader opens the page.
"""

import json
import os
import shutil
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

from npslam_teach.publishing import lessons

MARKER = "npslam_teach-site.json"
# The extensions that a lesson needs; others that are installed where the site is built are left out.
_EXTENSIONS = ("@jupyter-widgets/jupyterlab-manager", "@jupyterlite/pyodide-kernel-extension", "anywidget")
_SOURCES = ("npslam_teach", "pyproject.toml", "README.md", "LICENSE")


def build_site(root: Path, out: Path, pyodide: Path | None = None) -> Path:
    """Build the site in a folder beside ``out`` and put it there when it is complete.

    Args:
        root: the course's folder.
        out: the folder to make; it does not exist, is empty, or holds a site that this function built.
        pyodide: a folder with a distribution of Pyodide to serve with the site, so that readers need no other host for
            what is in it.

    Returns:
        the path of the site.

    Raises:
        FileNotFoundError: the folder around ``out``, or the distribution, does not exist.
        ValueError: ``out`` holds something else, a package is missing, or the build failed.
    """
    out = Path(os.path.realpath(out))
    require_packages(root / "pyproject.toml")
    _check_out(out)
    _check_pyodide(pyodide)
    with tempfile.TemporaryDirectory(prefix=f".{out.name}-", dir=out.parent) as temporary:
        source, site = Path(temporary) / "source", Path(temporary) / "site"
        _copy_lessons(root, source / "files")
        wheel = build_wheel(root, source / "pypi")
        if pyodide is not None:
            shutil.copytree(pyodide, source / "static" / "pyodide")
        _run_jupyterlite(source, site)
        (site / MARKER).write_text(json.dumps({"wheel": wheel.name}), encoding="utf-8")
        _put_in_place(site, out, Path(temporary) / "previous")
    return out


def requirements(pyproject: Path) -> list[str]:
    """What building a site needs beyond the course's environment."""
    project = tomllib.loads(pyproject.read_text(encoding="utf-8"))["project"]
    return project["optional-dependencies"]["site"]


def require_packages(pyproject: Path) -> None:
    """Raise ValueError with the remedy if one of ``requirements`` is not installed."""
    from importlib.metadata import PackageNotFoundError, version

    from packaging.requirements import Requirement

    for line in requirements(pyproject):
        wanted = Requirement(line)
        try:
            found = version(wanted.name)
        except PackageNotFoundError:
            found = None
        if found is None or not wanted.specifier.contains(found, prereleases=True):
            quoted = " ".join(f'"{each}"' for each in requirements(pyproject))
            remedy = f'run "{sys.executable}" -m pip install {quoted}'
            raise ValueError(f"a site needs {line}, got {found or 'nothing of that name'}: {remedy}")


def build_wheel(root: Path, folder: Path) -> Path:
    """Build the course's wheel into ``folder``, without the network, and return its path.

    Raises:
        ValueError: pip failed; the message ends with the last line of its output.
    """
    folder.mkdir(parents=True)
    with tempfile.TemporaryDirectory() as temporary:
        # A copy, because setuptools leaves a folder `build` behind, and reuses files of an older one.
        copy = Path(temporary) / "course"
        for name in _SOURCES:
            if (root / name).is_dir():
                shutil.copytree(root / name, copy / name, ignore=shutil.ignore_patterns("__pycache__"))
            else:
                shutil.copy2(root / name, copy / name)
        options = ["--quiet", "--no-deps", "--no-build-isolation", "--no-index", "--disable-pip-version-check"]
        _run(["pip", "wheel", *options, "--wheel-dir", str(folder), str(copy)], Path(temporary))
    (wheel,) = folder.glob("*.whl")
    return wheel


def _check_out(out: Path) -> None:
    if not out.parent.is_dir():
        raise FileNotFoundError(f"{out}: expected a folder to write into, found no folder {out.parent}")
    if out.exists() and not out.is_dir():
        raise ValueError(f"{out}: expected the name of a folder, got that of a file")
    if out.exists() and any(out.iterdir()) and not (out / MARKER).is_file():
        raise ValueError(f"{out}: expected no folder, an empty one or an earlier site, got one with other files in it")


def _check_pyodide(folder: Path | None) -> None:
    for name in ("pyodide.mjs", "pyodide-lock.json"):
        if folder is not None and not (folder / name).is_file():
            raise FileNotFoundError(f"--pyodide {folder}: expected a distribution of Pyodide, found no {name} in it")


def _copy_lessons(root: Path, files: Path) -> None:
    """Lessons and pictures keep their places relative to each other, so the links between them hold."""
    paths = lessons.lesson_paths(root / "notebooks")
    pictures = {file for path in paths for file in lessons.picture_files(path)}
    for path in [*(path.resolve() for path in paths), *sorted(pictures)]:
        target = files / path.relative_to(root.resolve())
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(path, target)


def _run_jupyterlite(source: Path, site: Path) -> None:
    settings = {
        "apps": ["lab"],
        "federated_extensions": [str(path) for path in _extensions()],
        "ignore_sys_prefix": ["federated_extensions"],
        "no_sourcemaps": True,
        "output_dir": str(site),
    }
    configuration = source / "jupyter_lite_config.json"
    configuration.write_text(json.dumps({"LiteBuildConfig": settings}), encoding="utf-8")
    # It records in the current folder what is up to date, so that must be a new one.
    _run(["jupyterlite_core", "build", "--lite-dir", str(source)], source)


def _extensions() -> list[Path]:
    from jupyter_core.paths import jupyter_path

    found = [[path for path in map(Path, jupyter_path("labextensions", name)) if path.is_dir()] for name in _EXTENSIONS]
    return [paths[0] for paths in found if paths]


def _run(arguments: list[str], folder: Path) -> None:
    """Run ``python -m``; raises ValueError with one sentence that ends with the last line of the output."""
    command = [sys.executable, "-m", *arguments]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, encoding="utf-8", errors="replace")
    if done.returncode != 0:
        said = (done.stderr + done.stdout).strip().splitlines() or ["nothing"]
        raise ValueError(f"{arguments[0]} could not build its part of the site and said: {said[-1]}")


def _put_in_place(site: Path, out: Path, previous: Path) -> None:
    """Two renames; when the second one fails, the first is undone."""
    if not out.exists():
        site.rename(out)
        return
    out.rename(previous)
    try:
        site.rename(out)
    except OSError:
        previous.rename(out)
        raise
