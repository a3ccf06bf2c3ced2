"""The explorer of lesson 04: alpha, the threshold and the kernel width of the association."""

import numpy as np

from npslam_teach import plotting, se2
from npslam_teach.association import PAPER_KERNEL_STD, association_weights, decide, reweight
from npslam_teach.course.dirichlet_process import pictures
from npslam_teach.course.explorers import Explorer, choice, slider
from npslam_teach.simulate import TOY_CLASSES, toy_objects
from npslam_teach.types import RobotLog

HIGHEST_WEIGHT = 1.7  # of the axis: a lone observation weighs at most 1, alpha goes up to 1.5


def explore_association(log: RobotLog | None = None, class_names=TOY_CLASSES, asks: int = 4) -> Explorer:
    """Weights and probabilities of any observation, every other one an object of its own (deck figures 6 to 8).

    Args:
        log: a short one, whose observations fit side by side; the toy scene when None.
        class_names: (C,).
        asks: index of the observation that asks at the start.
    """
    log = toy_objects()[0] if log is None else log
    xy = se2.apply(se2.dead_reckoning(log.odometry)[log.obs_time], log.obs_xy)
    figure, left, right, level = _bars(log, class_names)

    def update(asks: int, alpha: float, threshold: float, kernel_std: float) -> str:
        votes = (log.obs_class == log.obs_class[asks]).astype(float)
        votes[asks] = 0.0  # judged by the others
        weights = association_weights(votes, np.linalg.norm(xy - xy[asks], axis=1), kernel_std)
        probabilities = reweight(weights, alpha)
        for ax, values in ((left, np.append(weights, alpha)), (right, probabilities)):
            pictures.set_bars(ax, np.where(np.arange(len(values)) == asks, np.nan, values))
        level.set_ydata([threshold, threshold])
        level.set_visible(threshold > 0)
        return _words(asks, weights, probabilities, alpha, threshold or None)

    observations = choice("which sighting", {f"Obj_{k + 1}": k for k in range(log.num_observations)})
    observations.value = asks
    return Explorer(
        figure,
        update,
        asks=observations,
        alpha=slider("alpha", 0.5, 0.05, 1.5, 0.05),
        threshold=slider("threshold (0: none)", 0.0, 0.0, 0.95, 0.05),
        kernel_std=slider("kernel width s (m)", PAPER_KERNEL_STD, 0.05, 1.0, 0.05),
    )


def _bars(log: RobotLog, class_names):
    """The figure, the axes of weights and of probabilities, and the level of the threshold."""
    names = [*pictures.sighting_names(log.obs_class, class_names), "new"]
    bar_class = [*log.obs_class.tolist(), None]
    figure, (left, right) = plotting.new_figure(2, 1, (8.6, 5.4))
    nothing = np.zeros(len(names))
    pictures.plot_bars(left, nothing, names, bar_class, "weight (no unit)", "weights: votes x nearness, and alpha")
    pictures.plot_bars(right, nothing, names, bar_class, "probability (no unit)", "probabilities, and the threshold")
    left.set_ylim(0.0, HIGHEST_WEIGHT)
    right.set_ylim(0.0, 1.12)
    pictures.plot_threshold(right, 0.0)
    left.tick_params(labelbottom=False)  # names once, below both: drawing them takes a quarter of the time
    right.texts[-1].remove()  # its value would change; the words and the slider give it
    return figure, left, right, right.lines[-1]


def _words(asks: int, weights: np.ndarray, probabilities: np.ndarray, alpha: float, threshold: float | None) -> str:
    """The observation that asks, the numbers that are not zero, and the decision."""
    some = [k for k in np.argsort(-weights, kind="stable") if weights[k] >= 0.005]
    weighed = ", ".join(f"Obj_{k + 1} {weights[k]:.2f}" for k in some) or "none of the others"
    likely = "".join(f"Obj_{k + 1} {probabilities[k]:.2f}, " for k in some) + f"new {probabilities[-1]:.2f}"
    chosen = decide(probabilities, threshold)
    answer = "a new object" if chosen == len(weights) else f"the same as Obj_{chosen + 1}"
    rule = "the most probable wins" if threshold is None else f"threshold {threshold:.2f}"
    return (
        f"Obj_{asks + 1} weighs {weighed}, against alpha {alpha:.2f} for a new object. "
        f'Probabilities: {likely}. By the rule "{rule}" it is {answer}.'
    )
