"""The interactive explorers: sliders, a picture that follows them, and a description in words below it.

This is the only module that imports ipywidgets. The explorers of a lesson are in its folder. Each makes a figure and
its artists once, defines an ``update`` that moves the artists and returns a description of the picture, and passes both
to ``Explorer``. The map that students draw on is a widget of its own, in ``draw_your_own_world``.
"""

import html
import traceback
from collections.abc import Callable
from pathlib import Path

import anywidget
import ipywidgets
from matplotlib.figure import Figure

from npslam_teach.plotting.blitting import Redrawing
from npslam_teach.plotting.export import picture_tag

__all__ = ["Explorer", "choice", "player", "slider"]

_LAYOUT = {"width": "28em"}
_STYLE = {"description_width": "11em"}


def slider(name: str, value: float, low: float, high: float, step: float) -> ipywidgets.Widget:
    """A slider with a name that a screen reader finds; it has whole numbers if the step is a whole number.

    Args:
        name: what it sets, with the unit.
        value: at the start.
        low: its left end.
        high: its right end.
        step: of an arrow key.
    """
    kind = ipywidgets.IntSlider if isinstance(step, int) else ipywidgets.FloatSlider
    number = {} if isinstance(step, int) else {"readout_format": ".2f"}
    return kind(value, min=low, max=high, step=step, **_named(name), **number)


def choice(name: str, options: dict) -> ipywidgets.Widget:
    """A drop-down list: text to value; None is a value like any other.

    Args:
        name: what it sets.
        options: text to value; the first one is chosen at the start.
    """
    widget = ipywidgets.Dropdown(options=options, **_named(name))
    if None in options.values():
        # To ipywidgets None means that nothing is chosen: the list would be shown empty.
        place = list(options.values()).index(None)

        def choose_it(change) -> None:
            if change.new is None:
                widget.index = place

        widget.observe(choose_it, names="index")
    return widget


def _named(name: str) -> dict:
    """A label, and the same as a tooltip: without one ipywidgets would show "null"."""
    return {"description": name, "tooltip": name, "layout": _LAYOUT, "style": _STYLE}


def player(name: str, high: int, milliseconds: int = 1000) -> tuple[ipywidgets.Widget, ipywidgets.Widget]:
    """A slider from 0 to ``high`` and a play button that moves it; ``Explorer`` takes the button among ``extras``."""
    button = ipywidgets.Play(min=0, max=high, interval=milliseconds, description=f"play {name}")
    position = slider(name, 0, 0, high, 1)
    ipywidgets.jslink((button, "value"), (position, "value"))
    return position, button


class _PageScript(anywidget.AnyWidget):
    """What the page does for an explorer: see ``explorer.js``."""

    _esm = Path(__file__).parent / "explorer.js"


class Explorer(ipywidgets.VBox):
    """Sliders above a picture; the picture and the words under it follow every change.

    The picture is an ``<img>`` with these words as its alternative text, for those who cannot see it. The words under
    the picture are for those who can; a screen reader does not read them a second time. An error in ``update`` is shown
    in place of the picture, because Jupyter hides the exceptions of callbacks, and is raised again, so that a test or a
    cell that moves a slider fails.
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
        self._update, self._drawing = update, Redrawing(figure)
        self._picture = ipywidgets.HTML()
        children = [*extras, *sliders.values(), self._picture, _PageScript(layout={"display": "none"})]
        super().__init__(children, _dom_classes=("npslam-explorer",))
        for each in sliders.values():
            each.observe(lambda change: self.refresh(), names="value")
        self.refresh()

    def refresh(self) -> None:
        """Apply the sliders' values, draw, and show."""
        try:
            self.words = self._update(**self._values())
            image = picture_tag(self._drawing.png(), self.words, self.figure.get_size_inches())
            caption = f'<figcaption aria-hidden="true">{html.escape(self.words)}</figcaption>'
            self._picture.value = f'<figure style="margin:0">{image}{caption}</figure>'
        except Exception:
            self._picture.value = f"<pre>{html.escape(traceback.format_exc())}</pre>"
            raise

    def _values(self) -> dict:
        """The values of the sliders, rounded: 0.2 where a page that adds up steps sends 0.19999999999999998."""
        values = {name: each.value for name, each in self.sliders.items()}
        return {name: round(value, 9) if isinstance(value, float) else value for name, value in values.items()}

    def __repr__(self) -> str:
        """The text that is shown in place of the widget where no kernel runs, as on a code host."""
        return f"Explorer: {self.words}"

    def move(self, **values) -> str:
        """Move sliders as a hand would, and return the words under the picture."""
        for name, value in values.items():
            self.sliders[name].value = value
        return self.words
