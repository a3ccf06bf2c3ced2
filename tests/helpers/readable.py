"""Whether a figure can be read: its texts are inside it and large enough, and none covers another."""

import itertools

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.text import Text

from npslam_teach.plotting.style import TEXT_SIZE

SMALLEST = min(TEXT_SIZE.values())  # pt


def texts_of(figure):
    """Every visible text that is not blank, with its box; of 3D axes, whose labels have no fixed boxes, the title."""
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    texts = [text for text in figure.findobj(Text) if text.get_visible() and text.get_text().strip()]
    left_out = {text for ax in figure.axes for axis in (ax.xaxis, ax.yaxis) for text in labels_out_of_view(axis)}
    left_out |= {text for ax in figure.axes if ax.name == "3d" for text in ax.findobj(Text) if text is not ax.title}
    # Text's own method: that of an annotation includes the point it refers to.
    return [(each, Text.get_window_extent(each, canvas.get_renderer())) for each in texts if each not in left_out]


def labels_out_of_view(axis):
    """Matplotlib keeps labels of ticks beyond the ends of an axis, and never draws them."""
    low, high = sorted(axis.get_view_interval())
    room = 1e-6 * (high - low)
    ticks = axis.get_major_ticks() + axis.get_minor_ticks()
    out = [t for t in ticks if not axis.axes.axison or not low - room <= t.get_loc() <= high + room]
    return [label for tick in out for label in (tick.label1, tick.label2)]


def assert_inside(figure):
    """All texts are inside the figure, and large enough; returns them with their boxes."""
    found = texts_of(figure)
    assert len(found) > 2
    for text, box in found:
        assert box.x0 >= -1 and box.y0 >= -1, text
        assert box.x1 <= figure.bbox.width + 1 and box.y1 <= figure.bbox.height + 1, text
        assert text.get_fontsize() >= SMALLEST, text
    return found


def assert_readable(figure):
    """All texts are inside the figure, large enough, and none covers another."""
    for (text, a), (other, b) in itertools.combinations(assert_inside(figure), 2):
        apart = a.x1 <= b.x0 + 1 or b.x1 <= a.x0 + 1 or a.y1 <= b.y0 + 1 or b.y1 <= a.y0 + 1
        assert apart, (text, other)
