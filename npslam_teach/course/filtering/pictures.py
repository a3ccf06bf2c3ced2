"""Filtering: beliefs on a line, gates on a map, the filter's own consistency, and methods over many rooms."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import LogLocator, NullFormatter

from npslam_teach import se2
from npslam_teach.evaluation.consistency import chi2_bounds, nis_in_windows, share_within
from npslam_teach.methods.ekf import expected_observations, landmarks_of
from npslam_teach.methods.ekf_slam import FilterStep
from npslam_teach.methods.gating import NEW, UNASSIGNED, assign
from npslam_teach.plotting.maps import plot_objects, plot_robots
from npslam_teach.plotting.style import (
    CLASS_COLORS,
    CLASS_MARKERS,
    ESTIMATE_COLOR,
    TEXT_SIZE,
    TRUTH_LINE,
    class_style,
    label_axes,
    label_map,
    legend_beside,
    method_style,
)
from npslam_teach.plotting.uncertainty import ellipse_points
from npslam_teach.types import RobotLog

# Beliefs side by side; not the colours of the lessons' classes, except for a fourth.
BELIEF_COLORS, BELIEF_LINES = (
    (ESTIMATE_COLOR, CLASS_COLORS[5], CLASS_COLORS[3], CLASS_COLORS[1]),
    ("-", "--", "-.", ":"),
)


def plot_beliefs(ax: Axes, beliefs: dict, true_x: float) -> Axes:
    """Gaussians on a line, each solid, dashed, ... and in a colour of its own.

    Args:
        ax: any axes.
        beliefs: name to (mean, variance) in m and m^2.
        true_x: m, where the robot really is.
    """
    widest = max(np.sqrt(variance) for _, variance in beliefs.values())
    means = [mean for mean, _ in beliefs.values()]
    x = np.linspace(min(means) - 3 * widest, max(means) + 3 * widest, 600)
    for k, (name, (mean, variance)) in enumerate(beliefs.items()):
        density = np.exp(-((x - mean) ** 2) / (2 * variance)) / np.sqrt(2 * np.pi * variance)
        ax.plot(x, density, BELIEF_LINES[k % 4], color=BELIEF_COLORS[k % 4], linewidth=2.4, label=name)
    ax.axvline(true_x, label="true position", **TRUTH_LINE)
    ax.set_ylim(bottom=0.0)
    legend_beside(ax)
    surest = min(beliefs, key=lambda name: beliefs[name][1])
    title = f"the narrowest belief: {surest}, with a standard deviation of {np.sqrt(beliefs[surest][1]):.2f} m"
    return label_axes(ax, "position in the corridor (m)", "density (1/m)", title)


def object_names(object_class: np.ndarray, class_names: tuple) -> list[str]:
    """Names by class, in the order in which objects were found: "chair A", "chair B", "screen A"; (K,)."""
    names, seen = [], {}
    for c in np.asarray(object_class).tolist():
        number = seen[c] = seen.get(c, -1) + 1
        names.append(f"{class_names[c]} {chr(ord('A') + number % 26)}{number // 26 or ''}")
    return names


class GateMap:
    """A map of one step of a filter: the objects it knows, the observations, and the decisions of its gates.

    The artists are made once; ``decide`` moves them.
    """

    def __init__(self, ax: Axes, step: FilterStep, log: RobotLog, class_names: tuple):
        """Draw the robot, the objects that it knows, and what it sees now, with the gates still closed.

        Args:
            ax: a map.
            step: of a filter; its own decision is ignored.
            log: what it runs on.
            class_names: (C,).
        """
        self.ax, self.step, self.log = ax, step, log
        self.names = object_names(step.object_class, class_names)
        seen_class = log.obs_class[step.observations]
        # With known associations the distances of a filter ignore classes; gates do not.
        rivals = seen_class[:, None] == step.object_class
        self.squared_distance = np.where(rivals, step.squared_distance, np.inf)
        self.seen_at = se2.apply(step.prior_mean[:3], log.obs_xy[step.observations])
        self.gates = [{j: self._outline(j, dashes) for j in np.flatnonzero(rivals.any(axis=0))} for dashes in "-:"]
        landmarks = landmarks_of(step.prior_mean)
        plot_objects(ax, landmarks, step.object_class, class_names, sizes=110)
        plot_robots(ax, step.prior_mean[None, :3])
        for index in self.gates[0]:  # the others have no gate, and their names would crowd the map
            _write_beside(ax, self.names[index], landmarks[index], (0, -15), "center")
        ax.plot(*self.seen_at.T, "x", color=ESTIMATE_COLOR, markersize=10, markeredgewidth=2.5, zorder=3.5)
        self.ties = [ax.plot([], [], color=ESTIMATE_COLOR, linewidth=1.5, zorder=2.2)[0] for _ in self.seen_at]
        self.answers = [_write_beside(ax, "", xy, (11, 0)) for xy in self.seen_at]
        label_map(ax, f"before the sightings of pose {step.time} are used")

    def decide(self, gate: float, second_gate: float) -> list[str]:
        """Set the gates, and return the decision for each observation.

        Args:
            gate: a Mahalanobis distance.
            second_gate: another; if it is smaller than ``gate``, both are ``gate``.
        """
        second_gate = max(gate, second_gate)
        for lines, radius in zip(self.gates, (gate, second_gate), strict=True):
            for index, line in lines.items():
                outline = gate_outline(
                    self.step.prior_mean, self.step.prior_cov, index, self.log.observation_std, radius
                )
                line.set_data(*outline.T)
        decision, words = assign(self.squared_distance, gate**2, second_gate**2), []
        for k, chosen in enumerate(decision.tolist()):
            words.append({UNASSIGNED: "left out", NEW: "new"}.get(chosen) or self.names[chosen])
            self.answers[k].set_text(f"Obj_{self.step.observations[k] + 1}: {words[k]}")
            end = landmarks_of(self.step.prior_mean)[chosen] if chosen >= 0 else self.seen_at[k]
            self.ties[k].set_data(*np.stack([self.seen_at[k], end]).T)
        return words

    def frame(self, radius: float) -> None:
        """Fix the limits of the map so that gates up to this Mahalanobis distance fit."""
        self.decide(radius, radius)
        self.ax.relim()
        self.ax.autoscale_view()
        self.ax.set(autoscale_on=False)

    def _outline(self, index: int, dashes: str):
        color = class_style(self.step.object_class[index])[0]
        return self.ax.plot([], [], dashes, color=color, linewidth=1.8, zorder=1.8)[0]


def gate_outline(
    mean: np.ndarray, cov: np.ndarray, index: int, observation_std: np.ndarray, radius: float
) -> np.ndarray:
    """The border of the region where an observation of an object passes its gate; (100, 2) m, W.

    The gate is an ellipse in the frame of the robot; the mean pose carries it into the world.

    Args:
        mean: (n,) of the filter.
        cov: (n, n).
        index: of the object.
        observation_std: (2,) m.
        radius: of the gate, a Mahalanobis distance.
    """
    expected, innovation_cov = expected_observations(mean, cov, np.array([index]), observation_std)
    return se2.apply(mean[:3], ellipse_points(expected[0], innovation_cov[0], share_within(radius)))


def _write_beside(ax: Axes, text: str, xy: np.ndarray, offset: tuple, align: str = "left"):
    """A name beside a marker, on white so that lines behind it are not mistaken for strokes; returns the annotation."""
    place = {"xytext": offset, "textcoords": "offset points", "ha": align, "va": "center"}
    back = {"facecolor": "white", "linewidth": 0, "pad": 0.8, "alpha": 0.85}
    return ax.annotate(text, xy, fontsize=TEXT_SIZE["tick"], zorder=4, bbox=back, **place)


def plot_robot_belief(ax: Axes, pose: np.ndarray, pose_cov: np.ndarray, name: str, k: int = 0) -> Axes:
    """A robot and the ellipse that should hold it with 95 %.

    Args:
        ax: a map.
        pose: (3,) m, m, rad, W.
        pose_cov: (3, 3).
        name: for the legend.
        k: of several beliefs on one map: colour and dashes.
    """
    color = BELIEF_COLORS[k % 4]
    outline = ellipse_points(pose[:2], pose_cov[:2, :2])
    ax.plot(*outline.T, BELIEF_LINES[k % 4], color=color, linewidth=2.2, label=name)
    heading = (3, 0, np.rad2deg(pose[2]) - 90)
    ax.plot(*pose[:2], marker=heading, markersize=8, color=color, linestyle="none", zorder=3.2)
    return label_map(ax)


def plot_nis(ax: Axes, records: dict, window: int = 50, probability: float = 0.95) -> Axes:
    """The average NIS per number measured, over windows of frames, with the band that a consistent filter stays in.

    Args:
        ax: any axes.
        records: name to ``FilterRecord``; all with the same matches, so that one band holds for all.
        window: frames that are taken together.
        probability: that a window of a consistent filter lies in the band.
    """
    inside = []
    for k, (name, record) in enumerate(records.items()):
        middle, average, dof = nis_in_windows(record.nis, record.nis_dof, window)
        line = {"color": BELIEF_COLORS[k % 4], "linestyle": BELIEF_LINES[k % 4], "marker": CLASS_MARKERS[k % 4]}
        ax.plot(middle, average, linewidth=2.2, label=name, **line)
        low, high = chi2_bounds(dof, probability)
        inside += [name] if np.mean((low <= average) & (average <= high)) > 0.5 else []
    band = f"{probability:.0%} band of a consistent filter"
    ax.fill_between(middle, low, high, color="0.85", zorder=0.5, label=band)
    ax.set_yscale("log")
    _plain_numbers(ax.yaxis)
    legend_beside(ax)
    title = f"consistent, mostly within the band: {', '.join(inside) or 'none'}"
    return label_axes(ax, "pose t (index)", "NIS per number measured (log scale)", title)


def plot_spread(ax: Axes, errors: dict) -> Axes:
    """One dot for every room and method, and a bar at the median.

    Args:
        ax: any axes.
        errors: name of a method to its mean pose errors (rooms,) m.
    """
    for row, (name, values) in enumerate(errors.items()):
        style = {key: spread_style(name)[key] for key in ("color", "marker")}
        # Spread a little up and down, alike for every method, so that equal values do not hide each other.
        up = row + 0.18 * np.linspace(-1, 1, len(values))
        ax.plot(
            values, up, linestyle="none", markersize=9, markeredgecolor=ESTIMATE_COLOR, markeredgewidth=0.6, **style
        )
        ax.plot(np.full(2, np.median(values)), [row - 0.32, row + 0.32], color=ESTIMATE_COLOR, linewidth=2.5)
    ax.set_xscale("log")
    _plain_numbers(ax.xaxis)
    ax.set_yticks(range(len(errors)), list(errors))
    ax.invert_yaxis()
    best = min(errors, key=lambda name: max(errors[name]))
    title = f"least error in the worst room: {best}\n(a dot is a room, a bar the median)"
    return label_axes(ax, "mean pose error (m, log scale)", "method", title)


def spread_style(name: str) -> dict:
    """The style of a method, without what follows a comma in its name; a black star if there is no such method."""
    try:
        return method_style(name.split(",")[0])
    except ValueError:
        return {"color": ESTIMATE_COLOR, "marker": "*"}


def _plain_numbers(axis) -> None:
    """Write 0.5, 1, 2 on a logarithmic axis, not powers of ten."""
    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.set_major_formatter("{x:g}")
    axis.set_minor_formatter(NullFormatter())
