"""Run notebooks from top to bottom and write their outputs back, as they are committed.

``python tests/execute_notebooks.py notebooks/*.ipynb``; afterwards read the difference before committing it.
"""

import os
import sys
from pathlib import Path

import nbformat
from nbclient import NotebookClient

WIDGET = "application/vnd.jupyter.widget-view+json"
KEPT_METADATA = {"kernelspec", "language_info"}


def execute(notebook: nbformat.NotebookNode, folder: Path) -> nbformat.NotebookNode:
    """Execute in ``folder``; raises ``nbclient.exceptions.CellExecutionError`` at the first error."""
    NotebookClient(notebook, timeout=120, resources={"metadata": {"path": str(folder)}}).execute()
    return notebook


def tidy(notebook: nbformat.NotebookNode) -> nbformat.NotebookNode:
    """Drop what changes from run to run and machine to machine: widget state, time stamps, Python's version."""
    notebook.metadata = {key: value for key, value in notebook.metadata.items() if key in KEPT_METADATA}
    notebook.metadata["kernelspec"] = {"display_name": "Python 3 (ipykernel)", "language": "python", "name": "python3"}
    notebook.metadata["language_info"] = {"name": "python"}
    for cell in notebook.cells:
        kept = {"tags", "jupyter", "cellView"} if "install" in cell.metadata.get("tags", []) else {"tags"}
        cell.metadata = {key: value for key, value in cell.metadata.items() if key in kept}
        if cell.cell_type == "code":
            cell.outputs = joined_streams(cell.outputs)
            for output in cell.outputs:
                if "text/html" in output.get("data", {}):
                    # Without its kernel a widget is an error message, and hides the frames that work.
                    output.data.pop(WIDGET, None)
    return notebook


def joined_streams(outputs: list) -> list:
    """What a cell prints may arrive in pieces, differently each time: one piece for each run of prints."""
    joined = []
    for output in outputs:
        if joined and output.output_type == "stream" and joined[-1].get("name") == output.name:
            joined[-1]["text"] += output.text
        else:
            joined.append(output)
    return joined


def main(paths: list[str]) -> None:
    os.environ["NPSLAM_TEACH_FRAMES"] = "1"  # explorers that work without a kernel
    for name in paths:
        path = Path(name)
        print(path, file=sys.stderr)
        notebook = tidy(execute(nbformat.read(path, as_version=4), path.parent))
        nbformat.write(notebook, path)


if __name__ == "__main__":
    main(sys.argv[1:])
