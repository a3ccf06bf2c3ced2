"""Whether a figure can be read: its texts are inside it, and none covers another."""

import itertools

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.text import Text


def texts_of(figure):
    """Every visible text that says something, with the box that it covers."""
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    said = [text for text in figure.findobj(Text) if text.get_visible() and text.get_text().strip()]
    # Text's own method: that of an annotation includes the point it refers to.
    boxes = [(text.get_text(), Text.get_window_extent(text, canvas.get_renderer())) for text in said]
    beyond = {text for ax in figure.axes for axis in (ax.xaxis, ax.yaxis) for text in labels_out_of_view(axis)}
    return [both for text, both in zip(said, boxes, strict=True) if text not in beyond]


def labels_out_of_view(axis):
    """Matplotlib keeps labels of ticks beyond the ends of an axis, and never draws them."""
    low, high = sorted(axis.get_view_interval())
    room = 1e-6 * (high - low)
    ticks = axis.get_major_ticks() + axis.get_minor_ticks()
    out = [t for t in ticks if not axis.axes.axison or not low - room <= t.get_loc() <= high + room]
    return [label for tick in out for label in (tick.label1, tick.label2)]


def assert_readable(figure):
    """All texts lie inside the figure, and none on another."""
    found = texts_of(figure)
    assert len(found) > 5
    for text, box in found:
        assert box.x0 >= -1 and box.y0 >= -1, text
        assert box.x1 <= figure.bbox.width + 1 and box.y1 <= figure.bbox.height + 1, text
    for (text, a), (other, b) in itertools.combinations(found, 2):
        apart = a.x1 <= b.x0 + 1 or b.x1 <= a.x0 + 1 or a.y1 <= b.y0 + 1 or b.y1 <= a.y0 + 1
        assert apart, (text, other)
