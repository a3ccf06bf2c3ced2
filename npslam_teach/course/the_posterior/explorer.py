"""The explorers of lesson 11: the exact posterior under alpha and temperature, and the states of an annealing."""

import math

import numpy as np

from npslam_teach import plotting, se2
from npslam_teach.association import all_partitions
from npslam_teach.association.partition_posterior import TrackletEvidence, log_posterior
from npslam_teach.course.explorers import Explorer, player, slider
from npslam_teach.course.the_posterior import pictures
from npslam_teach.methods.annealing import Model, State
from npslam_teach.plotting.maps import plot_trajectory
from npslam_teach.plotting.style import (
    CLASS_COLORS,
    CLASS_MARKERS,
    ESTIMATE_COLOR,
    ESTIMATE_LINE,
    TRUTH_LINE,
    Line2D,
    class_style,
    label_axes,
    label_map,
    legend_below,
    path_handles,
)
from npslam_teach.types import GroundTruth

ROWS = 8
FRAMES = 6  # of an annealing, where no kernel runs


class ExactPosterior:
    """Every partition of a few tracklets, and how probable it is for any alpha and temperature."""

    def __init__(self, evidence: TrackletEvidence):
        """List them all.

        Args:
            evidence: of N tracklets of one class, N up to about 9.
        """
        self.partitions = [np.array(labels) for labels in all_partitions([0] * len(evidence.counts))]
        self.num_objects = np.array([labels.max() + 1 for labels in self.partitions])
        log_p = np.array([log_posterior(evidence, labels) for labels in self.partitions])
        # Alpha enters once for every object, and nowhere else.
        self.at_alpha_1 = log_p - self.num_objects * math.log(evidence.alpha)

    def probabilities(self, alpha: float = 1.0, temperature: float = 1.0) -> np.ndarray:
        """Of every partition, (P,): the posterior to the power of one over the temperature, normalised."""
        log_p = (self.at_alpha_1 + self.num_objects * math.log(alpha)) / temperature
        p = np.exp(log_p - log_p.max())
        return p / p.sum()


def explore_posterior(exact: ExactPosterior, true_labels: np.ndarray) -> Explorer:
    """Move alpha and the temperature of a posterior that is known exactly.

    Args:
        exact: of a few tracklets.
        true_labels: (N,) numbered in the order of first observation.
    """
    figure, (left, right) = plotting.new_figure(1, 2, (11.5, 4.6), width_ratios=(1.7, 1))
    most = pictures.PartitionBars(left, ROWS, f"{ROWS} of {len(exact.partitions)} partitions")
    numbers = np.arange(1, exact.num_objects.max() + 1)
    bars = right.bar(numbers, np.zeros(len(numbers)), 0.7, color="0.75", edgecolor=ESTIMATE_COLOR, linewidth=0.8)
    right.axvline(true_labels.max() + 1, **TRUTH_LINE)
    right.set(ylim=(0.0, 1.02), xticks=numbers)
    label_axes(right, "objects (number)", "probability (no unit)", "how many? (dashed: truth)")

    def update(log_alpha: float, temperature: float) -> str:
        p = exact.probabilities(10**log_alpha, temperature)
        order = most.show(exact.partitions, p, true_labels)
        by_number = np.bincount(exact.num_objects, weights=p)[1:]
        for bar, share in zip(bars, by_number, strict=True):
            bar.set_height(share)
        return _words(exact, p, order, by_number, 10**log_alpha, temperature)

    log_alpha = slider("log10 of alpha", 0.0, -3.0, 3.0, 0.1)
    temperature = slider("temperature", 1.0, 0.1, 8.0, 0.1)
    frames = {"log_alpha": (0, 3), "temperature": (0.1, 1, 4)}
    return Explorer(figure, update, frames, log_alpha=log_alpha, temperature=temperature)


def _words(exact: ExactPosterior, p: np.ndarray, order: list, by_number, alpha: float, temperature: float) -> str:
    first, second = (f"{pictures.partition_name(exact.partitions[k])} has {p[k]:.3f}" for k in order[:2])
    needed = int(np.searchsorted(np.cumsum(np.sort(p)[::-1]), 0.95) + 1)
    number = int(np.argmax(by_number)) + 1
    return (
        f"Alpha {alpha:.3g}, temperature {temperature:.1f}: {first}, {second}; {needed} partitions hold 95 %; "
        f"most probably {number} objects, {by_number[number - 1]:.2f}."
    )


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
        log, tracklet = self.model.log, self.model.tracklet[used]
        xy = se2.apply(path[log.obs_time[used]], log.obs_xy[used])
        sums = [np.bincount(tracklet, weights=xy[:, axis]) for axis in (0, 1)]
        return np.column_stack(sums) / np.bincount(tracklet)[:, None]

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
        points = np.concatenate([*self.tracklet_xy, *self.object_xy, *(path[:, :2] for path in self.paths)])
        low, high = points.min(axis=0) - 0.4, points.max(axis=0) + 0.4
        label_map(ax, "").set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))

        def move(number: int) -> None:
            path.set_data(*self.paths[number][:, :2].T)
            ends = zip(self.tracklet_xy[number], self.object_xy[number], strict=True)
            for spoke, mark, color, (seen_at, object_at) in zip(spokes, marks, self.colors[number], ends, strict=True):
                spoke.set_data(*np.stack([seen_at, object_at]).T)
                mark.set_data(*seen_at[:, None])
                mark.set_color(color)
            ax.set_title(self.title(number))

        return move

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
    figure, (left, right) = plotting.new_figure(1, 2, (12.0, 6.2), width_ratios=(1.7, 1))
    move = film.draw(left)
    temperatures = [state.temperature for state in film.states]
    counts = [int(state.labels.max()) + 1 for state in film.states]
    right.plot(temperatures, counts, "o-", color=CLASS_COLORS[0], markersize=5)
    (here,) = right.plot([], [], "o", color=CLASS_COLORS[1], markersize=11)
    num_true = len(film.truth.world.object_xy)
    right.axhline(num_true, **TRUTH_LINE)
    right.set(xscale="log", ylim=(0, 1.1 * max(*counts, num_true)))
    right.xaxis.set_major_formatter("{x:g}")
    right.invert_xaxis()
    label_axes(right, "temperature (no unit, log scale)", "objects (number)", "from hot to cold (dashed: truth)")
    legend_below(figure, film.handles(), columns=5)

    def update(state: int) -> str:
        move(state)
        here.set_data([temperatures[state]], [counts[state]])
        return annealing_words(film, state)

    states = player("state", len(film.states) - 1)
    return Explorer(figure, update, {"state": states.grid()[:: 1 + len(film.states) // FRAMES]}, state=states)


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
