"""The interactive explorers: controls, a picture that follows them, and a description in words below it.

The explorers of a lesson are in its folder. Each passes an ``update`` to ``Explorer``, which moves the artists of a
figure and returns a description in words, or returns the words and a ``scene.Scene``. The map that students draw on is
a widget of its own, in ``draw_your_own_world``.

The kernel owns the state. The page sends what it wishes as a message with a number; the kernel answers every message,
and tells of moves from code, through ``shown``. The page never writes to a trait, so no echo of it can come back.
"""

import base64
import os
import traceback
from collections.abc import Callable
from pathlib import Path

import anywidget
import traitlets
from matplotlib.figure import Figure

from npslam_teach.course import frames, scene
from npslam_teach.course.controls import Control, choice, places, player, slider
from npslam_teach.plotting.blitting import Redrawing
from npslam_teach.plotting.export import CSS_DPI

__all__ = ["Explorer", "choice", "places", "player", "slider"]

_HERE = Path(__file__).parent
_WITH_FRAMES = "NPSLAM_TEACH_FRAMES"  # set where outputs are committed or compared: frames take seconds


class Explorer(anywidget.AnyWidget):
    """Controls above a picture; the picture and the words under it follow every change.

    The words are the alternative text of the picture. An error in ``update`` is shown in place of the picture, because
    Jupyter hides the exceptions of callbacks, and is raised again, so that a test or a cell that moves a slider fails.
    """

    _esm = _HERE / "explorer.js"
    _css = (_HERE / "explorer.css").read_text(encoding="utf-8") + scene.PAGE_CSS

    controls = traitlets.List().tag(sync=True)
    shown = traitlets.Dict().tag(sync=True)

    def __init__(self, figure: Figure | None, update: Callable, without_kernel: dict | None = None, **sliders: Control):
        """Show ``update(**values)``.

        Args:
            figure: made by ``plotting.new_figure``; its artists belong to ``update``. None for a scene.
            update: moves the artists to the values and returns the words; without a figure, the words and the scene.
            without_kernel: by the names of controls, the values for which frames are computed in advance; every
                combination is one, the other controls stay where they stand.
            sliders: from ``slider``, ``choice``, ``player`` or ``places``, by the name of the argument of ``update``.
        """
        super().__init__()
        self.figure, self.sliders, self.words, self.scene = figure, sliders, "", None
        self.without_kernel = without_kernel or {}
        self._update, self._drawing, self._number = update, figure and Redrawing(figure), 0
        self.controls = [each.spec(name) for name, each in sliders.items()]
        for each in sliders.values():
            each.changed = self.refresh
        self.on_msg(self._handle_message)
        self.refresh()

    def refresh(self, answers: dict | None = None) -> None:
        """Apply the values, draw, and show.

        Args:
            answers: the page's message that this is the answer to.
        """
        try:
            self.shown = self._message(answers) | self.picture()
        except Exception:
            self.shown = self._message(answers) | {"error": traceback.format_exc()}
            raise

    def picture(self) -> dict:
        """The words and the picture for the present values, as the page shows them."""
        told = self._update(**self.values())
        if self.figure is None:
            self.words, self.scene = told
            return {"words": self.words, "scene": self.scene.message()}
        self.words = " ".join(told.split())
        size = [round(length * CSS_DPI) for length in self.figure.get_size_inches()]
        png = base64.b64encode(self._drawing.png()).decode("ascii")
        return {"words": self.words, "src": f"data:image/png;base64,{png}", "size": size}

    def values(self) -> dict:
        """The value of every control, by name."""
        return {name: each.value for name, each in self.sliders.items()}

    def move(self, **values) -> str:
        """Move controls as a hand would, and return the words under the picture.

        Raises:
            KeyError: there is no such control.
            ValueError: a control cannot be set to this.
        """
        for name, value in values.items():
            self.sliders[name].put(value)
        self.refresh()
        return self.words

    def _message(self, answers: dict | None) -> dict:
        self._number += 1  # two equal pictures are two answers
        values = {name: each.to_page() for name, each in self.sliders.items()}
        return {"number": self._number, "values": values, "answers": answers}

    def _handle_message(self, _, content: dict, buffers) -> None:
        answers = {key: content.get(key) for key in ("view", "number")}
        try:
            for name, sent in content["values"].items():
                self.sliders[name].put(self.sliders[name].from_page(sent))
        finally:
            self.refresh(answers)

    def _repr_mimebundle_(self, **kwargs):
        """The widget, and beside it what a page shows that has no kernel: frames, or one picture."""
        data, metadata = super()._repr_mimebundle_(**kwargs)
        data["text/plain"] = repr(self)
        data["text/html"] = frames.html_of(self, with_frames=bool(os.environ.get(_WITH_FRAMES)))
        return data, metadata

    def __repr__(self) -> str:
        """The text that is shown where neither pictures nor widgets are."""
        return f"Explorer: {self.words}"
