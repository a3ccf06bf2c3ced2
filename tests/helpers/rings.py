"""The rings of a scene that move controls: what they move, where they lead, and where they lie."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Ring:
    """A part of a scene with stops."""

    moves: tuple  # names of controls
    stops: tuple  # (x px, y px, a value for each of them), the values as texts
    follows: bool  # from stop to stop, or dropped on one
    xy: np.ndarray  # px


def ring_of(attributes: dict) -> Ring:
    """Of the attributes of its part."""
    stops = []
    for text in attributes["data-stops"].split(";"):
        x, y, *values = text.split(" ")
        stops.append((float(x), float(y), *values))
    xy = np.array([attributes["cx"], attributes["cy"]], dtype=float)
    return Ring(tuple(attributes["data-moves"].split(" ")), tuple(stops), "data-follows" in attributes, xy)


def rings_of(scene) -> dict[str, Ring]:
    """By the names of their parts."""
    return {name: ring_of(part[1]) for name, part in scene.parts.items() if "data-stops" in part[1]}


def assert_rings_lie_where_they_are_led(explorer) -> None:
    """A ring that goes from stop to stop lies, once its controls are set to what a stop says, at that stop."""
    before, followed = explorer.values(), 0
    for name, ring in rings_of(explorer.scene).items():
        for x, y, *values in ring.stops if ring.follows else ():
            for control, value in zip((explorer.sliders[each] for each in ring.moves), values, strict=True):
                control.put(control.from_page(int(value) if hasattr(control, "options") else float(value)))
            explorer.refresh()
            np.testing.assert_allclose(rings_of(explorer.scene)[name].xy, (x, y), atol=0.06)
            followed += 1
        explorer.move(**before)
    assert followed > 1
