"""Worlds to begin with in "draw your own world": one that the method handles well, and five that break it.

Each of the five breaks it in another way, and comes with the same world without the defect for comparison.
"""

from dataclasses import dataclass, replace

import numpy as np

from npslam_teach.simulate.fifteen_objects import FIFTEEN_CLASSES
from npslam_teach.simulate.hand_drawn import Drawing

ROOM = (0.0, 0.0, 12.0, 8.0)  # m
CORRIDOR = (0.0, 0.0, 36.0, 9.0)  # m
_POINT_EVERY = 0.2  # m along the lines of the gallery

# Five classes of three; the nearest two of one class are 5 m apart.
_FIFTEEN = (
    *((1.0, 1.2, "chair"), (3.6, 0.8, "screen"), (6.0, 1.1, "cup"), (8.6, 0.7, "book"), (11.0, 1.3, "lamp")),
    *((0.8, 4.0, "cup"), (3.4, 4.1, "book"), (6.1, 3.0, "lamp"), (8.4, 4.2, "chair"), (11.2, 4.0, "screen")),
    *((1.2, 6.9, "lamp"), (3.7, 7.2, "chair"), (6.1, 6.6, "screen"), (8.5, 7.3, "cup"), (10.9, 6.8, "book")),
)


@dataclass(frozen=True, eq=False)
class GalleryWorld:
    """A world with one defect, and the same world without it."""

    title: str
    look_for: str  # one sentence: what to look at
    drawing: Drawing
    without: Drawing
    cure: str  # how the world without the defect differs


def figure_of_eight(rounds: float = 2.0) -> np.ndarray:
    """A line (N, 2) m through the middle of the room, 22 m in each round."""
    phase = np.linspace(0.0, 2 * np.pi * rounds, 4000)
    return _thinned(np.column_stack([6.0 + 4.2 * np.sin(phase), 4.0 + 2.6 * np.sin(2 * phase)]))


def ellipse(rounds: float = 2.0) -> np.ndarray:
    """A line (N, 2) m around the middle of the room, 20 m in each round."""
    phase = np.linspace(0.0, 2 * np.pi * rounds, 4000)
    return _thinned(np.column_stack([6.0 + 4.0 * np.cos(phase), 4.0 + 2.4 * np.sin(phase)]))


def straight(length: float, start=(1.0, 4.5)) -> np.ndarray:
    """A line (N, 2) m to the right."""
    return _thinned(np.array([start, (start[0] + length, start[1])]))


def there_and_back(length: float, start=(1.0, 3.75), apart: float = 1.5) -> np.ndarray:
    """A line (N, 2) m to the right, a half circle to the left, and back beside it."""
    x, y = start
    turn = np.linspace(-np.pi / 2, np.pi / 2, 50)
    bend = np.column_stack([x + length + apart / 2 * np.cos(turn), y + apart / 2 * (1 + np.sin(turn))])
    return _thinned(np.concatenate([[start], bend, [(x, y + apart)]]))


def drawn_fifteen(**changes) -> Drawing:
    """Fifteen objects of five classes in a room of 12 m x 8 m, and a figure of eight driven twice.

    Args:
        **changes: fields of ``Drawing`` to replace.
    """
    scene = {"stroke": figure_of_eight(), "class_names": FIFTEEN_CLASSES, "room": ROOM} | _objects(_FIFTEEN)
    return Drawing(**(scene | changes))


def _objects(objects) -> dict:
    """The fields of ``Drawing`` for (x, y, name of the class)."""
    classes = [FIFTEEN_CLASSES.index(name) for _, _, name in objects]
    return {"object_xy": [(x, y) for x, y, _ in objects], "object_class": classes}


def _thinned(xy: np.ndarray) -> np.ndarray:
    """The same line with a point every 20 cm."""
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(xy, axis=0), axis=1))])
    even = np.linspace(0.0, along[-1], round(along[-1] / _POINT_EVERY) + 1)
    return np.column_stack([np.interp(even, along, xy[:, axis]) for axis in (0, 1)]).round(3)


_HEALTHY = drawn_fifteen()  # three of the worlds without their defect


def _twins() -> GalleryWorld:
    def second(name):
        return drawn_fifteen(**_objects((*_FIFTEEN, (8.9, 4.2, name))))

    return GalleryWorld(
        "two look-alike chairs",
        "Look at the two chairs on the right of the middle, 0.5 m apart: the map has one chair between them.",
        second("chair"),
        second("lamp"),
        "the second chair is a lamp",
    )


def _corridor() -> GalleryWorld:
    sides = ((2.5 + 2.1 * k, 6.0 if k % 2 else 3.0, FIFTEEN_CLASSES[k % 5]) for k in range(16))
    furnished = {"class_names": FIFTEEN_CLASSES, "room": CORRIDOR} | _objects(tuple(sides))
    return GalleryWorld(
        "a long corridor",
        "Look at the path, not at the count: every object is found, once, and yet the map is bent.",
        Drawing(stroke=straight(34.0), **furnished),
        Drawing(stroke=there_and_back(16.0), **furnished),
        "the robot turns half-way and comes back",
    )


def _one_class() -> GalleryWorld:
    return GalleryWorld(
        "all of one class",
        "Look at the count: nothing but the place tells chair from chair, and the drifted place is wrong.",
        drawn_fifteen(object_class=np.zeros(len(_FIFTEEN), dtype=int)),
        _HEALTHY,
        "five classes again",
    )


def _moving() -> GalleryWorld:
    goal = np.array(_HEALTHY.object_xy)
    goal[12] = (6.1, 0.8)
    return GalleryWorld(
        "a moving object",
        "Look along the dashed arrow, where one screen is wheeled across the room: it is counted again and again.",
        replace(_HEALTHY, object_goal=goal),
        _HEALTHY,
        "the screen stays",
    )


def _false_detector() -> GalleryWorld:
    return GalleryWorld(
        "a false detector",
        "Look at the lone small markers: each is an object that was seen once and never was there.",
        drawn_fifteen(clutter_rate=0.1),
        _HEALTHY,
        "no false observations",
    )


GALLERY = {
    "twins": _twins(),
    "corridor": _corridor(),
    "one-class": _one_class(),
    "moving": _moving(),
    "false-detector": _false_detector(),
}
