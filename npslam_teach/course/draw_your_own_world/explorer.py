"""The explorer in which a student draws a world and watches the method map it; ``draw_world.js`` is its page.

The page sends ``drawing`` when the mouse or the finger is lifted; the kernel answers with ``answer``. Both are plain
dictionaries, described in ``messages``. They hold the number of the request, so that the page knows which drawing an
answer belongs to. There are two answers: at once the initial estimate, later all rounds of the method.
"""

import shlex
import time
from pathlib import Path

import anywidget
import numpy as np
import traitlets

import npslam_teach
from npslam_teach import datasets
from npslam_teach.course.draw_your_own_world.messages import (
    SHOWN_METHODS,
    SolvedWorld,
    answer,
    drawing_of,
    from_message,
    initial,
    solve,
    to_message,
    words,
)
from npslam_teach.plotting.style import CLASS_COLORS, CLASS_MARKERS, ESTIMATE_COLOR, TRUTH_COLOR
from npslam_teach.simulate import GALLERY, drawn_fifteen, drawn_run
from npslam_teach.simulate.gallery import ellipse, figure_of_eight, straight, there_and_back
from npslam_teach.simulate.hand_drawn import MAX_CLUTTER, MAX_NOISE
from npslam_teach.system import files
from npslam_teach.types import GroundTruth, RobotLog, Snapshot

__all__ = ["DrawWorld"]

_STROKES = {
    "figure of eight, twice": figure_of_eight(2.0),
    "figure of eight, once": figure_of_eight(1.0),
    "round and round": ellipse(2.0),
    "there and back": there_and_back(9.0, start=(1.5, 3.25)),
    "straight through": straight(10.0, start=(1.0, 4.0)),
}


def _worlds() -> dict:
    """The worlds of the list: title, what to look for, and the drawing."""
    fifteen = drawn_fifteen()
    bare = {"object_xy": np.empty((0, 2)), "object_class": []}
    start = "Draw a path with the mouse or a finger, drop and drag objects, and watch how many the robot counts."
    empty = "Choose what to drop above the map and click into it; the robot counts what you gave it."
    own = {
        "fifteen": {"title": "fifteen objects", "look_for": start, "drawing": to_message(fifteen)},
        "empty": {"title": "an empty room", "look_for": empty, "drawing": to_message(drawn_fifteen(**bare))},
    }
    gallery = {
        key: {"title": each.title, "look_for": each.look_for, "drawing": to_message(each.drawing)}
        for key, each in GALLERY.items()
    }
    return own | gallery


class DrawWorld(anywidget.AnyWidget):
    """Draw a robot's path, drop and drag objects, set the noise; the method runs after each change.

    A drawing that cannot be used is answered with one sentence, and the last good world is kept.
    """

    _esm = Path(__file__).parent / "draw_world.js"
    _css = Path(__file__).parent / "draw_world.css"

    drawing = traitlets.Dict().tag(sync=True)
    answer = traitlets.Dict().tag(sync=True)
    worlds = traitlets.Dict().tag(sync=True)
    paths = traitlets.Dict().tag(sync=True)
    look = traitlets.Dict().tag(sync=True)

    def __init__(self, world: str = "fifteen"):
        """Begin with a world of the list: "fifteen", "empty", or a key of ``simulate.GALLERY``."""
        super().__init__()
        self.worlds = _worlds()
        self.paths = {name: stroke.round(3).tolist() for name, stroke in _STROKES.items()}
        self.look = {
            "colors": CLASS_COLORS,
            "markers": CLASS_MARKERS,
            "truth": TRUTH_COLOR,
            "estimate": ESTIMATE_COLOR,
            "methods": SHOWN_METHODS,
            "max_noise": MAX_NOISE,
            "max_clutter": MAX_CLUTTER,
        }
        self.solved: SolvedWorld | None = None
        self._good: dict = {}  # the drawing that ``solved`` is of
        self._loaded: tuple[RobotLog, GroundTruth] | None = None
        self.observe(self._work, names="drawing")
        self.on_msg(self._handle_message)
        self.choose(world)

    @property
    def words(self) -> str:
        """What stands under the picture."""
        return words(self.solved)

    @property
    def log(self) -> RobotLog:
        """What the robot measured in the world that is shown."""
        return self.solved.log

    @property
    def truth(self) -> GroundTruth:
        """What really happened in it."""
        return self.solved.truth

    @property
    def snapshots(self) -> list[Snapshot]:
        """Every round of the method."""
        return self.solved.snapshots

    def choose(self, world: str) -> str:
        """Show a world of the list, as if it were chosen on the page, and return the words under the picture.

        Raises:
            ValueError: there is no such world.
        """
        if world not in self.worlds:
            raise ValueError(f"world: expected one of {', '.join(self.worlds)}, got {world!r}")
        return self._show(self.worlds[world]["drawing"])

    def change(self, **entries) -> str:
        """Change entries of the drawing, as the page would, and return the words under the picture.

        Args:
            **entries: ``noise``, ``clutter_rate``, ``seed``, ``method``, ``stroke`` or ``objects``, as in
                ``messages.to_message``.

        Raises:
            ValueError: the drawing cannot be used; the last good world is kept.
        """
        return self._show(self._good | entries)

    def save(self, path) -> None:
        """Write the world that is shown to a ``.npz`` log, with the truth, for ``solve`` and ``load``."""
        datasets.save_log(path, self.log, self.truth)

    def load(self, path) -> str:
        """Show the world of a ``.npz`` log and solve the log itself; after a change the robot drives through it again.

        Raises:
            FileNotFoundError: no such file.
            ValueError: it is not a log, or it does not hold the truth.
        """
        log, truth = datasets.load_log(path)
        if truth is None:
            raise ValueError(f"{path}: expected the truth to draw (true_poses, object_xy, ...), got a log without it")
        with files.prefix_errors(path):
            message = to_message(drawing_of(log, truth))
        self._loaded = (log, truth)
        return self._show(message)

    def _show(self, message: dict) -> str:
        self.drawing = message | {"request": self.drawing.get("request", 0) + 1}
        if "error" in self.answer:
            raise ValueError(self.answer["error"])
        return self.words

    def _work(self, change) -> None:
        """Answer a drawing; there is always an answer, because the page waits for it."""
        begin = time.perf_counter()
        loaded, self._loaded = self._loaded, None
        result = {"error": "The program failed, through no fault of yours; the log of the notebook says where"}
        try:
            log, truth = loaded or drawn_run(from_message(self.drawing))
            self._reply(answer(initial(log, truth)), begin, done=False)
            self.solved = solve(log, truth, self.drawing.get("method", "np-graph"))
            result, self._good = answer(self.solved), self.drawing
        except ValueError as error:
            result = {"error": str(error)}
        finally:
            self._reply(result, begin, done=True)

    def _reply(self, result: dict, begin: float, done: bool) -> None:
        seconds = round(time.perf_counter() - begin, 4)
        self.answer = result | {"request": self.drawing.get("request", 0), "seconds": seconds, "done": done}

    def _handle_message(self, _, content: dict, buffers) -> None:
        """Save or load the file that the page names, and report the result."""
        name = str(content.get("file", ""))
        try:
            if content.get("do") == "load":
                self.load(name)
                note = f"Loaded {name}."
            else:
                self.save(name)
                note = f"Saved. In a terminal: {_solve_command(name)}"
        except (ValueError, FileNotFoundError) as error:
            note = str(error)
        self.send({"note": note})

    def __repr__(self) -> str:
        """The text that is shown in place of the widget where no kernel runs, as on a code host."""
        return f"DrawWorld: {self.words}"


def _solve_command(name: str) -> str:
    """The command that solves a saved file, wherever the terminal stands."""
    course = Path(npslam_teach.__file__).resolve().parents[1]
    solve_it = f"python3 -m npslam_teach solve {shlex.quote(str(Path(name).resolve()))}"
    is_checkout = (course / "pyproject.toml").exists()  # else the package is installed, and found from anywhere
    return f"cd {shlex.quote(str(course))} && {solve_it}" if is_checkout else solve_it
