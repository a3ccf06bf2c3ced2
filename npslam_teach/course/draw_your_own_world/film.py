"""Draw your own world as a film for those who have not opened it: a path is drawn, a thousand objects become few."""

from collections.abc import Iterator

import numpy as np
from matplotlib.figure import Figure

from npslam_teach import plotting
from npslam_teach.course.draw_your_own_world.messages import SolvedWorld, solve
from npslam_teach.course.figure_file import FilmFile
from npslam_teach.plotting.export import gif_bytes
from npslam_teach.plotting.maps import laid_over_truth, plot_objects
from npslam_teach.plotting.style import ESTIMATE_COLOR, ESTIMATE_LINE, START, TRUTH_LINE, class_style, label_map
from npslam_teach.simulate import drawn_fifteen, drawn_run
from npslam_teach.types import Snapshot

_STROKES, _GLIDE = 12, 5  # frames of the drawing, and from one round to the next
_QUICK, _ROUND, _END = 70, 700, 2600  # ms that a frame is shown: on the way, at a round, at the last one


def world_film() -> bytes:
    """The page's first world as an animated GIF: its path is drawn, then its rounds glide into each other."""
    stage = _Stage(solve(*drawn_run(drawn_fifteen())))
    durations = [_QUICK] * _STROKES
    last = len(stage.world.snapshots) - 1
    for number in range(last + 1):
        durations += ([_QUICK] * (_GLIDE - 1) if number else []) + [_END if number == last else _ROUND]
    return gif_bytes(_frames(stage), durations)


def _frames(stage: "_Stage") -> Iterator[Figure]:
    """One figure that is changed from frame to frame."""
    for k in range(_STROKES):
        yield stage.draw_path((k + 1) / _STROKES)
    snapshots = stage.world.snapshots
    yield stage.show(snapshots[0], snapshots[0], 1.0)
    for before, after in zip(snapshots, snapshots[1:], strict=False):
        for k in range(_GLIDE):
            share = (k + 1) / _GLIDE
            yield stage.show(before, after, share * share * (3 - 2 * share))  # sets out and arrives gently


class _Stage:
    """The map: the true objects, the true path as far as it is drawn, and what is believed at the moment."""

    def __init__(self, world: SolvedWorld):
        self.world = world
        self.figure, self.ax = plotting.new_figure(size=(7.2, 5.3))
        truth = world.truth
        plot_objects(self.ax, truth.world.object_xy, truth.world.object_class, truth.world.class_names, truth=True)
        (self._drawn,) = self.ax.plot([], [], **TRUTH_LINE)
        (self._pen,) = self.ax.plot([], [], **START)
        (self._path,) = self.ax.plot([], [], **ESTIMATE_LINE)
        looks = [class_style(c) for c in range(world.log.num_classes)]
        edges = {"edgecolors": ESTIMATE_COLOR, "linewidths": 0.4, "zorder": 2.5}
        self._sightings = [self.ax.scatter([], [], c=color, marker=marker, **edges) for color, marker in looks]
        label_map(self.ax, "").set(xlim=(-0.5, 12.7), ylim=(-0.7, 8.7))

    def draw_path(self, share: float) -> Figure:
        """The path, drawn up to a share of its length."""
        xy = self.world.truth.poses[:, :2]
        end = max(1, round(share * len(xy)))
        self._drawn.set_data(*xy[:end].T)
        self._pen.set_data(*xy[end - 1 : end].T)
        self.ax.set_title("Draw where the robot drives")
        return self.figure

    def show(self, before: Snapshot, after: Snapshot, share: float) -> Figure:
        """What is believed on the way from one round to another: every sighting moves to its new object."""
        (path, places, sizes), (to_path, to_places, to_sizes) = map(self._believed, (before, after))
        self._pen.set_data([], [])
        self._path.set_data(*(path + share * (to_path - path)).T)
        places, sizes = places + share * (to_places - places), sizes + share * (to_sizes - sizes)
        for c, artist in enumerate(self._sightings):
            of_class = self.world.log.obs_class == c
            artist.set_offsets(places[of_class])
            artist.set_sizes(sizes[of_class])
        shown = after if share == 1.0 else before
        rounds = "Every sighting is an object" if shown.iteration == 0 else f"Round {shown.iteration}"
        self.ax.set_title(f"{rounds}: {shown.num_objects} objects")
        return self.figure

    def _believed(self, snapshot: Snapshot) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The path (T, 2) m, and of every sighting the place (M, 2) m and the size (M,) of its object."""
        poses, landmarks = laid_over_truth(snapshot, self.world.truth)
        counts = snapshot.votes[:, 1:].sum(axis=1)
        none = snapshot.labels < 0
        places = np.where(none[:, None], np.nan, landmarks[snapshot.labels])
        return poses[:, :2], places, 10 * np.sqrt(counts[snapshot.labels])


FILMS = (
    FilmFile(
        "draw_your_own_world",
        "A film of a room with fifteen objects. A path is drawn as a figure of eight; along what the wheels report, "
        "more than a thousand sightings lie in clouds beside the objects; round by round they glide together, the path "
        "moves onto the drawn one, and fifteen are left.",
        world_film,
    ),
)
