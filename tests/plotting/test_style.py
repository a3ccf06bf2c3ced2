"""How classes and methods look, also to those who see few colours."""

import itertools

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from matplotlib.markers import MarkerStyle
from pictures import ALL_METHODS, METHODS

from npslam_teach import plotting
from npslam_teach.plotting import style

# Machado, Oliveira and Fernandes 2009, severity 1, on linear RGB.
DEFICIENCIES = {
    "normal": np.eye(3),
    "deuteranopia": np.array(
        [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]]
    ),
    "protanopia": np.array(
        [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]]
    ),
}
XYZ_OF_RGB = np.array(
    [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750], [0.0193339, 0.1191920, 0.9503041]]
)


def lab(colors, deficiency="normal"):
    """(N, 3) CIELAB of sRGB colours as somebody with a deficiency sees them."""
    srgb = np.array([to_rgb(color) for color in colors])
    linear = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
    seen = np.clip(linear @ DEFICIENCIES[deficiency].T, 0, 1)
    t = seen @ XYZ_OF_RGB.T / XYZ_OF_RGB.sum(axis=1)
    f = np.where(t > 216 / 24389, np.cbrt(t), (24389 / 27 * t + 16) / 116)
    return np.stack([116 * f[:, 1] - 16, 500 * (f[:, 0] - f[:, 1]), 200 * (f[:, 1] - f[:, 2])], axis=1)


def least_distance(points):
    return min(np.linalg.norm(a - b) for a, b in itertools.combinations(points, 2))


def test_the_simulation_of_colour_blindness_does_what_it_should():
    assert np.allclose(lab(["white"], "deuteranopia"), lab(["white"]), atol=0.1)
    red_and_green = ["#c03020", "#507020"]
    for deficiency in ("deuteranopia", "protanopia"):
        assert least_distance(lab(red_and_green, deficiency)) < 0.55 * least_distance(lab(red_and_green))


# A distance of 2.3 can just be noticed side by side; 10 is a clear difference at a glance. Five classes, those of the
# lessons, are held to more than eight, for which colour alone is a weak sign on a grey printer: markers decide there.
@pytest.mark.parametrize(("num_classes", "in_colour", "in_grey"), [(5, 25.0, 12.0), (8, 20.0, 6.5)])
def test_class_colours_can_be_told_apart_by_everybody(num_classes, in_colour, in_grey):
    colors = [plotting.class_style(c)[0] for c in range(num_classes)]
    for deficiency in DEFICIENCIES:
        assert least_distance(lab(colors, deficiency)) > in_colour, deficiency
    assert least_distance(lab(colors)[:, :1]) > in_grey


def test_class_colours_stand_out_from_paper_and_from_the_path():
    colors = [plotting.class_style(c)[0] for c in range(8)]
    for background in ("white", style.ESTIMATE_COLOR):
        assert min(np.linalg.norm(lab([color])[0] - lab([background])[0]) for color in colors) > 20


def test_every_class_has_a_marker_of_its_own():
    markers = [plotting.class_style(c)[1] for c in range(8)]
    assert len(set(markers)) == 8
    assert all(MarkerStyle(marker).is_filled() for marker in markers)
    assert len({plotting.class_style(c) for c in range(64)}) == 64


def test_class_style_refuses_a_negative_class():
    with pytest.raises(ValueError, match="c: expected a class index"):
        plotting.class_style(-1)


def test_every_method_has_a_style_of_its_own():
    names = set(ALL_METHODS)
    styles = [plotting.method_style(name) for name in names]
    for key in ("color", "marker"):
        assert len({look[key] for look in styles}) == len(names)
    assert plotting.method_style("np-graph") == plotting.method_style("np-graph")
    with pytest.raises(ValueError, match="name: expected one of np-graph, .* got 'nonsense'"):
        plotting.method_style("nonsense")


def test_the_styles_of_methods_that_are_compared_differ_in_dashes_or_width():
    looks = [plotting.method_style(name) for name in METHODS]
    assert len({(look["linestyle"], look["linewidth"]) for look in looks}) == len(METHODS)
    for deficiency in DEFICIENCIES:
        assert least_distance(lab([look["color"] for look in looks], deficiency)) > 25
