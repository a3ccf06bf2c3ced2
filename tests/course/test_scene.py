"""Scenes: what a hand needs is not in a picture that stands still, and every class has its marker."""

import re
import xml.etree.ElementTree as ET

import numpy as np
import pytest
from rings import ring_of

from npslam_teach.course.scene import Panel, Scene
from npslam_teach.plotting.style import CLASS_MARKERS

PANEL = Panel((10.0, 20.0, 200.0, 100.0), (-1.0, 1.0), (0.0, 5.0))
STOPS = [((0.0, 1.0), {"first": 3, "second": ">"}), ((1.0, 5.0), {"first": 4, "second": "<"})]


def test_a_ring_says_where_it_leads_and_to_what():
    scene = Scene((220.0, 140.0))
    PANEL.grip(scene, "ring", (0.5, 2.5), STOPS, "a label", reach=30.0)
    ring = ring_of(scene.parts["ring"][1])
    assert ring.moves == ("first", "second") and not ring.follows
    assert ring.stops == ((110.0, 100.0, "3", ">"), (210.0, 20.0, "4", "<"))
    np.testing.assert_allclose(ring.xy, PANEL.to_page((0.5, 2.5))[0])
    PANEL.grip(scene, "other", (0.5, 2.5), STOPS, "a label")
    assert ring_of(scene.parts["other"][1]).follows


def test_a_picture_that_stands_still_has_no_rings_handles_or_hints():
    scene = Scene((220.0, 140.0))
    PANEL.line(scene, "line", [(0, 0), (1, 1)], "estimate")
    PANEL.grip(scene, "ring", (0.5, 2.5), STOPS, "a label", reach=30.0)
    PANEL.handle(scene, "handle", (0.5, 2.5), ("xy", 0), "a label")
    scene.add("hint", "text", "drag it", x=0, y=0, data_hint="true")
    drawn = [each.tag.split("}")[1] for each in ET.fromstring(scene.svg())]
    assert drawn == ["style", "rect", "polyline"]


@pytest.mark.parametrize("object_class", range(len(CLASS_MARKERS)))
def test_every_class_has_a_marker_around_its_point(object_class):
    scene = Scene((220.0, 140.0))
    PANEL.mark(scene, "mark", (0.0, 2.5), object_class, radius=10.0)
    tag, named = scene.parts["mark"]
    if tag == "circle":
        assert (named["cx"], named["cy"], named["r"]) == ("110", "70", "10")
        return
    corners = np.array([each.split(",") for each in named["points"].split()], dtype=float) - (110.0, 70.0)
    far = np.hypot(*corners.T)
    assert len(corners) >= 3 and far.max() <= 16.0 and far.min() > 4.0
    assert np.abs(corners.mean(axis=0)).max() < 2.0


def test_the_last_bit_of_a_number_is_never_in_a_picture():
    """It depends on the machine, and what a notebook shows is compared with what it has shown elsewhere."""
    third = Panel((100 / 3, 20 / 3, 160 / 3, 100 / 7), (0.0, 1 / 3), (0.0, 5 / 7))
    scene = Scene((220.0, 140.0))
    third.axes(scene, "map", "title", ("x (m)", "y (m)"), ((0.1,), (0.3,)))
    third.line(scene, "line", [(1 / 7, 1 / 3), (1 / 9, 1 / 11)], "estimate")
    third.mark(scene, "mark", (1 / 9, 1 / 13), 1)
    third.text(scene, "text", (1 / 9, 1 / 13), "words")
    third.dots(scene, "dots", [(1 / 9, 1 / 13)], 3.0)
    assert not re.findall(r"\d+\.\d{3,}", scene.svg())
