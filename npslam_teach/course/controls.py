"""What the explorers are moved with: sliders, lists, players, and points that are dragged on the picture itself.

A control holds its value on the side of the kernel, which alone decides what it is; the page shows it and asks for
others. ``spec`` describes a control to the page, ``to_page`` and ``from_page`` translate its value.
"""

from collections.abc import Callable

import numpy as np

__all__ = ["Choice", "Places", "Slider", "choice", "places", "player", "slider"]


class Control:
    """A value with a name, and whoever wants to know when it changes."""

    def __init__(self, description: str, value):
        self.description, self._value = description, self.checked(value)
        self.changed: Callable[[], None] = lambda: None

    @property
    def value(self):
        """What it is set to; to set it redraws the picture."""
        return self._value

    @value.setter
    def value(self, value) -> None:
        value = self.checked(value)
        if not np.array_equal(value, self._value):
            self._value = value
            self.changed()

    def put(self, value) -> None:
        """Set the value without redrawing, which is left to the caller."""
        self._value = self.checked(value)

    def checked(self, value):
        """The value as it is kept; ValueError if the control cannot be set to it."""
        return value

    def to_page(self):
        """The value as the page sees it."""
        return self._value

    def from_page(self, sent):
        """The value that the page means."""
        return sent


class Slider(Control):
    """A number between two ends; a whole one if the step is a whole number."""

    def __init__(self, description: str, value: float, low: float, high: float, step: float, play: int = 0):
        self.min, self.max, self.step, self.play = low, high, step, play
        super().__init__(description, value)

    @property
    def is_whole(self) -> bool:
        """Whether it takes whole numbers alone."""
        return isinstance(self.step, int)

    def checked(self, value):
        """The number as it is kept: 0.2 for 0.19999999999999998, what is typed is not moved to the grid."""
        number = round(float(value), 9)
        if not self.min <= number <= self.max:
            raise ValueError(f"{self.description}: expected a number from {self.min} to {self.max}, got {value}")
        if self.is_whole and number != int(number):
            raise ValueError(f"{self.description}: expected a whole number, got {value}")
        return int(number) if self.is_whole else number

    def grid(self) -> list:
        """Where the arrow keys lead, in order."""
        steps = int(round((self.max - self.min) / self.step, 9))
        return [self.checked(self.min + k * self.step) for k in range(steps + 1)]

    def spec(self, name: str) -> dict:
        """For the page."""
        ends = {"min": self.min, "max": self.max, "step": self.step, "whole": self.is_whole, "play": self.play}
        return {"kind": "slider", "name": name, "label": self.description, **ends}


class Choice(Control):
    """One of several values, each with a text."""

    def __init__(self, description: str, options: dict, value):
        self.options = options
        super().__init__(description, value)

    def checked(self, value):
        """The value, if it is among the options."""
        if not any(value is each or value == each for each in self.options.values()):
            raise ValueError(f"{self.description}: expected one of {list(self.options.values())}, got {value!r}")
        return value

    @property
    def index(self) -> int:
        """The number of the option, from 0."""
        return next(k for k, each in enumerate(self.options.values()) if self._value is each or self._value == each)

    def grid(self) -> list:
        """All values, in order."""
        return list(self.options.values())

    def to_page(self) -> int:
        """The number of the option."""
        return self.index

    def from_page(self, sent: int):
        """The value of the option with this number."""
        return self.grid()[sent]

    def spec(self, name: str) -> dict:
        """For the page."""
        return {"kind": "choice", "name": name, "label": self.description, "options": list(self.options)}


class Places(Control):
    """Points of a scene that are dragged; parts with ``data-places`` and ``data-index`` are their handles."""

    def __init__(self, description: str, xy, low, high, step: float, scale: tuple, key: float, released: str = ""):
        self.low, self.high, self.step = tuple(low), tuple(high), step
        self._page = {"scale": list(scale), "key": key, "released": released}
        super().__init__(description, xy)

    def checked(self, value) -> np.ndarray:
        """(N, 2) inside the bounds."""
        xy = np.array(value, dtype=float).round(9)
        if xy.ndim != 2 or xy.shape[1] != 2 or not np.isfinite(xy).all():
            raise ValueError(f"{self.description}: expected (N, 2) finite numbers, got shape {xy.shape}")
        if not ((xy >= self.low) & (xy <= self.high)).all():
            raise ValueError(f"{self.description}: expected points from {self.low} to {self.high}, got {xy.tolist()}")
        return xy

    def to_page(self) -> list:
        """Lists of two numbers."""
        return self._value.tolist()

    def spec(self, name: str) -> dict:
        """For the page."""
        bounds = {"low": list(self.low), "high": list(self.high), "step": self.step}
        return {"kind": "places", "name": name, "label": self.description, **bounds, **self._page}


def slider(name: str, value: float, low: float, high: float, step: float, milliseconds: int = 0) -> Slider:
    """A slider with a field for its number; it has whole numbers if the step is a whole number.

    Args:
        name: what it sets, with the unit.
        value: at the start.
        low: its left end.
        high: its right end.
        step: of an arrow key.
        milliseconds: that a value is shown while it plays; with 0 there are no buttons to play it.
    """
    return Slider(name, value, low, high, step, milliseconds)


def choice(name: str, options: dict) -> Choice:
    """A drop-down list: text to value; None is a value like any other.

    Args:
        name: what it sets.
        options: text to value; the first one is chosen at the start.
    """
    return Choice(name, options, next(iter(options.values())))


def player(name: str, high: int, milliseconds: int = 1000) -> Slider:
    """A slider from 0 to ``high`` with buttons that step and play.

    Args:
        name: what it counts.
        high: the last step.
        milliseconds: that a step is shown while it plays.
    """
    return Slider(name, 0, 0, high, 1, play=milliseconds)


def places(name: str, xy, panel, step: float = 0.01, key: float = 0.05, released: str = "") -> Places:
    """Points that are dragged in a panel of a scene; they cannot leave it.

    Args:
        name: what they are.
        xy: (N, 2) at the start, in the units of the panel.
        panel: ``scene.Panel``.
        step: to which the hand is rounded.
        key: how far an arrow key moves one.
        released: the name of a player that starts when a point is let go, and returns to 0 when one is moved. A drag
            then begins where the points are drawn, not where they were left.
    """
    low, high = zip(panel.x, panel.y, strict=True)
    return Places(name, xy, low, high, step, panel.scale, key, released)
