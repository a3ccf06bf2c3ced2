"""Drift on the fifteen-object scene: a slider on the noise moves the path and every observation."""

import numpy as np

from npslam_teach import plotting, se2, simulate
from npslam_teach.course.explorers import Explorer, slider
from npslam_teach.plotting.style import class_handles, legend_beside, path_handles

HIGHEST_NOISE = 3.0


def explore_noise(seed: int = 2016) -> Explorer:
    """Change the noise of odometry and camera: the same draws are scaled, so nothing else changes (deck figure 5).

    Args:
        seed: of the room and the draws, as in ``simulate.fifteen_objects``.
    """
    _, truth = simulate.fifteen_objects(seed)
    log, _, _ = _dead_reckoned(seed, HIGHEST_NOISE)
    figure, ax = plotting.new_figure(size=(8.0, 6.0))
    observations = _draw_room(ax, truth, log)
    (path,) = ax.plot([], [], **plotting.style.ESTIMATE_LINE)
    (end,) = ax.plot([], [], marker="X", markersize=12, color=plotting.style.ESTIMATE_COLOR, linestyle="none", zorder=4)
    _fix_limits(ax, truth, seed)

    def update(noise: float) -> str:
        log, poses, xy = _dead_reckoned(seed, noise)
        path.set_data(*poses[:, :2].T)
        end.set_data(*poses[-1:, :2].T)
        for c, markers in observations.items():
            markers.set_offsets(xy[log.obs_class == c])
        return in_words(noise, poses, xy, truth)

    noise = slider("noise (paper = 1)", 1.0, 0.0, HIGHEST_NOISE, 0.25)
    return Explorer(figure, update, {"noise": noise.grid()[::2]}, noise=noise)


def in_words(noise: float, poses: np.ndarray, obs_xy_world: np.ndarray, truth) -> str:
    """The errors of dead reckoning from the true first pose, of the path and of the observations."""
    off = np.linalg.norm(poses[:, :2] - truth.poses[:, :2], axis=1)
    beside = np.linalg.norm(obs_xy_world - truth.world.object_xy[truth.obs_object], axis=1)
    return (
        f"Noise {noise:.2f}: the robot ends {off[-1]:.2f} m from where it thinks it is, {off.mean():.2f} m off on "
        f"average. Its {len(beside)} sightings are {len(beside)} objects, half of them more than "
        f"{np.median(beside):.2f} m beside the real one."
    )


def _dead_reckoned(seed: int, noise: float):
    """The log, the dead-reckoned poses (T, 3) from the true start, and the observations (M, 2) m carried into W."""
    log, truth = simulate.fifteen_objects(seed, noise)
    poses = se2.dead_reckoning(log.odometry, truth.poses[0])
    return log, poses, se2.apply(poses[log.obs_time], log.obs_xy)


def _draw_room(ax, truth, log) -> dict:
    """The truth, and one collection of markers for the observations of every class."""
    world = truth.world
    plotting.plot_trajectory(ax, truth.poses, truth=True)
    plotting.plot_objects(ax, world.object_xy, world.object_class, world.class_names, truth=True)
    known = len(ax.collections)
    plotting.plot_objects(ax, log.obs_xy, log.obs_class, world.class_names, sizes=14, alpha=0.55)
    classes = np.unique(log.obs_class)
    last = path_handles(("estimated path",))[0]
    end = plotting.style.Line2D([], [], marker="X", markersize=10, color="#1a1a1a", linestyle="none")
    end.set_label("believed end")
    handles = class_handles(classes, world.class_names) + [last, end]
    legend_beside(ax, handles + path_handles(("true path", "true object")))
    ax.set_title("every sighting a new object", fontsize=plotting.style.TEXT_SIZE["title"])
    return dict(zip(classes.tolist(), ax.collections[known:], strict=True))


def _fix_limits(ax, truth, seed: int) -> None:
    """Axes that hold everything at every noise, so that they stand still under the slider."""
    points = [truth.poses[:, :2], truth.world.object_xy]
    for noise in np.linspace(0.0, HIGHEST_NOISE, 4):
        _, poses, xy = _dead_reckoned(seed, noise)
        points += [poses[:, :2], xy]
    low, high = np.concatenate(points).min(axis=0) - 0.4, np.concatenate(points).max(axis=0) + 0.4
    ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
