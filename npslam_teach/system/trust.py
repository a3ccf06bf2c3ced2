"""Lessons that are as they were committed show their results alive: Jupyter runs no script that it has not signed.

``python -m npslam_teach.system.trust`` is JupyterLab, with Jupyter's own arguments, in a folder whose lessons it signs
first. One process does both, because both import what takes a second to import.
"""

import shutil
import subprocess
import sys
from pathlib import Path


def trust_committed(root: Path) -> list[str]:
    """Sign the lessons that are unchanged since their commit, as Jupyter signs what a user has run.

    Whoever starts the course runs the code of the same commit anyway. What git does not know, what has been changed
    since, and everything where there is no git is left as it is: there results are folded, and forms wait for a run.

    Args:
        root: the copy of the repository.

    Returns:
        the names of what was signed, relative to ``root``.
    """
    import nbformat
    from nbformat.sign import NotebookNotary

    names = [name for name in _unchanged(root) if name.endswith(".ipynb")]
    notary = NotebookNotary()
    try:
        for name in names:
            notary.sign(nbformat.read(root / name, as_version=4))
    finally:
        notary.store.close()
    return names


def _unchanged(root: Path) -> list[str]:
    """The files in ``notebooks`` that git has, and has as they are."""
    if shutil.which("git") is None:
        return []
    answers = []
    for command in ("ls-files -z", "diff --name-only --relative -z HEAD"):
        git = ["git", *command.split(), "--", "notebooks"]
        done = subprocess.run(git, cwd=root, capture_output=True, text=True, stdin=subprocess.DEVNULL)
        if done.returncode != 0:  # no clone, or one of another user
            return []
        answers.append(done.stdout.split("\0"))
    tracked, changed = answers
    return [name for name in tracked if name and name not in changed]


def main() -> int:
    """Sign the lessons of the current folder and be JupyterLab."""
    # To see whether a text is an IRI, which nothing here is, jsonschema imports this where it is installed, and that
    # takes longer than half of all other modules.
    sys.modules.setdefault("rfc3987_syntax", None)
    trust_committed(Path.cwd())
    from jupyterlab import labapp

    return labapp.main()


if __name__ == "__main__":
    sys.exit(main())
