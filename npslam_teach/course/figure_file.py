"""What a figure file is, and how it is written."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

from npslam_teach import plotting
from npslam_teach.system.files import atomic_write
from npslam_teach.system.progress import track


@dataclass(frozen=True)
class FigureFile:
    """A figure of the course: its file name without suffix, its alternative text, and how to draw it."""

    name: str  # begins with the number of the deck's figure: fig07_...
    alt: str  # what the picture shows, for those who cannot see it
    draw: Callable  # without arguments; returns a matplotlib Figure


@dataclass(frozen=True)
class FilmFile:
    """A film of the course: its file name without suffix, its alternative text, and how to draw it."""

    name: str
    alt: str  # what happens in it, for those who cannot see it
    draw: Callable[[], bytes]  # an animated GIF


def draw_files(entries: Iterable[FigureFile], folder: Path) -> None:
    """Draw figures into a folder, each as PNG and SVG."""
    entries = list(entries)
    for entry in track(entries, len(entries), "figures", "figures"):
        plotting.save(entry.draw(), folder / entry.name)


def draw_films(entries: Iterable[FilmFile], folder: Path) -> None:
    """Draw films into a folder, each as an animated GIF."""
    for entry in entries:
        with atomic_write(folder / f"{entry.name}.gif", "wb") as stream:
            stream.write(entry.draw())
