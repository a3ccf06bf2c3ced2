"""The explorer of lesson 04: drag the observations, and turn alpha, the threshold and the kernel width."""

import numpy as np

from npslam_teach import se2
from npslam_teach.association import PAPER_KERNEL_STD, association_weights, decide, reweight
from npslam_teach.course.explorers import Explorer, choice, places, slider
from npslam_teach.course.scene import Panel, Scene
from npslam_teach.plotting.style import class_style
from npslam_teach.simulate import TOY_CLASSES, toy_objects
from npslam_teach.types import RobotLog

HIGHEST_WEIGHT = 1.7  # of the axis: a lone observation weighs at most 1, alpha goes up to 1.5
HIGHEST_PROBABILITY = 1.12  # room for the numbers above the bars
SIZE = (980.0, 450.0)  # px
LEFT, BARS = 60.0, ((590.0, 36.0, 380.0, 145.0), (590.0, 260.0, 380.0, 145.0))
MARGIN = 0.7  # m around the observations
WIDTH_OF_BAR = 0.72
FRAMES = {"alpha": [0.05, 0.5, 0.9, 1.0, 1.5], "kernel_std": [0.05, 0.15, 0.25, 0.5, 0.7, 1.0]}  # without a kernel
NAME = (1.0, 0.3)  # m, width and height of a name on the map


def explore_association(log: RobotLog | None = None, class_names=TOY_CLASSES, asks: int = 4) -> Explorer:
    """Weights and probabilities of any observation, every other one an object of its own (deck figures 6 to 8).

    Args:
        log: a short one, whose observations fit side by side; the toy scene when None.
        class_names: (C,).
        asks: index of the observation that asks at the start.
    """
    log = toy_objects()[0] if log is None else log
    path = se2.dead_reckoning(log.odometry)
    seen = se2.apply(path[log.obs_time], log.obs_xy).round(9)
    room = Panel.around(np.concatenate([path[:, :2], seen]), MARGIN, (LEFT, 36.0, 465.0, SIZE[1] - 90.0))

    def update(asks: int, alpha: float, threshold: float, kernel_std: float, xy: np.ndarray) -> tuple[str, Scene]:
        votes = (log.obs_class == log.obs_class[asks]) & (np.arange(len(xy)) != asks)  # judged by the others
        weights = association_weights(votes.astype(float), np.linalg.norm(xy - xy[asks], axis=1), kernel_std)
        probabilities = reweight(weights, alpha)
        scene = Scene(SIZE)
        _draw_map(scene, room, path, xy, log.obs_class, class_names, asks, kernel_std)
        _draw_answers(scene, asks, np.append(weights, alpha), probabilities, threshold, log.obs_class)
        return _words(asks, weights, probabilities, alpha, threshold or None), scene

    observations = choice("which sighting asks", {f"Obj_{k + 1}": k for k in range(log.num_observations)})
    observations.put(asks)
    sliders = {
        "alpha": slider("alpha", 0.5, 0.05, 1.5, 0.05),
        "threshold": slider("threshold (0: none)", 0.0, 0.0, 0.95, 0.05),
        "kernel_std": slider("kernel width s (m)", PAPER_KERNEL_STD, 0.05, 1.0, 0.05),
    }
    return Explorer(None, update, FRAMES, asks=observations, **sliders, xy=places("sightings", seen, room))


def _draw_map(scene: Scene, room: Panel, path, xy, obs_class, class_names, asks: int, kernel_std: float) -> None:
    """The observations with their names; those that the asking one may be have the kernel around them."""
    room.map_axes(scene, f"Obj_{asks + 1} asks: who is near enough to be the same?", 1.0)
    room.line(scene, "path", path[:, :2], "estimate")
    alike = [k for k in np.flatnonzero(obs_class == obs_class[asks]) if k != asks]
    for k in alike:
        x, y = room.to_page(xy[k])[0]
        for times in (2, 1):
            style = {"class_": "halo", "fill": class_style(int(obs_class[k]))[0], "style": room.clip(scene)}
            scene.add(f"halo {k} {times}", "circle", cx=x, cy=y, r=times * kernel_std * room.scale[0], **style)
    for k in alike:
        room.line(scene, f"distance {k}", [xy[asks], xy[k]], "spring")
    for k, point in enumerate(xy):
        room.mark(scene, f"sighting {k}", point, int(obs_class[k]))
        right = xy - point
        crowded = ((right[:, 0] > 0) & (right[:, 0] < NAME[0]) & (np.abs(right[:, 1]) < NAME[1])).any()
        shift, style = ((-17.0, 5.0), "end") if crowded else ((17.0, 5.0), "start")
        room.text(scene, f"name {k}", point, f"Obj_{k + 1}", shift, f"{style} bold" if k == asks else style)
    hint = "drag a sighting, or move it with the arrow keys"
    scene.add("hint", "text", hint, x=LEFT, y=SIZE[1] - 6, class_="quiet small", data_places="xy")
    for k, point in enumerate(xy):
        name = f"Obj_{k + 1}, {class_names[obs_class[k]]}, at {point[0]:.2f} m, {point[1]:.2f} m"
        room.handle(scene, f"handle {k}", point, ("xy", k), name, radius=13.0)


def _draw_answers(scene: Scene, asks: int, weights, probabilities, threshold: float, obs_class) -> None:
    """Weights and probabilities of all but the one that asks, and the threshold where there is one."""
    itself = np.arange(len(probabilities)) == asks
    for row, (values, top) in enumerate(((weights, HIGHEST_WEIGHT), (probabilities, HIGHEST_PROBABILITY))):
        _draw_bars(scene, row, np.where(itself, np.nan, values), top, obs_class)
    if threshold > 0:
        bars = Panel(BARS[1], (-0.5, len(probabilities) - 0.5), (0.0, HIGHEST_PROBABILITY))
        bars.line(scene, "threshold", [(-0.5, threshold), (len(probabilities) - 0.5, threshold)], "level")


def _draw_bars(scene: Scene, row: int, values: np.ndarray, top: float, obs_class) -> None:
    """A bar for every observation and one for "new"; NaN is the one that asks, which has none."""
    panel = Panel(BARS[row], (-0.5, len(values) - 0.5), (0.0, top))
    title = ("weights: votes x nearness, and alpha", "probabilities, and the threshold")[row]
    kind = ("weight", "probability")[row]
    panel.axes(scene, kind, title, ("", f"{kind} (no unit)"), ((), (0.0, 0.5, 1.0)))
    for k, value in enumerate(values):
        is_new, height = k == len(obs_class), 0.0 if np.isnan(value) else float(value)
        corner, foot = panel.to_page([(k - WIDTH_OF_BAR / 2, height), (k + WIDTH_OF_BAR / 2, 0.0)])
        size = {"width": foot[0] - corner[0], "height": foot[1] - corner[1]}
        color = "#9a9a9a" if is_new else class_style(int(obs_class[k]))[0]
        scene.add(f"{kind} {k}", "rect", x=corner[0], y=corner[1], fill=color, class_="mark", **size)
        # A weight of 0.004 is written as 0.00, and exactly zero as 0.
        text = "itself" if np.isnan(value) else "0" if height == 0 else f"{height:.2f}"
        panel.text(scene, f"{kind} number {k}", (k, height), text, (0.0, -5.0))
        name = "new" if is_new else f"Obj_{k + 1}"
        panel.text(scene, f"{kind} name {k}", (k, 0.0), name, (0.0, 18.0), "middle small")


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
