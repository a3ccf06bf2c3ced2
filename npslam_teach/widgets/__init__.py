"""The interactive explorers: sliders, a picture that follows them, and the same in words beside it.

This is the sole module that knows ipywidgets. A lesson's explorers stand in modules of their own; each makes a figure
and its artists once, writes an ``update`` that moves the artists and says in words what is now to be seen, and hands
both to ``Explorer``.
"""

import html
import traceback
from collections.abc import Callable

import ipywidgets
from matplotlib.figure import Figure

from npslam_teach.plotting.pictures import picture_tag

__all__ = ["Explorer", "choice", "player", "slider"]

_LAYOUT = {"width": "28em"}
_STYLE = {"description_width": "11em"}


def slider(name: str, value: float, low: float, high: float, step: float) -> ipywidgets.Widget:
    """A slider with a name that a screen reader finds; whole numbers where the step is one.

    Args:
        name: what it sets, with the unit.
        value: at the start.
        low: its left end.
        high: its right end.
        step: of an arrow key.
    """
    kind = ipywidgets.IntSlider if isinstance(step, int) else ipywidgets.FloatSlider
    number = {} if isinstance(step, int) else {"readout_format": ".2f"}
    return kind(value, min=low, max=high, step=step, description=name, layout=_LAYOUT, style=_STYLE, **number)


def choice(name: str, options: dict) -> ipywidgets.Widget:
    """A drop-down list: text to value."""
    return ipywidgets.Dropdown(options=options, description=name, layout=_LAYOUT, style=_STYLE)


def player(name: str, high: int, milliseconds: int = 1000) -> tuple[ipywidgets.Widget, ipywidgets.Widget]:
    """A slider from 0 to ``high`` with a play button that moves it; hand the slider to ``Explorer``, the button too."""
    button = ipywidgets.Play(min=0, max=high, interval=milliseconds, description=f"play {name}")
    position = slider(name, 0, 0, high, 1)
    ipywidgets.jslink((button, "value"), (position, "value"))
    return position, button


class Explorer(ipywidgets.VBox):
    """Sliders above a picture; the picture and the words under it follow every change.

    The picture is an ``<img>`` whose alternative text is the words, so nothing is lost to those who cannot see it. An
    error in ``update`` is shown in the picture's place, because Jupyter hides what a callback raises, and raised again,
    so that a test or a cell that moves a slider fails.
    """

    def __init__(self, figure: Figure, update: Callable[..., str], extras=(), **sliders: ipywidgets.Widget):
        """Show ``figure`` with ``update(**values)`` applied.

        Args:
            figure: made by ``plotting.new_figure``; its artists belong to ``update``.
            update: moves the artists to the values of the sliders and returns the words for the picture.
            extras: further widgets to show beside the sliders, such as a play button.
            sliders: from ``slider``, ``choice`` or ``player``, by the name of the argument of ``update``.
        """
        self.figure, self.sliders, self.words = figure, sliders, ""
        self._update = update
        self._picture = ipywidgets.HTML()
        super().__init__([*extras, *sliders.values(), self._picture])
        for each in sliders.values():
            each.observe(lambda change: self.refresh(), names="value")
        self.refresh()
        # Laid out once: a picture that follows a slider must not shift by a hair each time.
        figure.set_layout_engine("none")

    def refresh(self) -> None:
        """Apply the sliders' values, draw, and show."""
        try:
            self.words = self._update(**{name: each.value for name, each in self.sliders.items()})
            image = picture_tag(self.figure, self.words)
            self._picture.value = f"<figure>{image}<figcaption>{html.escape(self.words)}</figcaption></figure>"
        except Exception:
            self._picture.value = f"<pre>{html.escape(traceback.format_exc())}</pre>"
            raise

    def __repr__(self) -> str:
        """What stands in the place of the widget where no kernel runs, as on a code host."""
        return f"Explorer: {self.words}"

    def move(self, **values) -> str:
        """Move sliders as a hand would, and return the words under the picture."""
        for name, value in values.items():
            self.sliders[name].value = value
        return self.words
