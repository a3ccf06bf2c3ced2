"""Every figure file of the course: what it is called, what it shows and how it is drawn.

The numbers are those of the deck that the course replaces. Each module holds the figures of some lessons.
"""

from pathlib import Path

from npslam_teach.figures import (
    lesson01,
    lesson02,
    lesson03,
    lesson04,
    lesson05,
    lesson06,
    lesson08,
    lesson09,
    simulation,
)
from npslam_teach.figures.files import draw_files
from npslam_teach.files import atomic_write

MODULES = (
    lesson01,
    lesson02,
    lesson03,
    lesson04,
    lesson05,
    lesson06,
    lesson08,
    lesson09,
    simulation,
)
FIGURES = tuple(sorted((entry for module in MODULES for entry in module.FIGURES), key=lambda entry: entry.name))


def draw_all(folder: Path) -> None:
    """Draw every figure of the course, and an index page with the alternative texts."""
    draw_files(FIGURES, folder)
    with atomic_write(folder / "README.md") as stream:
        stream.write("# Figures\n\n`python3 -m npslam_teach figures` draws them anew, byte for byte.\n")
        for entry in FIGURES:
            stream.write(f"\n## {entry.name}\n\n![{entry.alt}]({entry.name}.png)\n\n{entry.alt}\n")
