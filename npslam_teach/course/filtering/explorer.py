"""The filter's gates at one pose: two sliders decide what is matched, what is left out and what is new."""

from itertools import islice

import numpy as np

from npslam_teach import evaluation, plotting
from npslam_teach.course.explorers import Explorer, slider
from npslam_teach.course.filtering import pictures
from npslam_teach.methods.ekf_slam import filter_steps
from npslam_teach.plotting.style import Line2D, class_handles, legend_beside
from npslam_teach.types import RobotLog

WIDEST = 6.0  # standard deviations


def explore_gate(log: RobotLog, time: int, class_names: tuple, labels=None) -> Explorer:
    """Stop the filter before it uses the observations of one pose, and move its gates.

    Args:
        log: what the robot measured.
        time: the pose.
        class_names: (C,).
        labels: (M,) known associations, used instead of decisions before that pose; see ``filter_steps``.

    Raises:
        ValueError: no observation of this pose has the class of an object that is in the map by then.
    """
    if not 0 <= time < log.num_poses:
        raise ValueError(f"time: expected a pose from 0 to {log.num_poses - 1}, got {time}")
    step = next(islice(filter_steps(log, labels=labels), time, None))
    figure, ax = plotting.new_figure(size=(9.0, 5.0))
    picture = pictures.GateMap(ax, step, log, class_names)
    if not np.isfinite(picture.squared_distance).any():
        raise ValueError(f"time: expected a pose that sees a known object's class, pose {time} does not")
    picture.frame(WIDEST)
    _legend(ax, step.object_class, class_names)

    def update(gate: float, second_gate: float) -> str:
        return in_words(picture, picture.decide(gate, second_gate), gate, max(gate, second_gate))

    first = slider("gate (st. deviations)", 3.0, 0.5, WIDEST, 0.1)
    second = slider("second gate (st. dev.)", 5.3, 0.5, WIDEST, 0.1)
    frames = {"gate": (0.5, 2, 3, 4.5, 6), "second_gate": (0.5, 3, 5.3, 6)}
    return Explorer(figure, update, frames, gate=first, second_gate=second)


def in_words(picture: pictures.GateMap, answers: list[str], gate: float, second_gate: float, nearest: int = 3) -> str:
    """The gates, and for every observation its distances to the nearest objects and the decision."""
    share = 100 * evaluation.share_within(gate)
    parts = [
        f"Gates at {gate:.1f} and {second_gate:.1f} standard deviations; {share:.1f} % of right matches pass the first."
    ]
    for k, squared, words in zip(picture.step.observations, picture.squared_distance, answers, strict=True):
        order = [j for j in np.argsort(squared, kind="stable")[:nearest] if np.isfinite(squared[j])]
        far = ", ".join(f"{picture.names[j]} at {np.sqrt(squared[j]):.2f}" for j in order) or "no object of its class"
        parts.append(f"Obj_{k + 1}: {far}; {words}.")
    return " ".join(parts)


def _legend(ax, object_class: np.ndarray, class_names: tuple) -> None:
    lines = {"gate": {"linestyle": "-"}, "second gate": {"linestyle": ":"}}
    handles = [Line2D([], [], color="0.3", linewidth=1.8, label=label, **look) for label, look in lines.items()]
    seen = Line2D(
        [], [], color="#1a1a1a", marker="x", markersize=9, markeredgewidth=2.5, linestyle="none", label="sighting"
    )
    robot = Line2D([], [], color="#1a1a1a", marker="^", markersize=10, linestyle="none", label="robot")
    legend_beside(ax, class_handles(np.unique(object_class), class_names) + [robot, seen, *handles])
