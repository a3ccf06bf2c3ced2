"""The states of an annealing (lesson 11): a map of the tracklets, which glides from state to state."""

import numpy as np

from npslam_teach import se2
from npslam_teach.course import moving_scene
from npslam_teach.course.explorers import Explorer, player
from npslam_teach.course.scene import Panel, Scene
from npslam_teach.methods.annealing import Model, State
from npslam_teach.plotting.maps import plot_trajectory
from npslam_teach.plotting.style import (
    CLASS_COLORS,
    CLASS_MARKERS,
    ESTIMATE_COLOR,
    ESTIMATE_LINE,
    Line2D,
    class_style,
    label_map,
    path_handles,
)
from npslam_teach.pose_graph import mean_landmarks
from npslam_teach.types import GroundTruth

SIZE = (980.0, 560.0)  # px
MAP, COUNTS = (60.0, 36.0, 560.0, 440.0), (700.0, 36.0, 260.0, 440.0)


class AnnealingFilm:
    """A map of the tracklets, with lines to their objects, for every state of an annealing."""

    def __init__(self, states: list[State], model: Model, truth: GroundTruth):
        """Compute what every picture shows.

        Args:
            states: of one search, from hot to cold.
            model: with N tracklets.
            truth: in whose frame the map is drawn; every state is moved so that its first pose is the true one.
        """
        self.states, self.model, self.truth = states, model, truth
        used = np.flatnonzero(model.tracklet >= 0)
        first = np.unique(model.tracklet[used], return_index=True)[1]
        self.tracklet_class = model.log.obs_class[used[first]]
        self.paths = [se2.compose(truth.poses[0], state.graph.poses) for state in states]
        self.object_xy = [se2.apply(truth.poses[0], state.graph.landmarks) for state in states]  # of each tracklet
        self.tracklet_xy = [self._seen_at(path, used) for path in self.paths]
        self.colors = [self._colors(state.labels) for state in states]

    def _seen_at(self, path: np.ndarray, used: np.ndarray) -> np.ndarray:
        """The mean of the observations of each tracklet along a path, (N, 2) m, W."""
        log = self.model.log
        return mean_landmarks(self.model.tracklet[used], se2.apply(path[log.obs_time[used]], log.obs_xy[used]))

    def _colors(self, labels: np.ndarray) -> list[str]:
        """Of each tracklet: the objects of a class have different colours, in the order of first observation."""
        seen: dict = {}
        colors = []
        for label, c in zip(labels.tolist(), self.tracklet_class.tolist(), strict=True):
            of_class = seen.setdefault(c, {})
            rank = of_class.setdefault(label, len(of_class))
            colors.append(object_style(c, rank)[0])
        return colors

    def draw(self, ax):
        """Draw the truth and the artists that move; returns a function of the number of a state that moves them."""
        plot_trajectory(ax, self.truth.poses, truth=True)
        (path,) = ax.plot([], [], **ESTIMATE_LINE | {"linewidth": 0.8})
        spokes = [ax.plot([], [], color="0.35", linewidth=1.2, zorder=2.2)[0] for _ in self.tracklet_class]
        marks = [self._mark(ax, c) for c in self.tracklet_class]
        shown = Panel.around(self.points(), moving_scene.MARGIN, MAP)
        label_map(ax, "").set(xlim=shown.x, ylim=shown.y)

        def move(number: int) -> None:
            path.set_data(*self.paths[number][:, :2].T)
            ends = zip(self.tracklet_xy[number], self.object_xy[number], strict=True)
            for spoke, mark, color, (seen_at, object_at) in zip(spokes, marks, self.colors[number], ends, strict=True):
                spoke.set_data(*np.stack([seen_at, object_at]).T)
                mark.set_data(*seen_at[:, None])
                mark.set_color(color)
            ax.set_title(self.title(number))

        return move

    def points(self) -> np.ndarray:
        """What a map has to show to hold every state, (N, 2) m."""
        return np.concatenate([*self.tracklet_xy, *self.object_xy, *(path[:, :2] for path in self.paths)])

    def title(self, number: int) -> str:
        """The temperature and the number of objects."""
        state = self.states[number]
        return f"temperature {state.temperature:.2g}: {state.labels.max() + 1} objects"

    def _mark(self, ax, object_class: int):
        marker = object_style(object_class, 0)[1]
        style = {"linestyle": "none", "markeredgecolor": ESTIMATE_COLOR, "markeredgewidth": 0.6, "zorder": 3}
        return ax.plot([], [], marker=marker, markersize=9, **style)[0]

    def handles(self) -> list:
        """The legend: a marker for every class; colours distinguish the objects of a class."""
        names = self.truth.world.class_names
        style = {"linestyle": "none", "color": "0.75", "markeredgecolor": ESTIMATE_COLOR, "markersize": 9}
        marks = [Line2D([], [], marker=CLASS_MARKERS[c], label=names[c], **style) for c in range(len(names))]
        style |= {"marker": "o", "color": CLASS_COLORS[0], "markerfacecoloralt": CLASS_COLORS[1], "fillstyle": "left"}
        colors = Line2D([], [], label="colours: objects of one class", **style)
        spoke = Line2D([], [], color="0.35", linewidth=1.2, label="from where it was seen to its object")
        return [*marks, colors, spoke, *path_handles(("estimated path", "true path"))]


def explore_annealing(film: AnnealingFilm) -> Explorer:
    """Step through an annealing, from hot to cold.

    Args:
        film: of the states of one search.
    """
    room = Panel.around(film.points(), moving_scene.MARGIN, MAP)
    powers = np.log10([state.temperature for state in film.states])
    counts = [int(state.labels.max()) + 1 for state in film.states]
    highest = 1.1 * max(*counts, len(film.truth.world.object_xy))
    cooling = Panel(COUNTS, (powers.max() + 0.15, powers.min() - 0.15), (0.0, highest))

    def update(state: int) -> tuple[str, Scene]:
        scene = Scene(SIZE)
        _draw_map(scene, room, film, state)
        _draw_cooling(scene, cooling, film, np.column_stack([powers, counts]), state)
        moving_scene.draw_key(scene, film.truth, (MAP[0], SIZE[1] - 12), moving_scene.LINES[:2], fill="#bdbdbd")
        told = "colours: the objects of a class"
        scene.add("key colours", "text", told, x=COUNTS[0] + 20, y=SIZE[1] - 12, class_="quiet")
        return annealing_words(film, state), scene

    states = player("state", len(film.states) - 1)
    return Explorer(None, update, {"state": states.grid()}, state=states)


def _draw_map(scene: Scene, room: Panel, film: AnnealingFilm, number: int) -> None:
    """Path and tracklets: colours tell the objects of a class apart, and a spoke leads from a tracklet to its own."""
    room.map_axes(scene, film.title(number), moving_scene.TICKS)
    room.line(scene, "truth", film.truth.poses[:: moving_scene.EVERY, :2], "truth")
    moving_scene.draw_path(scene, room, "path", film.paths[number][:: moving_scene.EVERY, :2])
    for k, ends in enumerate(zip(film.tracklet_xy[number], film.object_xy[number], strict=True)):
        room.line(scene, f"spoke {k}", ends, "spring")
    looks = zip(film.tracklet_xy[number], film.tracklet_class.tolist(), film.colors[number], strict=True)
    for k, (xy, c, color) in enumerate(looks):
        room.mark(scene, f"tracklet {k}", xy, c, 6.5, fill=color)


def _draw_cooling(scene: Scene, panel: Panel, film: AnnealingFilm, points: np.ndarray, number: int) -> None:
    """The number of objects over the temperature, whose axis is logarithmic and falls to the right."""
    num_true = len(film.truth.world.object_xy)
    temperatures = (10.0, 1.0, 0.1)
    ticks = [np.log10(each) for each in temperatures if panel.x[1] <= np.log10(each) <= panel.x[0]]
    labels = ("temperature (log scale)", "")
    panel.axes(scene, "cooling", f"{points[number, 1]:.0f} objects", labels, (ticks, range(0, int(panel.y[1]), 5)))
    for k, power in enumerate(ticks):
        scene.parts[f"cooling xt{k}"] = [*scene.parts[f"cooling xt{k}"][:2], f"{10.0**power:g}"]
    panel.line(scene, "true number", [(x, num_true) for x in panel.x], "truth")
    panel.text(scene, "true name", (panel.x[1], num_true), f"true: {num_true}", (-6.0, 18.0), "end quiet")
    panel.line(scene, "cooling curve", points, "estimate")
    x, y = panel.to_page(points[number])[0]
    scene.add("cooling dot", "circle", cx=x, cy=y, r=6.5, class_="ink")


def annealing_words(film: AnnealingFilm, number: int) -> str:
    """The temperature, the objects, and the log posterior of a state."""
    state = film.states[number]
    alone = int(np.count_nonzero(np.bincount(state.labels) == 1))
    return (
        f"Temperature {state.temperature:.2f}: {len(state.labels)} tracklets in {state.labels.max() + 1} objects, "
        f"{alone} of them alone; log posterior {state.log_posterior:.0f}."
    )


def object_style(object_class: int, rank: int) -> tuple[str, str]:
    """The colour of the ``rank``-th object of its class, and the marker of the class: together they identify it."""
    return CLASS_COLORS[rank % len(CLASS_COLORS)], class_style(object_class)[1]
