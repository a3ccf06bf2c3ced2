"""Saving a lesson that was only opened leaves its file as it was, byte for byte.

JupyterLab writes the language of the running kernel into a notebook as soon as it is open, down to Python's version,
and saves it after two minutes. A reader who has changed nothing would then have a changed file, and the next
``git pull`` would refuse. The server that ``lab`` starts calls this before it writes.
"""

import json
from pathlib import Path


def keep_what_was_there(path: str, model: dict, contents_manager, **_) -> None:
    """A hook for ``FileContentsManager.pre_save_hook``: the language and the kernel's name stay as the file has them.

    Args:
        path: of the notebook, below the server's root.
        model: what is to be written, as the server has it; changed in place.
        contents_manager: knows the root.
    """
    content = model.get("content")
    if model.get("type") != "notebook" or not isinstance(content, dict):
        return
    before, now = _metadata(Path(contents_manager.root_dir) / path), content.get("metadata", {})
    if _kernel(before) != _kernel(now):
        return  # somebody has chosen another one
    for key in ("language_info", "kernelspec"):
        if key in before:
            now[key] = before[key]


def _metadata(file: Path) -> dict:
    """Those of the notebook as it is on the disk; none where there is no such file yet."""
    try:
        return json.loads(file.read_text(encoding="utf-8")).get("metadata", {})
    except (OSError, ValueError):
        return {}


def _kernel(metadata: dict) -> str | None:
    return metadata.get("kernelspec", {}).get("name")
