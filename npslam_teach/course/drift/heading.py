"""The explorer of one wrong heading in lesson 02: drag it, and the path behind it turns with it."""

import numpy as np

from npslam_teach import se2
from npslam_teach.course.explorers import Explorer, slider
from npslam_teach.course.scene import Panel, Scene

SIZE = (980.0, 562.0)  # px
ROOM = Panel((60.0, 36.0, 504.0, 462.0), (-1.6, 5.6), (-2.0, 4.6))  # m; 70 px per metre on both axes
FARTHEST = 2.0  # m, of the axis of the bars
BARS = Panel((660.0, 36.0, 300.0, 462.0), (0.0, 19.0), (0.0, FARTHEST))
LARGEST, HAND_STEP = 30, 5  # degrees
NOSE = 0.85  # m from a pose to the ring on its heading
FRAMES = {"turn": (1, 4, 8, 11, 14, 17), "error": range(-LARGEST, LARGEST + 1, 10)}  # without a kernel


def two_corners() -> np.ndarray:
    """Nine metres around two corners in steps of half a metre, (18, 3) m, m, rad."""
    steps = np.tile([0.5, 0.0, 0.0], (18, 1))
    steps[[7, 13], 2] = np.pi / 2
    return steps


def with_wrong_turn(steps: np.ndarray, turn: int, error: float) -> np.ndarray:
    """The path, (T, 3) m, m, rad from the origin, when one turn is reported wrongly.

    Args:
        steps: (T-1, 3) m, m, rad, the true ones.
        turn: which of them, from 1; it ends at the pose of this number.
        error: rad, by how much its turn is reported too large.
    """
    reported = np.array(steps, dtype=float)
    reported[turn - 1, 2] += error
    return se2.dead_reckoning(reported)


def explore_heading() -> Explorer:
    """The path of figure 25, whose wrong heading is dragged to another angle, or along the path to another step."""
    steps = two_corners()
    true_path = se2.dead_reckoning(steps)

    def update(turn: int, error: float) -> tuple[str, Scene]:
        path = with_wrong_turn(steps, turn, np.deg2rad(error))
        scene = Scene(SIZE)
        _draw_room(scene, true_path, path, turn, error)
        _draw_bars(scene, _ends_off(steps, np.deg2rad(error)), turn, error)
        return words(true_path, path, turn, error), scene

    sliders = {
        "turn": slider("which turn is wrong", 4, 1, len(steps), 1),
        "error": slider("its error (degrees)", 15.0, -float(LARGEST), float(LARGEST), 1.0),
    }
    return Explorer(None, update, FRAMES, **sliders)


def words(true_path: np.ndarray, path: np.ndarray, turn: int, error: float) -> str:
    """Which turn is wrong, the straight way from there to the end, and how far the end is off."""
    off = _off(true_path, path)
    far = np.linalg.norm(true_path[-1, :2] - true_path[turn, :2])
    size = "too large" if error >= 0 else "too small"
    return (
        f"Turn {turn} is reported {abs(error):g} degrees {size}. From there to the end it is {far:.2f} m in a straight "
        f"line, and the end is {off:.2f} m off: 2 sin({abs(error):g}/2 degrees) times as far."
    )


def _ends_off(steps: np.ndarray, error: float) -> np.ndarray:
    """How far the end is off for each turn that may be wrong, (T-1,) m."""
    end = se2.dead_reckoning(steps)[-1, :2]
    turns = range(1, len(steps) + 1)
    return np.array([np.linalg.norm(with_wrong_turn(steps, turn, error)[-1, :2] - end) for turn in turns])


def _draw_room(scene: Scene, true_path: np.ndarray, path: np.ndarray, turn: int, error: float) -> None:
    title = f"all that comes after turn {turn} is turned: the end is {_off(true_path, path):.2f} m off"
    ROOM.axes(scene, "map", title, ("x (m)", "y (m)"), (range(-1, 6), range(-2, 5)))
    hinge = path[turn, :2]
    ROOM.line(scene, "far true", [hinge, true_path[-1, :2]], "grid")
    ROOM.line(scene, "far", [hinge, path[-1, :2]], "grid")
    ROOM.line(scene, "truth", true_path[:, :2], "truth")
    ROOM.line(scene, "path", path[:, :2], "estimate")
    ROOM.dots(scene, "poses", path[:, :2], 7)
    ROOM.line(scene, "off", [path[-1, :2], true_path[-1, :2]], "pull")
    ROOM.text(scene, "true end", true_path[-1, :2], "true end", (8.0, 20.0), "quiet")
    up = -6.0 if path[-1, 1] >= true_path[-1, 1] else 16.0  # away from the line between the ends
    ROOM.text(scene, "believed end", path[-1, :2], "believed end", (-10.0, up), "end bold")
    _draw_rings(scene, true_path, path, turn, error)


def _off(true_path: np.ndarray, path: np.ndarray) -> float:
    return float(np.linalg.norm(path[-1, :2] - true_path[-1, :2]))


def _draw_rings(scene: Scene, true_path: np.ndarray, path: np.ndarray, turn: int, error: float) -> None:
    """The two rings: one goes along the path from turn to turn, the other around the wrong turn."""
    nose, right = _nose(path[turn]), _nose(true_path[turn])
    ROOM.line(scene, "right heading", [path[turn, :2], right], "truth")
    ROOM.line(scene, "heading", [path[turn, :2], nose], "pull")
    angles = range(-LARGEST, LARGEST + 1, HAND_STEP)
    around = [(_nose(true_path[turn] + (0, 0, np.deg2rad(each))), {"error": each}) for each in angles]
    along = [(pose[:2], {"turn": t}) for t, pose in enumerate(true_path) if t > 0]
    ROOM.grip(scene, "which", path[turn, :2], along, f"turn {turn}; arrow keys choose another", r=10.0)
    name = f"heading after turn {turn}, {error:g} degrees from the true one; arrow keys turn it"
    ROOM.grip(scene, "turned", nose, around, name, r=14.0)
    hint = "drag the ring on the heading, or the small one along the path; arrow keys work as well"
    scene.add("hint", "text", hint, x=60, y=SIZE[1] - 5, class_="quiet small", data_hint="true")


def _nose(pose: np.ndarray) -> np.ndarray:
    """Where the ring lies on a pose's heading, (2,) m."""
    return pose[:2] + NOSE * np.array([np.cos(pose[2]), np.sin(pose[2])])


def _draw_bars(scene: Scene, ends_off: np.ndarray, turn: int, error: float) -> None:
    """For each turn how far the end would be off if this one were wrong; the present one is dark."""
    title = f"if another turn errs by {abs(error):g} degrees"
    ticks = (range(1, 19, 3), np.arange(0.0, FARTHEST + 0.1, 0.5))
    BARS.axes(scene, "bars", title, ("turn (number)", "end off by (m)"), ticks)
    for name, turns, color in (("bars", range(1, len(ends_off) + 1), "#b5b5b5"), ("present bar", [turn], "#00659f")):
        tops = BARS.to_page([(k, ends_off[k - 1]) for k in turns])
        foot = BARS.box[1] + BARS.box[3]
        bars = " ".join(f"M{x:.1f},{foot:g}V{y:.1f}" for x, y in tops)
        scene.add(name, "path", d=bars, fill="none", stroke=color, style="stroke-width: 11")
