"""What is asked of the artists in a figure. Pictures are never compared with pictures."""

import base64
import html.parser

import numpy as np
from matplotlib.collections import PathCollection
from matplotlib.colors import to_rgb
from matplotlib.legend import Legend

from npslam_teach import plotting
from npslam_teach.methods import METHODS as ALL_METHODS

METHODS = {name: method for name, method in ALL_METHODS.items() if method.in_paper}


def lines_like(ax, dashed):
    """The lines of a path or a level, with or without dashes; markers alone are left out."""
    found = [line for line in ax.lines if line.get_linestyle() != "None" and len(line.get_xdata()) > 1]
    return [line for line in found if (line.get_linestyle() == "--") == dashed]


def scatters(ax, hollow):
    found = [artist for artist in ax.collections if isinstance(artist, PathCollection)]
    return [artist for artist in found if (len(artist.get_facecolors()) == 0) == hollow]


def offsets(collections):
    return np.concatenate([np.asarray(artist.get_offsets()) for artist in collections])


def same_points(a, b):
    return np.allclose(a[np.lexsort(np.asarray(a).T)], b[np.lexsort(np.asarray(b).T)], atol=1e-9)


def is_grey(color):
    return np.ptp(to_rgb(color)) < 1e-9 and 0.3 < to_rgb(color)[0] < 0.7


def kabsch(xy, reference_xy):
    """The best rigid motion by another road than the package takes: singular values."""
    mean, reference_mean = xy.mean(axis=0), reference_xy.mean(axis=0)
    u, _, vt = np.linalg.svd((xy - mean).T @ (reference_xy - reference_mean))
    flip = np.diag([1.0, np.sign(np.linalg.det(u @ vt))])
    rotation = (u @ flip @ vt).T
    return lambda points: (points - mean) @ rotation.T + reference_mean


def on_axes(draw, *arguments):
    figure, ax = plotting.new_figure()
    draw(ax, *arguments)
    return figure


def panels(figure):
    return [ax for ax in figure.axes if ax.axison]


def titles(figure):
    return [ax.get_title() for ax in panels(figure)]


def legend_texts(figure):
    (legend,) = figure.findobj(Legend)
    return [text.get_text() for text in legend.get_texts()]


class FirstTag(html.parser.HTMLParser):
    tag = None

    def handle_starttag(self, tag, attributes):
        if self.tag is None:
            self.tag, self.attributes = tag, dict(attributes)


def parsed(shown):
    parser = FirstTag()
    parser.feed(shown.data)
    media_type, data = parser.attributes["src"].removeprefix("data:").split(";base64,")
    return parser, media_type, base64.b64decode(data, validate=True)
