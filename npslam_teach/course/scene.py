"""Scenes: pictures of a few parts that glide from one state to the next and can be taken hold of.

A scene is SVG in pieces: every part has a name, a tag, attributes and perhaps a text. The page moves the part of a name
to its next attributes; the same parts written one after the other are a picture for where no scripts run. Colours of
lines and texts are classes of ``scene.css``, which follow a dark theme; those of objects are colours.
"""

from dataclasses import dataclass, field
from pathlib import Path
from xml.sax.saxutils import escape, quoteattr

import numpy as np

from npslam_teach.plotting.style import class_style

CSS = (Path(__file__).parent / "scene.css").read_text(encoding="utf-8")
PAGE_CSS = "".join(f".npslam-explorer svg {line}\n" for line in CSS.splitlines())
_PLUS = ((-0.4, -1.1), (0.4, -1.1), (0.4, -0.4), (1.1, -0.4), (1.1, 0.4), (0.4, 0.4))
_PLUS += tuple((-x, -y) for x, y in _PLUS)
_SHAPES = {
    "o": None,
    "s": [(-0.9, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)],
    "^": [(0, -1.15), (1.05, 0.85), (-1.05, 0.85)],
    "D": [(0, -1.2), (1.2, 0), (0, 1.2), (-1.2, 0)],
    "v": [(0, 1.15), (1.05, -0.85), (-1.05, -0.85)],
    "P": _PLUS,
    "X": [((x - y) / np.sqrt(2), (x + y) / np.sqrt(2)) for x, y in _PLUS],
    "*": [(r * np.sin(k * np.pi / 5), -r * np.cos(k * np.pi / 5)) for k, r in enumerate((1.3, 0.55) * 5)],
}
_FOR_HANDS = {"data-places", "data-stops", "data-hint"}


@dataclass
class Scene:
    """The parts of one picture, by name; later ones lie over earlier ones."""

    size: tuple[float, float]  # px
    parts: dict[str, list] = field(default_factory=dict)

    def add(self, name: str, tag: str, text: str | None = None, **attributes) -> None:
        """Add a part; ``class_`` and underscores become what SVG calls them, numbers are rounded to 0.01 px."""
        named = {key.rstrip("_").replace("_", "-"): _written(value) for key, value in attributes.items()}
        self.parts[name] = [tag, named] if text is None else [tag, named, text]

    @property
    def page(self) -> "Panel":
        """The whole picture, in px from its upper left corner."""
        return Panel((0.0, 0.0, *self.size), (0.0, self.size[0]), (self.size[1], 0.0))

    def message(self) -> dict:
        """For the page."""
        return {"size": list(self.size), "parts": self.parts}

    def svg(self) -> str:
        """The same as a file, without what only a hand needs."""
        drawn = "".join(_markup(*part) for part in self.parts.values() if not _FOR_HANDS & part[1].keys())
        width, height = self.size
        box = f'viewBox="0 0 {width:g} {height:g}" width="{width:g}" height="{height:g}"'
        head = f'<svg xmlns="http://www.w3.org/2000/svg" {box}>'
        paper = f'<rect width="{width}" height="{height}" fill="#fff"/>'
        return f"{head}<style>{CSS}</style>{paper}{drawn}</svg>"


@dataclass(frozen=True)
class Panel:
    """A rectangle of the picture with axes of its own."""

    box: tuple[float, float, float, float]  # left, top, width, height in px
    x: tuple[float, float]  # what it shows, from left to right
    y: tuple[float, float]  # from bottom to top

    @classmethod
    def around(cls, points: np.ndarray, margin: float, box: tuple[float, float, float, float]) -> "Panel":
        """A map that holds points (N, 2), with one scale for both axes, as large as a box in px has room for."""
        low, high = points.min(axis=0) - margin, points.max(axis=0) + margin
        left, top, width, height = box
        scale = min(width / (high[0] - low[0]), height / (high[1] - low[1]))
        inside = (left, top, scale * (high[0] - low[0]), scale * (high[1] - low[1]))
        return cls(inside, (low[0], high[0]), (low[1], high[1]))

    @property
    def scale(self) -> tuple[float, float, float, float]:
        """Page = scale[0] * x + scale[1], scale[2] * y + scale[3]."""
        left, top, width, height = self.box
        a, b = width / (self.x[1] - self.x[0]), -height / (self.y[1] - self.y[0])
        return a, left - a * self.x[0], b, top - b * self.y[1]

    def to_page(self, xy) -> np.ndarray:
        """(N, 2) px of (N, 2) in the units of the axes."""
        a, x0, b, y0 = self.scale
        return np.atleast_2d(xy) * (a, b) + (x0, y0)

    def clip(self, scene: Scene) -> str:
        """The style of a part that is cut off at the frame."""
        left, top, width, height = (round(length, 2) for length in self.box)
        right, bottom = round(scene.size[0] - left - width, 2), round(scene.size[1] - top - height, 2)
        return f"clip-path: inset({top}px {right}px {bottom}px {left}px) view-box"

    def axes(self, scene: Scene, name: str, title: str, labels: tuple[str, str], ticks: tuple) -> None:
        """Frame, grid, ticks, labels and title.

        Args:
            scene: gets them.
            name: a prefix for the names of the parts.
            title: of the panel.
            labels: of x and y, with units; an empty one is left out.
            ticks: values on x and on y.
        """
        left, top, width, height = self.box
        right, bottom = left + width, top + height
        for k, value in enumerate(ticks[0]):
            at = self.to_page((value, self.y[0]))[0][0]
            scene.add(f"{name} x{k}", "line", x1=at, x2=at, y1=top, y2=bottom, class_="grid")
            scene.add(f"{name} xt{k}", "text", f"{value:g}", x=at, y=bottom + 18, class_="middle quiet")
        for k, value in enumerate(ticks[1]):
            at = self.to_page((self.x[0], value))[0][1]
            scene.add(f"{name} y{k}", "line", x1=left, x2=right, y1=at, y2=at, class_="grid")
            scene.add(f"{name} yt{k}", "text", f"{value:g}", x=left - 7, y=at + 5, class_="end quiet")
        scene.add(f"{name} frame", "rect", x=left, y=top, width=width, height=height, class_="frame")
        scene.add(f"{name} title", "text", title, x=left, y=top - 10, class_="title")
        if labels[0]:
            scene.add(f"{name} xl", "text", labels[0], x=left + width / 2, y=bottom + 38, class_="middle quiet")
        if labels[1]:
            turn = f"translate({round(left - 42, 2)} {round(top + height / 2, 2)}) rotate(-90)"
            scene.add(f"{name} yl", "text", labels[1], transform=turn, class_="middle quiet")

    def map_axes(self, scene: Scene, title: str, spacing: float) -> None:
        """The axes of a map in metres, with a tick at every multiple of the spacing."""
        ranges = (self.x, self.y)
        ticks = tuple(np.arange(np.ceil(low / spacing) * spacing, high, spacing) + 0.0 for low, high in ranges)
        self.axes(scene, "map", title, ("x (m)", "y (m)"), ticks)

    def dots(self, scene: Scene, name: str, xy, width: float) -> None:
        """A dot, so many px wide, at each of (N, 2) points of an estimate."""
        dots = " ".join(f"M{x:.1f},{y:.1f}h0" for x, y in self.to_page(xy))
        scene.add(name, "path", d=dots, class_="estimate", style=f"stroke-width: {width:g}; stroke-linecap: round")

    def line(self, scene: Scene, name: str, xy, style: str, **attributes) -> None:
        """A line through (N, 2) points, of a class of ``scene.css``."""
        points = " ".join(f"{_written(x)},{_written(y)}" for x, y in self.to_page(xy))
        scene.add(name, "polyline", points=points, class_=style, **attributes)

    def mark(self, scene: Scene, name: str, xy, object_class: int, radius: float = 8.0, **attributes) -> None:
        """The marker of a class at a point."""
        color, marker = class_style(object_class)
        x, y = self.to_page(xy)[0]
        shape = _SHAPES[marker]
        style = {"fill": color, "class_": "mark"} | attributes
        if shape is None:
            scene.add(name, "circle", cx=x, cy=y, r=radius, **style)
        else:
            corners = " ".join(f"{_written(x + radius * p)},{_written(y + radius * q)}" for p, q in shape)
            scene.add(name, "polygon", points=corners, **style)

    def text(self, scene: Scene, name: str, xy, text: str, shift=(0.0, 0.0), style: str = "middle") -> None:
        """A text at a point, moved by some px."""
        x, y = self.to_page(xy)[0] + shift
        scene.add(name, "text", text, x=x, y=y, class_=style)

    def handle(self, scene: Scene, name: str, xy, places: tuple[str, int], label: str, radius: float = 16.0) -> None:
        """A ring around a point by which it is dragged.

        Args:
            scene: gets it.
            name: of the part.
            xy: (2,).
            places: the name of the control and the number of the point.
            label: what a screen reader says.
            radius: px, large enough for a finger.
        """
        x, y = self.to_page(xy)[0]
        seen = {"class_": "handle mark", "fill": "transparent", "tabindex": 0, "role": "button"}
        what = {"aria_roledescription": "point to drag", "aria_label": f"{label}; arrow keys move it"}
        owner = {"data_places": places[0], "data_index": places[1]}
        scene.add(name, "circle", cx=x, cy=y, r=radius, **seen, **what, **owner)

    def grip(self, scene: Scene, name: str, xy, stops: list, label: str, reach: float | None = None, **style) -> None:
        """A ring that moves controls: it has places to go to, with or without a kernel.

        Args:
            scene: gets it.
            name: of the part.
            xy: (2,) where it lies.
            stops: ``(xy, values)`` for each place: what some controls, the same for all places, are set to there, by
                name and as the page counts them (of a list the number of the option); ">" is a step on from where a
                control stands, and "<" a step back.
            label: what a screen reader says.
            reach: px within which a stop catches what is dropped. None where the ring goes from stop to stop while it
                is held; the arrow keys follow their order then.
            style: other attributes of the ring, among them its radius ``r``.
        """
        x, y = self.to_page(xy)[0].round(1)  # as its stops are
        places = [[*self.to_page(where)[0].round(1), *values.values()] for where, values in stops]
        seen = {"r": 16.0, "class_": "handle mark", "fill": "transparent", "tabindex": 0, "role": "button"} | style
        what = {"aria_roledescription": "point to drag", "aria_label": label}
        where = {"data_follows": "true"} if reach is None else {"data_reach": reach}
        where |= {
            "data_moves": " ".join(stops[0][1]),
            "data_stops": ";".join(" ".join(map(_written, each)) for each in places),
        }
        scene.add(name, "circle", cx=x, cy=y, **seen, **what, **where)


def _markup(tag: str, attributes: dict, text: str = "") -> str:
    named = " ".join(f"{key}={quoteattr(value)}" for key, value in attributes.items())
    return f"<{tag} {named}>{escape(text)}</{tag}>"


def _written(value) -> str:
    return value if isinstance(value, str) else f"{round(float(value), 2):g}"
