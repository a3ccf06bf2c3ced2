"""The course as students get it: all that runs and reads, without solutions, the guide's answers and the tests."""

import re
import shutil
from pathlib import Path

KEPT = ("LICENSE", "README.md", "environment.txt", "pyproject.toml", ".gitignore", ".binder", "figures", "npslam_teach")
ANSWERS = ("solutions", "teaching_guide.md")  # of the folder ``notebooks``
_NOT_OURS = shutil.ignore_patterns("__pycache__", "*.pyc", ".ipynb_checkpoints", *ANSWERS)


def write_student_course(root: Path, out: Path) -> Path:
    """Copy the course without its answers, for a branch or a repository that students pull from.

    Args:
        root: the copy of the repository.
        out: the folder to make.

    Raises:
        ValueError: it exists and is not empty.
    """
    if out.exists() and any(out.iterdir()):
        raise ValueError(f"--out {out}: expected a new folder or an empty one, found files in it")
    out.mkdir(parents=True, exist_ok=True)
    for name in (*KEPT, "notebooks"):
        source = root / name
        if source.is_dir():
            shutil.copytree(source, out / name, ignore=_NOT_OURS)
        elif source.exists():
            shutil.copy2(source, out / name)
    for path in (out / "README.md", *sorted((out / "notebooks").glob("*.*"))):
        if path.suffix in (".md", ".ipynb"):
            text = path.read_text(encoding="utf-8")
            path.write_text(without_answers(text), encoding="utf-8")
    return out


def without_answers(text: str) -> str:
    """Links to solutions, to the guide and to the tests become plain words: what they lead to is not there."""
    return re.sub(r"\[([^\]\n]+)\]\((?:[^)\s]*(?:solutions/|teaching_guide\.md)[^)\s]*|tests/[^)\s]*)\)", r"\1", text)
