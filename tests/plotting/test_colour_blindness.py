"""Colours as people see them who lack one kind of cone, by a model other than the one the palette was chosen with.

Machado, Oliveira and Fernandes (2009) simulate the deficiency; distances are those of CAM02-UCS, in which 1 can just be
noticed side by side and 8 is plain at a glance.
"""

import itertools

import numpy as np
import pytest
from matplotlib.colors import to_rgb

from npslam_teach import plotting
from npslam_teach.methods import METHODS
from npslam_teach.plotting import style

colorspacious = pytest.importorskip(
    "colorspacious", reason="colorspacious is not installed: pip install -r tests/requirements.txt"
)

NOTICED = 3.0
PLAIN = 8.0
CLEAR = 15.0
DEFICIENCIES = ("none", "deuteranomaly", "protanomaly", "tritanomaly")
LESSON_CLASSES = 5  # no lesson has more


def seen(colors, deficiency: str) -> np.ndarray:
    """(N, 3) CAM02-UCS of sRGB colours under a deficiency of full severity."""
    rgb = np.array([to_rgb(color) for color in colors])
    if deficiency != "none":
        space = {"name": "sRGB1+CVD", "cvd_type": deficiency, "severity": 100}
        rgb = np.clip(colorspacious.cspace_convert(rgb, space, "sRGB1"), 0, 1)
    return colorspacious.cspace_convert(rgb, "sRGB1", "CAM02-UCS")


def least_distance(colors, deficiency: str) -> float:
    return min(np.linalg.norm(a - b) for a, b in itertools.combinations(seen(colors, deficiency), 2))


def test_the_model_confuses_what_people_confuse():
    for deficiency, confused in (("deuteranomaly", ["#c03020", "#507020"]), ("tritanomaly", ["#d0d8ff", "#d8f0a0"])):
        assert least_distance(confused, deficiency) < 0.6 * least_distance(confused, "none")


@pytest.mark.parametrize("deficiency", DEFICIENCIES)
def test_the_classes_of_the_lessons_the_truth_the_estimate_and_the_paper_are_clearly_apart(deficiency):
    classes = [plotting.class_style(c)[0] for c in range(LESSON_CLASSES)]
    assert least_distance([*classes, style.TRUTH_COLOR, style.ESTIMATE_COLOR, "#ffffff"], deficiency) > CLEAR


@pytest.mark.parametrize("deficiency", DEFICIENCIES)
def test_of_eight_classes_colour_alone_tells_all_apart(deficiency):
    assert least_distance([plotting.class_style(c)[0] for c in range(8)], deficiency) > PLAIN


@pytest.mark.parametrize("deficiency", DEFICIENCIES)
def test_the_curves_of_methods_that_are_compared_are_clearly_apart(deficiency):
    assert least_distance([plotting.method_style(name)["color"] for name in METHODS], deficiency) > CLEAR


@pytest.mark.parametrize("deficiency", [*DEFICIENCIES, "grey"])
def test_what_colour_does_not_tell_apart_a_marker_does(deficiency):
    """All 64 classes that the palette serves, on a grey printer too."""
    looks = [plotting.class_style(c) for c in range(64)]
    places = seen([color for color, _ in looks], "none" if deficiency == "grey" else deficiency)
    if deficiency == "grey":
        places = places * [1, 0, 0]
    for (a, (_, marker)), (b, (_, other)) in itertools.combinations(zip(places, looks, strict=True), 2):
        assert marker != other or np.linalg.norm(a - b) > NOTICED
